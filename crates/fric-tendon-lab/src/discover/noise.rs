//! The part of a residual that is more than noise.
//!
//! Model errors change slowly, so consecutive samples share them, whereas white noise is uncorrelated. The mean product of a residual with its copy
//! some samples later is therefore the square of the model error, without the noise and without a noise estimate. For white noise it is 0 with a
//! standard error of the mean square divided by the root of the number of products. The size of the gap before plays no role.

use super::case::{Case, Fit};

/// Number of following samples with which each residual is multiplied. A model error that lasts for fewer samples, such as the reversal of a hole, is
/// only partly detected.
const LAGS: usize = 4;
/// Number of standard errors beyond which a mean product is not noise: one in a thousand.
const STANDARD_ERRORS: f64 = 3.0;
/// Negligible error in the verdict, as a fraction of the greatest tension. It is twice the difference between Dahl's contacts and holes that stick
/// and slip in runs with both directions, 0.4 mN of 1.7 N.
pub const PRACTICAL_RATIO: f64 = 0.0005;

/// The common part of consecutive samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct Common {
    products: f64,
    product_count: f64,
    squares: f64,
    count: f64,
}

impl Common {
    /// Adds a series. A gap removes its products.
    pub fn add(&mut self, series: &[f64]) {
        for (place, value) in series.iter().enumerate().filter(|(_, value)| value.is_finite()) {
            self.squares += value * value;
            self.count += 1.0;
            for later in series.iter().skip(place + 1).take(LAGS).filter(|later| later.is_finite()) {
                self.products += value * later;
                self.product_count += 1.0;
            }
        }
    }

    /// Returns the root mean square of the common part, in the unit of the series.
    pub fn rms(&self) -> f64 {
        (self.products / self.product_count.max(1.0)).max(0.0).sqrt()
    }

    /// Returns the value that chance would give.
    pub fn chance(&self) -> f64 {
        let mean_square = self.squares / self.count.max(1.0);
        (STANDARD_ERRORS * mean_square / self.product_count.max(1.0).sqrt()).sqrt()
    }
}

pub fn rms_n(fit: &Fit) -> f64 {
    fit.held_out_n.rms().unwrap_or(f64::INFINITY)
}

/// Returns the series of one grating, counted from 0.
fn series(fit: &Fit, grating: usize) -> Vec<f64> {
    fit.residual_n.iter().map(|row| row.get(grating).copied().unwrap_or(f64::NAN)).collect()
}

fn common(fit: &Fit) -> Common {
    let mut common = Common::default();
    (0..fit.model.mu.len()).for_each(|grating| common.add(&series(fit, grating)));
    common
}

/// Multiple of noise and model error from which a fit that has one μ for all holes leaves too much. Holes that differ by a tenth leave up to 1.3 of it, one
/// with half as much again 2.4.
const MISFIT: f64 = 2.0;

/// Whether consecutive values of these series have more in common than noise, the error of the model, holes that are not alike, and the error of steps that
/// were taken off all of them.
pub fn is_misfit(series: &[Vec<f64>], model_error: f64, step_count: usize) -> bool {
    let mut common = Common::default();
    for series in series {
        common.add(series);
    }
    // The size of a step is known from the change between two samples of all series, but for their white noise.
    let noise = (common.squares / common.count.max(1.0) - common.rms().powi(2)).max(0.0).sqrt();
    #[expect(clippy::cast_precision_loss, reason = "small counts")]
    let of_steps = noise * (2.0 * step_count as f64 / series.len().max(1) as f64).sqrt();
    common.rms() > MISFIT * common.chance().hypot(model_error).hypot(of_steps)
}

/// Returns the root mean square of a residual above the noise over training and held-out samples, N. Using both balances what a fit removes from one
/// and adds to the other.
pub fn excess_n(fit: &Fit) -> f64 {
    common(fit).rms()
}

/// Whether the rest is noise or negligible, so that the search ends.
pub fn is_negligible(case: &Case<'_>, fit: &Fit) -> bool {
    let common = common(fit);
    common.rms() <= common.chance().hypot(practical_n(case))
}

/// Whether the rest of one grating, counted from 0, is noise, or no more than at the other gratings, where `own` is true for those that an effect
/// accounts for. What all holes leave, such as contacts of another law, does not contradict an effect at one of them.
pub fn is_as_elsewhere(case: &Case<'_>, fit: &Fit, grating: usize, own: &dyn Fn(usize) -> bool) -> bool {
    let rest = |grating: usize| {
        let mut common = Common::default();
        common.add(&series(fit, grating));
        common
    };
    let here = rest(grating);
    let elsewhere = (0..fit.model.mu.len()).filter(|other| !own(*other)).map(|other| rest(other).rms());
    here.rms() <= here.chance().hypot(practical_n(case)).max(elsewhere.fold(0.0, f64::max))
}

/// Returns the error that is no evidence: a negligible one, and two standard errors of the tension at the base, which all gratings have in common.
fn practical_n(case: &Case<'_>) -> f64 {
    let negligible_n = PRACTICAL_RATIO * case.samples.iter().map(|sample| sample.tension_base_n).fold(0.0, f64::max);
    negligible_n.hypot(2.0 * case.base_error_n)
}
