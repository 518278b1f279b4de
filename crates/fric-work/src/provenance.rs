//! The origin of a result: program, version, date, command, and the input files by name and hash.
//!
//! Every JSON result and every page contains it, from one [`Provenance`]. It names no user and no machine: a path that is absolute, or leads out of
//! the working directory, is reduced to the file name.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::{Component, Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::SystemTime;

use serde::Serialize;
use sha2::{Digest as _, Sha256};

/// Number of bytes read at once for hashing.
const BLOCK: usize = 1 << 20;

/// The origin of a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Provenance {
    /// `fric`.
    pub program: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// Date of the result, UTC, as RFC 3339 to the second.
    pub made: String,
    /// The command line, or the name of the function in Python.
    pub command: String,
    /// The input files.
    pub inputs: Vec<Input>,
}

/// An input file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Input {
    /// `log` or `model`.
    pub role: &'static str,
    /// Its name, without the path.
    pub name: String,
    /// SHA-256 of its contents in hexadecimal; `None` if it cannot be read again, such as a pipe.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
}

impl Provenance {
    /// Creates the provenance of a command line, starting with the program's name, and its input files.
    #[must_use]
    pub fn of_command(words: &[impl AsRef<OsStr>], files: &[PathBuf]) -> Self {
        let mut words = words.iter().map(AsRef::as_ref);
        let program = words.next().map_or_else(String::new, |program| file_name(Path::new(program)));
        let command = words.fold(program, |command, word| command + " " + &quoted(&host_free(word)));
        Self::new(command, files.iter().flat_map(|path| inputs(path)).collect())
    }

    /// Creates the provenance of a Python function: the files of its log, and the text of its model under the model's name.
    #[must_use]
    pub fn of_call(function: &str, logs: &[PathBuf], model: Option<(&str, &str)>) -> Self {
        let model = model.map(|(name, text)| Input {
            role: "model",
            name: name.to_owned(),
            sha256: Some(hexadecimal(&Sha256::digest(text))),
        });
        let logs = logs.iter().flat_map(|path| inputs(path));
        Self::new(function.to_owned(), logs.chain(model).collect())
    }

    fn new(command: String, inputs: Vec<Input>) -> Self {
        let now = jiff::Timestamp::now();
        let made = jiff::Timestamp::from_second(now.as_second()).unwrap_or(now).to_string();
        Self { program: "fric", version: env!("CARGO_PKG_VERSION"), made, command, inputs }
    }

    /// Returns the names of the logs as a phrase; `arrays` if there is no file.
    #[must_use]
    pub fn logs(&self) -> String {
        let names = self.names("log");
        if names.is_empty() { "arrays".to_owned() } else { names }
    }

    /// Returns the name of the robot file.
    #[must_use]
    pub fn model(&self) -> String {
        self.names("model")
    }

    fn names(&self, role: &str) -> String {
        let names: Vec<&str> =
            self.inputs.iter().filter(|input| input.role == role).map(|input| input.name.as_str()).collect();
        names.join(", ")
    }
}

/// Returns a path for display: unchanged if it stays below the working directory, else only the file name.
#[must_use]
pub fn shown_path(path: &Path) -> String {
    let leaves = path.is_absolute() || path.components().any(|part| matches!(part, Component::ParentDir));
    if leaves { file_name(path) } else { path.display().to_string() }
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Returns a word of a command line with its path, also after `--option=`, replaced as in [`shown_path`].
fn host_free(word: &OsStr) -> String {
    let text = word.to_string_lossy();
    match text.split_once('=') {
        Some((option, path)) if option.starts_with("--") => format!("{option}={}", shown_path(Path::new(path))),
        _ => shown_path(Path::new(text.as_ref())),
    }
}

/// Quotes a word for a shell.
fn quoted(word: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_./=:,+@%".contains(letter);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// Returns a file, or every file of a folder such as a rosbag2 recording.
fn inputs(path: &Path) -> Vec<Input> {
    let Ok(entries) = fs::read_dir(path) else { return vec![input(path, file_name(path))] };
    let mut files: Vec<PathBuf> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| path.is_file()).collect();
    files.sort();
    let folder = file_name(path);
    files.iter().map(|file| input(file, format!("{folder}/{}", file_name(file)))).collect()
}

fn input(path: &Path, name: String) -> Input {
    let is_model = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    Input { role: if is_model { "model" } else { "log" }, name, sha256: hash(path) }
}

/// The state of a file: path, size and modification time.
type FileState = (PathBuf, u64, SystemTime);

/// Cache of hashes, so that a log that is used repeatedly is read for its hash only once.
static HASHES: LazyLock<Mutex<HashMap<FileState, String>>> = LazyLock::new(Mutex::default);

fn hash(path: &Path) -> Option<String> {
    let about = fs::metadata(path).ok().filter(fs::Metadata::is_file)?;
    let key = (path.canonicalize().ok()?, about.len(), about.modified().ok()?);
    let known = || HASHES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(hash) = known().get(&key) {
        return Some(hash.clone());
    }
    let hash = hash_of_file(path).ok()?;
    known().insert(key, hash.clone());
    Some(hash)
}

fn hash_of_file(path: &Path) -> io::Result<String> {
    let (mut file, mut hasher, mut block) = (File::open(path)?, Sha256::new(), vec![0; BLOCK]);
    loop {
        match file.read(&mut block)? {
            0 => return Ok(hexadecimal(&hasher.finalize())),
            count => hasher.update(block.get(..count).unwrap_or_default()),
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a String cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_the_machine_is_told() {
        let words = [
            "/home/ann/bin/fric-cli",
            "replay",
            "/home/ann/a log.mcap",
            "--report=/tmp/r.html",
            "../x/m.toml",
            "runs/b.mcap",
        ];
        let made = Provenance::of_command(&words, &[]);
        assert_eq!(made.command, "fric-cli replay 'a log.mcap' --report=r.html m.toml runs/b.mcap");
        assert!(made.made.ends_with('Z') && made.made.len() == 20, "{}", made.made);
    }

    #[test]
    fn a_model_is_known_by_its_hash() {
        // The test vector of FIPS 180-4 for "abc".
        let made = Provenance::of_call("fric.replay", &[], Some(("rig", "abc")));
        let hash = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(made.inputs, [Input { role: "model", name: "rig".to_owned(), sha256: Some(hash.to_owned()) }]);
        assert_eq!([made.logs(), made.model()], ["arrays", "rig"]);
    }
}
