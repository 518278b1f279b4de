//! A log, whatever it is kept in: what the commands read.
//!
//! [`Log::open`] looks at the bytes, not at the name, to find out what a file is. [`SignalReader`](crate::signals::SignalReader)
//! makes rows of any of them, so that nothing beyond needs to know which it was.

mod error;

use std::path::Path;
use std::sync::Arc;

pub use self::error::LogError;

use crate::csv_log::CsvLog;
use crate::recording::{Attachment, Channel, FileDamage, Message, Recording, RecordingError, open_file};

/// An open log.
#[derive(Debug)]
pub struct Log(pub(crate) Content);

/// What a log is kept in.
#[derive(Debug)]
pub(crate) enum Content {
    /// Messages.
    Recording(Box<Recording>),
    /// Rows.
    Csv(Box<CsvLog>),
}

impl From<Recording> for Log {
    fn from(recording: Recording) -> Self {
        Self(Content::Recording(Box::new(recording)))
    }
}

impl Log {
    /// Opens the files of one log, in any order.
    ///
    /// # Errors
    /// If no file is named, one cannot be opened or is no log, or if they are of several kinds.
    pub fn open<P: AsRef<Path>>(paths: &[P]) -> Result<Self, LogError> {
        let mut tables: Option<CsvLog> = None;
        let mut first_other = None;
        for path in paths.iter().map(AsRef::as_ref) {
            match csv_at(path)? {
                Some(table) => match &mut tables {
                    Some(tables) => tables.join(table),
                    None => tables = Some(table),
                },
                None => first_other = first_other.or(Some(path)),
            }
        }
        match (tables, first_other) {
            (Some(tables), None) => Ok(Self(Content::Csv(Box::new(tables)))),
            (Some(_), Some(other)) => {
                let csv = paths.iter().map(AsRef::as_ref).find(|path| matches!(csv_at(path), Ok(Some(_))));
                let csv = csv.map(Path::to_path_buf).unwrap_or_default();
                Err(LogError::Mixed { csv, other: other.to_path_buf() })
            }
            (None, _) => Ok(Recording::open(paths)?.into()),
        }
    }

    /// The channels known so far, each at the place of its [`Channel::id`]; a log of rows has none.
    #[must_use]
    pub fn channels(&self) -> &[Arc<Channel>] {
        match &self.0 {
            Content::Recording(recording) => recording.channels(),
            Content::Csv(_) => &[],
        }
    }

    /// The next message in the order of log time; `None` at the end, and of a log of rows.
    ///
    /// # Errors
    /// As [`Recording::next_message`].
    pub fn next_message(&mut self) -> Result<Option<Message<'_>>, RecordingError> {
        match &mut self.0 {
            Content::Recording(recording) => recording.next_message(),
            Content::Csv(_) => Ok(None),
        }
    }

    /// Names of the columns of a log of rows.
    #[must_use]
    pub fn column_names(&self) -> Option<&[String]> {
        match &self.0 {
            Content::Recording(_) => None,
            Content::Csv(table) => Some(table.column_names()),
        }
    }

    /// Names of the attachments.
    #[must_use]
    pub fn attachment_names(&self) -> Vec<String> {
        match &self.0 {
            Content::Recording(recording) => recording.attachments().map(|attachment| attachment.name).collect(),
            Content::Csv(_) => Vec::new(),
        }
    }

    /// Reads an attachment by its name; `None` if there is none.
    ///
    /// # Errors
    /// As [`Recording::attachment`].
    pub fn attachment(&self, name: &str) -> Result<Option<Attachment>, RecordingError> {
        match &self.0 {
            Content::Recording(recording) => recording.attachment(name),
            Content::Csv(_) => Ok(None),
        }
    }

    /// Where the beginning of a file is missing, and with it what its messages are: that file.
    #[must_use]
    pub fn beheaded(&self) -> Option<&Path> {
        match &self.0 {
            Content::Recording(recording) => {
                recording.damage().files().iter().find(|file| file.lacks_beginning()).map(FileDamage::path)
            }
            Content::Csv(_) => None,
        }
    }

    /// How many messages could not be read.
    pub(crate) fn lost_messages(&self) -> u64 {
        match &self.0 {
            Content::Recording(recording) => recording.damage().lost_messages(),
            Content::Csv(_) => 0,
        }
    }

    /// What could not be read, and what is out of the ordinary, a sentence each. Complete when all has been read.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        match &self.0 {
            Content::Recording(recording) => recording.warnings(),
            Content::Csv(table) => table.warnings(),
        }
    }

    /// How many bytes have been read so far, for a progress bar: [`Self::total_bytes`] at the end.
    #[must_use]
    pub fn bytes_read(&self) -> u64 {
        match &self.0 {
            Content::Recording(recording) => recording.bytes_read(),
            Content::Csv(table) => table.progress().0,
        }
    }

    /// The size of all files.
    #[must_use]
    pub fn total_bytes(&self) -> u64 {
        match &self.0 {
            Content::Recording(recording) => recording.total_bytes(),
            Content::Csv(table) => table.progress().1,
        }
    }
}

/// The CSV file at a path; `None` where something else is, or nothing that can be opened.
fn csv_at(path: &Path) -> Result<Option<CsvLog>, LogError> {
    // What cannot be opened is told where recordings are.
    let Ok((file, len)) = open_file(path) else { return Ok(None) };
    Ok(CsvLog::open(path, file, len)?)
}
