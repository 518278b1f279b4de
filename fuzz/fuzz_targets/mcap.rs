//! Bytes as an MCAP recording: its messages, twice the same, and what is told of damage.
#![no_main]

use std::fs;
use std::sync::LazyLock;

use fric_log::recording::Recording;
use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

static PLACE: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder for logs"));

fuzz_target!(|data: &[u8]| {
    let path = PLACE.path().join("log.mcap");
    fs::write(&path, data).expect("room for a log");
    let open = || Recording::open(&[&path]);
    let Ok(recording) = open() else { return };
    let messages = Messages::of(recording, data.len());
    assert_eq!(Messages::of(open().expect("a log that has been read"), data.len()), messages);
});

/// What a log has to say, without the messages themselves.
#[derive(Debug, PartialEq)]
struct Messages {
    count: u64,
    payload_bytes: usize,
    checksum: u64,
    damage: String,
}

impl Messages {
    fn of(mut recording: Recording, file_bytes: usize) -> Self {
        let mut messages = Self { count: 0, payload_bytes: 0, checksum: 0, damage: String::new() };
        let (mut latest_nanos, mut late_count) = (0, 0);
        while let Some(message) = recording.next_message().expect("a file that stays") {
            messages.count += 1;
            messages.payload_bytes += message.data.len();
            let words = [message.log_time_nanos, message.publish_time_nanos, u64::from(message.sequence)];
            for word in words.into_iter().chain(message.data.iter().map(|byte| u64::from(*byte))) {
                messages.checksum = messages.checksum.rotate_left(7) ^ word;
            }
            late_count += u64::from(message.log_time_nanos < latest_nanos);
            latest_nanos = latest_nanos.max(message.log_time_nanos);
        }
        assert_eq!(recording.late_count(), late_count);
        assert_eq!(recording.total_bytes(), file_bytes as u64);
        assert!(recording.bytes_read() <= recording.total_bytes());
        messages.damage = format!("{:?} {:?}", recording.damage(), recording.warnings());
        messages
    }
}
