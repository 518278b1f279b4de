//! Rows of numbers as a file: CSV, or MCAP by its ending.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use fric_log::output::{CompleteFile, OutputError, OutputFile};
use fric_log::write::LogWriter;
use fric_tendon_lab::columns;

use crate::failure::{Failure, Outcome};

/// The topic and the message type of rows in MCAP.
#[derive(Clone, Copy)]
pub struct Channel {
    pub topic: &'static str,
    pub message: &'static str,
}

/// The destination of rows.
pub enum RowsFile {
    Log(Box<LogWriter>),
    Text(OutputFile),
}

impl RowsFile {
    pub fn create(path: &Path, inputs: &[PathBuf], force: bool) -> Outcome<Self> {
        Ok(if is_mcap(path) {
            Self::Log(Box::new(LogWriter::create(path, inputs, force)?))
        } else {
            Self::Text(OutputFile::create(path, inputs, force)?)
        })
    }

    /// Writes the rows. Without times, text has no column for them, and messages are a second apart.
    pub fn write(
        self,
        channel: Channel,
        names: &[String],
        time_s: Option<&[f64]>,
        rows: impl Iterator<Item = Vec<f64>>,
    ) -> Outcome<CompleteFile> {
        match self {
            Self::Log(mut writer) => {
                let channel = writer.add_numbers(channel.topic, channel.message, names)?;
                for (place, numbers) in (0_u32..).zip(rows) {
                    let stated_s = time_s.and_then(|time_s| time_s.get(place as usize));
                    let time_s = stated_s.copied().unwrap_or(f64::from(place));
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "seconds of a short run"
                    )]
                    let stamp_nanos = (time_s * 1e9).round() as u64;
                    writer.write_numbers(&channel, stamp_nanos, &numbers)?;
                }
                Ok(writer.complete()?)
            }
            Self::Text(file) => {
                let first = time_s.map(|_| columns::TIME.to_owned());
                let names: Vec<String> = first.into_iter().chain(names.iter().cloned()).collect();
                let rows = rows.enumerate().map(|(place, mut numbers)| {
                    if let Some(time_s) = time_s.and_then(|time_s| time_s.get(place)) {
                        numbers.insert(0, *time_s);
                    }
                    numbers
                });
                write_text(file, &names, rows)
            }
        }
    }
}

/// Whether a path names a log in MCAP.
pub fn is_mcap(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "mcap")
}

/// Writes CSV with all digits, so that the reader gets the exact numbers.
pub fn write_text(file: OutputFile, names: &[String], rows: impl Iterator<Item = Vec<f64>>) -> Outcome<CompleteFile> {
    let path = file.path().to_owned();
    let mut writer = csv::Writer::from_writer(file);
    let failed = |error: csv::Error| written(&path, error.into());
    writer.write_record(names).map_err(failed)?;
    for row in rows {
        writer.write_record(row.iter().map(f64::to_string)).map_err(failed)?;
    }
    let mut file = writer.into_inner().map_err(|error| written(&path, error.into_error()))?;
    file.flush().map_err(|error| written(&path, error))?;
    Ok(file.complete()?)
}

fn written(path: &Path, source: std::io::Error) -> Failure {
    OutputError::File { path: path.to_owned(), source }.into()
}
