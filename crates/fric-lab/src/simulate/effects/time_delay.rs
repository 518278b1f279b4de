//! `time_delay` in the simulated robot: the log's length and speed are those that the cable will have `delay_s` later,
//! or for a negative one had before.
//!
//! Forces and pose are of the present; the motion is computed for the other instant, not shifted by whole samples.

use super::{Cause, TruthEffect};

#[derive(Debug)]
struct MotionAhead {
    lead_s: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(MotionAhead { lead_s: (cause.value)("delay_s") })
}

impl TruthEffect for MotionAhead {
    fn motion_lead_s(&self) -> f64 {
        self.lead_s
    }
}
