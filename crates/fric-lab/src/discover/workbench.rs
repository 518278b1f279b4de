//! Fits trial models of one cable to the training samples and judges them on the held-out samples.

use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use fric_core::parameters::{OFFSET, Values};
use nalgebra::DVector;
use rayon::prelude::*;

use crate::certainty::one_load::BesideMotion;
use crate::fit::{CableRecord, Parameter};
use crate::samples::record::PerLog;
use crate::samples::split::{Block, used};
use crate::search::gang::{Gang, Seat};
use crate::search::gram::inverse_of_normal;
use crate::search::pass::{Forces, Part};
use crate::search::problem::{Comparison, Loss, Member, Problem};
use crate::search::solve::search_near;
use crate::search::stream::Stream;

/// Distance from its minimum at which a model is judged, in standard errors: the sum of squares then changes by less than noise does.
pub const NEAR_ERRORS: f64 = 0.5;

/// Models are tried side by side while their forces and derivatives take up at most this, bytes: six minutes at 1 kHz with eight parameters on any number
/// of cores up to ten, and an hour's one by one. A log of a minute is never held up.
const FORCES_BYTES: usize = 256 << 20;

/// A model to try: start values and free parameters.
#[derive(Clone, Debug)]
pub struct Model {
    /// Start values.
    pub values: Values,
    /// The free parameters.
    pub free: Vec<Parameter>,
}

/// A model that was fitted.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Fitted values.
    pub values: Values,
    /// The free parameters.
    pub free: Vec<Parameter>,
    /// Training sum of squares of the residuals, N².
    pub training: f64,
    /// Held-out sum of squares of the residuals, N².
    pub held_out: f64,
    /// Held-out sum of squares of what the model adds to the force that the sensor implies without friction, N².
    pub added: f64,
    /// Distance from its minimum at the end of the search, in standard errors.
    pub near_errors: f64,
    /// Number of evaluations of the model that the search took.
    pub evaluation_count: usize,
}

impl Trial {
    /// Returns the model, for a search that continues from here.
    pub fn model(&self) -> Model {
        Model { values: self.values, free: self.free.clone() }
    }
}

/// One cable with its samples.
#[derive(Clone, Debug)]
pub struct Workbench<'a> {
    /// The cable's cycles, with a reference from which hum and faults were removed.
    pub record: CableRecord<'a>,
    /// The blocks of the log.
    pub blocks: &'a [Block],
    /// Which samples count.
    pub counts: &'a [bool],
    /// Which samples have a measured reference instead of one interpolated between two measurements.
    pub measured: &'a [bool],
    /// Flag that ends every search when set.
    pub stop: &'a AtomicBool,
}

impl<'a> Workbench<'a> {
    /// Returns the samples that count and are held out, or are used for training.
    pub fn used(&self, held_out: bool) -> Vec<bool> {
        used(self.blocks, self.counts, held_out)
    }

    /// Returns the number of held-out samples, or of training samples.
    pub fn count(&self, held_out: bool) -> usize {
        self.used(held_out).into_iter().filter(|used| *used).count()
    }

    /// Whether a zero is free beside these parameters, of the recording or of each log.
    pub fn has_zero(&self, free: &[Parameter]) -> bool {
        free.iter().any(|parameter| parameter.place() == OFFSET) || self.record.per_log.is_some()
    }

    /// Returns the standard deviation of the reference over the held-out samples, N; NaN if there are none.
    pub fn reference_variation_n(&self) -> f64 {
        let used = self.used(true);
        let known_n =
            self.record.references_n.iter().zip(&used).filter(|(_, used)| **used).map(|(known_n, _)| *known_n);
        let mean = |numbers: &mut dyn Iterator<Item = f64>| {
            let (sum, count) = numbers.fold((0.0, 0.0), |(sum, count), number| (sum + number, count + 1.0));
            sum / count
        };
        let middle_n = mean(&mut known_n.clone());
        mean(&mut known_n.map(|force_n| (force_n - middle_n).powi(2))).sqrt()
    }

    /// Whether the log contains more than one load, given the standard deviation of the noise. With one load only, a sensor that shows this load whatever
    /// the force agrees best. The sensor's curve is then unknown, and a gain is equivalent to an offset. What goes with the direction and the speed of the
    /// motion may be friction and is no other load. What is left, in the reference and in the sensor, must exceed the noise and, because no friction model is
    /// exact, the friction: the part of the difference of the two that goes with the motion. In simulated logs under varying load it is 1.3 to 4 times that.
    pub fn knows_load(&self, noise_n: f64) -> bool {
        let shown_n = |cycle| self.record.frictionless_n(cycle);
        BesideMotion::of(&self.record, &self.used(true), shown_n).is_some_and(|left| {
            let least = left.of_motion.max(left.count * noise_n * noise_n);
            left.force > least && left.reference > least
        })
    }

    /// Returns the least-squares problem over the training samples.
    pub fn problem(&self, free: &[Parameter], seat: Option<Rc<Seat<'a>>>) -> Problem<'a> {
        Problem {
            members: vec![Member { record: self.record, free: free.to_vec() }],
            comparison: Comparison::Forces,
            loss: Loss::Squares,
            used: self.used(false),
            stop: self.stop,
            seat,
        }
    }

    /// Fits several models, each to the given distance from its minimum in standard errors, as many at once as memory allows. Returns the trials in the
    /// given order.
    pub fn try_all(&self, models: &[Model], near_errors: f64) -> Vec<Trial> {
        let free_count = models.iter().map(|model| model.free.len()).max().unwrap_or(0);
        let bytes = self.record.rows.len() * (free_count + 1) * size_of::<f64>();
        let together = models.chunks((FORCES_BYTES / bytes.max(1)).max(1));
        together
            .flat_map(|models| models.par_iter().map(|model| self.fit(model, near_errors)).collect::<Vec<_>>())
            .collect()
    }

    /// Fits one model.
    pub fn try_one(&self, model: &Model) -> Trial {
        self.fit(model, NEAR_ERRORS)
    }

    /// Fits one model to the given distance from its minimum, in standard errors.
    pub fn fit(&self, model: &Model, near_errors: f64) -> Trial {
        let gang = Gang::new(1, self.stop);
        let bench: &Workbench<'_> = self;
        let mut problem = bench.problem(&model.free, Some(Rc::new(gang.seat(0))));
        let (mut values, mut evaluation_count) = (model.values, 0);
        if !model.free.is_empty() {
            let start = within_bounds(&mut problem, &model.values);
            let (found, minimum) = search_near(&problem, &[start], self.record.cycle_s, near_errors);
            values = found.first().copied().unwrap_or(values);
            evaluation_count = minimum.evaluation_count;
        }
        let found = bench.evaluated_with(&problem, &values);
        let left_n = |cycle: usize| found.residual_n(cycle);
        let gain = self.record.params.frictionless_gain();
        let added_n = |cycle: usize| {
            let Some(row) = self.record.rows.get(cycle) else { return f64::NAN };
            let left_n = found.residual_n(cycle);
            // Zeros of the logs are no part of what the model adds.
            match &found.zero_shifts_n {
                Some(_) if left_n.is_finite() => found.added_n(cycle),
                Some(_) => f64::NAN,
                None => {
                    left_n + (self.record.reference_n(cycle) - (row.signals.sensor_force_n * gain + values[OFFSET]))
                }
            }
        };
        let squares = |held_out: bool, number: &dyn Fn(usize) -> f64| -> f64 {
            let blocks = self.blocks.iter().filter(|block| block.held_out == held_out);
            let numbers = blocks.flat_map(|block| block.cycles.clone()).map(number);
            numbers.filter(|number| number.is_finite()).map(|number| number * number).sum()
        };
        Trial {
            values,
            free: model.free.clone(),
            training: squares(false, &left_n),
            held_out: squares(true, &left_n),
            added: squares(true, &added_n),
            near_errors,
            evaluation_count,
        }
    }

    /// Returns the force of the model minus the reference in each cycle, N; NaN where a sample does not count. Where each log has a zero of its own, the
    /// training samples of a log determine it.
    pub fn residuals_n(&self, values: &Values) -> Vec<f64> {
        self.evaluated(values).residuals_n().collect()
    }

    /// Evaluates a model in each cycle.
    pub fn evaluated(&self, values: &Values) -> Evaluated<'_, 'a> {
        self.evaluated_with(&self.problem(&[], None), values)
    }

    /// Returns the residuals of several models, to be computed along with the log.
    pub fn residual_streams(&self, models: &[Values]) -> ResidualStreams<'_, 'a> {
        let member = Member { record: self.record, free: Vec::new() };
        let problem = self.problem(&[], None);
        ResidualStreams {
            bench: self,
            parts: models.iter().map(|values| member.part(values, true)).collect(),
            zero_changes_n: models.iter().map(|values| problem.zero_changes_n(values)).collect(),
        }
    }

    fn evaluated_with(&self, problem: &Problem<'_>, values: &Values) -> Evaluated<'_, 'a> {
        Evaluated {
            bench: self,
            offset_n: values[OFFSET],
            forces: problem.forces(&[*values]).and_then(|mut forces| forces.pop()).unwrap_or_default(),
            zero_shifts_n: problem.zero_shifts_n(values),
        }
    }

    /// Returns the residuals with a measured reference, as a series with its gaps.
    pub fn measured_of(&self, residual_n: &[f64]) -> Vec<f64> {
        residual_n.iter().zip(self.measured).filter(|(_, measured)| **measured).map(|(number, _)| *number).collect()
    }
}

/// A model of one cable in each cycle.
pub struct Evaluated<'b, 'a> {
    bench: &'b Workbench<'a>,
    offset_n: f64,
    forces: Arc<Forces>,
    zero_shifts_n: Option<Vec<f64>>,
}

impl Evaluated<'_, '_> {
    /// Returns the force of the model minus the reference in a cycle, N; NaN where the sample does not count. See [`Workbench::residuals_n`].
    pub fn residual_n(&self, cycle: usize) -> f64 {
        if self.bench.counts.get(cycle) != Some(&true) {
            return f64::NAN;
        }
        let shift_n = self.zero_shifts_n.as_ref().and_then(|of| of.get(cycle)).copied().unwrap_or(0.0);
        self.forces.at(cycle).0 - self.bench.record.reference_n(cycle) + shift_n
    }

    /// Returns the same of each cycle.
    pub fn residuals_n(&self) -> impl Iterator<Item = f64> {
        (0..self.bench.record.rows.len()).map(|cycle| self.residual_n(cycle))
    }

    /// Returns what the model adds in a cycle to the force that the sensor implies without friction, N. Zeros of the logs are no part of it.
    pub fn added_n(&self, cycle: usize) -> f64 {
        let Some(row) = self.bench.record.rows.get(cycle) else { return f64::NAN };
        let gain = self.bench.record.params.frictionless_gain();
        self.forces.at(cycle).0 - self.offset_n - row.signals.sensor_force_n * gain
    }
}

/// The residuals of several models of one cable. They come along with the log, because series of many models would take up more memory than the log.
pub struct ResidualStreams<'b, 'a> {
    bench: &'b Workbench<'a>,
    parts: Vec<Part<'a>>,
    /// Of each model, the changes of the zeros of the logs.
    zero_changes_n: Vec<Vec<Option<f64>>>,
}

impl ResidualStreams<'_, '_> {
    /// Starts at the first cycle. Returns a function that appends the residual of each model in a cycle, N: see [`Workbench::residuals_n`]. Cycles must
    /// ascend.
    pub fn start(&self) -> impl FnMut(usize, &mut Vec<f64>) {
        let record = &self.bench.record;
        let mut stream = Stream::new(self.parts.clone());
        move |cycle, residuals_n| {
            stream.advance_to(cycle);
            let counts = self.bench.counts.get(cycle) == Some(&true);
            let reference_n = if counts { record.reference_n(cycle) } else { f64::NAN };
            residuals_n.extend(self.zero_changes_n.iter().enumerate().map(|(model, changes_n)| {
                let (force_n, derivatives) = stream.at(model, cycle);
                let shift_n = if let Some(PerLog { zero, .. }) = record.per_log {
                    let change_n = changes_n.get(record.log_index(cycle)).copied().flatten().unwrap_or(0.0);
                    zero.lever(derivatives) * change_n
                } else {
                    0.0
                };
                force_n - reference_n + shift_n
            }));
        }
    }
}

/// Moves parameters away from lower bounds at which the search coordinates have zero slope: to the minimum of the problem linearised in all free
/// parameters. Parameters whose minimum is out of range stay where they are.
fn within_bounds(problem: &mut Problem<'_>, values: &Values) -> Values {
    let Some(free) = problem.members.first().map(|member| member.free.clone()) else { return *values };
    let is_least = |parameter: &Parameter| values[parameter.place()] <= parameter.row().min;
    if !free.iter().any(is_least) {
        return *values;
    }
    let step = problem.gram(&[*values]).and_then(|gram| {
        let (matrix, gradient, _) = gram.normal_equations();
        Some(inverse_of_normal(&matrix)? * gradient)
    });
    let step = step.unwrap_or_else(|| DVector::zeros(free.len()));
    let mut start = *values;
    for (parameter, step) in free.iter().zip(&step).filter(|(parameter, _)| is_least(parameter)) {
        start[parameter.place()] = (values[parameter.place()] - step).clamp(parameter.row().min, parameter.row().max);
    }
    for member in &mut problem.members {
        member.free.retain(|parameter| start[parameter.place()] > parameter.row().min);
    }
    start
}
