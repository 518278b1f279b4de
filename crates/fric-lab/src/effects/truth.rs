//! What an effect, or a disturbance, can do to the simulated robot: a method for each place at which it acts.

use core::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;

/// A bearing at one instant, as far as its friction depends on it beside the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// How fast the cable runs over its pulley, m/s, positive paying out.
    pub speed_m_per_s: f64,
    /// Length of the cable, m.
    pub length_m: f64,
    /// Tension of the cable at the platform, N.
    pub tension_n: f64,
    /// Since the start, s.
    pub time_s: f64,
    /// The pulley nearest to the platform.
    pub is_last_pulley: bool,
}

/// An effect at work on one cable. Every method's default is a cable without it.
pub trait TruthEffect: core::fmt::Debug + Send + Sync {
    /// Factor on a bearing's μ.
    fn mu_factor(&self, _contact: &Contact) -> f64 {
        1.0
    }

    /// Time goes on by `step_s`, the winch moving as the contact says: for what remembers.
    fn moved(&mut self, _contact: &Contact, _step_s: f64) {}

    /// Factor on a bearing's μ that depends on its load, N.
    fn load_factor(&self, _normal_force_n: f64) -> f64 {
        1.0
    }

    /// Sliding friction of a bearing beside `μ·F_N`, N.
    fn drag_n(&self, _contact: &Contact) -> f64 {
        0.0
    }

    /// μ of the pulley of a number, from 1 at the sensor, where it has one of its own.
    fn own_mu(&self, _pulley: f64) -> Option<f64> {
        None
    }

    /// How many times the friction of its load a bearing holds at rest at most.
    fn held_ratio(&self) -> f64 {
        f64::INFINITY
    }

    /// What all pulleys together take from the tension beside `F_pv·v`, N.
    fn viscous_n(&self, _speed_m_per_s: f64) -> f64 {
        0.0
    }

    /// Factor on `F_pv`.
    fn viscous_factor(&self, _speed_m_per_s: f64) -> f64 {
        1.0
    }

    /// Factor on the exponent of the presliding, which is 1 without.
    fn presliding_exponent(&self) -> f64 {
        1.0
    }

    /// Mass of each pulley at its rim, kg.
    fn pulley_mass_kg(&self) -> f64 {
        0.0
    }

    /// How much the cable stretches from the winch to the platform, m/N.
    fn compliance_m_per_n(&self) -> f64 {
        0.0
    }

    /// Tension at the platform per tension behind the last pulley at a length.
    fn platform_factor(&self, _length_m: f64) -> f64 {
        1.0
    }

    /// Tension at the platform beyond that behind the last pulley, of a cable that runs at a speed, at a length, under a tension, N.
    fn platform_force_n(&self, _speed_m_per_s: f64, _length_m: f64, _tension_n: f64) -> f64 {
        0.0
    }

    /// By how much the logged motion runs ahead of the cable's, s.
    fn motion_lead_s(&self) -> f64 {
        0.0
    }

    /// How far the winch turns on a reversal before the cable follows, m of cable.
    fn winch_play_m(&self) -> f64 {
        0.0
    }

    /// What the curve of the sensor makes of a force, N.
    fn bent_n(&self, force_n: f64) -> f64 {
        force_n
    }

    /// What the winch adds to what is shown at a length of the cable it has let out, N.
    fn winch_force_n(&self, _length_m: f64) -> f64 {
        0.0
    }

    /// What the sensor shows per newton.
    fn sensor_gain(&self) -> f64 {
        1.0
    }

    /// What the sensor shows too much, N.
    fn sensor_offset_n(&self, _time_s: f64) -> f64 {
        0.0
    }

    /// What an amplifier that follows late shows of a force, noise included, `step_s` after the last, N.
    fn lagging_n(&mut self, force_n: f64, _step_s: f64) -> f64 {
        force_n
    }

    /// What is logged of what the sensor shows, noise included, N.
    fn reading_n(&self, shown_n: f64) -> f64 {
        shown_n
    }

    /// Whether the last reading is logged again.
    fn is_frozen(&self, _time_s: f64) -> bool {
        false
    }
}

/// What one effect of one cable is made from.
pub struct Cause<'a> {
    /// Its parameters by key.
    pub value: &'a dyn Fn(&str) -> f64,
    /// Length of the cable where the run starts, m.
    pub start_length_m: f64,
    /// What the sensor shows of the tension without friction, 1.
    pub sensor_ratio: f64,
    /// For phases and the like.
    pub random: &'a mut ChaCha8Rng,
}

/// What goes up and down with a length.
#[derive(Clone, Copy, Debug)]
pub struct Oscillation {
    amplitude: f64,
    phase_rad: f64,
    rad_per_m: f64,
}

impl Oscillation {
    /// From the parts of sine and cosine.
    pub fn new(sin: f64, cos: f64, period_m: f64) -> Self {
        Self { amplitude: libm::hypot(sin, cos), phase_rad: libm::atan2(cos, sin), rad_per_m: TAU / period_m }
    }

    /// At a length, m.
    pub fn at(&self, length_m: f64) -> f64 {
        self.amplitude * libm::sin(self.rad_per_m * length_m + self.phase_rad)
    }
}

/// How much of the way to its final temperature a body has come, 0…1.
pub fn warmed(time_s: f64, time_constant_s: f64) -> f64 {
    -libm::expm1(-time_s / time_constant_s)
}

/// The time that a drift has gone on for, s; one that ends at 0 has no end.
pub fn drifted_s(time_s: f64, until_s: f64) -> f64 {
    if until_s > 0.0 && time_s > until_s { until_s } else { time_s }
}

/// An effect from its cause.
pub type Build = fn(&mut Cause<'_>) -> Box<dyn TruthEffect>;
