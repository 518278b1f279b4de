//! Models tried on one cable: fitted to the samples learned from, judged on those held out.

use std::panic::resume_unwind;
use std::rc::Rc;
use std::sync::atomic::AtomicBool;
use std::thread;

use fric_core::LANES;
use fric_core::parameters::{OFFSET, Values};
use nalgebra::DVector;
use rayon::prelude::*;

use crate::certainty::undetermined::inverse_of_normal;
use crate::fit::{CableRecord, Parameter, Row};
use crate::samples::split::Block;
use crate::search::gang::{Gang, Seat};
use crate::search::problem::{Comparison, Loss, Member, Problem};
use crate::search::solve::search_near;

/// A model is judged this near to its minimum, in standard errors: the sum of squares changes by less than noise does.
pub const NEAR_ERRORS: f64 = 0.5;

/// A model to try: where its search starts, and what it varies.
#[derive(Clone, Debug)]
pub struct Model {
    /// Start values.
    pub values: Values,
    /// What is varied.
    pub free: Vec<Parameter>,
}

/// A model that was fitted.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Fitted values.
    pub values: Values,
    /// What was varied.
    pub free: Vec<Parameter>,
    /// Sum of squares of the residuals over the samples learned from, N².
    pub training: f64,
    /// And over those held out.
    pub held_out: f64,
    /// How near to its minimum the search came, in standard errors.
    pub near_errors: f64,
}

impl Trial {
    /// The model, to be searched on from here.
    pub fn model(&self) -> Model {
        Model { values: self.values, free: self.free.clone() }
    }
}

/// One cable with its samples.
#[derive(Clone, Debug)]
pub struct Workbench<'a> {
    /// Its cycles; the reference is cleaned of what is no matter of friction.
    pub record: CableRecord<'a>,
    /// Blocks of the log.
    pub blocks: &'a [Block],
    /// Which samples count.
    pub counts: &'a [bool],
    /// Which have a reference of their own, rather than one between two measurements.
    pub measured: &'a [bool],
    /// Set to end every search.
    pub stop: &'a AtomicBool,
}

impl<'a> Workbench<'a> {
    /// Samples that count and are learned from, or held out.
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

    /// How many samples are held out, or learned from.
    pub fn count(&self, held_out: bool) -> usize {
        self.used(held_out).into_iter().filter(|used| *used).count()
    }

    /// Standard deviation of the reference over the samples held out, N; NaN without any.
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

    /// Whether the reference tells more loads than one, with noise of this standard deviation. If not, a sensor agrees with it best that shows this load
    /// whatever the force is: nothing is known of the sensor's curve, and a gain is another word for an offset.
    pub fn knows_load(&self, noise_n: f64) -> bool {
        self.reference_variation_n() > noise_n
    }

    /// The least-squares problem over the samples learned from.
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

    /// Fits several models, as many side by side as there are lanes, each as near to its minimum as asked for, in standard errors; in
    /// the order given.
    pub fn try_all(&self, models: &[Model], near_errors: f64) -> Vec<Trial> {
        let together = |models: &[Model]| self.try_together(models, near_errors);
        let groups: Vec<Vec<Trial>> = models.par_chunks(LANES).map(together).collect();
        groups.into_iter().flatten().collect()
    }

    /// Fits one model.
    pub fn try_one(&self, model: &Model) -> Trial {
        self.fit(model, NEAR_ERRORS)
    }

    /// Fits one model as near to its minimum as asked for, in standard errors.
    pub fn fit(&self, model: &Model, near_errors: f64) -> Trial {
        let gang = Gang::new(1, self.stop);
        self.try_on(model, gang.seat(0), near_errors)
    }

    fn try_together(&self, models: &[Model], near_errors: f64) -> Vec<Trial> {
        let gang = Gang::new(models.len(), self.stop);
        thread::scope(|scope| {
            let searches: Vec<_> = models
                .iter()
                .enumerate()
                .map(|(place, model)| {
                    let seat = gang.seat(place);
                    scope.spawn(|| self.try_on(model, seat, near_errors))
                })
                .collect();
            searches.into_iter().map(|search| search.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
        })
    }

    fn try_on<'b>(&'b self, model: &Model, seat: Seat<'b>, near_errors: f64) -> Trial
    where
        'a: 'b,
    {
        let bench: &Workbench<'b> = self;
        let mut problem = bench.problem(&model.free, Some(Rc::new(seat)));
        let mut values = model.values;
        if !model.free.is_empty() {
            let start = within_bounds(&mut problem, &model.values);
            let (found, _) = search_near(&problem, &[start], self.record.cycle_s, near_errors);
            values = found.first().copied().unwrap_or(values);
        }
        let residuals_n = bench.residuals_with(&problem, &values);
        let sum = |held_out: bool| {
            let blocks = self.blocks.iter().filter(|block| block.held_out == held_out);
            let of_blocks = blocks.flat_map(|block| residuals_n.get(block.cycles.clone()).unwrap_or_default());
            of_blocks.filter(|number| number.is_finite()).map(|number| number * number).sum()
        };
        let (training, held_out) = (sum(false), sum(true));
        Trial { values, free: model.free.clone(), training, held_out, near_errors }
    }

    /// Force of the model less the reference in each cycle, N; NaN where a sample does not count.
    pub fn residuals_n(&self, values: &Values) -> Vec<f64> {
        self.residuals_with(&self.problem(&[], None), values)
    }

    /// What the model adds to the force that the sensor shows, as if nothing rubbed, in each cycle, N.
    pub fn added_n(&self, values: &Values) -> Vec<f64> {
        let forces = self.problem(&[], None).forces(&[*values]).unwrap_or_default();
        let gain = self.record.params.frictionless_gain();
        let added_n = |(cycle, row): (usize, &Row)| {
            let force_n = forces.first().map_or(f64::NAN, |forces| forces.at(cycle).0);
            force_n - values[OFFSET] - row.signals.sensor_force_n * gain
        };
        self.record.rows.iter().enumerate().map(added_n).collect()
    }

    /// Those of them with a reference of their own: of a series of measurements, with its gaps.
    pub fn measured_of(&self, residual_n: &[f64]) -> Vec<f64> {
        residual_n.iter().zip(self.measured).filter(|(_, measured)| **measured).map(|(number, _)| *number).collect()
    }

    fn residuals_with(&self, problem: &Problem<'_>, values: &Values) -> Vec<f64> {
        let forces = problem.forces(&[*values]).unwrap_or_default();
        let force_n = |cycle: usize| forces.first().map_or(f64::NAN, |forces| forces.at(cycle).0);
        let rows = self.record.rows.iter().zip(self.counts).enumerate();
        rows.map(|(cycle, (row, counts))| if *counts { force_n(cycle) - row.reference_n } else { f64::NAN }).collect()
    }
}

/// Takes parameters away from the least values they can have, where the coordinates of a search have no slope: to the minimum, were the
/// forces linear in all that varies. Those for which that is out of range stay where they are.
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
