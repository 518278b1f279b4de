//! The operating conditions of every cycle: quantities that friction may depend on, and over which a disagreement with the model may be concentrated.

use std::ops::Range;
use std::sync::Arc;

use super::cable::CableRecord;
use super::record::Row;
use crate::replay::Deviation;

/// Number of cycles over which rates are computed.
const RATE_CYCLES: usize = 20;
/// Maximum number of bins of a condition, and of the length, along which a defect is narrow.
const BINS: usize = 16;
const LENGTH_BINS: usize = 64;
/// The name of the condition that is the number of the log.
pub const LOG: &str = "log";
/// A cable slower than this fraction of its usual speed is at rest, and its position there depends only on the run.
const RESTING_RATIO: f64 = 0.02;

/// The division of a condition into bins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    /// This many bins with equal numbers of samples.
    Crowds(usize),
    /// This many bins of equal width.
    Widths(usize),
}

impl Spacing {
    /// Returns the same spacing with at most `most` bins.
    pub fn at_most(self, most: usize) -> Self {
        match self {
            Self::Crowds(count) => Self::Crowds(count.min(most)),
            Self::Widths(count) => Self::Widths(count.min(most)),
        }
    }
}

/// One operating condition over all cycles. Its values are computed from the cycles of the record where they are needed, because a series for each
/// condition would take up more memory than the record.
#[derive(Clone)]
pub struct Condition<'a> {
    /// Its name in results.
    pub signal: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its division into bins.
    pub bins: Spacing,
    count: usize,
    of_cycle: Arc<dyn Fn(usize) -> f64 + Send + Sync + 'a>,
}

impl<'a> Condition<'a> {
    /// Creates the condition from its value in each of the record's cycles; NaN if it has none.
    pub fn new(
        record: &CableRecord<'a>,
        (signal, unit, bins): (&'static str, &'static str, Spacing),
        of_cycle: impl Fn(usize) -> f64 + Send + Sync + 'a,
    ) -> Self {
        Self { signal, unit, bins, count: record.rows.len(), of_cycle: Arc::new(of_cycle) }
    }

    /// Returns the condition divided into at most `most` bins.
    pub fn with_at_most(&self, most: usize) -> Self {
        Self { bins: self.bins.at_most(most), ..self.clone() }
    }

    /// Returns its value in a cycle; NaN if it has none.
    pub fn at(&self, cycle: usize) -> f64 {
        (self.of_cycle)(cycle)
    }

    /// Returns its value in each cycle; NaN if it has none.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        (0..self.count).map(|cycle| self.at(cycle))
    }
}

/// Returns all conditions of a cable that its record contains.
pub fn conditions<'a>(record: &CableRecord<'a>) -> Vec<Condition<'a>> {
    let record = *record;
    let by_row = |name: (&'static str, &'static str, Spacing), value: fn(&Row) -> f64| {
        Condition::new(&record, name, move |cycle| record.rows.get(cycle).map_or(f64::NAN, value))
    };
    let crowds = Spacing::Crowds(BINS);
    let standstill = |row: &Row| f64::from(u8::from(row.signals.displacement_m.abs() <= 0.0));
    let ways_m = ways_since_reversal_m(&record);
    let moving_m_per_s = RESTING_RATIO * usual_speed_m_per_s(&record);
    let length_m = move |row: &Row| {
        if row.signals.speed_m_per_s.abs() > moving_m_per_s { row.signals.length_m } else { f64::NAN }
    };
    let mut conditions = vec![
        by_row(("standstill", "1", Spacing::Crowds(2)), standstill),
        by_row(("direction", "1", Spacing::Crowds(3)), |row| sign(row.signals.displacement_m)),
        Condition::new(&record, ("way_since_reversal", "m", crowds), move |cycle| {
            ways_m.get(cycle).copied().unwrap_or(f64::NAN)
        }),
        by_row(("speed", "m/s", crowds), |row| row.signals.speed_m_per_s.abs()),
        Condition::new(&record, ("acceleration", "m/s²", crowds), move |cycle| {
            rate(&record, cycle, |row| row.signals.speed_m_per_s).abs()
        }),
        by_row(("sensor_force", "N", crowds), |row| row.signals.sensor_force_n),
        Condition::new(&record, ("force_rate", "N/s", crowds), move |cycle| {
            rate(&record, cycle, |row| row.signals.sensor_force_n)
        }),
        Condition::new(&record, ("length", "m", Spacing::Widths(LENGTH_BINS)), move |cycle| {
            record.rows.get(cycle).map_or(f64::NAN, length_m)
        }),
    ];
    if record.params.needs_pose() {
        conditions.push(by_row(("wrap", "deg", crowds), |row| row.pose_wrap.wrap_rad().to_degrees()));
    }
    if let Some(radius_m) = record.params.pose_pulley_radius_m() {
        conditions.push(Condition::new(&record, ("pulley_angle", "deg", crowds), move |cycle| {
            let angle = |row: &Row| (row.signals.length_m / radius_m).to_degrees().rem_euclid(360.0);
            record.rows.get(cycle).map_or(f64::NAN, angle)
        }));
    }
    conditions
}

/// Returns the conditions over which an effect of the machine has one size: all but the sensor force and its rate, which contain what a model leaves, and load,
/// time and log. `all` are those of [`conditions`].
pub fn steady<'a>(record: &CableRecord<'a>, all: &[Condition<'a>]) -> Vec<Condition<'a>> {
    let without_residual = all.iter().filter(|condition| !["sensor_force", "force_rate"].contains(&condition.signal));
    let of_run = [load(record), time(record)].into_iter().chain(log(record));
    without_residual.cloned().chain(of_run).collect()
}

/// Returns the force at the platform as a condition. The sensor force contains what a model does not explain: a residual depends on it whatever it
/// comes from.
pub fn load<'a>(record: &CableRecord<'a>) -> Condition<'a> {
    let of_cycle = *record;
    Condition::new(record, ("load", "N", Spacing::Crowds(BINS)), move |cycle| of_cycle.reference_n(cycle))
}

/// Returns the time as a condition, for warm-up and wear.
pub fn time<'a>(record: &CableRecord<'a>) -> Condition<'a> {
    let of_cycle = *record;
    Condition::new(record, ("time", "s", Spacing::Crowds(BINS)), move |cycle| of_cycle.time_s(cycle))
}

/// Returns the number of the log as a condition, over which an effect of the machine has one size; `None` for a single log.
pub fn log<'a>(record: &CableRecord<'a>) -> Option<Condition<'a>> {
    let starts: Vec<usize> = record.logs().map(|(start, _)| start).collect();
    let bins = Spacing::Widths(starts.len().min(BINS));
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let number = move |cycle: usize| starts.partition_point(|start| *start <= cycle) as f64;
    (record.logs().count() > 1).then(|| Condition::new(record, (LOG, "1", bins), number))
}

/// Returns the root mean square of the speed, m/s.
fn usual_speed_m_per_s(record: &CableRecord<'_>) -> f64 {
    let mut speed = Deviation::default();
    record.rows.iter().filter(|row| row.is_sound()).for_each(|row| speed.add(row.signals.speed_m_per_s));
    speed.rms().unwrap_or(0.0)
}

/// Returns −1, 0 or 1.
pub fn sign(number: f64) -> f64 {
    if number > 0.0 {
        1.0
    } else if number < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Returns the distance since the last reversal in each cycle, m. A cable at rest keeps it.
fn ways_since_reversal_m(record: &CableRecord<'_>) -> Vec<f64> {
    let mut all_m = vec![f64::NAN; record.rows.len()];
    for (start, rows) in record.logs() {
        let mut way_m = 0.0_f64;
        for (place, row) in all_m.iter_mut().skip(start).zip(rows) {
            let step_m = row.signals.displacement_m;
            way_m = if way_m * step_m < 0.0 { step_m } else { way_m + step_m };
            *place = way_m.abs();
        }
    }
    all_m
}

/// Returns the rate of a signal over some cycles on either side, within the log of the cycle.
fn rate(record: &CableRecord<'_>, cycle: usize, value: fn(&Row) -> f64) -> f64 {
    let half = RATE_CYCLES / 2;
    let Range { start, end } = record.log_of(cycle);
    let (from, to) = (cycle.saturating_sub(half).max(start), (cycle + half).min(end.saturating_sub(1)));
    let of = |place: usize, value: fn(&Row) -> f64| record.rows.get(place).map_or(f64::NAN, value);
    let cycle_of = |row: &Row| row.cycle;
    (of(to, value) - of(from, value)) / ((of(to, cycle_of) - of(from, cycle_of)) * record.cycle_s)
}
