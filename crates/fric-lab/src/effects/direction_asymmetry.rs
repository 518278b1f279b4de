//! `direction_asymmetry` in the simulated robot: bearings with more friction in one direction of rotation, for instance due to tilted rollers.
//!
//! When the cable pays out, both kinds of friction are greater by their ratios; when it reels in, they are smaller by the same. The direction is the
//! momentary one of the cable over the pulley.

use fric_core::effects::direction_asymmetry::{COULOMB, VISCOUS as VISCOUS_RATIO};
use fric_core::parameters::{MU, VISCOUS, Values};

use super::truth::{Cause, Contact, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, as_it_is};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts: as_it_is, typical, is_more_than_usual };

#[derive(Debug)]
struct Tilted {
    coulomb_ratio: f64,
    viscous_ratio: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [coulomb_ratio, viscous_ratio] = ["coulomb_ratio", "viscous_ratio"].map(cause.value);
    Box::new(Tilted { coulomb_ratio, viscous_ratio })
}

impl TruthEffect for Tilted {
    fn mu_factor(&self, contact: &Contact) -> f64 {
        if contact.speed_m_per_s < 0.0 { 1.0 - self.coulomb_ratio } else { 1.0 + self.coulomb_ratio }
    }

    fn viscous_factor(&self, speed_m_per_s: f64) -> f64 {
        if speed_m_per_s < 0.0 { 1.0 - self.viscous_ratio } else { 1.0 + self.viscous_ratio }
    }
}

/// Whether the two directions differ by more than laws of friction do.
fn is_more_than_usual(values: &Values, around: &Around) -> bool {
    let bearings_n = values[MU] * around.wrap_factor_sum * around.tension_n;
    let viscous_n = values[VISCOUS] * f64::from(around.pulley_count) * around.speed_m_per_s;
    let more_n = values[COULOMB].abs() * bearings_n + values[VISCOUS_RATIO].abs() * viscous_n;
    more_n > around.between_laws_ratio(values) * around.tension_n
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    let ratio = scale.either(0.25);
    vec![("coulomb_ratio", ratio), ("viscous_ratio", ratio)]
}
