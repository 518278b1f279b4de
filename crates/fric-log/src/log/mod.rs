//! A log of any supported kind, as the commands read it.
//!
//! [`Log::open`] detects the kind of a file from its bytes, not from its name. [`SignalReader`](crate::signals::SignalReader) produces rows from any
//! of them, so that no other code depends on the kind.

mod error;
mod storage;

use std::path::Path;
use std::sync::Arc;

pub use self::error::LogError;
pub use self::storage::{Chunks, Storage};

use crate::bag::{self, Bag, Opened, Unpacker};
use crate::csv_log::CsvLog;
use crate::recording::{Attachment, Channel, FileDamage, Message, Recording, RecordingError, open_file};

/// An open log.
#[derive(Debug)]
pub struct Log {
    pub(crate) content: Content,
    /// Remarks from opening the log.
    remarks: Vec<String>,
    /// For messages of a bag's MCAP files, which may be compressed individually.
    unpacker: Unpacker,
}

/// The storage of a log.
#[derive(Debug)]
pub(crate) enum Content {
    /// Messages in MCAP files.
    Recording(Box<Recording>),
    /// Messages in SQLite files.
    Bag(Box<Bag>),
    /// Rows of CSV files.
    Csv(Box<CsvLog>),
}

impl From<Recording> for Log {
    fn from(recording: Recording) -> Self {
        Self::of(Content::Recording(Box::new(recording)))
    }
}

impl Log {
    fn of(content: Content) -> Self {
        Self { content, remarks: Vec::new(), unpacker: Unpacker::default() }
    }

    /// Opens the files of one log, in any order, or the folder of a bag.
    ///
    /// # Errors
    /// Returns a [`LogError`] if no file is named, one cannot be opened or is not a log, or if they are of several kinds.
    pub fn open<P: AsRef<Path>>(paths: &[P]) -> Result<Self, LogError> {
        let paths: Vec<&Path> = paths.iter().map(AsRef::as_ref).collect();
        if let [folder] = *paths
            && folder.is_dir()
        {
            let (opened, remarks) = bag::open_folder(folder)?;
            return Ok(match opened {
                Opened::Recording(recording) => Self { remarks, ..(*recording).into() },
                Opened::Bag(bag) => Self { remarks, ..Self::of(Content::Bag(Box::new(bag))) },
            });
        }
        if let Some(bag) = bag::open_files(&paths)? {
            return Ok(Self::of(Content::Bag(Box::new(bag))));
        }
        let mut tables: Option<CsvLog> = None;
        let mut first_other = None;
        for path in paths.iter().copied() {
            match csv_at(path)? {
                Some(table) => match &mut tables {
                    Some(tables) => tables.join(table),
                    None => tables = Some(table),
                },
                None => first_other = first_other.or(Some(path)),
            }
        }
        match (tables, first_other) {
            (Some(tables), None) => Ok(Self::of(Content::Csv(Box::new(tables)))),
            (Some(_), Some(other)) => {
                let csv = paths.iter().copied().find(|path| matches!(csv_at(path), Ok(Some(_))));
                let csv = csv.map(Path::to_path_buf).unwrap_or_default();
                Err(LogError::Mixed { csv, other: other.to_path_buf() })
            }
            (None, _) => Ok(Recording::open(&paths)?.into()),
        }
    }

    /// Returns the channels known so far, each at the index [`Channel::id`]; a log of rows has none.
    #[must_use]
    pub fn channels(&self) -> &[Arc<Channel>] {
        match &self.content {
            Content::Recording(recording) => recording.channels(),
            Content::Bag(bag) => bag.channels(),
            Content::Csv(_) => &[],
        }
    }

    /// Returns the next message in the order of log time; `None` at the end, and for a log of rows.
    ///
    /// # Errors
    /// Returns the errors of [`Recording::next_message`].
    pub fn next_message(&mut self) -> Result<Option<Message<'_>>, RecordingError> {
        match &mut self.content {
            Content::Recording(recording) => {
                let Some(message) = recording.next_message()? else { return Ok(None) };
                // Data other than CDR may begin like compressed data.
                let is_cdr = message.channel.message_encoding == "cdr";
                let data = if is_cdr { self.unpacker.content(message.data) } else { message.data };
                Ok(Some(Message { data, ..message }))
            }
            Content::Bag(bag) => Ok(bag.next_message()),
            Content::Csv(_) => Ok(None),
        }
    }

    /// Returns the column names of a log of rows.
    #[must_use]
    pub fn column_names(&self) -> Option<&[String]> {
        match &self.content {
            Content::Recording(_) | Content::Bag(_) => None,
            Content::Csv(table) => Some(table.column_names()),
        }
    }

    /// Returns the cells of the line of units under the column names; empty if there is none.
    #[must_use]
    pub fn column_units(&self) -> &[String] {
        match &self.content {
            Content::Recording(_) | Content::Bag(_) => &[],
            Content::Csv(table) => table.column_units(),
        }
    }

    /// Returns of each column of a log of rows whether it has dates or times of day, by the first row.
    #[must_use]
    pub fn dated_columns(&self) -> Vec<bool> {
        match &self.content {
            Content::Recording(_) | Content::Bag(_) => Vec::new(),
            Content::Csv(table) => table.dated_columns(),
        }
    }

    /// Returns of each column of a log of rows whether it is the same in all rows of the first file, which are read for this.
    ///
    /// # Errors
    /// Returns a [`LogError`] if they cannot be read.
    pub fn unchanging_columns(&self) -> Result<Vec<bool>, LogError> {
        match &self.content {
            Content::Recording(_) | Content::Bag(_) => Ok(Vec::new()),
            Content::Csv(table) => Ok(table.unchanging_columns()?),
        }
    }

    /// Returns the names of the attachments.
    #[must_use]
    pub fn attachment_names(&self) -> Vec<String> {
        match &self.content {
            Content::Recording(recording) => recording.attachments().map(|attachment| attachment.name).collect(),
            Content::Bag(_) | Content::Csv(_) => Vec::new(),
        }
    }

    /// Reads the attachments of a name, one of each file that has it.
    ///
    /// # Errors
    /// Returns the errors of [`Recording::attachments_named`].
    pub fn attachments_named(&self, name: &str) -> Result<Vec<Attachment>, RecordingError> {
        match &self.content {
            Content::Recording(recording) => recording.attachments_named(name),
            Content::Bag(_) | Content::Csv(_) => Ok(Vec::new()),
        }
    }

    /// Returns a file whose beginning is missing, so that the types of its messages are unknown.
    #[must_use]
    pub fn beheaded(&self) -> Option<&Path> {
        match &self.content {
            Content::Recording(recording) => {
                recording.damage().files().iter().find(|file| file.lacks_beginning()).map(FileDamage::path)
            }
            Content::Bag(_) | Content::Csv(_) => None,
        }
    }

    /// Returns the number of messages that could not be read.
    pub(crate) fn lost_messages(&self) -> u64 {
        match &self.content {
            Content::Recording(recording) => recording.damage().lost_messages(),
            Content::Bag(bag) => bag.lost_messages(),
            Content::Csv(_) => 0,
        }
    }

    /// Returns warnings about unreadable data and anything unusual, one sentence each; complete when everything has been read.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.remarks.clone();
        warnings.extend(match &self.content {
            Content::Recording(recording) => recording.warnings(),
            Content::Bag(bag) => bag.warnings(),
            Content::Csv(table) => table.warnings(),
        });
        warnings.extend(self.unpacker.warning());
        warnings
    }

    /// Returns the bytes read so far, for a progress bar: [`Self::total_bytes`] at the end.
    #[must_use]
    pub fn bytes_read(&self) -> u64 {
        match &self.content {
            Content::Recording(recording) => recording.bytes_read(),
            Content::Bag(bag) => bag.progress().0,
            Content::Csv(table) => table.progress().0,
        }
    }

    /// Returns the size of all files.
    #[must_use]
    pub fn total_bytes(&self) -> u64 {
        match &self.content {
            Content::Recording(recording) => recording.total_bytes(),
            Content::Bag(bag) => bag.progress().1,
            Content::Csv(table) => table.progress().1,
        }
    }
}

/// Opens the CSV file at a path; `None` if it is something else or cannot be opened.
fn csv_at(path: &Path) -> Result<Option<CsvLog>, LogError> {
    // Files that cannot be opened are reported by the recording reader.
    let Ok((file, len)) = open_file(path) else { return Ok(None) };
    Ok(CsvLog::open(path, file, len)?)
}
