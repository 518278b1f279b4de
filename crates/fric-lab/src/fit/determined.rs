//! What the samples determine, and what not.
//!
//! A parameter is determined if its 95 % interval is narrower than itself, or narrow enough not to matter. The one that is
//! furthest from it is held at its given value, the rest fitted again, and so on: two parameters that only together have
//! an effect leave the one that is known better.

use fric_core::parameters::{MU, OFFSET, VISCOUS};

use super::vector::Parameter;

/// Half the width of a 95 % interval in standard errors.
pub const HALF_INTERVAL: f64 = 1.96;
/// An interval of ± this matters to no one: μ, 1.
const NEGLIGIBLE_MU: f64 = 0.0025;
/// ε, as a share of the cable's friction.
const NEGLIGIBLE_OFFSET_RATIO: f64 = 0.01;
/// F_pv of all pulleys at 1 m/s, likewise.
const NEGLIGIBLE_VISCOUS_RATIO: f64 = 0.125;

/// What matters for a cable.
#[derive(Clone, Copy, Debug)]
pub struct Yardstick {
    /// Root mean square of its friction, N.
    pub friction_n: f64,
    /// Its pulleys.
    pub pulley_count: usize,
}

impl Yardstick {
    /// How wide an interval is, as a multiple of the widest that still determines the parameter; above 1 it does not.
    pub fn vagueness(&self, parameter: &Parameter, value: f64, standard_error: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "at most MAX_PULLEYS")]
        let pulleys = self.pulley_count as f64;
        let negligible = match parameter.place() {
            MU => NEGLIGIBLE_MU,
            OFFSET => NEGLIGIBLE_OFFSET_RATIO * self.friction_n,
            VISCOUS => NEGLIGIBLE_VISCOUS_RATIO * self.friction_n / pulleys,
            _ => 0.0,
        };
        let size = if parameter.row().min > 0.0 { value } else { value - parameter.row().neutral };
        let half_width = HALF_INTERVAL * standard_error;
        if half_width.is_finite() { half_width / (0.5 * size.abs()).max(negligible) } else { f64::INFINITY }
    }
}
