//! The operating conditions of every cycle: quantities that friction may depend on, and over which a disagreement with the model may be concentrated.

use std::sync::Arc;

use super::record::{CableRecord, Row};
use crate::replay::Deviation;

/// Number of cycles over which rates are computed.
const RATE_CYCLES: usize = 20;
/// Maximum number of bins of a condition, and of the length, along which a defect is narrow.
const BINS: usize = 16;
const LENGTH_BINS: usize = 64;
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

/// One operating condition over all cycles.
#[derive(Clone, Debug)]
pub struct Condition {
    /// Its name in results.
    pub signal: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its value in each cycle; NaN if it has none. Copies share them.
    pub values: Arc<Vec<f64>>,
    /// Its division into bins.
    pub bins: Spacing,
}

/// Returns all conditions of a cable that its record contains.
pub fn conditions(record: &CableRecord<'_>) -> Vec<Condition> {
    let mut conditions = Vec::new();
    let mut add = |signal, unit, bins, of_log: &dyn Fn(&[Row]) -> Vec<f64>| {
        let mut values = vec![f64::NAN; record.rows.len()];
        for (start, rows) in record.logs() {
            for (place, value) in values.iter_mut().skip(start).zip(of_log(rows)) {
                *place = value;
            }
        }
        conditions.push(Condition { signal, unit, values: Arc::new(values), bins });
    };
    let rows_to = |value: fn(&Row) -> f64| move |rows: &[Row]| rows.iter().map(value).collect::<Vec<f64>>();
    let cycle_s = record.cycle_s;
    let standstill = |row: &Row| f64::from(u8::from(row.signals.displacement_m.abs() <= 0.0));
    add("standstill", "1", Spacing::Crowds(2), &rows_to(standstill));
    add("direction", "1", Spacing::Crowds(3), &rows_to(|row| sign(row.signals.displacement_m)));
    add("way_since_reversal", "m", Spacing::Crowds(BINS), &ways_since_reversal_m);
    add("speed", "m/s", Spacing::Crowds(BINS), &rows_to(|row| row.signals.speed_m_per_s.abs()));
    add("acceleration", "m/s²", Spacing::Crowds(BINS), &|rows| {
        rates(rows, cycle_s, |row| row.signals.speed_m_per_s).into_iter().map(f64::abs).collect()
    });
    add("sensor_force", "N", Spacing::Crowds(BINS), &rows_to(|row| row.signals.sensor_force_n));
    add("force_rate", "N/s", Spacing::Crowds(BINS), &|rows| rates(rows, cycle_s, |row| row.signals.sensor_force_n));
    let moving_m_per_s = RESTING_RATIO * usual_speed_m_per_s(record);
    add("length", "m", Spacing::Widths(LENGTH_BINS), &move |rows| {
        let moves = |row: &Row| row.signals.speed_m_per_s.abs() > moving_m_per_s;
        rows.iter().map(|row| if moves(row) { row.signals.length_m } else { f64::NAN }).collect()
    });
    if record.params.needs_pose() {
        add("wrap", "deg", Spacing::Crowds(BINS), &rows_to(|row| row.pose_wrap.wrap_rad().to_degrees()));
    }
    if let Some(radius_m) = record.params.pose_pulley_radius_m() {
        add("pulley_angle", "deg", Spacing::Crowds(BINS), &move |rows| {
            rows.iter().map(|row| (row.signals.length_m / radius_m).to_degrees().rem_euclid(360.0)).collect()
        });
    }
    conditions
}

/// Returns the force at the platform as a condition. The sensor force contains what a model does not explain: a residual depends on it whatever it
/// comes from.
pub fn load(record: &CableRecord<'_>) -> Condition {
    let values = Arc::new(record.rows.iter().map(|row| row.reference_n).collect());
    Condition { signal: "load", unit: "N", values, bins: Spacing::Crowds(BINS) }
}

/// Returns the time as a condition, for warm-up and wear.
pub fn time(record: &CableRecord<'_>) -> Condition {
    let values = Arc::new((0..record.rows.len()).map(|cycle| record.time_s(cycle)).collect());
    Condition { signal: "time", unit: "s", values, bins: Spacing::Crowds(BINS) }
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

/// Returns the distance since the last reversal, m. A cable at rest keeps it.
fn ways_since_reversal_m(rows: &[Row]) -> Vec<f64> {
    let mut way_m = 0.0_f64;
    rows.iter()
        .map(|row| {
            let step_m = row.signals.displacement_m;
            way_m = if way_m * step_m < 0.0 { step_m } else { way_m + step_m };
            way_m.abs()
        })
        .collect()
}

/// Returns the rates of a signal over some cycles on either side.
fn rates(rows: &[Row], cycle_s: f64, value: fn(&Row) -> f64) -> Vec<f64> {
    let half = RATE_CYCLES / 2;
    let rate = |place: usize| {
        let (from, to) = (place.saturating_sub(half), (place + half).min(rows.len() - 1));
        let change = rows.get(to).map_or(f64::NAN, value) - rows.get(from).map_or(f64::NAN, value);
        let cycle = |place: usize| rows.get(place).map_or(f64::NAN, |row| row.cycle);
        change / ((cycle(to) - cycle(from)) * cycle_s)
    };
    (0..rows.len()).map(rate).collect()
}
