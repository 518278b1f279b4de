//! Solves a problem from start values to estimates: search and outliers.

use fric_core::parameters::{SIGMA, Values};
use nalgebra::DMatrix;

use super::optimizer;
use super::optimizer::{Minimum, Termination};
use super::problem::{Loss, Member, Problem};
use super::vector::{Coordinate, Parameter, with};
use crate::samples::selection::Standing;

/// Deviations beyond this many standard deviations count as outliers if their neighbours do not share them.
const OUTLIER_RATIO: f64 = 8.0;
/// Number of samples to either side that count as neighbours. A deviation that lasts no longer cannot be distinguished from an outlier.
const NEIGHBOURS: usize = 2;
/// Maximum fraction of samples that can be outliers. If there are more, the model does not describe the samples.
const MOST_OUTLIERS_RATIO: f64 = 0.02;
/// Huber's bound in standard deviations: 95 % efficient for normal noise.
const HUBER_RATIO: f64 = 1.345;
/// Ratio of the standard deviation to the median magnitude of a normal distribution.
const DEVIATION_PER_MEDIAN: f64 = 1.482_602_218_505_602;
/// A given value contradicts the samples if it raises the sum of squares by more than this fraction.
pub(crate) const CONTRADICTION_RATIO: f64 = 0.01;
/// A parameter at its bound, with the given value within its interval, gets the given value unless that multiplies the sum of squares by more than this. The
/// interval supposes a straight line, which a bound ends: of bearings without friction the given one had multiplied it by a thousand.
pub(crate) const GROSS_CONTRADICTION: f64 = 2.0;
/// A search continues to within this many standard errors of the minimum.
pub(crate) const NEAR_ERRORS: f64 = 0.01;
/// A stiffness beyond this fraction of the end of its range has gone there. Half and twice this fraction are the same: contacts have 10⁹ N/m at most,
/// and where σ has no slope the search ends at 10¹² N/m.
const LOST_RATIO: f64 = 0.5;
/// Maximum number of rounds of search and outlier detection.
const ROUNDS: usize = 3;

/// The treatment of large deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighing {
    /// Least squares; deviations that cannot be measurements are left out.
    #[default]
    LeastSquares,
    /// Huber's loss: quadratic up to 1.345 standard deviations, linear beyond.
    Huber,
}

/// A parameter of one of the problem's cables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// Index of the cable in the problem.
    pub member: usize,
    /// The parameter.
    pub parameter: Parameter,
}

/// A combination of parameters that the samples leave open: changing them together by these steps has no effect.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenCombination {
    /// The parameters that change.
    pub parts: Vec<OpenPart>,
}

/// A parameter in a combination.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenPart {
    /// Index of the cable in the robot.
    pub cable: usize,
    /// The parameter.
    pub parameter: Parameter,
    /// Its part of a step of 1.96 standard errors, in its unit; not finite for a parameter that has no effect at all. Of a zero that motion one way leaves
    /// open, of a step as large as takes all friction for a zero; of a zero that one load leaves open beside a gain, of a step that takes all of the gain for a zero.
    pub step: f64,
}

/// The solution of a problem.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Values of each cable.
    pub values: Vec<Values>,
    /// The finally free parameters, in the order of the covariance.
    pub unknowns: Vec<Unknown>,
    /// Parameters that the samples do not determine; held at the given values.
    pub undetermined: Vec<Unknown>,
    /// The combination that each of them is confused with.
    pub open: Vec<OpenCombination>,
    /// Parameters at a bound that the samples would move beyond it.
    pub at_bound: Vec<Unknown>,
    /// Covariance of the estimates.
    pub covariance: DMatrix<f64>,
    pub termination: Termination,
    pub evaluation_count: usize,
}

/// Solves a problem from the given starts, the most promising first, with all parameters free, determined or not. Marks outliers in `standings`.
pub(crate) fn settle(
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
        open: Vec::new(),
        at_bound: Vec::new(),
        covariance: DMatrix::zeros(0, 0),
        termination: Termination::NothingToFit,
        evaluation_count: 0,
    };
    if problem.used.contains(&true) {
        let best = starts
            .into_iter()
            .map(|start| (search(problem, &start, cycle_s), start))
            .inspect(|((_, minimum), _)| solution.evaluation_count += minimum.evaluation_count)
            .min_by(|((_, one), _), ((_, other), _)| one.squares.total_cmp(&other.squares));
        if let Some(((found, minimum), start)) = best {
            (solution.values, solution.termination) = (found, minimum.termination);
            solution.regain(problem, &start, minimum.squares, cycle_s);
        }
        for _ in 0..ROUNDS {
            if !look_again(problem, &solution.values, weighing, standings) {
                break;
            }
            solution.search_on(problem, cycle_s);
        }
    }
    solution
}

impl Solution {
    /// Searches again for cables whose presliding a step has taken away, from their start values, as long as that helps. At the end of its range σ has
    /// no slope and cannot come back, while the other parameters stand in for the presliding that is missing. A cable by itself has starts with several
    /// σ instead.
    fn regain(&mut self, problem: &Problem<'_>, start: &[Values], mut squares: f64, cycle_s: f64) {
        for _ in 1..problem.members.len() {
            let mut again = self.values.clone();
            for unknown in unknowns(problem).iter().filter(|unknown| unknown.parameter.place() == SIGMA) {
                let (_, greatest) = Coordinate::of(&unknown.parameter, cycle_s).range();
                if let (Some(values), Some(start)) = (again.get_mut(unknown.member), start.get(unknown.member))
                    && values[SIGMA] >= LOST_RATIO * greatest
                    && start[SIGMA] < LOST_RATIO * greatest
                {
                    *values = *start;
                }
            }
            if again == self.values {
                return;
            }
            let (found, minimum) = search(problem, &again, cycle_s);
            self.evaluation_count += minimum.evaluation_count;
            if minimum.squares < squares {
                (self.values, self.termination, squares) = (found, minimum.termination, minimum.squares);
            } else {
                return;
            }
        }
    }

    /// Continues from where the last search ended.
    pub(crate) fn search_on(&mut self, problem: &Problem<'_>, cycle_s: f64) {
        let (found, minimum) = search(problem, &self.values, cycle_s);
        self.evaluation_count += minimum.evaluation_count;
        (self.values, self.termination) = (found, minimum.termination);
    }
}

/// Whether the samples contradict values that were held: the sum of squares is far smaller with them free.
pub(crate) fn contradicts(held: &Problem<'_>, at: &[Values], free: &Problem<'_>, found: &[Values]) -> bool {
    squares(held, at) > squares(free, found) * (1.0 + CONTRADICTION_RATIO)
}

/// Returns the sum of squares at some values; NaN if stopped.
pub(crate) fn squares(problem: &Problem<'_>, values: &[Values]) -> f64 {
    problem.gram(values).map_or(f64::NAN, |gram| gram.normal_equations().2)
}

/// Returns the free parameters of a problem.
pub(crate) fn unknowns(problem: &Problem<'_>) -> Vec<Unknown> {
    let of_member = |(member, of): (usize, &Member<'_>)| {
        of.free.iter().map(|parameter| Unknown { member, parameter: *parameter }).collect::<Vec<_>>()
    };
    problem.members.iter().enumerate().flat_map(of_member).collect()
}

/// Stops varying a parameter and sets it to its given value.
pub(crate) fn hold(problem: &mut Problem<'_>, unknown: Unknown, values: &mut [Values], given: &[Values]) {
    let place = unknown.parameter.place();
    if let Some(member) = problem.members.get_mut(unknown.member) {
        member.free.retain(|parameter| *parameter != unknown.parameter);
    }
    if let (Some(values), Some(given)) = (values.get_mut(unknown.member), given.get(unknown.member)) {
        values[place] = given[place];
    }
}

/// Returns the minimum reached from a start.
pub(crate) fn search(problem: &Problem<'_>, start: &[Values], cycle_s: f64) -> (Vec<Values>, Minimum) {
    search_near(problem, start, cycle_s, NEAR_ERRORS)
}

/// Returns a point at most `near_errors` standard errors from the minimum; see [`optimizer::minimize`].
pub fn search_near(problem: &Problem<'_>, start: &[Values], cycle_s: f64, near_errors: f64) -> (Vec<Values>, Minimum) {
    let unknowns = unknowns(problem);
    let coordinates: Vec<Coordinate> =
        unknowns.iter().map(|unknown| Coordinate::of(&unknown.parameter, cycle_s)).collect();
    let number =
        |unknown: &Unknown| start.get(unknown.member).map_or(f64::NAN, |values| values[unknown.parameter.place()]);
    let values_of = |numbers: &[f64]| -> Vec<Values> {
        let mut numbers = numbers.iter().copied();
        let members = problem.members.iter().zip(start);
        members.map(|(member, values)| with(values, &member.free, numbers.by_ref().take(member.free.len()))).collect()
    };
    let from: Vec<f64> = unknowns.iter().map(number).collect();
    let minimum = optimizer::minimize(&coordinates, &from, problem.residual_count(), near_errors, |numbers| {
        problem.gram(&values_of(numbers)).map(|gram| gram.normal_equations())
    });
    let values = values_of(&minimum.values);
    if minimum.values != minimum.evaluated {
        problem.step(&values_of(&minimum.evaluated), &values);
    }
    (values, minimum)
}

/// Examines the deviations again: leaves out outliers, or sets Huber's bound. Returns whether anything changed.
fn look_again(problem: &mut Problem<'_>, values: &[Values], weighing: Weighing, standings: &mut [Standing]) -> bool {
    problem.loss = Loss::Squares;
    // Former outliers are judged again, because a worse fit may have caused them.
    let mut before = Vec::new();
    for (place, (standing, used)) in standings.iter_mut().zip(&mut problem.used).enumerate() {
        if *standing == Standing::Outlier {
            (*standing, *used) = (Standing::Used, true);
            before.push(place);
        }
    }
    let most = problem.used.len();
    let mut places = Vec::with_capacity(most);
    // One series for a cable's force, six for a wrench.
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

/// Whether a residual is large while its neighbours are not: their median is less than half as large. A deviation that lasts is no outlier but
/// something that the model misses, so its samples must be fitted.
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
        // A step, a pulse of three samples, the top of a triangle, and an outlier on an excursion.
        assert!(is_found(&[0.1, 0.0, 0.1, 9.0, 9.2, 9.1, 9.0]).is_empty());
        assert!(is_found(&[0.1, 0.0, 0.1, 9.0, 9.2, 9.1, 0.1, 0.0]).is_empty());
        assert!(is_found(&[0.0, 3.0, 6.0, 9.0, 12.0, 9.0, 6.0, 3.0, 0.0]).is_empty());
        assert_eq!(is_found(&[9.0, 9.1, 9.2, 60.0, 9.1, 9.2, 9.1]), [3]);
    }
}
