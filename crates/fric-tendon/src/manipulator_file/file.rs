//! The manipulator file, `format = "fric-continuum/1"`: converts TOML text to checked parameters.
//!
//! Two steps, as with the robot file ([`fric_core::robot::file`]): `serde` gives [`ManipulatorTables`], exactly what is written;
//! [`ManipulatorFile::parse`] checks them into [`ManipulatorParams`]. Every error names file, line and key, the value and
//! what is allowed, and for a misspelt key the nearest one there is. Needs the feature `manipulator-file`; not for the cycle.

use core::fmt;
use std::borrow::ToOwned;
use std::format;
use std::path::{Path, PathBuf};
use std::string::{String, ToString};
use std::vec::Vec;

use fric_core::robot::check;
use fric_core::robot::locate::{Line, Step, line_of, read_tables};
use fric_core::robot::read::{exactly, table, table_if_given};
use fric_core::text_file;
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::gratings::GratingsTable;
use super::measuring::{self, BaseSensorTable, MarkersTable};
use crate::params::{
    ManipulatorError, ManipulatorOptions, ManipulatorParams, Tendon, TendonOptions, rectangle_bending_stiffness_n_m2,
};

/// The only value of `format` that this version reads.
pub const FORMAT: &str = "fric-continuum/1";

/// Default presliding stiffness of a hole, N/m: friction of 0.05 N builds up within 2.5 μm.
pub const USUAL_SIGMA_N_PER_M: f64 = 20_000.0;

/// A manipulator file as written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ManipulatorTables {
    /// [`FORMAT`].
    pub format: String,
    /// Name of the manipulator.
    pub name: String,
    /// Number of disks without the base plate.
    pub disk_count: usize,
    /// Distance between the centres of neighbouring disks, m: one for all segments, or a list with one per segment, starting at the base plate.
    pub pitch_m: OneOrEach,
    /// Thickness of a disk, m.
    pub disk_thickness_m: f64,
    /// Radius of the circle of holes, m.
    pub hole_radius_m: f64,
    /// Mass of a disk, kg; default 0.
    #[serde(default)]
    pub disk_mass_kg: f64,
    /// Gravity in the plane of bending, base frame, m/s²; default none.
    #[serde(default, deserialize_with = "exactly")]
    pub gravity_m_per_s2: [f64; 2],
    /// The backbone.
    #[serde(deserialize_with = "table")]
    pub backbone: BackboneTable,
    /// The load on the last disk.
    #[serde(default, deserialize_with = "table")]
    pub tip: TipTable,
    /// The tendon on the side of +y and its holes.
    #[serde(deserialize_with = "table")]
    pub tendon: TendonTable,
    /// The tendon on the side of −y; like the first by default.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "table_if_given")]
    pub antagonist: Option<TendonTable>,
    /// The gratings of the first tendon.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "table_if_given")]
    pub gratings: Option<GratingsTable>,
    /// The frame in which the markers are measured; the base frame by default.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "table_if_given")]
    pub markers: Option<MarkersTable>,
    /// The tension sensor at the base; an ideal one by default.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "table_if_given")]
    pub base_sensor: Option<BaseSensorTable>,
}

/// `[backbone]`: a strip that bends about its wide side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BackboneTable {
    /// Width, m.
    pub width_m: f64,
    /// Thickness, m.
    pub thickness_m: f64,
    /// Young's modulus, Pa.
    pub youngs_modulus_pa: f64,
    /// Mass per length, kg/m; default 0.
    #[serde(default)]
    pub mass_kg_per_m: f64,
    /// Bending stiffness of a segment relative to that of the above numbers, 0.01…100: one for all, or a list; default 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub segment_stiffness_ratio: Option<OneOrEach>,
    /// Unloaded curvature, 1/m, towards the first tendon, at most 1 rad in the longest segment: one for all, or a list; default 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub precurvature_per_m: Option<OneOrEach>,
}

/// `[tip]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TipTable {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Force of constant direction, base frame, N.
    #[serde(deserialize_with = "exactly")]
    pub force_n: [f64; 2],
}

/// `[tendon]` and `[antagonist]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TendonTable {
    /// Friction coefficient: one for all holes, or a list with one per hole, starting at the base plate.
    pub mu: OneOrEach,
    /// Presliding stiffness of a hole, N/m: one for all, or a list. By default the tendon slides in one direction with Coulomb friction;
    /// [`Friction::History`](crate::Friction::History) then uses [`USUAL_SIGMA_N_PER_M`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma_n_per_m: Option<OneOrEach>,
    /// Axial stiffness E·A, N.
    pub axial_stiffness_n: f64,
    /// Tension capacity of the tendon, N.
    pub capacity_n: f64,
}

/// A number for all holes or segments, or a list with one per hole or segment.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OneOrEach {
    /// One number for all.
    One(f64),
    /// One number per hole or segment, starting at the base plate.
    Each(Vec<f64>),
}

impl OneOrEach {
    /// Returns the number or numbers.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        match self {
            Self::One(one) => core::slice::from_ref(one),
            Self::Each(each) => each,
        }
    }
}

/// Implemented by hand, because the error of the derived code names no position within the list.
impl<'de> Deserialize<'de> for OneOrEach {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Numbers;

        impl<'de> Visitor<'de> for Numbers {
            type Value = OneOrEach;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a number, or a list with one for each hole or segment")
            }

            fn visit_f64<E: de::Error>(self, one: f64) -> Result<OneOrEach, E> {
                Ok(OneOrEach::One(one))
            }

            #[expect(clippy::cast_precision_loss, reason = "as toml reads a whole number where a fraction may stand")]
            fn visit_i64<E: de::Error>(self, one: i64) -> Result<OneOrEach, E> {
                Ok(OneOrEach::One(one as f64))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<OneOrEach, A::Error> {
                let mut each = Vec::new();
                while let Some(number) = list.next_element::<f64>()? {
                    each.push(number);
                }
                Ok(OneOrEach::Each(each))
            }
        }

        deserializer.deserialize_any(Numbers)
    }
}

/// A valid manipulator file.
#[derive(Clone, Debug, PartialEq)]
pub struct ManipulatorFile {
    tables: ManipulatorTables,
    params: ManipulatorParams,
}

/// Errors of a manipulator file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ManipulatorFileError {
    /// The file cannot be read.
    #[error("cannot read the manipulator file {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The text is not a valid manipulator file.
    #[error("{origin}{}: {problem}", Line(*line))]
    Invalid {
        /// Source of the text.
        origin: String,
        /// Line, from 1, if it is known.
        line: Option<usize>,
        /// The problem, and what to do.
        problem: String,
    },
}

/// Errors of [`ManipulatorTables`]: the key and the problem.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{problem}")]
pub struct TablesError {
    path: Vec<Step>,
    problem: String,
}

impl TablesError {
    pub(super) fn new(path: Vec<Step>, problem: String) -> Self {
        Self { path, problem }
    }
}

impl ManipulatorFile {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// Returns a [`ManipulatorFileError`] if the file cannot be read or is invalid.
    pub fn read(path: &Path) -> Result<Self, ManipulatorFileError> {
        let text =
            text_file::read(path).map_err(|source| ManipulatorFileError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, &path.display().to_string())
    }

    /// Checks a text; `origin` names its source in error messages.
    ///
    /// # Errors
    /// Returns [`ManipulatorFileError::Invalid`] for the first problem.
    pub fn parse(text: &str, origin: &str) -> Result<Self, ManipulatorFileError> {
        let invalid = |line, problem: String| ManipulatorFileError::Invalid {
            origin: text_file::printable(origin),
            line,
            problem: text_file::printable(&problem),
        };
        let tables = read_tables(text, FORMAT).map_err(|(line, problem)| invalid(line, problem))?;
        Self::check(tables).map_err(|error| invalid(line_of(text, &error.path), error.problem))
    }

    /// Checks tables that come from elsewhere than a text.
    ///
    /// # Errors
    /// Returns a [`TablesError`] for the first problem.
    pub fn check(tables: ManipulatorTables) -> Result<Self, TablesError> {
        if tables.format != FORMAT {
            let problem = format!("`format` is \"{}\"; this version reads \"{FORMAT}\"", tables.format);
            return Err(TablesError { path: Vec::from([Step::Key("format")]), problem });
        }
        if let Some(problem) = text_file::name_problem(&tables.name) {
            return Err(TablesError { path: Vec::from([Step::Key("name")]), problem: format!("`name` {problem}") });
        }
        let BackboneTable { width_m, thickness_m, youngs_modulus_pa, mass_kg_per_m, .. } = tables.backbone;
        let lengths = [("width_m", width_m), ("thickness_m", thickness_m)].map(|(key, value)| (key, value, 1e-6, 1.0));
        let others = [("youngs_modulus_pa", youngs_modulus_pa, 1e5, 1e13), ("mass_kg_per_m", mass_kg_per_m, 0.0, 1e3)];
        for (key, value, min, max) in lengths.into_iter().chain(others) {
            check(key, value, min, max).map_err(|error| TablesError {
                path: Vec::from([Step::Key("backbone"), Step::Key(key)]),
                problem: error.to_string(),
            })?;
        }
        let tendon = tables.tendon.options();
        let stated = |list: &Option<OneOrEach>| list.as_ref().map_or_else(Vec::new, |all| all.as_slice().to_vec());
        let ratio = stated(&tables.backbone.segment_stiffness_ratio);
        let curvature_per_m = stated(&tables.backbone.precurvature_per_m);
        let params = ManipulatorParams::new(&ManipulatorOptions {
            disk_count: tables.disk_count,
            pitch_m: tables.pitch_m.as_slice(),
            disk_thickness_m: tables.disk_thickness_m,
            hole_radius_m: tables.hole_radius_m,
            bending_stiffness_n_m2: rectangle_bending_stiffness_n_m2(youngs_modulus_pa, width_m, thickness_m),
            segment_stiffness_ratio: if tables.backbone.segment_stiffness_ratio.is_some() { &ratio } else { &[1.0] },
            precurvature_per_m: if tables.backbone.precurvature_per_m.is_some() { &curvature_per_m } else { &[0.0] },
            disk_mass_kg: tables.disk_mass_kg,
            backbone_mass_kg_per_m: mass_kg_per_m,
            gravity_m_per_s2: tables.gravity_m_per_s2,
            tip_mass_kg: tables.tip.mass_kg,
            tip_force_n: tables.tip.force_n,
            tendons: [tendon, tables.antagonist.as_ref().map_or(tendon, TendonTable::options)],
        })
        .map_err(|error| locate(&error))?;
        if let Some(gratings) = &tables.gratings {
            gratings.check(tables.disk_count)?;
        }
        measuring::check(tables.markers.as_ref(), tables.base_sensor.as_ref())?;
        Ok(Self { tables, params })
    }

    /// Returns the checked parameters.
    #[must_use]
    pub fn params(&self) -> &ManipulatorParams {
        &self.params
    }

    /// Returns the content of the file as written.
    #[must_use]
    pub fn tables(&self) -> &ManipulatorTables {
        &self.tables
    }

    /// Returns the file as TOML text, without comments.
    ///
    /// # Errors
    /// A checked file causes no error; the signature is that of the serialiser.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(&self.tables)
    }
}

impl ManipulatorTables {
    /// Returns the length of each segment of a checked file, starting at the base plate, m.
    pub fn segment_pitch_m(&self) -> impl Iterator<Item = f64> {
        let stated = self.pitch_m.as_slice();
        (0..self.disk_count).filter_map(move |segment| stated.get(segment).or(stated.last()).copied())
    }

    /// Returns the length of the backbone of a checked file, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.segment_pitch_m().sum()
    }
}

impl TendonTable {
    fn options(&self) -> TendonOptions<'_> {
        TendonOptions {
            mu: self.mu.as_slice(),
            sigma_n_per_m: self.sigma_n_per_m.as_ref().map_or(&[USUAL_SIGMA_N_PER_M], OneOrEach::as_slice),
            axial_stiffness_n: self.axial_stiffness_n,
            capacity_n: self.capacity_n,
        }
    }
}

/// Returns the position of a refused parameter in the file, with the file's name for it.
fn locate(error: &ManipulatorError) -> TablesError {
    let mut path = Vec::new();
    let key = match (error.tendon, error.key) {
        (Some(tendon), key) => {
            path.push(Step::Key(if tendon == Tendon::Agonist { "tendon" } else { "antagonist" }));
            key
        }
        (None, key @ ("tip_mass_kg" | "tip_force_n")) => {
            path.push(Step::Key("tip"));
            if key == "tip_mass_kg" { "mass_kg" } else { "force_n" }
        }
        (None, key @ ("bending_stiffness_n_m2" | "segment_stiffness_ratio" | "precurvature_per_m")) => {
            path.push(Step::Key("backbone"));
            key
        }
        (None, key) => key,
    };
    path.push(Step::Key(key));
    path.extend(error.place.map(Step::Index));
    TablesError { path, problem: ManipulatorError { key, ..*error }.to_string() }
}
