//! Fits trial models of one cable to the training samples and judges them on the held-out samples.

use std::rc::Rc;
use std::sync::atomic::AtomicBool;

use fric_core::parameters::{OFFSET, Values};
use nalgebra::DVector;
use rayon::prelude::*;

use crate::certainty::undetermined::inverse_of_normal;
use crate::fit::{CableRecord, Parameter, Row};
use crate::samples::split::Block;
use crate::search::gang::{Gang, Seat};
use crate::search::problem::{Comparison, Loss, Member, Problem};
use crate::search::solve::search_near;

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
        let mut used = vec![false; self.counts.len()];
        for block in self.blocks.iter().filter(|block| block.held_out == held_out) {
            let (Some(used), Some(counts)) =
                (used.get_mut(block.cycles.clone()), self.counts.get(block.cycles.clone()))
            else {
                continue;
            };
            used.copy_from_slice(counts);
        }
        used
    }

    /// Returns the number of held-out samples, or of training samples.
    pub fn count(&self, held_out: bool) -> usize {
        self.used(held_out).into_iter().filter(|used| *used).count()
    }

    /// Returns the standard deviation of the reference over the held-out samples, N; NaN if there are none.
    pub fn reference_variation_n(&self) -> f64 {
        let used = self.used(true);
        let rows = self.record.rows.iter().zip(&used).filter(|(_, used)| **used);
        let known_n = rows.map(|(row, _)| row.reference_n);
        let mean = |numbers: &mut dyn Iterator<Item = f64>| {
            let (sum, count) = numbers.fold((0.0, 0.0), |(sum, count), number| (sum + number, count + 1.0));
            sum / count
        };
        let middle_n = mean(&mut known_n.clone());
        mean(&mut known_n.map(|force_n| (force_n - middle_n).powi(2))).sqrt()
    }

    /// Whether the reference contains more than one load, given the standard deviation of the noise. With one load only, a sensor that shows this
    /// load whatever the force agrees best. The sensor's curve is then unknown, and a gain is equivalent to an offset.
    pub fn knows_load(&self, noise_n: f64) -> bool {
        self.reference_variation_n() > noise_n
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
        let residuals_n = bench.residuals_with(&problem, &values);
        let left_n = |cycle: usize| residuals_n.get(cycle).copied().unwrap_or(f64::NAN);
        let gain = self.record.params.frictionless_gain();
        let added_n = |cycle: usize| {
            let frictionless_n = |row: &Row| row.signals.sensor_force_n * gain + values[OFFSET];
            let row = self.record.rows.get(cycle);
            left_n(cycle) + row.map_or(f64::NAN, |row| row.reference_n - frictionless_n(row))
        };
        // Zeros of the logs are no part of what the model adds.
        let without_zeros_n = problem.per_log().map(|_| bench.added_with(&problem, &values));
        let added_n = |cycle: usize| match &without_zeros_n {
            Some(added_n) if left_n(cycle).is_finite() => added_n.get(cycle).copied().unwrap_or(f64::NAN),
            Some(_) => f64::NAN,
            None => added_n(cycle),
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
        self.residuals_with(&self.problem(&[], None), values)
    }

    /// Returns what the model adds in each cycle to the force that the sensor implies without friction, N.
    pub fn added_n(&self, values: &Values) -> Vec<f64> {
        self.added_with(&self.problem(&[], None), values)
    }

    fn added_with(&self, problem: &Problem<'_>, values: &Values) -> Vec<f64> {
        let forces = problem.forces(&[*values]).unwrap_or_default();
        let gain = self.record.params.frictionless_gain();
        let added_n = |(cycle, row): (usize, &Row)| {
            let force_n = forces.first().map_or(f64::NAN, |forces| forces.at(cycle).0);
            force_n - values[OFFSET] - row.signals.sensor_force_n * gain
        };
        self.record.rows.iter().enumerate().map(added_n).collect()
    }

    /// Returns the residuals with a measured reference, as a series with its gaps.
    pub fn measured_of(&self, residual_n: &[f64]) -> Vec<f64> {
        residual_n.iter().zip(self.measured).filter(|(_, measured)| **measured).map(|(number, _)| *number).collect()
    }

    fn residuals_with(&self, problem: &Problem<'_>, values: &Values) -> Vec<f64> {
        let forces = problem.forces(&[*values]).unwrap_or_default();
        let force_n = |cycle: usize| forces.first().map_or(f64::NAN, |forces| forces.at(cycle).0);
        let by_zeros_n = problem.zero_shifts_n(values);
        let shift_n = |cycle: usize| by_zeros_n.as_ref().and_then(|of| of.get(cycle)).copied().unwrap_or(0.0);
        let left_n = |cycle: usize, row: &Row| force_n(cycle) - row.reference_n + shift_n(cycle);
        let rows = self.record.rows.iter().zip(self.counts).enumerate();
        rows.map(|(cycle, (row, counts))| if *counts { left_n(cycle, row) } else { f64::NAN }).collect()
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
