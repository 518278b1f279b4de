//! Logs taken apart and put together again with the `mcap` crate, independently of `fric-log`.

use std::io::Cursor;

use mcap::records::MessageHeader;
use mcap::{Attachment, Compression, MessageStream, Summary, WriteOptions};

/// How messages are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    Zstd,
    Plain,
    Unchunked,
}

/// One message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    pub topic: String,
    pub log_time_nanos: u64,
    pub data: Vec<u8>,
}

/// All messages of a log in the order of the file.
pub fn messages(log: &[u8]) -> Vec<Message> {
    let messages = MessageStream::new(log).unwrap().map(Result::unwrap);
    messages
        .map(|message| Message {
            topic: message.channel.topic.clone(),
            log_time_nanos: message.log_time,
            data: message.data.to_vec(),
        })
        .collect()
}

/// The decoded messages of one topic.
pub fn on_topic<T>(log: &[u8], topic: &str, decode: impl Fn(&[u8]) -> T) -> Vec<T> {
    messages(log).iter().filter(|message| message.topic == topic).map(|message| decode(&message.data)).collect()
}

/// The robot file attached to a log.
pub fn attached_robot(log: &[u8]) -> String {
    let summary = Summary::read(log).unwrap().unwrap();
    let [index] = summary.attachment_indexes.as_slice() else { panic!("not one attachment") };
    let attachment = mcap::read::attachment(log, index).unwrap();
    assert_eq!(attachment.name, "fric-robot.toml");
    String::from_utf8(attachment.data.into_owned()).unwrap()
}

/// The log again, stored in another way, with this robot file and the messages wanted by topic and time.
pub fn rewrite(log: &[u8], storage: Storage, robot: Option<&str>, wants: impl Fn(&str, u64) -> bool) -> Vec<u8> {
    rewrite_data(log, storage, robot, |topic, time, data| wants(topic, time).then(|| data.to_vec()))
}

/// The log with other bytes in the messages of a topic.
pub fn with_data(log: &[u8], topic: &str, change: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    rewrite_data(log, Storage::Zstd, Some(&attached_robot(log)), |of, _, data| {
        Some(if of == topic { change(data) } else { data.to_vec() })
    })
}

/// The log again with what is made of each message's bytes.
fn rewrite_data(
    log: &[u8],
    storage: Storage,
    robot: Option<&str>,
    data_of: impl Fn(&str, u64, &[u8]) -> Option<Vec<u8>>,
) -> Vec<u8> {
    let mut writer = WriteOptions::new()
        .compression((storage == Storage::Zstd).then_some(Compression::Zstd))
        .compression_threads(0)
        .chunk_size(Some(16 << 10))
        .use_chunks(storage != Storage::Unchunked)
        .create(Cursor::new(Vec::new()))
        .unwrap();
    if let Some(robot) = robot {
        let (name, media_type) = ("fric-robot.toml".to_owned(), "application/toml".to_owned());
        let data = robot.as_bytes().into();
        writer.attach(&Attachment { log_time: 0, create_time: 0, name, media_type, data }).unwrap();
    }
    for message in MessageStream::new(log).unwrap().map(Result::unwrap) {
        let channel = &message.channel;
        let Some(data) = data_of(&channel.topic, message.log_time, &message.data) else { continue };
        let schema = channel.schema.as_ref().unwrap();
        let schema = writer.add_schema(&schema.name, &schema.encoding, &schema.data).unwrap();
        let channel_id =
            writer.add_channel(schema, &channel.topic, &channel.message_encoding, &channel.metadata).unwrap();
        let (log_time, publish_time) = (message.log_time, message.publish_time);
        let header = MessageHeader { channel_id, sequence: message.sequence, log_time, publish_time };
        writer.write_to_known_channel(&header, &data).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// The log without the topics named.
pub fn without(log: &[u8], topics: &[&str]) -> Vec<u8> {
    rewrite(log, Storage::Zstd, Some(&attached_robot(log)), |topic, _| !topics.contains(&topic))
}

/// The log with the reference of one cable under another name of the same length.
pub fn without_reference_of(log: &[u8], cable: &str) -> Vec<u8> {
    with_data(log, "/reference_forces", |data| {
        let at = data.windows(cable.len()).position(|window| window == cable.as_bytes()).unwrap();
        let mut data = data.to_vec();
        data[at..at + cable.len()].fill(b'x');
        data
    })
}
