//! A model's numbers by least squares over what is learned from: Gauss–Newton with slopes by differences, which are taken once, for the
//! tensions are nearly linear in all of them.

use nalgebra::{DMatrix, DVector};

use super::case::{Case, Fit};
use super::model::{Model, Parameter};
use super::spread::shared_spread;
use crate::fit::engine::{Gram, Scores, inverse_of_normal};

const MOST_STEPS: u32 = 8;
const MOST_HALVINGS: u32 = 6;
/// A step that lowers the sum of squares by less is the last.
const SETTLED_RATIO: f64 = 1e-6;

/// The model with its numbers fitted; `None` where it has no shapes.
pub fn fitted(case: &Case<'_>, start: &Model) -> Option<Fit> {
    let mut now = case.fit(start)?;
    let parameters = start.parameters();
    if parameters.is_empty() {
        return Some(now);
    }
    let slopes = slopes(case, &now, &parameters)?;
    for _ in 0..MOST_STEPS {
        // The lines' errors find their minimum by themselves.
        let Some(step) = Linearised::new(case, &now, &slopes).map(|problem| problem.step()) else { break };
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

/// Covariance of a fitted model's parameters: under residuals that remember, under lines of the gratings that are known no better than their
/// calibration makes them, and under holes that share a μ although each has its own; `None` where the run does not determine them.
///
/// A hole whose μ is off by δ moves the parameters by `(JᵀJ)⁻¹Jᵀs·δ` with the slopes `s` of the tensions (delta method). The shared μ is that of the
/// mean hole, which moves too, by its share. How far holes are off in the mean is estimated from the run ([`shared_spread`]).
pub fn covariance(case: &Case<'_>, fit: &Fit) -> Option<DMatrix<f64>> {
    let parameters = fit.model.parameters();
    let by_parameters = slopes(case, fit, &parameters)?;
    let problem = Linearised::new(case, fit, &by_parameters)?;
    let mut covariance = problem.covariance();
    let shared: Vec<usize> = (0..fit.model.mu.len()).filter(|hole| !fit.model.is_own[*hole]).collect();
    let Some(place) = parameters.iter().position(|parameter| *parameter == Parameter::SharedMu) else {
        return Some(covariance);
    };
    let each: Vec<Parameter> = shared.iter().copied().map(Parameter::OwnMu).collect();
    let others = parameters.iter().copied().filter(|parameter| *parameter != Parameter::SharedMu);
    let all: Vec<Parameter> = each.iter().copied().chain(others).collect();
    let all_slopes = slopes(case, fit, &all)?;
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

/// Derivatives of the residuals by each parameter.
pub type Slopes = Vec<Vec<Vec<f64>>>;

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
                let moved = now.model.with(*mu, value + change);
                let change = moved.get(*mu) - value;
                let slope = |(moved_n, now_n): (&f64, &f64)| (now_n - moved_n) / change;
                let rows = case.tensions_n(&moved)?.into_iter().zip(&now.tension_n);
                Some(rows.map(|(moved_n, now_n)| moved_n.iter().zip(now_n).map(slope).collect()).collect())
            }
        })
        .collect()
}

/// Residuals learned from and their slopes, those by the errors of the gratings' lines last, reduced.
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
    /// `None` where the run does not determine the parameters. The gratings of a sample belong together.
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

    /// To the minimum.
    pub fn step(&self) -> DVector<f64> {
        -(&self.inverse * &self.gradient).rows(0, self.parameters).into_owned()
    }

    /// Of the parameters: that of generalised least squares, and where the residuals remember, of each parameter the greater variance that
    /// blocks of the run tell. Blocks alone tell too little: a short run has fewer of them than a fit has numbers.
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

    /// How the parameters move with something that has these slopes, by one of it.
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

/// Slopes of one residual: by the parameters, and by the errors of all lines, of which its own alone matter.
fn row_of(case: &Case<'_>, slopes: &Slopes, sample: usize, segment: usize) -> Vec<f64> {
    let mut numbers: Vec<f64> = slopes.iter().map(|all| all[sample][segment]).collect();
    for (line, errors_n) in case.line_error_n[sample].iter().enumerate() {
        numbers.extend(errors_n.map(|error_n| if line == segment { -error_n } else { 0.0 }));
    }
    numbers
}
