//! A model's numbers by least squares over what is learned from: Gauss–Newton with slopes by differences, for the tensions are nearly
//! linear in all of them.

use nalgebra::{DMatrix, DVector};

use super::case::{Case, Fit};
use super::model::{Model, Parameter};
use crate::fit::engine::{Gram, Scores, inverse_of_normal};

const MOST_STEPS: u32 = 8;
const MOST_HALVINGS: u32 = 6;
/// A step that lowers the sum of squares by less is the last.
const SETTLED_RATIO: f64 = 1e-4;

/// The model with its numbers fitted; `None` where it has no shapes.
pub fn fitted(case: &Case<'_>, start: &Model) -> Option<Fit> {
    let mut now = case.fit(start)?;
    let parameters = start.parameters();
    if parameters.is_empty() {
        return Some(now);
    }
    for _ in 0..MOST_STEPS {
        let Some(step) = step(case, &now, &parameters) else { break };
        let trial = |share: f64| {
            let moved = parameters.iter().zip(step.iter()).fold(now.model.clone(), |model, (parameter, change)| {
                model.with(*parameter, model.get(*parameter) + share * change)
            });
            case.fit(&moved).filter(|fit| fit.squares < now.squares)
        };
        let Some(better) = (0..MOST_HALVINGS).find_map(|halving| trial(0.5_f64.powi(halving.cast_signed()))) else {
            break;
        };
        let is_settled = better.squares > (1.0 - SETTLED_RATIO) * now.squares;
        now = better;
        if is_settled {
            break;
        }
    }
    Some(now)
}

/// The step to the minimum of the linearised problem.
fn step(case: &Case<'_>, now: &Fit, parameters: &[Parameter]) -> Option<DVector<f64>> {
    let (matrix, gradient, _) = linearised(case, now, &slopes(case, now, parameters)?).0.normal_equations();
    matrix.cholesky().map(|factor| factor.solve(&-gradient))
}

/// Covariance of a fitted model's parameters, under residuals that remember and lines of the gratings that are known no better than their
/// calibration makes them; `None` where the run does not determine them.
///
/// A line that is off by `e` moves the parameters by `(JᵀJ)⁻¹Jᵀe` (delta method); errors of constant and slope of each line are independent.
pub fn covariance(case: &Case<'_>, fit: &Fit) -> Option<DMatrix<f64>> {
    let slopes = slopes(case, fit, &fit.model.parameters())?;
    let (gram, scores) = linearised(case, fit, &slopes);
    let inverse = inverse_of_normal(&gram.normal_equations().0)?;
    let mut covariance = scores.covariance(&inverse);
    for (segment, part) in (0..fit.model.mu.len()).flat_map(|segment| [(segment, 0), (segment, 1)]) {
        let mut pull = DVector::zeros(slopes.len());
        for (sample, row) in fit.residual_n.iter().enumerate().filter(|(sample, _)| !case.held_out[*sample]) {
            if row[segment].is_finite() {
                let error_n = case.line_error_n[sample][segment][part];
                pull.iter_mut().zip(&slopes).for_each(|(pull, slopes)| *pull += slopes[sample][segment] * error_n);
            }
        }
        let change = &inverse * pull;
        covariance += &change * change.transpose();
    }
    Some(covariance)
}

/// Derivatives of the residuals by each parameter.
type Slopes = Vec<Vec<Vec<f64>>>;

fn slopes(case: &Case<'_>, now: &Fit, parameters: &[Parameter]) -> Option<Slopes> {
    let start_s = case.samples.first()?.time_s;
    parameters
        .iter()
        .map(|parameter| match parameter {
            Parameter::Drift(grating) => {
                let elapsed_s = case.samples.iter().map(|sample| sample.time_s - start_s);
                let slope = |elapsed_s: f64, segment: usize| if segment == *grating { -elapsed_s } else { 0.0 };
                let count = now.model.mu.len();
                Some(elapsed_s.map(|elapsed_s| (0..count).map(|segment| slope(elapsed_s, segment)).collect()).collect())
            }
            mu => {
                let value = now.model.get(*mu);
                let change = 0.02 * value.max(0.02);
                let moved = case.fit(&now.model.with(*mu, value + change))?;
                let change = moved.model.get(*mu) - value;
                let pairs = moved.residual_n.iter().zip(&now.residual_n);
                Some(pairs.map(|(one, other)| one.iter().zip(other).map(|(p, q)| (p - q) / change).collect()).collect())
            }
        })
        .collect()
}

/// Residuals learned from and their slopes, reduced; the gratings of a sample belong together.
fn linearised(case: &Case<'_>, now: &Fit, slopes: &Slopes) -> (Gram, Scores) {
    let count = slopes.len();
    let (mut gram, mut scores) = (Gram::new(count), Scores::new(count));
    for (sample, row) in now.residual_n.iter().enumerate().filter(|(sample, _)| !case.held_out[*sample]) {
        let mut score = vec![0.0; count];
        for (segment, residual_n) in row.iter().enumerate() {
            let numbers: Vec<f64> = slopes.iter().map(|all| all[sample][segment]).chain([*residual_n]).collect();
            if numbers.iter().all(|number| number.is_finite()) {
                gram.add(&numbers);
                score.iter_mut().zip(&numbers).for_each(|(score, slope)| *score += slope * residual_n);
            }
        }
        scores.add(&score);
    }
    (gram, scores)
}
