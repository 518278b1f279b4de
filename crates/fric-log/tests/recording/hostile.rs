//! Files that claim what is not so.

use fric_log::recording::{DamageKind, FileEnd};
use mcap::records::op;

use super::support::{
    Sample, Storage, channel, chunk, file_of, file_places, message, open, options, read_all, record, sample, samples,
    sequences, sequences_in, write,
};

fn kinds(recording: &fric_log::recording::Recording) -> Vec<DamageKind> {
    let places = recording.damage().files()[0].places();
    places.iter().map(|place| place.kind).collect()
}

fn plain(samples: &[Sample]) -> Vec<u8> {
    let mut content = channel(1, "/a");
    content.extend(samples.iter().flat_map(|sample| message(1, sample)));
    content
}

/// A good chunk, the given record, and another good chunk.
fn between(bytes: Vec<u8>) -> Vec<u8> {
    let first = plain(&[sample("/a", 0, 10, 50)]);
    let last = plain(&[sample("/a", 1, 90, 50)]);
    let good = |content: &[u8], time| {
        let checksum = crc32fast::hash(content);
        chunk("", content, content.len() as u64, checksum, (time, time))
    };
    file_of(&[good(&first, 10), bytes, good(&last, 90)])
}

#[test]
fn chunks_that_claim_too_much_are_left_out() {
    let content = plain(&[sample("/a", 7, 50, 5000)]);
    let zstd = zstd::encode_all(&content[..], 1).unwrap();
    let true_len = content.len() as u64;
    let cases = [
        (chunk("zstd", &zstd, 1 << 60, 0, (50, 50)), DamageKind::ChunkTooLarge),
        (chunk("zstd", &zstd, u64::MAX, 0, (50, 50)), DamageKind::ChunkTooLarge),
        (chunk("zstd", &zstd, 1 << 30, 0, (50, 50)), DamageKind::ChunkTooLarge),
        (chunk("zstd", &zstd, 1 << 26, 0, (50, 50)), DamageKind::ChunkSize),
        (chunk("zstd", &zstd, true_len + 1, 0, (50, 50)), DamageKind::ChunkSize),
        (chunk("zstd", &zstd, true_len - 1, 0, (50, 50)), DamageKind::ChunkDecompression),
        (chunk("zstd", &zstd, 0, 0, (50, 50)), DamageKind::ChunkDecompression),
        (chunk("zstd", b"no zstd", 100, 0, (50, 50)), DamageKind::ChunkDecompression),
        (chunk("lz4", b"no lz4 either", 100, 0, (50, 50)), DamageKind::ChunkDecompression),
        (chunk("lz4", &[0x04, 0x22, 0x4d, 0x18], 1 << 60, 0, (50, 50)), DamageKind::ChunkTooLarge),
        (chunk("", &content, 1 << 60, 0, (50, 50)), DamageKind::ChunkTooLarge),
        (chunk("", &content, true_len + 1, 0, (50, 50)), DamageKind::ChunkSize),
        (chunk("", &content, true_len, 1, (50, 50)), DamageKind::ChunkChecksum),
        (chunk("zstd", &zstd, true_len, 1, (50, 50)), DamageKind::ChunkChecksum),
    ];
    for (place, (bytes, kind)) in cases.into_iter().enumerate() {
        let mut recording = open(&between(bytes)).unwrap();
        assert_eq!(sequences(&read_all(&mut recording)), [0, 1], "case {place}");
        assert_eq!(kinds(&recording), [kind], "case {place}");
        let range = recording.damage().files()[0].log_time_nanos();
        assert_eq!(range, Some((50, 50)));
    }
}

#[test]
fn content_that_expands_without_end_is_stopped() {
    // 20 MiB of zeros in a few kilobytes, said to be little.
    let zeros = vec![0; 20 << 20];
    let zstd = zstd::encode_all(&zeros[..], 1).unwrap();
    for claimed in [1000, 17 << 20] {
        let mut recording = open(&between(chunk("zstd", &zstd, claimed, 0, (50, 50)))).unwrap();
        assert_eq!(sequences(&read_all(&mut recording)), [0, 1]);
        assert_eq!(recording.damage().place_count(), 1);
    }
    // Said truly, it is read, and holds no records.
    let mut recording = open(&between(chunk("zstd", &zstd, 20 << 20, 0, (50, 50)))).unwrap();
    assert_eq!(sequences(&read_all(&mut recording)), [0, 1]);
    assert_eq!(kinds(&recording), [DamageKind::ChunkRecords]);
}

#[test]
fn records_of_impossible_length_are_skipped() {
    for opcode in 0..=255_u8 {
        for length in [0, 1, 1000, 1 << 40, 1 << 62, u64::MAX] {
            let mut bytes = vec![opcode];
            bytes.extend(length.to_le_bytes());
            bytes.extend([0xaa; 30]);
            let mut recording = open(&between(bytes)).unwrap();
            assert_eq!(sequences(&read_all(&mut recording)), [0, 1], "{opcode:#x} {length}");
            assert!(!recording.damage().is_empty());
        }
    }
}

#[test]
fn unknown_records_are_no_damage() {
    for opcode in [0x80, 0xff] {
        let mut recording = open(&between(record(opcode, &[0xaa; 300]))).unwrap();
        assert_eq!(sequences(&read_all(&mut recording)), [0, 1]);
        assert!(recording.damage().is_empty(), "{}", recording.damage());
    }
}

#[test]
fn strings_that_claim_gigabytes_are_not_believed() {
    // Inside a chunk, where no outer length contradicts.
    for opcode in [op::SCHEMA, op::CHANNEL] {
        let mut content = record(opcode, &[9, 0, 1, 0, 0xff, 0xff, 0xff, 0xff, 0, 0]);
        content.extend(plain(&[sample("/a", 5, 50, 50)]));
        let bytes = chunk("", &content, content.len() as u64, 0, (50, 50));
        let mut recording = open(&between(bytes)).unwrap();
        assert_eq!(sequences(&read_all(&mut recording)), [0, 5, 1]);
        assert_eq!(kinds(&recording), [DamageKind::Definition]);
    }
}

/// A schema's record: number, name, encoding and text.
fn schema(id: u16, text: &[u8]) -> Vec<u8> {
    let mut body = id.to_le_bytes().to_vec();
    for part in [b"type".as_slice(), b"ros2msg", text] {
        body.extend(u32::try_from(part.len()).unwrap().to_le_bytes());
        body.extend(part);
    }
    record(op::SCHEMA, &body)
}

/// Chunks of some hundred bytes unpack to definitions of any size; what is kept of them is bounded.
#[test]
fn definitions_beyond_any_robots_are_left_out() {
    let mut chunks = vec![channel(1, "/a")];
    let text = vec![b'#'; 10 << 20];
    for id in 1..=10 {
        let content = schema(id, &text);
        let packed = zstd::encode_all(&content[..], 1).unwrap();
        chunks.push(chunk("zstd", &packed, content.len() as u64, 0, (50, 50)));
    }
    chunks.push(message(1, &sample("/a", 3, 60, 50)));
    let mut recording = open(&file_of(&chunks)).unwrap();
    assert_eq!(sequences(&read_all(&mut recording)), [3]);
    // Three of them are within 32 MiB.
    assert_eq!(kinds(&recording), [DamageKind::TooLarge; 7]);
}

#[test]
fn records_that_break_off_inside_a_chunk_end_it() {
    let mut content = plain(&[sample("/a", 5, 50, 50), sample("/a", 6, 60, 50)]);
    content.extend([op::MESSAGE, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0, 1, 2, 3]);
    let bytes = chunk("", &content, content.len() as u64, crc32fast::hash(&content), (50, 70));
    let mut recording = open(&between(bytes)).unwrap();
    assert_eq!(sequences(&read_all(&mut recording)), [0, 5, 6, 1]);
    assert_eq!(kinds(&recording), [DamageKind::ChunkRecords]);
    assert_eq!(recording.damage().files()[0].log_time_nanos(), Some((60, 70)));
}

#[test]
fn messages_of_unknown_channels_are_counted() {
    let content = message(77, &sample("/a", 5, 50, 50)).repeat(3);
    let bytes = chunk("", &content, content.len() as u64, 0, (50, 50));
    let mut recording = open(&between(bytes)).unwrap();
    assert_eq!(sequences(&read_all(&mut recording)), [0, 1]);
    assert_eq!(kinds(&recording), [DamageKind::UnknownChannel]);
    assert_eq!(recording.damage().lost_messages(), 3);
}

#[test]
fn a_channel_defined_again_differently_is_a_conflict() {
    let mut content = channel(1, "/other");
    content.extend(message(1, &sample("/other", 5, 50, 50)));
    let bytes = chunk("", &content, content.len() as u64, 0, (50, 50));
    let mut recording = open(&between(bytes)).unwrap();
    assert_eq!(sequences(&read_all(&mut recording)), [0, 1]);
    assert!(kinds(&recording).contains(&DamageKind::Conflict));
    assert_eq!(recording.damage().lost_messages(), 1);
    assert!(recording.channels().iter().all(|channel| channel.topic == "/a"));
}

#[test]
fn times_outside_the_range_of_their_chunk_are_delivered() {
    // Said to be at 50, in truth at 5 and 95.
    let content = plain(&[sample("/a", 5, 5, 50), sample("/a", 6, 95, 50)]);
    let bytes = chunk("", &content, content.len() as u64, 0, (50, 50));
    let mut recording = open(&between(bytes)).unwrap();
    assert_eq!(sequences(&read_all(&mut recording)), [0, 5, 1, 6]);
    assert_eq!((recording.late_count(), recording.most_late_nanos()), (1, 5));
}

#[test]
fn a_channel_lost_with_its_chunk_is_known_from_the_summary() {
    let samples = samples(60);
    let bytes = write(options(Storage::Zstd, 3000), &samples);
    let chunk = file_places(&bytes).into_iter().find(|place| place.opcode == op::CHUNK).unwrap();
    let mut damaged = bytes.clone();
    damaged[chunk.end - 9] ^= 2;
    let mut recording = open(&damaged).unwrap();
    assert_eq!(recording.channels().len(), 2);
    let lost = sequences_in(&bytes, chunk).len();
    let read = read_all(&mut recording);
    assert_eq!(read, samples[lost..]);
    assert_eq!(recording.damage().place_count(), 1);
    assert_eq!(recording.damage().lost_messages(), lost as u64);
}

#[test]
fn a_wrong_summary_is_not_used() {
    let samples = samples(60);
    let bytes = write(options(Storage::Zstd, 3000), &samples);
    let summary_channel = file_places(&bytes).into_iter().find(|place| place.opcode == op::CHANNEL).unwrap();
    let mut damaged = bytes.clone();
    // The topic's last character.
    damaged[summary_channel.start + 9 + 9] ^= 1;
    let mut recording = open(&damaged).unwrap();
    assert!(recording.channels().is_empty());
    assert_eq!(read_all(&mut recording), samples);
    assert_eq!(kinds(&recording), [DamageKind::SummaryChecksum]);
}

#[test]
fn messages_that_resemble_other_records_are_messages() {
    // Read as the two strings of a header record, channel 18, number 0, and the start of a CDR payload fit the length.
    let mut resembling = sample("/a", 0, 50, 260);
    resembling.data[..4].copy_from_slice(&[0, 1, 0, 0]);
    // Read as a message index, the number is the length of the entries.
    let index = sample("/a", 80, 60, 64);
    let zero = Sample { log_time_nanos: 0, publish_time_nanos: 0, ..sample("/a", 0, 0, 4) };
    let samples = [zero, resembling, index.clone(), index];
    let mut records = vec![channel(18, "/a")];
    records.extend(samples.iter().map(|sample| message(18, sample)));
    let mut recording = open(&file_of(&records)).unwrap();
    assert_eq!(read_all(&mut recording), samples);
    assert!(recording.damage().is_empty(), "{}", recording.damage());
}

#[test]
fn the_damage_is_said_in_one_sentence() {
    let bytes = chunk("zstd", b"no zstd", 100, 0, (1_500_000_010, 2_750_000_010));
    let file = super::support::to_file(&between(bytes));
    let (_, recording) = super::support::read_files(&[file.path()]);
    let expected = format!(
        "`{}` has 1 damaged place (at byte 185: a chunk that cannot be decompressed); 60 bytes skipped, \
         between 1.500 s and 2.750 s after the start",
        file.path().display()
    );
    assert_eq!(recording.damage().to_string(), expected);
}

#[test]
fn random_bytes_do_not_disturb() {
    let mut random = super::support::Random(3);
    let bytes = write(options(Storage::Lz4, 1000), &samples(30));
    for _ in 0..300 {
        let mut damaged = bytes.clone();
        let start = random.below(damaged.len());
        let length = random.below(200).min(damaged.len() - start);
        for byte in &mut damaged[start..start + length] {
            *byte = u8::try_from(random.below(256)).unwrap();
        }
        if let Ok(mut recording) = open(&damaged) {
            let read = read_all(&mut recording);
            assert!(read.len() <= 30);
            let end = recording.damage().files()[0].end();
            assert!(matches!(end, FileEnd::Complete | FileEnd::SummaryCut | FileEnd::MessagesCut));
        }
    }
}
