//! The destinations of results: tables go to stdout, JSON and pages to files that appear completely or not at all.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use fric_core::text_file::harmless;
use fric_lab::text::{WIDTH, wrapped};
use fric_log::output::{CompleteFile, OutputFile, directory_of};
use fric_work::provenance::Provenance;
use serde::Serialize;

use crate::arguments::ResultArguments;
use crate::command;
use crate::failure::{Failure, Outcome};
use crate::terminal;

/// Checks that no two outputs have the same place.
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

/// The page and the JSON of a result, and the other files of the command that makes it.
#[derive(Debug)]
pub struct Outputs {
    json: JsonPlace,
    report: Option<OutputFile>,
    files: Vec<Written>,
    inputs: Vec<PathBuf>,
    force: bool,
}

#[derive(Debug)]
enum JsonPlace {
    Nowhere,
    Stdout,
    File(OutputFile),
}

impl Outputs {
    /// Checks the places of the result's files, and of `others`, before any input is read.
    pub fn check(arguments: &ResultArguments, others: &[Option<&Path>]) -> Outcome {
        let json_file = arguments.json.as_deref().filter(|path| !is_stdout(path));
        check_distinct(&[others, &[json_file]].concat())
    }

    /// Creates the named ones of page and JSON.
    pub fn create(arguments: &ResultArguments, report: Option<&Path>, inputs: Vec<PathBuf>) -> Outcome<Self> {
        let &ResultArguments { ref json, force } = arguments;
        let json = match json {
            None => JsonPlace::Nowhere,
            Some(path) if is_stdout(path) => JsonPlace::Stdout,
            Some(path) => JsonPlace::File(OutputFile::create(path, &inputs, force)?),
        };
        let report = report.map(|path| OutputFile::create(path, &inputs, force)).transpose()?;
        Ok(Self { json, report, files: Vec::new(), inputs, force })
    }

    /// Creates another file of the command.
    pub fn file(&self, path: &Path) -> Outcome<OutputFile> {
        Ok(OutputFile::create(path, &self.inputs, self.force)?)
    }

    pub fn has_report(&self) -> bool {
        self.report.is_some()
    }

    /// Adds a complete file with a description of its content.
    pub fn add(&mut self, file: CompleteFile, what: impl Into<String>) {
        self.files.push(Written::new(file, what));
    }

    /// Writes the page if it is named.
    pub fn write_report(&mut self, page: impl FnOnce(&Provenance) -> String) -> Outcome {
        if let Some(report) = self.report.take() {
            self.add(report.complete_with(&page(&provenance(&self.inputs)))?, "the report");
        }
        Ok(())
    }

    /// Ends a command: puts all complete files in their places and shows a text to people, with the next step if there is one, on
    /// stdout, or on stderr if stdout takes the JSON.
    pub fn finish(self, result: &impl Serialize, text: &str, next: &str) -> Outcome {
        let Self { json, mut files, inputs, .. } = self;
        let as_json = || as_json(result, &provenance(&inputs));
        match json {
            JsonPlace::Nowhere => show_with(text, files, next),
            JsonPlace::File(file) => {
                files.push(Written::new(file.complete_with(&as_json()?)?, "the result as JSON"));
                show_with(text, files, next)
            }
            JsonPlace::Stdout => {
                let json = as_json()?;
                let written = place(files)?;
                if !terminal::is_quiet() {
                    print_to(std::io::stderr(), "stderr", harmless(&joined(&[text, &written, next])).as_bytes())?;
                }
                print(json.as_bytes())
            }
        }
    }
}

/// Returns program, command and inputs of a result; reads the inputs for their hashes.
pub fn provenance(inputs: &[PathBuf]) -> Provenance {
    Provenance::of_command(&command::words(), inputs)
}

/// Returns a result for machines.
pub fn as_json(result: &impl Serialize, provenance: &Provenance) -> Outcome<String> {
    fric_work::json(result, provenance)
        .map_err(|error| Failure::new(format!("cannot write the result as JSON: {error}")))
}

/// A complete output with a description of its content.
#[derive(Debug)]
pub struct Written {
    file: CompleteFile,
    what: String,
}

impl Written {
    pub fn new(file: CompleteFile, what: impl Into<String>) -> Self {
        Self { file, what: what.into() }
    }

    /// Returns a line for people, within 80 columns if the path allows.
    fn told(path: &str, what: &str) -> String {
        let line = format!("wrote {path}: {what}\n");
        if line.chars().count() <= WIDTH { line } else { format!("wrote {path}:\n{}", wrapped("  ", what)) }
    }
}

/// Puts files in their places and lists them; on failure, reports which are already there.
fn place(files: Vec<Written>) -> Outcome<String> {
    let mut placed = Vec::new();
    let mut list = String::new();
    for Written { file, what } in files {
        let path = file.path().display().to_string();
        file.place().map_err(|error| Failure::from(error).although_written(&placed))?;
        list += &Written::told(&path, &what);
        placed.push(path);
    }
    Ok(if terminal::is_quiet() { String::new() } else { list })
}

/// Puts files in their places and shows a text, their list, and what to do next.
pub fn show_with(text: &str, files: Vec<Written>, next: &str) -> Outcome {
    let written = place(files)?;
    show(&joined(&[text, &written, next]))
}

/// Joins texts with an empty line between them.
fn joined(texts: &[&str]) -> String {
    let there: Vec<&str> = texts.iter().copied().filter(|text| !text.is_empty()).collect();
    there.join("\n")
}

/// Shows a text to people on stdout.
pub fn show(text: &str) -> Outcome {
    print(harmless(text).as_bytes())
}

/// Prints bytes to stdout as they are.
pub fn print(bytes: &[u8]) -> Outcome {
    print_to(std::io::stdout(), "stdout", bytes)
}

/// Whether the path is `-`, which means stdout.
fn is_stdout(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Prints to a stream. A closed reader (`| head`) is no failure.
fn print_to(mut stream: impl Write, name: &str, bytes: &[u8]) -> Outcome {
    match stream.write_all(bytes).and_then(|()| stream.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::new(format!("cannot print the result to {name}: {error}"))
                .advise(format!("See where {name} leads; output files that were named are written.")))
        }
        _ => Ok(()),
    }
}
