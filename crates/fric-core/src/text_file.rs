//! Small texts from outside the program: reading never blocks, whatever the path leads to, and quoting lets nothing but plain text reach a terminal.

use std::borrow::{Cow, ToOwned as _};
use std::format;
use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read as _, Result};
use std::path::Path;
use std::string::String;

/// Maximum size of a model's text in bytes; a robot of 64 cables takes less than a tenth of it.
pub const MOST_BYTES: usize = 1 << 20;

/// Reads a regular file of at most [`MOST_BYTES`].
///
/// # Errors
/// Returns the errors of the operating system, and errors for anything that is not a regular file (a pipe may never have a writer, a device may never
/// end), is larger, or is not UTF-8.
pub fn read(path: &Path) -> Result<String> {
    read_within(path, MOST_BYTES)
}

/// Reads the text of a regular file of at most so many bytes.
///
/// # Errors
/// As [`read`].
pub fn read_within(path: &Path, most_bytes: usize) -> Result<String> {
    // The path is checked first, because opening a pipe would wait for its writer.
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    if !metadata.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "it is no regular file (a pipe or a device)"));
    }
    if metadata.len() > most_bytes as u64 {
        return Err(Error::new(ErrorKind::FileTooLarge, format!("it has more than {} MiB", most_bytes >> 20)));
    }
    let mut text = String::new();
    // The limit also applies to a file that grows while it is read.
    File::open(path)?.take(most_bytes as u64).read_to_string(&mut text)?;
    Ok(text)
}

/// Returns the problem if a text is too long for a model.
#[must_use]
pub fn excess(text: &str) -> Option<String> {
    (text.len() > MOST_BYTES).then(|| format!("has {} bytes; a model's file has {MOST_BYTES} at most", text.len()))
}

/// Returns the problem of a name, if any: names are shown on terminals, in tables and in files.
#[must_use]
pub fn name_problem(name: &str) -> Option<String> {
    name.contains(char::is_control).then(|| "has a line break or another control character; leave it out".to_owned())
}

/// Maximum length of a quotation in one sentence, in characters.
const MOST_QUOTED: usize = 1000;

/// Escapes the characters of a text that command a terminal, all control characters but line breaks and tabs.
#[must_use]
pub fn harmless(text: &str) -> Cow<'_, str> {
    let is_order = |character: char| character.is_control() && !['\n', '\t'].contains(&character);
    if !text.contains(is_order) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        if is_order(character) {
            escaped.extend(character.escape_default());
        } else {
            escaped.push(character);
        }
    }
    Cow::Owned(escaped)
}

/// Returns a text as one printable line: control characters escaped, and a long text cut to its beginning.
#[must_use]
pub fn printable(text: &str) -> String {
    let mut line = String::with_capacity(text.len().min(MOST_QUOTED));
    for (place, character) in text.chars().enumerate() {
        if place == MOST_QUOTED {
            line.push('…');
            break;
        }
        if character.is_control() {
            line.extend(character.escape_default());
        } else {
            line.push(character);
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_quoted_is_one_short_line() {
        assert_eq!(printable("µ = 0,02 °"), "µ = 0,02 °");
        assert_eq!(printable("a\u{1b}[2Jb\r\nc\u{9b}"), "a\\u{1b}[2Jb\\r\\nc\\u{9b}");
        assert_eq!(printable(&"x".repeat(2_000_000)).chars().count(), MOST_QUOTED + 1);
    }

    #[test]
    fn only_regular_files_of_some_size_are_read() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("robot.toml");
        fs::write(&path, "name = \"rig\"").unwrap();
        assert_eq!(read(&path).unwrap(), "name = \"rig\"");
        fs::write(&path, "#".repeat(MOST_BYTES + 1)).unwrap();
        assert_eq!(read(&path).unwrap_err().kind(), ErrorKind::FileTooLarge);
        assert_eq!(read(directory.path()).unwrap_err().kind(), ErrorKind::IsADirectory);
        #[cfg(unix)]
        assert_eq!(read(Path::new("/dev/zero")).unwrap_err().kind(), ErrorKind::InvalidInput);
    }
}
