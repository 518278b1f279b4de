//! `stribeck` in the simulated robot: boundary lubrication of a bearing before its film has built up.
//!
//! The additional fraction of μ falls with the speed as `exp(−(v/velocity)²)`, the law of the catalogue. The speed is the cable's momentary speed,
//! also within the cycle.

use fric_core::effects::stribeck::VELOCITY;
use fric_core::parameters::Values;

use super::truth::{Cause, Contact, TruthEffect};
use super::{Around, LabEffect, Sizing, Start};
use crate::random::uniform;

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual };

/// Start values of the speed at which friction changes, as fractions of the usual speed of the moving cable.
const SPEED_SHARES: [f64; 2] = [0.04, 0.25];

#[derive(Debug)]
struct BoundaryLayer {
    additional_ratio: f64,
    velocity_m_per_s: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [additional_ratio, velocity_m_per_s] = ["ratio", "velocity_m_per_s"].map(cause.value);
    Box::new(BoundaryLayer { additional_ratio, velocity_m_per_s })
}

impl TruthEffect for BoundaryLayer {
    fn mu_factor(&self, contact: &Contact) -> f64 {
        1.0 + self.additional_ratio * libm::exp(-libm::pow(contact.speed_m_per_s / self.velocity_m_per_s, 2.0))
    }
}

/// Starts from two speeds at which friction may change.
fn starts(around: &Around) -> Vec<Start> {
    let of_share = |share| vec![("ratio", 0.3), ("velocity_m_per_s", share * around.speed_m_per_s)];
    SPEED_SHARES.map(of_share).to_vec()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    let ratio = scale.about(0.6);
    vec![("ratio", ratio), ("velocity_m_per_s", 0.03 * uniform(scale.random, 0.85, 1.15))]
}

/// Below the speed at which noise moves the length from sample to sample, the log does not show the cable's friction: contacts that the noise shakes loose
/// at rest look the same.
fn is_more_than_usual(values: &Values, around: &Around) -> bool {
    values[VELOCITY] * around.interval_s > around.length_noise_m
}
