//! `time_delay` in the simulated robot: the logged length and speed are those that the cable will have `delay_s` later or, for a negative value, had
//! before.
//!
//! Forces and pose belong to the present. The motion is computed for the other time, not shifted by whole samples.

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

#[derive(Debug)]
struct MotionAhead {
    lead_s: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(MotionAhead { lead_s: (cause.value)("delay_s") })
}

impl TruthEffect for MotionAhead {
    fn motion_lead_s(&self) -> f64 {
        self.lead_s
    }
}

fn starts(around: &Around) -> Vec<Start> {
    [-4.0, 4.0].map(|cycles| vec![("delay_s", cycles * around.cycle_s)]).to_vec()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    // A control loop cannot know much of the future motion.
    let delay_s = scale.either(0.008);
    vec![("delay_s", if delay_s < 0.0 { 0.375 * delay_s } else { delay_s })]
}
