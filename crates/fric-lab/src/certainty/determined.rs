//! Which parameters the samples determine.
//!
//! A parameter is determined if its 95 % interval is narrower than the parameter itself, or too narrow to matter. The parameter that is furthest from
//! that is held at its given value, the rest is fitted again, and so on. Of two parameters that only have an effect together, the one that is known
//! better stays, or the offset is held, which does no harm elsewhere. The others then compensate for the error of the held value, and their errors
//! are valid under the condition that it is right.
//!
//! No model is perfect: a parameter that changes the force by a thousandth of the friction is not determined, however long the log.

use fric_core::effects::time_delay::DELAY;
use fric_core::parameters::{MU, OFFSET, VISCOUS, Values};

use crate::search::vector::Parameter;

/// Half the width of a 95 % interval, in standard errors.
pub const HALF_INTERVAL: f64 = 1.96;
/// Half width of an interval that does not matter: μ, dimensionless.
pub const NEGLIGIBLE_MU: f64 = 0.0025;
/// Half width for ε, as a fraction of the cable's friction.
const NEGLIGIBLE_OFFSET_RATIO: f64 = 0.01;
/// Half width for F_pv of all pulleys at 1 m/s, as a fraction of the cable's friction.
const NEGLIGIBLE_VISCOUS_RATIO: f64 = 0.125;
/// Half width for effects, as a fraction of the friction, and for the delay, s.
pub const NEGLIGIBLE_RATIO: f64 = 0.05;
const NEGLIGIBLE_DELAY_S: f64 = 5e-4;
/// The model is trusted to this fraction of the friction.
const BELIEVED_RATIO: f64 = 1e-3;
/// Friction below this fraction of the tension is small, and parameters that are small beside it need not be known better.
const LITTLE_FRICTION_RATIO: f64 = 0.01;

/// The scale on which uncertainties matter for a cable.
#[derive(Clone, Copy, Debug)]
pub struct Yardstick {
    friction_n: f64,
    pulley_count: usize,
}

impl Yardstick {
    /// Creates the scale from the root mean squares of the cable's friction and tension, and its number of pulleys.
    pub fn new(friction_n: f64, tension_n: f64, pulley_count: usize) -> Self {
        Self { friction_n: friction_n.max(LITTLE_FRICTION_RATIO * tension_n), pulley_count }
    }

    /// Returns the width of an interval as a multiple of the widest one that still determines the parameter; above 1 it is undetermined. `leverage`
    /// is the greatest shift of the parameter per 1 N of model error.
    pub fn vagueness(&self, parameter: &Parameter, values: &Values, standard_error: f64, leverage: f64) -> f64 {
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
        let half_width = HALF_INTERVAL * standard_error + BELIEVED_RATIO * self.friction_n * leverage;
        if half_width.is_finite() { half_width / (0.5 * parameter.size(values)).max(negligible) } else { f64::INFINITY }
    }
}
