//! New values in a manipulator file that somebody wrote: comments, order and layout stay.

use std::borrow::ToOwned;
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

use toml_edit::{Array, DocumentMut, Item, Table, Value};

use super::file::{FORMAT, ManipulatorFile, ManipulatorFileError};

/// What to change; what is `None` or empty stays as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ManipulatorEdit {
    /// Friction coefficient of the first tendon: one for all holes, or one for each.
    pub mu: Vec<f64>,
    /// Presliding stiffness of its holes, N/m.
    pub sigma_n_per_m: Option<f64>,
    /// The line of each grating.
    pub lines: Vec<GratingLine>,
    /// Drift of each grating, nm/s.
    pub drift_nm_per_s: Vec<f64>,
}

/// The line of a grating, `T = a·Δλ + b`, with its standard errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GratingLine {
    /// a, N/nm.
    pub newton_per_nm: f64,
    /// b, N.
    pub offset_n: f64,
    /// Of a tension from one shift, N.
    pub standard_error_n: f64,
    /// Of the line at the mean shift of its load steps, N.
    pub line_error_n: f64,
    /// Of the slope, N/nm.
    pub slope_error_n_per_nm: f64,
    /// That mean shift, nm.
    pub mean_shift_nm: f64,
}

/// The text of a manipulator file with new values; `origin` says where it is from, for errors.
///
/// ```
/// use fric_core::continuum::edit::{ManipulatorEdit, rewrite};
/// let text = include_str!("../../../../examples/tendon-prototype.toml");
/// let edit = ManipulatorEdit { mu: vec![0.2], ..ManipulatorEdit::default() };
/// let edited = rewrite(text, "arm.toml", &edit)?;
/// assert_eq!(edited, text.replace("mu = 0.1753 ", "mu = 0.2 "));
/// # Ok::<(), fric_core::continuum::file::ManipulatorFileError>(())
/// ```
///
/// # Errors
/// [`ManipulatorFileError::Invalid`] if the text is not right, before or with the new values.
pub fn rewrite(text: &str, origin: &str, edit: &ManipulatorEdit) -> Result<String, ManipulatorFileError> {
    ManipulatorFile::parse(text, origin)?;
    let invalid = |problem: String| ManipulatorFileError::Invalid { origin: origin.to_owned(), line: None, problem };
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| invalid(error.to_string()))?;
    let mut set = |table: &str, key: &str, value: Value| {
        let place = document.entry(table).or_insert_with(|| {
            let mut table = Table::new();
            table.decor_mut().set_prefix("\n");
            Item::Table(table)
        });
        let Some(place) = place.as_table_like_mut() else {
            return Err(invalid(format!("`{table}` is no table; see {FORMAT}")));
        };
        let mut value = value;
        if let Some(old) = place.get(key).and_then(Item::as_value) {
            *value.decor_mut() = old.decor().clone();
        }
        place.insert(key, Item::Value(value));
        Ok(())
    };
    let list = |values: &[f64]| Value::Array(values.iter().copied().collect::<Array>());
    match edit.mu.as_slice() {
        [] => {}
        [one] => set("tendon", "mu", (*one).into())?,
        each => set("tendon", "mu", list(each))?,
    }
    if let Some(sigma_n_per_m) = edit.sigma_n_per_m {
        set("tendon", "sigma_n_per_m", sigma_n_per_m.into())?;
    }
    if !edit.lines.is_empty() {
        let column = |of: fn(&GratingLine) -> f64| list(&edit.lines.iter().map(of).collect::<Vec<_>>());
        set("gratings", "newton_per_nm", column(|line| line.newton_per_nm))?;
        set("gratings", "offset_n", column(|line| line.offset_n))?;
        set("gratings", "standard_error_n", column(|line| line.standard_error_n))?;
        set("gratings", "line_error_n", column(|line| line.line_error_n))?;
        set("gratings", "slope_error_n_per_nm", column(|line| line.slope_error_n_per_nm))?;
        set("gratings", "mean_shift_nm", column(|line| line.mean_shift_nm))?;
    }
    if !edit.drift_nm_per_s.is_empty() {
        set("gratings", "drift_nm_per_s", list(&edit.drift_nm_per_s))?;
    }
    let text = document.to_string();
    ManipulatorFile::parse(&text, &format!("{origin} with the new values"))?;
    Ok(text)
}
