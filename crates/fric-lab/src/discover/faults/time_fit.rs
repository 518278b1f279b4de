//! The fit of a time error of the reference beside the parameters of a model.

use std::sync::atomic::AtomicBool;

use fric_core::effects::Effect;
use fric_core::parameters::MU;

use super::shifted::{Shift, shifted};
use crate::candidates::catalogue::{around, fitted, has, starts};
use crate::discover::lag::behind_lag;
use crate::discover::naming::projection::{Columns, Signals, visit_less_projection};
use crate::discover::workbench::{Model, NEAR_ERRORS, Trial, Workbench};
use crate::fit::{CableRecord, Parameter, Row};
use crate::samples::split::Block;
use crate::search::vector::Coordinate;

/// Minimum relative decrease of the held-out sum of squares. It corresponds to 0.25 % of the rms, as for an effect.
pub const LEAST_GAIN: f64 = 0.005;

/// Maximum number of improvements, and the fraction of a sample interval below which an improvement counts as none. Noise in the reference makes its
/// rate larger and each improvement smaller, so more improvements are needed. With 8, a delay of 6 ms on a bench with slowly changing forces comes
/// out 5 % short.
const ROUNDS: usize = 24;
const SMALL: f64 = 1e-2;
/// Number of samples on either side over which rates are computed.
const RATE_SAMPLES: usize = 5;

/// Effects of the machine that can leave what a late reference leaves, `ε·dF/dt`: what goes with the speed does under a load that goes with the length, and
/// inertia where such a load turns.
const RIVALS: [Effect; 2] = [Effect::Viscous, Effect::PulleyInertia];

/// A way in which a reference may be off in time.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// By a constant time.
    Delay,
    /// By a time that grows.
    Skew,
    /// It is early because the sensor force is behind a lag of first order, with the time constant in place of the delay, negative.
    Lag,
}

impl Kind {
    /// Returns the number of times that determine the shift.
    pub fn parameter_count(self) -> usize {
        if self == Self::Skew { 2 } else { 1 }
    }
}

/// A linear step towards the correct time.
pub struct Step {
    shift: Shift,
    /// Decrease of the sum of squares, N², and as a fraction of what the model's parameters cannot compensate.
    gain: f64,
    pub gain_ratio: f64,
    /// Of the rate of the reference, and its product with the time, beside the residual.
    columns: Columns,
}

/// The result of correcting one kind of shift.
pub struct Corrected {
    pub shift: Shift,
    pub references_n: Vec<f64>,
    pub trial: Trial,
}

/// Returns the time of a sample, s since the first sample of its log.
pub fn seconds(record: &CableRecord<'_>, place: usize) -> f64 {
    let start = record.starts.get(record.log_index(place)).copied().unwrap_or(0);
    record.time_s(place) - record.time_s(start)
}

/// Returns the rate of the reference, N/s; NaN where it is unknown.
pub fn rates(record: &CableRecord<'_>, references_n: &[f64]) -> Vec<f64> {
    let mut rates = vec![f64::NAN; references_n.len()];
    for (start, log) in record.logs() {
        let of_log = references_n.get(start..start + log.len()).unwrap_or_default();
        let middles = rates.iter_mut().skip(start + RATE_SAMPLES);
        for ((place, rate), around) in (start..).zip(middles).zip(of_log.windows(2 * RATE_SAMPLES + 1)) {
            let change_n = around[2 * RATE_SAMPLES] - around[0];
            *rate = change_n / (record.time_s(place + 2 * RATE_SAMPLES) - record.time_s(place));
        }
    }
    rates
}

/// One cable with its log.
#[derive(Clone, Copy)]
pub struct Case<'a> {
    pub record: CableRecord<'a>,
    pub counts: &'a [bool],
    pub blocks: &'a [Block],
    pub measured: &'a [bool],
    pub stop: &'a AtomicBool,
}

impl<'a> Case<'a> {
    pub fn bench<'b>(&self, references_n: &'b [f64]) -> Workbench<'b>
    where
        'a: 'b,
    {
        let Self { record, counts, blocks, measured, stop } = *self;
        Workbench { record: record.with_references(references_n), blocks, counts, measured, stop }
    }

    /// Returns the model with the rivals of a late reference free, beside the reference as it is.
    pub fn beside_rivals(&self, given: &Trial) -> Option<Trial> {
        let around = around(&self.record, given.values[MU], 0.0);
        let has_inertia = has(Effect::PulleyInertia, &given.values);
        // They differ in the window of the acceleration.
        let of_inertia = if has_inertia {
            vec![given.values]
        } else {
            starts(Effect::PulleyInertia, &given.values, &around, &self.record)
        };
        let mut free = given.free.clone();
        free.extend(RIVALS.into_iter().flat_map(fitted).filter(|rival| !given.free.contains(rival)));
        let models: Vec<Model> = of_inertia.into_iter().map(|values| Model { values, free: free.clone() }).collect();
        let fits = self.bench(self.record.references_n).try_all(&models, NEAR_ERRORS);
        fits.into_iter().min_by(|one, other| one.training.total_cmp(&other.training))
    }

    /// Returns a fitted model with the parameters that the search drove to a bound there, and those that keep clear of one.
    fn settled(&self, trial: &Trial) -> (Model, Vec<Parameter>) {
        let (mut model, mut inside) = (trial.model(), Vec::new());
        for parameter in &trial.free {
            let value = &mut model.values[parameter.place()];
            match Coordinate::of(parameter, self.record.cycle_s).bound_at(*value, 0.0) {
                Some(bound) => *value = bound,
                None => inside.push(*parameter),
            }
        }
        (model, inside)
    }

    /// Returns the shift of a kind that leaves the smallest residual.
    pub fn corrected(&self, as_it_is: &Trial, kind: Kind) -> Option<Corrected> {
        let (mut shift, mut trial) = (Shift::default(), as_it_is.clone());
        let mut references_n = self.record.references_n.to_vec();
        for _ in 0..ROUNDS {
            let Step { shift: step, .. } = self.improvement(&references_n, &trial, kind)?;
            shift = Shift { delay_s: shift.delay_s + step.delay_s, skew: shift.skew + step.skew };
            references_n = match kind {
                Kind::Lag => {
                    let time_constant_s = (-shift.delay_s).max(f64::MIN_POSITIVE);
                    behind_lag(&self.record, self.record.references_n, |past_s| (-past_s / time_constant_s).exp())
                }
                Kind::Delay | Kind::Skew => shifted(&self.record, shift),
            };
            trial = self.fitted_again(&references_n, &trial);
            let last = |(start, log): (usize, &[Row])| seconds(&self.record, (start + log.len()).saturating_sub(1));
            let end_s = self.record.logs().map(last).fold(0.0, f64::max);
            if step.delay_s.abs() + step.skew.abs() * end_s < SMALL * self.record.interval_s {
                break;
            }
        }
        Some(Corrected { shift, references_n, trial })
    }

    /// Fits a model again, to other references.
    pub fn fitted_again(&self, references_n: &[f64], trial: &Trial) -> Trial {
        self.bench(references_n).try_one(&self.settled(trial).0)
    }

    /// Whether a delay with a skew would reduce the residual notably.
    pub fn may_gain(&self, references_n: &[f64], trial: &Trial) -> Option<bool> {
        Some(self.improvement(references_n, trial, Kind::Skew)?.gain >= LEAST_GAIN * trial.training)
    }

    /// Returns the shift that would reduce the residual most.
    pub fn improvement(&self, references_n: &[f64], trial: &Trial, kind: Kind) -> Option<Step> {
        let count = kind.parameter_count();
        let (mut columns, mut squares) = (Columns::new(count, 0, count), 0.0);
        self.visit(references_n, trial, kind, |rates, residual_n| {
            columns.add(rates, residual_n);
            squares += if residual_n.is_finite() { residual_n * residual_n } else { 0.0 };
        })?;
        let (factors, gain) = columns.fit(&[0, 1][..count])?;
        let shift = Shift { delay_s: -factors[0], skew: factors.get(1).map_or(0.0, |factor| -factor) };
        Some(Step { shift, gain, gain_ratio: gain / squares, columns })
    }

    /// Returns the factor by which memory in what another improvement would leave weakens the evidence, at least 1.
    pub fn inflation(&self, of: &Corrected, kind: Kind) -> Option<f64> {
        let Step { columns, .. } = self.improvement(&of.references_n, &of.trial, kind)?;
        let mut memory = columns.memory(&[0, 1][..kind.parameter_count()])?;
        self.visit(&of.references_n, &of.trial, kind, |rates, residual_n| memory.add(rates, residual_n))?;
        Some(memory.inflations().into_iter().fold(1.0, f64::max))
    }

    /// Visits the samples that count with the rate of the reference, for a skew also its product with the time, and with the residual, each less what the
    /// model's parameters can compensate.
    fn visit(&self, references_n: &[f64], trial: &Trial, kind: Kind, mut visit: impl FnMut(&[f64], f64)) -> Option<()> {
        let bench = self.bench(references_n);
        let (left, rate_n_per_s) = (bench.evaluated(&trial.values), rates(&self.record, references_n));
        let signals = || -> Signals<'_> {
            Box::new(|place, numbers| {
                let rate = rate_n_per_s.get(place).copied().unwrap_or(f64::NAN);
                numbers.extend([left.residual_n(place), rate]);
                numbers.extend((kind == Kind::Skew).then(|| rate * seconds(&self.record, place)));
            })
        };
        // What is at its bound makes up for nothing that would move it beyond.
        let problem = bench.problem(&self.settled(trial).1, None);
        visit_less_projection(&problem, &trial.values, &signals, |_, numbers| {
            if let Some((residual_n, rates)) = numbers.split_first() {
                visit(rates, *residual_n);
            }
        })
    }
}
