//! What of a residual is more than noise.
//!
//! What a model misses changes slowly: samples that follow each other have it in common, and of white noise nothing. So the mean product of a residual
//! with itself some samples later is the square of what is missed, without the noise and without an estimate of it; of white noise
//! alone it is 0 with a standard error of the mean square over the root of the number of products. How large the gap was before does not enter.

use super::case::{Case, Fit};

/// A residual is multiplied with each of so many that follow. What is over within fewer samples, as the turning round of a hole, shows in part only.
const LAGS: usize = 4;
/// Standard errors beyond which a mean product is not noise: one in a thousand.
const STANDARD_ERRORS: f64 = 3.0;
/// Share of the greatest tension that is practically nothing in the verdict: twice what Dahl's contacts make of holes that stick and slip in runs with
/// both directions, 0.4 mN of 1.7 N.
const PRACTICAL_RATIO: f64 = 0.0005;

/// What neighbours have in common.
#[derive(Clone, Copy, Debug, Default)]
pub struct Common {
    products: f64,
    product_count: f64,
    squares: f64,
    count: f64,
}

impl Common {
    /// Takes in a series; a gap takes its products with it.
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

    /// Root mean square of what is common, in the unit of the series.
    pub fn rms(&self) -> f64 {
        (self.products / self.product_count.max(1.0)).max(0.0).sqrt()
    }

    /// What chance makes of it.
    pub fn chance(&self) -> f64 {
        let mean_square = self.squares / self.count.max(1.0);
        (STANDARD_ERRORS * mean_square / self.product_count.max(1.0).sqrt()).sqrt()
    }
}

pub fn rms_n(fit: &Fit) -> f64 {
    fit.held_out_n.rms().unwrap_or(f64::INFINITY)
}

/// Of one grating, from 0.
fn series(fit: &Fit, grating: usize) -> Vec<f64> {
    fit.residual_n.iter().map(|row| row.get(grating).copied().unwrap_or(f64::NAN)).collect()
}

fn common(fit: &Fit) -> Common {
    let mut common = Common::default();
    (0..fit.model.mu.len()).for_each(|grating| common.add(&series(fit, grating)));
    common
}

/// What a residual has above the noise, root mean square over learned and held-out samples, N: what a fit takes from the one it adds to the other.
pub fn excess_n(fit: &Fit) -> f64 {
    common(fit).rms()
}

/// Whether what is left is noise, or practically nothing: nothing to look for.
pub fn is_negligible(case: &Case<'_>, fit: &Fit) -> bool {
    let common = common(fit);
    common.rms() <= common.chance().hypot(practical_n(case))
}

/// Whether one grating, from 0, has noise left alone.
pub fn is_noise_at(case: &Case<'_>, fit: &Fit, grating: usize) -> bool {
    let mut common = Common::default();
    common.add(&series(fit, grating));
    common.rms() <= common.chance().hypot(practical_n(case))
}

fn practical_n(case: &Case<'_>) -> f64 {
    PRACTICAL_RATIO * case.samples.iter().map(|sample| sample.tension_base_n).fold(0.0, f64::max)
}
