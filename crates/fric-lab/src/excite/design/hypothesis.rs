//! Two models of a cable that a run is to distinguish: the size of their effects, their predictions, and the expected evidence against the wrong one.

use fric_core::CableParams;
use fric_core::effects::Effect;
use fric_core::parameters::{MU, Values};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::predicted::sensed;
use crate::candidates::catalogue;
use crate::candidates::ripple::{period_of, periods};
use crate::discover::naming::evidence::delta_bic;
use crate::discover::workbench::{Model, NEAR_ERRORS, Trial, Workbench};
use crate::effects::{self, Around, Sizing};
use crate::fit::{CableRecord, FitOptions, Parameter, Row};
use crate::samples::split::split;
use std::sync::atomic::AtomicBool;

/// Strength of an effect of unknown size, relative to the maximum in machines.
const STRENGTH_RATIO: f64 = 0.5;
/// Mean normal force of a pulley per tension: 2 at 180°, √2 at 90°.
const NORMAL_PER_TENSION: f64 = 1.6;

/// One of the models: a base with or without an effect.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    pub values: Values,
    /// The parameters that an identification varies.
    pub free: Vec<Parameter>,
}

impl Hypothesis {
    /// Creates the model of these values with an effect, which is varied in any case.
    pub fn new(params: &CableParams, effect: Option<Effect>, values: &Values) -> Option<Self> {
        let params = params.with_values(values).ok()?;
        let mut free = FitOptions::default().free(&params);
        // The effect is varied even if a refit has made it small.
        for parameter in effect.into_iter().flat_map(catalogue::fitted) {
            if !free.contains(&parameter) {
                free.push(parameter);
            }
        }
        Some(Self { values: *values, free })
    }
}

/// Returns the values without an effect.
pub fn without(values: &Values, effect: Option<Effect>) -> Values {
    let mut values = *values;
    for parameter in effect.into_iter().flat_map(Parameter::of) {
        values[parameter.place()] = parameter.row().neutral;
    }
    values
}

/// Returns the values with an effect of half the maximum strength in machines; `None` for the friction that every model has.
pub fn with_typical(record: &CableRecord<'_>, values: &Values, effect: Effect, duration_s: f64) -> Option<Values> {
    let lab = effects::of(effect)?;
    let around = catalogue::around(record, values[MU], 0.0);
    let mut sizing = Sizing {
        strength_ratio: STRENGTH_RATIO,
        mu: values[MU],
        tension_n: around.mean_tension_n,
        normal_n: NORMAL_PER_TENSION * around.mean_tension_n,
        duration_s,
        random: &mut ChaCha8Rng::seed_from_u64(0),
    };
    let mut values = *values;
    for (key, value) in (lab.typical)(&mut sizing) {
        let parameter = Parameter::of(effect).find(|parameter| parameter.row().key == key)?;
        values[parameter.place()] = value.clamp(parameter.row().min, parameter.row().max);
    }
    Some(values)
}

/// The log of a cable if a model is true, with buffers to fit other models to it.
pub struct Prediction<'a> {
    record: CableRecord<'a>,
    rows: Vec<Row>,
    references_n: Vec<f64>,
    stop: &'a AtomicBool,
}

impl<'a> Prediction<'a> {
    /// Creates the prediction. Returns `None` if the model gives non-finite forces.
    pub fn new(record: &CableRecord<'a>, truth: &Values, stop: &'a AtomicBool) -> Option<Self> {
        let (rows, references_n) = sensed(record, truth)?;
        Some(Self { record: *record, rows, references_n, stop })
    }

    /// Returns its cycles.
    pub fn record(&self) -> CableRecord<'_> {
        CableRecord { rows: &self.rows, references_n: &self.references_n, ..self.record }
    }

    /// Returns the model that comes nearest to the log with an effect in place of the true one; `None` if stopped or without a start. `also` is an
    /// additional start.
    pub fn fitted(
        &self,
        base: &Values,
        effect: Option<Effect>,
        noise_n: f64,
        also: Option<&Hypothesis>,
    ) -> Option<(Hypothesis, Trial)> {
        let record = self.record();
        let (blocks, counts) = (split(&record), vec![true; self.rows.len()]);
        let bench = Workbench { record, blocks: &blocks, counts: &counts, measured: &counts, stop: self.stop };
        let starts = match effect {
            Some(effect) => {
                let around = around(&bench, base, noise_n, effect);
                catalogue::starts(effect, base, &around, &bench.record)
            }
            None => vec![*base],
        };
        let mut models: Vec<Model> = Vec::new();
        for values in starts.iter().chain(also.map(|also| &also.values)) {
            let free = Hypothesis::new(record.params, effect, values)?.free;
            models.push(Model { values: *values, free });
        }
        let trials = bench.try_all(&models, NEAR_ERRORS).into_iter();
        let finite = trials.filter(|trial| trial.training.is_finite() && trial.held_out.is_finite());
        let squares = |trial: &Trial| trial.training + trial.held_out;
        let best = finite.min_by(|one, other| squares(one).total_cmp(&squares(other)))?;
        let hypothesis = Hypothesis { values: best.values, free: best.free.clone() };
        Some((hypothesis, best))
    }

    /// Returns the expected `ΔBIC` against a model that was fitted to this log, as the discovery computes it: over the half of the samples that it
    /// trains on, with noise of the standard deviation `noise_n`.
    pub fn evidence(&self, truth: &Hypothesis, fitted: &Trial, noise_n: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (0.5 * self.rows.len() as f64, fitted.free.len() as f64 - truth.free.len() as f64);
        // Training blocks and held-out blocks are half of the run each. Using both makes the result less dependent on their assignment.
        let squares_ratio = 1.0 + 0.5 * (fitted.training + fitted.held_out) / (count * noise_n * noise_n);
        delta_bic(count, squares_ratio, more)
    }
}

/// Returns the surroundings of a search; for a ripple they include the periods.
fn around(bench: &Workbench<'_>, current: &Values, noise_n: f64, effect: Effect) -> Around {
    let mut around = catalogue::around(&bench.record, current[MU], noise_n);
    if period_of(effect).is_some() {
        around.periods = periods(&bench.record, &bench.residuals_n(current));
    }
    around
}
