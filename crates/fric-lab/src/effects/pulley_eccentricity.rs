//! `pulley_eccentricity` in the simulated robot: an eccentric pulley, whose lever arm varies as it turns.
//!
//! The tension at the platform is the tension behind the last pulley times `1 + a·sin φ + b·cos φ`, with `φ = 2π·l/period` and l the cable's length.

use core::f64::consts::TAU;

use super::truth::{Cause, Oscillation, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};
use crate::random::uniform;

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

#[derive(Debug)]
struct OutOfTrue(Oscillation);

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [sin_ratio, cos_ratio, period_m] = ["sin_ratio", "cos_ratio", "period_m"].map(cause.value);
    Box::new(OutOfTrue(Oscillation::new(sin_ratio, cos_ratio, period_m)))
}

impl TruthEffect for OutOfTrue {
    fn platform_factor(&self, length_m: f64) -> f64 {
        1.0 + self.0.at(length_m)
    }
}

/// Starts from every period at which the residual ripples.
fn starts(around: &Around) -> Vec<Start> {
    let of_period = |period_m: &f64| vec![("sin_ratio", 1e-3), ("cos_ratio", 1e-3), ("period_m", *period_m)];
    around.periods.with_load.iter().map(of_period).collect()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    let (ratio, phase_rad) = (scale.about(0.02), uniform(scale.random, 0.0, TAU));
    let period_m = uniform(scale.random, 0.05, 0.12);
    let (sin, cos) = libm::sincos(phase_rad);
    vec![("sin_ratio", ratio * cos), ("cos_ratio", ratio * sin), ("period_m", period_m)]
}
