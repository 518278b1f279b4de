//! `sensor_lag` in the simulated robot: an amplifier with a low pass, behind all the noise of its sensor.
//!
//! In each cycle the force shown goes towards the one there is by a share: the cycle over the time constant.

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};

/// What the lab knows of it.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

/// The lag that the search begins from, in cycles. Without smoothing: a low pass takes noise away whether there is a lag or not.
const LAG: f64 = 4.0;

#[derive(Debug)]
struct LowPass {
    time_constant_s: f64,
    shown_n: Option<f64>,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(LowPass { time_constant_s: (cause.value)("time_constant_s"), shown_n: None })
}

impl TruthEffect for LowPass {
    fn lagging_n(&mut self, force_n: f64, step_s: f64) -> f64 {
        if self.time_constant_s <= step_s {
            return force_n;
        }
        let share = step_s / self.time_constant_s;
        let shown_n = self.shown_n.map_or(force_n, |shown_n| shown_n + share * (force_n - shown_n));
        self.shown_n = Some(shown_n);
        shown_n
    }
}

fn starts(around: &Around) -> Vec<Start> {
    vec![vec![("time_constant_s", LAG * around.cycle_s)]]
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("time_constant_s", scale.about(0.006))]
}
