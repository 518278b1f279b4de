//! Tables as the messages of one topic.

use std::path::Path;
use std::sync::Arc;

use crate::path::FieldPath;
use crate::recording::{Channel, Message, Recording};
use crate::schema::{Decoder, FieldKind, MessageType, SchemaError, Values, Wanted};
use crate::signals::{Probe, STAMPS};

use super::{NumberTable, TIME_COLUMN, TableError};

/// The columns of one channel in the making.
#[derive(Debug)]
struct Source {
    decoder: Decoder,
    columns: Vec<(String, Vec<f64>)>,
    /// Whether the time is none of the columns, and which of the decoder's fields it then is.
    needs_time: bool,
    stamp: Option<usize>,
    stamps_nanos: Vec<i64>,
    unusable_count: u64,
    first_problem: Option<String>,
}

/// Reads the wanted fields of the one topic that has any.
pub(super) fn read(path: &Path, wanted: &[String]) -> Result<NumberTable, TableError> {
    let mut recording = Recording::open(&[path])?;
    let mut sources: Vec<(Arc<Channel>, Option<Source>)> = Vec::new();
    while let Some(message) = recording.next_message()? {
        if !sources.iter().any(|(channel, _)| channel.id == message.channel.id) {
            let source = Source::find(&message, wanted).map_err(|source| TableError::Schema {
                path: path.to_owned(),
                topic: message.channel.topic.clone(),
                source: Box::new(source),
            })?;
            sources.push((Arc::clone(message.channel), source));
        }
        let known = sources.iter_mut().find(|(channel, _)| channel.id == message.channel.id);
        if let Some((_, Some(source))) = known {
            source.add(&message);
        }
    }
    let mut topics: Vec<String> = sources.iter().map(|(channel, _)| channel.topic.clone()).collect();
    let mut found: Vec<(Arc<Channel>, Source)> =
        sources.into_iter().filter_map(|(channel, source)| Some((channel, source?))).collect();
    let (channel, source) = match (found.pop(), found.is_empty()) {
        (None, _) => {
            topics.sort();
            topics.dedup();
            let example = wanted.first().cloned().unwrap_or_default();
            let topics = if topics.is_empty() { "none".to_owned() } else { topics.join(", ") };
            return Err(TableError::NoTopic { path: path.to_owned(), example, topics });
        }
        (Some(source), true) => source,
        (Some((channel, _)), false) => {
            let names: Vec<&str> = found.iter().map(|(channel, _)| channel.topic.as_str()).collect();
            let topics = format!("{}, {}", names.join(", "), channel.topic);
            return Err(TableError::SeveralTopics { path: path.to_owned(), topics });
        }
    };
    let mut warnings = recording.warnings();
    if let Some(problem) = &source.first_problem {
        warnings.push(format!(
            "topic `{}`: {} messages cannot be used; the first: {problem}",
            channel.topic, source.unusable_count
        ));
    }
    Ok(NumberTable { columns: source.finish(), warnings })
}

impl Source {
    /// Which of the wanted fields a channel's messages have; `None` without any but a time.
    fn find(message: &Message<'_>, wanted: &[String]) -> Result<Option<Self>, SchemaError> {
        let channel = message.channel;
        let (name, encoding, data) = channel.schema.as_ref().map_or(("", "", &[][..]), |schema| {
            (schema.name.as_str(), schema.encoding.as_str(), schema.data.as_slice())
        });
        // What cannot be read at all has none of the columns.
        let Ok(message_type) = MessageType::new(&channel.message_encoding, name, encoding, data) else {
            return Ok(None);
        };
        let probe = Probe { message_type: &message_type, message: message.data };
        let field = |name: &str| FieldPath::default().member(name);
        let is_there = |name: &&String| probe.has(Wanted::numbers(field(name)), FieldKind::Number);
        let names: Vec<String> = wanted.iter().filter(is_there).cloned().collect();
        if names.iter().all(|name| name == TIME_COLUMN) {
            return Ok(None);
        }
        let mut fields: Vec<Wanted> = names.iter().map(|name| Wanted::numbers(field(name))).collect();
        let stamps = STAMPS.iter().map(|names| names.iter().fold(FieldPath::default(), |path, name| path.member(name)));
        let stamp = stamps.map(Wanted::times).find(|stamp| probe.has(stamp.clone(), FieldKind::Time));
        let needs_time = !names.iter().any(|name| name == TIME_COLUMN);
        let stamp = stamp.filter(|_| needs_time).map(|stamp| {
            fields.push(stamp);
            fields.len() - 1
        });
        Ok(Some(Self {
            decoder: message_type.decoder(&fields)?,
            columns: names.into_iter().map(|name| (name, Vec::new())).collect(),
            needs_time,
            stamp,
            stamps_nanos: Vec::new(),
            unusable_count: 0,
            first_problem: None,
        }))
    }

    fn add(&mut self, message: &Message<'_>) {
        match self.decoder.read(message.data) {
            Ok(values) => {
                let stamp_nanos = self.stamp.and_then(|place| values.time_nanos(place)).filter(|nanos| *nanos != 0);
                let log_nanos = i64::try_from(message.log_time_nanos).unwrap_or(i64::MAX);
                self.stamps_nanos.push(stamp_nanos.unwrap_or(log_nanos));
                let number = |place: usize, values: &Values| values.number(place).unwrap_or(f64::NAN);
                for (place, (_, numbers)) in self.columns.iter_mut().enumerate() {
                    numbers.push(number(place, values));
                }
            }
            Err(error) => {
                self.unusable_count += 1;
                self.first_problem.get_or_insert_with(|| error.to_string());
            }
        }
    }

    fn finish(self) -> Vec<(String, Vec<f64>)> {
        let mut columns = self.columns;
        if self.needs_time {
            let first_nanos = self.stamps_nanos.first().copied().unwrap_or(0);
            #[expect(clippy::cast_precision_loss, reason = "seconds since the first row")]
            let since_s = |nanos: &i64| nanos.saturating_sub(first_nanos) as f64 / 1e9;
            columns.insert(0, (TIME_COLUMN.to_owned(), self.stamps_nanos.iter().map(since_s).collect()));
        }
        columns
    }
}
