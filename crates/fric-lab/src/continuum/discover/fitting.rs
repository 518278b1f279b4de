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
    let (matrix, gradient, _) = linearised(case, now, parameters)?.0.normal_equations();
    matrix.cholesky().map(|factor| factor.solve(&-gradient))
}

/// Covariance of a fitted model's parameters, under residuals that remember; `None` where the run does not determine them.
pub fn covariance(case: &Case<'_>, fit: &Fit) -> Option<DMatrix<f64>> {
    let (gram, scores) = linearised(case, fit, &fit.model.parameters())?;
    Some(scores.covariance(&inverse_of_normal(&gram.normal_equations().0)?))
}

/// Residuals learned from and their slopes, reduced; the gratings of a sample belong together.
fn linearised(case: &Case<'_>, now: &Fit, parameters: &[Parameter]) -> Option<(Gram, Scores)> {
    let start_s = case.samples.first()?.time_s;
    let slopes: Vec<Vec<Vec<f64>>> = parameters
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
        .collect::<Option<_>>()?;
    let count = parameters.len();
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
    Some((gram, scores))
}
