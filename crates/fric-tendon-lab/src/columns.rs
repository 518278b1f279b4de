//! Named columns of numbers, as in runs and on load benches.

use fric_core::robot::unknown_name;

use super::error::ContinuumError;

/// Time, s.
pub const TIME: &str = "time_s";
/// Tension of the tendon at the base, N.
pub const TENSION_BASE: &str = "tension_base_n";
/// Shift of the unloaded reference grating, nm.
pub const SHIFT_REFERENCE: &str = "shift_reference_nm";
/// Load of a calibration: mass on a hook, g, or force, N.
pub const LOADS: [&str; 2] = ["load_g", "load_n"];
/// A load on a single hole: tensions on both sides, and the angles between them and the normal force (\[C\] 16).
pub const HOLE: [&str; 4] = ["tension_1_n", "tension_2_n", "angle_1_rad", "angle_2_rad"];

/// Tension of the second tendon at the base, N, in commands.
pub const SECOND_TENSION_BASE: &str = "second_tension_base_n";
/// Wanted bend of the whole manipulator, rad.
pub const BEND: &str = "bend_rad";
/// Wanted position of the tip, m.
pub const TIP: [&str; 2] = ["tip_x_m", "tip_y_m"];

/// Parts of column names that occur only in a manipulator's run or bench.
pub const MARKS: [&str; 6] = [TENSION_BASE, "shift_", "marker_", "load_", "tension_1_n", "angle_1_rad"];

/// Returns `shift_1_nm` …
#[must_use]
pub fn shifts(disk_count: usize) -> Vec<String> {
    (1..=disk_count).map(|place| format!("shift_{place}_nm")).collect()
}

/// Returns `marker_1_x_m`, `marker_1_y_m` …
#[must_use]
pub fn markers(disk_count: usize) -> Vec<String> {
    (1..=disk_count).flat_map(|place| [format!("marker_{place}_x_m"), format!("marker_{place}_y_m")]).collect()
}

/// Returns all columns that a run may have.
#[must_use]
pub fn of_run(disk_count: usize) -> Vec<String> {
    let first = [TENSION_BASE, TIME, SHIFT_REFERENCE].map(ToOwned::to_owned);
    first.into_iter().chain(shifts(disk_count)).chain(markers(disk_count)).collect()
}

/// Returns all columns that a calibration may have.
#[must_use]
pub fn of_calibration(disk_count: usize) -> Vec<String> {
    LOADS.into_iter().chain([SHIFT_REFERENCE]).map(ToOwned::to_owned).chain(shifts(disk_count)).collect()
}

/// Returns all columns of loads on a single hole.
#[must_use]
pub fn of_hole() -> Vec<String> {
    HOLE.map(ToOwned::to_owned).to_vec()
}

/// Returns all columns that a path of goals may have.
#[must_use]
pub fn of_path() -> Vec<String> {
    [TIME, BEND].into_iter().chain(TIP).map(ToOwned::to_owned).collect()
}

/// Shift per strain of a silica grating at 1550 nm, `λ_B(1 − P_e)` (\[C\] 3), nm.
const SHIFT_NM_PER_STRAIN: f64 = 1550.0 * (1.0 - 0.22);
/// Shift that corresponds to a strain of 4 %, which no fibre survives, nm.
const MOST_SHIFT_NM: f64 = 50.0;
/// Fraction of the values to check; the greatest values beyond it may be spikes of the demodulator.
const MOST_RATIO: f64 = 0.75;

/// Returns the greatest magnitude among a column's values, with the largest quarter left out.
fn greatest_of_most(column: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = column.iter().map(|value| value.abs()).filter(|size| size.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place in a list"
    )]
    let place = (MOST_RATIO * sizes.len() as f64) as usize;
    sizes.get(place).copied().unwrap_or(0.0)
}

/// Columns of equal length whose names are all known.
#[derive(Clone, Debug)]
pub(super) struct Columns<'a> {
    columns: &'a [(String, Vec<f64>)],
}

impl<'a> Columns<'a> {
    /// Checks names and lengths.
    pub fn new(columns: &'a [(String, Vec<f64>)], known: &[String]) -> Result<Self, ContinuumError> {
        for (name, _) in columns {
            if !known.contains(name) {
                let sentence = unknown_name("column", name, known.iter().map(String::as_str));
                return Err(ContinuumError::UnknownColumn(sentence));
            }
        }
        let count = columns.first().map_or(0, |(_, numbers)| numbers.len());
        match columns.iter().find(|(_, numbers)| numbers.len() != count) {
            Some((name, numbers)) => {
                Err(ContinuumError::UnequalColumns { column: name.clone(), count: numbers.len(), needed: count })
            }
            None => Ok(Self { columns }),
        }
    }

    /// Returns all columns of shifts; `None` if there are none.
    pub fn shifts(&self, disk_count: usize) -> Result<Option<Vec<&'a [f64]>>, ContinuumError> {
        let names = shifts(disk_count);
        let columns = self.group(&names)?;
        for (name, column) in names.into_iter().zip(columns.iter().flatten()) {
            let greatest_nm = greatest_of_most(column);
            if greatest_nm > MOST_SHIFT_NM {
                let strain_percent = 100.0 * greatest_nm / SHIFT_NM_PER_STRAIN;
                return Err(ContinuumError::ShiftUnit { column: name, greatest_nm, strain_percent });
            }
        }
        Ok(columns)
    }

    pub fn row_count(&self) -> usize {
        self.columns.first().map_or(0, |(_, numbers)| numbers.len())
    }

    pub fn get(&self, name: &str) -> Option<&'a [f64]> {
        self.columns.iter().find(|(other, _)| other == name).map(|(_, numbers)| numbers.as_slice())
    }

    pub fn required(&self, name: &str) -> Result<&'a [f64], ContinuumError> {
        self.get(name).ok_or_else(|| ContinuumError::MissingColumn { column: name.to_owned(), beside: None })
    }

    /// Returns all columns of a group; `None` if there are none.
    pub fn group(&self, names: &[String]) -> Result<Option<Vec<&'a [f64]>>, ContinuumError> {
        let Some(beside) = names.iter().find(|name| self.get(name).is_some()) else { return Ok(None) };
        let column = |name: &String| {
            self.get(name)
                .ok_or_else(|| ContinuumError::MissingColumn { column: name.clone(), beside: Some(beside.clone()) })
        };
        names.iter().map(column).collect::<Result<_, _>>().map(Some)
    }
}
