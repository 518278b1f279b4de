//! Which samples a fit learns from, and why not from the others.

use fric_core::parameters::{MU, SIGMA, Values};

use super::record::{CableRecord, Row};

/// How many samples count, and how many not for which reason. Every sample is in one of these.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SampleCounts {
    /// Learned from.
    pub used: usize,
    /// Faulty sensor, motion or pose, or no tension.
    pub flagged: usize,
    /// No reference, or one that stood still while the cable moved.
    pub without_reference: usize,
    /// Between two measurements of the reference, which has been joined by lines.
    pub interpolated: usize,
    /// From the start of a log until what the pulleys had stored before no longer matters.
    pub warm_up: usize,
    /// Too far from everything else to be a measurement.
    pub outliers: usize,
}

/// Where a sample is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    Used,
    Flagged,
    WithoutReference,
    Interpolated,
    WarmUp,
    Outlier,
}

/// A reference that keeps its last bit over this way of the cable is no measurement, m.
const STILL_TRAVEL_M: f64 = 1e-3;
/// Fewest samples in a row with the same reference for that.
const STILL_COUNT: usize = 20;
/// What is left of the friction stored at the start of a log when it no longer matters.
const FORGOTTEN: f64 = 1e-3;
/// A log's way, as a multiple of what it takes to forget, from which on it is used at all.
const LEAST_WAY_RATIO: f64 = 1.25;
/// A cable that moves less than this at all rests, whatever its winch does to hold the force, m.
const LEAST_RANGE_M: f64 = 3e-5;

/// Standing of each sample before anything is known about the friction; `has_reference` says whether there is something
/// to compare with.
pub fn first_look(record: &CableRecord<'_>, has_reference: impl Fn(usize, &Row) -> bool) -> Vec<Standing> {
    let standing = |(place, row): (usize, &Row)| {
        if !row.is_sound() {
            Standing::Flagged
        } else if has_reference(place, row) {
            Standing::Used
        } else {
            Standing::WithoutReference
        }
    };
    record.rows.iter().enumerate().map(standing).collect()
}

/// Takes out references that stand still to the last bit while the cable moves.
pub fn leave_out_still_references(record: &CableRecord<'_>, standings: &mut [Standing]) {
    let mut start = 0;
    for run in record.rows.chunk_by(|one, next| one.reference_n.to_bits() == next.reference_n.to_bits()) {
        let travel_m: f64 = run.iter().map(|row| row.signals.displacement_m.abs()).sum();
        if run.len() >= STILL_COUNT && travel_m >= STILL_TRAVEL_M {
            let places = standings.iter_mut().skip(start).take(run.len());
            places.filter(|standing| **standing == Standing::Used).for_each(|s| *s = Standing::WithoutReference);
        }
        start += run.len();
    }
}

/// Takes out references that nobody measured, but lines between two measurements give.
pub fn leave_out_interpolated(measured: &[bool], standings: &mut [Standing]) {
    let rows = standings.iter_mut().zip(measured).filter(|(standing, _)| **standing == Standing::Used);
    rows.filter(|(_, measured)| !**measured).for_each(|(standing, _)| *standing = Standing::Interpolated);
}

/// Takes out the start of each log, until the friction stored before is forgotten.
///
/// Whatever way a cable moves, `exp(−Σσ|Δl|/f_c)` of the stored friction is left, with σ and f_c of the pulley that keeps
/// it longest; `values` need to be right to some ten per cent only.
pub fn leave_out_warm_up(record: &CableRecord<'_>, values: &Values, standings: &mut [Standing]) {
    let memory_m = record.params.memory_m_per_n(values[MU], values[SIGMA]);
    if memory_m <= 0.0 {
        return;
    }
    for (start, rows) in record.logs() {
        let of_log = standings.iter_mut().skip(start).take(warm_up(rows, memory_m));
        let counts = |standing: &&mut Standing| [Standing::Used, Standing::Interpolated].contains(standing);
        of_log.filter(counts).for_each(|standing| *standing = Standing::WarmUp);
    }
}

/// How many cycles of a log it takes to forget; all where its cable moves hardly further than that, or rests: such a log tells
/// nothing that could be relied on.
fn warm_up(rows: &[Row], memory_m: f64) -> usize {
    let forgotten = -FORGOTTEN.ln();
    let (mut exponent, mut cycles) = (0.0, 0);
    let (mut length_m, mut least_m, mut greatest_m) = (0.0_f64, 0.0_f64, 0.0_f64);
    for row in rows {
        let (tension_n, displacement_m) = (row.signals.sensor_force_n, row.signals.displacement_m);
        exponent += if tension_n > 0.0 { displacement_m.abs() / (memory_m * tension_n) } else { 0.0 };
        cycles += usize::from(exponent < forgotten);
        length_m += displacement_m;
        (least_m, greatest_m) = (least_m.min(length_m), greatest_m.max(length_m));
        if exponent >= LEAST_WAY_RATIO * forgotten && greatest_m - least_m >= LEAST_RANGE_M {
            return cycles;
        }
    }
    rows.len()
}

/// Counts them.
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
