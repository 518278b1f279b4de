//! Where results go: tables to stdout, JSON and pages to files that appear whole or not at all.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use fric_log::output::{OutputFile, directory_of};
use serde::Serialize;

use crate::failure::{Failure, Outcome};

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

/// Where the machine-readable result goes.
#[derive(Debug)]
pub enum JsonTarget {
    Nowhere,
    Stdout,
    File(OutputFile),
}

impl JsonTarget {
    pub fn prepare(path: Option<&Path>, inputs: &[PathBuf], force: bool) -> Outcome<Self> {
        match path {
            None => Ok(Self::Nowhere),
            Some(path) if is_stdout(path) => Ok(Self::Stdout),
            Some(path) => Ok(Self::File(OutputFile::create(path, inputs, force)?)),
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
            Self::File(file) => Ok(file.finish_with(&text()?)?),
        }
    }

    /// Shows a text to people: on stdout, or on stderr where stdout takes the JSON.
    pub fn show(&self, text: &str) -> Outcome {
        match self {
            Self::Stdout => print_to(std::io::stderr(), &harmless(text)),
            Self::Nowhere | Self::File(_) => print_to(std::io::stdout(), &harmless(text)),
        }
    }
}

/// Lines of text without what a terminal would take for an order.
fn harmless(text: &str) -> String {
    let is_order = |character: char| character.is_control() && character != '\n';
    let escaped = |character: char| {
        if is_order(character) { character.escape_default().to_string() } else { character.to_string() }
    };
    if text.contains(is_order) { text.chars().map(escaped).collect() } else { text.to_owned() }
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
