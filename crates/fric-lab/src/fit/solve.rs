//! From a problem and a start to values with their covariance: search, outliers, what is not determined.

use fric_core::parameters::Values;
use nalgebra::DMatrix;

use super::determined::Yardstick;
use super::gram::{Gram, Triangle};
use super::optimizer::{self, Minimum, Termination};
use super::pass;
use super::problem::{Loss, Member, Problem};
use super::selection::Standing;
use super::vector::{Coordinate, Parameter, with};
use crate::replay::Deviation;

/// Deviations beyond this many standard deviations are no measurements.
const OUTLIER_RATIO: f64 = 8.0;
/// More outliers than this share of the samples are no outliers: the model does not describe them.
const MOST_OUTLIERS_RATIO: f64 = 0.02;
/// Huber's bound in standard deviations: 95 % efficient for normal noise.
const HUBER_RATIO: f64 = 1.345;
/// Standard deviation of a normal distribution per median of the magnitude.
const DEVIATION_PER_MEDIAN: f64 = 1.482_602_218_505_602;
/// Rounds of search and new look at the deviations.
const ROUNDS: usize = 3;

/// How to weigh deviations that are far out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighing {
    /// Least squares; deviations that cannot be measurements are left out.
    #[default]
    LeastSquares,
    /// Huber's loss: squares up to 1.345 standard deviations, linear beyond.
    Huber,
}

/// A parameter of one of the problem's cables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// Which cable of the problem.
    pub member: usize,
    /// Which parameter.
    pub parameter: Parameter,
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Values of each cable.
    pub values: Vec<Values>,
    /// What was varied at last, in the order of the covariance.
    pub unknowns: Vec<Unknown>,
    /// What the samples do not determine; held at the given values.
    pub undetermined: Vec<Unknown>,
    /// Covariance of the estimates.
    pub covariance: DMatrix<f64>,
    pub termination: Termination,
    pub evaluation_count: usize,
}

/// Solves a problem from the starts given, the most promising first. `standings` of its samples are updated with the
/// outliers.
pub fn solve(
    problem: &mut Problem<'_>,
    starts: Vec<Vec<Values>>,
    given: &[Values],
    cycle_s: f64,
    weighing: Weighing,
    standings: &mut [Standing],
) -> Solution {
    let mut solution = Solution {
        values: given.to_vec(),
        unknowns: unknowns(problem),
        undetermined: Vec::new(),
        covariance: DMatrix::zeros(0, 0),
        termination: Termination::NothingToFit,
        evaluation_count: 0,
    };
    if problem.used.contains(&true) {
        let best = starts
            .into_iter()
            .map(|start| search(problem, &start, cycle_s))
            .inspect(|(_, minimum)| solution.evaluation_count += minimum.evaluation_count)
            .min_by(|(_, one), (_, other)| one.squares.total_cmp(&other.squares));
        if let Some((found, minimum)) = best {
            (solution.values, solution.termination) = (found, minimum.termination);
        }
        for _ in 0..ROUNDS {
            if !look_again(problem, &solution.values, weighing, standings) {
                break;
            }
            solution.search_on(problem, cycle_s);
        }
    }
    solution.hold_undetermined(problem, given, cycle_s);
    solution
}

impl Solution {
    /// Goes on from where the last search has ended.
    fn search_on(&mut self, problem: &Problem<'_>, cycle_s: f64) {
        let (found, minimum) = search(problem, &self.values, cycle_s);
        self.evaluation_count += minimum.evaluation_count;
        (self.values, self.termination) = (found, minimum.termination);
    }

    /// Holds one parameter after the other that the samples do not determine, the vaguest first.
    fn hold_undetermined(&mut self, problem: &mut Problem<'_>, given: &[Values], cycle_s: f64) {
        loop {
            self.unknowns = unknowns(problem);
            self.covariance = covariance(problem, &self.values);
            let sticks = yardsticks(problem, &self.values);
            let vagueness = |(place, unknown): (usize, &Unknown)| {
                let value = self.values.get(unknown.member)?[unknown.parameter.place()];
                let standard_error = self.covariance[(place, place)].sqrt();
                Some((sticks.get(unknown.member)?.vagueness(&unknown.parameter, value, standard_error), *unknown))
            };
            let all = self.unknowns.iter().enumerate().filter_map(vagueness);
            let vaguest = all.max_by(|(one, _), (other, _)| one.total_cmp(other));
            let stopped = self.termination == Termination::Stopped;
            let Some((_, worst)) = vaguest.filter(|(vagueness, _)| *vagueness > 1.0 && !stopped) else { return };
            hold(problem, worst, &mut self.values, given);
            self.undetermined.push(worst);
            self.search_on(problem, cycle_s);
        }
    }
}

/// What matters for each cable of a problem.
fn yardsticks(problem: &Problem<'_>, values: &[Values]) -> Vec<Yardstick> {
    let of = |(member, values): (&Member<'_>, &Values)| {
        let mut friction = Deviation::default();
        pass::run_plain(&member.record, values, |_, row, forces| {
            if row.is_sound() {
                friction.add(forces.friction_n);
            }
        });
        let pulley_count = member.record.params.pulley_count();
        Yardstick { friction_n: friction.rms().unwrap_or(0.0), pulley_count }
    };
    problem.members.iter().zip(values).map(of).collect()
}

/// What a problem varies.
fn unknowns(problem: &Problem<'_>) -> Vec<Unknown> {
    let of_member = |(member, of): (usize, &Member<'_>)| {
        of.free.iter().map(|parameter| Unknown { member, parameter: *parameter }).collect::<Vec<_>>()
    };
    problem.members.iter().enumerate().flat_map(of_member).collect()
}

/// Varies a parameter no longer: it takes its given value.
fn hold(problem: &mut Problem<'_>, unknown: Unknown, values: &mut [Values], given: &[Values]) {
    let place = unknown.parameter.place();
    if let Some(member) = problem.members.get_mut(unknown.member) {
        member.free.retain(|parameter| *parameter != unknown.parameter);
    }
    if let (Some(values), Some(given)) = (values.get_mut(unknown.member), given.get(unknown.member)) {
        values[place] = given[place];
    }
}

/// The minimum from a start.
fn search(problem: &Problem<'_>, start: &[Values], cycle_s: f64) -> (Vec<Values>, Minimum) {
    let unknowns = unknowns(problem);
    let coordinates: Vec<Coordinate> =
        unknowns.iter().map(|unknown| Coordinate::of(&unknown.parameter, cycle_s)).collect();
    let at_start: Vec<f64> = unknowns
        .iter()
        .zip(&coordinates)
        .map(|(unknown, coordinate)| {
            start.get(unknown.member).map_or(f64::NAN, |values| coordinate.place_of(values[unknown.parameter.place()]))
        })
        .collect();
    let values_at = |places: &[f64]| -> (Vec<Values>, Vec<f64>) {
        let (numbers, slopes): (Vec<f64>, Vec<f64>) =
            places.iter().zip(&coordinates).map(|(place, coordinate)| coordinate.value_at(*place)).unzip();
        let mut numbers = numbers.into_iter();
        let members = problem.members.iter().zip(start);
        (
            members
                .map(|(member, values)| with(values, &member.free, numbers.by_ref().take(member.free.len())))
                .collect(),
            slopes,
        )
    };
    let minimum = optimizer::minimize(&at_start, |places| {
        let (values, slopes) = values_at(places);
        let gram: Gram = problem.gram(&values)?;
        let (mut matrix, mut gradient, squares) = gram.normal_equations();
        for (row, slope) in slopes.iter().enumerate() {
            matrix.row_mut(row).scale_mut(*slope);
            matrix.column_mut(row).scale_mut(*slope);
            gradient[row] *= slope;
        }
        Some(Triangle::new(&matrix, &gradient, squares))
    });
    (values_at(&minimum.coordinates).0, minimum)
}

/// Covariance of what a problem varies; infinite where the samples say nothing.
fn covariance(problem: &Problem<'_>, values: &[Values]) -> DMatrix<f64> {
    let count = problem.parameter_count();
    let unknown = || DMatrix::from_diagonal_element(count, count, f64::INFINITY);
    let Some((gram, scores)) = problem.gram_and_scores(values) else { return unknown() };
    let (matrix, ..) = gram.normal_equations();
    let scale: Vec<f64> = matrix.diagonal().iter().map(|square| 1.0 / square.max(f64::MIN_POSITIVE).sqrt()).collect();
    let scaled = DMatrix::from_fn(count, count, |row, column| {
        // What has no effect at all gets an all but infinite variance of its own.
        let vanishing = if row == column { 1e-12 } else { 0.0 };
        matrix[(row, column)] * scale[row] * scale[column] + vanishing
    });
    let Some(factor) = scaled.cholesky() else { return unknown() };
    let inverse = factor.inverse();
    let inverse = DMatrix::from_fn(count, count, |row, column| inverse[(row, column)] * scale[row] * scale[column]);
    let covariance = scores.covariance(&inverse);
    let silent = |place: usize| matrix[(place, place)] <= 0.0;
    DMatrix::from_fn(
        count,
        count,
        |row, column| {
            if row == column && silent(row) { f64::INFINITY } else { covariance[(row, column)] }
        },
    )
}

/// Looks at the deviations anew: leaves out what cannot be a measurement, or sets Huber's bound. Whether something has
/// changed.
fn look_again(problem: &mut Problem<'_>, values: &[Values], weighing: Weighing, standings: &mut [Standing]) -> bool {
    problem.loss = Loss::Squares;
    let mut deviations: Vec<(usize, f64)> = Vec::new();
    problem.residuals(values, |place, residuals| {
        let most = residuals.iter().fold(0.0, |most: f64, residual| most.max(residual.abs()));
        deviations.push((place, most));
    });
    let mut magnitudes: Vec<f64> = deviations.iter().map(|(_, deviation)| *deviation).collect();
    let middle = magnitudes.len() / 2;
    if magnitudes.is_empty() {
        return false;
    }
    let (_, median, _) = magnitudes.select_nth_unstable_by(middle, f64::total_cmp);
    let deviation = *median * DEVIATION_PER_MEDIAN;
    match weighing {
        Weighing::Huber => {
            problem.loss = Loss::Huber(HUBER_RATIO * deviation);
            true
        }
        Weighing::LeastSquares => {
            let outliers: Vec<usize> = deviations
                .iter()
                .filter(|(_, far)| *far > OUTLIER_RATIO * deviation)
                .map(|(place, _)| *place)
                .collect();
            #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
            let few = outliers.len() as f64 <= MOST_OUTLIERS_RATIO * deviations.len() as f64;
            if outliers.is_empty() || !few {
                return false;
            }
            for place in outliers {
                if let (Some(used), Some(standing)) = (problem.used.get_mut(place), standings.get_mut(place)) {
                    (*used, *standing) = (false, Standing::Outlier);
                }
            }
            true
        }
    }
}
