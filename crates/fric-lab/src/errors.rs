//! Errors of forces and wrenches, as the results for machines have them.

use serde::Serialize;

use crate::replay::{Deviation, WrenchErrors, WrenchReference};
use crate::text::table;

/// Deviation of a force from the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ForceError {
    /// Root mean square, N.
    pub rms_n: f64,
    /// Mean of the magnitude, N.
    pub mae_n: f64,
}

impl ForceError {
    /// Of deviations; `None` without any.
    #[must_use]
    pub fn of(deviation: &Deviation) -> Option<Self> {
        Some(Self { rms_n: deviation.rms()?, mae_n: deviation.mean_magnitude()? })
    }
}

/// Deviation of the wrench.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WrenchError {
    /// Root mean square of the force deviation's length, N.
    pub force_rms_n: f64,
    /// The same of the torque, N m.
    pub torque_rms_nm: f64,
}

/// Deviation of the wrench without and with compensation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WrenchResult {
    /// `wrench`, or `mass` where it is compared with the wrench of the platform's mass and pose.
    pub reference: &'static str,
    /// By the frictionless forces.
    pub before: WrenchError,
    /// By the compensated forces.
    pub after: WrenchError,
}

impl WrenchResult {
    /// Of deviations; `None` without any.
    #[must_use]
    pub fn of(reference: WrenchReference, before: &WrenchErrors, after: &WrenchErrors) -> Option<Self> {
        let error = |(force_rms_n, torque_rms_nm)| WrenchError { force_rms_n, torque_rms_nm };
        Some(Self { reference: reference.name(), before: error(before.rms()?), after: error(after.rms()?) })
    }

    /// Heading of a table, with what the wrench is compared with where that is not the measured one.
    #[must_use]
    pub fn title(&self) -> &'static str {
        if self.reference == WrenchReference::Mass.name() { "wrench, by mass" } else { "wrench" }
    }

    /// As a table.
    #[must_use]
    pub fn table(&self) -> String {
        let Self { before, after, .. } = self;
        let rows = [
            ["force".to_owned(), format!("{:.4} N", before.force_rms_n), format!("{:.4} N", after.force_rms_n)],
            ["torque".to_owned(), format!("{:.4} Nm", before.torque_rms_nm), format!("{:.4} Nm", after.torque_rms_nm)],
        ];
        table(&[self.title(), "rms before", "after"], 1, &rows)
    }
}
