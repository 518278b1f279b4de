//! `winch_ripple` in the simulated robot: a cogging motor, whose current measures the force.
//!
//! The sensor signal ripples as the motor turns, by a force that is independent of the load.

use core::f64::consts::TAU;

use super::truth::{Cause, Oscillation, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};
use crate::random::uniform;

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

#[derive(Debug)]
struct Cogging(Oscillation);

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [sin, cos, period_m] = ["sin_n", "cos_n", "period_m"].map(cause.value);
    Box::new(Cogging(Oscillation::new(sin, cos, period_m)))
}

impl TruthEffect for Cogging {
    fn winch_force_n(&self, length_m: f64) -> f64 {
        self.0.at(length_m)
    }
}

/// Starts from every period at which the residual ripples independently of the load.
fn starts(around: &Around) -> Vec<Start> {
    let least_n = 1e-3 * around.tension_n;
    let of_period = |period_m: &f64| vec![("sin_n", least_n), ("cos_n", least_n), ("period_m", *period_m)];
    around.periods.alone.iter().map(of_period).collect()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    // As shown by a sensor at 180°, which measures the cable force twice.
    let (force_n, phase_rad) = (scale.about(0.04 * scale.tension_n), uniform(scale.random, 0.0, TAU));
    let period_m = uniform(scale.random, 0.02, 0.06);
    let (sin, cos) = libm::sincos(phase_rad);
    vec![("sin_n", force_n * cos), ("cos_n", force_n * sin), ("period_m", period_m)]
}
