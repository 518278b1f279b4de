//! Whether an effect is the one constant that its name promises.
//!
//! A physical effect has one size, whatever the cable does. Something else that is taken for it has another size in each operating
//! condition: what is called a presliding exponent over short ways is none over long ones. So the size of the effect is
//! estimated anew in the bins of every condition, by one step of least squares from the fitted model with everything else in it
//! allowed for, and compared with the size over all.
//!
//! With `e` the force that the effect adds, `ẽ` what is left of it when all other parameters make up for what they can, and `r` the
//! residual, the size in a bin as a share of the fitted one is `1 − Σẽr/Σẽ²` over the bin's samples.

use fric_core::parameters::Values;

use super::projection::less_projection;
use crate::discover::workbench::{Trial, Workbench};
use crate::fit::Parameter;
use crate::samples::bins::Bins;
use crate::samples::conditions::Condition;
use crate::search::problem::Problem;

/// An effect as a share of its fitted size, over one condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steadiness {
    /// The condition.
    pub signal: &'static str,
    /// Mean square by which the size differs from the fitted one over the bins, weighed by what each tells of it, less what chance makes of it.
    pub scatter: f64,
    /// What is above the noise that the effect would explain if it grew or fell in proportion to the condition, as a share.
    pub bent: f64,
    /// By how much it would then grow or fall over the range of the condition, as a share of its fitted size.
    pub tilt: f64,
}

/// What an effect adds to a model, with everything else allowed for.
pub struct Portrait<'a> {
    residual_n: Vec<f64>,
    own_n: Vec<f64>,
    conditions: &'a [Condition],
    noise_n: f64,
    inflation: f64,
}

impl<'a> Portrait<'a> {
    /// Of an effect with these fitted parameters; `neutral` are the model's values without it. `noise` is the standard deviation of the noise, N, and
    /// how many samples are worth an independent one. `None` where there are no numbers.
    pub fn of(
        bench: &Workbench<'_>,
        model: &Trial,
        of: &[Parameter],
        neutral: &Values,
        conditions: &'a [Condition],
        (noise_n, inflation): (f64, f64),
    ) -> Option<Self> {
        let others: Vec<Parameter> = model.free.iter().filter(|parameter| !of.contains(parameter)).copied().collect();
        let problem = Problem { used: bench.counts.to_vec(), ..bench.problem(&others, None) };
        let residual_n = bench.residuals_n(&model.values);
        let without_n = bench.residuals_n(neutral);
        let added_n: Vec<f64> = residual_n.iter().zip(&without_n).map(|(with, without)| with - without).collect();
        let own_n = less_projection(&problem, &model.values, &[added_n])?.pop()?;
        Some(Self { residual_n, own_n, conditions, noise_n, inflation })
    }

    /// Mean square by which chance scatters a sum of products, N²: that of the residual, by how many of its samples are worth an
    /// independent one. What other effects have left scatters the sums as noise does.
    fn variance(&self) -> f64 {
        let finite = self.residual_n.iter().filter(|number| number.is_finite());
        let (squares, count) =
            finite.fold((0.0, 0.0), |(squares, count), number| (squares + number * number, count + 1.0));
        squares / count * self.inflation
    }

    /// The steadiness over each condition that is divided into bins.
    pub fn steadiness(&self) -> Vec<Steadiness> {
        let finite = self.residual_n.iter().filter(|number| number.is_finite());
        let excess: f64 = finite.map(|number| number * number - self.noise_n * self.noise_n).sum();
        self.conditions.iter().filter_map(|condition| self.over(condition, excess)).collect()
    }

    fn over(&self, condition: &Condition, excess: f64) -> Option<Steadiness> {
        let bins = Bins::new(condition, &self.residual_n)?;
        let (first, last) = (*bins.edges.first()?, *bins.edges.last()?);
        // Of each bin, and of the condition as a whole, from 0 to 1.
        let mut sums = vec![(0.0_f64, 0.0_f64); bins.count()];
        let (mut tilt, mut moments) = (0.0, [0.0_f64; 3]);
        let samples = condition.values.iter().zip(&self.residual_n).zip(&self.own_n);
        for ((value, residual_n), own_n) in samples.filter(|((_, r), own)| r.is_finite() && own.is_finite()) {
            let Some((product, square)) = bins.of(*value).and_then(|bin| sums.get_mut(bin)) else { continue };
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
