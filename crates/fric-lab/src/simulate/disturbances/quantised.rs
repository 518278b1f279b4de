//! A sensor read by a converter with few bits.

use super::{DisturbanceRow, parameter};
use crate::effects::truth::{Cause, TruthEffect};

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "quantised",
    cause: "the converter behind the sensor has few bits, so that readings come in coarse steps",
    parameters: &[parameter("resolution_n", "N", 0.2, [1e-9, 1000.0])],
    build,
};

#[derive(Debug)]
struct Coarse {
    resolution_n: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Coarse { resolution_n: (cause.value)("resolution_n") })
}

impl TruthEffect for Coarse {
    fn reading_n(&self, shown_n: f64) -> f64 {
        libm::round(shown_n / self.resolution_n) * self.resolution_n
    }
}
