//! Tables as the messages of one topic.

use std::collections::BTreeMap;
use std::path::Path;

use crate::path::FieldPath;
use crate::recording::{Message, Recording};
use crate::schema::{Decoder, FieldKind, MessageType, SchemaError, Wanted};
use crate::signals::{Probe, STAMPS};

use super::{NumberTable, TIME_COLUMN, TableError};

/// The columns of one topic under construction.
#[derive(Debug, Default)]
struct Source {
    channels: Vec<ChannelFields>,
    columns: Vec<(String, Vec<f64>)>,
    stamps_nanos: Vec<i64>,
    unusable_count: u64,
    first_problem: Option<String>,
}

/// The columns that the messages of one channel contain. A topic may have several channels, for instance one per start of its node.
#[derive(Debug)]
struct ChannelFields {
    id: usize,
    /// `None` without a column except the time.
    decoder: Option<Decoder>,
    /// For each number of the decoder, the index of its column.
    places: Vec<usize>,
    /// Index of the stamp among the decoder's fields, if the time is not a column.
    stamp: Option<usize>,
}

/// Reads the wanted fields of the only topic that has any.
pub(super) fn read(path: &Path, wanted: &[String]) -> Result<NumberTable, TableError> {
    let mut recording = Recording::open(&[path])?;
    let mut sources: BTreeMap<String, Source> = BTreeMap::new();
    while let Some(message) = recording.next_message()? {
        let topic = &message.channel.topic;
        let added = match sources.get_mut(topic) {
            Some(source) => source.add(&message, wanted),
            None => sources.entry(topic.clone()).or_default().add(&message, wanted),
        };
        added.map_err(|source| TableError::Schema {
            path: path.to_owned(),
            topic: topic.clone(),
            source: Box::new(source),
        })?;
    }
    let mut warnings = recording.warnings();
    let listed = |topics: &mut dyn Iterator<Item = &String>| topics.map(String::as_str).collect::<Vec<_>>().join(", ");
    let topics = listed(&mut sources.keys());
    sources.retain(|_, source| !source.columns.is_empty());
    if sources.len() > 1 {
        return Err(TableError::SeveralTopics { path: path.to_owned(), topics: listed(&mut sources.keys()) });
    }
    let Some((topic, source)) = sources.pop_first() else {
        let example = wanted.first().cloned().unwrap_or_default();
        let topics = if topics.is_empty() { "none".to_owned() } else { topics };
        // Damage may be the reason why there is none.
        let found = std::iter::once(topics).chain(warnings).collect::<Vec<_>>().join("; ");
        return Err(TableError::NoTopic { path: path.to_owned(), example, found });
    };
    if let Some(problem) = source.first_problem {
        if source.stamps_nanos.is_empty() {
            return Err(TableError::NoUsableMessage { path: path.to_owned(), topic, problem });
        }
        let count = source.unusable_count;
        warnings.push(format!("topic `{topic}`: {count} messages cannot be used; the first: {problem}"));
    }
    Ok(NumberTable { columns: with_time(source.columns, &source.stamps_nanos), warnings })
}

impl Source {
    /// Adds a message as a row.
    fn add(&mut self, message: &Message<'_>, wanted: &[String]) -> Result<(), SchemaError> {
        let id = message.channel.id;
        if !self.channels.iter().any(|channel| channel.id == id) {
            let channel = self.find(message, wanted)?;
            self.channels.push(channel);
        }
        let Some(channel) = self.channels.iter_mut().find(|channel| channel.id == id) else { return Ok(()) };
        let Some(decoder) = &mut channel.decoder else { return Ok(()) };
        match decoder.read(message.data) {
            Ok(values) => {
                let stamp_nanos = channel.stamp.and_then(|place| values.time_nanos(place)).filter(|nanos| *nanos != 0);
                let log_nanos = i64::try_from(message.log_time_nanos).unwrap_or(i64::MAX);
                self.stamps_nanos.push(stamp_nanos.unwrap_or(log_nanos));
                let row_count = self.stamps_nanos.len();
                for (field, place) in channel.places.iter().enumerate() {
                    if let Some((_, numbers)) = self.columns.get_mut(*place) {
                        numbers.push(values.number(field).unwrap_or(f64::NAN));
                    }
                }
                // Columns that only other channels have.
                self.columns.iter_mut().for_each(|(_, numbers)| numbers.resize(row_count, f64::NAN));
            }
            Err(error) => {
                self.unusable_count += 1;
                self.first_problem.get_or_insert_with(|| error.to_string());
            }
        }
        Ok(())
    }

    /// Finds the wanted fields in a channel's messages; new ones become columns.
    fn find(&mut self, message: &Message<'_>, wanted: &[String]) -> Result<ChannelFields, SchemaError> {
        let channel = message.channel;
        let none = ChannelFields { id: channel.id, decoder: None, places: Vec::new(), stamp: None };
        let (name, encoding, data) = channel.schema.as_ref().map_or(("", "", &[][..]), |schema| {
            (schema.name.as_str(), schema.encoding.as_str(), schema.data.as_slice())
        });
        // A channel that cannot be read has none of the columns.
        let Ok(message_type) = MessageType::new(&channel.message_encoding, name, encoding, data) else {
            return Ok(none);
        };
        let probe = Probe { message_type: &message_type, message: message.data };
        let field = |name: &str| FieldPath::default().member(name);
        let is_there = |name: &&String| probe.has(Wanted::numbers(field(name)), FieldKind::Number);
        let names: Vec<&String> = wanted.iter().filter(is_there).collect();
        if names.iter().all(|name| *name == TIME_COLUMN) {
            return Ok(none);
        }
        let mut fields: Vec<Wanted> = names.iter().map(|name| Wanted::numbers(field(name))).collect();
        let stamps = STAMPS.iter().map(|names| names.iter().fold(FieldPath::default(), |path, name| path.member(name)));
        let stamp = stamps.map(Wanted::times).find(|stamp| probe.has(stamp.clone(), FieldKind::Time));
        let needs_time = !names.iter().any(|name| *name == TIME_COLUMN);
        let stamp = stamp.filter(|_| needs_time).map(|stamp| {
            fields.push(stamp);
            fields.len() - 1
        });
        let decoder = Some(message_type.decoder(&fields)?);
        let places = names.into_iter().map(|name| self.place_of(name)).collect();
        Ok(ChannelFields { decoder, places, stamp, ..none })
    }

    /// Returns the index of a column; a new one gets NaN in the rows so far.
    fn place_of(&mut self, name: &str) -> usize {
        self.columns.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
            self.columns.push((name.to_owned(), vec![f64::NAN; self.stamps_nanos.len()]));
            self.columns.len() - 1
        })
    }
}

/// Returns the columns, preceded by the time since the first row if it is not among them.
fn with_time(mut columns: Vec<(String, Vec<f64>)>, stamps_nanos: &[i64]) -> Vec<(String, Vec<f64>)> {
    if !columns.iter().any(|(name, _)| name == TIME_COLUMN) {
        let first_nanos = stamps_nanos.first().copied().unwrap_or(0);
        #[expect(clippy::cast_precision_loss, reason = "seconds since the first row")]
        let since_s = |nanos: &i64| nanos.saturating_sub(first_nanos) as f64 / 1e9;
        columns.insert(0, (TIME_COLUMN.to_owned(), stamps_nanos.iter().map(since_s).collect()));
    }
    columns
}
