//! Messages that name only some of the cables.

use fric_log::signals::Role;

use super::support::*;

/// A cycle of two cables each millisecond, a message a cable; the second is stamped so much later than the first.
fn apart(offset: i64) -> Log {
    let mut log = Log::default();
    for time in every(MS, S, 500) {
        for (name, stamp, number) in [("a", time, ms(time)), ("b", time + offset, -ms(time))] {
            log.add("/cables", JOINT_STATES, stamp, joints(stamp, &[name], &[number], &[], &[number]));
            log.add("/reference", JOINT_STATES, stamp, joints(stamp, &[name], &[], &[], &[number]));
        }
    }
    log
}

#[test]
fn those_of_one_stamp_are_one_row() {
    // With and without topics that the rows wait for.
    for paths in [&PATHS[..1], &PATHS[..2], &PATHS] {
        let joined = apart(0).read(paths, &["a", "b"]);
        assert_eq!(joined.stamps(), every(MS, S, 500).collect::<Vec<_>>());
        for row in &joined.rows {
            let time = ms(row.stamp_nanos);
            assert_near(&row.force_n, &[time, -time], "force");
            assert_near(&row.length_m, &[time, -time], "length");
            assert_near(&row.speed_m_per_s, &[1000.0, -1000.0], "speed");
            if paths.len() > 1 {
                assert_near(&row.reference_n, &[time, -time], "reference");
            }
        }
        assert_eq!(joined.counts(Role::Cable), [1000, 0, 0, 0, 0, 0]);
        assert_eq!(joined.reader.warnings(), [""; 0]);
        assert!(joined.reader.counts(Role::Cable).interval_nanos > 0.9e6);
    }
}

#[test]
fn those_of_other_stamps_are_told() {
    let joined = apart(300_000).read_two();
    assert_eq!(joined.rows.len(), 1000);
    let warnings = joined.reader.warnings();
    for (signal, warning) in ["cable signal `/cables`", "reference signal `/reference`"].iter().zip(&warnings) {
        let told = format!("{signal}: messages name only some of the cables at 998 of their stamps");
        assert!(warning.starts_with(&told) && warning.contains("one stamp"), "{warning}");
    }
    assert_eq!(warnings.len(), 2);
}

#[test]
fn what_a_cable_had_first_counts_and_what_is_nothing_new_is_a_duplicate() {
    let mut log = Log::default();
    for time in every(MS, S, 20) {
        log.add("/cables", JOINT_STATES, time, joints(time, &["a"], &[1.0], &[], &[1.0]));
        // The first of these has a speed, the sample so far has none.
        log.add("/cables", JOINT_STATES, time, joints(time, &["b", "a"], &[2.0, 9.0], &[0.5, 0.5], &[2.0, 9.0]));
        log.add("/cables", JOINT_STATES, time, joints(time, &["b"], &[8.0], &[8.0], &[8.0]));
    }
    let joined = log.read_two();
    assert_eq!(joined.counts(Role::Cable), [40, 20, 0, 0, 0, 0]);
    for row in &joined.rows {
        assert_near(&row.force_n, &[1.0, 2.0], "force");
        assert_near(&row.speed_m_per_s[1..], &[0.5], "speed");
    }
}

#[test]
fn a_topic_of_some_cables_is_as_it_should_be() {
    // The clock set back half-way, once alone and once for both.
    for reference_step in [0, 100 * S] {
        let mut log = Log::default();
        for (index, time) in (0..).zip(every(MS, 500 * S, 1000)) {
            let back = i64::from(index >= 500);
            let stamp = time - back * 100 * S;
            let number = [ms(time), ms(time)];
            log.add("/cables", JOINT_STATES, time, joints(stamp, &["a", "b"], &number, &[], &number));
            let stamp = time - back * reference_step;
            log.add("/reference", JOINT_STATES, time, joints(stamp, &["b"], &[], &[], &[ms(time)]));
        }
        let joined = log.read_two();
        assert_eq!(joined.rows.len(), 1000);
        let known = if reference_step == 0 { 500 } else { 1000 };
        for row in &joined.rows[..known] {
            assert_near(&row.reference_n, &[f64::NAN, row.force_n[1]], "reference");
        }
        assert_eq!(joined.reader.counts(Role::Reference).partial_count, 0);
    }
}

#[test]
fn a_clock_set_back_keeps_the_cables_together() {
    let mut log = Log::default();
    for (index, time) in (0..).zip(every(MS, 500 * S, 1000)) {
        let stamp = if index < 500 { time } else { time - 100 * S };
        for (name, number) in [("a", ms(time)), ("b", -ms(time))] {
            log.add("/cables", JOINT_STATES, time, joints(stamp, &[name], &[number], &[], &[number]));
        }
    }
    let joined = log.read_two();
    assert_eq!(joined.rows.len(), 1000);
    assert!(joined.rows.iter().all(|row| row.force_n[0].to_bits() == (-row.force_n[1]).to_bits()));
    assert_eq!((joined.counts(Role::Cable)[3], joined.reader.counts(Role::Cable).partial_count), (1, 0));
}

impl Log {
    fn read_two(&self) -> Joined {
        self.read(&PATHS[..2], &["a", "b"])
    }
}
