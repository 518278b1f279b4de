//! Holds the rows of all cables: in memory while they are few, else in a temporary file from which cables are loaded in turn.
//!
//! The file has no name and ends with the process. It lies in the system's folder for temporary files, and holds 72 bytes a sample and cable, block by
//! block: in each block the rows of the first cable, then those of the next. Rows come back with the same bits.
//!
//! A comparison with the wrench takes all cables at once, so its rows stay in memory.

use std::borrow::Cow;
use std::env;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use fric_core::Sample;
use fric_core::robot::RobotParams;
use miette::Diagnostic;
use thiserror::Error;

use super::record::{LogZero, Measurements, ROW_WIDTH, Reference, Row, Samples};
use crate::set_up::Signals;

/// Size of the rows that stay in memory, bytes: a minute and three quarters of eight cables at 1 kHz.
const MEMORY_BYTES: usize = 64 << 20;
/// Cables are loaded together while their rows take up at most this multiple of what stays in memory. With 4, six minutes of eight cables at 1 kHz are
/// worked on together, as in memory, and an hour's cables one by one. Twice as much would add 256 MB to the memory of logs between.
const LOADED_RATIO: usize = 4;
/// Size of a row with its reference in memory, bytes.
const SAMPLE_BYTES: usize = size_of::<Row>() + size_of::<f64>();
/// Size of a row with its reference in the file, bytes.
const ROW_BYTES: usize = ROW_WIDTH * size_of::<f64>();
/// Number of rows that are read at once.
const ROWS_AT_ONCE: usize = 4096;

/// The environment variable with the folder of temporary files.
const FOLDER_VARIABLE: &str = if cfg!(windows) { "TMP" } else { "TMPDIR" };

/// The temporary file of the samples cannot be made, written or read.
#[derive(Debug, Diagnostic, Error)]
#[error("the samples are too many for memory, and a temporary file in {} cannot hold them", folder.display())]
#[diagnostic(help(
    "Set {} to a writable folder on a disk with {} free bytes a sample and cable.",
    FOLDER_VARIABLE,
    ROW_BYTES
))]
pub struct StoreError {
    /// The folder of the temporary file.
    pub folder: PathBuf,
    /// The cause.
    pub source: io::Error,
}

impl StoreError {
    fn new(source: io::Error) -> Self {
        Self { folder: env::temp_dir(), source }
    }
}

/// The samples of one or several logs of a robot, of any length.
#[derive(Debug)]
pub struct SampleStore<'a> {
    /// Conditions the samples, and holds those that are not in the file.
    tail: Measurements<'a>,
    /// Compares the signals with one another.
    signals: Signals,
    memory_bytes: usize,
    file: Option<Mutex<File>>,
    /// Number of samples in each block of the file.
    blocks: Vec<usize>,
}

impl<'a> SampleStore<'a> {
    /// Creates an empty store for a robot.
    #[must_use]
    pub fn new(robot: &RobotParams<'a>, reference: Reference) -> Self {
        Measurements::new(robot, reference).into()
    }

    /// Lets so many bytes of rows stay in memory before they go to the file.
    #[must_use]
    pub fn within(self, memory_bytes: usize) -> Self {
        Self { memory_bytes, ..self }
    }

    /// Lets each log have a zero of its own, in all fits to forces.
    #[must_use]
    pub fn with_zero_per_log(self, zero: Option<LogZero>) -> Self {
        Self { tail: self.tail.with_zero_per_log(zero), ..self }
    }

    /// Starts another log: the memory of a cable does not carry over.
    pub fn start_log(&mut self) {
        self.tail.start_log();
        self.signals.start();
    }

    /// Adds the next sample of the log.
    ///
    /// # Errors
    /// [`StoreError`] if the samples no longer fit into memory and the temporary file cannot take them. The store is then of no further use.
    pub fn add(&mut self, sample: &Sample<'_>) -> Result<(), StoreError> {
        self.tail.add(sample);
        self.signals.add(sample);
        let row_count: usize = self.tail.samples.iter().map(|of_cable| of_cable.rows.len()).sum();
        if row_count * SAMPLE_BYTES > self.memory_bytes && self.tail.reference() == Reference::Forces {
            self.move_to_file().map_err(StoreError::new)?;
        }
        Ok(())
    }

    fn move_to_file(&mut self) -> io::Result<()> {
        let file = match self.file.take() {
            Some(file) => file.into_inner().unwrap_or_else(PoisonError::into_inner),
            None => tempfile::tempfile()?,
        };
        // A cable may have been loaded meanwhile.
        let mut writer = BufWriter::with_capacity(ROWS_AT_ONCE * ROW_BYTES, file);
        writer.seek(SeekFrom::End(0))?;
        let all = self.tail.samples.iter().flat_map(|of_cable| of_cable.rows.iter().zip(of_cable.references_n.iter()));
        for (row, reference_n) in all {
            for number in row.to_numbers(*reference_n, false) {
                writer.write_all(&number.to_le_bytes())?;
            }
        }
        let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
        self.file = Some(Mutex::new(file));
        self.blocks.push(self.tail.samples.first().map_or(0, |of_cable| of_cable.rows.len()));
        self.tail.samples.fill_with(Samples::default);
        Ok(())
    }

    /// Returns the robot.
    #[must_use]
    pub fn robot(&self) -> &RobotParams<'a> {
        self.tail.robot()
    }

    /// Returns the reference that is kept.
    #[must_use]
    pub fn reference(&self) -> Reference {
        self.tail.reference()
    }

    /// Returns the time of each sample, s since the first one.
    pub(crate) fn times_s(&self) -> Arc<Vec<f64>> {
        self.tail.times_s()
    }

    /// Returns the start of each log, s. Several logs follow one another.
    #[must_use]
    pub fn log_starts_s(&self) -> Vec<f64> {
        self.tail.log_starts_s()
    }

    /// Returns the cables in groups that fit into memory together, in order: all of them, if the file is not needed.
    pub(crate) fn groups(&self) -> impl Iterator<Item = Range<usize>> + use<> {
        let cable_count = self.robot().cables().len();
        let bytes = self.tail.len() * SAMPLE_BYTES;
        let most = if self.file.is_some() { LOADED_RATIO * self.memory_bytes / bytes.max(1) } else { cable_count };
        // Groups of nearly the same size.
        let group_count = cable_count.div_ceil(most.max(1)).max(1);
        (0..group_count).map(move |group| group * cable_count / group_count..(group + 1) * cable_count / group_count)
    }

    /// Returns the measurements with the rows of these cables in memory; of all cables, if the file is not needed. References that are held between
    /// measurements come with lines in place of what they repeat.
    ///
    /// # Errors
    /// [`StoreError`] if the temporary file cannot be read.
    pub fn load(&self, cables: Range<usize>) -> Result<Cow<'_, Measurements<'a>>, StoreError> {
        let given = self.given(cables)?;
        Ok(given.without_repeats().map_or(given, Cow::Owned))
    }

    /// Returns the same measurements as they were added.
    fn given(&self, cables: Range<usize>) -> Result<Cow<'_, Measurements<'a>>, StoreError> {
        let Some(file) = &self.file else { return Ok(Cow::Borrowed(&self.tail)) };
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        let samples: io::Result<Vec<Samples>> = cables.clone().map(|cable| self.read(&mut file, cable)).collect();
        Ok(Cow::Owned(self.tail.holding(cables, samples.map_err(StoreError::new)?)))
    }

    /// Returns what is wrong if the reference of cables is their own sensor's force. `names` are those of the cables.
    pub(crate) fn copied_references(&self, names: &[&str]) -> Option<String> {
        self.signals.copied(names)
    }

    /// Returns warnings about signals that are slower than the log or contradict one another. `names` are those of the cables.
    ///
    /// # Errors
    /// [`StoreError`] if the temporary file cannot be read.
    pub fn warnings(&self, names: &[&str]) -> Result<Vec<String>, StoreError> {
        let warnings = self.groups().map(|group| Ok(self.given(group)?.repeat_warnings(names)));
        let slow = warnings.collect::<Result<Vec<_>, StoreError>>()?.concat();
        Ok(self.signals.warnings(names).into_iter().chain(slow).collect())
    }

    /// Returns the measurements with the rows of all cables in memory.
    ///
    /// # Errors
    /// [`StoreError`] if the temporary file cannot be read.
    pub fn all(&self) -> Result<Cow<'_, Measurements<'a>>, StoreError> {
        self.load(0..self.robot().cables().len())
    }

    /// Reads the samples of a cable.
    fn read(&self, file: &mut File, cable: usize) -> io::Result<Samples> {
        let cable_count = self.robot().cables().len();
        let (mut rows, mut references_n) = (Vec::with_capacity(self.tail.len()), Vec::with_capacity(self.tail.len()));
        let mut bytes = Vec::with_capacity(ROWS_AT_ONCE * ROW_BYTES);
        let mut block_start = 0;
        for count in &self.blocks {
            let row = (block_start + cable * count) as u64;
            file.seek(SeekFrom::Start(row * ROW_BYTES as u64))?;
            for from in (0..*count).step_by(ROWS_AT_ONCE) {
                bytes.resize(ROWS_AT_ONCE.min(count - from) * ROW_BYTES, 0);
                file.read_exact(&mut bytes)?;
                let (numbers, _) = bytes.as_chunks::<{ size_of::<f64>() }>();
                let (of_rows, _) = numbers.as_chunks::<ROW_WIDTH>();
                for row in of_rows {
                    let (row, known_n, _) = Row::from_numbers(&row.map(f64::from_le_bytes));
                    rows.push(row);
                    references_n.push(known_n);
                }
            }
            block_start += cable_count * count;
        }
        if let Some(tail) = self.tail.samples.get(cable) {
            rows.extend_from_slice(&tail.rows);
            references_n.extend_from_slice(&tail.references_n);
        }
        Ok(Samples { rows: Arc::new(rows), references_n: Arc::new(references_n) })
    }
}

impl<'a> From<Measurements<'a>> for SampleStore<'a> {
    fn from(measurements: Measurements<'a>) -> Self {
        let signals = Signals::new(measurements.robot());
        Self { tail: measurements, signals, memory_bytes: MEMORY_BYTES, file: None, blocks: Vec::new() }
    }
}
