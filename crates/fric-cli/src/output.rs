//! Where results go: tables to stdout, JSON and pages to files that appear whole or not at all.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;
use tempfile::NamedTempFile;

use crate::failure::{Failure, Outcome};

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
        let shown = path.display();
        let is_input = path
            .canonicalize()
            .is_ok_and(|path| inputs.iter().any(|input| input.canonicalize().is_ok_and(|input| input == path)));
        if is_input {
            return Err(Failure::new(format!("{shown} is an input of this command and would be overwritten"))
                .advise("Name another output file."));
        }
        if !force && path.exists() {
            return Err(Failure::new(format!("{shown} exists already"))
                .advise("Name another output file, or replace it with --force."));
        }
        let directory = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let file = NamedTempFile::new_in(directory).map_err(|error| {
            Failure::new(format!("cannot write {shown}: {error}"))
                .advise(format!("Check that the directory {} exists and is writable.", directory.display()))
        })?;
        Ok(Self { path: path.to_owned(), file, force })
    }

    /// Writes the text and puts the file in its place.
    pub fn write(mut self, text: &str) -> Outcome {
        let failure =
            |error: std::io::Error, path: &Path| Failure::new(format!("cannot write {}: {error}", path.display()));
        self.file.write_all(text.as_bytes()).map_err(|error| failure(error, &self.path))?;
        let placed = if self.force { self.file.persist(&self.path) } else { self.file.persist_noclobber(&self.path) };
        placed.map(drop).map_err(|error| failure(error.error, &self.path))
    }
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
            Some(path) if path.as_os_str() == "-" => Ok(Self::Stdout),
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
