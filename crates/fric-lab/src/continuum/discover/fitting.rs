//! A model's numbers by least squares over what is learned from: Gauss–Newton with slopes by differences, for the tensions are nearly
//! linear in all of them.

use nalgebra::{DMatrix, DVector};

use super::case::{Case, Fit};
use super::model::{Model, Parameter};

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
    let (mut matrix, mut right) = (DMatrix::<f64>::zeros(count, count), DVector::<f64>::zeros(count));
    for (sample, row) in now.residual_n.iter().enumerate().filter(|(sample, _)| !case.held_out[*sample]) {
        for (segment, residual_n) in row.iter().enumerate() {
            let slope: Vec<f64> = slopes.iter().map(|all| all[sample][segment]).collect();
            if !residual_n.is_finite() || slope.iter().any(|slope| !slope.is_finite()) {
                continue;
            }
            for one in 0..count {
                right[one] -= slope[one] * residual_n;
                for other in 0..count {
                    matrix[(one, other)] += slope[one] * slope[other];
                }
            }
        }
    }
    matrix.cholesky().map(|factor| factor.solve(&right))
}
