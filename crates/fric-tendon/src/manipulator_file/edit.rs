//! Writes new values into a manipulator file without changing comments, order and layout.

use std::borrow::ToOwned;
use std::format;
use std::string::String;
use std::vec::Vec;

use fric_core::toml_editor::{self, Numbers};

use super::file::{ManipulatorFile, ManipulatorFileError, ManipulatorTables, OneOrEach};
use super::measuring::{BaseSensorTable, MarkersTable};

/// The changes; `None` or an empty list keeps a value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ManipulatorEdit {
    /// Friction coefficient of the first tendon: one for all holes, or one per hole.
    pub mu: Vec<f64>,
    /// Presliding stiffness of the first tendon's holes, N/m.
    pub sigma_n_per_m: Option<f64>,
    /// The calibration line of each grating.
    pub lines: Vec<GratingLine>,
    /// Drift of each grating, nm/s.
    pub drift_nm_per_s: Vec<f64>,
    /// Common shift of all gratings from a time on, nm, and that time, s.
    pub common_step: Option<[f64; 2]>,
    /// Distance of each disk from the one before, starting at the base plate, m.
    pub pitch_m: Vec<f64>,
    /// Young's modulus of the backbone, Pa, which determines its bending stiffness.
    pub youngs_modulus_pa: Option<f64>,
    /// Bending stiffness of each segment relative to the backbone's.
    pub segment_stiffness_ratio: Vec<f64>,
    /// Unloaded curvature, 1/m: one for all segments, or one per segment.
    pub precurvature_per_m: Vec<f64>,
    /// Radius of the circle of holes, m.
    pub hole_radius_m: Option<f64>,
    /// Gravity, m/s².
    pub gravity_m_per_s2: Option<[f64; 2]>,
    /// Mass on the tip, kg.
    pub tip_mass_kg: Option<f64>,
    /// Force on the tip, N.
    pub tip_force_n: Option<[f64; 2]>,
    /// Frame of the markers.
    pub markers: Option<MarkersTable>,
    /// Sensor of the tension at the base.
    pub base_sensor: Option<BaseSensorTable>,
}

impl ManipulatorEdit {
    /// Returns the changes of friction, bending, loads and measurement that convert the given tables to the wanted ones. The lines of the gratings
    /// and their drift are not compared.
    #[must_use]
    pub fn between(given: &ManipulatorTables, wanted: &ManipulatorTables) -> Self {
        fn changed<T: PartialEq + Clone>(given: &T, wanted: &T) -> Option<T> {
            (given != wanted).then(|| wanted.clone())
        }
        let list = |given: &Option<OneOrEach>, wanted: &Option<OneOrEach>| {
            changed(given, wanted).flatten().map_or_else(Vec::new, |all| all.as_slice().to_vec())
        };
        let step = |tables: &ManipulatorTables| {
            tables.gratings.as_ref().map(|all| [all.common_step_nm.unwrap_or(0.0), all.common_step_s.unwrap_or(0.0)])
        };
        let (backbone, wanted_backbone) = (&given.backbone, &wanted.backbone);
        Self {
            mu: changed(&given.tendon.mu, &wanted.tendon.mu).map_or_else(Vec::new, |mu| mu.as_slice().to_vec()),
            sigma_n_per_m: changed(&given.tendon.sigma_n_per_m, &wanted.tendon.sigma_n_per_m)
                .flatten()
                .and_then(|sigma| sigma.as_slice().first().copied()),
            lines: Vec::new(),
            drift_nm_per_s: Vec::new(),
            common_step: changed(&step(given), &step(wanted)).flatten(),
            pitch_m: changed(&given.pitch_m, &wanted.pitch_m).map_or_else(Vec::new, |all| all.as_slice().to_vec()),
            youngs_modulus_pa: changed(&backbone.youngs_modulus_pa, &wanted_backbone.youngs_modulus_pa),
            segment_stiffness_ratio: list(&backbone.segment_stiffness_ratio, &wanted_backbone.segment_stiffness_ratio),
            precurvature_per_m: list(&backbone.precurvature_per_m, &wanted_backbone.precurvature_per_m),
            hole_radius_m: changed(&given.hole_radius_m, &wanted.hole_radius_m),
            gravity_m_per_s2: changed(&given.gravity_m_per_s2, &wanted.gravity_m_per_s2),
            tip_mass_kg: changed(&given.tip.mass_kg, &wanted.tip.mass_kg),
            tip_force_n: changed(&given.tip.force_n, &wanted.tip.force_n),
            markers: changed(&given.markers, &wanted.markers).flatten(),
            base_sensor: changed(&given.base_sensor, &wanted.base_sensor).flatten(),
        }
    }
}

/// The calibration line of a grating, `T = a·Δλ + b`, with its standard errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GratingLine {
    /// a, N/nm.
    pub newton_per_nm: f64,
    /// b, N.
    pub offset_n: f64,
    /// Standard error of a tension from one shift, N.
    pub standard_error_n: f64,
    /// Standard error of the line at the mean shift of its load steps, N.
    pub line_error_n: f64,
    /// Standard error of the slope, N/nm.
    pub slope_error_n_per_nm: f64,
    /// Mean shift of the load steps, nm.
    pub mean_shift_nm: f64,
}

/// Returns the text of a manipulator file with new values. Everything else stays unchanged to the byte, including a value that is set to itself.
/// `origin` names its source in error messages.
///
/// ```
/// use fric_tendon::edit::{ManipulatorEdit, rewrite};
/// let text = include_str!("../../../../examples/tendon-prototype.toml");
/// let edit = ManipulatorEdit { mu: vec![0.2], ..ManipulatorEdit::default() };
/// let edited = rewrite(text, "arm.toml", &edit)?;
/// assert_eq!(edited, text.replace("mu = 0.1753 ", "mu = 0.2 "));
/// # Ok::<(), fric_tendon::file::ManipulatorFileError>(())
/// ```
///
/// # Errors
/// Returns [`ManipulatorFileError::Invalid`] if the text is invalid before or with the new values.
pub fn rewrite(text: &str, origin: &str, edit: &ManipulatorEdit) -> Result<String, ManipulatorFileError> {
    ManipulatorFile::parse(text, origin)?;
    let mut text = text.to_owned();
    // An empty name denotes the document itself.
    let mut set = |table: &str, key: &str, value: Numbers<'_>| {
        toml_editor::set(&mut text, table, key, value).map_err(|problem| ManipulatorFileError::Invalid {
            origin: origin.to_owned(),
            line: None,
            problem,
        })
    };
    match edit.mu.as_slice() {
        [] => {}
        [one] => set("tendon", "mu", Numbers::One(*one))?,
        each => set("tendon", "mu", Numbers::List(each))?,
    }
    if let Some(sigma_n_per_m) = edit.sigma_n_per_m {
        set("tendon", "sigma_n_per_m", Numbers::One(sigma_n_per_m))?;
    }
    if !edit.lines.is_empty() {
        let column = |of: fn(&GratingLine) -> f64| edit.lines.iter().map(of).collect::<Vec<_>>();
        set("gratings", "newton_per_nm", Numbers::List(&column(|line| line.newton_per_nm)))?;
        set("gratings", "offset_n", Numbers::List(&column(|line| line.offset_n)))?;
        set("gratings", "standard_error_n", Numbers::List(&column(|line| line.standard_error_n)))?;
        set("gratings", "line_error_n", Numbers::List(&column(|line| line.line_error_n)))?;
        set("gratings", "slope_error_n_per_nm", Numbers::List(&column(|line| line.slope_error_n_per_nm)))?;
        set("gratings", "mean_shift_nm", Numbers::List(&column(|line| line.mean_shift_nm)))?;
    }
    if !edit.drift_nm_per_s.is_empty() {
        set("gratings", "drift_nm_per_s", Numbers::List(&edit.drift_nm_per_s))?;
    }
    if let Some([step_nm, from_s]) = edit.common_step {
        set("gratings", "common_step_nm", Numbers::One(step_nm))?;
        set("gratings", "common_step_s", Numbers::One(from_s))?;
    }
    let numbers = [
        ("backbone", "youngs_modulus_pa", edit.youngs_modulus_pa),
        ("", "hole_radius_m", edit.hole_radius_m),
        ("tip", "mass_kg", edit.tip_mass_kg),
        ("markers", "angle_rad", edit.markers.map(|markers| markers.angle_rad)),
        ("base_sensor", "gain", edit.base_sensor.map(|sensor| sensor.gain)),
        ("base_sensor", "offset_n", edit.base_sensor.map(|sensor| sensor.offset_n)),
        ("base_sensor", "lag_s", edit.base_sensor.map(|sensor| sensor.lag_s)),
    ];
    for (table, key, value) in numbers {
        if let Some(value) = value {
            set(table, key, Numbers::One(value))?;
        }
    }
    let vectors = [
        ("", "gravity_m_per_s2", edit.gravity_m_per_s2),
        ("tip", "force_n", edit.tip_force_n),
        ("markers", "offset_m", edit.markers.map(|markers| markers.offset_m)),
    ];
    for (table, key, value) in vectors {
        if let Some(value) = value {
            set(table, key, Numbers::List(&value))?;
        }
    }
    if !edit.pitch_m.is_empty() {
        set("", "pitch_m", Numbers::List(&edit.pitch_m))?;
    }
    for (key, values) in
        [("segment_stiffness_ratio", &edit.segment_stiffness_ratio), ("precurvature_per_m", &edit.precurvature_per_m)]
    {
        match values.as_slice() {
            [] => {}
            [one] => set("backbone", key, Numbers::One(*one))?,
            each => set("backbone", key, Numbers::List(each))?,
        }
    }
    ManipulatorFile::parse(&text, &format!("{origin} with the new values"))?;
    Ok(text)
}
