//! The operating conditions of every cycle, in which a disagreement may sit.

use crate::fit::{CableRecord, Row};

/// Cycles over which rates are taken.
const RATE_CYCLES: usize = 20;
/// Most bins of a condition, and of the length, along which a defect is narrow.
const BINS: usize = 16;
const LENGTH_BINS: usize = 96;

/// One operating condition over all cycles.
#[derive(Clone, Debug)]
pub struct Condition {
    /// Its name in results.
    pub signal: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its value in each cycle; NaN where it has none.
    pub values: Vec<f64>,
    /// How many bins to look at it in.
    pub bins: usize,
}

/// All conditions of a cable that its record tells.
pub fn conditions(record: &CableRecord<'_>) -> Vec<Condition> {
    let mut conditions = Vec::new();
    let mut add = |signal, unit, bins, of_log: &dyn Fn(&[Row]) -> Vec<f64>| {
        let mut values = vec![f64::NAN; record.rows.len()];
        for (start, rows) in record.logs() {
            for (place, value) in values.iter_mut().skip(start).zip(of_log(rows)) {
                *place = value;
            }
        }
        conditions.push(Condition { signal, unit, values, bins });
    };
    let rows_to = |value: fn(&Row) -> f64| move |rows: &[Row]| rows.iter().map(value).collect::<Vec<f64>>();
    let cycle_s = record.cycle_s;
    let standstill = |row: &Row| f64::from(u8::from(row.signals.displacement_m.abs() <= 0.0));
    add("standstill", "1", 2, &rows_to(standstill));
    add("direction", "1", 3, &rows_to(|row| sign(row.signals.displacement_m)));
    add("way_since_reversal", "m", BINS, &ways_since_reversal_m);
    add("speed", "m/s", BINS, &rows_to(|row| row.signals.speed_m_per_s.abs()));
    add("acceleration", "m/s²", BINS, &|rows| {
        rates(rows, cycle_s, |row| row.signals.speed_m_per_s).into_iter().map(f64::abs).collect()
    });
    add("sensor_force", "N", BINS, &rows_to(|row| row.signals.sensor_force_n));
    add("force_rate", "N/s", BINS, &|rows| rates(rows, cycle_s, |row| row.signals.sensor_force_n));
    add("length", "m", LENGTH_BINS, &rows_to(|row| row.signals.length_m));
    if record.params.needs_pose() {
        add("wrap", "deg", BINS, &rows_to(|row| row.pose_wrap.wrap_rad().to_degrees()));
    }
    if let Some(radius_m) = record.params.pose_pulley_radius_m() {
        add("pulley_angle", "deg", BINS, &move |rows| {
            rows.iter().map(|row| (row.signals.length_m / radius_m).to_degrees().rem_euclid(360.0)).collect()
        });
    }
    conditions
}

/// −1, 0 or 1.
pub fn sign(number: f64) -> f64 {
    if number > 0.0 {
        1.0
    } else if number < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Way since the last reversal, m; a cable that rests keeps it.
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

/// Rates of a signal over some cycles on either side.
fn rates(rows: &[Row], cycle_s: f64, value: fn(&Row) -> f64) -> Vec<f64> {
    let half = RATE_CYCLES / 2;
    let rate = |place: usize| {
        let (from, to) = (place.saturating_sub(half), (place + half).min(rows.len() - 1));
        let change = rows.get(to).map_or(f64::NAN, value) - rows.get(from).map_or(f64::NAN, value);
        #[expect(clippy::cast_precision_loss, reason = "a few cycles")]
        let duration_s = (to - from) as f64 * cycle_s;
        change / duration_s
    };
    (0..rows.len()).map(rate).collect()
}
