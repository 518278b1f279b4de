//! A log, whatever it is kept in: what the commands read.
//!
//! [`Log::open`] looks at the bytes, not at the name, to find out what a file is. [`SignalReader`](crate::signals::SignalReader)
//! makes rows of any of them, so that nothing beyond needs to know which it was.

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
    /// What was out of the ordinary when it was opened.
    remarks: Vec<String>,
    /// For the messages of a bag of MCAP files, which may be compressed each by itself.
    unpacker: Option<Unpacker>,
}

/// What a log is kept in.
#[derive(Debug)]
pub(crate) enum Content {
    /// Messages in MCAP files.
    Recording(Box<Recording>),
    /// Messages in SQLite files.
    Bag(Box<Bag>),
    /// Rows.
    Csv(Box<CsvLog>),
}

impl From<Recording> for Log {
    fn from(recording: Recording) -> Self {
        Self::of(Content::Recording(Box::new(recording)))
    }
}

impl Log {
    fn of(content: Content) -> Self {
        Self { content, remarks: Vec::new(), unpacker: None }
    }

    /// Opens the files of one log, in any order, or the folder of a bag.
    ///
    /// # Errors
    /// If no file is named, one cannot be opened or is no log, or if they are of several kinds.
    pub fn open<P: AsRef<Path>>(paths: &[P]) -> Result<Self, LogError> {
        let paths: Vec<&Path> = paths.iter().map(AsRef::as_ref).collect();
        if let [folder] = *paths
            && folder.is_dir()
        {
            let (opened, remarks) = bag::open_folder(folder)?;
            return Ok(match opened {
                Opened::Recording(recording) => {
                    Self { remarks, unpacker: Some(Unpacker::default()), ..(*recording).into() }
                }
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

    /// The channels known so far, each at the place of its [`Channel::id`]; a log of rows has none.
    #[must_use]
    pub fn channels(&self) -> &[Arc<Channel>] {
        match &self.content {
            Content::Recording(recording) => recording.channels(),
            Content::Bag(bag) => bag.channels(),
            Content::Csv(_) => &[],
        }
    }

    /// The next message in the order of log time; `None` at the end, and of a log of rows.
    ///
    /// # Errors
    /// As [`Recording::next_message`].
    pub fn next_message(&mut self) -> Result<Option<Message<'_>>, RecordingError> {
        match &mut self.content {
            Content::Recording(recording) => {
                let message = recording.next_message()?;
                let Some((message, unpacker)) = message.zip(self.unpacker.as_mut()) else { return Ok(message) };
                // What is not CDR may begin as compressed data do.
                let is_cdr = message.channel.message_encoding == "cdr";
                let data = if is_cdr { unpacker.content(message.data) } else { message.data };
                Ok(Some(Message { data, ..message }))
            }
            Content::Bag(bag) => Ok(bag.next_message()),
            Content::Csv(_) => Ok(None),
        }
    }

    /// Names of the columns of a log of rows.
    #[must_use]
    pub fn column_names(&self) -> Option<&[String]> {
        match &self.content {
            Content::Recording(_) | Content::Bag(_) => None,
            Content::Csv(table) => Some(table.column_names()),
        }
    }

    /// Names of the attachments.
    #[must_use]
    pub fn attachment_names(&self) -> Vec<String> {
        match &self.content {
            Content::Recording(recording) => recording.attachments().map(|attachment| attachment.name).collect(),
            Content::Bag(_) | Content::Csv(_) => Vec::new(),
        }
    }

    /// Reads an attachment by its name; `None` if there is none.
    ///
    /// # Errors
    /// As [`Recording::attachment`].
    pub fn attachment(&self, name: &str) -> Result<Option<Attachment>, RecordingError> {
        match &self.content {
            Content::Recording(recording) => recording.attachment(name),
            Content::Bag(_) | Content::Csv(_) => Ok(None),
        }
    }

    /// Where the beginning of a file is missing, and with it what its messages are: that file.
    #[must_use]
    pub fn beheaded(&self) -> Option<&Path> {
        match &self.content {
            Content::Recording(recording) => {
                recording.damage().files().iter().find(|file| file.lacks_beginning()).map(FileDamage::path)
            }
            Content::Bag(_) | Content::Csv(_) => None,
        }
    }

    /// How many messages could not be read.
    pub(crate) fn lost_messages(&self) -> u64 {
        match &self.content {
            Content::Recording(recording) => recording.damage().lost_messages(),
            Content::Bag(bag) => bag.lost_messages(),
            Content::Csv(_) => 0,
        }
    }

    /// What could not be read, and what is out of the ordinary, a sentence each. Complete when all has been read.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.remarks.clone();
        warnings.extend(match &self.content {
            Content::Recording(recording) => recording.warnings(),
            Content::Bag(bag) => bag.warnings(),
            Content::Csv(table) => table.warnings(),
        });
        warnings.extend(self.unpacker.as_ref().and_then(Unpacker::warning));
        warnings
    }

    /// How many bytes have been read so far, for a progress bar: [`Self::total_bytes`] at the end.
    #[must_use]
    pub fn bytes_read(&self) -> u64 {
        match &self.content {
            Content::Recording(recording) => recording.bytes_read(),
            Content::Bag(bag) => bag.progress().0,
            Content::Csv(table) => table.progress().0,
        }
    }

    /// The size of all files.
    #[must_use]
    pub fn total_bytes(&self) -> u64 {
        match &self.content {
            Content::Recording(recording) => recording.total_bytes(),
            Content::Bag(bag) => bag.progress().1,
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
