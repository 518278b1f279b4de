//! `pulley_inertia` in the simulated robot: pulleys that have to be sped up.
//!
//! Each takes `m·dv/dt` from the tension, m = J/r² and dv/dt the acceleration of the motion itself, not a difference of
//! samples. What a stretching cable adds to the acceleration is left out.

use super::{Cause, TruthEffect};

#[derive(Debug)]
struct Rim {
    mass_kg: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Rim { mass_kg: (cause.value)("mass_kg") })
}

impl TruthEffect for Rim {
    fn pulley_mass_kg(&self) -> f64 {
        self.mass_kg
    }
}
