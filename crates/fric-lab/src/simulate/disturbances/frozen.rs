//! A sensor that repeats the same value for a while, at intervals.

use super::{DisturbanceRow, in_stretch, parameter};
use crate::effects::truth::{Cause, TruthEffect};
use crate::random::uniform;

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "frozen",
    cause: "the bus loses the sensor for a while and the last value is logged again, at even intervals",
    parameters: &[parameter("interval_s", "s", 10.0, [0.01, 1e6]), parameter("length_s", "s", 0.4, [0.0, 1e6])],
    build,
};

#[derive(Debug)]
#[expect(clippy::struct_field_names, reason = "the unit")]
struct Lost {
    first_s: f64,
    interval_s: f64,
    length_s: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [interval_s, length_s] = ["interval_s", "length_s"].map(cause.value);
    let first_s = interval_s * uniform(cause.random, 0.1, 0.9);
    Box::new(Lost { first_s, interval_s, length_s })
}

impl TruthEffect for Lost {
    fn is_frozen(&self, time_s: f64) -> bool {
        in_stretch(time_s, self.first_s, self.interval_s, self.length_s)
    }
}
