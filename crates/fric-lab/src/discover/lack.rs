//! Checks whether a log holds enough for a discovery. A cable with too little information gets a reason instead of a verdict.
//!
//! The checks read the record before anything is fitted, except for the warm-up, which depends on the friction.

use crate::fit::{CableRecord, Row, SampleCounts};

/// Minimum duration of samples that count, s. Half of it is held out and must contain some reversals.
const LEAST_S: f64 = 8.0;
/// Minimum range of the cable length, m. A cable with a smaller range does not move: it is as much as a winch needs to hold a force.
const LEAST_RANGE_M: f64 = 1e-4;
/// Minimum stroke that counts as a reversal, m. Over a shorter one the friction hardly reverses.
const STROKE_M: f64 = 1e-4;
/// Minimum number of strokes, not all in one direction, in the training samples and in the held-out samples. With fewer, friction cannot be
/// distinguished from an offset.
const FEWEST_STROKES: usize = 3;
/// Time over which speeds are computed, s. It is shorter than any stroke and long enough for the steps of an encoder.
const SPEED_OVER_S: f64 = 0.1;
/// The cable counts as moving above this fraction of its high speed.
const MOVES_RATIO: f64 = 0.05;
/// Below this ratio, high and low speed (90 % and 10 % quantiles) count as the same, and no effect of speed can show.
const ONE_SPEED_RATIO: f64 = 1.25;

/// The reason why a cable gets no verdict, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lack {
    /// One sentence without its full stop.
    pub cause: String,
    /// What to do, one sentence.
    pub advice: &'static str,
}

impl Lack {
    fn new(cause: impl Into<String>, advice: &'static str) -> Self {
        Self { cause: cause.into(), advice }
    }
}

const RUN: &str = "Record longer strokes at several speeds in both directions, best the run of `fric-cli excite`.";
const LONGER: &str = "Record a longer run, best that of `fric-cli excite`.";

/// Returns what a cable's record lacks.
pub fn lack_of(record: &CableRecord<'_>) -> Option<Lack> {
    let with_reference = record.references_n.iter().filter(|reference_n| reference_n.is_finite()).count();
    if with_reference == 0 {
        return Some(Lack::new(
            "the log has no reference force of it, or none that is a number",
            "Record the force of the cable at the platform beside its other signals.",
        ));
    }
    let counts = |(row, reference_n): &(&Row, &f64)| row.is_sound() && reference_n.is_finite();
    let sound = record.rows.iter().zip(record.references_n).filter(counts).count();
    if sound == 0 {
        return Some(Lack::new(
            "each sample is flagged, or has no tension on the cable",
            "See the flags with `fric-cli replay`.",
        ));
    }
    let motion = Motion::of(record);
    if motion.range_m < LEAST_RANGE_M {
        return Some(Lack::new(format!("it rests: its length changes by {:.3} mm in all", motion.range_m * 1e3), RUN));
    }
    if let Some(lack) = too_short(seconds(sound, record.interval_s)) {
        return Some(lack);
    }
    let [out, back] = motion.strokes;
    if out.min(back) == 0 || out + back < FEWEST_STROKES {
        let reverses = if out.min(back) == 0 { "never reverses" } else { "reverses only once" };
        return Some(Lack::new(
            format!("it {reverses}, so that friction cannot be told from an offset of the sensors"),
            RUN,
        ));
    }
    None
}

/// Whether a cable has only one speed while it moves, so that what depends on the speed is part of its friction.
pub fn has_one_speed(record: &CableRecord<'_>) -> bool {
    Motion::of(record).speed_ratio < ONE_SPEED_RATIO
}

/// Returns what is missing if this is the duration of the samples with a reference, s.
pub fn too_short(samples_s: f64) -> Option<Lack> {
    let cause = || format!("{:.1} s of samples with a reference are too few, {LEAST_S} s are needed", below(samples_s));
    (samples_s < LEAST_S).then(|| Lack::new(cause(), LONGER))
}

/// Returns what is missing once it is known which samples count.
pub fn lack_of_samples(counts: &SampleCounts, interval_s: f64) -> Option<Lack> {
    let SampleCounts { used, flagged, without_reference, interpolated, warm_up, outliers } = *counts;
    // A measurement of a reference that is slower than the cycle stands for the cycles around it.
    let used_s = seconds(used + interpolated, interval_s);
    if used_s >= LEAST_S {
        return None;
    }
    let warm_up_is_most = warm_up > flagged.max(without_reference).max(outliers);
    if warm_up_is_most && used == 0 {
        return Some(Lack::new("it moves too little to forget the friction stored in it when the log began", RUN));
    }
    if warm_up_is_most {
        let cause = format!(
            "{:.1} s of samples are too few, {LEAST_S} s are needed: before them, {:.1} s of motion pass until it has \
             forgotten the friction stored in it when the log began",
            below(used_s),
            seconds(warm_up, interval_s)
        );
        return Some(Lack::new(cause, LONGER));
    }
    let advice = if without_reference >= flagged {
        "Where a reference stands still, it measures nothing; a load that stays is `reference = { constant_n = … }` under `[log]`."
    } else {
        "See the flags with `fric-cli replay`."
    };
    let cause = format!("only {:.1} s of its samples can be used: {LEAST_S} s are needed", below(used_s));
    Some(Lack::new(cause, advice))
}

/// Rounds to a tenth, down where too few seconds would not look like it.
fn below(seconds: f64) -> f64 {
    let tenths = seconds * 10.0;
    if tenths.round() < LEAST_S * 10.0 { tenths.round() / 10.0 } else { tenths.floor() / 10.0 }
}

/// Returns the reason if the noise cannot be estimated.
pub fn lack_of_noise() -> Lack {
    Lack::new(
        "so many of its samples are missing or flagged that hardly five in a row can be used, which it takes to tell the noise",
        "See the gaps with `fric-cli info` and the flags with `fric-cli replay`.",
    )
}

fn seconds(samples: usize, interval_s: f64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let seconds = samples as f64 * interval_s;
    seconds
}

/// The motion of a cable.
#[derive(Clone, Copy, Debug)]
struct Motion {
    /// Greatest length minus least length, m.
    range_m: f64,
    /// Number of strokes in all logs: paying out, and reeling in.
    strokes: [usize; 2],
    /// High speed divided by low speed; 1 at a constant speed.
    speed_ratio: f64,
}

impl Motion {
    fn of(record: &CableRecord<'_>) -> Self {
        let mut motion = Self { range_m: 0.0, strokes: [0, 0], speed_ratio: 1.0 };
        let mut speeds = Vec::new();
        for (_, rows) in record.logs() {
            let mut turns = Turns::default();
            let (mut length_m, mut least_m, mut greatest_m) = (0.0_f64, 0.0_f64, 0.0_f64);
            for row in rows {
                length_m += row.signals.displacement_m;
                (least_m, greatest_m) = (least_m.min(length_m), greatest_m.max(length_m));
                if turns.at(length_m) {
                    motion.strokes[usize::from(turns.direction < 0.0)] += 1;
                }
            }
            motion.range_m = motion.range_m.max(greatest_m - least_m);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
            let stretch = ((SPEED_OVER_S / record.interval_s) as usize).max(1);
            speeds.extend(rows.chunks_exact(stretch).map(|rows| {
                let way_m: f64 = rows.iter().map(|row| row.signals.displacement_m).sum();
                way_m.abs() / seconds(stretch, record.interval_s)
            }));
        }
        speeds.sort_by(f64::total_cmp);
        let high = quantile(&speeds, 0.9);
        let first = speeds.partition_point(|speed| *speed <= MOVES_RATIO * high);
        let moving = speeds.get(first..).unwrap_or_default();
        let (low, high) = (quantile(moving, 0.1), quantile(moving, 0.9));
        if low > 0.0 {
            motion.speed_ratio = high / low;
        }
        motion
    }
}

/// Returns the quantile of sorted numbers; 0 if there are none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let place = share * sorted.len().saturating_sub(1) as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place")]
    sorted.get(place as usize).copied().unwrap_or(0.0)
}

/// Follows a length and reports where it starts to move or reverses.
#[derive(Clone, Copy, Debug, Default)]
struct Turns {
    extreme_m: f64,
    /// Direction of motion; 0 until it is known.
    direction: f64,
}

impl Turns {
    fn at(&mut self, length_m: f64) -> bool {
        let way_m = length_m - self.extreme_m;
        if self.direction * way_m > 0.0 {
            self.extreme_m = length_m;
        }
        if way_m.abs() < STROKE_M || self.direction * way_m > 0.0 {
            return false;
        }
        (self.extreme_m, self.direction) = (length_m, way_m.signum());
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strokes(lengths_m: impl IntoIterator<Item = f64>) -> usize {
        let mut turns = Turns::default();
        lengths_m.into_iter().filter(|length_m| turns.at(*length_m)).count()
    }

    #[test]
    fn a_stroke_is_one_that_friction_follows() {
        let ramp = |count: i32| (0..count).map(|k| f64::from(k) * 1e-4);
        assert_eq!(strokes(ramp(1000)), 1);
        assert_eq!(strokes(ramp(1000).map(|way_m| way_m + 5e-5 * (way_m * 3e4).sin())), 1);
        assert_eq!(strokes(ramp(1000).chain(ramp(1000).map(|way_m| 0.1 - way_m))), 2);
        assert_eq!(strokes((0..10_000).map(|k| 0.01 * (f64::from(k) * std::f64::consts::TAU / 2000.0).sin())), 11);
    }
}
