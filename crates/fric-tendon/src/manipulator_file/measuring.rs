//! `[markers]` and `[base_sensor]` of the manipulator file: the relation between the manipulator and its measurements.

use std::string::ToString;
use std::vec::Vec;

use fric_core::robot::check as in_range;
use fric_core::robot::locate::Step;
use fric_core::robot::read::exactly;
use serde::{Deserialize, Serialize};

use super::file::TablesError;

/// `[markers]`: the pose of the markers' frame. A disk at p in the base frame has its marker at `offset + R(angle)·p`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MarkersTable {
    /// Measured position of the base frame's origin, m, within ±10 m.
    #[serde(deserialize_with = "exactly")]
    pub offset_m: [f64; 2],
    /// Measured rotation of the base frame, rad, from x to y, within ±π.
    pub angle_rad: f64,
}

impl MarkersTable {
    /// Returns the measured position of a point of the base frame, m.
    #[must_use]
    pub fn measured(&self, [x_m, y_m]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (libm::sin(self.angle_rad), libm::cos(self.angle_rad));
        let [right_m, up_m] = self.offset_m;
        [right_m + cos * x_m - sin * y_m, up_m + sin * x_m + cos * y_m]
    }

    /// Returns the point of the base frame for a measured position, m. NaN stays NaN.
    #[must_use]
    pub fn in_base_frame(&self, [x_m, y_m]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (libm::sin(self.angle_rad), libm::cos(self.angle_rad));
        let [right_m, up_m] = self.offset_m;
        let (x_m, y_m) = (x_m - right_m, y_m - up_m);
        [cos * x_m + sin * y_m, cos * y_m - sin * x_m]
    }
}

/// `[base_sensor]`: the tension sensor at the base shows `gain·T(t − lag) + offset`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BaseSensorTable {
    /// Gain, 0.1…10.
    pub gain: f64,
    /// Signal without tension, N.
    pub offset_n: f64,
    /// Delay, s, −10…10.
    pub lag_s: f64,
}

/// An ideal sensor.
impl Default for BaseSensorTable {
    fn default() -> Self {
        Self { gain: 1.0, offset_n: 0.0, lag_s: 0.0 }
    }
}

/// Checks whether all numbers are finite and in range.
pub(super) fn check(markers: Option<&MarkersTable>, sensor: Option<&BaseSensorTable>) -> Result<(), TablesError> {
    let (markers, sensor) = (markers.copied().unwrap_or_default(), sensor.copied().unwrap_or_default());
    let [x_m, y_m] = markers.offset_m;
    let turn = core::f64::consts::PI;
    let numbers: [(&'static str, &'static str, f64, f64, f64); 6] = [
        ("markers", "offset_m", x_m, -10.0, 10.0),
        ("markers", "offset_m", y_m, -10.0, 10.0),
        ("markers", "angle_rad", markers.angle_rad, -turn, turn),
        ("base_sensor", "gain", sensor.gain, 0.1, 10.0),
        ("base_sensor", "offset_n", sensor.offset_n, -1e3, 1e3),
        ("base_sensor", "lag_s", sensor.lag_s, -10.0, 10.0),
    ];
    for (table, key, value, min, max) in numbers {
        in_range(key, value, min, max)
            .map_err(|error| TablesError::new(Vec::from([Step::Key(table), Step::Key(key)]), error.to_string()))?;
    }
    Ok(())
}
