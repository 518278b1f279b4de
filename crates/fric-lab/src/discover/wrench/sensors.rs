//! Faults of the force sensors in a log that is compared with the wrench: hum, and intervals in which a sensor is faulty.
//!
//! Hum of the mains enters the wiring of a sensor and does not act on the platform. A spectral line of a sensor's force that is unrelated to the
//! motion of its cable counts as hum if the wrench of the cables comes nearer to its reference without it. A cable that really vibrates pulls on the
//! platform, and a measured wrench shows the same vibration.
//!
//! The lines are searched in the force after [`PASSES`] high-pass filters, each of which subtracts the mean over [`WINDOW_S`]. They remove nearly all
//! of the motion. Each passes the fraction `H = 1 − sin(n·φ/2)/(n·sin(φ/2))` of a sine, with φ the angle between two samples and n the number of
//! samples in the mean.

use core::f64::consts::PI;

use nalgebra::Vector6;

use crate::discover::faults::lines::{Line, lines};
use crate::discover::faults::passes::Passes;
use crate::discover::faults::spectrum::{Times, motion_and_load};
use crate::discover::faults::{FaultyStretch, faulty_stretches, leave_out, of_stretches};
use crate::fit::balance::by_moment_arm;
use crate::fit::wrench::ReferenceWrenches;
use crate::fit::{CableRecord, Measurements, Row};
use crate::recording_fault::{Fault, RecordingFault};
use crate::samples::selection::Standing;

/// Width of the mean, s: one period of 50 Hz.
const WINDOW_S: f64 = 0.02;
/// Number of high-pass filters. After a single one, lines of fast motion exceed those of hum.
const PASSES: i32 = 3;
/// A line of which less than this fraction passes each filter may be motion and is not considered. The limit lies near 30 Hz.
const LEAST_PASSED: f64 = 0.5;

/// A log with its sensor faults corrected where possible.
pub struct Sensors<'a> {
    /// The log without hum.
    pub measurements: Measurements<'a>,
    /// The faults of each cable's sensor.
    pub faults: Vec<Vec<RecordingFault>>,
    /// Whether some sensor is faulty in a sample.
    pub is_faulty: Vec<bool>,
}

/// Hum of one sensor.
struct Hum {
    cable: usize,
    line: Line,
    /// Fraction of its amplitude that has passed the filters.
    passed: f64,
    /// The hum in each sample, as the sensor shows it, N.
    force_n: Vec<f64>,
}

impl<'a> Sensors<'a> {
    /// Finds the faults in a log.
    pub fn of(measurements: &Measurements<'a>, references: &ReferenceWrenches) -> Self {
        let records: Vec<CableRecord<'_>> = measurements.cables().collect();
        let of_cables: Vec<Vec<FaultyStretch>> = records.iter().map(faulty_stretches).collect();
        let mut standings = vec![Standing::Used; measurements.len()];
        for (record, stretches) in records.iter().zip(&of_cables) {
            leave_out(record, stretches, &mut standings);
        }
        let is_faulty: Vec<bool> = standings.iter().map(|standing| *standing != Standing::Used).collect();
        let found = records.iter().enumerate().flat_map(|(cable, record)| hum_of(cable, record, &is_faulty));
        let hum = outside_of_the_wrench(found.collect(), &records, measurements, references);
        let rows = |(cable, record): (usize, &CableRecord<'_>)| -> Option<Vec<Row>> {
            hum.iter().any(|of| of.cable == cable).then(|| {
                let mut rows = record.rows.to_vec();
                for of in hum.iter().filter(|of| of.cable == cable) {
                    let forces = rows.iter_mut().map(|row| &mut row.signals.sensor_force_n);
                    forces.zip(&of.force_n).for_each(|(force_n, hum_n)| *force_n -= hum_n);
                }
                rows
            })
        };
        let rows: Vec<Option<Vec<Row>>> = records.iter().enumerate().map(rows).collect();
        let faults = |(cable, (record, stretches)): (usize, (&CableRecord<'_>, &Vec<FaultyStretch>))| {
            let of_hum = hum.iter().filter(|of| of.cable == cable).map(Hum::fault);
            of_hum.chain(of_stretches(stretches, |cycle| record.time_s(cycle))).collect()
        };
        let faults = records.iter().zip(&of_cables).enumerate().map(faults).collect();
        let is_clean = rows.iter().all(Option::is_none);
        let measurements = if is_clean { measurements.clone() } else { measurements.with_rows(rows) };
        Self { measurements, faults, is_faulty }
    }
}

impl Hum {
    fn fault(&self) -> RecordingFault {
        let amplitude_n = self.line.amplitude() / self.passed;
        let parameters = vec![("frequency_hz", self.line.frequency_hz), ("amplitude_n", amplitude_n)];
        RecordingFault { fault: Fault::Hum, parameters, intervals_s: Vec::new() }
    }
}

/// Returns spectral lines of a sensor that are unrelated to the motion of its cable.
fn hum_of(cable: usize, record: &CableRecord<'_>, is_faulty: &[bool]) -> Vec<Hum> {
    let shown = |(row, is_faulty): (&Row, &bool)| {
        if row.signals.sensor_finite && !is_faulty { row.signals.sensor_force_n } else { f64::NAN }
    };
    let sensed: Vec<f64> = record.rows.iter().zip(is_faulty).map(shown).collect();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
    let half = (0.5 * WINDOW_S / record.interval_s).round() as usize;
    if half == 0 {
        return Vec::new();
    }
    let times = Times::of(record);
    let mut signals = motion_and_load(record);
    // The last signal is the load as the sensor shows it, which is what is searched.
    signals.truncate(signals.len().saturating_sub(1));
    let quick = (0..PASSES).fold(sensed, |signal, _| less_mean(record, &signal, half));
    let found = lines(&quick, &times, &signals, &Passes::of(record)).into_iter().map(|line| {
        #[expect(clippy::cast_precision_loss, reason = "a few samples")]
        let count = (2 * half + 1) as f64;
        let half_angle = PI * line.frequency_hz * record.interval_s;
        let once = 1.0 - (count * half_angle).sin() / (count * half_angle.sin());
        let passed = if once > LEAST_PASSED { once.powi(PASSES) } else { 0.0 };
        let mut force_n = vec![0.0; record.rows.len()];
        if passed > 0.0 {
            line.add_to(force_n.iter_mut(), passed.recip(), &times);
        }
        Hum { cable, line, passed, force_n }
    });
    found.filter(|hum| hum.passed > 0.0).collect()
}

/// Returns a signal minus its mean over `half` samples on either side; NaN if one of these is NaN, and at the ends of a log.
fn less_mean(record: &CableRecord<'_>, signal: &[f64], half: usize) -> Vec<f64> {
    let mut rest = vec![f64::NAN; signal.len()];
    #[expect(clippy::cast_precision_loss, reason = "a few samples")]
    let count = (2 * half + 1) as f64;
    for (start, rows) in record.logs() {
        let of_log = signal.get(start..start + rows.len()).unwrap_or_default();
        for (place, window) in of_log.windows(2 * half + 1).enumerate() {
            let (Some(middle), Some(rest)) = (window.get(half), rest.get_mut(start + place + half)) else { continue };
            *rest = middle - window.iter().sum::<f64>() / count;
        }
    }
    rest
}

/// Returns the lines without which the wrench of the cables comes nearer to its reference. All cables' lines of a frequency are judged together.
fn outside_of_the_wrench(
    found: Vec<Hum>,
    records: &[CableRecord<'_>],
    measurements: &Measurements<'_>,
    references: &ReferenceWrenches,
) -> Vec<Hum> {
    if found.is_empty() {
        return found;
    }
    let structure = &measurements.platform().structure;
    let scale = by_moment_arm(structure);
    let count = records.len();
    let at = |place: usize, force_n: &dyn Fn(usize) -> f64| -> Vector6<f64> {
        let columns = structure.iter().skip(place * count).take(count).enumerate();
        columns.map(|(cable, column)| column * (records[cable].params.frictionless_gain() * force_n(cable))).sum()
    };
    let sensor_n = |place: usize, cable: usize| records[cable].rows[place].signals.sensor_force_n;
    let measured = (0..measurements.len()).filter(|place| references.measured.get(*place) == Some(&true));
    let deviations: Vec<(usize, Vector6<f64>)> = measured
        .map(|place| (place, scale * (references.outside[place] + at(place, &|cable| sensor_n(place, cable)))))
        .filter(|(_, deviation)| deviation.iter().all(|part| part.is_finite()))
        .collect();
    let is_better_without = |frequency_hz: f64| {
        let alike: Vec<&Hum> = found.iter().filter(|of| is_near(of, frequency_hz)).collect();
        let change = |(place, deviation): &(usize, Vector6<f64>)| {
            let hum_n = |cable: usize| alike.iter().filter(|of| of.cable == cable).map(|of| of.force_n[*place]).sum();
            let hum = scale * at(*place, &hum_n);
            // Half of the change of the squared deviation.
            0.5 * hum.norm_squared() - hum.dot(deviation)
        };
        deviations.iter().map(change).sum::<f64>() < 0.0
    };
    let keep: Vec<bool> = found.iter().map(|of| is_better_without(of.line.frequency_hz)).collect();
    found.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(of, _)| of).collect()
}

/// Whether the frequency of a line equals another one, within the resolution of a spectrum.
fn is_near(hum: &Hum, frequency_hz: f64) -> bool {
    const NEAR_HZ: f64 = 0.25;
    (hum.line.frequency_hz - frequency_hz).abs() < NEAR_HZ
}
