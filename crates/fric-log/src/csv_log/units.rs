//! Detects values that seem to have another unit than their column.
//!
//! The size of a value alone says little about a large robot: what a second measure of the same shows is in the right unit.

use super::CsvRow;
use crate::signals::Role;

/// A quantity whose unit is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Force,
    Length,
    Speed,
    Position,
}

impl Quantity {
    const fn unit(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Length | Self::Position => "m",
            Self::Speed => "m/s",
        }
    }
}

/// The magnitudes of the values of one column.
#[derive(Debug, Clone)]
struct Sizes {
    of: (Role, Quantity, usize),
    column: String,
    count: u64,
    sum: f64,
    greatest: f64,
}

/// The magnitudes of all values so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Units {
    /// Those of each column, file by file, and where the columns of the present file begin.
    sizes: Vec<Sizes>,
    first_of_file: usize,
    /// Of each cable.
    measures: Vec<Measures>,
    last_stamp_nanos: Option<i64>,
    /// Number of rows with a time, and of those with the time of the row before.
    timed_count: u64,
    /// Number of poses, and of those whose quaternion is 0.
    posed_count: u64,
    unturned_count: u64,
    repeated_count: u64,
    /// The shortest time from one row to the next.
    least_interval_nanos: Option<u64>,
    time_has_factor: bool,
}

/// Interval of the samples above which their times are probably not in seconds: no winch is recorded at less than 5 Hz, and in milliseconds this is
/// 5 kHz.
pub const GREAT_INTERVAL_S: f64 = 0.2;

/// Interval of the samples below which their times are probably days: no winch is recorded at more than 500 kHz, and in days this is 6 Hz.
const SMALL_INTERVAL_S: f64 = 2e-6;

/// A unit of time smaller than a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// 1e-3 s.
    Millisecond,
    /// 1e-6 s.
    Microsecond,
    /// 1e-9 s.
    Nanosecond,
}

impl TimeUnit {
    /// Returns the largest unit in which a time that was taken for seconds is below `most_s`; `None` if there is none.
    pub(super) fn of(taken_s: f64, most_s: f64) -> Option<Self> {
        let units = [(Self::Millisecond, 1e-3), (Self::Microsecond, 1e-6), (Self::Nanosecond, 1e-9)];
        units.into_iter().find(|(_, factor)| taken_s.abs() * factor < most_s).map(|(unit, _)| unit)
    }

    /// Returns its name and the factor to seconds.
    const fn name_and_factor(self) -> (&'static str, &'static str) {
        match self {
            Self::Millisecond => ("milliseconds", "0.001"),
            Self::Microsecond => ("microseconds", "1e-6"),
            Self::Nanosecond => ("nanoseconds", "1e-9"),
        }
    }

    /// Returns how to state it, a sentence without its beginning `if` and its full stop.
    pub(super) fn advice(self) -> String {
        let (name, factor) = self.name_and_factor();
        format!(
            "it is in {name}, give the column of `time_s` `factor = {factor}` under `[log.columns]` in the robot file"
        )
    }
}

/// Mean force above which the unit is probably grams or millinewtons, N: the largest cable robots with sensors have lower forces.
const GREAT_FORCE_N: f64 = 4000.0;
/// Force below which all values are probably in kilonewtons, N.
const SMALL_FORCE_N: f64 = 0.1;
/// Length above which the unit is probably millimetres, m: the diagonal of a hall.
const GREAT_LENGTH_M: f64 = 150.0;
/// Speed above which the unit is probably millimetres per second, m/s.
const GREAT_SPEED_M_PER_S: f64 = 30.0;

impl Units {
    /// Begins a file, which may have other columns than the one before.
    pub fn begin_file(&mut self) {
        self.first_of_file = self.sizes.len();
    }

    /// Adds the value of a column of this name, without its offset. `place` is that of the column among those of the file; `of` is its signal, and the
    /// index among those of its kind, such as the cable.
    pub fn add(&mut self, place: usize, of: (Role, Quantity, usize), column: &str, value: f64) {
        let place = self.first_of_file + place;
        if self.sizes.len() <= place {
            self.sizes.push(Sizes { of, column: column.to_owned(), count: 0, sum: 0.0, greatest: 0.0 });
        }
        if let Some(sizes) = self.sizes.get_mut(place).filter(|_| value.is_finite()) {
            sizes.count += 1;
            sizes.sum += value.abs();
            sizes.greatest = sizes.greatest.max(value.abs());
        }
    }

    /// Compares the measures of each of so many cables with one another.
    pub fn compare(&mut self, stamp_nanos: i64, row: &CsvRow, cable_count: usize) {
        self.measures.resize_with(cable_count, Measures::default);
        let of_cables = row.values(Role::Cable).unwrap_or_default();
        let references_n = row.values(Role::Reference).unwrap_or_default();
        for (cable, measures) in self.measures.iter_mut().enumerate() {
            let of_cable = |quantity: usize| of_cables.get(quantity * cable_count + cable).copied();
            if let (Some(force_n), Some(reference_n)) = (of_cable(0), references_n.get(cable)) {
                measures.forces.add(force_n, *reference_n);
            }
            if let (Some(length_m), Some(speed_m_per_s)) = (of_cable(1), of_cable(2)) {
                measures.motion.add(stamp_nanos, length_m, speed_m_per_s);
            }
        }
    }

    /// Adds the time of a row; `is_plain` if the file has it in seconds.
    pub fn add_stamp(&mut self, stamp_nanos: i64, is_plain: bool) {
        self.time_has_factor |= !is_plain;
        self.timed_count += 1;
        if let Some(last_nanos) = self.last_stamp_nanos.replace(stamp_nanos) {
            let interval_nanos = stamp_nanos.abs_diff(last_nanos);
            if interval_nanos == 0 {
                self.repeated_count += 1;
                return;
            }
            self.least_interval_nanos =
                Some(self.least_interval_nanos.map_or(interval_nanos, |least| least.min(interval_nanos)));
        }
    }

    /// Adds the values of a pose, the quaternion last.
    pub fn add_pose(&mut self, values: &[f64]) {
        let [_, _, _, orientation @ ..] = values else { return };
        self.posed_count += 1;
        self.unturned_count += u64::from(orientation.iter().all(|part| *part == 0.0));
    }

    /// Returns warnings about quantities that seem to have another unit, one sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        #[expect(clippy::cast_precision_loss, reason = "a duration for people")]
        let interval_s = self.least_interval_nanos.map_or(0.0, |nanos| nanos as f64 * 1e-9);
        if 2 * self.repeated_count > self.timed_count {
            warnings.push(format!(
                "{} of {} rows have the time of the row before, without which they are left out: the time has too few digits for the rate, or it is that of \
                 another column",
                self.repeated_count, self.timed_count
            ));
        } else if interval_s > GREAT_INTERVAL_S
            && let Some(unit) = TimeUnit::of(interval_s, GREAT_INTERVAL_S)
        {
            let advice = if self.time_has_factor {
                "that is wrong, correct the `factor` of `time_s` under `[log.columns]` in the robot file".to_owned()
            } else {
                unit.advice()
            };
            warnings.push(format!("the time is at least {interval_s:.4} s from row to row; if {advice}"));
        } else if interval_s > 0.0 && interval_s < SMALL_INTERVAL_S && !self.time_has_factor {
            warnings.push(format!(
                "the time is at least {interval_s:.1e} s from row to row, which looks like a spreadsheet's days: if so, give the column of `time_s` \
                 `factor = 86400.0` under `[log.columns]` in the robot file"
            ));
        }
        let of = |quantity| self.sizes.iter().filter(move |sizes| sizes.of.1 == quantity && sizes.count > 0);
        #[expect(clippy::cast_precision_loss, reason = "a mean for people")]
        let mean_n = |of: &Sizes| of.sum / of.count as f64;
        let greatest = |of: &Sizes| of.greatest;
        // The columns beyond a limit are named, unless it is all of them.
        let mut warn = |quantity, what: &str, size: &dyn Fn(&Sizes) -> f64, most: f64, other: &str, factor: &str| {
            let great: Vec<&Sizes> = of(quantity).filter(|of| size(of) > most && !self.is_confirmed(of)).collect();
            let Some(value) = great.iter().map(|of| size(of)).reduce(f64::max) else { return };
            let columns = if great.len() < of(quantity).count() {
                let mut names: Vec<String> = great.iter().map(|of| format!("`{}`", of.column)).collect();
                names.dedup();
                format!("in {} ", names.join(", "))
            } else {
                String::new()
            };
            warnings.push(format!(
                "{columns}{what} {value:.4} {}, which looks like {other}: if so, give the columns `factor = {factor}` under `[log.columns]` in the robot file",
                quantity.unit()
            ));
        };
        let grams = "grams (or millinewtons, factor 0.001)";
        warn(Quantity::Force, "forces are on average", &mean_n, GREAT_FORCE_N, grams, "0.00980665");
        let greatest_n = of(Quantity::Force).map(greatest).fold(0.0, f64::max);
        if greatest_n < SMALL_FORCE_N {
            warn(Quantity::Force, "forces are at most", &greatest, 0.0, "kilonewtons", "1000");
        }
        warn(Quantity::Length, "lengths are up to", &greatest, GREAT_LENGTH_M, "millimetres", "0.001");
        warn(Quantity::Position, "positions are up to", &greatest, GREAT_LENGTH_M, "millimetres", "0.001");
        warn(Quantity::Speed, "speeds are up to", &greatest, GREAT_SPEED_M_PER_S, "millimetres a second", "0.001");
        if self.unturned_count > 0 {
            warnings.push(format!(
                "the quaternion in `pose.qx` to `pose.qw` is 0 in {} of {} rows, which is no rotation, so that they have no pose; that of no turn has `qw` = 1",
                self.unturned_count, self.posed_count
            ));
        }
        warnings
    }

    /// Whether another measure of a cable shows the same, and is not too great itself. Two forces confirm each other, unless they are too small: a
    /// large robot has great forces, but none has so small ones.
    fn is_confirmed(&self, sizes: &Sizes) -> bool {
        let (_, quantity, cable) = sizes.of;
        let Some(measures) = self.measures.get(cable) else { return false };
        let is_usual = |other: Quantity, most: f64| {
            self.sizes.iter().filter(|sizes| sizes.of.1 == other && sizes.of.2 == cable).all(|of| of.greatest <= most)
        };
        match quantity {
            Quantity::Force => measures.forces.agree() && sizes.greatest > SMALL_FORCE_N,
            Quantity::Length => measures.motion.ways.agree() && is_usual(Quantity::Speed, GREAT_SPEED_M_PER_S),
            Quantity::Speed => measures.motion.ways.agree() && is_usual(Quantity::Length, GREAT_LENGTH_M),
            Quantity::Position => false,
        }
    }
}

/// Least squared correlation of two measures of the same, and greatest ratio of their sizes. The smallest ratio of two units is 2.2, of kilograms and
/// pounds; half and twice the distance from 1 tell the same of speeds that are filtered or late.
const LEAST_CORRELATION: f64 = 0.5;
const GREATEST_RATIO: f64 = 1.3;
/// Time over which the length changes between two comparisons, s: the noise of a length is small beside its change then.
const STEP_S: f64 = 0.1;
/// Longest time between two samples that belong together, s.
const LONGEST_GAP_S: f64 = 0.5;

/// Two measures of a cable's force, and two of its motion.
#[derive(Debug, Clone, Default)]
struct Measures {
    forces: Pair,
    motion: Motion,
}

/// Sums over two measures of the same quantity.
#[derive(Debug, Clone, Copy, Default)]
struct Pair {
    one: f64,
    other: f64,
    both: f64,
}

impl Pair {
    fn add(&mut self, one: f64, other: f64) {
        if one.is_finite() && other.is_finite() {
            self.one += one * one;
            self.other += other * other;
            self.both += one * other;
        }
    }

    /// Whether both show the same.
    fn agree(&self) -> bool {
        let ratio = (self.one / self.other).sqrt();
        self.both > 0.0
            && self.both * self.both > LEAST_CORRELATION * self.one * self.other
            && (GREATEST_RATIO.recip()..GREATEST_RATIO).contains(&ratio)
    }
}

/// The way of a cable, by the change of its length and by its speed.
#[derive(Debug, Clone, Default)]
struct Motion {
    /// Time, length and speed of the last sample.
    last: Option<(i64, f64, f64)>,
    /// Time since the present step began, s, and the ways in it, m.
    step: (f64, [f64; 2]),
    ways: Pair,
}

impl Motion {
    fn add(&mut self, stamp_nanos: i64, length_m: f64, speed_m_per_s: f64) {
        if !(length_m.is_finite() && speed_m_per_s.is_finite()) {
            return;
        }
        let Some((last_nanos, last_m, last_m_per_s)) = self.last.replace((stamp_nanos, length_m, speed_m_per_s)) else {
            return;
        };
        #[expect(clippy::cast_precision_loss, reason = "an interval between samples")]
        let passed_s = stamp_nanos.saturating_sub(last_nanos) as f64 * 1e-9;
        if !(passed_s > 0.0 && passed_s <= LONGEST_GAP_S) {
            self.step = Default::default();
            return;
        }
        let (lasted_s, [by_length_m, by_speed_m]) = &mut self.step;
        *lasted_s += passed_s;
        *by_length_m += length_m - last_m;
        *by_speed_m += 0.5 * (last_m_per_s + speed_m_per_s) * passed_s;
        if *lasted_s >= STEP_S {
            self.ways.add(*by_length_m, *by_speed_m);
            self.step = Default::default();
        }
    }
}
