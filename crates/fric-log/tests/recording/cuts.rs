//! Recordings that are cut off.

use fric_log::recording::{DamageKind, FileEnd};
use mcap::records::op;

use super::support::{
    STORAGES, Sample, Storage, file_places, open, options, places, read_all, samples, sequences_in, write,
};

/// How many messages are certainly complete in front of `cut`, in the order of the file.
fn complete_before(bytes: &[u8], storage: Storage, cut: usize) -> usize {
    let mut count = 0;
    for place in file_places(bytes) {
        if place.end <= cut {
            count += sequences_in(bytes, place).len();
        } else if storage == Storage::Plain && place.opcode == op::CHUNK && place.start < cut {
            // An uncompressed chunk shows its records as they are, behind 49 bytes of header and fields.
            let content = (place.start + 49).min(cut);
            let inner = places(&bytes[..cut], content);
            let is_complete = |inner: &&super::support::Place| inner.opcode == op::MESSAGE && inner.end <= cut;
            count += inner.iter().filter(is_complete).count();
        }
    }
    count
}

fn check_cut(bytes: &[u8], samples: &[Sample], storage: Storage, cut: usize) {
    let Ok(mut recording) = open(&bytes[..cut]) else {
        assert!(cut < mcap::MAGIC.len(), "{storage:?} cut at {cut} does not open");
        return;
    };
    let read = read_all(&mut recording);
    assert_eq!(read, samples[..read.len()], "{storage:?} cut at {cut}");
    let complete = complete_before(bytes, storage, cut);
    assert!(read.len() >= complete, "{storage:?} cut at {cut}: {} of {complete}", read.len());
    if matches!(storage, Storage::Plain | Storage::Unchunked) {
        assert_eq!(read.len(), complete, "{storage:?} cut at {cut}");
    }
    let damage = recording.damage();
    if cut < bytes.len() {
        assert!(!damage.is_empty(), "{storage:?} cut at {cut}");
        assert_ne!(damage.files()[0].end(), FileEnd::Complete);
        assert_eq!(damage.to_string().lines().count(), 1);
    } else {
        assert!(damage.is_empty(), "{damage}");
    }
    if damage.files()[0].end() == FileEnd::SummaryCut {
        assert_eq!(read.len(), samples.len());
    }
}

#[test]
fn all_complete_messages_in_front_of_a_cut_are_delivered() {
    let samples = samples(60);
    for storage in STORAGES {
        let bytes = write(options(storage, 3000), &samples);
        for cut in (1..=bytes.len()).filter(|cut| cut % 19 == 0 || *cut + 40 > bytes.len()) {
            check_cut(&bytes, &samples, storage, cut);
        }
    }
}

#[test]
fn a_large_chunk_is_read_up_to_the_cut() {
    let samples = samples(6000);
    for storage in [Storage::Zstd, Storage::Lz4, Storage::Plain] {
        let bytes = write(options(storage, 1 << 30), &samples);
        let chunk = file_places(&bytes).into_iter().find(|place| place.opcode == op::CHUNK).unwrap();
        let cut = chunk.start + (chunk.end - chunk.start) * 3 / 4;
        let mut recording = open(&bytes[..cut]).unwrap();
        let read = read_all(&mut recording);
        assert_eq!(read, samples[..read.len()]);
        assert!(read.len() > samples.len() / 2, "{storage:?}: {}", read.len());
        let damage = &recording.damage().files()[0];
        assert_eq!(damage.places()[0].kind, DamageKind::ChunkCut);
        assert_eq!(damage.end(), FileEnd::MessagesCut);
        assert!(damage.log_time_nanos().is_some());
    }
}

#[test]
fn zeros_behind_the_cut_are_no_messages() {
    let samples = samples(40);
    for storage in STORAGES {
        let bytes = write(options(storage, 2000), &samples);
        let places = file_places(&bytes);
        let last = places.iter().rfind(|place| matches!(place.opcode, op::CHUNK | op::MESSAGE)).unwrap();
        let mut bytes = bytes[..last.end].to_vec();
        bytes.resize(bytes.len() + 5000, 0);
        let mut recording = open(&bytes).unwrap();
        assert_eq!(read_all(&mut recording), samples, "{storage:?}");
        let damage = &recording.damage().files()[0];
        assert_eq!(damage.lost_bytes(), 5000);
        assert_eq!(damage.end(), FileEnd::MessagesCut);
    }
}
