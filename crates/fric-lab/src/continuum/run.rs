//! A run of a manipulator: what was measured, sample by sample.

use super::error::ContinuumError;

/// What was measured at one time. A list that was not measured is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunSample {
    /// Time, s.
    pub time_s: f64,
    /// Tension of the tendon at the base, N.
    pub tension_base_n: f64,
    /// Wavelength shift of the grating in each segment, nm; NaN where a grating is dead.
    pub shift_nm: Vec<f64>,
    /// Centre of each disk, base frame, m.
    pub marker_m: Vec<[f64; 2]>,
}

/// Whether a run fits a manipulator with so many disks.
///
/// # Errors
/// [`ContinuumError::TimeNotRising`], [`ContinuumError::NotFinite`] and [`ContinuumError::WrongCount`] name the first sample that is
/// not right.
pub fn check_run(samples: &[RunSample], disk_count: usize) -> Result<(), ContinuumError> {
    let mut before_s = f64::NEG_INFINITY;
    for sample in samples {
        let time_s = sample.time_s;
        if !time_s.is_finite() || time_s <= before_s {
            return Err(ContinuumError::TimeNotRising { time_s, before_s });
        }
        before_s = time_s;
        let tension_n = sample.tension_base_n;
        if !tension_n.is_finite() || tension_n < 0.0 {
            return Err(ContinuumError::NotFinite { what: "tension_base_n", value: tension_n, time_s });
        }
        for (what, count) in [("shifts", sample.shift_nm.len()), ("markers", sample.marker_m.len())] {
            if count != 0 && count != disk_count {
                return Err(ContinuumError::WrongCount { what, count, needed: disk_count });
            }
        }
    }
    Ok(())
}
