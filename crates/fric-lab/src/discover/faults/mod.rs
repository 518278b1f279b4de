//! What is wrong with a log itself and no matter of friction.
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

/// Samples in a row with the same force, to the last bit, from which on a sensor stands still.
const FEWEST_STILL: usize = 20;
/// And this many times the length of the runs that happen all the time, for sensors of few digits.
const STILL_RATIO: usize = 8;
/// Samples at the greatest or the least force of a log from which on it is the end of the sensor's range.
const FEWEST_AT_END: usize = 20;
/// A spike is so far off the medians of so many neighbours on either side, as a multiple of what half of the samples are; of white noise one in 10¹³ is.
/// And so many times as far as these medians are apart.
const SPIKE_RATIO: f64 = 12.0;
const SPIKE_NEIGHBOURS: usize = 4;
const AGREEMENT: f64 = 4.0;
/// And more than this share of the force: friction of 8 % that turns round for a cycle makes 16 % of it.
const FRICTION_RATIO: f64 = 0.25;
/// Values of a coarse converter: samples of each on the average, and how far from a multiple of the step one may be, by rounding.
const FEWEST_A_STEP: usize = 20;
const OFF_STEP: f64 = 1e-3;
/// What is left out after a stretch, s: the friction in the model has to find back.
const AFTER_S: f64 = 0.1;
/// Two stretches with less than this between them are one, s.
const MERGED_S: f64 = 0.1;

/// What is the matter with a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A line in the spectrum that goes with nothing the cable does.
    Hum,
    /// A damped oscillation of one frequency, as of a sensor on a mount that gives way.
    Vibration,
    /// The length trembles, and the model takes it for motion.
    NoisyLength,
    /// The force sensor repeats itself.
    Frozen,
    /// The force sensor is at the end of its range.
    Clipped,
    /// The force sensor shows single values that are far from those before and after.
    Spikes,
    /// The converter behind the force sensor has coarse steps.
    CoarseConverter,
    /// The reference comes late.
    ReferenceDelay,
    /// The clock of the reference runs otherwise than that of the winch.
    ClockSkew,
}

/// A fault of a recording: it says something about the log, not about the machine.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingFault {
    /// Which.
    pub fault: Fault,
    /// What is known of it, by key with its unit.
    pub parameters: Vec<(&'static str, f64)>,
    /// When, s since the first sample; empty where it is there all the time.
    pub intervals_s: Vec<[f64; 2]>,
}

/// Cycles in which the sensor is not to be believed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultyStretch {
    /// Why not.
    pub fault: Fault,
    /// When.
    pub cycles: Range<usize>,
}

/// Stretches of a cable's log with a faulty sensor, in the order of time.
pub fn faulty_stretches(record: &CableRecord<'_>) -> Vec<FaultyStretch> {
    // Where the sensor shows no number, that of the last good sample stands for it: such samples are flagged already.
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
    // A steady force stays within a coarse step: nothing tells such a sensor from one that stands still.
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

/// Places at which a signal is far from its neighbours on both sides, which agree, as no noise is: it jumps there and back. Where most values are those of the neighbours,
/// nothing tells the noise.
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

/// The step of the values that a sensor shows, N, where all of them are whole multiples of one apart, and each is there many times.
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

/// Length of the runs that half of the samples are in.
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

/// The greatest and the least force, where the sensor stays at it as no signal with noise would.
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

/// The faults that such stretches are, by kind.
pub fn of_stretches(stretches: &[FaultyStretch], time_s: impl Fn(usize) -> f64) -> Vec<RecordingFault> {
    let of_kind = |fault: Fault| {
        let alike = stretches.iter().filter(|stretch| stretch.fault == fault);
        let intervals_s: Vec<[f64; 2]> =
            alike.map(|stretch| [time_s(stretch.cycles.start), time_s(stretch.cycles.end)]).collect();
        (!intervals_s.is_empty()).then(|| RecordingFault { fault, parameters: Vec::new(), intervals_s })
    };
    [Fault::Frozen, Fault::Clipped, Fault::Spikes].into_iter().filter_map(of_kind).collect()
}

/// Leaves such stretches, and the moment after each, out of what counts.
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
