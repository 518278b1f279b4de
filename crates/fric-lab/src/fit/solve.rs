//! From a problem and a start to values with their covariance: search, outliers, what is not determined.

use std::sync::Arc;

use fric_core::parameters::{OFFSET, Values};
use nalgebra::DMatrix;

use super::determined::Yardstick;
use super::gram::{Gram, Triangle};
use super::optimizer::{self, Minimum, Termination};
use super::pass::Forces;
use super::problem::{Comparison, Loss, Member, Problem};
use super::selection::Standing;
use super::vector::{Coordinate, Parameter, with};
use crate::replay::Deviation;

/// Deviations beyond this many standard deviations that their neighbours do not share are no measurements.
const OUTLIER_RATIO: f64 = 8.0;
/// So many samples to either side are neighbours: of what is shorter than them it cannot be told that it lasts.
const NEIGHBOURS: usize = 2;
/// More outliers than this share of the samples are no outliers: the model does not describe them.
const MOST_OUTLIERS_RATIO: f64 = 0.02;
/// Huber's bound in standard deviations: 95 % efficient for normal noise.
const HUBER_RATIO: f64 = 1.345;
/// Standard deviation of a normal distribution per median of the magnitude.
const DEVIATION_PER_MEDIAN: f64 = 1.482_602_218_505_602;
/// Vaguenesses within this ratio are alike: those of parameters that only together have an effect.
const COMPARABLE_RATIO: f64 = 0.01;
/// A given value that raises the sum of squares by more than this share contradicts the samples.
const CONTRADICTION_RATIO: f64 = 0.01;
/// A search goes on to within so many standard errors of the minimum.
const NEAR_ERRORS: f64 = 0.01;
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
/// outliers; `kept` are varied however little is known of them.
pub fn solve(
    problem: &mut Problem<'_>,
    starts: Vec<Vec<Values>>,
    given: &[Values],
    cycle_s: f64,
    weighing: Weighing,
    standings: &mut [Standing],
    kept: &[Unknown],
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
    solution.hold_undetermined(problem, given, cycle_s, kept);
    solution
}

impl Solution {
    /// Goes on from where the last search has ended.
    fn search_on(&mut self, problem: &Problem<'_>, cycle_s: f64) {
        let (found, minimum) = search(problem, &self.values, cycle_s);
        self.evaluation_count += minimum.evaluation_count;
        (self.values, self.termination) = (found, minimum.termination);
    }

    /// Holds one parameter after the other that the samples do not determine, the vaguest first. One whose given value the
    /// samples contradict stays as found: they know that much.
    fn hold_undetermined(&mut self, problem: &mut Problem<'_>, given: &[Values], cycle_s: f64, kept: &[Unknown]) {
        let mut kept = kept.to_vec();
        let mut least = None;
        loop {
            let mut all;
            (self.covariance, all) = vagueness(problem, &self.values);
            self.unknowns = all.iter().map(|(_, unknown)| *unknown).collect();
            all.retain(|(_, unknown)| !kept.contains(unknown));
            let most = all.iter().fold(1.0, |most: f64, (vagueness, _)| most.max(*vagueness));
            let is_offset = |unknown: &Unknown| unknown.parameter.place() == OFFSET;
            // Of those that are about as vague the offset comes last.
            let vague = all.iter().filter(|(vagueness, _)| *vagueness > 1.0 && *vagueness >= COMPARABLE_RATIO * most);
            let vaguest = vague.max_by(|(one, of_one), (other, of_other)| {
                is_offset(of_other).cmp(&is_offset(of_one)).then(one.total_cmp(other))
            });
            let stopped = self.termination == Termination::Stopped;
            let Some((_, worst)) = vaguest.filter(|_| !stopped).copied() else { return };
            let (members, found, termination) = (problem.members.clone(), self.values.clone(), self.termination);
            // By what all were before the first was held: many small steps are one big one.
            let bound = *least.get_or_insert_with(|| squares(problem, &self.values)) * (1.0 + CONTRADICTION_RATIO);
            hold(problem, worst, &mut self.values, given);
            self.search_on(problem, cycle_s);
            if squares(problem, &self.values) > bound {
                (problem.members, self.values, self.termination) = (members, found, termination);
                kept.push(worst);
            } else {
                self.undetermined.push(worst);
            }
        }
    }
}

/// Covariance of what a problem varies at some values, and in its order how vague each parameter is: above 1 where the samples do
/// not determine it, see [`Yardstick`].
pub fn vagueness(problem: &Problem<'_>, values: &[Values]) -> (DMatrix<f64>, Vec<(f64, Unknown)>) {
    let (covariance, leverages) = covariance(problem, values);
    let sticks = yardsticks(problem, values);
    let of = |(place, unknown): (usize, Unknown)| {
        let value = values.get(unknown.member).map_or(f64::NAN, |values| values[unknown.parameter.place()]);
        let standard_error = covariance[(place, place)].sqrt();
        let leverage = leverages.get(place).copied().unwrap_or(0.0);
        let vagueness = sticks
            .get(unknown.member)
            .map_or(f64::INFINITY, |stick| stick.vagueness(&unknown.parameter, value, standard_error, leverage));
        (vagueness, unknown)
    };
    let all = unknowns(problem).into_iter().enumerate().map(of).collect();
    (covariance, all)
}

/// Whether the samples contradict values that were held: with them free the sum of squares is smaller by far.
pub(super) fn contradicts(held: &Problem<'_>, at: &[Values], free: &Problem<'_>, found: &[Values]) -> bool {
    squares(held, at) > squares(free, found) * (1.0 + CONTRADICTION_RATIO)
}

/// Sum of squares at some values; NaN when stopped.
fn squares(problem: &Problem<'_>, values: &[Values]) -> f64 {
    problem.gram(values).map_or(f64::NAN, |gram| gram.normal_equations().2)
}

/// What matters for each cable of a problem.
fn yardsticks(problem: &Problem<'_>, values: &[Values]) -> Vec<Yardstick> {
    let forces = problem.forces(values).unwrap_or_default();
    let of = |((member, values), forces): ((&Member<'_>, &Values), &Arc<Forces>)| {
        let gain = member.record.params.frictionless_gain();
        let (mut friction, mut tension) = (Deviation::default(), Deviation::default());
        for (cycle, row) in member.record.rows.iter().enumerate().filter(|(_, row)| row.is_sound()) {
            let frictionless_n = row.signals.sensor_force_n * gain;
            friction.add(forces.at(cycle).0 - values[OFFSET] - frictionless_n);
            tension.add(frictionless_n);
        }
        let [friction_n, tension_n] = [friction, tension].map(|force| force.rms().unwrap_or(0.0));
        Yardstick::new(friction_n, tension_n, member.record.params.pulley_count())
    };
    problem.members.iter().zip(values).zip(&forces).map(of).collect()
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
pub(super) fn search(problem: &Problem<'_>, start: &[Values], cycle_s: f64) -> (Vec<Values>, Minimum) {
    search_near(problem, start, cycle_s, NEAR_ERRORS)
}

/// A place no further from the minimum than so many standard errors, see [`optimizer::minimize`].
pub fn search_near(problem: &Problem<'_>, start: &[Values], cycle_s: f64, near_errors: f64) -> (Vec<Values>, Minimum) {
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
    let is_straight = |from: &[f64], to: &[f64]| {
        let mut of_each = coordinates.iter().zip(from).zip(to);
        of_each.all(|((coordinate, from), to)| coordinate.is_straight(*from, *to))
    };
    let minimum = optimizer::minimize(&at_start, problem.residual_count(), near_errors, is_straight, |places| {
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
    let (values, _) = values_at(&minimum.coordinates);
    if minimum.coordinates != minimum.evaluated {
        problem.step(&values_at(&minimum.evaluated).0, &values);
    }
    (values, minimum)
}

/// Covariance of what a problem varies, infinite where the samples say nothing; and by how much each moves for residuals of
/// 1 N in every sample, at worst.
pub fn covariance(problem: &Problem<'_>, values: &[Values]) -> (DMatrix<f64>, Vec<f64>) {
    let count = problem.parameter_count();
    let unknown = || (DMatrix::from_diagonal_element(count, count, f64::INFINITY), vec![f64::INFINITY; count]);
    let Some((gram, scores)) = problem.gram_and_scores(values) else { return unknown() };
    let (matrix, ..) = gram.normal_equations();
    let Some(inverse) = inverse_of_normal(&matrix) else { return unknown() };
    let covariance = scores.covariance(&inverse);
    let silent = |place: usize| matrix[(place, place)] <= 0.0;
    let finite = |row, column| if row == column && silent(row) { f64::INFINITY } else { covariance[(row, column)] };
    // Residuals of a wrench are no forces of a cable.
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let samples = match problem.comparison {
        Comparison::Forces => problem.used.iter().filter(|used| **used).count() as f64,
        Comparison::Wrench { .. } => 0.0,
    };
    let leverages = inverse.diagonal().iter().map(|variance| (samples * variance).sqrt()).collect();
    (DMatrix::from_fn(count, count, finite), leverages)
}

/// Inverse of a matrix `JᵀJ`, scaled meanwhile; what has no effect at all gets an all but infinite variance of its own. `None` where
/// the matrix is not of numbers.
pub fn inverse_of_normal(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let count = matrix.nrows();
    let scale: Vec<f64> = matrix.diagonal().iter().map(|square| 1.0 / square.max(f64::MIN_POSITIVE).sqrt()).collect();
    let scaled = DMatrix::from_fn(count, count, |row, column| {
        let vanishing = if row == column { 1e-12 } else { 0.0 };
        matrix[(row, column)] * scale[row] * scale[column] + vanishing
    });
    let inverse = scaled.cholesky()?.inverse();
    Some(DMatrix::from_fn(count, count, |row, column| inverse[(row, column)] * scale[row] * scale[column]))
}

/// Looks at the deviations anew: leaves out what cannot be a measurement, or sets Huber's bound. Whether something has
/// changed.
fn look_again(problem: &mut Problem<'_>, values: &[Values], weighing: Weighing, standings: &mut [Standing]) -> bool {
    problem.loss = Loss::Squares;
    // What was left out before is judged again: a worse fit may have been at fault.
    let mut before = Vec::new();
    for (place, (standing, used)) in standings.iter_mut().zip(&mut problem.used).enumerate() {
        if *standing == Standing::Outlier {
            (*standing, *used) = (Standing::Used, true);
            before.push(place);
        }
    }
    let most = problem.used.len();
    let mut places = Vec::with_capacity(most);
    // One of a cable's force, six of a wrench.
    let mut series: Vec<Vec<f64>> = Vec::new();
    problem.residuals(values, |place, residuals| {
        series.resize_with(residuals.len(), || Vec::with_capacity(most));
        series.iter_mut().zip(residuals).for_each(|(series, residual)| series.push(*residual));
        places.push(place);
    });
    let most =
        |sample: usize| series.iter().filter_map(|of| of.get(sample)).fold(0.0, |most: f64, of| most.max(of.abs()));
    let mut magnitudes: Vec<f64> = (0..places.len()).map(most).collect();
    if magnitudes.is_empty() {
        return false;
    }
    let middle = magnitudes.len() / 2;
    let (_, median, _) = magnitudes.select_nth_unstable_by(middle, f64::total_cmp);
    let deviation = *median * DEVIATION_PER_MEDIAN;
    if weighing == Weighing::Huber {
        problem.loss = Loss::Huber(HUBER_RATIO * deviation);
        return true;
    }
    let is_spike =
        |sample: usize| series.iter().any(|residuals| is_spike(residuals, sample, OUTLIER_RATIO * deviation));
    let spikes = places.iter().enumerate().filter(|(sample, _)| is_spike(*sample));
    let mut outliers: Vec<usize> = spikes.map(|(_, place)| *place).collect();
    #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
    let few = outliers.len() as f64 <= MOST_OUTLIERS_RATIO * places.len() as f64;
    if !few {
        outliers.clear();
    }
    for place in &outliers {
        if let (Some(used), Some(standing)) = (problem.used.get_mut(*place), standings.get_mut(*place)) {
            (*used, *standing) = (false, Standing::Outlier);
        }
    }
    outliers != before
}

/// Whether a residual is far out, and its neighbours are not: less than half as far, by their median. What lasts is no spike but
/// something that the model misses, and the samples have a right to be fitted.
fn is_spike(residuals: &[f64], place: usize, far: f64) -> bool {
    let Some(residual) = residuals.get(place).filter(|residual| residual.abs() > far) else { return false };
    let around = residuals.iter().skip(place.saturating_sub(NEIGHBOURS)).take(NEIGHBOURS + place.min(NEIGHBOURS) + 1);
    let mut shares: Vec<f64> = around.map(|other| other / residual).collect();
    let middle = shares.len() / 2;
    let (_, median, _) = shares.select_nth_unstable_by(middle, f64::total_cmp);
    *median < 0.5
}

#[cfg(test)]
mod tests {
    use super::is_spike;

    #[test]
    fn a_spike_is_alone_and_an_excursion_is_not() {
        let is_found = |residuals: &[f64]| -> Vec<usize> {
            (0..residuals.len()).filter(|place| is_spike(residuals, *place, 8.0)).collect()
        };
        assert_eq!(is_found(&[0.1, -0.2, 0.1, 50.0, 0.3, -0.1, 0.2]), [3]);
        assert_eq!(is_found(&[0.1, -0.2, 0.1, -50.0, -40.0, -0.1, 0.2, 0.1]), [3, 4]);
        assert_eq!(is_found(&[50.0, 0.1, 0.2, 0.1, -0.1, 50.0]), [0, 5]);
        // A step, a pulse of three samples, the top of a triangle, and a spike on an excursion.
        assert!(is_found(&[0.1, 0.0, 0.1, 9.0, 9.2, 9.1, 9.0]).is_empty());
        assert!(is_found(&[0.1, 0.0, 0.1, 9.0, 9.2, 9.1, 0.1, 0.0]).is_empty());
        assert!(is_found(&[0.0, 3.0, 6.0, 9.0, 12.0, 9.0, 6.0, 3.0, 0.0]).is_empty());
        assert_eq!(is_found(&[9.0, 9.1, 9.2, 60.0, 9.1, 9.2, 9.1]), [3]);
    }
}
