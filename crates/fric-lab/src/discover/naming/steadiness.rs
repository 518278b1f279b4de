//! Tests whether an effect has one constant size.
//!
//! A physical effect has one size, whatever the cable does. Something else that is mistaken for it has a different size in each operating condition:
//! a presliding exponent found over short strokes disappears over long ones. So the size of the effect is estimated again in the bins of every
//! condition, by one least-squares step from the fitted model with all other parameters free, and compared with the overall size.
//!
//! Let `e` be the force that the effect adds, `ẽ` the part of it that the other parameters cannot compensate, and `r` the residual. The size in a
//! bin, relative to the fitted size, is `1 − Σẽr/Σẽ²` over the bin's samples.

use fric_core::parameters::Values;

use super::projection::{Signals, visit_less_projection};
use crate::discover::workbench::{Trial, Workbench};
use crate::fit::Parameter;
use crate::samples::bins::Bins;
use crate::samples::conditions::{Condition, LOG};
use crate::search::problem::Problem;

/// Relative size of an effect over one condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steadiness {
    /// The condition.
    pub signal: &'static str,
    /// Weighted mean square deviation of the size from the fitted one over the bins, minus the contribution of chance. The weights are the
    /// information of the bins.
    pub scatter: f64,
    /// Fraction of the excess above the noise that the effect would explain if its size varied linearly with the condition.
    pub bent: f64,
    /// Change of the size over the range of the condition in that case, relative to the fitted size.
    pub tilt: f64,
}

/// The contribution of an effect to a model that the other parameters cannot compensate.
pub struct Portrait<'a> {
    residual_n: Vec<f64>,
    own_n: Vec<f64>,
    conditions: &'a [Condition<'a>],
    noise_n: f64,
    inflation: f64,
}

impl<'a> Portrait<'a> {
    /// Computes the portrait of an effect with these fitted parameters. `neutral` are the model's values without it. `noise` holds the standard
    /// deviation of the noise, N, and the number of samples that are worth one independent sample. Returns `None` if a number is not finite.
    pub fn of(
        bench: &Workbench<'_>,
        model: &Trial,
        of: &[Parameter],
        neutral: &Values,
        conditions: &'a [Condition<'a>],
        (noise_n, inflation): (f64, f64),
    ) -> Option<Self> {
        let others: Vec<Parameter> = model.free.iter().filter(|parameter| !of.contains(parameter)).copied().collect();
        let problem = Problem { used: bench.counts.to_vec(), ..bench.problem(&others, None) };
        let (with, without) = (bench.evaluated(&model.values), bench.evaluated(neutral));
        let added_n = || -> Signals<'_> {
            Box::new(|cycle, numbers| numbers.push(with.residual_n(cycle) - without.residual_n(cycle)))
        };
        let mut own_n = vec![f64::NAN; bench.counts.len()];
        visit_less_projection(&problem, &model.values, &added_n, |cycle, numbers| {
            own_n.get_mut(cycle).into_iter().zip(numbers).for_each(|(own_n, number)| *own_n = *number);
        })?;
        let residual_n = with.residuals_n().collect();
        Some(Self { residual_n, own_n, conditions, noise_n, inflation })
    }

    /// Returns the variance by chance of a sum of products, N²: the variance of the residual times the number of its samples that are worth one
    /// independent sample. What other effects have left scatters the sums as noise does.
    fn variance(&self) -> f64 {
        let finite = self.residual_n.iter().filter(|number| number.is_finite());
        let (squares, count) =
            finite.fold((0.0, 0.0), |(squares, count), number| (squares + number * number, count + 1.0));
        squares / count * self.inflation
    }

    /// Returns the steadiness over each condition that is divided into bins.
    pub fn steadiness(&self) -> Vec<Steadiness> {
        let finite = self.residual_n.iter().filter(|number| number.is_finite());
        let excess: f64 = finite.map(|number| number * number - self.noise_n * self.noise_n).sum();
        let over = |condition| self.over(condition, excess);
        let log = self.conditions.iter().find(|condition| condition.signal == LOG);
        self.conditions.iter().filter_map(over).chain(log.and_then(|log| self.within(log))).collect()
    }

    /// Returns the steadiness from what changes in a log to what differs between logs. Of several short logs, what differs between them easily looks like
    /// an effect of their durations or speeds.
    fn within(&self, log: &Condition<'_>) -> Option<Steadiness> {
        // By log: the count, and the sums of both, of the products and of the squares.
        let mut sums: Vec<(f64, [f64; 5])> = Vec::new();
        let samples = log.values().zip(&self.residual_n).zip(&self.own_n);
        for ((number, residual_n), own_n) in samples.filter(|((_, r), own)| r.is_finite() && own.is_finite()) {
            if sums.last().is_none_or(|(last, _)| (last - number).abs() > 0.0) {
                sums.push((number, [0.0; 5]));
            }
            let of_sample = [1.0, *residual_n, *own_n, own_n * residual_n, own_n * own_n];
            let all = sums.last_mut().into_iter().flat_map(|(_, sums)| sums);
            all.zip(of_sample).for_each(|(sum, number)| *sum += number);
        }
        let centred = |[count, residual, own, product, square]: [f64; 5]| {
            [product - own * residual / count, square - own * own / count]
        };
        let [product, square] = sums
            .into_iter()
            .map(|(_, sums)| centred(sums))
            .fold([0.0; 2], |sum, of_log| [sum[0] + of_log[0], sum[1] + of_log[1]]);
        let scatter = (product * product / square - self.variance()) / square;
        (square > 0.0).then_some(Steadiness { signal: LOG, scatter, bent: 0.0, tilt: 0.0 })
    }

    fn over(&self, condition: &Condition<'_>, excess: f64) -> Option<Steadiness> {
        let bins = Bins::new(condition, &self.residual_n)?;
        let (first, last) = (*bins.edges.first()?, *bins.edges.last()?);
        // Sums per bin, and over the whole condition scaled to 0…1.
        let mut sums = vec![(0.0_f64, 0.0_f64); bins.count()];
        let (mut tilt, mut moments) = (0.0, [0.0_f64; 3]);
        let samples = condition.values().zip(&self.residual_n).zip(&self.own_n);
        for ((value, residual_n), own_n) in samples.filter(|((_, r), own)| r.is_finite() && own.is_finite()) {
            let Some((product, square)) = bins.of(value).and_then(|bin| sums.get_mut(bin)) else { continue };
            let (at, of_sample) = ((value - first) / (last - first), own_n * own_n);
            (*product, *square) = (*product + own_n * residual_n, *square + of_sample);
            tilt += at * own_n * residual_n;
            moments = [moments[0] + of_sample, moments[1] + at * of_sample, moments[2] + at * at * of_sample];
        }
        let product: f64 = sums.iter().map(|(product, _)| product).sum();
        let scatter = |(product, square): &(f64, f64)| (product * product / square - self.variance()) / moments[0];
        let lever = moments[2] - moments[1] * moments[1] / moments[0];
        let bend = tilt - product * moments[1] / moments[0];
        Some(Steadiness {
            signal: condition.signal,
            scatter: sums.iter().filter(|(_, square)| *square > 0.0).map(scatter).sum(),
            bent: if lever > 0.0 { (bend * bend / lever - self.variance()) / excess } else { 0.0 },
            tilt: if lever > 0.0 { (bend / lever).abs() } else { 0.0 },
        })
    }
}
