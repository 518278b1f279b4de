//! `[log.columns]`: assigns columns of a CSV log to signals and units.

use std::borrow::ToOwned;
use std::collections::BTreeMap;
use std::format;
use std::string::String;
use std::vec::Vec;

use serde::{Deserialize, Serialize};

use super::locate::{Step, unknown_name};
use super::options_error::OptionsError;

/// The time column, s.
pub const TIME_COLUMN: &str = "time_s";
/// Suffixes of a cable's columns after its name and a point: sensor force, length, speed, reference.
const CABLE_COLUMNS: [&str; 4] = ["force_n", "length_m", "speed_m_per_s", "reference_n"];
/// The columns of the platform's pose in the base frame.
pub const POSE_COLUMNS: [&str; 7] = ["pose.x_m", "pose.y_m", "pose.z_m", "pose.qx", "pose.qy", "pose.qz", "pose.qw"];
/// The columns of the external wrench on the platform.
pub const WRENCH_COLUMNS: [&str; 6] =
    ["wrench.fx_n", "wrench.fy_n", "wrench.fz_n", "wrench.tx_nm", "wrench.ty_nm", "wrench.tz_nm"];

/// An entry of `[log.columns]`: the value is `factor` times the column's content, plus `offset`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnTable {
    /// Name of the column in the header of the CSV file.
    pub column: String,
    /// Converts its unit to that of the key: 0.001 from millimetres, -1 for the opposite sign.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub factor: f64,
    /// Added after the factor, in the unit of the key.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub offset: f64,
}

impl ColumnTable {
    /// Creates an entry for a column in the unit of its key.
    #[must_use]
    pub fn plain(column: &str) -> Self {
        Self { column: column.to_owned(), factor: 1.0, offset: 0.0 }
    }
}

const fn one() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde passes it")]
fn is_one(factor: &f64) -> bool {
    factor.to_bits() == 1.0_f64.to_bits()
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde passes it")]
fn is_zero(offset: &f64) -> bool {
    offset.to_bits() == 0.0_f64.to_bits()
}

/// Returns the possible columns of a log for cables with these names.
pub(super) fn known(cable_names: &[&str]) -> Vec<String> {
    let of_cables = cable_names.iter().flat_map(|name| CABLE_COLUMNS.map(|column| format!("{name}.{column}")));
    let of_platform = [TIME_COLUMN].into_iter().chain(POSE_COLUMNS).chain(WRENCH_COLUMNS).map(ToOwned::to_owned);
    of_cables.chain(of_platform).collect()
}

/// Checks the entries of a robot with cables of these names.
///
/// # Errors
/// Returns an [`OptionsError`] for a key that names no signal, or a factor or offset that is not a valid number.
pub(super) fn check(columns: &BTreeMap<String, ColumnTable>, cable_names: &[&str]) -> Result<(), OptionsError> {
    let known = known(cable_names);
    for (place, (key, table)) in columns.iter().enumerate() {
        let wrong = |name: &str, problem: String| {
            let path = [Step::Key("log"), Step::Key("columns"), Step::Index(place)];
            OptionsError::new(&path, name, problem)
        };
        if !known.contains(key) {
            let problem =
                format!("under [log] has an {}", unknown_name("signal", key, known.iter().map(String::as_str)));
            return Err(wrong("columns", problem));
        }
        if table.column.trim().is_empty() {
            return Err(wrong("column", format!("of `{key}` is empty; give the name in the header of the CSV file")));
        }
        if !table.factor.is_finite() || table.factor == 0.0 {
            let problem = format!("of `{key}` is {}; it must be a finite number other than 0", table.factor);
            return Err(wrong("factor", problem));
        }
        if !table.offset.is_finite() {
            return Err(wrong("offset", format!("of `{key}` is {}; it must be a finite number", table.offset)));
        }
    }
    Ok(())
}
