//! CSV logs: a header, and one row of numbers per time.
//!
//! The following is detected automatically: comma, semicolon, tab or blanks as separator, decimal points or commas, a byte order mark, quotes, lines starting
//! with `#`, a header in one of these, lines about the recording above the header, and a line of units under it. Empty cells and those that say that
//! there is no value (`nan`, `NA`, `---`) are gaps of their signal. Columns are named like the keys of
//! [`ColumnTable`](fric_core::robot::file::ColumnTable), or as the robot file states. A row with too many or too few cells, or without a time, is
//! left out and counted; text in place of a number is an error. The last line counts only if it has a line end, because its last number may be
//! incomplete.
//!
//! Rows are read one after the other, and memory does not grow with the log. Several files are the parts of one log, in the order of their first
//! times.

mod columns;
mod error;
mod units;

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Take};
use std::path::{Path, PathBuf};

use csv::{ByteRecord, Reader};

pub use self::error::CsvError;
pub use self::units::GREAT_INTERVAL_S;

use self::columns::{Column, Columns, Wanted};
use self::units::{Quantity, TimeUnit, Units};
use crate::csv_form::{Decimals, Form, TableText, clock_nanos, is_without_value, scaled, text_of};
use crate::signals::{Role, SignalPaths};

/// Number of bytes that contain the header and enough rows to tell where the table begins.
const BEGINNING_BYTES: u64 = 1 << 18;
/// Greatest likely time in seconds: the year 2100, counted from 1970.
const GREATEST_TIME_S: f64 = 4.1e9;
/// Power of ten from seconds to nanoseconds. A date or a time of day is in seconds: a factor does not go with it.
const SECONDS_EXPONENT: u32 = 9;
/// Greatest length of a line, bytes: thousands of signals.
const LINE_BYTES: usize = 4 << 20;
/// Number of bytes that are searched for the last line end.
const ENDING_BYTES: u64 = 1 << 20;

/// One or several CSV files, read as one log.
#[derive(Debug)]
pub struct CsvLog {
    files: Vec<CsvFile>,
    state: State,
    /// Index of the present file, and the reading position.
    current: usize,
    bytes_read: u64,
    decimals: Decimals,
    units: Units,
    row: CsvRow,
    record: ByteRecord,
    row_count: u64,
    unusable_count: u64,
    first_problem: Option<String>,
    remarks: Vec<String>,
}

/// One of the files.
#[derive(Debug)]
struct CsvFile {
    path: PathBuf,
    file: File,
    len: u64,
    /// End of its last complete line.
    end: u64,
    form: Form,
}

#[derive(Debug)]
enum State {
    /// Nothing has been read yet.
    Open,
    Reading(Box<(Columns, Rows)>),
    Ended,
}

/// A reader of the rows of a file.
type Rows = Reader<TableText<Lines>>;

/// Rows whose lines are of bounded length, because each is held in memory.
#[derive(Debug)]
struct Lines {
    rows: Take<File>,
    /// Bytes since the last line end.
    line_bytes: usize,
}

impl Read for Lines {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.rows.read(buffer)?;
        let end = buffer.get(..count).and_then(|bytes| bytes.iter().rposition(|byte| *byte == b'\n'));
        self.line_bytes = end.map_or(self.line_bytes + count, |end| count - end);
        if self.line_bytes > LINE_BYTES { Err(io::ErrorKind::InvalidData.into()) } else { Ok(count) }
    }
}

impl CsvFile {
    /// Returns a reader of the rows from the first one on.
    fn rows(&self) -> Result<Rows, CsvError> {
        let Self { path, file, end, form, .. } = self;
        let refused = |source| CsvError::Read { path: path.clone(), source };
        let mut rows = file.try_clone().map_err(refused)?;
        rows.seek(SeekFrom::Start(form.rows_at)).map_err(refused)?;
        Ok(form.reader(Lines { rows: rows.take(end.saturating_sub(form.rows_at)), line_bytes: 0 }))
    }

    fn refusal(&self, error: csv::Error) -> CsvError {
        let path = self.path.clone();
        match error.into_kind() {
            csv::ErrorKind::Io(source) if source.kind() == io::ErrorKind::InvalidData => {
                CsvError::LongLine { path, most_bytes: LINE_BYTES }
            }
            csv::ErrorKind::Io(source) => CsvError::Read { path, source },
            other => CsvError::Read { path, source: io::Error::other(format!("{other:?}")) },
        }
    }
}

/// A row, in the robot's order.
#[derive(Debug, Default)]
pub(crate) struct CsvRow {
    pub stamp_nanos: i64,
    /// Values by role, except length and speed, which follow the force; empty if the row has none.
    values: [Vec<f64>; 6],
}

impl CsvRow {
    /// Returns the values of a signal: force, length and, if the file has it, speed of each cable; reference of each cable; position and orientation;
    /// force and torque. `None` if the row has none.
    pub fn values(&self, role: Role) -> Option<&[f64]> {
        Some(self.values[role as usize].as_slice()).filter(|values| !values.is_empty())
    }
}

impl CsvLog {
    /// Opens a non-empty file; `None` if it does not look like CSV.
    pub(crate) fn open(path: &Path, mut file: File, len: u64) -> Result<Option<Self>, CsvError> {
        let refused = |source| CsvError::Read { path: path.to_owned(), source };
        let mut beginning = Vec::new();
        file.by_ref().take(BEGINNING_BYTES).read_to_end(&mut beginning).map_err(refused)?;
        // What a power failure leaves of the last rows is zeros.
        beginning.truncate(beginning.len() - beginning.iter().rev().take_while(|byte| **byte == 0).count());
        let is_named =
            path.extension().is_some_and(|it| it.eq_ignore_ascii_case("csv") || it.eq_ignore_ascii_case("tsv"));
        if beginning.starts_with(b"\xff\xfe") || beginning.starts_with(b"\xfe\xff") {
            return if is_named { Err(CsvError::NotUtf8 { path: path.to_owned() }) } else { Ok(None) };
        }
        let is_text = !beginning.iter().any(|byte| byte.is_ascii_control() && !byte.is_ascii_whitespace());
        let Some(form) = Form::find(&beginning).filter(|form| is_text && (is_named || form.has_fitting_row)) else {
            return if is_named && is_text { Err(CsvError::NoRow { path: path.to_owned() }) } else { Ok(None) };
        };
        if form.lacks_header {
            return Err(CsvError::NoHeader { path: path.to_owned(), line: form.first_line });
        }
        if let [name] = form.names.as_slice() {
            return Err(CsvError::OneColumn { path: path.to_owned(), name: name.clone() });
        }
        if len > BEGINNING_BYTES && form.rows_at >= BEGINNING_BYTES {
            return Err(CsvError::LongHeader { path: path.to_owned(), most_bytes: BEGINNING_BYTES });
        }
        let end = last_line_end(&mut file, len).map_err(refused)?.max(form.rows_at);
        let cut = (end < len).then(|| {
            let path = path.display();
            format!(
                "`{path}` is cut off: its last line has no line end and is left out; if that line is whole, put a line \
                     end behind it"
            )
        });
        Ok(Some(Self {
            files: vec![CsvFile { path: path.to_owned(), file, len, end, form }],
            state: State::Open,
            current: 0,
            bytes_read: 0,
            decimals: Decimals::default(),
            units: Units::default(),
            row: CsvRow::default(),
            record: ByteRecord::new(),
            row_count: 0,
            unusable_count: 0,
            first_problem: None,
            remarks: cut.into_iter().collect(),
        }))
    }

    /// Appends the files of another log.
    pub(crate) fn join(&mut self, other: Self) {
        self.files.extend(other.files);
        self.remarks.extend(other.remarks);
    }

    /// Returns the column names of the first file.
    #[must_use]
    pub fn column_names(&self) -> &[String] {
        self.files.first().map_or(&[], |file| file.form.names.as_slice())
    }

    /// Returns the line of units under the names in the first file; empty if there is none.
    pub(crate) fn column_units(&self) -> &[String] {
        self.files.first().map_or(&[], |file| file.form.units.as_slice())
    }

    /// Returns of each column of the first file whether its first row has a date or a time of day there.
    pub(crate) fn dated_columns(&self) -> Vec<bool> {
        let has_date = |file: &CsvFile| (0..file.form.names.len()).map(|column| file.form.has_date(column)).collect();
        self.files.first().map(has_date).unwrap_or_default()
    }

    /// Returns of each column of the first file whether all its rows say the same; of one row that is unknown, and false.
    pub(crate) fn unchanging_columns(&self) -> Result<Vec<bool>, CsvError> {
        let Some(file) = self.files.first() else { return Ok(Vec::new()) };
        let (mut rows, mut row) = (file.rows()?, ByteRecord::new());
        // The first value of each column, and whether no other has followed.
        let mut columns: Vec<(Vec<u8>, bool)> = vec![(Vec::new(), true); file.form.names.len()];
        let mut row_count = 0_u64;
        while columns.iter().any(|(_, is_same)| *is_same)
            && rows.read_byte_record(&mut row).map_err(|error| file.refusal(error))?
        {
            row_count += 1;
            for ((first, is_same), cell) in columns.iter_mut().zip(&row).filter(|(_, cell)| !cell.is_empty()) {
                if first.is_empty() {
                    first.extend_from_slice(cell);
                }
                *is_same &= first == cell;
            }
        }
        Ok(columns.into_iter().map(|(_, is_same)| is_same && row_count > 1).collect())
    }

    /// Returns the bytes read so far, and the total.
    pub(crate) fn progress(&self) -> (u64, u64) {
        (self.bytes_read, self.files.iter().map(|file| file.len).sum())
    }

    /// Returns warnings about anything unusual, complete when all rows have been read.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut warnings = self.remarks.clone();
        if let Some(problem) = &self.first_problem {
            let count = self.unusable_count;
            let rows = if count == 1 { "1 row is".to_owned() } else { format!("{count} rows are") };
            warnings.push(format!("{rows} left out: {problem}"));
        }
        warnings.extend(self.units.warnings());
        warnings
    }

    /// Returns the names of a signal's columns in the first file; empty if there are none.
    pub(crate) fn columns_of(&self, role: Role) -> Vec<&str> {
        let State::Reading(reading) = &self.state else { return Vec::new() };
        let columns = &reading.0;
        let groups: &[&[Option<Column>]] = match role {
            Role::Cable => &[&columns.force_n, &columns.length_m, &columns.speed_m_per_s],
            Role::Length | Role::Speed => &[],
            Role::Reference => &[&columns.reference_n],
            Role::Pose => &[&columns.pose],
            Role::Wrench => &[&columns.wrench],
        };
        groups.iter().flat_map(|group| group.iter().flatten()).map(|column| column.table.column.as_str()).collect()
    }

    /// Returns the next row for a robot with cables of these names; `None` at the end.
    pub(crate) fn next_row(&mut self, names: &[String], paths: &SignalPaths) -> Result<Option<&CsvRow>, CsvError> {
        let wanted = Wanted {
            columns: paths.columns(),
            cable_names: names,
            reference: paths.get(Role::Reference).is_some(),
            pose: paths.get(Role::Pose).is_some(),
            wrench: paths.get(Role::Wrench).is_some(),
        };
        loop {
            match &self.state {
                State::Open => {
                    if self.files.len() > 1 {
                        self.sort(&wanted)?;
                    }
                    self.start(&wanted)?;
                }
                State::Reading(_) => {
                    if self.read_row()? {
                        return Ok(Some(&self.row));
                    }
                    if self.current + 1 < self.files.len() {
                        self.current += 1;
                        self.start(&wanted)?;
                    } else {
                        return self.end().map(|()| None);
                    }
                }
                State::Ended => return Ok(None),
            }
        }
    }

    /// Sorts the files by their first times.
    fn sort(&mut self, wanted: &Wanted<'_>) -> Result<(), CsvError> {
        let mut starts = Vec::new();
        for place in 0..self.files.len() {
            self.current = place;
            self.start(wanted)?;
            starts.push(if self.read_row()? { self.row.stamp_nanos } else { i64::MAX });
        }
        let mut files: Vec<_> = starts.into_iter().zip(std::mem::take(&mut self.files)).collect();
        files.sort_by_key(|(start, _)| *start);
        self.files = files.into_iter().map(|(_, file)| file).collect();
        (self.current, self.row_count, self.unusable_count, self.first_problem) = (0, 0, 0, None);
        (self.units, self.decimals) = (Units::default(), Decimals::default());
        self.remarks.dedup();
        Ok(())
    }

    /// Starts the current file.
    fn start(&mut self, wanted: &Wanted<'_>) -> Result<(), CsvError> {
        let Some(file) = self.files.get(self.current) else { return Ok(()) };
        let CsvFile { path, form, .. } = file;
        let mut remarks = Vec::new();
        let columns = Columns::find(path, form, wanted, &mut remarks)?;
        remarks.extend(columns.units_remark(path, form));
        remarks.retain(|remark| !self.remarks.contains(remark));
        self.remarks.extend(remarks);
        self.units.begin_file();
        self.state = State::Reading(Box::new((columns, file.rows()?)));
        Ok(())
    }

    /// Reads the next usable row of the current file. Returns false at its end.
    fn read_row(&mut self) -> Result<bool, CsvError> {
        let State::Reading(reading) = &mut self.state else { return Ok(false) };
        let (columns, reader) = &mut **reading;
        let Some(file) = self.files.get(self.current) else { return Ok(false) };
        let CsvFile { path, form, .. } = file;
        let before: u64 = self.files.iter().take(self.current).map(|file| file.len).sum();
        loop {
            let has_row = reader.read_byte_record(&mut self.record).map_err(|error| file.refusal(error))?;
            self.bytes_read = before + form.rows_at + reader.position().byte();
            if !has_row {
                return Ok(false);
            }
            let line = form.first_line - 1 + self.record.position().map_or(0, csv::Position::line);
            let mut cells = Cells { record: &self.record, decimals: &mut self.decimals, path, line };
            let problem = if self.record.len() == form.names.len() {
                match cells.stamp_nanos(&columns.time)? {
                    Some(stamp_nanos) => {
                        self.row.stamp_nanos = stamp_nanos;
                        cells.fill(columns, &mut self.row, &mut self.units)?;
                        self.units.compare(stamp_nanos, &self.row, columns.force_n.len());
                        // A date needs no unit.
                        if !cells.text(&columns.time).contains(&b':') {
                            self.units.add_stamp(stamp_nanos, columns.time.has_plain_values());
                        }
                        self.row_count += 1;
                        return Ok(true);
                    }
                    None => format!("line {line} has no time in column `{}`", columns.time.table.column),
                }
            } else {
                format!("line {line} has {} cells under a header of {}", self.record.len(), form.names.len())
            };
            self.unusable_count += 1;
            self.first_problem.get_or_insert_with(|| format!("{problem} (`{}`)", path.display()));
        }
    }

    fn end(&mut self) -> Result<(), CsvError> {
        self.bytes_read = self.progress().1;
        let path = || self.files.first().map(|file| file.path.clone()).unwrap_or_default();
        if self.row_count > 0 {
            return Ok(());
        }
        self.state = State::Ended;
        Err(match self.first_problem.clone() {
            Some(problem) => CsvError::NoUsableRow { path: path(), problem },
            None => CsvError::NoRow { path: path() },
        })
    }

    /// Returns the error for rows without any number for a cable.
    pub(crate) fn without_numbers(&self) -> CsvError {
        CsvError::NoNumber { path: self.files.first().map(|file| file.path.clone()).unwrap_or_default() }
    }
}

/// The cells of a row.
struct Cells<'a> {
    record: &'a ByteRecord,
    decimals: &'a mut Decimals,
    path: &'a Path,
    line: u64,
}

impl<'a> Cells<'a> {
    fn text(&self, column: &Column) -> &'a [u8] {
        let record: &'a ByteRecord = self.record;
        record.get(column.index).unwrap_or_default()
    }

    fn wrong(&self, column: &Column) -> CsvError {
        CsvError::Cell {
            path: self.path.to_owned(),
            line: self.line,
            column: column.table.column.clone(),
            text: text_of(self.text(column)),
        }
    }

    fn number(&mut self, column: &Column) -> Result<f64, CsvError> {
        let text = std::str::from_utf8(self.text(column)).map_err(|_| self.wrong(column))?;
        let number = self.decimals.number(text).or_else(|| is_without_value(text).then_some(f64::NAN));
        number.ok_or_else(|| self.wrong(column))
    }

    /// Returns the time; `None` if there is none.
    fn stamp_nanos(&mut self, column: &Column) -> Result<Option<i64>, CsvError> {
        let exponent = column.nanos_exponent();
        if let Ok(text) = std::str::from_utf8(self.text(column)) {
            if let Some(nanos) = exponent.and_then(|exponent| scaled(text, exponent)) {
                return Ok(Some(nanos));
            }
            if let Some(nanos) = clock_nanos(text) {
                return match exponent {
                    Some(SECONDS_EXPONENT) => Ok(Some(nanos)),
                    _ => Err(CsvError::DateWithFactor {
                        path: self.path.to_owned(),
                        line: self.line,
                        column: column.table.column.clone(),
                        text: text.to_owned(),
                    }),
                };
            }
        }
        let nanos = column.value(self.number(column)?) * 1e9;
        if nanos.is_nan() {
            return Ok(None);
        }
        if nanos.is_infinite() {
            return Err(self.wrong(column));
        }
        #[expect(clippy::cast_possible_truncation, reason = "checked to be within 292 years")]
        let stamp_nanos = (nanos.abs() < 9.2e18).then_some(nanos.round() as i64);
        stamp_nanos.map(Some).ok_or_else(|| CsvError::Time {
            path: self.path.to_owned(),
            line: self.line,
            column: column.table.column.clone(),
            text: text_of(self.text(column)),
            unit: TimeUnit::of(nanos * 1e-9, GREATEST_TIME_S).filter(|_| column.has_plain_values()),
        })
    }

    /// Fills in the values of a row. A signal without any known value, or an incomplete pose or wrench, is left empty.
    fn fill(&mut self, columns: &Columns, row: &mut CsvRow, units: &mut Units) -> Result<(), CsvError> {
        let Columns { force_n, length_m, speed_m_per_s, reference_n, pose, wrench, .. } = columns;
        let has_speed = speed_m_per_s.iter().any(Option::is_some);
        let speed: &[Option<Column>] = if has_speed { speed_m_per_s } else { &[] };
        let (position, orientation) = pose.split_at(pose.len().min(3));
        let mut place = 0;
        for (role, groups) in [
            (
                Role::Cable,
                &[
                    (Some(Quantity::Force), &**force_n),
                    (Some(Quantity::Length), length_m),
                    (Some(Quantity::Speed), speed),
                ][..],
            ),
            (Role::Reference, &[(Some(Quantity::Force), &**reference_n)]),
            (Role::Pose, &[(Some(Quantity::Position), position), (None, orientation)]),
            (Role::Wrench, &[(None, &**wrench)]),
        ] {
            let values = &mut row.values[role as usize];
            values.clear();
            for (quantity, columns) in groups {
                for (cable, column) in columns.iter().enumerate() {
                    let Some(column) = column else {
                        values.push(f64::NAN);
                        continue;
                    };
                    let value = column.value(self.number(column)?);
                    if let Some(quantity) = quantity {
                        // The offset says nothing about the unit of the column.
                        let without_offset = value - column.table.offset;
                        units.add(place, (role, *quantity, cable), &column.table.column, without_offset);
                        place += 1;
                    }
                    values.push(value);
                }
            }
            let mut numbers = values.iter().map(|value| !value.is_nan());
            let is_known =
                if matches!(role, Role::Pose | Role::Wrench) { numbers.all(|it| it) } else { numbers.any(|it| it) };
            if !is_known {
                values.clear();
            } else if role == Role::Pose {
                units.add_pose(values);
            }
        }
        Ok(())
    }
}

/// Returns the end of the last complete line.
fn last_line_end(file: &mut File, len: u64) -> io::Result<u64> {
    let from = len.saturating_sub(ENDING_BYTES);
    file.seek(SeekFrom::Start(from))?;
    let mut ending = Vec::new();
    file.take(ENDING_BYTES).read_to_end(&mut ending)?;
    let end = ending.iter().rposition(|byte| matches!(byte, b'\n' | b'\r')).map_or(0, |place| place + 1);
    // Blanks after it are not a line.
    let is_blank = ending.get(end..).unwrap_or_default().iter().all(u8::is_ascii_whitespace);
    Ok(if is_blank { len } else { from + end as u64 })
}
