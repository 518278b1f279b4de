//! All cables with their samples, and the fit of a model of them to the wrench on the platform.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use fric_core::effects::Effect;
use nalgebra::{DMatrix, DVector, Matrix6, Vector6};

use super::geometry::{Description, Geometry};
use super::model::{Model, Unknown};
use crate::certainty::scores::Scores;
use crate::discover::effort::Effort;
use crate::fit::{CableRecord, Parameter};
use crate::replay::{Deviation, WrenchReference};
use crate::samples::noise::white_noise;
use crate::samples::split::{Block, used};
use crate::search::gram::Gram;
use crate::search::gram::inverse_of_normal;
use crate::search::optimizer::minimize;
use crate::search::pass::Forces;
use crate::search::problem::{Comparison, Loss, Member, Problem};
use crate::search::vector::Coordinate;

/// Standard deviations of a geometry's numbers as a fraction of their scale, and of the friction as a fraction of the given values. Each acts as one
/// additional deviation, so that a number keeps its given value if the samples do not determine it.
const GEOMETRY_RATIO: f64 = 0.1;
const FRICTION_RATIO: f64 = 1.0;

/// A fitted model.
#[derive(Clone, Debug)]
pub struct Trial {
    pub model: Model,
    /// Sum of the squared whitened deviations in each block.
    pub blocks: Vec<f64>,
    /// The same over the training blocks, and over the held-out blocks.
    pub training: f64,
    pub held_out: f64,
}

/// All cables with their samples.
#[derive(Clone, Debug)]
pub struct Bench<'a> {
    pub records: Vec<CableRecord<'a>>,
    pub description: Description<'a>,
    pub blocks: Vec<Block>,
    /// Whether a sample counts.
    pub counts: Vec<bool>,
    /// Whether the reference of a sample is measured instead of interpolated.
    pub measured: &'a [bool],
    /// Transforms deviations into uncorrelated numbers of variance 1.
    pub whitening: Matrix6<f64>,
    pub stop: &'a AtomicBool,
    /// The work of the search.
    pub effort: Arc<Effort>,
}

impl<'a> Bench<'a> {
    /// Returns which samples count and belong to the held-out blocks, or to the training blocks.
    pub fn used(&self, held_out: bool) -> Vec<bool> {
        used(&self.blocks, &self.counts, held_out)
    }

    /// Returns the number of these samples.
    pub fn count(&self, held_out: bool) -> usize {
        self.used(held_out).into_iter().filter(|used| *used).count()
    }

    /// Calls `run` with the problem of a model. There, parameters with one value for all cables are separate ones of each cable.
    pub fn with_problem<T>(&self, model: &Model, used: Vec<bool>, run: impl FnOnce(&Problem<'_>) -> T) -> T {
        let (structure, outside) = self.description.changed(&model.changes);
        let member = |(record, free): (&CableRecord<'a>, &Vec<Parameter>)| {
            let alike = model.alike.iter().filter(|of| !free.contains(of));
            Member { record: *record, free: free.iter().chain(alike).copied().collect() }
        };
        let problem = Problem {
            members: self.records.iter().zip(&model.free).map(member).collect(),
            comparison: Comparison::Wrench {
                structure: &structure,
                outside: &outside,
                whitening: Box::new(self.whitening),
            },
            loss: Loss::Squares,
            used,
            stop: self.stop,
            seat: None,
        };
        run(&problem)
    }

    /// Visits the six rows of every training sample: derivatives by the unknowns, then the deviation. Returns false if stopped.
    pub fn rows(&self, model: &Model, mut visit: impl FnMut(usize, &[Vec<f64>])) -> bool {
        let unknowns = model.unknowns();
        let column = |unknown: Unknown| unknowns.iter().position(|of| *of == unknown);
        let tangents = self.tangents(model);
        let first_tangent = unknowns.len() - tangents.len();
        self.with_problem(model, self.used(false), |problem| {
            let columns: Vec<Option<usize>> = problem
                .members
                .iter()
                .enumerate()
                .flat_map(|(cable, member)| member.free.iter().map(move |of| (cable, *of)))
                .map(|(cable, of)| column(Unknown::Own(cable, of)).or_else(|| column(Unknown::Alike(of))))
                .collect();
            let mut joint = vec![vec![0.0; unknowns.len() + 1]; 6];
            problem.visit(&model.values, true, |place, rows| {
                for ((component, row), joint) in rows.enumerate().zip(&mut joint) {
                    joint.fill(0.0);
                    let Some((deviation, derivatives)) = row.split_last() else { continue };
                    for (derivative, column) in derivatives.iter().zip(&columns) {
                        column.and_then(|column| joint.get_mut(column)).into_iter().for_each(|sum| *sum += derivative);
                    }
                    for (sum, tangent) in joint.iter_mut().skip(first_tangent).zip(&tangents) {
                        *sum = tangent.get(place).map_or(f64::NAN, |change| change[component]);
                    }
                    joint.last_mut().into_iter().for_each(|last| *last = *deviation);
                }
                visit(place, &joint);
            })
        })
    }

    /// Returns the whitened derivatives by the corrections of the robot file, in every sample.
    fn tangents(&self, model: &Model) -> Vec<Vec<Vector6<f64>>> {
        if model.changes.is_empty() {
            return Vec::new();
        }
        let forces = self.forces(model);
        let force_n = |place: usize, cable: usize| forces.get(cable).map_or(f64::NAN, |forces| forces.at(place).0);
        let of = |of: &Geometry| self.description.tangents(*of, &model.changes, force_n);
        let mut all: Vec<Vec<Vector6<f64>>> = model.changes.keys().flat_map(of).collect();
        all.iter_mut().flatten().for_each(|change| *change = self.whitening * *change);
        all
    }

    /// Returns the normal equations of a model over the training samples, and adds to `scores`; `None` if stopped.
    pub fn gram(&self, model: &Model, mut scores: Option<&mut Scores>) -> Option<Gram> {
        let unknowns = model.unknowns();
        let mut gram = Gram::new(unknowns.len());
        let mut score = vec![0.0; unknowns.len()];
        let completed = self.rows(model, |place, rows| {
            score.fill(0.0);
            for row in rows {
                gram.add(row);
                let Some((deviation, derivatives)) = row.split_last() else { continue };
                score.iter_mut().zip(derivatives).for_each(|(sum, derivative)| *sum += derivative * deviation);
            }
            if let Some(scores) = scores.as_deref_mut() {
                scores.add_of(place, &score);
            }
        });
        for (place, unknown) in unknowns.iter().enumerate() {
            let Some((given, scale)) = self.expected(unknown) else { continue };
            let mut row = vec![0.0; unknowns.len() + 1];
            row.iter_mut().skip(place).take(1).for_each(|entry| *entry = scale.recip());
            row.last_mut().into_iter().for_each(|last| *last = (model.number(unknown) - given) / scale);
            gram.add(&row);
        }
        completed.then_some(gram)
    }

    /// Returns the prior mean and standard deviation of a number; `None` for parameters of effects.
    fn expected(&self, unknown: &Unknown) -> Option<(f64, f64)> {
        match unknown {
            // Of a tensor a log with few axes of rotation shows a part, and a narrow prior would pass for knowledge of the rest.
            Unknown::Geometry(of @ Geometry::Inertia, _) => Some((0.0, self.description.size(*of))),
            Unknown::Geometry(of, _) => Some((0.0, GEOMETRY_RATIO * self.description.size(*of))),
            Unknown::Own(cable, of) if of.effect().is_none() => {
                let given = self.records.get(*cable)?.params.values()[of.place()];
                Some((given, FRICTION_RATIO * given.abs())).filter(|(_, scale)| *scale > 0.0)
            }
            Unknown::Own(..) | Unknown::Alike(_) => None,
        }
    }

    /// Fits a model to the training samples, to within `near_errors` standard errors of its minimum.
    pub fn fit(&self, model: &Model, near_errors: f64) -> Trial {
        let unknowns = model.unknowns();
        let cycle_s = self.records.first().map_or(f64::NAN, |record| record.cycle_s);
        let coordinate = |unknown: &Unknown| match unknown {
            Unknown::Own(_, of) | Unknown::Alike(of) => Coordinate::of(of, cycle_s),
            Unknown::Geometry(..) => Coordinate::UNBOUNDED,
        };
        let coordinates: Vec<Coordinate> = unknowns.iter().map(coordinate).collect();
        let start: Vec<f64> = unknowns.iter().map(|unknown| model.number(unknown)).collect();
        let minimum = minimize(&coordinates, &start, 6 * self.count(false), near_errors, |numbers| {
            self.gram(&model.moved(numbers), None).map(|gram| gram.normal_equations())
        });
        self.effort.add(minimum.evaluation_count);
        self.judged(model.moved(&minimum.values))
    }

    /// Returns the model with the friction of the robot file as the start values of a fit.
    pub fn with_given_friction(&self, model: &Model) -> Model {
        let mut model = model.clone();
        for ((values, free), record) in model.values.iter_mut().zip(&model.free).zip(&self.records) {
            let given = record.params.values();
            for of in free.iter().filter(|of| of.effect().is_none()) {
                values[of.place()] = given[of.place()];
            }
        }
        model
    }

    /// Returns the square of the unit in which models are compared. By the weight alone, all noise is that of the sensors, and sensor gains scale it
    /// with the forces. The unit undoes this scaling, which explains nothing.
    pub fn unit_square(&self, model: &Model) -> f64 {
        let gain = Effect::SensorGain.places().start;
        let (sum, count) = model.values.iter().fold((0.0, 0.0), |(sum, count), of| (sum + of[gain].ln(), count + 1.0));
        if self.description.reference == WrenchReference::Mass { (2.0 * sum / count).exp() } else { 1.0 }
    }

    /// Returns a model with its sums of squares.
    pub fn judged(&self, model: Model) -> Trial {
        let deviations = self.deviations(&model);
        let unit_square = self.unit_square(&model);
        let of_block = |block: &Block| -> f64 {
            let of_block = deviations.get(block.cycles.clone()).unwrap_or_default();
            unit_square * of_block.iter().map(Vector6::norm_squared).filter(|square| square.is_finite()).sum::<f64>()
        };
        let blocks: Vec<f64> = self.blocks.iter().map(of_block).collect();
        let sum = |held_out: bool| {
            let of = self.blocks.iter().zip(&blocks).filter(|(block, _)| block.held_out == held_out);
            of.map(|(_, squares)| squares).sum()
        };
        Trial { training: sum(false), held_out: sum(true), blocks, model }
    }

    /// Returns the whitened deviations of every sample; NaN if it does not count.
    pub fn deviations(&self, model: &Model) -> Vec<Vector6<f64>> {
        let mut all = vec![Vector6::repeat(f64::NAN); self.counts.len()];
        self.with_problem(model, self.counts.clone(), |problem| {
            problem.residuals(&model.values, |place, of_sample| {
                if let (Some(deviation), true) = (all.get_mut(place), of_sample.len() == 6) {
                    *deviation = Vector6::from_row_slice(of_sample);
                }
            });
        });
        all
    }

    /// Returns the standard deviation of the white noise in each component of a model's deviations; `None` if there are too few.
    pub fn noise(&self, model: &Model) -> Option<[f64; 6]> {
        let deviations = self.deviations(model);
        let mut noise = [0.0; 6];
        for (component, noise) in noise.iter_mut().enumerate() {
            *noise = self.white_noise(deviations.iter().map(|deviation| deviation[component]))?;
        }
        Some(noise)
    }

    /// Returns the standard deviation of the white noise in a series with one number per sample, NaN if the sample does not count; `None` if there are
    /// too few. Samples with an interpolated reference are included if they are the majority: they have the full noise of the sensors and hardly any of
    /// the reference.
    pub fn white_noise(&self, numbers: impl Iterator<Item = f64>) -> Option<f64> {
        let all: Vec<(f64, bool)> = numbers.zip(self.measured.iter().copied()).collect();
        let count =
            |wanted: bool| all.iter().filter(|(number, measured)| number.is_finite() && *measured == wanted).count();
        let (by_measurement, between) = (count(true), count(false));
        let taken = all.into_iter().filter(|(_, measured)| *measured || between > by_measurement);
        white_noise(&taken.map(|(number, _)| number).collect::<Vec<f64>>())
    }

    /// Returns the mean squared whitened deviation if the forces of these cables have errors of this fraction of their tensions that add up.
    pub fn believed_square(&self, model: &Model, ratio: f64, cables: Range<usize>) -> f64 {
        let (structure, _) = self.description.changed(&model.changes);
        let records = self.records.get(cables.clone()).unwrap_or_default();
        let (mut sum, mut count) = (0.0, 0.0);
        for place in (0..self.counts.len()).filter(|place| self.counts[*place]) {
            let columns = structure.iter().skip(place * self.records.len() + cables.start);
            let error = |(record, column): (&CableRecord<'_>, &Vector6<f64>)| {
                (self.whitening * column).abs() * (ratio * record.frictionless_n(place)).abs()
            };
            sum += records.iter().zip(columns).map(error).sum::<Vector6<f64>>().norm_squared();
            count += 1.0;
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// Returns the error of one cable's force that alone comes nearest to the deviation of each sample, N.
    pub fn of_cable_n(&self, model: &Model, deviations: &[Vector6<f64>], cable: usize) -> Vec<f64> {
        let (structure, _) = self.description.changed(&model.changes);
        let columns = structure.iter().skip(cable).step_by(self.records.len());
        let nearest = |(column, deviation): (&Vector6<f64>, &Vector6<f64>)| {
            let lever = self.whitening * column;
            lever.dot(deviation) / lever.norm_squared()
        };
        columns.zip(deviations).map(nearest).collect()
    }

    /// Returns the force of one cable that the wrench shows in each sample beside the forces of the others by a model: the one that comes nearest to it. The
    /// model of the cable itself has no part in it.
    pub fn shown_by_others_n(&self, model: &Model, cable: usize) -> Vec<f64> {
        let errors_n = self.of_cable_n(model, &self.deviations(model), cable);
        let forces = self.forces(model);
        let force_n = |place: usize| forces.get(cable).map_or(f64::NAN, |forces| forces.at(place).0);
        errors_n.iter().enumerate().map(|(place, error_n)| force_n(place) - error_n).collect()
    }

    fn forces(&self, model: &Model) -> Vec<Arc<Forces>> {
        self.with_problem(model, Vec::new(), |problem| problem.forces(&model.values)).unwrap_or_default()
    }

    /// Returns the root mean square of the wrench's error, six components, if the force of every cable is off by `ratio` of itself and by its `wander_n`, N,
    /// independently of each other.
    pub fn believed_wrench(&self, model: &Model, ratio: f64, wander_n: &[f64]) -> [f64; 6] {
        let (structure, _) = self.description.changed(&model.changes);
        let count = self.records.len();
        let (mut squares, mut samples) = (Vector6::<f64>::zeros(), 0.0);
        for (place, _) in self.counts.iter().enumerate().filter(|(_, counts)| **counts) {
            let columns = structure.iter().skip(place * count).take(count);
            let mut of_sample = Vector6::zeros();
            for ((column, record), wander_n) in columns.zip(&self.records).zip(wander_n) {
                let error_n = (ratio * record.frictionless_n(place)).hypot(*wander_n);
                let of_cable = self.whitening * column * error_n;
                of_sample += of_cable.component_mul(&of_cable);
            }
            if of_sample.iter().all(|square| square.is_finite()) {
                squares += of_sample;
                samples += 1.0;
            }
        }
        (squares / samples).map(f64::sqrt).into()
    }

    /// Returns the root mean square of [`of_cable_n`](Self::of_cable_n) if the force of each cable has an independent error of this fraction of its
    /// tension, N.
    pub fn believed_n(&self, model: &Model, cable: usize, ratio: f64) -> f64 {
        let (structure, _) = self.description.changed(&model.changes);
        let count = self.records.len();
        let of_sample = |place: usize| {
            let levers: Vec<Vector6<f64>> =
                structure.iter().skip(place * count).take(count).map(|column| self.whitening * column).collect();
            let own = levers.get(cable)?;
            let error = |(lever, record): (&Vector6<f64>, &CableRecord<'_>)| {
                (ratio * record.frictionless_n(place) * own.dot(lever)).powi(2)
            };
            Some(levers.iter().zip(&self.records).map(error).sum::<f64>().sqrt() / own.norm_squared())
        };
        let used = self.counts.iter().enumerate().filter(|(_, counts)| **counts);
        let mut errors = Deviation::default();
        used.filter_map(|(place, _)| of_sample(place)).for_each(|error_n| errors.add(error_n));
        errors.rms().unwrap_or(0.0)
    }

    /// Returns the covariance of a model's unknowns at its minimum: with the correlation of the deviations over time, and as if they were independent.
    pub fn covariances(&self, model: &Model) -> Option<[DMatrix<f64>; 2]> {
        let mut scores = Scores::new(model.unknowns().len());
        let (matrix, _, squares) = self.gram(model, Some(&mut scores))?.normal_equations();
        let inverse = inverse_of_normal(&matrix)?;
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let variance = squares / (6.0 * self.count(false) as f64);
        // What is expected is an observation as well; without it, a number that nothing else determines would have no error at all.
        let information = |unknown: &Unknown| self.expected(unknown).map_or(0.0, |(_, scale)| scale.powi(-2));
        let expected = DVector::from_iterator(matrix.nrows(), model.unknowns().iter().map(information));
        let of_expected = &inverse * DMatrix::from_diagonal(&expected) * &inverse;
        Some([scores.covariance(&inverse) + of_expected, inverse * variance])
    }
}
