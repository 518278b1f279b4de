//! A piece of the cable that does not run freely over the last pulley: a kink, a splice, a broken strand.
//!
//! While the piece passes, the bearing's sliding friction increases by `drag_n·exp(−((l − l₀)/width)²)`, where l is the cable's length and `l₀` the
//! length at the start of the run plus `from_start_m`.

use super::{DisturbanceRow, parameter};
use crate::effects::truth::{Cause, Contact, TruthEffect};

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "local_defect",
    cause: "a kink or splice rubs while it passes the last pulley, in one short piece of the cable's length",
    parameters: &[
        parameter("drag_n", "N", 0.3, [0.0, 1e6]),
        parameter("from_start_m", "m", 0.03, [-1000.0, 1000.0]),
        parameter("width_m", "m", 0.01, [1e-6, 1000.0]),
    ],
    build,
};

#[derive(Debug)]
struct Kink {
    drag_n: f64,
    length_m: f64,
    width_m: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [drag_n, from_start_m, width_m] = ["drag_n", "from_start_m", "width_m"].map(cause.value);
    Box::new(Kink { drag_n, length_m: cause.start_length_m + from_start_m, width_m })
}

impl TruthEffect for Kink {
    fn drag_n(&self, contact: &Contact) -> f64 {
        if !contact.is_last_pulley {
            return 0.0;
        }
        self.drag_n * libm::exp(-libm::pow((contact.length_m - self.length_m) / self.width_m, 2.0))
    }
}
