//! A sensor whose zero jumps and jumps back: an amplifier that changes its range, a loose plug.

use super::{DisturbanceRow, in_stretch, parameter};
use crate::effects::truth::{Cause, TruthEffect};
use crate::random::uniform;

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "step",
    cause: "a loose contact or a change of the amplifier's range shifts the sensor for a while, at even intervals",
    parameters: &[
        parameter("shift_n", "N", 0.3, [-1000.0, 1000.0]),
        parameter("interval_s", "s", 15.0, [0.01, 1e6]),
        parameter("length_s", "s", 4.0, [0.0, 1e6]),
    ],
    build,
};

#[derive(Debug)]
struct Shifted {
    shift_n: f64,
    first_s: f64,
    interval_s: f64,
    length_s: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [shift_n, interval_s, length_s] = ["shift_n", "interval_s", "length_s"].map(cause.value);
    let first_s = interval_s * uniform(cause.random, 0.1, 0.9);
    Box::new(Shifted { shift_n, first_s, interval_s, length_s })
}

impl TruthEffect for Shifted {
    fn sensor_offset_n(&self, time_s: f64) -> f64 {
        if in_stretch(time_s, self.first_s, self.interval_s, self.length_s) { self.shift_n } else { 0.0 }
    }
}
