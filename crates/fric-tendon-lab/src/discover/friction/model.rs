//! A model of the tendon with the numbers that the discovery varies.

use crate::shape_errors::Way;

/// Friction at the holes and the drift of the gratings.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The friction model.
    pub way: Way,
    /// μ of each hole.
    pub mu: Vec<f64>,
    /// Whether the shared μ of the holes stays as stated in the file.
    pub is_shared_given: bool,
    /// Holes with a μ of their own; the shared scale does not include them.
    pub is_own: Vec<bool>,
    /// Whether each grating drifts, and its drift as a tension, N/s.
    pub drifts: Vec<bool>,
    pub drift_n_per_s: Vec<f64>,
}

/// A step of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Friction at the holes.
    Coulomb,
    /// Holes with memory.
    Presliding,
    /// A drifting grating, counted from 0.
    SensorDrift(usize),
    /// A hole with its own μ, counted from 0.
    HoleFriction(usize),
}

impl Effect {
    /// Returns the name used in results.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Coulomb => "coulomb",
            Self::Presliding => "presliding",
            Self::SensorDrift(_) => "sensor_drift",
            Self::HoleFriction(_) => "hole_friction",
        }
    }

    /// Returns the cause, and what to do about it on the machine.
    pub fn cause_and_remedy(self) -> [&'static str; 2] {
        match self {
            Self::Coulomb => [
                "The tendon rubs in the holes of the disks.",
                "State μ; lubricate, or choose a smoother pair of materials.",
            ],
            Self::Presliding => [
                "After a reversal the holes near the base turn round first, those near the tip still hold: friction depends on the \
                 history of the tension.",
                "Compute shapes with the history; pull beyond the wanted tension before small releases. σ is a usual value: above it a run hardly \
                 tells one from another.",
            ],
            Self::SensorDrift(_) => [
                "The wavelength of a grating wanders, as with its temperature.",
                "Let it warm up, or lead a grating without load along and record it as shift_reference_nm.",
            ],
            Self::HoleFriction(_) => [
                "A hole is rougher or smoother than the others, or the tendon is kinked there.",
                "Look at the edge of the hole and at the coating of the tendon; state μ hole by hole.",
            ],
        }
    }
}

/// A fitted number of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// The shared μ of the holes; if the file states several, all are scaled.
    SharedMu,
    /// The μ of an individual hole.
    OwnMu(usize),
    /// Drift of a grating.
    Drift(usize),
}

impl Model {
    /// Returns the fitted parameters.
    pub fn parameters(&self) -> Vec<Parameter> {
        let has_friction = self.way != Way::None;
        let shared =
            (has_friction && !self.is_shared_given && self.is_own.contains(&false)).then_some(Parameter::SharedMu);
        let all = |flags: &[bool]| (0..flags.len()).filter(|place| flags[*place]).collect::<Vec<_>>();
        let own = all(&self.is_own).into_iter().map(Parameter::OwnMu);
        shared.into_iter().chain(own).chain(all(&self.drifts).into_iter().map(Parameter::Drift)).collect()
    }

    /// Returns one of its numbers.
    pub fn get(&self, parameter: Parameter) -> f64 {
        let found = match parameter {
            Parameter::SharedMu => self.mu.iter().zip(&self.is_own).find(|(_, is_own)| !**is_own).map(|(mu, _)| mu),
            Parameter::OwnMu(hole) => self.mu.get(hole),
            Parameter::Drift(grating) => self.drift_n_per_s.get(grating),
        };
        found.copied().unwrap_or(0.0)
    }

    /// Returns the model with another value; μ is kept within its range.
    pub fn with(&self, parameter: Parameter, value: f64) -> Self {
        let mut model = self.clone();
        match parameter {
            Parameter::SharedMu => {
                let factor = value.clamp(LEAST_MU, MOST_MU) / self.get(parameter);
                for (mu, _) in model.mu.iter_mut().zip(&self.is_own).filter(|(_, is_own)| !**is_own) {
                    *mu = (*mu * factor).min(MOST_MU);
                }
            }
            Parameter::OwnMu(hole) => {
                if let Some(mu) = model.mu.get_mut(hole) {
                    *mu = value.clamp(LEAST_MU, MOST_MU);
                }
            }
            Parameter::Drift(grating) => {
                if let Some(drift) = model.drift_n_per_s.get_mut(grating) {
                    *drift = value;
                }
            }
        }
        model
    }

    /// Returns the model with holes that have their own μ.
    pub fn with_holes(&self, holes: &[usize]) -> Self {
        let mut model = self.clone();
        for hole in holes {
            if let Some(is_own) = model.is_own.get_mut(*hole) {
                *is_own = true;
            }
        }
        model
    }

    /// Returns the model with a drifting grating.
    pub fn with_drift(&self, grating: usize) -> Self {
        let mut model = self.clone();
        if let Some(drifts) = model.drifts.get_mut(grating) {
            *drifts = true;
        }
        model
    }
}

/// Search range of μ; the lower limit is not 0, so that μ can be scaled again.
const LEAST_MU: f64 = 1e-4;
const MOST_MU: f64 = 0.9;
