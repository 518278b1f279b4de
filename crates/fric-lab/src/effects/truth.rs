//! The ways in which an effect or a disturbance can act on the simulated robot: one method per place.

use core::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;

/// The momentary state of a bearing, as far as its friction depends on it, apart from the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Speed of the cable over its pulley, m/s, positive paying out.
    pub speed_m_per_s: f64,
    /// Length of the cable, m.
    pub length_m: f64,
    /// Tension of the cable at the platform, N.
    pub tension_n: f64,
    /// Time since the start, s.
    pub time_s: f64,
    /// Whether it is the pulley nearest to the platform.
    pub is_last_pulley: bool,
}

/// An effect on one cable. The default of every method is a cable without the effect.
pub trait TruthEffect: core::fmt::Debug + Send + Sync {
    /// Returns the factor on a bearing's μ.
    fn mu_factor(&self, _contact: &Contact) -> f64 {
        1.0
    }

    /// Advances the time by `step_s` while the winch moves as the contact says; used by effects with memory.
    fn moved(&mut self, _contact: &Contact, _step_s: f64) {}

    /// Returns the factor on a bearing's μ that depends on its load, N.
    fn load_factor(&self, _normal_force_n: f64) -> f64 {
        1.0
    }

    /// Returns the sliding friction of a bearing in addition to `μ·F_N`, N.
    fn drag_n(&self, _contact: &Contact) -> f64 {
        0.0
    }

    /// Returns the μ of a pulley, numbered from 1 at the sensor, if it has one of its own.
    fn own_mu(&self, _pulley: f64) -> Option<f64> {
        None
    }

    /// Returns the greatest friction of a bearing at rest, as a multiple of its load-dependent friction.
    fn held_ratio(&self) -> f64 {
        f64::INFINITY
    }

    /// Returns the force that all pulleys together take from the tension in addition to `F_pv·v`, N.
    fn viscous_n(&self, _speed_m_per_s: f64) -> f64 {
        0.0
    }

    /// Returns the factor on `F_pv`.
    fn viscous_factor(&self, _speed_m_per_s: f64) -> f64 {
        1.0
    }

    /// Returns by how much the friction force of a bristle leads its deflection, s: damping of the bristle divided by its stiffness.
    fn bristle_lead_s(&self) -> f64 {
        0.0
    }

    /// Returns the factor on the presliding exponent, which is 1 without effects.
    fn presliding_exponent(&self) -> f64 {
        1.0
    }

    /// Returns the mass of each pulley, reduced to its rim, kg.
    fn pulley_mass_kg(&self) -> f64 {
        0.0
    }

    /// Returns the compliance of the cable from the winch to the platform, m/N.
    fn compliance_m_per_n(&self) -> f64 {
        0.0
    }

    /// Returns the rate at which the cable from the winch to the platform grows longer by itself, m/s.
    fn creep_m_per_s(&self) -> f64 {
        0.0
    }

    /// Returns the ratio of the tension at the platform to that behind the last pulley, at a length.
    fn platform_factor(&self, _length_m: f64) -> f64 {
        1.0
    }

    /// Returns the tension at the platform minus that behind the last pulley, N, for a speed, a length and a tension of the cable.
    fn platform_force_n(&self, _speed_m_per_s: f64, _length_m: f64, _tension_n: f64) -> f64 {
        0.0
    }

    /// Returns the time by which the logged motion is ahead of the cable's, s.
    fn motion_lead_s(&self) -> f64 {
        0.0
    }

    /// Returns how far the winch turns after a reversal before the cable follows, m of cable.
    fn winch_play_m(&self) -> f64 {
        0.0
    }

    /// Returns the force after the nonlinear curve of the sensor, N.
    fn bent_n(&self, force_n: f64) -> f64 {
        force_n
    }

    /// Returns the force that the winch adds to the sensor signal at a length of paid-out cable, N.
    fn winch_force_n(&self, _length_m: f64) -> f64 {
        0.0
    }

    /// Returns the sensor gain.
    fn sensor_gain(&self) -> f64 {
        1.0
    }

    /// Returns the sensor offset, N.
    fn sensor_offset_n(&self, _time_s: f64) -> f64 {
        0.0
    }

    /// Returns the output of a lagging amplifier, including noise, `step_s` after the last one, N.
    fn lagging_n(&mut self, force_n: f64, _step_s: f64) -> f64 {
        force_n
    }

    /// Returns the logged value of a sensor signal, including noise, N.
    fn reading_n(&self, shown_n: f64) -> f64 {
        shown_n
    }

    /// Whether the last reading is repeated.
    fn is_frozen(&self, _time_s: f64) -> bool {
        false
    }
}

/// The inputs from which an effect of one cable is created.
pub struct Cause<'a> {
    /// Its parameters by key.
    pub value: &'a dyn Fn(&str) -> f64,
    /// Length of the cable at the start of the run, m.
    pub start_length_m: f64,
    /// Ratio of the sensor signal to the tension without friction, dimensionless.
    pub sensor_ratio: f64,
    /// Random numbers, for instance for phases.
    pub random: &'a mut ChaCha8Rng,
}

/// A sine wave over a length.
#[derive(Clone, Copy, Debug)]
pub struct Oscillation {
    amplitude: f64,
    phase_rad: f64,
    rad_per_m: f64,
}

impl Oscillation {
    /// Creates the wave from its sine and cosine amplitudes.
    pub fn new(sin: f64, cos: f64, period_m: f64) -> Self {
        Self { amplitude: libm::hypot(sin, cos), phase_rad: libm::atan2(cos, sin), rad_per_m: TAU / period_m }
    }

    /// Returns the value at a length, m.
    pub fn at(&self, length_m: f64) -> f64 {
        self.amplitude * libm::sin(self.rad_per_m * length_m + self.phase_rad)
    }
}

/// Returns the completed fraction of a warm-up, 0…1.
pub fn warmed(time_s: f64, time_constant_s: f64) -> f64 {
    -libm::expm1(-time_s / time_constant_s)
}

/// Returns the duration of a drift so far, s. A drift whose end is 0 has no end.
pub fn drifted_s(time_s: f64, until_s: f64) -> f64 {
    if until_s > 0.0 && time_s > until_s { until_s } else { time_s }
}

/// A constructor of an effect.
pub type Build = fn(&mut Cause<'_>) -> Box<dyn TruthEffect>;
