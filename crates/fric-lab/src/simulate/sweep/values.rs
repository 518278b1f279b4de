//! The strengths of effects and disturbances in a sweep.

use fric_core::effects::Effect;

use crate::effects::{self, Sizing};
use crate::random::uniform;
use crate::simulate::disturbances::Disturbance;
use crate::simulate::error::HiddenError;
use crate::simulate::hidden::HiddenEffect;

/// Returns an effect of the catalogue.
pub fn effect(effect: Effect, strength: &mut Sizing<'_>) -> Result<HiddenEffect, HiddenError> {
    let values = effects::of(effect).map(|lab| (lab.typical)(strength)).unwrap_or_default();
    HiddenEffect::of(effect, &values)
}

/// Returns a disturbance.
pub fn disturbance(kind: &str, strength: &mut Sizing<'_>) -> Result<Disturbance, HiddenError> {
    let values = match kind {
        "hum" => {
            let frequency_hz = if uniform(strength.random, -1.0, 1.0) < 0.0 { 50.0 } else { 60.0 };
            vec![("amplitude_n", strength.about(0.12)), ("frequency_hz", frequency_hz)]
        }
        "frozen" => vec![("interval_s", 10.0), ("length_s", strength.about(0.6))],
        // At 180° the sensor measures the cable force twice. A greater strength cuts off more.
        "clipped" => vec![("greatest_n", 2.0 * strength.tension_n * (1.6 - strength.about(0.25)))],
        "step" => vec![("shift_n", strength.either(0.3))],
        "quantised" => vec![("resolution_n", strength.about(0.3))],
        "warming" => vec![("amplitude_n", strength.about(0.1)), ("period_s", uniform(strength.random, 15.0, 25.0))],
        "local_defect" => {
            let from_start_m = uniform(strength.random, -0.03, 0.03);
            vec![("drag_n", strength.about(0.25)), ("from_start_m", from_start_m), ("width_m", 0.01)]
        }
        "vibration" => vec![
            ("amplitude_n", strength.about(0.15)),
            ("frequency_hz", uniform(strength.random, 8.0, 40.0)),
            ("damping_ratio", uniform(strength.random, 0.01, 0.05)),
        ],
        "bristle_damping" => vec![("lead_s", strength.about(0.01))],
        "creep" => {
            vec![("compliance_m_per_n", strength.about(4e-4)), ("time_constant_s", uniform(strength.random, 2.0, 10.0))]
        }
        // Refused by name.
        _ => Vec::new(),
    };
    Disturbance::new(kind, &values)
}
