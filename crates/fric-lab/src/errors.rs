//! Errors of forces and wrenches, in the form of the machine-readable results.

use serde::Serialize;

use crate::replay::{Deviation, WrenchErrors, WrenchReference};
use crate::text::table;

/// Error of a force against the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ForceError {
    /// Root mean square, N.
    pub rms_n: f64,
    /// Mean of the magnitude, N.
    pub mae_n: f64,
}

impl ForceError {
    /// Creates the error from deviations; `None` if there are none.
    #[must_use]
    pub fn of(deviation: &Deviation) -> Option<Self> {
        Some(Self { rms_n: deviation.rms()?, mae_n: deviation.mean_magnitude()? })
    }
}

/// Error of the wrench.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WrenchError {
    /// Root mean square of the force error's magnitude, N.
    pub force_rms_n: f64,
    /// Root mean square of the torque error's magnitude, N m.
    pub torque_rms_nm: f64,
}

/// Error of the wrench without and with compensation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WrenchResult {
    /// `wrench`, or `mass` if the reference is the wrench computed from the platform's mass and pose.
    pub reference: WrenchReference,
    /// Error with the frictionless forces.
    pub before: WrenchError,
    /// Error with the compensated forces.
    pub after: WrenchError,
    /// Error with the compensated forces on held-out blocks of the log, with parameters from a fit to the other blocks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held_out: Option<WrenchError>,
}

impl WrenchError {
    /// Creates the error from deviations; `None` if there are none.
    #[must_use]
    pub fn of(errors: &WrenchErrors) -> Option<Self> {
        errors.rms().map(|(force_rms_n, torque_rms_nm)| Self { force_rms_n, torque_rms_nm })
    }
}

impl WrenchResult {
    /// Creates the result from deviations; `None` if there are none.
    #[must_use]
    pub fn of(reference: WrenchReference, before: &WrenchErrors, after: &WrenchErrors) -> Option<Self> {
        let (before, after) = (WrenchError::of(before)?, WrenchError::of(after)?);
        Some(Self { reference, before, after, held_out: None })
    }

    /// Returns the heading of a table; it names the reference if that is not the measured wrench.
    #[must_use]
    pub fn title(&self) -> &'static str {
        if self.reference == WrenchReference::Mass { "wrench, by mass" } else { "wrench" }
    }

    /// Returns a table.
    #[must_use]
    pub fn table(&self) -> String {
        let errors: Vec<&WrenchError> = [&self.before, &self.after].into_iter().chain(&self.held_out).collect();
        let row = |name: &str, cell: fn(&WrenchError) -> String| -> Vec<String> {
            std::iter::once(name.to_owned()).chain(errors.iter().map(|error| cell(error))).collect()
        };
        let rows = [
            row("force [N]", |error| format!("{:.4}", error.force_rms_n)),
            row("torque [Nm]", |error| format!("{:.4}", error.torque_rms_nm)),
        ];
        let header = [self.title(), "rms error\nbefore", "rms error\nafter", "rms error\nheld out"];
        table(header.get(..=errors.len()).unwrap_or(&header), 1, &rows)
    }
}
