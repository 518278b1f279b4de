//! Bytes as a log, on the way that a replay takes: the recording, the robot file attached, the rows, the cycle.
#![no_main]

use std::fs;
use std::sync::LazyLock;

use fric_core::robot::file::RobotFile;
use fric_lab::replay::Replay;
use fric_log::log::Log;
use fric_log::recording::Recording;
use fric_log::robot::AttachedRobot;
use fric_log::signals::{SignalPaths, SignalReader};
use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

static PLACE: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder for logs"));
static ROBOT: LazyLock<RobotFile> = LazyLock::new(|| {
    RobotFile::parse(include_str!("../../examples/mini-ipanema.toml"), "example").expect("the example")
});

fuzz_target!(|data: &[u8]| {
    let path = PLACE.path().join("log.mcap");
    fs::write(&path, data).expect("room for a log");
    let open = || Recording::open(&[&path]);
    let Ok(recording) = open() else { return };
    let messages = Messages::of(recording, data.len());
    assert_eq!(Messages::of(open().expect("a log that has been read"), data.len()), messages);

    let log = Log::from(open().expect("a log that has been read"));
    let attached = AttachedRobot::find(&log).ok().flatten();
    let robot = attached.as_ref().map_or(&*ROBOT, |attached| &attached.robot);
    let Ok(paths) = SignalPaths::of_robot(robot) else { return };
    let names = robot.cable_names();
    let Ok(mut replay) = Replay::new(&robot.params()) else { return };
    let mut rows = SignalReader::new(log, paths, &names);
    while let Ok(Some(sample)) = rows.next_row() {
        assert_eq!((sample.cables.len(), sample.reference_force_n.len()), (names.len(), names.len()));
        let cycle = replay.step(&sample);
        for output in cycle.cables {
            let numbers = [output.force_at_platform_n, output.friction_n, output.frictionless_n];
            assert!(numbers.iter().all(|number| number.is_finite()), "{output:?}");
        }
    }
    let _ = (rows.warnings(), rows.log().warnings());
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
