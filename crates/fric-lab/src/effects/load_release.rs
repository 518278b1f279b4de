//! `load_release` in the simulated robot: a contact that slips back as its load falls.
//!
//! After each step of the integration a bristle that is bent further than its load bears has slipped back to what it bears.

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};

/// What the lab knows of it.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

#[derive(Debug)]
struct SlippingBack {
    ratio: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(SlippingBack { ratio: (cause.value)("ratio") })
}

impl TruthEffect for SlippingBack {
    fn held_ratio(&self) -> f64 {
        1.0 / self.ratio
    }
}

fn starts(_: &Around) -> Vec<Start> {
    vec![vec![("ratio", 1.0)]]
}

fn typical(_: &mut Sizing<'_>) -> Start {
    // It is so or not.
    vec![("ratio", 1.0)]
}
