//! `bearing_drag` in the simulated robot: a seal that rubs on every pulley's shaft whatever the load.
//!
//! The seal sticks as the bearing does: its force is part of what the bristle can hold before it slides.

use super::{Cause, Contact, TruthEffect};

#[derive(Debug)]
struct Seal {
    drag_n: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Seal { drag_n: (cause.value)("drag_n") })
}

impl TruthEffect for Seal {
    fn drag_n(&self, _contact: &Contact) -> f64 {
        self.drag_n
    }
}
