//! A run of a manipulator: the measurements, sample by sample.

use fric_tendon::{ManipulatorParams, Tendon};

use super::columns::{self, Columns};
use super::error::ContinuumError;

/// Base tension of the first sample, as a fraction of the run's greatest, above which the holes may remember something from before the run. They hold
/// friction in proportion to the tension, so that at half of it a memory of a fortieth of the greatest friction counts, at twice a tenth does not.
const BEGIN_RATIO: f64 = 0.05;

/// The measurements at one time. A list that was not measured is empty.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSample {
    /// Time, s.
    pub time_s: f64,
    /// Tension of the tendon at the base, N; NaN if it was not measured.
    pub tension_base_n: f64,
    /// Wavelength shift of the grating in each segment, nm; NaN if a grating is dead.
    pub shift_nm: Vec<f64>,
    /// Shift of the unloaded reference grating, nm; NaN without one.
    pub shift_reference_nm: f64,
    /// Centre of each disk, base frame, m; NaN if a marker is hidden.
    pub marker_m: Vec<[f64; 2]>,
}

impl Default for RunSample {
    fn default() -> Self {
        let nan = f64::NAN;
        Self { time_s: 0.0, tension_base_n: nan, shift_nm: Vec::new(), shift_reference_nm: nan, marker_m: Vec::new() }
    }
}

/// Ratio of the markers' distance to the arm's length above which they are in millimetres, which makes some 500 of the half of the arm. A camera may
/// stand apart from a small arm; at half and at twice this ratio the same runs are refused.
const FAR_RATIO: f64 = 100.0;

/// A checked run: time increases, tensions are finite and not negative, and every group of columns is complete or absent.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    samples: Vec<RunSample>,
    disk_count: usize,
    has_tension: bool,
}

impl Run {
    /// Creates a run from named columns; any group except the time may be missing: `time_s`, `tension_base_n`, `shift_1_nm …`, `shift_reference_nm`,
    /// `marker_1_x_m, marker_1_y_m …`.
    ///
    /// # Errors
    /// Returns a [`ContinuumError`] with the first column that is unknown, missing in its group or of another length, or the first invalid sample.
    pub fn from_columns(columns: &[(String, Vec<f64>)], disk_count: usize) -> Result<Self, ContinuumError> {
        let all = Columns::new(columns, &columns::of_run(disk_count))?;
        let time_s = all.required(columns::TIME)?;
        let tension_n = all.get(columns::TENSION_BASE);
        let reference_nm = all.get(columns::SHIFT_REFERENCE);
        let shift_nm = all.shifts(disk_count)?.unwrap_or_default();
        let marker_m = all.group(&columns::markers(disk_count))?.unwrap_or_default();
        let of = |column: Option<&[f64]>, row: usize| column.and_then(|column| column.get(row)).copied();
        let samples = time_s
            .iter()
            .enumerate()
            .map(|(row, time_s)| {
                let numbers = |group: &[&[f64]]| -> Vec<f64> {
                    group.iter().map(|column| of(Some(column), row).unwrap_or(f64::NAN)).collect()
                };
                RunSample {
                    time_s: *time_s,
                    tension_base_n: of(tension_n, row).unwrap_or(f64::NAN),
                    shift_nm: numbers(&shift_nm),
                    shift_reference_nm: of(reference_nm, row).unwrap_or(f64::NAN),
                    marker_m: numbers(&marker_m).as_chunks().0.to_vec(),
                }
            })
            .collect();
        Self::checked(samples, disk_count, tension_n.is_some())
    }

    /// Creates a run from samples. The base tension counts as measured if any sample has one.
    ///
    /// # Errors
    /// Returns a [`ContinuumError`] with the first invalid sample.
    pub fn new(samples: Vec<RunSample>, disk_count: usize) -> Result<Self, ContinuumError> {
        let has_tension = samples.iter().any(|sample| !sample.tension_base_n.is_nan());
        Self::checked(samples, disk_count, has_tension)
    }

    fn checked(samples: Vec<RunSample>, disk_count: usize, has_tension: bool) -> Result<Self, ContinuumError> {
        let mut before_s = f64::NEG_INFINITY;
        for (place, sample) in samples.iter().enumerate() {
            let (time_s, row) = (sample.time_s, place + 1);
            if !time_s.is_finite() {
                return Err(ContinuumError::NoTime { row, time_s });
            }
            if time_s <= before_s {
                return Err(ContinuumError::TimeNotRising { row, time_s, before_s });
            }
            before_s = time_s;
            let tension_n = sample.tension_base_n;
            if has_tension && !(tension_n.is_finite() && tension_n >= 0.0) {
                return Err(ContinuumError::NoTension { row, tension_n, time_s });
            }
            for (what, count) in [("shifts", sample.shift_nm.len()), ("markers", sample.marker_m.len())] {
                if count != 0 && count != disk_count {
                    return Err(ContinuumError::WrongCount { what, count, needed: disk_count });
                }
            }
        }
        Ok(Self { samples, disk_count, has_tension })
    }

    /// Returns the samples in the order of time.
    #[must_use]
    pub fn samples(&self) -> &[RunSample] {
        &self.samples
    }

    /// Returns the tension at the base with which the run begins, N, if the holes may remember something from before it.
    #[must_use]
    pub fn begin_tension_n(&self) -> Option<f64> {
        let greatest_n = self.samples.iter().map(|sample| sample.tension_base_n).fold(0.0, f64::max);
        self.samples.first().map(|first| first.tension_base_n).filter(|first_n| *first_n > BEGIN_RATIO * greatest_n)
    }

    /// Returns a warning in one sentence if the tendon is under tension at the beginning: what the holes remember from before is unknown.
    #[must_use]
    pub fn begin_warning(&self) -> Option<String> {
        self.begin_tension_n().map(|first_n| {
            format!(
                "the run begins at {first_n:.2} N at the base, and the history takes the tendon as pulled from slack to there; if it was released \
                 before, friction is wrong until the tension passes the one from which it was released. Begin runs with a slack tendon"
            )
        })
    }

    /// Returns the run with other tensions at the base, which must be finite and not negative.
    pub(super) fn with_base_tension(&self, tension_n: &[f64]) -> Self {
        let mut run = self.clone();
        for (sample, tension_n) in run.samples.iter_mut().zip(tension_n) {
            sample.tension_base_n = *tension_n;
        }
        run
    }

    /// Returns the run with other markers, of the same number in each sample.
    pub(super) fn with_markers(&self, marker_m: Vec<Vec<[f64; 2]>>) -> Self {
        let mut run = self.clone();
        for (sample, marker_m) in run.samples.iter_mut().zip(marker_m) {
            sample.marker_m = marker_m;
        }
        run
    }

    /// Returns the run with a step taken off the shifts of all gratings from a time on.
    pub(super) fn without_step(mut self, from_s: f64, step_nm: f64) -> Self {
        for sample in self.samples.iter_mut().filter(|sample| sample.time_s >= from_s) {
            sample.shift_nm.iter_mut().for_each(|shift_nm| *shift_nm -= step_nm);
        }
        self
    }

    /// Returns the number of disks of the manipulator.
    #[must_use]
    pub fn disk_count(&self) -> usize {
        self.disk_count
    }

    /// Whether the tension at the base was measured.
    #[must_use]
    pub fn has_tension(&self) -> bool {
        self.has_tension
    }

    /// Whether there are gratings.
    #[must_use]
    pub fn has_shifts(&self) -> bool {
        self.samples.iter().any(|sample| !sample.shift_nm.is_empty())
    }

    /// Whether there is an unloaded reference grating in every sample.
    #[must_use]
    pub fn has_reference(&self) -> bool {
        !self.samples.is_empty() && self.samples.iter().all(|sample| sample.shift_reference_nm.is_finite())
    }

    /// Whether there are markers.
    #[must_use]
    pub fn has_markers(&self) -> bool {
        self.samples.iter().any(|sample| !sample.marker_m.is_empty())
    }

    /// Checks that tensions and markers are of the manipulator's size.
    ///
    /// # Errors
    /// Returns [`ContinuumError::OverCapacity`] with the first tension at the base that exceeds the tendon's capacity, or
    /// [`ContinuumError::MarkerUnit`] for markers much farther away than the arm is long.
    pub fn check_sizes(&self, params: &ManipulatorParams) -> Result<(), ContinuumError> {
        let capacity_n = params.capacity_n(Tendon::Agonist);
        let over = self.samples.iter().position(|sample| sample.tension_base_n > capacity_n);
        if let Some((place, sample)) = over.and_then(|place| Some((place, self.samples.get(place)?))) {
            return Err(ContinuumError::OverCapacity {
                row: place + 1,
                time_s: sample.time_s,
                tension_n: sample.tension_base_n,
                capacity_n,
            });
        }
        let distances_m = self.samples.iter().flat_map(|sample| &sample.marker_m).map(|[x_m, y_m]| x_m.hypot(*y_m));
        let mut sorted_m: Vec<f64> = distances_m.filter(|distance_m| distance_m.is_finite()).collect();
        sorted_m.sort_by(f64::total_cmp);
        let length_m = params.length_m();
        match sorted_m.get(sorted_m.len() / 2) {
            Some(&middle_m) if middle_m > FAR_RATIO * length_m => {
                Err(ContinuumError::MarkerUnit { distance_m: middle_m, length_m })
            }
            _ => Ok(()),
        }
    }
}
