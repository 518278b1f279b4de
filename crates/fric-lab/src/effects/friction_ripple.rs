//! `friction_ripple` in the simulated robot: bearings whose friction varies over a revolution.
//!
//! μ of all pulleys is multiplied by `1 + a·sin φ`, where `φ` is `2π·l/period` plus a phase and l the length of the cable.

use core::f64::consts::TAU;

use super::truth::{Cause, Contact, Oscillation, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};
use crate::random::uniform;

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

#[derive(Debug)]
struct Uneven(Oscillation);

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [sin, cos, period_m] = ["sin_ratio", "cos_ratio", "period_m"].map(cause.value);
    Box::new(Uneven(Oscillation::new(sin, cos, period_m)))
}

impl TruthEffect for Uneven {
    fn mu_factor(&self, contact: &Contact) -> f64 {
        1.0 + self.0.at(contact.length_m)
    }
}

/// Starts from every period at which the residual ripples and reverses with the motion.
fn starts(around: &Around) -> Vec<Start> {
    let of_period = |period_m: &f64| vec![("sin_ratio", 0.01), ("cos_ratio", 0.01), ("period_m", *period_m)];
    around.periods.with_friction.iter().map(of_period).collect()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    let (ratio, phase_rad) = (scale.about(0.3), uniform(scale.random, 0.0, TAU));
    let period_m = uniform(scale.random, 0.05, 0.12);
    let (sin, cos) = libm::sincos(phase_rad);
    vec![("sin_ratio", ratio * cos), ("cos_ratio", ratio * sin), ("period_m", period_m)]
}
