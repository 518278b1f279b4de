//! `[gratings]` of the manipulator file: the fibre Bragg gratings of the first tendon, one in each segment.

use std::borrow::ToOwned;
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

use serde::{Deserialize, Serialize};
use toml_edit::{Array, DocumentMut, Item, Table};

use super::file::{FORMAT, ManipulatorFile, ManipulatorFileError, OneOrEach, TablesError};
use crate::robot::check;
use crate::robot::locate::Step;

/// What is known of the gratings. A list has one entry for each segment from the base.
///
/// Needed is a calibration (`newton_per_nm`), or for the strain form (\[C\] 4) `wavelength_nm` and `photoelastic_ratio`; E·A is
/// the tendon's `axial_stiffness_n`. A calibration goes before the strain form.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GratingsTable {
    /// Slope a of `T = a·Δλ + b` (\[C\] 7), N/nm.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub newton_per_nm: Vec<f64>,
    /// Offset b, N; 0 if left out.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub offset_n: Vec<f64>,
    /// Standard error of a tension from one shift, N; 0 if left out.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub standard_error_n: Vec<f64>,
    /// Bragg wavelength λ_B, nm: for the strain form, and to take the temperature off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wavelength_nm: Option<OneOrEach>,
    /// Bragg wavelength of the grating without load whose shift is `shift_reference_nm`, nm; the mean of the others if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_wavelength_nm: Option<f64>,
    /// Effective photoelastic coefficient P_e; 0.22 for silica.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub photoelastic_ratio: Option<f64>,
    /// From the face of the disk on the base side to the near end of a grating in the straight manipulator, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_base_side_m: Option<OneOrEach>,
    /// Length of a grating, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_m: Option<OneOrEach>,
}

impl GratingsTable {
    /// Whether everything is finite, in its range and as long as there are segments.
    pub(super) fn check(&self, disk_count: usize) -> Result<(), TablesError> {
        let problem = |path: &[Step], problem: String| {
            let path = [Step::Key("gratings")].into_iter().chain(path.iter().copied()).collect();
            Err(TablesError::new(path, problem))
        };
        let one = |value: &Option<f64>| value.iter().copied().collect::<Vec<f64>>();
        let each = |values: &Option<OneOrEach>| values.iter().flat_map(|all| all.as_slice().to_vec()).collect();
        let lists: [(&'static str, Vec<f64>, f64, f64); 8] = [
            ("newton_per_nm", self.newton_per_nm.clone(), -1e6, 1e6),
            ("offset_n", self.offset_n.clone(), -1e6, 1e6),
            ("standard_error_n", self.standard_error_n.clone(), 0.0, 1e6),
            ("wavelength_nm", each(&self.wavelength_nm), 100.0, 1e4),
            ("reference_wavelength_nm", one(&self.reference_wavelength_nm), 100.0, 1e4),
            ("photoelastic_ratio", one(&self.photoelastic_ratio), 0.0, 0.9),
            ("from_base_side_m", each(&self.from_base_side_m), 0.0, 10.0),
            ("length_m", each(&self.length_m), 0.0, 10.0),
        ];
        for (key, values, min, max) in &lists {
            let may_be_one = !["newton_per_nm", "offset_n", "standard_error_n"].contains(key);
            if !(values.is_empty() || values.len() == disk_count || may_be_one && values.len() == 1) {
                let text =
                    format!("`{key}` has {} entries; {disk_count} are needed, one for each segment", values.len());
                return problem(&[Step::Key(key)], text);
            }
            for (place, value) in values.iter().enumerate() {
                if let Err(error) = check(key, *value, *min, *max) {
                    return problem(&[Step::Key(key), Step::Index(place)], format!("{error} (grating {})", place + 1));
                }
            }
        }
        if let Some(place) = self.newton_per_nm.iter().position(|slope| *slope == 0.0) {
            let text = format!("`newton_per_nm` of grating {} is 0, with which it measures nothing", place + 1);
            return problem(&[Step::Key("newton_per_nm"), Step::Index(place)], text);
        }
        let has_strain_form = self.wavelength_nm.is_some() && self.photoelastic_ratio.is_some();
        if self.newton_per_nm.is_empty() && !has_strain_form {
            let text = "no tension follows from these gratings; give `newton_per_nm` by a calibration, or `wavelength_nm` \
                        and `photoelastic_ratio`";
            return problem(&[], text.to_owned());
        }
        if self.from_base_side_m.is_some() != self.length_m.is_some() {
            let text = "`from_base_side_m` and `length_m` place a grating together; give both or none";
            return problem(&[], text.to_owned());
        }
        Ok(())
    }
}

/// The text of a manipulator file with the coefficients of a calibration; all else stays, comments included.
///
/// `lines` holds for each grating the slope, N/nm, the offset, N, and the standard error of a tension, N. `origin` says
/// where the text is from, for errors.
///
/// # Errors
/// [`ManipulatorFileError::Invalid`] if the text is not right, before or with the new values.
pub fn with_calibration(text: &str, origin: &str, lines: &[[f64; 3]]) -> Result<String, ManipulatorFileError> {
    ManipulatorFile::parse(text, origin)?;
    let invalid = |problem: String| ManipulatorFileError::Invalid { origin: origin.to_owned(), line: None, problem };
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| invalid(error.to_string()))?;
    let gratings = document.entry("gratings").or_insert_with(|| {
        let mut table = Table::new();
        table.decor_mut().set_prefix("\n");
        Item::Table(table)
    });
    let Some(gratings) = gratings.as_table_like_mut() else {
        return Err(invalid(format!("`gratings` is no table; see {FORMAT}")));
    };
    for (place, key) in ["newton_per_nm", "offset_n", "standard_error_n"].into_iter().enumerate() {
        let values: Array = lines.iter().filter_map(|line| line.get(place)).copied().collect();
        gratings.insert(key, toml_edit::value(values));
    }
    let text = document.to_string();
    ManipulatorFile::parse(&text, &format!("{origin} with the calibration"))?;
    Ok(text)
}
