//! Options of an identification run.

use fric_core::KnownReference;

use super::error::ExcitationError;
use crate::trajectory::Limits;

/// Maximum coordinate of a box, m.
const FURTHEST_M: f64 = 1e4;
/// Minimum length of a box's longest edge, m.
const SHORTEST_EDGE_M: f64 = 1e-3;

/// Region and limits of the run.
///
/// ```
/// use fric_lab::excite::ExcitationOptions;
/// let gentle = ExcitationOptions { max_speed_m_per_s: Some(0.3), ..ExcitationOptions::default() };
/// assert_eq!(gentle.max_tension_n, None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExcitationOptions {
    /// Least and greatest corner of the platform's box, base frame, m; that of the simulation by default.
    pub box_m: Option<[[f64; 3]; 2]>,
    /// Maximum speed of the platform, m/s; that of the run by default.
    pub max_speed_m_per_s: Option<f64>,
    /// Maximum acceleration of the platform, m/s²; that of the run by default, and under a hanging mass 0.4 m/s², at which its force counts as known.
    pub max_acceleration_m_per_s2: Option<f64>,
    /// Minimum cable force at the platform, N; that of the simulation by default.
    pub min_tension_n: Option<f64>,
    /// Maximum cable force at the platform, N; unlimited by default.
    pub max_tension_n: Option<f64>,
}

impl ExcitationOptions {
    /// Checks whether all numbers are in range.
    pub(super) fn check(&self) -> Result<(), ExcitationError> {
        let ranges = [
            ("max_speed_m_per_s", self.max_speed_m_per_s, 1e-3, 100.0),
            ("max_acceleration_m_per_s2", self.max_acceleration_m_per_s2, 1e-3, 1e4),
            ("min_tension_n", self.min_tension_n, 1e-6, 1e6),
            ("max_tension_n", self.max_tension_n, self.min_tension_n.unwrap_or(1e-6), 1e7),
        ];
        for (key, value, min, max) in ranges {
            if let Some(value) = value.filter(|value| !(min..=max).contains(value)) {
                return Err(ExcitationError::OptionOutOfRange { key, value, min, max });
            }
        }
        let Some([least_m, greatest_m]) = self.box_m else { return Ok(()) };
        for value in least_m.into_iter().chain(greatest_m) {
            if !(-FURTHEST_M..=FURTHEST_M).contains(&value) {
                let (key, min, max) = ("box_m", -FURTHEST_M, FURTHEST_M);
                return Err(ExcitationError::OptionOutOfRange { key, value, min, max });
            }
        }
        let edges = ["x", "y", "z"].into_iter().zip(least_m.into_iter().zip(greatest_m));
        let is_point = edges.clone().all(|(_, (from, to))| to - from < SHORTEST_EDGE_M);
        match edges.into_iter().find(|(_, (from, to))| is_point || to < from) {
            Some((axis, (from, to))) => Err(ExcitationError::BadBox { axis, from, to }),
            None => Ok(()),
        }
    }

    /// Returns the limits of a run under a load that may be known.
    pub(super) fn limits(&self, known: Option<&KnownReference>) -> Limits {
        let of_load = Limits::of_load(known);
        Limits {
            speed_m_per_s: self.max_speed_m_per_s.unwrap_or(of_load.speed_m_per_s),
            acceleration_m_per_s2: self.max_acceleration_m_per_s2.unwrap_or(of_load.acceleration_m_per_s2),
        }
    }

    /// Returns the first given option that concerns the platform.
    pub(super) fn about_platform(&self) -> Option<&'static str> {
        [
            ("box_m", self.box_m.is_some()),
            ("min_tension_n", self.min_tension_n.is_some()),
            ("max_tension_n", self.max_tension_n.is_some()),
        ]
        .into_iter()
        .find_map(|(key, given)| given.then_some(key))
    }
}
