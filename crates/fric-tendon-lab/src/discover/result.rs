//! What the result of a manipulator's discovery has besides, or instead of, a robot's; the keys of `fric-discover/1` are those of
//! [`fric_lab::discover::result`].

use fric_lab::discover::result::{Absent, DiscoverResult, Machine, Value};
use serde::Serialize;

use super::goes_with::GoesWith;
use super::summary::describe;

/// A manipulator: its result has one cable, the tendon.
#[derive(Clone, Copy, Debug)]
pub struct Manipulator;

impl Machine for Manipulator {
    type OfRobots<T: Value> = Absent;
    /// Number of a grating or a disk, from 1 at the base.
    type Bound = usize;
    type GoesWith = GoesWith;
    type Markers = TendonMarkers;
    /// Cause and remedy.
    type Entry = [&'static str; 2];

    fn summary(result: &DiscoverResult<Self>) -> String {
        describe(result)
    }
}

/// Distances between disks and markers, which do not depend on the friction.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TendonMarkers {
    /// Root mean square noise of a distance, mm, due to markers and gratings.
    pub noise_mm: f64,
    /// Root mean square displacement of the disks for one standard error of the calibration lines, mm.
    pub calibration_error_mm: f64,
    /// Distances with the given file.
    pub before: MarkerError,
    /// Distances with the extended file.
    pub after: MarkerError,
}

/// Distances over all disks and samples.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MarkerError {
    /// Root mean square, mm.
    pub rms_mm: f64,
    /// Greatest distance, mm.
    pub max_mm: f64,
}
