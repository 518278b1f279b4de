//! `friction_drift` in the simulated robot: bearings that warm up, run in or lose grease while the run lasts.
//!
//! μ changes by the same amount every second from the start of the log to where the drift ends; it does not fall below zero.

use super::{Cause, Contact, TruthEffect, drifted_s};

#[derive(Debug)]
struct Ageing {
    rate_per_s: f64,
    until_s: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Ageing { rate_per_s: (cause.value)("rate_per_s"), until_s: (cause.value)("until_s") })
}

impl TruthEffect for Ageing {
    fn mu_factor(&self, contact: &Contact) -> f64 {
        (1.0 + self.rate_per_s * drifted_s(contact.time_s, self.until_s)).max(0.0)
    }
}
