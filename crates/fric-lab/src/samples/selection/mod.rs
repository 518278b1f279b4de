//! Selects the samples that a fit uses, with the reasons for leaving out the others.

mod jumps;

use std::ops::Range;

use fric_core::CableParams;
use fric_core::parameters::{MU, SIGMA, Values};

use super::cable::CableRecord;
use super::held::repeated_forces;
use super::interpolated::measured_references;
use super::noise::white_noise;
use super::record::Row;
use super::steps::CoarseSteps;
use super::still::{runs, stands_still};

pub use jumps::leave_out_jumps;

/// Counts of used samples, and of samples left out by reason. Every sample is counted once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SampleCounts {
    /// Samples used for training.
    pub used: usize,
    /// Samples with a faulty sensor, motion or pose, or without tension.
    pub flagged: usize,
    /// Samples without a reference, or with one that is frozen while the cable moves.
    pub without_reference: usize,
    /// Samples between two measurements of a linearly interpolated reference.
    pub interpolated: usize,
    /// Samples at the start of a log, until the friction stored before no longer matters.
    pub warm_up: usize,
    /// Samples too far from the others to be measurements.
    pub outliers: usize,
}

/// The standing of a sample: used, or the reason why not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    Used,
    Flagged,
    WithoutReference,
    Interpolated,
    WarmUp,
    Outlier,
}

/// Remaining fraction of the friction stored at the start of a log at which it no longer matters.
const FORGOTTEN: f64 = 1e-3;
/// Minimum travel of a log, as a multiple of the distance of the warm-up, for the log to be used.
const LEAST_WAY_RATIO: f64 = 1.25;
/// A reference with less than this fraction of the sensor's noise is calculated. That of two force sensors differs by less, and that of a calculation is rounding;
/// half and twice this fraction tell the same.
const CALCULATED_RATIO: f64 = 0.1;
/// A cable with a smaller range of motion is at rest, even if its winch moves to hold the force, m.
const LEAST_RANGE_M: f64 = 3e-5;

/// Returns the standing of each sample before anything is known about the friction. `has_reference` says whether a sample has a reference.
pub fn first_look(record: &CableRecord<'_>, has_reference: impl Fn(usize) -> bool) -> Vec<Standing> {
    let standing = |(place, row): (usize, &Row)| {
        if !row.is_sound() {
            Standing::Flagged
        } else if has_reference(place) {
            Standing::Used
        } else {
            Standing::WithoutReference
        }
    };
    record.rows.iter().enumerate().map(standing).collect()
}

/// Leaves out forces of the sensor that stand still, also those before the cycle in which that shows; not if they come in coarse steps, or if a slower
/// device repeats each until the next.
pub fn leave_out_still_forces(record: &CableRecord<'_>, standings: &mut [Standing]) {
    let shown_n = record.shown_forces_n();
    if repeated_forces(record).is_some() || CoarseSteps::of(&shown_n).is_some() {
        return;
    }
    let is_still = |run: &Range<usize>| shown_n[run.start].is_finite() && stands_still(&shown_n, run);
    for run in runs(&shown_n).filter(is_still) {
        standings.iter_mut().skip(run.start).take(run.len()).for_each(|standing| *standing = Standing::Flagged);
    }
}

/// Leaves out references that stand still, unless they come in coarse steps or are calculated.
pub fn leave_out_still_references(record: &CableRecord<'_>, standings: &mut [Standing]) {
    if CoarseSteps::of(record.references_n).is_some() || is_calculated(record) {
        return;
    }
    for run in runs(record.references_n).filter(|run| stands_still(record.references_n, run)) {
        let places = standings.iter_mut().skip(run.start).take(run.len());
        places.filter(|standing| **standing == Standing::Used).for_each(|s| *s = Standing::WithoutReference);
    }
}

/// Whether the reference is calculated and no device shows it, as `m·(g − a)` of a weight that stays the same at constant speed: where it changes, it has next to
/// nothing of the noise that the sensor has.
fn is_calculated(record: &CableRecord<'_>) -> bool {
    let mut changing_n = record.references_n.to_vec();
    for run in runs(record.references_n).filter(|run| run.len() > 1) {
        changing_n.iter_mut().skip(run.start).take(run.len()).for_each(|reference_n| *reference_n = f64::NAN);
    }
    let noises_n = white_noise(&changing_n).zip(white_noise(&record.shown_forces_n()));
    // The line between two measurements has no noise either.
    noises_n.is_some_and(|(of_reference, of_sensor)| of_reference < CALCULATED_RATIO * of_sensor)
        && !measured_references(record).contains(&false)
}

/// Leaves out references that were interpolated between two measurements.
pub fn leave_out_interpolated(measured: &[bool], standings: &mut [Standing]) {
    let rows = standings.iter_mut().zip(measured).filter(|(standing, _)| **standing == Standing::Used);
    rows.filter(|(_, measured)| !**measured).for_each(|(standing, _)| *standing = Standing::Interpolated);
}

/// Leaves out the start of each log, until the friction stored before is forgotten.
///
/// After travel of a cable, `exp(−Σσ|Δl|/f_c)` of the stored friction remains, with σ and f_c of the pulley that keeps it longest. `values` only need
/// to be right to some ten per cent.
pub fn leave_out_warm_up(record: &CableRecord<'_>, values: &Values, standings: &mut [Standing]) {
    let memory_m = record.params.memory_m_per_n(values[MU], values[SIGMA]);
    for (start, rows) in record.logs() {
        let of_log = standings.iter_mut().skip(start).take(warm_up(rows, memory_m));
        let counts = |standing: &&mut Standing| [Standing::Used, Standing::Interpolated].contains(standing);
        of_log.filter(counts).for_each(|standing| *standing = Standing::WarmUp);
    }
}

/// Returns the number of cycles until the friction stored at the beginning of these rows is forgotten, by the robot file; 0 without friction.
pub fn cycles_to_forget(params: &CableParams, rows: &[Row]) -> usize {
    let given = params.values();
    let memory_m = params.memory_m_per_n(given[MU], given[SIGMA]);
    if memory_m > 0.0 {
        forgetting(rows, memory_m).take_while(|exponent| *exponent < -FORGOTTEN.ln()).count()
    } else {
        0
    }
}

/// Returns Σσ|Δl|/f_c from the first of these rows to each.
fn forgetting(rows: &[Row], memory_m: f64) -> impl Iterator<Item = f64> {
    rows.iter().scan(0.0, move |exponent, row| {
        let (tension_n, displacement_m) = (row.signals.sensor_force_n, row.signals.displacement_m);
        *exponent += if tension_n > 0.0 { displacement_m.abs() / (memory_m * tension_n) } else { 0.0 };
        Some(*exponent)
    })
}

/// Returns the number of warm-up cycles of a log, 0 without friction that lasts: all of them if its cable hardly moves further than that or is at rest,
/// because such a log is unreliable.
fn warm_up(rows: &[Row], memory_m: f64) -> usize {
    if memory_m <= 0.0 {
        return 0;
    }
    let forgotten = -FORGOTTEN.ln();
    let mut cycles = 0;
    let (mut length_m, mut least_m, mut greatest_m) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (row, exponent) in rows.iter().zip(forgetting(rows, memory_m)) {
        cycles += usize::from(exponent < forgotten);
        length_m += row.signals.displacement_m;
        (least_m, greatest_m) = (least_m.min(length_m), greatest_m.max(length_m));
        if exponent >= LEAST_WAY_RATIO * forgotten && greatest_m - least_m >= LEAST_RANGE_M {
            return cycles;
        }
    }
    rows.len()
}

/// Counts the samples by standing.
pub fn count(standings: &[Standing]) -> SampleCounts {
    let of = |wanted: Standing| standings.iter().filter(|standing| **standing == wanted).count();
    SampleCounts {
        used: of(Standing::Used),
        flagged: of(Standing::Flagged),
        without_reference: of(Standing::WithoutReference),
        interpolated: of(Standing::Interpolated),
        warm_up: of(Standing::WarmUp),
        outliers: of(Standing::Outlier),
    }
}
