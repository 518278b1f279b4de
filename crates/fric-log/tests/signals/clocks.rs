//! Clocks that are set back, that are not set, or that have nothing to do with one another.

use fric_log::signals::{LengthWindow, Role};

use super::support::*;

/// One second of cables and references, and what the stamps are ahead of the log time.
fn second(log: &mut Log, start: i64, cable_offset: i64, reference_offset: i64, reference_interval: i64) {
    for time in every(MS, start, 1000) {
        let stamp = time + cable_offset;
        log.add("/cables", JOINT_STATES, time, cable(stamp, ms(time), ms(time)));
    }
    for time in every(reference_interval, start, S / reference_interval) {
        let stamp = time + reference_offset;
        log.add("/reference", JOINT_STATES, time, joints(stamp, &["a"], &[], &[], &[ms(time)]));
    }
}

fn known(joined: &Joined) -> Vec<bool> {
    joined.rows.iter().map(|row| row.reference_n[0].is_finite()).collect()
}

#[test]
fn all_clocks_set_back_together() {
    for step in [50 * MS, 500 * MS, 3000 * S] {
        for reference_interval in [MS / 4, MS, 4 * MS, 100 * MS] {
            let mut log = Log::default();
            let far = 4000 * S;
            second(&mut log, S, far, far, reference_interval);
            second(&mut log, 2 * S, far - step, far - step, reference_interval);
            let joined = log.read_a();
            let what = format!("{} ms, {} ms", ms(step), ms(reference_interval));
            assert_eq!(joined.rows.len(), 2000, "{what}");
            assert_eq!(joined.counts(Role::Cable)[3], 1, "{what}");
            // With a step below its interval, a topic goes on.
            assert_eq!(joined.counts(Role::Reference)[3], u64::from(step > reference_interval), "{what}");
            // Between the last message before and the first one after the step there is nothing to be known.
            let missing = usize::try_from(reference_interval / MS).unwrap().max(1);
            let unknown = known(&joined).iter().filter(|it| !**it).count();
            if step > reference_interval {
                assert!(unknown <= 2 * missing, "{what}: {unknown}");
                for row in joined.rows.iter().filter(|row| row.reference_n[0].is_finite()) {
                    assert_near(&row.reference_n, &row.force_n, &what);
                }
            }
            // No speed comes from lengths of both times.
            assert!(joined.rows.iter().all(|row| (row.speed_m_per_s[0] - 1000.0).abs() < 1e-6), "{what}");
        }
    }
}

#[test]
fn rows_that_wait_for_a_missing_topic_keep_what_they_have() {
    // The wrench never comes: at the step all rows are still waiting.
    let mut log = Log::default();
    second(&mut log, S, 100 * S, 100 * S, MS);
    second(&mut log, 2 * S, 0, 0, MS);
    let joined = log.read_a();
    assert!(joined.most_waiting > 900);
    assert!(known(&joined).iter().all(|known| *known));
}

#[test]
fn the_cable_clock_alone_is_set_back() {
    for step in [20 * MS, 300 * MS, 3000 * S] {
        let mut log = Log::default();
        second(&mut log, S, 4000 * S, 4000 * S, 4 * MS);
        second(&mut log, 2 * S, 4000 * S - step, 4000 * S, 4 * MS);
        let joined = log.read_a();
        assert_eq!(joined.rows.len(), 2000);
        assert_eq!((joined.counts(Role::Cable)[3], joined.counts(Role::Reference)[3]), (1, 0));
        let known = known(&joined);
        assert!(known[..996].iter().all(|known| *known));
        // As soon as the stamps meet again.
        let meet = usize::try_from((step / MS).min(1000)).unwrap();
        assert!(known[(1000 + meet + 20).min(2000)..1996.max(1000 + meet)].iter().all(|known| *known), "{step}");
    }
}

#[test]
fn the_other_clock_alone_is_set_back() {
    let mut log = Log::default();
    second(&mut log, S, 0, 300 * MS, 4 * MS);
    second(&mut log, 2 * S, 0, 0, 4 * MS);
    let joined = log.read_a();
    assert_eq!((joined.counts(Role::Cable)[3], joined.counts(Role::Reference)[3]), (0, 1));
    assert_eq!(joined.rows.len(), 2000);
    assert!(known(&joined)[1700..1996].iter().all(|known| *known));
}

#[test]
fn one_stamp_from_the_future() {
    let mut log = Log::default();
    second(&mut log, S, 0, 0, 4 * MS);
    log.add("/reference", JOINT_STATES, S + S / 2, joints(9000 * S, &["a"], &[], &[], &[1.0]));
    log.add("/cables", JOINT_STATES, S + S / 4, cable(9000 * S, 1.0, 1.0));
    let joined = log.read_a();
    assert_eq!(joined.rows.len(), 1001);
    let known = known(&joined).iter().filter(|known| **known).count();
    assert!(known >= 980, "{known}");
}

#[test]
fn without_a_stamp_the_log_time_is_the_time() {
    let mut log = Log::default();
    for time in every(MS, S, 40) {
        log.add("/cables", JOINT_STATES, time, cable(0, 1.0, 1.0));
        log.add("/wrench", WRENCHES, time + MS / 2, wrench(0, [ms(time); 6]));
    }
    let joined = log.read_a();
    assert_eq!(joined.stamps(), every(MS, S, 40).collect::<Vec<_>>());
    assert_near(&joined.rows[5].wrench.as_ref().unwrap()[..1], &[1004.5], "wrench");
}

#[test]
fn clocks_hours_apart_neither_hang_nor_fill_the_memory() {
    for offset in [7200 * S, -7200 * S] {
        let mut log = Log::default();
        for start in 0..30 {
            second(&mut log, (10_000 + start) * S, 0, offset, MS);
        }
        let joined = log.read_a();
        assert_eq!(joined.rows.len(), 30_000);
        assert!(!known(&joined).iter().any(|known| *known));
        assert!(joined.most_waiting <= 10_000 + LengthWindow::REACH as u64, "{}", joined.most_waiting);
    }
}
