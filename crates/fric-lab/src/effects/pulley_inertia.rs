//! `pulley_inertia` in the simulated robot: pulleys that must be accelerated.
//!
//! Each takes `m·dv/dt` from the tension, where m = J/r² and dv/dt is the acceleration of the motion itself, not a difference of samples. The
//! additional acceleration of a stretching cable is neglected.

use fric_core::effects::pulley_inertia::MASS;
use fric_core::parameters::{VISCOUS, Values};

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual };

/// Start values of the filter time constant for the acceleration, in cycles: the noisier the speed, the longer.
const WINDOWS: [f64; 4] = [0.0, 1.0, 4.0, 16.0];

#[derive(Debug)]
struct Rim {
    mass_kg: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Rim { mass_kg: (cause.value)("mass_kg") })
}

impl TruthEffect for Rim {
    fn pulley_mass_kg(&self) -> f64 {
        self.mass_kg
    }
}

/// Whether the inertia is beyond what viscous friction makes of a speed whose time is uncertain by a cycle: `F_pv·v(t − δ)` is `F_pv·v(t)` less
/// `F_pv·δ·dv/dt`, as a mass of `F_pv·δ` would take. A drive that takes the speed from two positions shows it half a cycle late.
fn is_more_than_usual(values: &Values, around: &Around) -> bool {
    values[MASS] > values[VISCOUS] * around.cycle_s
}

fn starts(around: &Around) -> Vec<Start> {
    WINDOWS.map(|cycles| vec![("window_s", cycles * around.cycle_s)]).to_vec()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("mass_kg", scale.about(0.05))]
}
