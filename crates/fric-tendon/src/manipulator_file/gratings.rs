//! `[gratings]` of the manipulator file: the fibre Bragg gratings of the first tendon, one in each segment.

use std::borrow::ToOwned;
use std::format;
use std::string::String;
use std::vec::Vec;

use fric_core::robot::check;
use fric_core::robot::locate::Step;
use serde::{Deserialize, Serialize};

use super::file::{OneOrEach, TablesError};

/// The properties of the gratings. A list has one entry per segment, starting at the base.
///
/// Required is a calibration (`newton_per_nm`) or, for the strain form (\[C\] 4), `wavelength_nm` and `photoelastic_ratio`; E·A is the tendon's
/// `axial_stiffness_n`. A calibration takes precedence over the strain form.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GratingsTable {
    /// Slope a of `T = a·Δλ + b` (\[C\] 7), N/nm.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub newton_per_nm: Vec<f64>,
    /// Offset b, N; default 0.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub offset_n: Vec<f64>,
    /// Standard error of a tension from one shift, N; default 0.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub standard_error_n: Vec<f64>,
    /// Standard error of the line itself, N, at the mean shift of its load steps; by default half of `standard_error_n`, as after ten evenly spaced
    /// loads.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub line_error_n: Vec<f64>,
    /// Standard error of the slope, N/nm; default 0.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub slope_error_n_per_nm: Vec<f64>,
    /// Mean shift of the load steps, nm, where the errors of line and slope are independent; default 0.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mean_shift_nm: Vec<f64>,
    /// Drift of the shift over the time of a run, nm/s, for instance of a fibre that warms up; default 0.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drift_nm_per_s: Vec<f64>,
    /// Common shift of all gratings from a time of the run on, nm, for instance when warm air reaches the fibre; default 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub common_step_nm: Option<f64>,
    /// That time, s in the run's time; by default the beginning.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub common_step_s: Option<f64>,
    /// Bragg wavelength λ_B, nm, for the strain form and to remove the temperature effect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wavelength_nm: Option<OneOrEach>,
    /// Bragg wavelength of the unloaded grating with the shift `shift_reference_nm`, nm; by default the mean of the others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_wavelength_nm: Option<f64>,
    /// Effective photoelastic coefficient P_e; 0.22 for silica.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub photoelastic_ratio: Option<f64>,
    /// Distance from the face of the disk on the base side to the near end of a grating in the straight manipulator, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_base_side_m: Option<OneOrEach>,
    /// Length of a grating, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_m: Option<OneOrEach>,
}

impl GratingsTable {
    /// Checks whether all values are finite and in range, and all lists have one entry per segment.
    pub(super) fn check(&self, disk_count: usize) -> Result<(), TablesError> {
        let problem = |path: &[Step], problem: String| {
            let path = [Step::Key("gratings")].into_iter().chain(path.iter().copied()).collect();
            Err(TablesError::new(path, problem))
        };
        let one = |value: &Option<f64>| value.iter().copied().collect::<Vec<f64>>();
        let each = |values: &Option<OneOrEach>| values.iter().flat_map(|all| all.as_slice().to_vec()).collect();
        let lists: [(&'static str, Vec<f64>, f64, f64); 14] = [
            ("newton_per_nm", self.newton_per_nm.clone(), -1e6, 1e6),
            ("offset_n", self.offset_n.clone(), -1e6, 1e6),
            ("standard_error_n", self.standard_error_n.clone(), 0.0, 1e6),
            ("line_error_n", self.line_error_n.clone(), 0.0, 1e6),
            ("slope_error_n_per_nm", self.slope_error_n_per_nm.clone(), 0.0, 1e6),
            ("mean_shift_nm", self.mean_shift_nm.clone(), -1e3, 1e3),
            ("drift_nm_per_s", self.drift_nm_per_s.clone(), -1e3, 1e3),
            ("common_step_nm", one(&self.common_step_nm), -1e3, 1e3),
            ("common_step_s", one(&self.common_step_s), -1e12, 1e12),
            ("wavelength_nm", each(&self.wavelength_nm), 100.0, 1e4),
            ("reference_wavelength_nm", one(&self.reference_wavelength_nm), 100.0, 1e4),
            ("photoelastic_ratio", one(&self.photoelastic_ratio), 0.0, 0.9),
            ("from_base_side_m", each(&self.from_base_side_m), 0.0, 10.0),
            ("length_m", each(&self.length_m), 0.0, 10.0),
        ];
        for (key, values, min, max) in &lists {
            let may_be_one = [
                "common_step_nm",
                "common_step_s",
                "wavelength_nm",
                "reference_wavelength_nm",
                "photoelastic_ratio",
                "from_base_side_m",
                "length_m",
            ];
            let may_be_one = may_be_one.contains(key);
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
