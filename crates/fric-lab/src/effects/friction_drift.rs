//! `friction_drift` in the simulated robot: bearings that warm up, run in or lose grease during the run.
//!
//! μ changes at a constant rate from the start of the log to the end of the drift, and does not fall below zero.

use super::truth::{Cause, Contact, TruthEffect, drifted_s};
use super::{Around, LabEffect, Sizing, Start, always};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

#[derive(Debug)]
struct Ageing {
    rate_per_s: f64,
    until_s: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Ageing { rate_per_s: (cause.value)("rate_per_s"), until_s: (cause.value)("until_s") })
}

impl TruthEffect for Ageing {
    fn mu_factor(&self, contact: &Contact) -> f64 {
        (1.0 + self.rate_per_s * drifted_s(contact.time_s, self.until_s)).max(0.0)
    }
}

fn starts(around: &Around) -> Vec<Start> {
    vec![vec![("until_s", around.end_s)]]
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    let duration_s = scale.duration_s;
    vec![("rate_per_s", scale.either(0.3 / duration_s))]
}
