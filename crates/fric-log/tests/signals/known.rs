//! References that are known and not measured.

use std::path::Path;

use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Sample};
use fric_log::recording::Recording;
use fric_log::signals::{Role, SignalPaths, SignalReader, StatedSignals};
use tempfile::TempDir;

use super::support::{JOINT_STATES, Log, MS, S, joints};

/// Rows `[force, length, reference]` of cable `a` of a bench whose robot file says this of the reference.
fn rows(log: &Log, reference: &str) -> Vec<[f64; 3]> {
    let text = format!(
        "format = 'fric-robot/1'\nname = 'bench'\ncycle_s = 0.001\n[log]\ncable = '/cables'\nreference = {reference}\n\
         [platform]\ngravity_m_per_s2 = [0.0, 0.0, -10.0]\n[[cable]]\nname = 'a'\npulleys = [{{ wrap_deg = 90.0 }}]\n"
    );
    let paths = SignalPaths::of_robot(&RobotFile::parse(&text, "bench").unwrap()).unwrap();
    let mut reader = SignalReader::new(Recording::open(&[log.file().path()]).unwrap(), paths, &["a"]);
    let mut rows = Vec::new();
    while let Some(row) = reader.next_row().unwrap() {
        rows.push([row.cables[0].sensor_force_n, row.cables[0].length_m, row.reference_force_n[0]]);
    }
    rows
}

/// A log of cable `a` whose length is this over the time in s; the force is the number of the sample.
fn moving(times_s: impl IntoIterator<Item = f64>, length_m: impl Fn(f64) -> f64) -> Log {
    let mut log = Log::default();
    for (number, time_s) in times_s.into_iter().enumerate() {
        #[expect(clippy::cast_possible_truncation, reason = "nanoseconds")]
        let stamp = S + (time_s * 1e9).round() as i64;
        #[expect(clippy::cast_precision_loss, reason = "a count, and nanoseconds")]
        let (force_n, since_s) = (number as f64, (stamp - S) as f64 * 1e-9);
        log.add("/cables", JOINT_STATES, stamp, joints(stamp, &["a"], &[length_m(since_s)], &[], &[force_n]));
    }
    log
}

fn milliseconds(count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(|number| f64::from(number) * 1e-3)
}

#[test]
fn a_constant_is_the_reference_of_every_row_with_a_force() {
    let mut log = moving(milliseconds(50), |time_s| time_s);
    log.add("/cables", JOINT_STATES, S + 50 * MS, joints(S + 50 * MS, &["a"], &[0.05], &[], &[f64::NAN]));
    let rows = rows(&log, "{ constant_n = 49.05 }");
    assert_eq!(rows.len(), 51);
    assert!(rows[..50].iter().all(|row| row[2].to_bits() == 49.05_f64.to_bits()));
    assert!(rows[50][2].is_nan());
}

#[test]
fn a_hanging_mass_pulls_less_while_it_falls_faster() {
    // Constant acceleration, at a constant rate and at one that varies between 3 and 9 ms: F = m·(g − a).
    let uneven = (0..200).map(|number| f64::from(number) * 6e-3 + 3e-3 * (f64::from(number) * 1.7).sin().abs());
    // And at one that is slower than the window: between 31 and 40 ms.
    let slow = (0..60).map(|number| f64::from(number) * 35e-3 + 2e-3 * (f64::from(number) * 1.7).sin());
    for times_s in [milliseconds(400).collect::<Vec<_>>(), uneven.collect(), slow.collect()] {
        for acceleration in [0.0, 0.4, -0.4] {
            let log = moving(times_s.clone(), |time_s| 1.0 + 0.2 * time_s + 0.5 * acceleration * time_s * time_s);
            let rows = rows(&log, "{ hanging_mass_kg = 5.0 }");
            assert_eq!(rows.len(), times_s.len());
            let (first_s, last_s) = (times_s[0], times_s[times_s.len() - 1]);
            for (row, time_s) in rows.iter().zip(&times_s) {
                if *time_s - first_s > 0.06 && last_s - *time_s > 0.06 {
                    assert!((row[2] - 5.0 * (10.0 - acceleration)).abs() < 1e-6, "{time_s}: {row:?}");
                }
                // Two windows of 20 ms are missing at the ends.
                assert!(row[2].is_finite() || *time_s - first_s < 0.06 || last_s - *time_s < 0.06, "{time_s} {row:?}");
            }
            assert!(rows[0][2].is_nan() && rows[rows.len() - 1][2].is_nan());
        }
    }
}

#[test]
fn the_weight_is_not_known_where_the_motion_is_not_quiet() {
    // A trapezoid: rest, 2 m/s² from 0.2 s to 0.3 s, then 0.2 m/s.
    let length_m = |time_s: f64| {
        let ramp_s = (time_s - 0.2).clamp(0.0, 0.1);
        1.0 + ramp_s * ramp_s + 0.2 * (time_s - 0.3).max(0.0)
    };
    let rows = rows(&moving(milliseconds(600), length_m), "{ hanging_mass_kg = 5.0 }");
    let known: Vec<usize> = (0..rows.len()).filter(|row| rows[*row][2].is_finite()).collect();
    assert!(known.iter().all(|row| (40..=180).contains(row) || (320..=560).contains(row)), "{known:?}");
    assert!(known.len() > 120 + 220, "{}", known.len());
    assert!(known.iter().all(|row| (rows[*row][2] - 50.0).abs() <= 5.0 * 0.5), "{known:?}");
    // What is before the ramp or behind it by more than a window and a difference is the weight itself.
    assert!([100, 150, 400, 500].iter().all(|row| (rows[*row][2] - 50.0).abs() < 1e-6));
}

#[test]
fn rows_come_whole_and_in_order_over_gaps_and_a_clock_that_is_set_back() {
    let mut log = moving(milliseconds(100).chain((0..100).map(|number| 1.0 + f64::from(number) * 1e-3)), |_| 1.0);
    // The clock goes back by a second, long after in the order of logging.
    for number in 0..100 {
        let (logged, stamp) = (4 * S + number * MS, S / 2 + number * MS);
        log.add("/cables", JOINT_STATES, logged, joints(stamp, &["a"], &[1.0], &[], &[1.0]));
    }
    let (known, plain) = (rows(&log, "{ hanging_mass_kg = 1.0 }"), rows(&log, "'/none'"));
    assert_eq!(known.len(), plain.len());
    assert!(known.iter().zip(&plain).all(|(known, plain)| known[..2] == plain[..2]));
    // Each of the three stretches of 100 ms lacks 40 ms at either end.
    let count = known.iter().filter(|row| (row[2] - 10.0).abs() < 1e-9).count();
    assert!((3 * 18..=3 * 24).contains(&count), "{count}");
}

fn cables_only() -> SignalPaths {
    SignalPaths::default().with(Role::Cable, Some("/cables".parse().unwrap()))
}

/// Returns the bits of each row's length, speed and reference; through a log, and from samples that are no log's.
fn speeds(path: &Path, of_log: &str) -> [Vec<[u64; 3]>; 2] {
    let text = |of_log: &str| {
        format!(
            "format = 'fric-robot/1'\nname = 'bench'\ncycle_s = 0.001\n[log]\ncable = '/cables'\n{of_log}\n[[cable]]\nname = 'a'\n\
             pulleys = [{{ wrap_deg = 90.0 }}]\n"
        )
    };
    let paths = |of_log| SignalPaths::of_robot(&RobotFile::parse(&text(of_log), "bench").unwrap()).unwrap();
    let reader = |paths| SignalReader::new(fric_log::log::Log::open(&[path]).unwrap(), paths, &["a"]);
    let bits = |row: &Sample<'_>| {
        [row.cables[0].length_m, row.cables[0].speed_m_per_s, row.reference_force_n[0]].map(f64::to_bits)
    };
    let (mut of_rows, mut of_samples) = (Vec::new(), Vec::new());
    let mut rows = reader(paths(of_log));
    while let Some(row) = rows.next_row().unwrap() {
        of_rows.push(bits(&row));
    }
    if let Some(mut stated) = StatedSignals::of(&paths(of_log)) {
        let mut rows = reader(paths(""));
        while let Some(row) = rows.next_row().unwrap() {
            stated.push(&row);
            while let Some(sample) = stated.next_sample() {
                of_samples.push(bits(&sample));
            }
        }
        stated.end();
        while let Some(sample) = stated.next_sample() {
            of_samples.push(bits(&sample));
        }
    }
    [of_rows, of_samples]
}

#[test]
fn speeds_from_the_lengths_take_the_place_of_those_of_the_log() {
    let (mut with, mut without) = (Log::default(), Log::default());
    for number in 0..300_i32 {
        let stamp = S + i64::from(number) * MS;
        let length_m = 1.0 + 0.1 * (0.02 * f64::from(number)).sin();
        with.add("/cables", JOINT_STATES, stamp, joints(stamp, &["a"], &[length_m], &[7.0], &[3.0]));
        without.add("/cables", JOINT_STATES, stamp, joints(stamp, &["a"], &[length_m], &[], &[3.0]));
    }
    let folder = TempDir::new().unwrap();
    let table = |log: &Log, name: &str, head: &str| {
        let mut text = format!("time_s,a.force_n,a.length_m{head}\n");
        let mut rows = SignalReader::new(Recording::open(&[log.file().path()]).unwrap(), cables_only(), &["a"]);
        while let Some(row) = rows.next_row().unwrap() {
            let CableInput { sensor_force_n, length_m, .. } = row.cables[0];
            #[expect(clippy::cast_precision_loss, reason = "milliseconds")]
            let time_s = (row.stamp_nanos / MS) as f64 * 1e-3;
            text += &format!("{time_s:.3},{sensor_force_n},{length_m}{}\n", if head.is_empty() { "" } else { ",7" });
        }
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let tables = [table(&with, "with.csv", ",a.speed_m_per_s"), table(&without, "without.csv", "")];
    let [with, without] = [&with, &without].map(Log::file);
    for [with, without] in [[with.path(), without.path()], [&tables[0], &tables[1]]] {
        for known in ["", "reference = { hanging_mass_kg = 5.0 }\n"] {
            let [derived, _] = speeds(without, known);
            assert_eq!(derived.len(), 300);
            assert_ne!(speeds(with, known)[0], derived);
            assert_eq!(speeds(with, &format!("{known}speed = 'lengths'\n")), [derived.clone(), derived]);
        }
    }
}
