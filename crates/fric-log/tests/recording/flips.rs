//! Recordings with single wrong bytes.

use std::collections::{BTreeMap, BTreeSet};

use fric_log::recording::DamageKind;
use mcap::records::op;

use super::support::{
    Random, STORAGES, Sample, Storage, file_places, open, options, read_all, samples, sequences, sequences_in, write,
};

/// What a wrong byte at `at` may cost: the messages of the record it is in.
fn may_lose(bytes: &[u8], storage: Storage, at: usize) -> BTreeSet<u32> {
    let places = file_places(bytes);
    let hit = places.iter().position(|place| (place.start..place.end).contains(&at));
    let mut lost: BTreeSet<u32> =
        hit.map(|hit| sequences_in(bytes, places[hit]).into_iter().collect()).unwrap_or_default();
    if let Some(hit) = hit
        && storage == Storage::Unchunked
        && hit > 0
    {
        // A message without anything readable behind it is not believed.
        lost.extend(sequences_in(bytes, places[hit - 1]));
    }
    lost
}

fn check_flip(bytes: &[u8], samples: &[Sample], storage: Storage, at: usize, bit: usize) {
    let label = format!("{storage:?}, bit {bit} of byte {at} flipped");
    let mut damaged = bytes.to_vec();
    damaged[at] ^= 1 << bit;
    let mut recording = open(&damaged).unwrap_or_else(|error| panic!("{label}: {error}"));
    let read = read_all(&mut recording);
    let by_sequence: BTreeMap<u32, &Sample> = samples.iter().map(|sample| (sample.sequence, sample)).collect();
    let may_lose = may_lose(bytes, storage, at);
    let mut seen = BTreeSet::new();
    for sample in &read {
        let is_original = by_sequence.get(&sample.sequence) == Some(&sample);
        if storage == Storage::Unchunked {
            // Outside chunks only the record that was hit may be wrong, or a definition.
            continue;
        }
        assert!(is_original, "{label}: {sample:?}");
        assert!(seen.insert(sample.sequence), "{label}: twice {}", sample.sequence);
    }
    if storage == Storage::Unchunked {
        assert!(read.len() + may_lose.len() >= samples.len(), "{label}: {} of {}", read.len(), samples.len());
        assert!(read.len() <= samples.len(), "{label}");
        return;
    }
    for sample in samples {
        let is_there = seen.contains(&sample.sequence) || may_lose.contains(&sample.sequence);
        assert!(is_there, "{label}: message {} is missing", sample.sequence);
    }
    if read.len() < samples.len() {
        assert!(!recording.damage().is_empty(), "{label}");
        assert_eq!(recording.damage().to_string().lines().count(), 1);
    } else {
        // The times in a chunk's header have no checksum; wrong ones can make messages late.
        let is_late = recording.late_count() > 0;
        assert_ne!(sequences(&read).is_sorted(), is_late, "{label}");
    }
}

#[test]
fn a_wrong_byte_costs_no_more_than_its_record() {
    let samples = samples(50);
    let mut random = Random(7);
    for storage in STORAGES {
        let bytes = write(options(storage, 3000), &samples);
        // Every byte of the record headers, and some of the rest.
        let mut places: BTreeSet<usize> = (0..60).chain(bytes.len() - 60..bytes.len()).collect();
        for place in file_places(&bytes) {
            places.extend(place.start..(place.start + 14).min(place.end));
        }
        places.extend((0..200).map(|_| random.below(bytes.len())));
        for at in places {
            check_flip(&bytes, &samples, storage, at, random.below(8));
        }
    }
}

#[test]
fn a_wrong_checksum_in_an_unchunked_file_is_told() {
    let samples = samples(30);
    let bytes = write(options(Storage::Unchunked, 0), &samples);
    let message = file_places(&bytes).into_iter().find(|place| place.opcode == op::MESSAGE).unwrap();
    let mut damaged = bytes.clone();
    damaged[message.end - 1] ^= 1;
    let mut recording = open(&damaged).unwrap();
    assert_eq!(read_all(&mut recording).len(), samples.len());
    let places = recording.damage().files()[0].places();
    assert_eq!(places.len(), 1);
    assert_eq!(places[0].kind, DamageKind::DataChecksum);
}

#[test]
fn a_chunk_with_a_wrong_length_is_recovered() {
    let samples = samples(50);
    for storage in [Storage::Zstd, Storage::Lz4, Storage::Plain] {
        let bytes = write(options(storage, 3000), &samples);
        let chunk = file_places(&bytes).into_iter().filter(|place| place.opcode == op::CHUNK).nth(1).unwrap();
        // The record's length, and the length of the content.
        for at in [chunk.start + 1, chunk.start + 2, chunk.start + 4, chunk.start + 8] {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x10;
            let mut recording = open(&damaged).unwrap();
            assert_eq!(read_all(&mut recording), samples, "{storage:?} byte {at}");
            let places = recording.damage().files()[0].places();
            assert_eq!(places[0].kind, DamageKind::HeaderRepaired);
            assert_eq!(places[0].offset_bytes, chunk.start as u64);
        }
    }
}

#[test]
fn a_damaged_chunk_in_the_middle_is_left_out_and_told() {
    let samples = samples(60);
    for storage in [Storage::Zstd, Storage::Lz4, Storage::Plain] {
        let bytes = write(options(storage, 3000), &samples);
        let chunks: Vec<_> = file_places(&bytes).into_iter().filter(|place| place.opcode == op::CHUNK).collect();
        let hit = chunks[1];
        let lost = sequences_in(&bytes, hit);
        let mut damaged = bytes.clone();
        damaged[hit.end - 20] ^= 0x40;
        let mut recording = open(&damaged).unwrap();
        let expected: Vec<Sample> = samples.iter().filter(|sample| !lost.contains(&sample.sequence)).cloned().collect();
        assert_eq!(read_all(&mut recording), expected);
        let damage = &recording.damage().files()[0];
        assert_eq!(damage.place_count(), 1);
        assert_eq!(damage.lost_messages(), lost.len() as u64);
        assert_eq!(damage.lost_bytes(), (hit.end - hit.start) as u64);
        let time = |sequence: u32| 1000 + u64::from(sequence) * 10;
        let range = (time(lost[0]), time(*lost.last().unwrap()));
        assert_eq!(damage.log_time_nanos(), Some(range));
    }
}
