//! The form of a CSV file: where its rows begin, the separator, and the names of the columns.

use csv::{ByteRecord, ReaderBuilder};

use super::number::Decimals;

/// Possible separators.
const SEPARATORS: [u8; 3] = *b",;\t";
/// Marks a line that is not part of the table.
pub const COMMENT: u8 = b'#';
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The form of a CSV file.
#[derive(Debug, Clone, PartialEq)]
pub struct Form {
    pub separator: u8,
    /// Column names, in the order of the file.
    pub names: Vec<String>,
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
    /// Determines the form of a file that begins with these bytes; `None` if there are only comments.
    pub fn find(beginning: &[u8]) -> Option<Self> {
        let table = beginning.strip_prefix(BYTE_ORDER_MARK).unwrap_or(beginning);
        let mut at = beginning.len() - table.len();
        let mut lines = Vec::new();
        for number in 1.. {
            let next = next_line(beginning, at);
            let Some(text) = beginning.get(at..next).filter(|text| !text.is_empty()) else { break };
            lines.push(Line { text: text.trim_ascii(), at, number });
            at = next;
        }
        let mut separators = SEPARATORS.to_vec();
        let mut comment = None;
        let mut filled = lines.iter().filter(|line| !line.text.is_empty());
        let header = loop {
            let line = filled.next()?;
            match line.text {
                [COMMENT, text @ ..] => comment = Some(text.trim_ascii()),
                // The separator line of spreadsheets.
                [b's', b'e', b'p', b'=', separator] => separators = vec![*separator],
                _ => break line,
            }
        };
        let row = filled.find(|line| !line.text.starts_with(&[COMMENT]));
        let separator = separators.iter().copied().max_by_key(|separator| {
            let count = cells(header.text, *separator).len();
            let fits = row.is_none_or(|row| cells(row.text, *separator).len() == count);
            // The first of equal ones; `max_by_key` would take the last.
            (count > 1 && fits, count, std::cmp::Reverse(*separator))
        })?;
        let mut names = cells(header.text, separator);
        let lacks_names = number_count(&names) == names.len();
        let commented =
            comment.map(|text| cells(text, separator)).filter(|other| lacks_names && other.len() == names.len());
        let lacks_header = lacks_names && commented.is_none();
        let first = if lacks_names { Some(header) } else { row };
        let has_fitting_row = first.is_some_and(|row| {
            let cells = cells(row.text, separator);
            cells.len() == names.len() && cells.len() > 1 && number_count(&cells) > 0
        });
        if let Some(commented) = commented {
            names = commented;
        }
        let rows_at = if lacks_names { header.at } else { next_line(beginning, header.at) };
        let first_line = header.number + u64::from(!lacks_names);
        Some(Self { separator, names, rows_at: rows_at as u64, first_line, lacks_header, has_fitting_row })
    }
}

/// Returns the position of the next line; lines end with `\n`, `\r\n` or `\r`.
fn next_line(bytes: &[u8], at: usize) -> usize {
    let rest = bytes.get(at..).unwrap_or_default();
    let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
    end.map_or(bytes.len(), |end| at + end + if rest.get(end..end + 2) == Some(b"\r\n") { 2 } else { 1 })
}

/// Returns the cells of a line, unquoted and trimmed.
fn cells(line: &[u8], separator: u8) -> Vec<String> {
    let mut reader = ReaderBuilder::new().has_headers(false).delimiter(separator).from_reader(line);
    let mut record = ByteRecord::new();
    // Reading from memory cannot fail, and bytes are not decoded.
    let _ = reader.read_byte_record(&mut record);
    record.iter().map(|cell| unquoted(text_of(cell).trim()).to_owned()).collect()
}

/// Removes quotes from a name, which belong to it if a blank precedes them.
fn unquoted(name: &str) -> &str {
    name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name)
}

/// Returns the number of numeric cells.
fn number_count(cells: &[String]) -> usize {
    let is_number = |cell: &&String| !cell.is_empty() && Decimals::default().number(cell).is_some();
    cells.iter().filter(is_number).count()
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
        assert!(form("1,2\n3,4\n").lacks_header);
        assert!(form("t,a\n1,2\n").has_fitting_row && !form("run one, good\nrun two\n").has_fitting_row);
        assert_eq!(Form::find(b"# nothing\n\n"), None);
        assert_eq!(form("t,a\n").rows_at, 4);
        assert_eq!(named("t,a\r1,2\r3,4\r"), expected(',', "t|a", "1,2\r3,4\r", 2));
    }
}
