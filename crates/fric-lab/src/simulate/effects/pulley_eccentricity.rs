//! `pulley_eccentricity` in the simulated robot: a pulley out of true, whose lever arm goes up and down as it turns.
//!
//! The tension at the platform is that behind the last pulley times `1 + a·sin φ + b·cos φ`, `φ = 2π·l/period`, l the
//! cable's length.

use core::f64::consts::TAU;

use super::{Cause, TruthEffect};

#[derive(Debug)]
struct OutOfTrue {
    amplitude_ratio: f64,
    phase_rad: f64,
    rad_per_m: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [sin_ratio, cos_ratio, period_m] = ["sin_ratio", "cos_ratio", "period_m"].map(cause.value);
    Box::new(OutOfTrue {
        amplitude_ratio: libm::hypot(sin_ratio, cos_ratio),
        phase_rad: libm::atan2(cos_ratio, sin_ratio),
        rad_per_m: TAU / period_m,
    })
}

impl TruthEffect for OutOfTrue {
    fn platform_factor(&self, length_m: f64) -> f64 {
        1.0 + self.amplitude_ratio * libm::sin(self.rad_per_m * length_m + self.phase_rad)
    }
}
