//! `sensor_lag` in the simulated robot: an amplifier with a low-pass filter, which also filters the sensor's noise.
//!
//! In each cycle the output approaches the input by a fraction: the cycle time divided by the time constant.

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

/// Start value of the lag, in cycles. There is no smoothing at the start, because a low-pass filter removes noise whether there is a lag or not.
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
