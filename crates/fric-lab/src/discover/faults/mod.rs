//! Faults of the recording itself, which have nothing to do with friction.
//!
//! Each such fault has a name, values and a place in time, and is corrected before model and log are compared: stretches in which a sensor stands still or is at the
//! end of its range, or where it spikes, are left out, hum (`lines`) and vibrations (`vibration`) come off the reference, the noise of the length (`length_noise`) is kept from being motion, and a reference
//! that comes late goes where it belongs (`timing`). The steps of a coarse converter are noise, and told.

pub mod correction;
pub mod length_noise;
pub mod lines;
pub mod oscillations;
pub mod spectrum;
pub mod timing;
pub mod vibration;

use std::ops::Range;

use crate::fit::{CableRecord, Row};
use crate::samples::selection::Standing;

/// Minimum number of consecutive samples with a bit-identical force for a frozen sensor.
const FEWEST_STILL: usize = 20;
/// Such a run must also be this many times as long as the usual runs, for sensors with few digits.
const STILL_RATIO: usize = 8;
/// Minimum number of samples at the greatest or least force of a log for this force to be the end of the sensor's range.
const FEWEST_AT_END: usize = 20;
/// A spike differs from the medians of its neighbours on either side by more than this multiple of the median deviation; in white noise one sample in
/// 10¹³ does. It also differs by more than this multiple of the difference between these two medians.
const SPIKE_RATIO: f64 = 12.0;
const SPIKE_NEIGHBOURS: usize = 4;
const AGREEMENT: f64 = 4.0;
/// A spike also exceeds this fraction of the force. Friction of 8 % that reverses for one cycle makes 16 %.
const FRICTION_RATIO: f64 = 0.25;
/// Limits for the values of a coarse converter: the minimum average number of samples per value, and the maximum distance of a value from a multiple
/// of the step, which allows for rounding.
const FEWEST_A_STEP: usize = 20;
const OFF_STEP: f64 = 1e-3;
/// Time that is left out after a faulty stretch, s. The friction of the model has to settle again.
const AFTER_S: f64 = 0.1;
/// Two stretches closer than this are merged, s.
const MERGED_S: f64 = 0.1;

/// The kind of a recording fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A spectral line that is unrelated to the motion and load of the cable.
    Hum,
    /// A damped oscillation of one frequency, as of a sensor on a mount that gives way.
    Vibration,
    /// The length trembles, and the model takes it for motion.
    NoisyLength,
    /// The force sensor repeats one value.
    Frozen,
    /// The force sensor is saturated.
    Clipped,
    /// The force sensor shows single values far from those before and after.
    Spikes,
    /// The converter behind the force sensor has coarse steps.
    CoarseConverter,
    /// The reference is late.
    ReferenceDelay,
    /// The clock of the reference runs at another rate than the clock of the winch.
    ClockSkew,
}

/// A fault of a recording. It concerns the log, not the machine.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingFault {
    /// The kind of the fault.
    pub fault: Fault,
    /// The values of the fault, by key with the unit.
    pub parameters: Vec<(&'static str, f64)>,
    /// Time intervals of the fault, s since the first sample; empty if it lasts throughout the log.
    pub intervals_s: Vec<[f64; 2]>,
}

/// Cycles in which the sensor cannot be trusted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultyStretch {
    /// The kind of the fault.
    pub fault: Fault,
    /// The cycles.
    pub cycles: Range<usize>,
}

/// Returns the stretches of a cable's log with a faulty sensor, in the order of time.
pub fn faulty_stretches(record: &CableRecord<'_>) -> Vec<FaultyStretch> {
    // A sample without a number takes the last good one and is already flagged.
    let shown_n = |row: &Row| if row.signals.sensor_finite { row.signals.sensor_force_n } else { f64::NAN };
    let shown: Vec<f64> = record.rows.iter().map(shown_n).collect();
    let runs: Vec<Range<usize>> = shown
        .chunk_by(|one, next| one.to_bits() == next.to_bits())
        .scan(0, |start, run| {
            *start += run.len();
            Some(*start - run.len()..*start)
        })
        .filter(|run| shown.get(run.start).is_some_and(|force_n| force_n.is_finite()))
        .collect();
    let usual = usual_length(&runs, runs.iter().map(Range::len).sum());
    let mut stretches = Vec::new();
    let ends = ends_of_range(&shown, usual);
    let is_end = |force_n: f64| ends.iter().any(|end| end.to_bits() == force_n.to_bits());
    // A steady force stays within one coarse step, so such a sensor cannot be distinguished from a frozen one.
    let is_coarse = coarse_step_n(record).is_some();
    for run in runs {
        let Some(force_n) = shown.get(run.start) else { continue };
        if is_end(*force_n) {
            stretches.push(FaultyStretch { fault: Fault::Clipped, cycles: run });
        } else if !is_coarse && run.len() >= FEWEST_STILL.max(STILL_RATIO * usual) {
            stretches.push(FaultyStretch { fault: Fault::Frozen, cycles: run });
        }
    }
    stretches.extend(spikes(&shown).map(|cycles| FaultyStretch { fault: Fault::Spikes, cycles }));
    stretches.sort_by_key(|stretch| (stretch.cycles.start, stretch.cycles.end));
    merged(stretches, record.interval_s)
}

/// Returns the places at which a signal jumps away and back: it is far from its neighbours on both sides, and the neighbours agree. Noise does not do
/// this. Where most values equal their neighbours, the noise cannot be estimated.
fn spikes(shown: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let middle = |values: &[f64]| {
        let mut values: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        let place = values.len() / 2;
        (!values.is_empty()).then(|| *values.select_nth_unstable_by(place, f64::total_cmp).1)
    };
    let change = |place: usize| (shown[place + 1] - shown[place]).abs();
    let off = |place: usize| {
        let around = place.checked_sub(SPIKE_NEIGHBOURS)?..place + SPIKE_NEIGHBOURS + 1;
        let (before, rest) = shown.get(around)?.split_at(SPIKE_NEIGHBOURS);
        let (value, after) = rest.split_first()?;
        let (before, after) = (middle(before)?, middle(after)?);
        let off = (value - f64::midpoint(before, after)).abs();
        let [rise, fall] = [place - 2, place].map(|place| change(place).max(change(place + 1)));
        let is_beyond_friction = off > FRICTION_RATIO * f64::midpoint(before, after).abs();
        let is_spike = is_beyond_friction && off > AGREEMENT * (before - after).abs() && rise.min(fall) > 0.5 * off;
        Some((off, is_spike))
    };
    let off: Vec<(f64, bool)> = (0..shown.len()).map(|place| off(place).unwrap_or((f64::NAN, false))).collect();
    let usual = middle(&off.iter().map(|(off, _)| *off).collect::<Vec<f64>>()).unwrap_or(0.0);
    let least = if usual > 0.0 { SPIKE_RATIO * usual } else { f64::INFINITY };
    let far = off.into_iter().enumerate().filter(move |(_, (off, is_spike))| *is_spike && *off > least);
    far.map(|(place, _)| place..place + 1)
}

/// Returns the step of the sensor's values, N, if all values are integer multiples of one step apart and each occurs many times.
pub fn coarse_step_n(record: &CableRecord<'_>) -> Option<f64> {
    let mut values: Vec<f64> =
        record.rows.iter().filter(|row| row.signals.sensor_finite).map(|row| row.signals.sensor_force_n).collect();
    let count = values.len();
    values.sort_by(f64::total_cmp);
    values.dedup();
    if values.len() < 2 || values.len() * FEWEST_A_STEP > count {
        return None;
    }
    let gaps = || values.windows(2).map(|pair| pair[1] - pair[0]);
    let step_n = gaps().fold(f64::INFINITY, f64::min);
    gaps().all(|gap_n| (gap_n / step_n - (gap_n / step_n).round()).abs() < OFF_STEP).then_some(step_n)
}

/// Returns the run length that half of the samples belong to.
fn usual_length(runs: &[Range<usize>], samples: usize) -> usize {
    let mut lengths: Vec<usize> = runs.iter().map(Range::len).collect();
    lengths.sort_unstable();
    let mut seen = 0;
    for length in lengths {
        seen += length;
        if 2 * seen >= samples {
            return length;
        }
    }
    1
}

/// Returns the greatest and the least force if the sensor stays there longer than a noisy signal would.
fn ends_of_range(forces_n: &[f64], usual: usize) -> Vec<f64> {
    let mut ends = Vec::new();
    for pick in [f64::max as fn(f64, f64) -> f64, f64::min] {
        let Some(end) = forces_n.iter().copied().filter(|force_n| force_n.is_finite()).reduce(pick) else { continue };
        let at_end = forces_n.iter().filter(|force_n| force_n.to_bits() == end.to_bits()).count();
        if at_end >= FEWEST_AT_END.max(STILL_RATIO * usual) {
            ends.push(end);
        }
    }
    ends
}

fn merged(stretches: Vec<FaultyStretch>, interval_s: f64) -> Vec<FaultyStretch> {
    let mut merged: Vec<FaultyStretch> = Vec::new();
    for stretch in stretches {
        #[expect(clippy::cast_precision_loss, reason = "a count of cycles")]
        let is_near = |last: &FaultyStretch| {
            (stretch.cycles.start.saturating_sub(last.cycles.end)) as f64 * interval_s < MERGED_S
        };
        match merged.last_mut() {
            Some(last) if last.fault == stretch.fault && is_near(last) => last.cycles.end = stretch.cycles.end,
            _ => merged.push(stretch),
        }
    }
    merged
}

/// Returns the faults of these stretches, grouped by kind.
pub fn of_stretches(stretches: &[FaultyStretch], time_s: impl Fn(usize) -> f64) -> Vec<RecordingFault> {
    let of_kind = |fault: Fault| {
        let alike = stretches.iter().filter(|stretch| stretch.fault == fault);
        let intervals_s: Vec<[f64; 2]> =
            alike.map(|stretch| [time_s(stretch.cycles.start), time_s(stretch.cycles.end)]).collect();
        (!intervals_s.is_empty()).then(|| RecordingFault { fault, parameters: Vec::new(), intervals_s })
    };
    [Fault::Frozen, Fault::Clipped, Fault::Spikes].into_iter().filter_map(of_kind).collect()
}

/// Excludes such stretches, and the time after each, from the samples that count.
pub fn leave_out(stretches: &[FaultyStretch], interval_s: f64, standings: &mut [Standing]) {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let after = (AFTER_S / interval_s) as usize;
    for stretch in stretches {
        let end = (stretch.cycles.end + after).min(standings.len());
        if let Some(standings) = standings.get_mut(stretch.cycles.start..end) {
            standings.fill(Standing::Flagged);
        }
    }
}
