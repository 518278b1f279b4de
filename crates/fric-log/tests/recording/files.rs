//! Files that are no recordings, and what is said about them.

use std::path::Path;

use fric_log::recording::{Recording, RecordingError};

use super::support::{Storage, file_of, open, options, read_all, samples, to_file, write};

fn error(bytes: &[u8]) -> String {
    fric_log::with_advice(&open(bytes).expect_err("no recording"))
}

#[test]
fn what_is_no_recording_is_named() {
    assert!(error(b"").contains("is empty (0 bytes)"));
    assert!(error(b"format = \"fric-robot/1\"\nname = \"rig\"\n").contains("text file"));
    assert!(error(b"SQLite format 3\0....").contains("ros2 bag convert"));
    assert!(error(b"#ROSBAG V2.0\n").contains("mcap convert"));
    assert!(error(&[0x1f, 0x8b, 8, 0, 0, 0]).contains("gunzip"));
    assert!(error(&[0xff; 3000]).contains("no MCAP record"));
    assert!(error(&vec![0; 100_000]).contains("no MCAP record"));
}

#[test]
fn paths_that_cannot_be_opened_are_named() {
    let open = |path: &Path| Recording::open(&[path]).expect_err("no recording");
    let missing = open(Path::new("/does/not/exist.mcap"));
    assert!(matches!(missing, RecordingError::Missing { .. }));
    assert!(missing.to_string().contains("/does/not/exist.mcap"));
    let directory = tempfile::tempdir().unwrap();
    assert!(matches!(open(directory.path()), RecordingError::Directory { .. }));
    assert!(matches!(Recording::open::<&Path>(&[]), Err(RecordingError::NoFiles)));
    // One bad file among good ones.
    let good = to_file(&write(options(Storage::Zstd, 1000), &samples(3)));
    let bad = to_file(b"no");
    let error = Recording::open(&[good.path(), bad.path()]).unwrap_err();
    assert!(error.to_string().contains(bad.path().to_str().unwrap()));
}

#[test]
fn a_recording_without_messages_is_none_the_less_one() {
    for bytes in [file_of(&[]), write(options(Storage::Zstd, 1000), &[])] {
        let mut recording = open(&bytes).unwrap();
        assert!(read_all(&mut recording).is_empty());
        assert!(recording.damage().is_empty(), "{}", recording.damage());
        assert_eq!(recording.log_time_range_nanos(), None);
    }
    // Nothing but the magic bytes: cut off right at the start.
    let mut recording = open(mcap::MAGIC).unwrap();
    assert!(read_all(&mut recording).is_empty());
    assert!(recording.damage().is_cut());
}

#[test]
fn rubbish_in_front_of_a_recording_is_skipped() {
    let samples = samples(40);
    for storage in super::support::STORAGES {
        let bytes = write(options(storage, 1000), &samples);
        for rubbish in [&[0; 3][..], &[5; 1000], b"some text in front of it\n"] {
            let mut recording = open(&[rubbish, &bytes].concat()).unwrap();
            assert_eq!(read_all(&mut recording), samples, "{storage:?}");
            assert!(recording.damage().place_count() > 0);
        }
        let mut wrong_magic = bytes.clone();
        wrong_magic[2] = 0;
        let mut recording = open(&wrong_magic).unwrap();
        assert_eq!(read_all(&mut recording), samples);
        assert!(!recording.damage().is_empty());
    }
}
