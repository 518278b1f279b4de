//! Bytes as a log of any kind, on the way that a replay takes: the robot file attached or one with CSV columns, the rows, the cycle.
#![no_main]

use std::fs;
use std::sync::LazyLock;

use fric_core::robot::file::RobotFile;
use fric_lab::replay::Replay;
use fric_log::log::Log;
use fric_log::robot::AttachedRobot;
use fric_log::signals::{SignalPaths, SignalReader};
use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

static PLACE: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder for logs"));
/// Robots with the columns of the seeds; a log of messages is read for the first.
static BENCHES: LazyLock<[RobotFile; 3]> = LazyLock::new(|| {
    [
        of_columns("time_s", "force", "length"),
        of_columns("Datum", "Kraft [kN]", "Weg (mm)"),
        of_columns("stamp_ns", "force_n", "length_m"),
    ]
});

/// Returns a robot of one cable with its own names of the columns.
fn of_columns(time: &str, force: &str, length: &str) -> RobotFile {
    let columns = format!(
        "time_s = {{ column = \"{time}\" }}\n\"winch.force_n\" = {{ column = \"{force}\", factor = 2.0 }}\n\
         \"winch.length_m\" = {{ column = \"{length}\", offset = 1.0 }}"
    );
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = 0.001\n[log.columns]\n{columns}\n[[cable]]\nname = \"winch\"\n\
         pulleys = [{{ wrap_deg = 180.0, sensor = true }}, {{ wrap_deg = 90.0 }}]\n\
         friction = {{ mu = 0.02, sigma_n_per_m = 900.0, viscous_n_s_per_m = 0.3 }}\n"
    );
    RobotFile::parse(&text, "bench").expect("a robot file")
}

fuzz_target!(|data: &[u8]| {
    let path = PLACE.path().join("log");
    fs::write(&path, data).expect("room for a log");
    let open = || Log::open(&[&path]);
    let Ok(log) = open() else { return };
    let attached = AttachedRobot::find(&log).ok().flatten();
    let names = log.column_names().unwrap_or_default();
    let has_columns = |robot: &&RobotFile| {
        let columns = &robot.options().log.columns;
        columns.values().any(|column| names.contains(&column.column))
    };
    let bench = BENCHES.iter().find(has_columns).unwrap_or(&BENCHES[0]);
    let robot = attached.as_ref().map_or(bench, |attached| &attached.robot);
    let rows = Rows::of(log, robot);
    assert_eq!(Rows::of(open().expect("a log that has been opened"), robot), rows);
});

/// What a log has to say, without the numbers themselves.
#[derive(Debug, PartialEq)]
struct Rows {
    count: u64,
    checksum: u64,
    warnings: Vec<String>,
    error: Option<String>,
}

impl Rows {
    fn of(log: Log, robot: &RobotFile) -> Option<Self> {
        let names = robot.cable_names();
        let paths = SignalPaths::of_robot(robot).ok()?;
        let mut replay = Replay::new(&robot.params()).ok()?;
        let mut reader = SignalReader::new(log, paths, &names);
        let mut rows = Self { count: 0, checksum: 0, warnings: Vec::new(), error: None };
        let mut latest_nanos = None;
        let end = loop {
            let sample = match reader.next_row() {
                Ok(Some(sample)) => sample,
                end => break end.map(|_| ()),
            };
            assert_eq!((sample.cables.len(), sample.reference_force_n.len()), (names.len(), names.len()));
            assert!(latest_nanos < Some(sample.stamp_nanos), "{latest_nanos:?} before {}", sample.stamp_nanos);
            latest_nanos = Some(sample.stamp_nanos);
            rows.count += 1;
            for output in replay.step(&sample).cables {
                let numbers = [output.force_at_platform_n, output.friction_n, output.frictionless_n];
                assert!(numbers.iter().all(|number| number.is_finite()), "{output:?}");
                rows.checksum = rows.checksum.rotate_left(7) ^ output.force_at_platform_n.to_bits();
            }
        };
        rows.error = end.err().map(|error| error.to_string());
        rows.warnings = [reader.log().warnings(), reader.warnings(), reader.robot_warnings(robot)].concat();
        Some(rows)
    }
}
