//! `load_release` in the simulated robot: a contact that slips back as its load falls.
//!
//! After each integration step, a bristle whose deflection exceeds what its load holds slips back to that deflection.

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};

/// The effect's entry in the lab.
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
    // The effect is either present or absent.
    vec![("ratio", 1.0)]
}
