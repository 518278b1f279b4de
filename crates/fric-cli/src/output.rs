//! Where results go: tables to stdout, JSON and pages to files that appear whole or not at all.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use comfy_table::{CellAlignment, Table, presets};
use fric_log::output::{OutputFile, directory_of};
use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::result::WrenchResult;

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

/// A coordinate to the millimetre, without a minus before a zero.
pub fn to_millimetre(part_m: f64) -> f64 {
    (part_m * 1e3).round() / 1e3 + 0.0
}

/// A table with a header; all columns but the first `left` are aligned right.
pub fn table(header: &[&str], left: usize, rows: &[impl AsRef<[String]>]) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header);
    for row in rows {
        table.add_row(row.as_ref());
    }
    for column in table.column_iter_mut().skip(left) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let lines = table.lines().map(|line| line.trim_end().to_owned() + "\n");
    lines.collect()
}

/// The errors of the wrench.
pub fn wrench_table(WrenchResult { before, after }: &WrenchResult) -> String {
    let rows = [
        ["force".to_owned(), format!("{:.4} N", before.force_rms_n), format!("{:.4} N", after.force_rms_n)],
        ["torque".to_owned(), format!("{:.4} Nm", before.torque_rms_nm), format!("{:.4} Nm", after.torque_rms_nm)],
    ];
    table(&["wrench", "rms before", "after"], 1, &rows)
}
