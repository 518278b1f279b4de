//! Faults of a recording.

use serde::Serialize;

use crate::discover::faults::{Fault, RecordingFault};
use crate::fit::result::Numbers;

/// A fault of a recording.
#[derive(Clone, Debug, Serialize)]
pub struct FaultResult {
    /// Its name.
    pub kind: &'static str,
    /// Its values, by key with the unit.
    pub parameters: Numbers,
    /// Time intervals of the fault, s since the first sample; empty if it lasts throughout the log.
    pub intervals_s: Vec<[f64; 2]>,
    /// The kind of the fault.
    #[serde(skip)]
    pub fault: Fault,
}

impl Fault {
    /// Returns the name used in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hum => "hum",
            Self::Vibration => "vibration",
            Self::NoisyLength => "noisy_length",
            Self::Frozen => "frozen",
            Self::Clipped => "clipped",
            Self::Spikes => "spikes",
            Self::CoarseConverter => "coarse_converter",
            Self::ReferenceDelay => "reference_delay",
            Self::ClockSkew => "clock_skew",
        }
    }
}

impl FaultResult {
    /// Creates the entry of a fault.
    #[must_use]
    pub fn of(found: &RecordingFault) -> Self {
        Self {
            kind: found.fault.name(),
            parameters: Numbers(found.parameters.iter().map(|(key, value)| ((*key).to_owned(), *value)).collect()),
            intervals_s: found.intervals_s.clone(),
            fault: found.fault,
        }
    }
}
