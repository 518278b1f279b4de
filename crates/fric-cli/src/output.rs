//! Where results go: tables to stdout, JSON and pages to files that appear whole or not at all.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;
use tempfile::NamedTempFile;

use crate::failure::{self, Failure, Outcome};

/// A text file to be written at the end, checked at the start.
#[derive(Debug)]
pub struct TextFile {
    path: PathBuf,
    file: NamedTempFile,
    force: bool,
}

impl TextFile {
    /// Makes sure that the file can be written and is neither an input nor, without `force`, there already.
    pub fn prepare(path: &Path, inputs: &[PathBuf], force: bool) -> Outcome<Self> {
        if inputs.iter().any(|input| is_same_file(path, input)) {
            return Err(is_input(path));
        }
        if !force && path.symlink_metadata().is_ok() {
            return Err(exists(path));
        }
        if path.is_dir() {
            return Err(unwritable(path, &ErrorKind::IsADirectory.into()));
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(".fric-").suffix(".part");
        // Temporary files are private; this one becomes an ordinary file, which the umask restricts.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(directory_of(path)).map_err(|error| unwritable(path, &error))?;
        Ok(Self { path: path.to_owned(), file, force })
    }

    /// Writes the text and puts the file in its place.
    pub fn write(mut self, text: &str) -> Outcome {
        self.file.write_all(text.as_bytes()).map_err(|error| unwritable(&self.path, &error))?;
        let placed = if self.force { self.file.persist(&self.path) } else { self.file.persist_noclobber(&self.path) };
        placed.map(drop).map_err(|error| match error.error.kind() {
            ErrorKind::AlreadyExists => exists(&self.path),
            _ => unwritable(&self.path, &error.error),
        })
    }
}

/// The failure of an output that is there already.
pub fn exists(path: &Path) -> Failure {
    Failure::new(format!("{} exists already", path.display()))
        .advise("Name another output file, or replace it with --force.")
}

/// The failure of an output that is an input.
pub fn is_input(path: &Path) -> Failure {
    Failure::new(format!("{} is an input of this command and would be overwritten", path.display()))
        .advise("Name another output file.")
}

/// The failure of an output that the operating system refuses.
pub fn unwritable(path: &Path, error: &io::Error) -> Failure {
    let failure = Failure::new(format!("cannot write {}: {}", path.display(), failure::reason(error)));
    match error.kind() {
        ErrorKind::IsADirectory => failure.advise("Name a file in it."),
        ErrorKind::StorageFull => failure.advise("Free some space, or name a file on another disk."),
        _ => {
            failure.advise(format!("Check that the directory {} exists and is writable.", directory_of(path).display()))
        }
    }
}

/// Makes sure that no two outputs are to stand in the same place.
pub fn check_distinct(outputs: &[Option<&Path>]) -> Outcome {
    let place = |path: &Path| {
        let directory = directory_of(path).canonicalize().ok()?;
        Some(directory.join(path.file_name()?))
    };
    let mut places = Vec::new();
    for path in outputs.iter().flatten() {
        let Some(place) = place(path) else { continue };
        if places.contains(&place) {
            return Err(Failure::usage(format!("{} is named for two outputs", path.display()))
                .advise("Give each output a file of its own."));
        }
        places.push(place);
    }
    Ok(())
}

fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Whether both paths lead to the same existing file, under whichever of its names.
fn is_same_file(one: &Path, other: &Path) -> bool {
    let same_path = match (fs::canonicalize(one), fs::canonicalize(other)) {
        (Ok(one), Ok(other)) => one == other,
        _ => return false,
    };
    same_path || is_same_inode(one, other)
}

#[cfg(unix)]
fn is_same_inode(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let inode = |path| fs::metadata(path).ok().map(|metadata| (metadata.dev(), metadata.ino()));
    inode(one).is_some_and(|one| inode(other) == Some(one))
}

#[cfg(not(unix))]
fn is_same_inode(_: &Path, _: &Path) -> bool {
    false
}

/// Where the machine-readable result goes.
#[derive(Debug)]
pub enum JsonTarget {
    Nowhere,
    Stdout,
    File(TextFile),
}

impl JsonTarget {
    pub fn prepare(path: Option<&Path>, inputs: &[PathBuf], force: bool) -> Outcome<Self> {
        match path {
            None => Ok(Self::Nowhere),
            Some(path) if is_stdout(path) => Ok(Self::Stdout),
            Some(path) => TextFile::prepare(path, inputs, force).map(Self::File),
        }
    }

    /// Writes the result.
    pub fn write(self, result: &impl Serialize) -> Outcome {
        let text = || {
            serde_json::to_string_pretty(result)
                .map(|text| text + "\n")
                .map_err(|error| Failure::new(format!("cannot write the result as JSON: {error}")))
        };
        match self {
            Self::Nowhere => Ok(()),
            Self::Stdout => print_to(std::io::stdout(), &text()?),
            Self::File(file) => file.write(&text()?),
        }
    }

    /// Shows a text to people: on stdout, or on stderr where stdout takes the JSON.
    pub fn show(&self, text: &str) -> Outcome {
        match self {
            Self::Stdout => print_to(std::io::stderr(), text),
            Self::Nowhere | Self::File(_) => print_to(std::io::stdout(), text),
        }
    }
}

/// `-`, where stdout is meant.
pub fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// A reader that has gone away (`| head`) is no failure.
fn print_to(mut stream: impl Write, text: &str) -> Outcome {
    match stream.write_all(text.as_bytes()).and_then(|()| stream.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot write the result: {error}")))
        }
        _ => Ok(()),
    }
}

/// A table with a header; all columns but the first `left` are aligned right.
pub fn table<const COLUMNS: usize>(header: [&str; COLUMNS], left: usize, rows: &[[String; COLUMNS]]) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header);
    for row in rows {
        table.add_row(row);
    }
    for column in table.column_iter_mut().skip(left) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let lines = table.lines().map(|line| line.trim_end().to_owned() + "\n");
    lines.collect()
}
