//! The order in which messages are delivered.

use std::collections::BTreeMap;

use fric_log::recording::Recording;
use tempfile::NamedTempFile;

use super::support::{
    STORAGES, Sample, Storage, open, options, read_all, read_files, sample, samples, sequences, to_file, write,
    write_with,
};

#[test]
fn messages_in_order_are_delivered_as_they_stand() {
    let samples = samples(300);
    for storage in STORAGES {
        for chunk_size in [500, 5000, 1 << 20] {
            let mut recording = open(&write(options(storage, chunk_size), &samples)).unwrap();
            assert_eq!(read_all(&mut recording), samples);
            assert!(recording.damage().is_empty(), "{}", recording.damage());
            assert_eq!(recording.late_count(), 0);
            assert_eq!(recording.expected_message_count(), Some(300));
            let range = (1000, 1000 + 2990);
            assert_eq!(recording.log_time_range_nanos(), Some(range));
        }
    }
}

#[test]
fn messages_out_of_order_are_sorted_and_ties_keep_their_order() {
    let times = [50, 20, 20, 90, 10, 20, 50, 50, 0, 90, 15, 50, 20];
    let samples: Vec<Sample> = (0..).zip(times).map(|(sequence, time)| sample("/a", sequence, time, 60)).collect();
    let mut expected = samples.clone();
    expected.sort_by_key(|sample| sample.log_time_nanos);
    for storage in STORAGES {
        for chunk_size in [1, 200, 100_000] {
            let mut recording = open(&write(options(storage, chunk_size), &samples)).unwrap();
            let read = read_all(&mut recording);
            assert_eq!(sequences(&read), sequences(&expected), "{storage:?} {chunk_size}");
            assert_eq!(recording.late_count(), 0);
        }
    }
}

#[test]
fn topic_after_topic_is_merged() {
    let topics = ["/a", "/b", "/c", "/d"];
    let mut samples = Vec::new();
    let mut sequence = 0;
    for (offset, topic) in (0..).zip(topics) {
        for i in 0..200 {
            samples.push(sample(topic, sequence, i * 10 + offset, 100));
            sequence += 1;
        }
    }
    let mut expected = samples.clone();
    expected.sort_by_key(|sample| sample.log_time_nanos);
    for storage in STORAGES {
        let bytes = write(options(storage, 2000).repeat_channels(false), &samples);
        let mut recording = open(&bytes).unwrap();
        assert_eq!(read_all(&mut recording), expected);
        assert_eq!(recording.late_count(), 0);
        // Without the end of the file no summary names the channels: each is defined in its first chunk only.
        let mut recording = open(&bytes[..bytes.len() - 40]).unwrap();
        assert_eq!(read_all(&mut recording), expected);
    }
}

#[test]
fn a_channel_defined_in_a_later_chunk_of_an_earlier_time_is_found() {
    // The second chunk is earlier in time, and relies on the channel that the first one defines.
    let samples = [sample("/a", 0, 500, 2000), sample("/a", 1, 100, 2000)];
    let bytes = write(options(Storage::Zstd, 100).repeat_channels(false).repeat_schemas(false), &samples);
    let mut recording = open(&bytes).unwrap();
    assert!(recording.channels().is_empty());
    assert_eq!(sequences(&read_all(&mut recording)), [1, 0]);
    assert!(recording.damage().is_empty(), "{}", recording.damage());
}

#[test]
fn split_files_are_joined_in_any_order() {
    let samples = samples(90);
    for storage in STORAGES {
        let files: Vec<NamedTempFile> =
            samples.chunks(30).map(|part| to_file(&write(options(storage, 1000), part))).collect();
        for order in [[0, 1, 2], [2, 0, 1], [2, 1, 0]] {
            let paths = order.map(|place: usize| files[place].path());
            let (read, recording) = read_files(&paths);
            assert_eq!(read, samples);
            assert_eq!(recording.late_count(), 0);
            // The same channels in all files are the same.
            assert_eq!(recording.channels().len(), 2);
            assert_eq!(recording.damage().files().len(), 3);
        }
    }
}

#[test]
fn files_that_number_their_channels_differently_do_not_mix() {
    let first = [sample("/a", 0, 10, 50), sample("/b", 1, 20, 50)];
    let second = [sample("/b", 2, 15, 50), sample("/a", 3, 25, 50)];
    let files = [
        to_file(&write(options(Storage::Zstd, 1000), &first)),
        to_file(&write(options(Storage::Unchunked, 1000), &second)),
    ];
    let (read, recording) = read_files(&files);
    assert_eq!(read, [first[0].clone(), second[0].clone(), first[1].clone(), second[1].clone()]);
    assert_eq!(recording.channels().len(), 2);
}

#[test]
fn ties_at_the_border_of_split_files_follow_the_recording() {
    let first = [sample("/a", 0, 10, 50), sample("/a", 1, 20, 50)];
    let second = [sample("/a", 2, 20, 50), sample("/a", 3, 30, 50)];
    let files =
        [to_file(&write(options(Storage::Lz4, 1000), &second)), to_file(&write(options(Storage::Lz4, 1000), &first))];
    assert_eq!(sequences(&read_files(&files).0), [0, 1, 2, 3]);
}

#[test]
fn overlap_beyond_the_memory_bound_is_delivered_late_and_counted() {
    // Fifty topics one after the other, each in a chunk of a mebibyte that covers the whole time: more than may be open.
    let mut samples = Vec::new();
    for topic in 0..50 {
        for i in 0..4 {
            let mut sample = sample("/t", topic * 4 + i, u64::from(i) * 1000 + u64::from(topic), 8);
            sample.topic = format!("/t{topic}");
            sample.data.resize(256 * 1024, 0);
            samples.push(sample);
        }
    }
    let mut recording = open(&write(options(Storage::Zstd, 1_040_000), &samples)).unwrap();
    let mut read = BTreeMap::new();
    let mut late = 0;
    let mut latest = 0;
    while let Some(message) = recording.next_message().unwrap() {
        assert!(read.insert(message.sequence, message.data.len()).is_none());
        late += u64::from(message.log_time_nanos < latest);
        latest = latest.max(message.log_time_nanos);
    }
    assert_eq!(read.len(), samples.len());
    assert!(late > 0);
    assert_eq!(recording.late_count(), late);
    assert!(recording.most_late_nanos() > 0);
    assert!(recording.damage().is_empty());
}

#[test]
fn a_recording_can_be_dropped_early() {
    let bytes = write(options(Storage::Zstd, 100), &samples(500));
    let file = to_file(&bytes);
    for count in [0, 1, 200] {
        let mut recording = Recording::open(&[file.path()]).unwrap();
        for _ in 0..count {
            assert!(recording.next_message().unwrap().is_some());
        }
        drop(recording);
    }
}

#[test]
fn attachments_and_metadata_are_listed() {
    let attach = |name: &str, data: &[u8]| mcap::Attachment {
        log_time: 7,
        create_time: 8,
        name: name.to_owned(),
        media_type: "text/plain".to_owned(),
        data: data.to_vec().into(),
    };
    let metadata = mcap::records::Metadata {
        name: "run".to_owned(),
        metadata: BTreeMap::from([("robot".to_owned(), "rig".to_owned())]),
    };
    let bytes = write_with(options(Storage::Zstd, 1000), &samples(20), |writer| {
        writer.attach(&attach("note", b"first")).unwrap();
        writer.write_metadata(&metadata).unwrap();
        writer.attach(&attach("note", b"second")).unwrap();
        writer.attach(&attach("empty", b"")).unwrap();
    });
    let recording = open(&bytes).unwrap();
    let names: Vec<(String, u64)> = recording.attachments().map(|info| (info.name, info.size_bytes)).collect();
    let expected = [("note", 5), ("note", 6), ("empty", 0)];
    assert_eq!(names, expected.map(|(name, size)| (name.to_owned(), size)));
    let note = recording.attachments_named("note").unwrap().pop().unwrap();
    assert_eq!(note.data, b"second");
    assert_eq!((note.info.log_time_nanos, note.info.create_time_nanos), (7, 8));
    assert_eq!(recording.attachments_named("empty").unwrap().pop().unwrap().data, b"");
    assert!(recording.attachments_named("other").unwrap().is_empty());
    assert_eq!(recording.metadata()[0].name, "run");
    assert_eq!(recording.metadata()[0].entries["robot"], "rig");

    // A wrong byte in the content.
    let mut damaged = bytes.clone();
    let at = bytes.windows(6).position(|bytes| bytes == b"second").unwrap();
    damaged[at] ^= 1;
    let error = open(&damaged).unwrap().attachments_named("note").unwrap_err();
    assert!(error.to_string().contains("the attachment `note`"), "{error}");
}
