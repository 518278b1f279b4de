//! `bearing_drag` in the simulated robot: the seal of every pulley's shaft has friction independent of the load.
//!
//! The seal sticks as the bearing does: its force is part of what the bristle can hold before it slides.

use super::truth::{Cause, Contact, TruthEffect};
use super::{LabEffect, Sizing, Start, always, as_it_is};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts: as_it_is, typical, is_more_than_usual: always };

#[derive(Debug)]
struct Seal {
    drag_n: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Seal { drag_n: (cause.value)("drag_n") })
}

impl TruthEffect for Seal {
    fn drag_n(&self, _contact: &Contact) -> f64 {
        self.drag_n
    }
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    // A fifth of the total friction.
    let load_n = scale.mu * scale.normal_n;
    vec![("drag_n", scale.about(0.25 * load_n))]
}
