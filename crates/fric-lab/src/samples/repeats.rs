//! Signals that show each value several times: those of a device that is slower than the log, and those with coarse steps.
//!
//! Whoever logs a slow device with a fast loop writes its last value until the next one comes. Only the first of them is a measurement.

use std::ops::Range;

use fric_core::Wrench;
use fric_core::signals::SignalLimits;
use nalgebra::Vector3;

use super::cable::CableRecord;
use super::record::{Measurements, Row};

/// Minimum fraction of the changes that follow the one before after nearly the same number of samples, for a held signal. A value that repeats by chance does
/// so in 47 % at most; a held one that jitters by a sample does in all. Half of the distance to either gives the same for the logs of the tests.
const LEAST_REGULAR: f64 = 0.8;
/// Numbers of samples that count as nearly the same: a device that is not in step with the log is held for one sample more or less.
const ALIKE_COUNT: usize = 3;
/// Minimum rate of a held signal, Hz, as of an interpolated one. Slower changes are those of the signal: weights that are put on by hand.
const LEAST_RATE_HZ: f64 = 10.0;
/// One in so many changes is smaller than the steps of a signal without coarse ones. Of noise they are a tenth of the median, of a wave a ninth.
const FEW_IN: usize = 20;
/// Minimum number of changes that tell of a device.
const FEWEST_CHANGES: usize = 50;
/// The maximum distance of a value from a multiple of a coarse converter's step, which allows for rounding.
const OFF_STEP: f64 = 1e-3;
/// Minimum fraction of the values that a coarse converter shows twice or more in a row. A step as great as the noise gives 0.28; it adds a twelfth to
/// the variance of the noise. Half and twice this fraction find the same in 199 logs, of which the eight with such a converter have 0.4 and more, all others 0.0001.
const LEAST_REPEATED: f64 = 0.25;
/// Maximum of the usual change from one value to another, in steps. More is a signal that is shown several times, with as many digits as it was
/// written; noise is then tens of the last digit. Half and twice as many find the same in those logs.
const MOST_STEPS: f64 = 2.0;

/// The steps of a coarse converter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoarseSteps {
    /// The step, in the unit of the signal.
    pub step: f64,
    /// Average number of samples that show the same value.
    pub samples_a_value: usize,
}

impl CoarseSteps {
    /// Returns the steps of a signal, NaN where it shows nothing; `None` if they are not coarse: the values are not multiples of one step apart, or
    /// change in nearly every sample, or usually by many steps.
    pub fn of(shown: &[f64]) -> Option<Self> {
        let finite: Vec<f64> = shown.iter().copied().filter(|value| value.is_finite()).collect();
        let (mut runs, mut repeated, mut changes) = (0.0, 0.0, Vec::new());
        let mut last = None;
        for run in finite.chunk_by(|one, next| one.to_bits() == next.to_bits()) {
            runs += 1.0;
            repeated += if run.len() > 1 { 1.0 } else { 0.0 };
            changes.extend(last.map(|last: f64| (run[0] - last).abs()));
            last = Some(run[0]);
        }
        if changes.is_empty() || repeated < LEAST_REPEATED * runs {
            return None;
        }
        let mut values = finite.clone();
        values.sort_by(f64::total_cmp);
        values.dedup();
        let gaps = || values.windows(2).map(|pair| pair[1] - pair[0]);
        let step = gaps().fold(f64::INFINITY, f64::min);
        let middle = changes.len() / 2;
        let usual = *changes.select_nth_unstable_by(middle, f64::total_cmp).1;
        let is_multiple = |gap: f64| (gap / step - (gap / step).round()).abs() < OFF_STEP;
        (usual < (MOST_STEPS + 0.5) * step && gaps().all(is_multiple))
            .then(|| Self { step, samples_a_value: finite.len() / values.len() })
    }
}

/// Maximum number of runs of bit-identical values in a log that are as long by chance, if values repeat independently. Half and twice as many change the
/// least number of samples by one at most.
const BY_CHANCE: f64 = 1e-3;
/// Number of samples on either side that tell how often a value repeats: more than are needed to tell one in ten from one in a hundred.
const SAMPLES_BESIDE: usize = 50;

/// Whether so long a run of identical values is not by chance, given how often the values repeat on the side of it where they do so more often. The longest
/// run on a side does not count, which may be another of the kind; nor do missing values, NaN.
pub fn stands_still(shown: &[f64], run: &Range<usize>) -> bool {
    let before = shown.get(..run.start).unwrap_or_default().iter().rev();
    let after = shown.get(run.end..).unwrap_or_default().iter();
    let probability = repeat_probability(before).max(repeat_probability(after));
    #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
    let (samples, repeats) = (shown.len() as f64, run.len() as f64 - 1.0);
    samples * probability.powf(repeats) < BY_CHANCE
}

/// Returns the probability that a value repeats, from the next ones without their longest run.
fn repeat_probability<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let nearest: Vec<f64> = values.copied().filter(|value| value.is_finite()).take(SAMPLES_BESIDE).collect();
    let lengths: Vec<usize> = runs(&nearest).map(|run| run.len()).collect();
    let longest = lengths.iter().max().copied().unwrap_or(0);
    let repeats = nearest.len() - lengths.len() - longest.saturating_sub(1);
    #[expect(clippy::cast_precision_loss, reason = "small counts")]
    let (repeats, pairs) = (repeats as f64, (nearest.len() - longest) as f64);
    // The mean of a probability of which nothing else is known.
    (repeats + 1.0) / (pairs + 2.0)
}

/// Returns the runs of bit-identical values.
pub fn runs(shown: &[f64]) -> impl Iterator<Item = Range<usize>> {
    shown.chunk_by(|one, next| one.to_bits() == next.to_bits()).scan(0, |start, run| {
        *start += run.len();
        Some(*start - run.len()..*start)
    })
}

/// Where a signal shows the measurement before once more, because it is held between two measurements.
struct Held {
    again: Vec<bool>,
    /// Usual number of samples that show a measurement, and the greatest one between two measurements of which none is missing.
    times: usize,
    most_times: usize,
}

impl Held {
    /// Returns where a signal is held; `None` if it is measured throughout.
    fn of_signal(record: &CableRecord<'_>, shown: &[f64]) -> Option<Self> {
        let is_same = |place: usize| {
            let now = shown.get(place).filter(|value| value.is_finite())?;
            let before = shown.get(place.wrapping_sub(1));
            Some(before.is_some_and(|before| before.to_bits() == now.to_bits()))
        };
        Self::of(record, is_same).filter(|_| changes_vary(shown))
    }

    /// Returns where the reference of a cable is held. A known one is not measured.
    fn of_reference(record: &CableRecord<'_>) -> Option<Self> {
        if record.reference_is_known { None } else { Self::of_signal(record, record.references_n) }
    }

    /// Returns where the length of a cable is held: the cable would stand still and jump.
    fn of_length(record: &CableRecord<'_>) -> Option<Self> {
        Self::of_signal(record, &lengths_m(record))
    }

    /// Returns where the logs repeat a sample of which `is_same` says whether it is like the one before, if any of them is held. It says nothing where the
    /// sample is missing.
    fn of(record: &CableRecord<'_>, is_same: impl Fn(usize) -> Option<bool>) -> Option<Self> {
        let mut hold = None;
        let of_log = |(start, rows): (usize, &[Row])| {
            let mut again: Vec<Option<bool>> = (start..start + rows.len()).map(&is_same).collect();
            if let Some(first) = again.first_mut() {
                *first = first.map(|_| false);
            }
            let of_log = regular_hold(&again, record.interval_s);
            hold = hold.max(of_log);
            again.into_iter().map(move |again| of_log.is_some() && again == Some(true))
        };
        let again = record.logs().flat_map(of_log).collect();
        let (times, most_times) = hold?;
        Some(Self { again, times, most_times })
    }

    /// Returns a signal with lines between its measurements, and NaN where some are missing.
    fn with_lines(&self, record: &CableRecord<'_>, shown: &[f64]) -> Vec<f64> {
        let mut lines = shown.to_vec();
        self.visit_holds(record, |hold, next| {
            let is_missing = next.is_none() || hold.len() > self.most_times;
            let from = hold.start;
            let slope =
                next.map_or(f64::NAN, |next| (shown[next] - shown[from]) / (record.time_s(next) - record.time_s(from)));
            for (place, line) in lines.iter_mut().enumerate().take(hold.end).skip(from + 1) {
                let on_line = shown[from] + slope * (record.time_s(place) - record.time_s(from));
                *line = if is_missing { f64::NAN } else { on_line };
            }
        });
        lines
    }

    /// Visits each measurement with the samples that repeat it, and the next measurement of the same log.
    fn visit_holds(&self, record: &CableRecord<'_>, mut visit: impl FnMut(Range<usize>, Option<usize>)) {
        for (start, rows) in record.logs() {
            let of_log = self.again.get(start..start + rows.len()).unwrap_or_default();
            let mut from = start;
            for hold in of_log.chunk_by(|_, next| *next) {
                let to = from + hold.len();
                if hold.len() > 1 {
                    visit(from..to, Some(to).filter(|next| *next < start + rows.len()));
                }
                from = to;
            }
        }
    }
}

/// Returns the usual number of samples that a log with this time between them, s, shows a measurement, and the greatest one that counts as nearly the
/// same; `None` unless nearly all are alike.
fn regular_hold(again: &[Option<bool>], interval_s: f64) -> Option<(usize, usize)> {
    let (mut lengths, mut present) = (Vec::new(), None);
    for again in again {
        match again {
            None => present = None,
            Some(false) => lengths.extend(present.replace(1)),
            Some(true) => present = present.map(|length: usize| length + 1),
        }
    }
    lengths.sort_unstable();
    let up_to = |length: usize| lengths.partition_point(|other| *other <= length);
    #[expect(clippy::cast_precision_loss, reason = "counts")]
    let is_usual = |shortest: &usize| {
        let alike = up_to(shortest + ALIKE_COUNT - 1) - up_to(shortest - 1);
        alike as f64 >= LEAST_REGULAR * lengths.len() as f64 && *shortest as f64 * interval_s * LEAST_RATE_HZ <= 1.0
    };
    let middle = *lengths.get(lengths.len() / 2)?;
    let shortest = (middle.saturating_sub(ALIKE_COUNT - 1).max(2)..=middle).find(is_usual)?;
    (lengths.len() >= FEWEST_CHANGES).then_some((middle, shortest + ALIKE_COUNT - 1))
}

/// Whether a signal usually changes by more than one step. Steps of a coarse sensor or encoder are all alike, and in a steady motion come regularly too.
fn changes_vary(shown: &[f64]) -> bool {
    let changes = shown.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut changes: Vec<f64> = changes.filter(|change| *change > 0.0 && change.is_finite()).collect();
    changes.sort_unstable_by(f64::total_cmp);
    let quantile = |of: usize| changes.get(changes.len() / of).copied().unwrap_or(0.0);
    quantile(2) > (MOST_STEPS + 0.5) * quantile(FEW_IN)
}

/// Returns where the sensor of a cable shows its last measurement once more; `None` if it measures in every cycle.
pub fn repeated_forces(record: &CableRecord<'_>) -> Option<Vec<bool>> {
    Some(Held::of_signal(record, &record.shown_forces_n())?.again)
}

fn lengths_m(record: &CableRecord<'_>) -> Vec<f64> {
    let length_m = |row: &Row| if row.signals.motion_finite { row.signals.length_m } else { f64::NAN };
    record.rows.iter().map(length_m).collect()
}

/// Returns the rows of a cable with lines between the lengths that were measured. A cable that rests does so until one hold before it has moved. The speed
/// of a held length is the mean over one measurement before and after; that of the steps would lag.
fn rows_with_lines(record: &CableRecord<'_>, limits: &SignalLimits) -> Option<Vec<Row>> {
    let held = Held::of_length(record)?;
    let mut rows = record.rows.to_vec();
    held.visit_holds(record, |hold, next| {
        let Some(next) = next else { return };
        let from = hold.start.max(next.saturating_sub(held.most_times));
        let (start_m, end_m) = (record.rows[from].signals.length_m, record.rows[next].signals.length_m);
        let slope = (end_m - start_m) / (record.time_s(next) - record.time_s(from));
        if slope.is_finite() {
            for (place, row) in rows.iter_mut().enumerate().take(next).skip(from + 1) {
                row.signals.length_m = start_m + slope * (record.time_s(place) - record.time_s(from));
            }
        }
    });
    let lengths_m: Vec<f64> = rows.iter().map(|row| row.signals.length_m).collect();
    for (start, log) in record.logs() {
        let end = start + log.len();
        if !held.again.get(start..end).is_some_and(|again| again.contains(&true)) {
            continue;
        }
        for (place, row) in rows.iter_mut().enumerate().take(end).skip(start) {
            let (before, after) = (place.saturating_sub(held.times).max(start), (place + held.times).min(end - 1));
            let speed = (lengths_m[after] - lengths_m[before]) / (record.time_s(after) - record.time_s(before));
            if speed.is_finite() {
                row.signals.speed_m_per_s = speed;
            }
        }
    }
    Some(CableRecord { rows: &rows, ..*record }.conditioned(limits))
}

impl Measurements<'_> {
    /// Returns the same measurements with lines in place of what references, wrenches and lengths only repeat, as between the messages of a slow topic;
    /// `None` if they repeat nothing.
    pub(crate) fn without_repeats(&self) -> Option<Self> {
        let lines =
            |record: CableRecord<'_>| Some(Held::of_reference(&record)?.with_lines(&record, record.references_n));
        let references_n: Vec<Option<Vec<f64>>> = self.cables().map(lines).collect();
        let limits = self.robot().monitor().limits();
        let rows: Vec<Option<Vec<Row>>> = self.cables().map(|record| rows_with_lines(&record, &limits)).collect();
        let wrenches = self.wrenches_with_lines();
        if references_n.iter().all(Option::is_none) && rows.iter().all(Option::is_none) && wrenches.is_none() {
            return None;
        }
        let changed = self.with_references(references_n).with_rows(rows);
        Some(match wrenches {
            Some(wrenches) => changed.with_wrenches(wrenches),
            None => changed,
        })
    }

    /// Returns a sentence for each kind of signal that is held, without its full stop. `names` are those of all cables.
    pub(crate) fn repeats_told(&self, names: &[&str]) -> Vec<String> {
        let of = |signal: &'static str, held: Option<Held>, name: &str| {
            held.map(|held| (signal, held.times, name.to_owned()))
        };
        let of_cable = |(name, record): (&&str, CableRecord<'_>)| {
            let force = Held::of_signal(&record, &record.shown_forces_n());
            let reference = Held::of_reference(&record);
            [
                of("force sensor", force, name),
                of("reference", reference, name),
                of("length", Held::of_length(&record), name),
            ]
        };
        let names = names.get(self.held()).unwrap_or_default();
        let cables = names.iter().zip(self.cables()).flat_map(of_cable).flatten();
        let wrench = of("wrench", self.held_wrenches(), "the platform");
        let mut told: Vec<(&str, usize, Vec<String>)> = Vec::new();
        for (signal, times, name) in cables.chain(wrench) {
            match told.iter_mut().find(|(other, as_often, _)| *other == signal && *as_often == times) {
                Some((.., names)) => names.push(name),
                None => told.push((signal, times, vec![name])),
            }
        }
        let sentence = |(signal, times, names): (&str, usize, Vec<String>)| {
            let names = names.join(", ");
            format!(
                "{names}: the {signal} is slower than the log, which shows each value {times} times; only the first counts"
            )
        };
        told.into_iter().map(sentence).collect()
    }

    fn held_wrenches(&self) -> Option<Held> {
        let wrenches = &self.platform().wrenches;
        let is_same = |place: usize| {
            let now = wrenches.get(place)?.as_ref()?;
            Some(wrenches.get(place.wrapping_sub(1)).is_some_and(|before| before.as_ref() == Some(now)))
        };
        Held::of(&self.cables().next()?, is_same)
    }

    fn wrenches_with_lines(&self) -> Option<Vec<Option<Wrench>>> {
        let record = self.cables().next()?;
        let (wrenches, held) = (&self.platform().wrenches, self.held_wrenches()?);
        let component = |component: usize| {
            let of = |wrench: &Option<Wrench>| wrench.map_or(f64::NAN, |wrench| wrench.to_vector()[component]);
            held.with_lines(&record, &wrenches.iter().map(of).collect::<Vec<f64>>())
        };
        let lines: [Vec<f64>; 6] = std::array::from_fn(component);
        let wrench = |place: usize| {
            let [x, y, z, tx, ty, tz] = lines.each_ref().map(|line| line[place]);
            let (force_n, torque_nm) = (Vector3::new(x, y, z), Vector3::new(tx, ty, tz));
            (force_n + torque_nm).iter().all(|value| value.is_finite()).then_some(Wrench { force_n, torque_nm })
        };
        Some((0..wrenches.len()).map(wrench).collect())
    }
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// A force of 10 ± 3 N with 0.01 N of noise, written with steps of `step_n`; `repeats` tells how often each value is shown.
    fn shown_n(step_n: f64, repeats: impl Fn(usize) -> usize) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let noise = std::iter::repeat_with(|| -> f64 { StandardNormal.sample(&mut random) });
        let force_n = |(place, noise): (i32, f64)| 10.0 + 3.0 * (0.002 * f64::from(place)).sin() + 0.01 * noise;
        let stepped_n = (0..4000).zip(noise).map(force_n).map(|force_n| (force_n / step_n).round() * step_n);
        stepped_n.enumerate().flat_map(|(place, force_n)| std::iter::repeat_n(force_n, repeats(place))).collect()
    }

    fn is_held(shown_n: &[f64]) -> bool {
        let is_same = |place: usize| place > 0 && shown_n[place - 1].to_bits() == shown_n[place].to_bits();
        let again = |place: usize| shown_n[place].is_finite().then(|| is_same(place));
        let again: Vec<Option<bool>> = (0..shown_n.len()).map(again).collect();
        regular_hold(&again, 1e-3).is_some() && changes_vary(shown_n)
    }

    #[test]
    fn steps_are_coarse_beside_the_noise() {
        let step = |shown_n: &[f64]| CoarseSteps::of(shown_n).map(|coarse| coarse.step);
        // Some 150 values, 27 samples each; 600 values, 7 samples each.
        for coarse_n in [0.04, 0.01] {
            assert!(step(&shown_n(coarse_n, |_| 1)).is_some_and(|found_n| (found_n / coarse_n - 1.0).abs() < 1e-6));
        }
        // Digits below the noise, also where every value is shown ten times.
        assert_eq!([1e-3, 1e-5].map(|written_n| step(&shown_n(written_n, |_| 1))), [None; 2]);
        assert_eq!(step(&shown_n(1e-5, |_| 10)), None);
        // A sensor that is frozen half of the time.
        let mut frozen_n = shown_n(1e-5, |_| 1);
        frozen_n[1000..3000].fill(10.0);
        assert_eq!(step(&frozen_n), None);
    }

    /// A sensor that hangs stands still before it is missing, and often more than once.
    #[test]
    fn a_sensor_stands_still_beside_gaps_and_other_stretches() {
        let mut force_n = shown_n(1e-5, |_| 1);
        for start in [500, 550, 2000] {
            let shown_n = force_n[start];
            force_n[start..start + 20].fill(shown_n);
        }
        force_n[2020..2080].fill(f64::NAN);
        let still = runs(&force_n).filter(|run| force_n[run.start].is_finite() && stands_still(&force_n, run));
        assert_eq!(still.collect::<Vec<_>>(), [500..520, 550..570, 2000..2020]);
        // Digits as coarse as the noise repeat a value in a third of the cases.
        let coarse_n = shown_n(0.02, |_| 1);
        assert!(!runs(&coarse_n).any(|run| run.len() < 8 && stands_still(&coarse_n, &run)));
    }

    #[test]
    fn a_held_signal_may_have_gaps() {
        let mut force_n = shown_n(1e-5, |_| 4);
        for start in (100..16_000).step_by(500) {
            force_n[start..start + 150].fill(f64::NAN);
        }
        assert!(is_held(&force_n));
    }

    #[test]
    fn a_value_that_is_shown_equally_often_is_held() {
        for written_n in [1e-3, 1e-5] {
            for times in [2, 3, 5, 10, 40] {
                assert!(is_held(&shown_n(written_n, |_| times)), "{written_n} N, {times}");
            }
            // 400 Hz in a log of 1 kHz, and a device that is a sample early or late.
            assert!(is_held(&shown_n(written_n, |place| 2 + place % 2)));
            assert!(is_held(&shown_n(written_n, |place| 7 + [0, 1, 2, 1][place % 4])));
        }
        // Coarse steps repeat by chance, a weight that is changed every 200 ms is that of the signal, and this one is measured throughout.
        for coarse_n in [0.1, 0.04, 0.02, 0.01] {
            assert!(!is_held(&shown_n(coarse_n, |_| 1)), "{coarse_n}");
        }
        assert!(!is_held(&shown_n(1e-5, |_| 200)));
        assert!(!is_held(&shown_n(1e-5, |_| 1)));
        // A wave without noise in coarse steps has runs of nearly the same length where it is steep.
        let wave = |place: i32| (100.0 * (0.005 * f64::from(place)).sin()).round();
        assert!(!is_held(&(0..8000).map(wave).collect::<Vec<f64>>()));
        // Counts of 4096 a turn of 0.4 m, written in µm.
        let counts = |place: i32| (wave(place) * 400.0 / 4096.0 * 1e3).round() * 1e-6;
        assert!(!is_held(&(0..8000).map(counts).collect::<Vec<f64>>()));
    }
}
