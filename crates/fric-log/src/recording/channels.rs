//! The channels of a recording under dense numbers, independent of the ids in its files.
//!
//! Each file numbers its schemas and channels itself, and repeats the definitions in every chunk and in its summary. Channels of different files (or
//! ids) that agree in everything are one channel here, so that a split recording reads as one. Definitions beside the messages take precedence over
//! those in the summary; two different definitions beside the messages are a conflict.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::record::{ChannelFields, ENTRY_COST, SchemaFields, op};

/// The definition of a channel's messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Schema {
    /// Its name, for ROS 2 the type: `sensor_msgs/msg/JointState`.
    pub name: String,
    /// Its language: `ros2msg`, `jsonschema`, `protobuf`.
    pub encoding: String,
    /// The definition in that language.
    pub data: Vec<u8>,
}

/// A stream of messages of one type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Channel {
    /// Its index in [`Recording::channels`](super::Recording::channels), not the id in the file.
    pub id: usize,
    /// Its topic.
    pub topic: String,
    /// Encoding of its messages: `cdr`, `json`, `protobuf`.
    pub message_encoding: String,
    /// Its schema; `None` if it has none, or if it was lost with a damaged part of the file.
    pub schema: Option<Arc<Schema>>,
    /// Metadata from the recorder.
    pub metadata: BTreeMap<String, String>,
}

/// The result of receiving a definition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Received {
    /// Known or new.
    Fine,
    /// It cannot be parsed.
    Broken,
    /// It is beyond what is kept of definitions.
    TooLarge,
    /// It contradicts an earlier one.
    Conflict,
}

/// The source of a definition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Source {
    /// Collected by the scan, as a fallback.
    Scan,
    /// Read together with its messages.
    Messages,
}

struct SchemaEntry {
    body: Box<[u8]>,
    source: Source,
    schema: Arc<Schema>,
}

struct ChannelEntry {
    body: Box<[u8]>,
    source: Source,
    schema_id: u16,
    /// Topic, encoding and metadata, to rebuild the channel if its schema becomes known later.
    channel: Channel,
}

/// Definitions of one file.
#[derive(Default)]
struct FileTable {
    schemas: HashMap<u16, SchemaEntry>,
    channels: HashMap<u16, ChannelEntry>,
    /// Dense number by channel id.
    dense: Vec<Option<u32>>,
}

/// Size of all definitions of a recording together, bytes; those of a robot's log have some hundred kilobytes. What is beyond it is left out.
const MOST_BYTES: u64 = 32 << 20;

/// All channels of a recording.
pub(super) struct ChannelTable {
    /// Size of the definitions so far, bytes.
    bytes: u64,
    channels: Vec<Arc<Channel>>,
    by_topic: HashMap<String, Vec<u32>>,
    files: Vec<FileTable>,
}

impl ChannelTable {
    pub(super) fn new(file_count: usize) -> Self {
        Self {
            bytes: 0,
            channels: Vec::new(),
            by_topic: HashMap::new(),
            files: std::iter::repeat_with(FileTable::default).take(file_count).collect(),
        }
    }

    pub(super) fn channels(&self) -> &[Arc<Channel>] {
        &self.channels
    }

    /// Returns the dense number of a file's channel.
    #[inline]
    pub(super) fn dense(&self, file: u32, channel_id: u16) -> Option<usize> {
        let table = self.files.get(file as usize)?;
        let dense = (*table.dense.get(usize::from(channel_id))?)?;
        Some(dense as usize)
    }

    #[inline]
    pub(super) fn get(&self, dense: usize) -> Option<&Arc<Channel>> {
        self.channels.get(dense)
    }

    /// Processes a schema or channel record of a file. The ids of channels that a conflict makes ambiguous are added to `rejected`.
    pub(super) fn define(
        &mut self,
        file: u32,
        opcode: u8,
        body: &[u8],
        source: Source,
        rejected: &mut Vec<u16>,
    ) -> Received {
        match opcode {
            op::SCHEMA => self.define_schema(file, body, source, rejected),
            op::CHANNEL => self.define_channel(file, body, source, rejected),
            _ => Received::Broken,
        }
    }

    /// Whether there is room for a definition, which takes it.
    fn fits(bytes: &mut u64, body: &[u8], entry_count: usize) -> bool {
        let all = *bytes + body.len() as u64 + ENTRY_COST * (1 + entry_count as u64);
        let fits = all <= MOST_BYTES;
        *bytes = if fits { all } else { *bytes };
        fits
    }

    fn define_schema(&mut self, file: u32, body: &[u8], source: Source, rejected: &mut Vec<u16>) -> Received {
        let Some(fields) = SchemaFields::parse(body).filter(|fields| fields.id != 0) else {
            return Received::Broken;
        };
        let Some(table) = self.files.get_mut(file as usize) else {
            return Received::Broken;
        };
        if let Some(entry) = table.schemas.get_mut(&fields.id) {
            let is_same = *entry.body == *body
                || (entry.schema.name == fields.name
                    && entry.schema.encoding == fields.encoding
                    && entry.schema.data == fields.data);
            if is_same {
                entry.source = entry.source.max(source);
                return Received::Fine;
            }
            if source == Source::Scan {
                return Received::Conflict;
            }
            if entry.source == Source::Messages {
                let users = table.channels.iter().filter(|(_, channel)| channel.schema_id == fields.id);
                rejected.extend(users.map(|(id, _)| *id));
                return Received::Conflict;
            }
        }
        if !Self::fits(&mut self.bytes, body, 0) {
            return Received::TooLarge;
        }
        let schema = Arc::new(Schema {
            name: fields.name.to_owned(),
            encoding: fields.encoding.to_owned(),
            data: fields.data.to_owned(),
        });
        table.schemas.insert(fields.id, SchemaEntry { body: body.into(), source, schema });
        let users: Vec<u16> =
            table.channels.iter().filter(|(_, channel)| channel.schema_id == fields.id).map(|(id, _)| *id).collect();
        for user in users {
            self.resolve(file, user);
        }
        Received::Fine
    }

    fn define_channel(&mut self, file: u32, body: &[u8], source: Source, rejected: &mut Vec<u16>) -> Received {
        let Some(table) = self.files.get_mut(file as usize) else {
            return Received::Broken;
        };
        let id = body.first_chunk().map(|bytes| u16::from_le_bytes(*bytes));
        if let Some(entry) = id.and_then(|id| table.channels.get_mut(&id))
            && *entry.body == *body
        {
            entry.source = entry.source.max(source);
            return Received::Fine;
        }
        let Some(fields) = ChannelFields::parse(body) else {
            return Received::Broken;
        };
        let channel = Channel {
            id: 0,
            topic: fields.topic.to_owned(),
            message_encoding: fields.message_encoding.to_owned(),
            schema: None,
            metadata: fields.metadata,
        };
        if let Some(entry) = table.channels.get_mut(&fields.id) {
            if entry.channel == channel && entry.schema_id == fields.schema_id {
                entry.source = entry.source.max(source);
                return Received::Fine;
            }
            if source == Source::Scan {
                return Received::Conflict;
            }
            if entry.source == Source::Messages {
                rejected.push(fields.id);
                return Received::Conflict;
            }
        }
        if !Self::fits(&mut self.bytes, body, channel.metadata.len()) {
            return Received::TooLarge;
        }
        table
            .channels
            .insert(fields.id, ChannelEntry { body: body.into(), source, schema_id: fields.schema_id, channel });
        self.resolve(file, fields.id);
        Received::Fine
    }

    /// Finds or creates the dense number of a file's channel.
    fn resolve(&mut self, file: u32, channel_id: u16) {
        let Some(table) = self.files.get_mut(file as usize) else {
            return;
        };
        let Some(entry) = table.channels.get(&channel_id) else {
            return;
        };
        let mut channel = entry.channel.clone();
        channel.schema = table.schemas.get(&entry.schema_id).map(|entry| Arc::clone(&entry.schema));
        let namesakes = self.by_topic.entry(channel.topic.clone()).or_default();
        let known = namesakes.iter().copied().find(|dense| {
            self.channels.get(*dense as usize).is_some_and(|known| {
                known.message_encoding == channel.message_encoding
                    && known.schema == channel.schema
                    && known.metadata == channel.metadata
            })
        });
        let dense = known.or_else(|| {
            let dense = u32::try_from(self.channels.len()).ok()?;
            namesakes.push(dense);
            channel.id = self.channels.len();
            self.channels.push(Arc::new(channel));
            Some(dense)
        });
        let place = usize::from(channel_id);
        if table.dense.len() <= place {
            table.dense.resize(place + 1, None);
        }
        if let Some(slot) = table.dense.get_mut(place) {
            *slot = dense;
        }
    }
}
