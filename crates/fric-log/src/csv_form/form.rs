//! The form of a CSV file: where its rows begin, the separator, and the names of the columns.

use std::borrow::Cow;
use std::cmp::Reverse;
use std::io::Read;

use csv::{ByteRecord, Reader, ReaderBuilder, Trim};

use super::blanks::{BLANKS, SingleBlanks, TableText};
use super::number::{Decimals, clock_nanos, is_without_value};
use crate::units::are_units;

/// Possible separators, besides blanks.
const SEPARATORS: [u8; 3] = *b",;\t";
/// Marks a line that is not part of the table.
const COMMENT: u8 = b'#';
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
/// Number of lines that show where the table begins.
const MOST_LINES: usize = 256;

/// The form of a CSV file.
#[derive(Debug, Clone, PartialEq)]
pub struct Form {
    /// Between cells; a blank stands for one or more of them, or of tabs.
    pub separator: u8,
    /// Column names, in the order of the file.
    pub names: Vec<String>,
    /// The cells of the line under the names, if that has no numbers.
    pub units: Vec<String>,
    /// The cells of the first row.
    pub first_row: Vec<String>,
    /// Position of the first row, and its line, from 1.
    pub rows_at: u64,
    pub first_line: u64,
    /// Whether there are numbers in place of the names.
    pub lacks_header: bool,
    /// Whether the row under the header has as many cells, at least one of them a number.
    pub has_fitting_row: bool,
}

/// A line and its position.
#[derive(Clone, Copy)]
struct Line<'a> {
    text: &'a [u8],
    at: usize,
    /// Line number, from 1.
    number: u64,
}

impl Form {
    /// Determines the form of a file that begins with these bytes; `None` if there are only comments. A filled column without a name gets that of its place.
    pub fn find(beginning: &[u8]) -> Option<Self> {
        let mut form = Self::as_written(beginning)?;
        for (place, (name, cell)) in (1..).zip(form.names.iter_mut().zip(&form.first_row)) {
            if name.is_empty() && !cell.is_empty() {
                *name = format!("column {place}");
            }
        }
        Some(form)
    }

    fn as_written(beginning: &[u8]) -> Option<Self> {
        let mut separators = SEPARATORS.to_vec();
        let mut comment = None;
        let mut filled: Vec<Line<'_>> = Vec::new();
        for line in lines(beginning).filter(|line| !line.text.is_empty()) {
            match line.text {
                [COMMENT, text @ ..] if filled.is_empty() => comment = Some(text.trim_ascii()),
                [COMMENT, ..] => {}
                // The separator line of spreadsheets.
                [b's', b'e', b'p', b'=', separator] if filled.is_empty() => separators = vec![*separator],
                _ => filled.push(line),
            }
            if filled.len() == MOST_LINES {
                break;
            }
        }
        let titled = separators.iter().filter_map(|separator| Self::titled(&filled, *separator));
        // The first of those with equally many columns; `max_by_key` would take the last.
        let titled = titled.max_by_key(|form| (form.names.len(), Reverse(form.separator)));
        if titled.is_some() {
            return titled;
        }
        // Blanks stand in names, dates and remarks too.
        if separators == SEPARATORS {
            separators.push(BLANKS);
        }
        let by_blanks = || Self::titled(&filled, BLANKS).filter(|form| form.fits_all(&filled));
        let by_blanks = separators.contains(&BLANKS).then(by_blanks).flatten();
        by_blanks.or_else(|| Self::from_first_line(beginning, &filled, &separators, comment))
    }

    /// Whether all rows have as many cells as there are names, but for a last one that is cut off.
    fn fits_all(&self, filled: &[Line<'_>]) -> bool {
        let rows = filled.iter().filter(|line| line.number >= self.first_line);
        let counts: Vec<usize> = rows.map(|line| cells(line.text, self.separator).len()).collect();
        let count = self.names.len();
        counts.split_last().is_some_and(|(last, others)| {
            others.iter().all(|of_row| *of_row == count) && (*last == count || *last < count && !others.is_empty())
        })
    }

    /// Whether the first row has a date or a time of day in a column.
    pub fn has_date(&self, column: usize) -> bool {
        self.first_row.get(column).is_some_and(|cell| clock_nanos(cell).is_some())
    }

    /// Returns a reader of text that begins with the first row.
    pub fn reader<R: Read>(&self, rows: R) -> Reader<TableText<R>> {
        ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(self.separator)
            .comment(Some(COMMENT))
            .trim(Trim::All)
            .from_reader(TableText::new(rows, self.separator))
    }

    /// Finds the table by its most frequent number of cells, and above its first row of numbers the names, which lines about the recording may precede
    /// and a line of units may follow; `None` if no line above the rows has as many cells.
    fn titled(filled: &[Line<'_>], separator: u8) -> Option<Self> {
        let rows: Vec<Vec<String>> = filled.iter().map(|line| cells(line.text, separator)).collect();
        let frequency = |count: usize| rows.iter().filter(|row| row.len() == count).count();
        let counts = rows.iter().map(Vec::len).filter(|count| *count > 1);
        let count = counts.max_by_key(|count| (frequency(*count), *count))?;
        let of_table: Vec<&Vec<String>> = rows.iter().filter(|row| row.len() == count).collect();
        // A full row, not what stands above or below the rows.
        let usual = of_table.get(of_table.len() / 2..)?.iter().max_by_key(|row| number_count(row))?;
        // A row has text only where rows usually do, and at least half as many numbers.
        let is_row = |row: &Vec<String>| {
            let fits = |(cell, usual): (&String, &String)| !is_text(cell) || is_text(usual);
            let numbers = number_count(row);
            row.len() == count && numbers > 0 && 2 * numbers >= number_count(usual) && row.iter().zip(*usual).all(fits)
        };
        let first_row = rows.iter().position(is_row)?;
        let above = rows.get(..first_row)?.iter().rev().take_while(|row| row.len() == count).count();
        let start = first_row - above;
        let is_filled = |place: usize| {
            let is_value = |cell: &&String| !cell.is_empty() && !is_without_value(cell);
            rows.get(place).is_some_and(|row| 2 * row.iter().filter(is_value).count() >= count)
        };
        let numbers = |place: usize| rows.get(place).map(|row| number_count(row));
        // The last of the lines of text has the names, or that above a line of units. Names are no numbers, and a remark fills few cells.
        let last = (start..first_row).rev().min_by_key(|place| (!is_filled(*place), numbers(*place)))?;
        let has_units = last > start && is_filled(last - 1) && rows.get(last).is_some_and(|row| are_units(row));
        let title = if has_units { last - 1 } else { last };
        let has_numbers = |place: usize| rows.get(place).is_some_and(|row| number_count(row) > 0);
        let first = title + if has_numbers(title + 1) { 1 } else { 2 };
        let (names, line) = (rows.get(title)?.clone(), filled.get(first)?);
        let units = rows.get(title + 1).filter(|_| first > title + 1).cloned().unwrap_or_default();
        let (rows_at, first_line) = (line.at as u64, line.number);
        let first_row = rows.get(first)?.clone();
        Some(Self {
            separator,
            names,
            units,
            first_row,
            rows_at,
            first_line,
            lacks_header: false,
            has_fitting_row: true,
        })
    }

    /// Takes the first line for the names, or the last comment if that line has numbers.
    fn from_first_line(
        beginning: &[u8],
        filled: &[Line<'_>],
        separators: &[u8],
        comment: Option<&[u8]>,
    ) -> Option<Self> {
        let (header, row) = (filled.first()?, filled.get(1));
        // Numbers alone tell the separator best: with another one they are cut or joined.
        let likeness = |separator: &u8| {
            let header = cells(header.text, *separator);
            let count = header.len();
            let are_numbers = count > 1 && number_count(&header) == count;
            let fits = row.is_none_or(|row| cells(row.text, *separator).len() == count);
            (*separator != BLANKS || are_numbers).then_some((
                are_numbers,
                count > 1 && fits,
                count,
                Reverse(*separator),
            ))
        };
        let separator = separators.iter().copied().max_by_key(likeness)?;
        let mut names = cells(header.text, separator);
        let lacks_names = number_count(&names) == names.len();
        let commented =
            comment.map(|text| cells(text, separator)).filter(|other| lacks_names && other.len() == names.len());
        let lacks_header = lacks_names && commented.is_none();
        let first = if lacks_names { Some(header) } else { row };
        let first_row = first.map(|row| cells(row.text, separator)).unwrap_or_default();
        let has_fitting_row = first_row.len() == names.len() && first_row.len() > 1 && number_count(&first_row) > 0;
        if let Some(commented) = commented {
            names = commented;
        }
        let rows_at = if lacks_names { header.at } else { next_line(beginning, header.at) } as u64;
        let first_line = header.number + u64::from(!lacks_names);
        let units = Vec::new();
        Some(Self { separator, names, units, first_row, rows_at, first_line, lacks_header, has_fitting_row })
    }
}

/// Iterates over the lines of a file that begins with these bytes, trimmed.
fn lines(beginning: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let table = beginning.strip_prefix(BYTE_ORDER_MARK).unwrap_or(beginning);
    let mut at = beginning.len() - table.len();
    (1..).map_while(move |number| {
        let next = next_line(beginning, at);
        let text = beginning.get(at..next).filter(|text| !text.is_empty())?;
        Some(Line { text: text.trim_ascii(), at: std::mem::replace(&mut at, next), number })
    })
}

/// Returns the position of the next line; lines end with `\n`, `\r\n` or `\r`.
fn next_line(bytes: &[u8], at: usize) -> usize {
    let rest = bytes.get(at..).unwrap_or_default();
    let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
    end.map_or(bytes.len(), |end| at + end + if rest.get(end..end + 2) == Some(b"\r\n") { 2 } else { 1 })
}

/// Returns the cells of a line, unquoted and trimmed.
fn cells(line: &[u8], separator: u8) -> Vec<String> {
    let line = if separator == BLANKS { Cow::Owned(SingleBlanks::of(line)) } else { Cow::Borrowed(line) };
    let mut reader = ReaderBuilder::new().has_headers(false).delimiter(separator).from_reader(&*line);
    let mut record = ByteRecord::new();
    // Reading from memory cannot fail, and bytes are not decoded.
    let _ = reader.read_byte_record(&mut record);
    record.iter().map(|cell| unquoted(text_of(cell).trim()).to_owned()).collect()
}

/// Removes quotes from a name, which belong to it if a blank precedes them.
fn unquoted(name: &str) -> &str {
    name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name)
}

/// Whether a cell is neither empty nor a number or a time.
fn is_text(cell: &str) -> bool {
    Decimals::default().number(cell).is_none() && clock_nanos(cell).is_none()
}

/// Returns the number of cells with numbers or times.
fn number_count(cells: &[String]) -> usize {
    cells.iter().filter(|cell| !cell.is_empty() && !is_text(cell)).count()
}

/// Decodes bytes as UTF-8, else as Latin-1, which spreadsheets use for headers.
pub fn text_of(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes).map_or_else(|_| bytes.iter().copied().map(char::from).collect(), ToOwned::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_form_is_found_out() {
        let form = |text: &str| Form::find(text.as_bytes()).unwrap();
        let named = |text: &str| {
            let Form { separator, names, rows_at, first_line, .. } = form(text);
            (char::from(separator), names.join("|"), text[usize::try_from(rows_at).unwrap()..].to_owned(), first_line)
        };
        let expected = |separator, names: &str, rows: &str, line| (separator, names.to_owned(), rows.to_owned(), line);
        assert_eq!(named("time_s,a\n1,2\n"), expected(',', "time_s|a", "1,2\n", 2));
        assert_eq!(named("\u{feff}time_s;a\r\n1,5;2\r\n"), expected(';', "time_s|a", "1,5;2\r\n", 2));
        assert_eq!(named("# made by x, y\n\nt\ta, b\n1\t2\n"), expected('\t', "t|a, b", "1\t2\n", 4));
        assert_eq!(named("\"t [s]\",\"F; N\"\n1,2\n"), expected(',', "t [s]|F; N", "1,2\n", 2));
        assert_eq!(named("sep=;\nt;a\n1;2\n"), expected(';', "t|a", "1;2\n", 3));
        assert_eq!(named("# t a\n# t, a\n1,2\n"), expected(',', "t|a", "1,2\n", 3));
        for numbers in
            ["1,2\n3,4\n", "1;2\n3;4\n", "0,5;1,5\n0,6;1,6\n", "1\t2\n3\t4\n", "1  2,5\n3  4,5\n", "0.1 2 -3\n"]
        {
            assert!(form(numbers).lacks_header, "{numbers}");
        }
        assert!(form("t,a\n1,2\n").has_fitting_row && !form("run one, good\nrun two\n").has_fitting_row);
        assert_eq!(Form::find(b"# nothing\n\n"), None);
        assert_eq!(form("t,a\n").rows_at, 4);
        assert_eq!(named("t,a\r1,2\r3,4\r"), expected(',', "t|a", "1,2\r3,4\r", 2));
        // A row that is cut off, and rows that do not fit the header, leave the names where they are.
        assert_eq!(named("t,a\n1\n2,3\n4,5\n"), expected(',', "t|a", "1\n2,3\n4,5\n", 2));
        assert_eq!(named("t,a\n1,2,\n3,4,\n"), expected(',', "t|a", "1,2,\n3,4,\n", 2));
        // Blanks, if nothing else separates.
        let rows = "0,001 1,9  0\n0,002 1,9  -0,5\n";
        assert_eq!(
            named(&format!(" time position\t velocity\n{rows}")),
            expected(' ', "time|position|velocity", rows, 2)
        );
        assert_eq!(named("# t \"F [N]\"\n1 2\n"), expected(' ', "t|F [N]", "1 2\n", 2));
        assert_eq!(named("Force in N;t\n1;2\n3;4\n"), expected(';', "Force in N|t", "1;2\n3;4\n", 2));
        // A separator at the end of the lines makes an empty column, an index of rows a filled one.
        assert_eq!(form(";a;b;\nms;N;m;\n0;1;2;\n").names, ["column 1", "a", "b", ""]);
        assert_eq!(form("a b\n1 2\n3\n4 5\n").names, ["a b"]);
        // Channels named by numbers.
        assert_eq!(named("t;1;2\n0;5;6\n1;5;6\n"), expected(';', "t|1|2", "0;5;6\n1;5;6\n", 2));
    }

    #[test]
    fn lines_about_the_recording_and_a_line_of_units_are_not_rows() {
        let form = |text: &str| {
            let Form { separator, names, units, rows_at, first_line, lacks_header, .. } =
                Form::find(text.as_bytes()).unwrap();
            assert!(!lacks_header);
            let rows = text[usize::try_from(rows_at).unwrap()..].to_owned();
            (char::from(separator), names.join("|"), units.join("|"), rows, first_line)
        };
        let expected = |separator, names: &str, units: &str, rows: &str, line| {
            (separator, names.to_owned(), units.to_owned(), rows.to_owned(), line)
        };
        let rows = "0,001;5,3;1,2\n0,002;5,4;1,3\n";
        assert_eq!(
            form(&format!("Zeit;Kraft;Weg\ns;N;mm\n{rows}")),
            expected(';', "Zeit|Kraft|Weg", "s|N|mm", rows, 3)
        );
        let preamble = "Messung 7, Seil 3\nDatum;3.5.2024\nRate;1000\n\n";
        assert_eq!(form(&format!("{preamble}Zeit;F;l\n{rows}")), expected(';', "Zeit|F|l", "", rows, 6));
        // As spreadsheets pad them.
        let padded = "Operator;Smith;\nRate;1000;\n;;\n";
        assert_eq!(form(&format!("{padded}t;F;l\ns;N;m\n{rows}")), expected(';', "t|F|l", "s|N|m", rows, 6));
        // A date of the recording, and a rate with its unit.
        let dated = "03.05.2024 12:00:00;;\nRate;1000;Hz\n";
        assert_eq!(form(&format!("{dated}t;F;l\ns;N;m\n{rows}")), expected(';', "t|F|l", "s|N|m", rows, 5));
        // With as many cells as the table has, as a logger writes it.
        let named = "Prüfstand 3;Seil A;Datum\n";
        assert_eq!(form(&format!("{named}Zeit;F;l\n{rows}")), expected(';', "Zeit|F|l", "", rows, 3));
        assert_eq!(form(&format!("{named}Zeit;F;l\ns;Skt;m\n{rows}")), expected(';', "Zeit|F|l", "s|Skt|m", rows, 4));
        // The second line has names beside a unit.
        let channels = "Time;Analog 1;Analog 2\nms;Speed;Torque\n";
        assert_eq!(form(&format!("{channels}{rows}")), expected(';', "ms|Speed|Torque", "", rows, 3));
        // One row.
        let row = "0,001;5,3;1,2\n";
        assert_eq!(form(&format!("{padded}t;F;l\ns;N;m\n{row}")), expected(';', "t|F|l", "s|N|m", row, 6));
        // Rows without names, and with an event in some.
        let rows = "0,0.00,5.0,1.0,start\n1,0.01,5.1,1.0,\n2,0.02,5.2,1.0,\n";
        assert_eq!(
            form(&format!(",time_s,F,l,event\n{rows}")),
            expected(',', "column 1|time_s|F|l|event", "", rows, 2)
        );
        // Times that are dates, and text in every row.
        let rows = "2024-05-03 12:00:00.001\t5.3\tok\n2024-05-03 12:00:00.002\t5.4\tok\n";
        assert_eq!(form(&format!("a\tb\tc\n{rows}")), expected('\t', "a|b|c", "", rows, 2));
    }
}
