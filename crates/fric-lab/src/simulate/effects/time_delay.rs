//! `time_delay` in the simulated robot: the log's length and speed are those that the cable will have `delay_s` later.
//!
//! Forces and pose are of the present; the motion is computed for the later instant, not shifted by whole samples.

use fric_core::effects::EffectParams;

use super::TruthEffect;

#[derive(Debug)]
struct MotionAhead {
    lead_s: f64,
}

pub fn build(params: &EffectParams) -> Box<dyn TruthEffect> {
    Box::new(MotionAhead { lead_s: params.get("time_delay", "delay_s").unwrap_or_default() })
}

impl TruthEffect for MotionAhead {
    fn motion_lead_s(&self) -> f64 {
        self.lead_s
    }
}
