//! Signals of a device that is slower than the log, which shows each of its measurements several times. Only the first of them is one.

use std::ops::Range;

use fric_core::Wrench;
use fric_core::signals::SignalLimits;
use nalgebra::Vector3;

use super::cable::CableRecord;
use super::record::{Measurements, Row};
use super::steps::changes_vary;

/// Minimum fraction of the changes that follow the one before after nearly the same number of samples, for a held signal. A value that repeats by chance does
/// so in 47 % at most; a held one that jitters by a sample does in all. Half of the distance to either gives the same for the logs of the tests.
const LEAST_REGULAR: f64 = 0.8;
/// Numbers of samples that count as nearly the same: a device that is not in step with the log is held for one sample more or less.
const ALIKE_COUNT: usize = 3;
/// Minimum rate of a held signal, Hz, as of an interpolated one. Slower changes are those of the signal: weights that are put on by hand.
const LEAST_RATE_HZ: f64 = 10.0;
/// Minimum number of changes that tell of a device.
const FEWEST_CHANGES: usize = 50;

/// Where a signal shows the measurement before once more, because it is held between two measurements.
struct Held {
    repeated: Vec<bool>,
    /// Usual number of samples that show a measurement, and the greatest one between two measurements of which none is missing.
    times: usize,
    most_times: usize,
}

impl Held {
    /// Returns where a signal is held; `None` if it is measured throughout.
    fn of_signal(record: &CableRecord<'_>, values: &[f64]) -> Option<Self> {
        let is_same = |index: usize| {
            let now = values.get(index).filter(|value| value.is_finite())?;
            let before = values.get(index.wrapping_sub(1));
            Some(before.is_some_and(|before| before.to_bits() == now.to_bits()))
        };
        Self::of(record, is_same).filter(|_| changes_vary(values))
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
            let mut repeated: Vec<Option<bool>> = (start..start + rows.len()).map(&is_same).collect();
            if let Some(first) = repeated.first_mut() {
                *first = first.map(|_| false);
            }
            let of_log = regular_hold(&repeated, record.interval_s);
            hold = hold.max(of_log);
            repeated.into_iter().map(move |repeated| of_log.is_some() && repeated == Some(true))
        };
        let repeated = record.logs().flat_map(of_log).collect();
        let (times, most_times) = hold?;
        Some(Self { repeated, times, most_times })
    }

    /// Returns a signal with lines between its measurements, and NaN where some are missing.
    fn with_lines(&self, record: &CableRecord<'_>, values: &[f64]) -> Vec<f64> {
        let mut lines = values.to_vec();
        self.visit_holds(record, |hold, next| {
            let is_missing = next.is_none() || hold.len() > self.most_times;
            let from = hold.start;
            let slope = next
                .map_or(f64::NAN, |next| (values[next] - values[from]) / (record.time_s(next) - record.time_s(from)));
            for (index, line) in lines.iter_mut().enumerate().take(hold.end).skip(from + 1) {
                let on_line = values[from] + slope * (record.time_s(index) - record.time_s(from));
                *line = if is_missing { f64::NAN } else { on_line };
            }
        });
        lines
    }

    /// Visits each measurement with the samples that repeat it, and the next measurement of the same log.
    fn visit_holds(&self, record: &CableRecord<'_>, mut visit: impl FnMut(Range<usize>, Option<usize>)) {
        for (start, rows) in record.logs() {
            let of_log = self.repeated.get(start..start + rows.len()).unwrap_or_default();
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
fn regular_hold(repeated: &[Option<bool>], interval_s: f64) -> Option<(usize, usize)> {
    let (mut lengths, mut present) = (Vec::new(), None);
    for repeated in repeated {
        match repeated {
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

/// Returns where the sensor of a cable shows its last measurement once more; `None` if it measures in every cycle.
pub fn repeated_forces(record: &CableRecord<'_>) -> Option<Vec<bool>> {
    Some(Held::of_signal(record, &record.shown_forces_n())?.repeated)
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
            for (index, row) in rows.iter_mut().enumerate().take(next).skip(from + 1) {
                row.signals.length_m = start_m + slope * (record.time_s(index) - record.time_s(from));
            }
        }
    });
    let lengths_m: Vec<f64> = rows.iter().map(|row| row.signals.length_m).collect();
    for (start, log) in record.logs() {
        let end = start + log.len();
        if !held.repeated.get(start..end).is_some_and(|repeated| repeated.contains(&true)) {
            continue;
        }
        for (index, row) in rows.iter_mut().enumerate().take(end).skip(start) {
            let (before, after) = (index.saturating_sub(held.times).max(start), (index + held.times).min(end - 1));
            let speed = (lengths_m[after] - lengths_m[before]) / (record.time_s(after) - record.time_s(before));
            if speed.is_finite() {
                row.signals.speed_m_per_s = speed;
            }
        }
    }
    Some(CableRecord { rows: &rows, ..*record }.conditioned(limits))
}

impl Measurements<'_> {
    /// Returns the same measurements with lines in index of what references, wrenches and lengths only repeat, as between the messages of a slow topic;
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
    pub(crate) fn repeat_warnings(&self, names: &[&str]) -> Vec<String> {
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
        let mut reported: Vec<(&str, usize, Vec<String>)> = Vec::new();
        for (signal, times, name) in cables.chain(wrench) {
            match reported.iter_mut().find(|(other, as_often, _)| *other == signal && *as_often == times) {
                Some((.., names)) => names.push(name),
                None => reported.push((signal, times, vec![name])),
            }
        }
        let sentence = |(signal, times, names): (&str, usize, Vec<String>)| {
            let names = names.join(", ");
            format!(
                "{names}: the {signal} is slower than the log, which shows each value {times} times; only the first counts"
            )
        };
        reported.into_iter().map(sentence).collect()
    }

    fn held_wrenches(&self) -> Option<Held> {
        let wrenches = &self.platform().wrenches;
        let is_same = |index: usize| {
            let now = wrenches.get(index)?.as_ref()?;
            Some(wrenches.get(index.wrapping_sub(1)).is_some_and(|before| before.as_ref() == Some(now)))
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
        let wrench = |index: usize| {
            let [x, y, z, tx, ty, tz] = lines.each_ref().map(|line| line[index]);
            let (force_n, torque_nm) = (Vector3::new(x, y, z), Vector3::new(tx, ty, tz));
            (force_n + torque_nm).iter().all(|value| value.is_finite()).then_some(Wrench { force_n, torque_nm })
        };
        Some((0..wrenches.len()).map(wrench).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::test_signals::shown_n;

    fn is_held(shown_n: &[f64]) -> bool {
        let is_same = |index: usize| index > 0 && shown_n[index - 1].to_bits() == shown_n[index].to_bits();
        let repeated = |index: usize| shown_n[index].is_finite().then(|| is_same(index));
        let repeated: Vec<Option<bool>> = (0..shown_n.len()).map(repeated).collect();
        regular_hold(&repeated, 1e-3).is_some() && changes_vary(shown_n)
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
            assert!(is_held(&shown_n(written_n, |index| 2 + index % 2)));
            assert!(is_held(&shown_n(written_n, |index| 7 + [0, 1, 2, 1][index % 4])));
        }
        // Coarse steps repeat by chance, a weight that is changed every 200 ms is that of the signal, and this one is measured throughout.
        for coarse_n in [0.1, 0.04, 0.02, 0.01] {
            assert!(!is_held(&shown_n(coarse_n, |_| 1)), "{coarse_n}");
        }
        assert!(!is_held(&shown_n(1e-5, |_| 200)));
        assert!(!is_held(&shown_n(1e-5, |_| 1)));
        // A wave without noise in coarse steps has runs of nearly the same length where it is steep.
        let wave = |index: i32| (100.0 * (0.005 * f64::from(index)).sin()).round();
        assert!(!is_held(&(0..8000).map(wave).collect::<Vec<f64>>()));
        // Counts of 4096 a turn of 0.4 m, written in µm.
        let counts = |index: i32| (wave(index) * 400.0 / 4096.0 * 1e3).round() * 1e-6;
        assert!(!is_held(&(0..8000).map(counts).collect::<Vec<f64>>()));
    }
}
