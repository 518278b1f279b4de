//! Changes of a TOML text by position.
//!
//! Positions are spans of a parser, so every offset lies between two characters. An invalid position changes nothing.

use core::ops::Range;
use std::borrow::ToOwned;
use std::format;
use std::string::String;
use std::vec::Vec;

use toml_edit::TableLike;

/// One range of a text and its replacement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Splice {
    /// The range in bytes.
    pub range: Range<usize>,
    /// The new text.
    pub with: String,
}

/// The span of an entry of a table or a list, including its key, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    pub start: usize,
    pub end: usize,
}

impl From<Range<usize>> for Entry {
    fn from(range: Range<usize>) -> Self {
        Self { start: range.start, end: range.end }
    }
}

/// Applies the changes, which must not overlap; insertions at one position keep their given order.
pub fn apply(text: &mut String, mut splices: Vec<Splice>) {
    splices.sort_by_key(|splice| splice.range.start);
    for Splice { range, with } in splices.into_iter().rev() {
        if text.get(range.clone()).is_some() {
            text.replace_range(range, &with);
        }
    }
}

/// Returns the entry of a table that ends last, including those under dotted keys.
pub fn last_entry(table: &dyn TableLike) -> Option<Entry> {
    let entries = table.get_values().into_iter().filter_map(|(keys, value)| {
        let end = value.span()?.end;
        Some(Entry { start: keys.first()?.span()?.start, end })
    });
    entries.max_by_key(|entry| entry.end)
}

/// Returns a new entry directly after another one in the same braces or brackets.
pub fn beside(last: &Entry, entry: &str) -> Vec<Splice> {
    Vec::from([insert(last.end, format!(", {entry}"))])
}

/// Returns a new line under an entry, with the same indentation.
pub fn below(text: &str, place: &Entry, entry: &str) -> Vec<Splice> {
    let line = format!("{}{}{entry}", newline(text, place.end), indentation(text, place.start));
    Vec::from([insert(line_end(text, place.end), line)])
}

/// Returns a new last entry of a list in brackets or of an inline table; on its own line if the last one is.
pub fn in_list(text: &str, array: &Range<usize>, last: Option<&Entry>, entry: &str) -> Vec<Splice> {
    let inside = array.start + 1..array.end.saturating_sub(1);
    let Some(last) = last else {
        let is_blank = text.get(inside.clone()).is_some_and(|inside| inside.trim().is_empty());
        return Vec::from([if is_blank {
            Splice { range: inside, with: format!(" {entry} ") }
        } else {
            insert(inside.start, format!(" {entry}"))
        }]);
    };
    let comma = comma_behind(text, last.end);
    let line_end = line_end(text, last.end);
    let has_own_line = is_first_on_line(text, last.start) && line_end < inside.end;
    if !has_own_line || comma.is_some_and(|comma| comma > line_end) {
        return beside(last, entry);
    }
    let (own_comma, new_comma) = if comma.is_some() { ("", ",") } else { (",", "") };
    let line = format!("{}{}{entry}{new_comma}", newline(text, last.end), indentation(text, last.start));
    Vec::from([insert(last.end, own_comma.to_owned()), insert(line_end, line)])
}

/// Removes one entry of a list, a comma, and a line that would be left blank or with only a comment.
pub fn out_of_list(text: &str, array: &Range<usize>, entries: &[Entry], index: usize) -> Option<Vec<Splice>> {
    let entry = *entries.get(index)?;
    let own_comma = comma_behind(text, entry.end);
    let mut range = entry.start..own_comma.map_or(entry.end, |comma| comma + 1);
    let mut splices = Vec::new();
    let others_comma = index.checked_sub(1).and_then(|before| comma_behind(text, entries.get(before)?.end));
    if let (None, Some(comma)) = (own_comma, others_comma) {
        splices.push(Splice { range: comma..comma + 1, with: String::new() });
    }
    let end = line_end(text, range.end);
    let rest = text.get(range.end..end)?.trim_start();
    if is_first_on_line(text, entry.start) && end < array.end && (rest.is_empty() || rest.starts_with('#')) {
        range = line_start(text, entry.start)..next_line(text, end);
    } else {
        let blanks = text.get(range.end..end)?.len() - rest.len();
        range.end += if own_comma.is_some() || entries.len() == 1 { blanks } else { 0 };
    }
    splices.push(Splice { range, with: String::new() });
    Some(splices)
}

/// Returns a new table under the last similar one: the same header, with each entry on its own line.
pub fn table_below(text: &str, header: &Range<usize>, last: &Entry, entries: &[String]) -> Vec<Splice> {
    let newline = newline(text, last.end);
    let header_line = line_start(text, header.start)..line_end(text, header.start);
    let header_text = text.get(header_line.clone()).unwrap_or_default();
    // The comment after the header is left out, because it refers to the existing table.
    let closed = header_text.find("]]").and_then(|place| header_text.get(..place + 2)).unwrap_or(header_text);
    let is_apart = blank_line_above(text, header_line.start).is_some();
    let mut added = if is_apart { newline.to_owned() } else { String::new() };
    added += newline;
    added += closed;
    for entry in entries {
        added += newline;
        added += indentation(text, last.start);
        added += entry;
    }
    Vec::from([insert(line_end(text, last.end), added)])
}

/// Returns a new table with one entry at the end of the text, after a blank line.
pub fn table_at_end(text: &str, name: &str, entry: &str) -> Vec<Splice> {
    let newline = newline(text, text.len());
    let last_end = if text.ends_with('\n') { "" } else { newline };
    let blank = if blank_line_above(text, text.len()).is_some() { "" } else { newline };
    Vec::from([insert(text.len(), format!("{last_end}{blank}[{name}]{newline}{entry}{newline}"))])
}

/// Removes a table under a header, from the header's line to that of its last entry, and the blank line before it.
pub fn without_lines(text: &str, header: &Range<usize>, last: Option<Entry>) -> Vec<Splice> {
    let start = line_start(text, header.start);
    let start = blank_line_above(text, start).unwrap_or(start);
    let end = next_line(text, line_end(text, last.map_or(header.end, |last| last.end)));
    Vec::from([Splice { range: start..end, with: String::new() }])
}

fn insert(place: usize, with: String) -> Splice {
    Splice { range: place..place, with }
}

/// Returns the line ending of the line at a position; that of the line before, if it is the last line and has none.
fn newline(text: &str, place: usize) -> &'static str {
    let behind = text.get(place..).and_then(|rest| rest.find('\n')).map(|found| place + found);
    let end = behind.or_else(|| text.rfind('\n'));
    let has_return = end.and_then(|end| text.get(..end)).is_some_and(|line| line.ends_with('\r'));
    if has_return { "\r\n" } else { "\n" }
}

fn line_start(text: &str, place: usize) -> usize {
    text.get(..place).and_then(|before| before.rfind('\n')).map_or(0, |newline| newline + 1)
}

/// Returns the start of the previous line, if that is blank.
fn blank_line_above(text: &str, line: usize) -> Option<usize> {
    let above = line_start(text, line.checked_sub(1)?);
    text.get(above..line)?.trim().is_empty().then_some(above)
}

/// Returns the end of the line at a position, before the newline.
fn line_end(text: &str, place: usize) -> usize {
    let line = text.get(place..).and_then(|rest| rest.split('\n').next()).unwrap_or_default();
    place + line.strip_suffix('\r').unwrap_or(line).len()
}

/// Returns the position after the newline at a line's end.
fn next_line(text: &str, line_end: usize) -> usize {
    let newline = text.get(line_end..).and_then(|rest| rest.find('\n'));
    newline.map_or(text.len(), |newline| line_end + newline + 1)
}

/// Returns the leading blanks of the line at a position.
fn indentation(text: &str, place: usize) -> &str {
    let line = text.get(line_start(text, place)..).unwrap_or_default();
    let blanks = line.find(|character| character != ' ' && character != '\t').unwrap_or(line.len());
    line.get(..blanks).unwrap_or_default()
}

fn is_first_on_line(text: &str, place: usize) -> bool {
    text.get(line_start(text, place)..place).is_some_and(|before| before.trim().is_empty())
}

/// Returns the comma after an entry; blanks, newlines and comments may precede it.
fn comma_behind(text: &str, mut place: usize) -> Option<usize> {
    loop {
        let rest = text.get(place..)?;
        let trimmed = rest.trim_start();
        place += rest.len() - trimmed.len();
        match trimmed.chars().next()? {
            ',' => return Some(place),
            '#' => place = line_end(text, place),
            _ => return None,
        }
    }
}
