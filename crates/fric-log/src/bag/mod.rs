//! Bags of rosbag2: SQLite files, or a folder with SQLite or MCAP files, compressed or not.
//!
//! Bags are read as the recorder wrote them, even if it was stopped before it wrote `metadata.yaml`; damaged ones are read as far as possible.
//! Messages and files compressed with zstd are decompressed, files into a temporary file. Older recorders stored no message definitions; those of
//! common types are built in.

mod database;
mod definitions;
mod metadata;
mod unpack;

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;
use std::sync::Arc;

pub(crate) use self::unpack::Unpacker;

use self::database::{Database, StoredTopic, TemporaryCopy};
use self::metadata::Files;
use crate::recording::{Channel, Message, Recording, RecordingError, Schema, SourceFile, open_file};

/// The first bytes of an SQLite file.
const SQLITE: &[u8] = b"SQLite format 3\0";

/// The content of a bag.
pub(crate) enum Opened {
    /// MCAP files.
    Recording(Box<Recording>),
    /// SQLite files.
    Bag(Bag),
}

/// The SQLite files of a bag, read as one.
#[derive(Debug)]
pub(crate) struct Bag {
    databases: Vec<Database>,
    current: usize,
    channels: Vec<Arc<Channel>>,
    /// For each file, the channel of each topic number.
    by_topic: Vec<HashMap<i64, usize>>,
    data: Vec<u8>,
    unpacker: Unpacker,
    unknown_count: u64,
}

/// Opens the bag in a folder. Also returns remarks about anything unusual.
pub(crate) fn open_folder(folder: &Path) -> Result<(Opened, Vec<String>), RecordingError> {
    let refused = |source| RecordingError::Open { path: folder.to_owned(), source };
    let Files { paths, mut remarks } = Files::find(folder).map_err(refused)?;
    if paths.is_empty() {
        return Err(RecordingError::Directory { path: folder.to_owned() });
    }
    let (mut mcaps, mut databases) = (Vec::new(), Vec::new());
    for path in paths {
        let (mut file, len) = match open_file(&path) {
            Ok(opened) => opened,
            Err(RecordingError::Empty { .. }) => {
                remarks.push(format!("`{}` is empty (0 bytes): its messages are missing", path.display()));
                continue;
            }
            Err(error) => return Err(error),
        };
        let refused = |source| RecordingError::Open { path: path.clone(), source };
        let mut unpacked = None;
        if path.extension().is_some_and(|ending| ending == metadata::COMPRESSED) {
            let (target, remark) = unpack::unpacked(&path, file).map_err(refused)?;
            remarks.extend(remark);
            file = target.reopen().map_err(refused)?;
            unpacked = Some(target);
        }
        if begins_with(&file, SQLITE).map_err(refused)? {
            databases.push(database(&path, len, unpacked.map(TemporaryCopy::Decompressed))?);
        } else {
            let len = file.metadata().map_err(refused)?.len();
            mcaps.push(SourceFile { path, file, len });
        }
    }
    let opened = match (mcaps.is_empty(), databases.is_empty()) {
        (false, true) => Opened::Recording(Box::new(Recording::of_files(mcaps)?)),
        (true, false) => Opened::Bag(Bag::new(databases)?),
        (true, true) => return Err(RecordingError::Empty { path: folder.to_owned() }),
        (false, false) => {
            return Err(RecordingError::SeveralStorages { path: folder.to_owned() });
        }
    };
    Ok((opened, remarks))
}

/// Opens the SQLite files at these paths; `None` if one of them is something else.
pub(crate) fn open_files(paths: &[&Path]) -> Result<Option<Bag>, RecordingError> {
    let mut databases = Vec::new();
    for path in paths {
        // Files that cannot be opened are reported by the recording reader.
        let Ok((file, len)) = open_file(path) else { return Ok(None) };
        if !begins_with(&file, SQLITE).unwrap_or(false) {
            return Ok(None);
        }
        databases.push(database(path, len, None)?);
    }
    if databases.is_empty() { Ok(None) } else { Bag::new(databases).map(Some) }
}

fn database(path: &Path, len: u64, decompressed: Option<TemporaryCopy>) -> Result<Database, RecordingError> {
    let refused = |source| RecordingError::Open { path: path.to_owned(), source };
    let copy = decompressed.map_or_else(|| TemporaryCopy::with_writes(path), |copy| Ok(Some(copy))).map_err(refused)?;
    Database::open(path, len, copy).map_err(|error| unreadable(path, &error))
}

fn unreadable(path: &Path, error: &rusqlite::Error) -> RecordingError {
    let reason = match error {
        rusqlite::Error::QueryReturnedNoRows => "it has no tables `topics` and `messages`".to_owned(),
        error => error.to_string(),
    };
    RecordingError::NotBag { path: path.to_owned(), reason }
}

fn begins_with(mut file: &File, magic: &[u8]) -> io::Result<bool> {
    use std::io::{Seek as _, SeekFrom};
    let mut start = Vec::new();
    file.take(magic.len() as u64).read_to_end(&mut start)?;
    file.seek(SeekFrom::Start(0))?;
    Ok(start == magic)
}

impl Bag {
    fn new(mut databases: Vec<Database>) -> Result<Self, RecordingError> {
        databases.sort_by_key(Database::first_nanos);
        let mut channels: Vec<Arc<Channel>> = Vec::new();
        let mut of_name: HashMap<String, Vec<usize>> = HashMap::new();
        let mut by_topic = Vec::new();
        for database in &databases {
            let topics = database.topics().map_err(|error| unreadable(&database.path, &error))?;
            let mut of_file = HashMap::new();
            for topic in topics {
                let number = topic.id;
                let channel = channel(topic, channels.len());
                let namesakes = of_name.entry(channel.topic.clone()).or_default();
                let is_same = |id: &&usize| {
                    channels.get(**id).is_some_and(|known| Channel { id: known.id, ..channel.clone() } == **known)
                };
                let known = namesakes.iter().find(is_same).copied();
                let id = known.unwrap_or_else(|| {
                    namesakes.push(channel.id);
                    channels.push(Arc::new(channel.clone()));
                    channel.id
                });
                of_file.insert(number, id);
            }
            by_topic.push(of_file);
        }
        Ok(Self {
            databases,
            current: 0,
            channels,
            by_topic,
            data: Vec::new(),
            unpacker: Unpacker::default(),
            unknown_count: 0,
        })
    }

    pub fn channels(&self) -> &[Arc<Channel>] {
        &self.channels
    }

    /// Returns the next message: one file after the other, each in the order of time.
    pub fn next_message(&mut self) -> Option<Message<'_>> {
        let (channel, log_time_nanos) = loop {
            let database = self.databases.get_mut(self.current)?;
            let Some((stamp_nanos, topic)) = database.next(&mut self.data) else {
                self.current += 1;
                continue;
            };
            let ids = self.by_topic.get(self.current);
            let Some(channel) = ids.and_then(|ids| ids.get(&topic)).and_then(|id| self.channels.get(*id)) else {
                self.unknown_count += 1;
                continue;
            };
            break (channel, u64::try_from(stamp_nanos).unwrap_or(0));
        };
        let data = self.unpacker.content(&self.data);
        Some(Message { channel, sequence: 0, log_time_nanos, publish_time_nanos: log_time_nanos, data })
    }

    /// Returns the bytes read so far, and the total.
    pub fn progress(&self) -> (u64, u64) {
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "for a progress bar"
        )]
        let part = |database: &Database| (database.len as f64 * database.progress_ratio()) as u64;
        let read = self.databases.iter().take(self.current).map(|database| database.len).sum::<u64>()
            + self.databases.get(self.current).map_or(0, part);
        (read, self.databases.iter().map(|database| database.len).sum())
    }

    /// Returns the number of messages that could not be read.
    pub fn lost_messages(&self) -> u64 {
        self.unknown_count + self.databases.iter().map(|database| database.lost_count).sum::<u64>()
    }

    /// Returns warnings about unreadable data, complete when all messages have been read.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for Database { path, problem, lost_count, .. } in &self.databases {
            if let Some(problem) = problem {
                let path = path.display();
                let lost = match lost_count {
                    0 => String::new(),
                    1 => ", without 1 message".to_owned(),
                    count => format!(", without {count} messages"),
                };
                warnings.push(format!("`{path}` is damaged ({problem}): what can be read of it is used{lost}"));
            }
        }
        if self.unknown_count > 0 {
            warnings.push(format!(
                "{} messages are of topics that the bag does not name, and are left out",
                self.unknown_count
            ));
        }
        warnings.extend(self.unpacker.warning());
        warnings
    }
}

fn channel(topic: StoredTopic, id: usize) -> Channel {
    let StoredTopic { name, type_name, encoding, definition: (language, text), .. } = topic;
    let (language, text) = match definitions::of_type(&type_name) {
        Some(known) if text.is_empty() => ("ros2msg".to_owned(), known),
        _ => (language, text),
    };
    let schema = Schema { name: type_name, encoding: language, data: text.into_bytes() };
    Channel { id, topic: name, message_encoding: encoding, schema: Some(Arc::new(schema)), metadata: BTreeMap::new() }
}
