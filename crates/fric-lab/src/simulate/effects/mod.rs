//! What the effects of the catalogue do to the simulated robot.
//!
//! To add one: a file here that implements [`TruthEffect`] from the physics, not from the compensator's code, and a row
//! in [`SIMULATED`]. An effect that acts at a place where none has acted so far gets a new method with a default that
//! does nothing, and one call where that place is ([`bristle`](super::bristle), [`motion`](super::motion),
//! [`stream`](super::stream)). An effect of the catalogue without a row is refused by name.

mod stribeck;
mod time_delay;

use fric_core::effects::EffectParams;
use fric_core::robot::file::EffectTable;

use super::error::SimulationError;
use super::hidden::{HiddenEffect, list};

/// An effect at work on one cable. Every method's default is a cable without it.
pub trait TruthEffect: core::fmt::Debug + Send + Sync {
    /// Factor on a bearing's μ at a cable speed.
    fn mu_factor(&self, _speed_m_per_s: f64) -> f64 {
        1.0
    }

    /// By how much the logged motion runs ahead of the cable's, s.
    fn motion_lead_s(&self) -> f64 {
        0.0
    }
}

/// All effects of one cable: factors multiply, leads add up.
#[derive(Debug, Default)]
pub struct TruthEffects(Vec<Box<dyn TruthEffect>>);

type Build = fn(&EffectParams) -> Box<dyn TruthEffect>;

/// What the simulation can do, by the catalogue's names.
const SIMULATED: &[(&str, Build)] = &[("stribeck", stribeck::build), ("time_delay", time_delay::build)];

impl TruthEffects {
    /// The effects that the robot file gives a cable and the hidden ones, all of which act.
    pub fn new(of_file: &[EffectTable], hidden: &[HiddenEffect]) -> Result<Self, SimulationError> {
        let mut effects = Self::default();
        for table in of_file {
            let mut params = EffectParams::NEUTRAL;
            for (key, value) in &table.parameters {
                params.set(&table.kind, key, *value)?;
            }
            effects.add(&table.kind, &params)?;
        }
        for effect in hidden {
            effects.add(effect.kind(), effect.params())?;
        }
        Ok(effects)
    }

    fn add(&mut self, kind: &str, params: &EffectParams) -> Result<(), SimulationError> {
        let Some((_, build)) = SIMULATED.iter().find(|(name, _)| *name == kind) else {
            let known = list(SIMULATED.iter().map(|(name, _)| format!("`{name}`")));
            return Err(SimulationError::UnsupportedEffect { kind: kind.to_owned(), known });
        };
        self.0.push(build(params));
        Ok(())
    }
}

impl TruthEffect for TruthEffects {
    fn mu_factor(&self, speed_m_per_s: f64) -> f64 {
        self.0.iter().map(|effect| effect.mu_factor(speed_m_per_s)).product()
    }

    fn motion_lead_s(&self) -> f64 {
        self.0.iter().map(|effect| effect.motion_lead_s()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_simulated_effect_is_in_the_catalogue() {
        for (kind, _) in SIMULATED {
            assert!(fric_core::effects::row(kind).is_some(), "{kind}");
        }
    }

    #[test]
    fn an_effect_without_a_row_is_refused_by_name() {
        let error = TruthEffects::default().add("sensor_gain", &EffectParams::NEUTRAL).map_err(|e| e.to_string());
        let expected = "the effect `sensor_gain` is in the catalogue, but the simulation cannot do it yet; \
                        it can do `stribeck`, `time_delay`";
        assert_eq!(error, Err(expected.to_owned()));
    }

    #[test]
    fn effects_of_file_and_hidden_ones_both_act() -> Result<(), Box<dyn core::error::Error>> {
        let table = EffectTable {
            kind: "stribeck".to_owned(),
            parameters: [("ratio".to_owned(), 0.5), ("velocity_m_per_s".to_owned(), 0.1)].into(),
        };
        let hidden = ["stribeck:ratio=0.2,velocity_m_per_s=0.05", "time_delay:delay_s=0.004"].map(HiddenEffect::parse);
        let effects = TruthEffects::new(&[table], &hidden.into_iter().collect::<Result<Vec<_>, _>>()?)?;
        assert!((effects.mu_factor(0.0) - 1.5 * 1.2).abs() < 1e-15);
        let expected = (1.0 + 0.5 * (-1.0_f64).exp()) * (1.0 + 0.2 * (-4.0_f64).exp());
        assert!((effects.mu_factor(-0.1) - expected).abs() < 1e-15);
        assert!((effects.motion_lead_s() - 0.004).abs() < 1e-18);
        Ok(())
    }
}
