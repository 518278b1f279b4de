//! Faults of the recording itself, which have nothing to do with friction.
//!
//! Each such fault has a name, values and a place in time, and is corrected before model and log are compared: stretches in which a sensor stands still or is at the
//! end of its range, or where it spikes, are left out, hum (`lines`) and vibrations (`vibration`) come off the reference, the noise of the length (`length_noise`) is kept from being motion, and a reference
//! that comes late or early goes where it belongs (`timing`). The steps of a coarse converter are noise, and told.

pub mod correction;
pub mod length_noise;
pub mod lines;
mod of_length;
pub mod oscillations;
pub mod passes;
mod shifted;
pub mod spectrum;
mod time_fit;
pub mod timing;
pub mod vibration;

use std::ops::Range;

use crate::fit::CableRecord;
use crate::recording_fault::{Fault, RecordingFault};
use crate::samples::selection::{Standing, cycles_to_forget};
use crate::samples::steps::CoarseSteps;
use crate::samples::still::{runs, stands_still};

/// Minimum number of samples at the greatest or least force of a log for this force to be the end of the sensor's range, and in usual runs.
const FEWEST_AT_END: usize = 20;
const END_RATIO: usize = 8;
/// A spike differs from the medians of its neighbours on either side by more than this multiple of the median deviation; in white noise one sample in
/// 10¹³ does. It also differs by more than this multiple of the difference between these two medians.
const SPIKE_RATIO: f64 = 12.0;
const SPIKE_NEIGHBOURS: usize = 4;
const AGREEMENT: f64 = 4.0;
/// A sample that a fit leaves out is a spike of the sensor if its force is off by more than this multiple, four standard deviations. Half of it would
/// take an outlier of the reference in one of 22 samples for one of the sensor; twice as much misses spikes of eight times the noise.
const OUTLIER_RATIO: f64 = 6.0;
/// A spike that no fit has seen also exceeds this fraction of the force. Friction of 8 % that reverses for one cycle makes 16 %.
const FRICTION_RATIO: f64 = 0.25;
/// Where the speed of the cable changes by more than in this fraction of the samples, and by more than this multiple of the median, the force of a mass may
/// be one sample long too, at 10 Hz that of a drum. One spike in fifty may fall there.
const QUICK_QUANTILE: f64 = 0.98;
const QUICK_RATIO: f64 = 4.0;
/// Least time that is left out after a faulty stretch, s.
const AFTER_S: f64 = 0.1;
/// Two stretches closer than this are merged, s.
const MERGED_S: f64 = 0.1;

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
    let shown = record.shown_forces_n();
    let has_value = |run: &Range<usize>| shown.get(run.start).is_some_and(|force_n| force_n.is_finite());
    let runs: Vec<Range<usize>> = runs(&shown).filter(has_value).collect();
    let usual = usual_length(&runs, runs.iter().map(Range::len).sum());
    let mut stretches = Vec::new();
    let coarse = CoarseSteps::of(&shown);
    // Where the force turns, a coarse sensor shows its last value as often as any other.
    let ends = ends_of_range(&shown, coarse.map_or(usual, |coarse| coarse.samples_a_value));
    let is_end = |force_n: f64| ends.iter().any(|end| end.to_bits() == force_n.to_bits());
    for run in runs {
        let Some(force_n) = shown.get(run.start) else { continue };
        if is_end(*force_n) {
            stretches.push(FaultyStretch { fault: Fault::Clipped, cycles: run });
        } else if coarse.is_none() && stands_still(&shown, &run) {
            // A steady force stays within one coarse step, so such a sensor cannot be distinguished from a frozen one.
            stretches.push(FaultyStretch { fault: Fault::Frozen, cycles: run });
        }
    }
    let quick = quick_changes(record);
    let spikes = spikes(&shown).filter(|spike| !quick(spike.start));
    stretches.extend(spikes.map(|cycles| FaultyStretch { fault: Fault::Spikes, cycles }));
    stretches.sort_by_key(|stretch| (stretch.cycles.start, stretch.cycles.end));
    merged(stretches, record.interval_s)
}

/// Returns the spikes among the samples that a fit leaves out because each is off by itself: those in which the sensor's force is off by itself too, more
/// than the reference. They may be far smaller than the friction, which the model knows.
pub fn spikes_among(record: &CableRecord<'_>, standings: &[Standing]) -> Vec<FaultyStretch> {
    if !standings.contains(&Standing::Outlier) {
        return Vec::new();
    }
    let quick = quick_changes(record);
    let (of_sensor, usual_n) = jumps(&record.shown_forces_n());
    let (of_reference, usual_reference_n) = jumps(record.references_n);
    let is_outlier = |place: usize| standings.get(place) == Some(&Standing::Outlier);
    let is_spike = |(place, (sensor, reference)): &(usize, (&Jump, &Jump))| {
        let [sensor_ratio, reference_ratio] = [sensor.off_n / usual_n, reference.off_n / usual_reference_n];
        // A spike of the reference may stand where friction turns.
        let is_of_sensor = sensor.is_alone && (reference_ratio.is_nan() || reference_ratio <= sensor_ratio);
        is_outlier(*place) && is_of_sensor && sensor_ratio > OUTLIER_RATIO && !quick(*place)
    };
    let alone = of_sensor.iter().zip(&of_reference).enumerate().filter(is_spike);
    alone.map(|(place, _)| FaultyStretch { fault: Fault::Spikes, cycles: place..place + 1 }).collect()
}

/// Returns whether the speed of the cable changes at a sample as it hardly does elsewhere.
fn quick_changes<'a>(record: &CableRecord<'a>) -> impl Fn(usize) -> bool + use<'a> {
    let rows = record.rows;
    let change = move |place: usize| {
        let speed_m_per_s = |place: usize| rows.get(place).map(|row| row.signals.speed_m_per_s);
        let change = speed_m_per_s(place + 1)? - speed_m_per_s(place.checked_sub(1)?)?;
        Some(change.abs()).filter(|change| change.is_finite())
    };
    let mut changes: Vec<f64> = (0..rows.len()).filter_map(change).collect();
    let mut quantile = |ratio: f64| {
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a place"
        )]
        let place = (ratio * changes.len() as f64) as usize;
        if changes.is_empty() { f64::INFINITY } else { *changes.select_nth_unstable_by(place, f64::total_cmp).1 }
    };
    let least = quantile(QUICK_QUANTILE).max(QUICK_RATIO * quantile(0.5));
    move |place| change(place).is_some_and(|change| change > least)
}

/// Returns the places at which a signal jumps away and back: it is far from its neighbours on both sides, and the neighbours agree. Noise does not do
/// this. Where most values equal their neighbours, the noise cannot be estimated.
fn spikes(shown: &[f64]) -> impl Iterator<Item = Range<usize>> {
    let (jumps, usual_n) = jumps(shown);
    let least_n = if usual_n > 0.0 { SPIKE_RATIO * usual_n } else { f64::INFINITY };
    let is_spike = move |(_, jump): &(usize, Jump)| jump.is_alone && jump.off_n > least_n.max(jump.most_friction_n);
    jumps.into_iter().enumerate().filter(is_spike).map(|(place, _)| place..place + 1)
}

/// A value of a signal beside its neighbours.
#[derive(Clone, Copy, Debug)]
struct Jump {
    /// Distance from the medians of the neighbours on either side, N; NaN if some are missing.
    off_n: f64,
    /// Whether the neighbours agree and the value leaves and comes back at once.
    is_alone: bool,
    /// What friction may do in a cycle, N.
    most_friction_n: f64,
}

/// Returns each value of a signal beside its neighbours, and the usual distance from them, N.
fn jumps(shown: &[f64]) -> (Vec<Jump>, f64) {
    let middle = |values: &[f64]| {
        let mut values: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        let place = values.len() / 2;
        (!values.is_empty()).then(|| *values.select_nth_unstable_by(place, f64::total_cmp).1)
    };
    let change = |place: usize| (shown[place + 1] - shown[place]).abs();
    let jump = |place: usize| {
        let around = place.checked_sub(SPIKE_NEIGHBOURS)?..place + SPIKE_NEIGHBOURS + 1;
        let (before, rest) = shown.get(around)?.split_at(SPIKE_NEIGHBOURS);
        let (value, after) = rest.split_first()?;
        let (before, after) = (middle(before)?, middle(after)?);
        let off_n = (value - f64::midpoint(before, after)).abs();
        let [rise, fall] = [place - 2, place].map(|place| change(place).max(change(place + 1)));
        let is_alone = off_n > AGREEMENT * (before - after).abs() && rise.min(fall) > 0.5 * off_n;
        Some(Jump { off_n, is_alone, most_friction_n: FRICTION_RATIO * f64::midpoint(before, after).abs() })
    };
    let none = Jump { off_n: f64::NAN, is_alone: false, most_friction_n: f64::NAN };
    let jumps: Vec<Jump> = (0..shown.len()).map(|place| jump(place).unwrap_or(none)).collect();
    let usual_n = middle(&jumps.iter().map(|jump| jump.off_n).collect::<Vec<f64>>()).unwrap_or(0.0);
    (jumps, usual_n)
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
        if at_end >= FEWEST_AT_END.max(END_RATIO * usual) {
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

/// Excludes such stretches, and what follows each in its log, from the samples that count. While the force stood still or was cut off, the model computed
/// friction for the wrong load, which lasts until the cable has moved.
pub fn leave_out(record: &CableRecord<'_>, stretches: &[FaultyStretch], standings: &mut [Standing]) {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
    let least = (AFTER_S / record.interval_s) as usize;
    for stretch in stretches {
        let mut logs = record.logs();
        let Some((start, rows)) = logs.find(|(start, rows)| stretch.cycles.start < start + rows.len()) else {
            continue;
        };
        let rest = rows.get(stretch.cycles.end.saturating_sub(start)..).unwrap_or_default();
        let lasts = stretch.fault != Fault::Spikes;
        let after = if lasts { least.max(cycles_to_forget(record.params, rest)) } else { least };
        let end = stretch.cycles.end + after.min(rest.len());
        if let Some(standings) = standings.get_mut(stretch.cycles.start..end) {
            standings.fill(Standing::Flagged);
        }
    }
}

#[cfg(test)]
mod tests {
    use fric_core::robot::file::RobotFile;
    use fric_core::{CableInput, Sample};
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::fit::{Measurements, Reference};

    /// A force of 10 ± 3 N with 0.01 N of noise, written with steps of `step_n`; each value is shown `times` times.
    fn shown_n(step_n: f64, times: usize) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let noise = std::iter::repeat_with(|| -> f64 { StandardNormal.sample(&mut random) });
        let force_n = |(place, noise): (i32, f64)| 10.0 + 3.0 * (0.002 * f64::from(place)).sin() + 0.01 * noise;
        let stepped_n = (0..4000).zip(noise).map(force_n).map(|force_n| (force_n / step_n).round() * step_n);
        stepped_n.flat_map(|force_n| std::iter::repeat_n(force_n, times)).collect()
    }

    /// A drum that starts within a sample, as at 10 Hz, moves its own mass: that is no spike of the sensor, and a force that jumps elsewhere is.
    #[test]
    fn the_force_of_an_acceleration_is_no_spike() {
        let robot = RobotFile::parse(
            "format = \"fric-robot/1\"\nname = \"drum\"\ncycle_s = 0.1\n[[cable]]\nname = \"w\"\npulleys = [{ wrap_deg = 180.0 }]\n\
             friction = { mu = 0.02 }\n",
            "drum",
        )
        .unwrap();
        let params = robot.params();
        let mut measurements = Measurements::new(&params, Reference::Forces);
        measurements.start_log();
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut length_m = 0.0;
        for cycle in 0_i32..600 {
            let noise: f64 = StandardNormal.sample(&mut random);
            // The speed changes between two cycles, and the force of the drum's mass is that of the change around it.
            let speed_m_per_s = if cycle < 300 { 0.0 } else { 2.0 };
            length_m += 0.1 * speed_m_per_s;
            let jump_n = if [100, 300, 500].contains(&cycle) { 800.0 } else { 0.0 };
            measurements.add(&Sample {
                stamp_nanos: i64::from(cycle) * 100_000_000,
                cables: &[CableInput { sensor_force_n: 1000.0 + 5.0 * noise + jump_n, length_m, speed_m_per_s }],
                reference_force_n: &[1000.0],
                pose: None,
                outside_wrench: None,
            });
        }
        let record = measurements.cable(0).unwrap();
        let spikes: Vec<usize> = faulty_stretches(&record).iter().map(|stretch| stretch.cycles.start).collect();
        assert_eq!(spikes, [100, 500]);
    }

    #[test]
    fn where_a_coarse_force_turns_its_range_does_not_end() {
        let coarse_n = shown_n(0.04, 1);
        let a_value = CoarseSteps::of(&coarse_n).unwrap().samples_a_value;
        // As in a fine sensor, the last value would be the end of the range.
        assert!(!ends_of_range(&coarse_n, 4).is_empty());
        assert_eq!(ends_of_range(&coarse_n, a_value), Vec::<f64>::new());
        let clipped_n: Vec<f64> = coarse_n.iter().map(|force_n| force_n.min(12.0)).collect();
        assert_eq!(ends_of_range(&clipped_n, a_value), [12.0]);
    }
}
