//! How strong an effect or a disturbance of a sweep is.

use core::f64::consts::TAU;

use crate::simulate::disturbances::Disturbance;
use crate::simulate::error::HiddenError;
use crate::simulate::hidden::HiddenEffect;
use crate::simulate::waves::uniform;
use rand_chacha::ChaCha8Rng;

/// What the size of an effect goes by.
pub struct Scale<'a> {
    /// Share of the full strength.
    pub strength_ratio: f64,
    pub mu: f64,
    /// Mean tension, N.
    pub tension_n: f64,
    /// Mean normal force of a pulley, N.
    pub normal_n: f64,
    pub duration_s: f64,
    pub random: &'a mut ChaCha8Rng,
}

impl Scale<'_> {
    /// About a value at full strength, the share of it at others.
    fn about(&mut self, full: f64) -> f64 {
        full * self.strength_ratio * uniform(self.random, 0.85, 1.15)
    }

    /// Either sign.
    fn either(&mut self, full: f64) -> f64 {
        let value = self.about(full);
        if uniform(self.random, -1.0, 1.0) < 0.0 { -value } else { value }
    }

    /// An effect of the catalogue.
    pub fn effect(&mut self, kind: &str) -> Result<HiddenEffect, HiddenError> {
        let values = match kind {
            "stribeck" => {
                let ratio = self.about(0.6);
                vec![("ratio", ratio), ("velocity_m_per_s", 0.03 * uniform(self.random, 0.85, 1.15))]
            }
            "direction_asymmetry" => {
                let ratio = self.either(0.25);
                vec![("coulomb_ratio", ratio), ("viscous_ratio", ratio)]
            }
            // A fifth of the whole.
            "bearing_drag" => {
                let load_n = self.mu * self.normal_n;
                vec![("drag_n", self.about(0.25 * load_n))]
            }
            "load_nonlinearity" => vec![("exponent", 1.0 + self.either(0.3)), ("reference_n", self.normal_n)],
            "friction_drift" => {
                let duration_s = self.duration_s;
                vec![("rate_per_s", self.either(0.3 / duration_s))]
            }
            "presliding_shape" => vec![("exponent", 1.0 + self.about(0.8))],
            "sensor_gain" => vec![("gain", 1.0 + self.either(0.03))],
            "sensor_offset" => vec![("offset_n", self.either(0.3))],
            "sensor_drift" => vec![("rate_n_per_s", self.either(0.005))],
            // A loop cannot know much of the motion to come.
            "time_delay" => {
                let delay_s = self.either(0.008);
                vec![("delay_s", if delay_s < 0.0 { 0.375 * delay_s } else { delay_s })]
            }
            "pulley_inertia" => vec![("mass_kg", self.about(0.05))],
            "pulley_eccentricity" => {
                let (ratio, phase_rad) = (self.about(0.02), uniform(self.random, 0.0, TAU));
                let period_m = uniform(self.random, 0.05, 0.12);
                let (sin, cos) = libm::sincos(phase_rad);
                vec![("sin_ratio", ratio * cos), ("cos_ratio", ratio * sin), ("period_m", period_m)]
            }
            "cable_elasticity" => vec![("compliance_m_per_n", self.about(2.5e-4))],
            // Refused by name.
            _ => Vec::new(),
        };
        HiddenEffect::new(kind, &values)
    }

    /// A disturbance.
    pub fn disturbance(&mut self, kind: &str) -> Result<Disturbance, HiddenError> {
        let values = match kind {
            "hum" => {
                let frequency_hz = if uniform(self.random, -1.0, 1.0) < 0.0 { 50.0 } else { 60.0 };
                vec![("amplitude_n", self.about(0.12)), ("frequency_hz", frequency_hz)]
            }
            "frozen" => vec![("interval_s", 10.0), ("length_s", self.about(0.6))],
            // The sensor at 180° feels the cable twice; the fuller the strength, the more is cut off.
            "clipped" => vec![("greatest_n", 2.0 * self.tension_n * (1.6 - self.about(0.25)))],
            "step" => vec![("shift_n", self.either(0.3))],
            "quantised" => vec![("resolution_n", self.about(0.3))],
            "warming" => vec![("amplitude_n", self.about(0.1)), ("period_s", uniform(self.random, 15.0, 25.0))],
            "local_defect" => {
                let from_start_m = uniform(self.random, -0.03, 0.03);
                vec![("drag_n", self.about(0.25)), ("from_start_m", from_start_m), ("width_m", 0.01)]
            }
            "backlash" => vec![("play_m", self.about(0.0005))],
            // Refused by name.
            _ => Vec::new(),
        };
        Disturbance::new(kind, &values)
    }
}
