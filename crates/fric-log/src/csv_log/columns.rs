//! Assigns columns to signals.

use std::collections::BTreeMap;
use std::path::Path;

use fric_core::robot::file::{ColumnTable, POSE_COLUMNS, TIME_COLUMN, WRENCH_COLUMNS};

use super::CsvError;
use crate::csv_form::Form;
use crate::units::{Head, Unit, stated_unit};

/// A column to read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    /// Its index in the file.
    pub index: usize,
    pub table: ColumnTable,
}

impl Column {
    /// Converts a number of the column to a value.
    pub fn value(&self, number: f64) -> f64 {
        let ColumnTable { factor, offset, .. } = self.table;
        number * factor + offset
    }

    /// Whether its numbers are its values, for no factor is given.
    pub fn has_plain_values(&self) -> bool {
        self.table.factor.to_bits() == 1.0_f64.to_bits()
    }

    /// Returns the power of ten that converts the times of this column to nanoseconds, if a power of ten suffices.
    pub fn nanos_exponent(&self) -> Option<u32> {
        let units = [(1.0, 9), (1e-3, 6), (1e-6, 3), (1e-9, 0)];
        let is_unit = |(factor, _): &(f64, u32)| factor.to_bits() == self.table.factor.to_bits();
        units.into_iter().find(is_unit).filter(|_| self.table.offset == 0.0).map(|(_, exponent)| exponent)
    }
}

/// The columns of a robot's signals in a file.
#[derive(Debug, Clone)]
pub(super) struct Columns {
    pub time: Column,
    /// Force columns, by cable.
    pub force_n: Vec<Option<Column>>,
    pub length_m: Vec<Option<Column>>,
    pub speed_m_per_s: Vec<Option<Column>>,
    pub reference_n: Vec<Option<Column>>,
    /// Complete or empty.
    pub pose: Vec<Option<Column>>,
    pub wrench: Vec<Option<Column>>,
}

/// The signals to find in a file.
pub(super) struct Wanted<'a> {
    pub columns: &'a BTreeMap<String, ColumnTable>,
    pub cable_names: &'a [String],
    pub reference: bool,
    pub pose: bool,
    pub wrench: bool,
}

impl Columns {
    /// Finds the columns of a file, and adds remarks about incomplete signals.
    pub fn find(path: &Path, form: &Form, wanted: &Wanted<'_>, remarks: &mut Vec<String>) -> Result<Self, CsvError> {
        let finder = Finder { path, names: &form.names, columns: wanted.columns };
        let of_cables = |quantity: &str| {
            let keys = wanted.cable_names.iter().map(|name| format!("{name}.{quantity}"));
            keys.map(|key| finder.find(&key)).collect::<Result<Vec<_>, _>>()
        };
        let time = finder.find(TIME_COLUMN)?.ok_or_else(|| finder.missing(TIME_COLUMN))?;
        let (force_n, length_m) = (of_cables("force_n")?, of_cables("length_m")?);
        if let Some((quantity, cable)) = incomplete(wanted.cable_names, &force_n, &length_m) {
            return Err(finder.missing(&format!("{cable}.{quantity}")));
        }
        for (quantity, columns) in [("force_n", &force_n), ("length_m", &length_m)] {
            let lacking = wanted.cable_names.iter().zip(columns).filter(|(_, column)| column.is_none());
            let lacking: Vec<String> = lacking.map(|(name, _)| format!("`{name}.{quantity}`")).collect();
            if !lacking.is_empty() {
                let (path, lacking) = (path.display(), lacking.join(", "));
                remarks.push(format!("`{path}` has no column {lacking}: nothing is compensated for these cables"));
            }
        }
        let mut group = |keys: &[&str], is_wanted: bool| -> Result<Vec<Option<Column>>, CsvError> {
            if !is_wanted {
                return Ok(Vec::new());
            }
            let found = keys.iter().map(|key| finder.find(key)).collect::<Result<Vec<_>, _>>()?;
            let lacking: Vec<_> = keys.iter().zip(&found).filter(|(_, column)| column.is_none()).collect();
            let Some((first, _)) = lacking.first() else { return Ok(found) };
            if lacking.len() < keys.len() {
                let path = path.display();
                remarks.push(format!(
                    "`{path}` has no column `{first}`, without which the others of its kind are not used"
                ));
            }
            Ok(Vec::new())
        };
        let pose = group(&POSE_COLUMNS, wanted.pose)?;
        let wrench = group(&WRENCH_COLUMNS, wanted.wrench)?;
        let speed_m_per_s = of_cables("speed_m_per_s")?;
        let reference_n = if wanted.reference { of_cables("reference_n")? } else { Vec::new() };
        Ok(Self { time, force_n, length_m, speed_m_per_s, reference_n, pose, wrench })
    }

    /// Returns a remark about columns that are in other units by the line of units or their names, but have no factor.
    pub fn units_remark(&self, path: &Path, form: &Form) -> Option<String> {
        let Self { time, force_n, length_m, speed_m_per_s, reference_n, pose, wrench } = self;
        let groups = [force_n, length_m, speed_m_per_s, reference_n, pose, wrench];
        // A date is in no unit, whatever its column is called.
        let time = Some(time).filter(|time| !form.has_date(time.index));
        let other_unit = |column: &Column| {
            let name = &column.table.column;
            let stated = form.units.get(column.index).and_then(|cell| stated_unit(cell));
            let unit = match stated {
                Some(stated) => Some(stated).filter(|unit| Unit::of(unit).is_none_or(|of| of.is_other_than_ours(unit))),
                // What is in brackets and not known may be no unit.
                None => Head::of(name).unit.filter(|unit| Unit::of(unit).is_some_and(|of| of.is_other_than_ours(unit))),
            };
            unit.filter(|_| column.has_plain_values()).map(|unit| format!("`{name}` is in {unit}"))
        };
        let all: Vec<String> =
            time.into_iter().chain(groups.into_iter().flatten().flatten()).filter_map(other_unit).collect();
        (!all.is_empty()).then(|| {
            let (path, all) = (path.display(), all.join(", "));
            format!(
                "`{path}`: by the header {all}, which is not applied; state the `factor` under `[log.columns]` in the robot file"
            )
        })
    }
}

/// Returns the first missing column if no cable has both force and length.
fn incomplete<'a>(
    names: &'a [String],
    force_n: &[Option<Column>],
    length_m: &[Option<Column>],
) -> Option<(&'static str, &'a str)> {
    let cables = || names.iter().zip(force_n).zip(length_m);
    if cables().any(|((_, force), length)| force.is_some() && length.is_some()) {
        return None;
    }
    // A cable that has one of the two is preferred.
    let begun = cables().find(|((_, force), length)| force.is_some() || length.is_some());
    let ((name, force), _) = begun.or_else(|| cables().next())?;
    Some((if force.is_some() { "length_m" } else { "force_n" }, name.as_str()))
}

struct Finder<'a> {
    path: &'a Path,
    names: &'a [String],
    columns: &'a BTreeMap<String, ColumnTable>,
}

impl Finder<'_> {
    /// Returns the column of a signal; one that the robot file names must exist.
    fn find(&self, key: &str) -> Result<Option<Column>, CsvError> {
        let stated = self.columns.get(key);
        let table = stated.cloned().unwrap_or_else(|| ColumnTable::plain(key));
        let wanted = table.column.trim();
        let mut indices = (0..).zip(self.names).filter(|(_, name)| *name == wanted).map(|(index, _)| index);
        let (first, second) = (indices.next(), indices.next());
        match (first, second) {
            (Some(_), Some(_)) => Err(CsvError::Repeated { path: self.path.to_owned(), column: wanted.to_owned() }),
            (Some(index), None) => Ok(Some(Column { index, table })),
            (None, _) if stated.is_some() => Err(CsvError::Misnamed {
                path: self.path.to_owned(),
                key: key.to_owned(),
                column: wanted.to_owned(),
                columns: self.names.to_vec(),
            }),
            (None, _) => Ok(None),
        }
    }

    fn missing(&self, wanted: &str) -> CsvError {
        CsvError::Missing { path: self.path.to_owned(), wanted: wanted.to_owned(), columns: self.names.to_vec() }
    }
}
