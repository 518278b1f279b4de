//! Recordings made for the tests, and an independent look at where their messages lie.

use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use std::path::Path;

use fric_log::recording::{Recording, RecordingError};
use mcap::records::{MessageHeader, op};
use mcap::{Compression, WriteOptions};
use tempfile::NamedTempFile;

/// How messages are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    Zstd,
    Lz4,
    Plain,
    Unchunked,
}

pub const STORAGES: [Storage; 4] = [Storage::Zstd, Storage::Lz4, Storage::Plain, Storage::Unchunked];

/// A message to be written, or as it was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sample {
    pub topic: String,
    pub sequence: u32,
    pub log_time_nanos: u64,
    pub publish_time_nanos: u64,
    pub data: Vec<u8>,
}

/// Deterministic numbers (xorshift).
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 % bound as u64).unwrap()
    }
}

pub fn sample(topic: &str, sequence: u32, log_time_nanos: u64, size: usize) -> Sample {
    let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ u64::from(sequence + 1));
    let mut data = sequence.to_le_bytes().to_vec();
    // Compressible, as real messages are, but different for each.
    data.extend((4..size).map(|_| b'a' + u8::try_from(random.below(4)).unwrap()));
    Sample { topic: topic.to_owned(), sequence, log_time_nanos, publish_time_nanos: log_time_nanos + 1, data }
}

/// Messages of two topics, ten nanoseconds apart.
pub fn samples(count: u32) -> Vec<Sample> {
    (0..count)
        .map(|i| {
            let topic = if i % 3 == 0 { "/a" } else { "/b" };
            sample(topic, i, 1000 + u64::from(i) * 10, 20 + (i as usize * 37) % 400)
        })
        .collect()
}

pub fn options(storage: Storage, chunk_size: u64) -> WriteOptions {
    WriteOptions::new()
        .compression(match storage {
            Storage::Zstd => Some(Compression::Zstd),
            Storage::Lz4 => Some(Compression::Lz4),
            Storage::Plain | Storage::Unchunked => None,
        })
        .compression_threads(0)
        .chunk_size(Some(chunk_size))
        .use_chunks(storage != Storage::Unchunked)
}

/// The bytes of a recording, and where its chunks begin and end is left to the writer.
pub fn write(options: WriteOptions, samples: &[Sample]) -> Vec<u8> {
    write_with(options, samples, |_| {})
}

/// Like [`write`], with something added at the end.
pub fn write_with(
    options: WriteOptions,
    samples: &[Sample],
    finish: impl FnOnce(&mut mcap::Writer<Cursor<Vec<u8>>>),
) -> Vec<u8> {
    let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
    let schema = writer.add_schema("test/Data", "ros2msg", b"uint8[] data").unwrap();
    for sample in samples {
        let metadata = BTreeMap::from([("from".to_owned(), "test".to_owned())]);
        let channel_id = writer.add_channel(schema, &sample.topic, "cdr", &metadata).unwrap();
        let header = MessageHeader {
            channel_id,
            sequence: sample.sequence,
            log_time: sample.log_time_nanos,
            publish_time: sample.publish_time_nanos,
        };
        writer.write_to_known_channel(&header, &sample.data).unwrap();
    }
    finish(&mut writer);
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

pub fn to_file(bytes: &[u8]) -> NamedTempFile {
    let mut file = NamedTempFile::with_suffix(".mcap").unwrap();
    file.write_all(bytes).unwrap();
    file.flush().unwrap();
    file
}

pub fn open(bytes: &[u8]) -> Result<Recording, RecordingError> {
    Recording::open(&[to_file(bytes).path()])
}

/// All messages that are delivered.
pub fn read_all(recording: &mut Recording) -> Vec<Sample> {
    let mut samples = Vec::new();
    while let Some(message) = recording.next_message().unwrap() {
        samples.push(Sample {
            topic: message.channel.topic.clone(),
            sequence: message.sequence,
            log_time_nanos: message.log_time_nanos,
            publish_time_nanos: message.publish_time_nanos,
            data: message.data.to_vec(),
        });
    }
    assert_eq!(recording.bytes_read(), recording.total_bytes());
    samples
}

pub fn read_files<P: AsRef<Path>>(paths: &[P]) -> (Vec<Sample>, Recording) {
    let mut recording = Recording::open(paths).unwrap();
    let samples = read_all(&mut recording);
    (samples, recording)
}

pub fn sequences(samples: &[Sample]) -> Vec<u32> {
    samples.iter().map(|sample| sample.sequence).collect()
}

/// A top-level record: opcode, start, end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    pub opcode: u8,
    pub start: usize,
    pub end: usize,
}

/// The records one after the other, `start` being the first one's place.
pub fn places(bytes: &[u8], start: usize) -> Vec<Place> {
    let mut places = Vec::new();
    let mut start = start;
    while start + 9 <= bytes.len() {
        let length = u64::from_le_bytes(bytes[start + 1..start + 9].try_into().unwrap());
        let end = start + 9 + usize::try_from(length).unwrap();
        places.push(Place { opcode: bytes[start], start, end });
        start = end;
    }
    places
}

/// The top-level records of an undamaged file.
pub fn file_places(bytes: &[u8]) -> Vec<Place> {
    places(&bytes[..bytes.len() - mcap::MAGIC.len()], mcap::MAGIC.len())
}

/// The content of an undamaged chunk record.
pub fn chunk_content(bytes: &[u8], place: Place) -> Vec<u8> {
    let body = &bytes[place.start + 9..place.end];
    let record = mcap::parse_record(op::CHUNK, body).unwrap();
    let mcap::records::Record::Chunk { header, data } = record else { unreachable!() };
    match header.compression.as_str() {
        "" => data.into_owned(),
        "zstd" => zstd::decode_all(&data[..]).unwrap(),
        "lz4" => {
            let mut content = Vec::new();
            let mut decoder = lz4_flex::frame::FrameDecoder::new(&data[..]);
            std::io::Read::read_to_end(&mut decoder, &mut content).unwrap();
            content
        }
        other => panic!("compression {other}"),
    }
}

/// The sequence numbers of the messages in a chunk (or of one message outside chunks).
pub fn sequences_in(bytes: &[u8], place: Place) -> Vec<u32> {
    let sequence = |bytes: &[u8], at: usize| u32::from_le_bytes(bytes[at + 11..at + 15].try_into().unwrap());
    match place.opcode {
        op::MESSAGE => vec![sequence(bytes, place.start)],
        op::CHUNK => {
            let content = chunk_content(bytes, place);
            let messages = places(&content, 0);
            messages
                .iter()
                .filter(|inner| inner.opcode == op::MESSAGE)
                .map(|inner| sequence(&content, inner.start))
                .collect()
        }
        _ => Vec::new(),
    }
}

/// A record's bytes.
pub fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    let mut bytes = vec![opcode];
    bytes.extend((body.len() as u64).to_le_bytes());
    bytes.extend(body);
    bytes
}

/// A chunk record's bytes, with a size and a checksum as claimed.
pub fn chunk(compression: &str, stored: &[u8], claimed_len: u64, checksum: u32, times: (u64, u64)) -> Vec<u8> {
    let mut body = times.0.to_le_bytes().to_vec();
    body.extend(times.1.to_le_bytes());
    body.extend(claimed_len.to_le_bytes());
    body.extend(checksum.to_le_bytes());
    body.extend(u32::try_from(compression.len()).unwrap().to_le_bytes());
    body.extend(compression.as_bytes());
    body.extend((stored.len() as u64).to_le_bytes());
    body.extend(stored);
    record(op::CHUNK, &body)
}

/// A message record's bytes.
pub fn message(channel_id: u16, sample: &Sample) -> Vec<u8> {
    let mut body = channel_id.to_le_bytes().to_vec();
    body.extend(sample.sequence.to_le_bytes());
    body.extend(sample.log_time_nanos.to_le_bytes());
    body.extend(sample.publish_time_nanos.to_le_bytes());
    body.extend(&sample.data);
    record(op::MESSAGE, &body)
}

/// A channel record's bytes, without schema and metadata.
pub fn channel(id: u16, topic: &str) -> Vec<u8> {
    let mut body = id.to_le_bytes().to_vec();
    body.extend([0, 0]);
    for text in [topic, "cdr"] {
        body.extend(u32::try_from(text.len()).unwrap().to_le_bytes());
        body.extend(text.as_bytes());
    }
    body.extend([0; 4]);
    record(op::CHANNEL, &body)
}

/// A file of the given records between header and footer, without a summary.
pub fn file_of(records: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = mcap::MAGIC.to_vec();
    bytes.extend(record(op::HEADER, &[0; 8]));
    bytes.extend(records.iter().flatten());
    bytes.extend(record(op::DATA_END, &[0; 4]));
    bytes.extend(record(op::FOOTER, &[0; 20]));
    bytes.extend(mcap::MAGIC);
    bytes
}
