//! Small texts from outside: read so that nothing that a path may lead to holds the process up, and quoted so that nothing in them reaches a
//! terminal as more than text.

use std::borrow::ToOwned;
use std::format;
use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read as _, Result};
use std::path::Path;
use std::string::String;

/// Bytes of the longest text that is taken for a model's; a robot of 64 cables is below a tenth of it.
pub const MOST_BYTES: usize = 1 << 20;

/// Reads a regular file of at most [`MOST_BYTES`].
///
/// # Errors
/// Those of the operating system; what is no regular file, for a pipe may never have a writer and a device never end; what is larger; what is
/// no UTF-8.
pub fn read(path: &Path) -> Result<String> {
    // By name first: opening a pipe would wait for its writer.
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    if !metadata.is_file() {
        return Err(Error::new(ErrorKind::InvalidInput, "it is no regular file (a pipe or a device)"));
    }
    if metadata.len() > MOST_BYTES as u64 {
        return Err(Error::new(ErrorKind::FileTooLarge, "it has more than 1 MiB"));
    }
    let mut text = String::new();
    // What grows while it is read has an end too.
    File::open(path)?.take(MOST_BYTES as u64).read_to_string(&mut text)?;
    Ok(text)
}

/// What is wrong with the length of a text that is to be a model's, if anything.
#[must_use]
pub fn excess(text: &str) -> Option<String> {
    (text.len() > MOST_BYTES).then(|| format!("has {} bytes; a model's file has {MOST_BYTES} at most", text.len()))
}

/// What is wrong with a name, if anything: it is shown on terminals, in tables and in files.
#[must_use]
pub fn name_problem(name: &str) -> Option<String> {
    name.contains(char::is_control).then(|| "has a line break or another control character; leave it out".to_owned())
}

/// The most that is quoted in one sentence, characters.
const MOST_QUOTED: usize = 1000;

/// A text as one line for people: control characters as escapes, and of a long one the beginning.
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
