//! Fits a model's numbers to the training samples by least squares: Gauss–Newton with slopes by finite differences. The slopes are computed once,
//! because the tensions are nearly linear in all numbers.

use fric_lab::statistics::{Gram, Scores, inverse_of_normal};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::model::{Model, Parameter};
use super::spread::shared_spread;
use crate::discover::case::{Case, Fit};
use crate::shape_errors::Way;

const MOST_STEPS: u32 = 8;
const MOST_HALVINGS: u32 = 6;
/// Relative decrease of the sum of squares below which a step is not taken; a step that achieves less is the last one.
const SETTLED_RATIO: f64 = 1e-6;

/// Returns the model with its numbers fitted; `None` if it has no shapes.
pub fn fitted(case: &Case<'_>, start: &Model) -> Option<Fit> {
    let now = case.fit(start)?;
    let slopes = start.parameters().iter().map(|parameter| by_parameter(case, &now, *parameter)).collect::<Option<_>>();
    Some(descended(case, now, &slopes?))
}

/// Does the same from an evaluated start, with slopes that all candidates beside a model share.
pub fn fitted_from(case: &Case<'_>, now: Fit, by_hole: &HoleSlopes) -> Option<Fit> {
    let slopes = by_hole.slopes(case, &now.model, &now.model.parameters())?;
    Some(descended(case, now, &slopes))
}

fn descended(case: &Case<'_>, mut now: Fit, slopes: &Slopes) -> Fit {
    let parameters = now.model.parameters();
    if parameters.is_empty() {
        return now;
    }
    for _ in 0..MOST_STEPS {
        // The errors of the calibration lines are minimised directly.
        let Some(problem) = Linearised::new(case, &now, slopes) else { break };
        if problem.gain_n2() < SETTLED_RATIO * now.squares {
            break;
        }
        let step = problem.step();
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
    now
}

/// Returns the covariance of a fitted model's parameters. It accounts for correlated residuals, for the calibration errors of the gratings, and for
/// holes that share a μ although each has its own. Returns `None` if the run does not determine the parameters.
///
/// An error δ of a hole's μ moves the parameters by `(JᵀJ)⁻¹Jᵀs·δ`, with the slopes `s` of the tensions (delta method). The shared μ is that of the
/// mean hole, which moves as well, by its share. The mean error of the holes is estimated from the run ([`shared_spread`]).
pub fn covariance(case: &Case<'_>, fit: &Fit) -> Option<DMatrix<f64>> {
    let parameters = fit.model.parameters();
    let by_hole = HoleSlopes::new(case, fit)?;
    let by_parameters = by_hole.slopes(case, &fit.model, &parameters)?;
    let problem = Linearised::new(case, fit, &by_parameters)?;
    let mut covariance = problem.covariance();
    let shared: Vec<usize> = (0..fit.model.mu.len()).filter(|hole| !fit.model.is_own[*hole]).collect();
    let Some(place) = parameters.iter().position(|parameter| *parameter == Parameter::SharedMu) else {
        return Some(covariance);
    };
    let each: Vec<Parameter> = shared.iter().copied().map(Parameter::OwnMu).collect();
    let others = parameters.iter().copied().filter(|parameter| *parameter != Parameter::SharedMu);
    let all: Vec<Parameter> = each.iter().copied().chain(others).collect();
    let all_slopes = by_hole.slopes(case, &fit.model, &all)?;
    let spread_ratio = shared_spread(&Linearised::new(case, fit, &all_slopes)?, &fit.model, &shared);
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let share = 1.0 / shared.len() as f64;
    for (hole, slopes) in shared.iter().zip(&all_slopes) {
        let off = spread_ratio * fit.model.mu[*hole];
        let mut change = problem.moved_by(case, slopes, &by_parameters) * off;
        change[place] -= share * spread_ratio * fit.model.get(Parameter::SharedMu);
        covariance += &change * change.transpose();
    }
    Some(covariance)
}

/// Derivatives of the residuals with respect to each parameter.
pub type Slopes = Vec<Vec<Vec<f64>>>;

/// Derivatives of the residuals with respect to the μ of each hole; empty without friction. Those with respect to other parameters follow from them.
pub struct HoleSlopes(Slopes);

impl HoleSlopes {
    /// Computes the slopes. Returns `None` if the model has no shapes.
    pub fn new(case: &Case<'_>, now: &Fit) -> Option<Self> {
        let count = if now.model.way == Way::None { 0 } else { now.model.mu.len() };
        let by_hole = (0..count).into_par_iter().map(|hole| by_parameter(case, now, Parameter::OwnMu(hole)));
        by_hole.collect::<Option<_>>().map(Self)
    }

    fn slopes(&self, case: &Case<'_>, model: &Model, parameters: &[Parameter]) -> Option<Slopes> {
        let of = |parameter: &Parameter| match parameter {
            Parameter::Drift(grating) => by_drift(case, *grating),
            Parameter::OwnMu(hole) => self.0.get(*hole).cloned(),
            Parameter::SharedMu => self.by_shared_mu(model),
        };
        parameters.iter().map(of).collect()
    }

    /// Scales all holes that share a μ together.
    fn by_shared_mu(&self, model: &Model) -> Option<Vec<Vec<f64>>> {
        let shared_mu = model.get(Parameter::SharedMu);
        let mut sum: Vec<Vec<f64>> = self.0.first()?.iter().map(|row| vec![0.0; row.len()]).collect();
        let holes = self.0.iter().zip(&model.mu).zip(&model.is_own).filter(|(_, is_own)| !**is_own);
        for ((by_hole, mu), _) in holes {
            for (sum, by_hole) in sum.iter_mut().flatten().zip(by_hole.iter().flatten()) {
                *sum += mu / shared_mu * by_hole;
            }
        }
        Some(sum)
    }
}

/// Returns the derivatives with respect to one parameter, by finite differences if it is a μ.
fn by_parameter(case: &Case<'_>, now: &Fit, parameter: Parameter) -> Option<Vec<Vec<f64>>> {
    if let Parameter::Drift(grating) = parameter {
        return by_drift(case, grating);
    }
    let value = now.model.get(parameter);
    let moved = now.model.with(parameter, value + 0.02 * value.max(0.02));
    let change = moved.get(parameter) - value;
    let slope = |(moved_n, now_n): (&f64, &f64)| (now_n - moved_n) / change;
    let rows = case.tensions_n(&moved)?.into_iter().zip(&now.tension_n);
    Some(rows.map(|(moved_n, now_n)| moved_n.iter().zip(now_n).map(slope).collect()).collect())
}

fn by_drift(case: &Case<'_>, grating: usize) -> Option<Vec<Vec<f64>>> {
    let start_s = case.samples.first()?.time_s;
    let row = |time_s: f64| {
        let mut row = vec![0.0; case.newton_per_nm.len()];
        row[grating] = start_s - time_s;
        row
    };
    Some(case.samples.iter().map(|sample| row(sample.time_s)).collect())
}

/// Training residuals and their slopes in reduced form, with the errors of the calibration lines last.
pub struct Linearised {
    parameters: usize,
    gradient: DVector<f64>,
    inverse: DMatrix<f64>,
    scores: Scores,
    noise_n: f64,
    /// Mean square of the residuals.
    variance_n2: f64,
}

impl Linearised {
    /// Linearises the problem. Returns `None` if the run does not determine the parameters. The gratings of a sample belong together.
    fn new(case: &Case<'_>, now: &Fit, slopes: &Slopes) -> Option<Self> {
        let (parameters, lines) = (slopes.len(), 2 * now.line_errors.len());
        let count = parameters + lines;
        let (mut gram, mut scores) = (Gram::new(count), Scores::new(count));
        for (sample, row) in now.residual_n.iter().enumerate().filter(|(sample, _)| !case.held_out[*sample]) {
            let mut score = vec![0.0; count];
            for (segment, residual_n) in row.iter().enumerate() {
                let mut numbers = row_of(case, slopes, sample, segment);
                numbers.push(*residual_n);
                if numbers.iter().all(|number| number.is_finite()) {
                    gram.add(&numbers);
                    score.iter_mut().zip(&numbers).for_each(|(score, slope)| *score += slope * residual_n);
                }
            }
            scores.add(&score);
        }
        for (line, errors) in now.line_errors.iter().flatten().enumerate() {
            let mut numbers = vec![0.0; count + 1];
            numbers[parameters + line] = case.noise_n;
            numbers[count] = case.noise_n * errors;
            gram.add(&numbers);
        }
        let (matrix, gradient, squares) = gram.normal_equations();
        let inverse = inverse_of_normal(&matrix)?;
        #[expect(clippy::cast_precision_loss, reason = "a count of parameters")]
        let variance_n2 = squares / (case.learned_count() - parameters as f64).max(1.0);
        Some(Self { parameters, gradient, inverse, scores, noise_n: case.noise_n, variance_n2 })
    }

    /// Returns the decrease of the sum of squares by the step, N².
    fn gain_n2(&self) -> f64 {
        self.gradient.dot(&(&self.inverse * &self.gradient))
    }

    /// Returns the step to the minimum.
    pub fn step(&self) -> DVector<f64> {
        -(&self.inverse * &self.gradient).rows(0, self.parameters).into_owned()
    }

    /// Returns the covariance of the parameters: that of generalised least squares or, for each parameter with correlated residuals, the greater
    /// variance from blocks of the run. Blocks alone are not enough, because a short run has fewer of them than a fit has numbers.
    pub fn covariance(&self) -> DMatrix<f64> {
        let white = &self.inverse * self.variance_n2;
        let mut in_blocks = self.scores.covariance(&self.inverse);
        let lines = self.inverse.columns(self.parameters, self.inverse.ncols() - self.parameters);
        in_blocks += lines * lines.transpose() * self.variance_n2 * self.noise_n.powi(2);
        let factor = |place: usize| (in_blocks[(place, place)] / white[(place, place)]).max(1.0).sqrt();
        DMatrix::from_fn(self.parameters, self.parameters, |row, column| {
            factor(row) * factor(column) * white[(row, column)]
        })
    }

    /// Returns the change of the parameters per unit of a cause with these slopes.
    fn moved_by(&self, case: &Case<'_>, slopes_by_it: &[Vec<f64>], slopes: &Slopes) -> DVector<f64> {
        let mut pull = DVector::zeros(self.inverse.ncols());
        for (sample, row) in slopes_by_it.iter().enumerate().filter(|(sample, _)| !case.held_out[*sample]) {
            for (segment, by_it) in row.iter().enumerate() {
                let numbers = row_of(case, slopes, sample, segment);
                if by_it.is_finite() && numbers.iter().all(|number| number.is_finite()) {
                    pull.iter_mut().zip(numbers).for_each(|(pull, slope)| *pull += slope * by_it);
                }
            }
        }
        (&self.inverse * pull).rows(0, self.parameters).into_owned()
    }
}

/// Returns the slopes of one residual: with respect to the parameters and to the errors of all lines, of which only its own is non-zero.
fn row_of(case: &Case<'_>, slopes: &Slopes, sample: usize, segment: usize) -> Vec<f64> {
    let mut numbers: Vec<f64> = slopes.iter().map(|all| all[sample][segment]).collect();
    for (line, errors_n) in case.line_error_n[sample].iter().enumerate() {
        numbers.extend(errors_n.map(|error_n| if line == segment { -error_n } else { 0.0 }));
    }
    numbers
}
