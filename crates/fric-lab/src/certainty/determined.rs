//! What the samples determine, and what not.
//!
//! A parameter is determined if its 95 % interval is narrower than itself, or narrow enough not to matter. The one that is
//! furthest from it is held at its given value, the rest fitted again, and so on: two parameters that only together have
//! an effect leave the one that is known better, or the offset, which does no harm elsewhere. The rest then makes up for
//! what the held value is wrong by, and its errors hold under the condition that it is right.
//!
//! No model is perfect: a parameter that changes the force by a thousandth of the friction is not determined, however long
//! the log.

use fric_core::effects::time_delay::DELAY;
use fric_core::parameters::{MU, OFFSET, VISCOUS};

use crate::search::vector::Parameter;

/// Half the width of a 95 % interval in standard errors.
pub const HALF_INTERVAL: f64 = 1.96;
/// An interval of ± this matters to no one: μ, 1.
const NEGLIGIBLE_MU: f64 = 0.0025;
/// ε, as a share of the cable's friction.
const NEGLIGIBLE_OFFSET_RATIO: f64 = 0.01;
/// F_pv of all pulleys at 1 m/s, likewise.
const NEGLIGIBLE_VISCOUS_RATIO: f64 = 0.125;
/// Effects: a share of the friction, and the delay, s.
const NEGLIGIBLE_RATIO: f64 = 0.05;
const NEGLIGIBLE_DELAY_S: f64 = 5e-4;
/// The model is believed to this share of the friction.
const BELIEVED_RATIO: f64 = 1e-3;
/// Friction below this share of the tension is little: what is small beside it need not be known better.
const LITTLE_FRICTION_RATIO: f64 = 0.01;

/// What matters for a cable.
#[derive(Clone, Copy, Debug)]
pub struct Yardstick {
    friction_n: f64,
    pulley_count: usize,
}

impl Yardstick {
    /// By the root mean squares of its friction and of its tension, and its pulleys.
    pub fn new(friction_n: f64, tension_n: f64, pulley_count: usize) -> Self {
        Self { friction_n: friction_n.max(LITTLE_FRICTION_RATIO * tension_n), pulley_count }
    }

    /// How wide an interval is, as a multiple of the widest that still determines the parameter; above 1 it does not.
    /// `leverage` is how far the parameter moves for 1 N by which the model is wrong all along, at worst.
    pub fn vagueness(&self, parameter: &Parameter, value: f64, standard_error: f64, leverage: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "at most MAX_PULLEYS")]
        let pulleys = self.pulley_count as f64;
        let negligible = match parameter.place() {
            MU => NEGLIGIBLE_MU,
            OFFSET => NEGLIGIBLE_OFFSET_RATIO * self.friction_n,
            VISCOUS => NEGLIGIBLE_VISCOUS_RATIO * self.friction_n / pulleys,
            DELAY => NEGLIGIBLE_DELAY_S,
            _ if parameter.row().unit == "1" => NEGLIGIBLE_RATIO,
            _ => 0.0,
        };
        let size = if parameter.row().min > 0.0 { value } else { value - parameter.row().neutral };
        let half_width = HALF_INTERVAL * standard_error + BELIEVED_RATIO * self.friction_n * leverage;
        if half_width.is_finite() { half_width / (0.5 * size.abs()).max(negligible) } else { f64::INFINITY }
    }
}
