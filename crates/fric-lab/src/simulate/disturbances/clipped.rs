//! A sensor whose amplifier saturates: no reading exceeds its range.

use super::{DisturbanceRow, parameter};
use crate::effects::truth::{Cause, TruthEffect};

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "clipped",
    cause: "the amplifier is set for too small a range and shows its end for every greater force",
    parameters: &[parameter("greatest_n", "N", 12.0, [0.0, 1e6])],
    build,
};

#[derive(Debug)]
struct Clipped {
    greatest_n: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Clipped { greatest_n: (cause.value)("greatest_n") })
}

impl TruthEffect for Clipped {
    fn reading_n(&self, shown_n: f64) -> f64 {
        shown_n.min(self.greatest_n)
    }
}
