//! How long rows wait for other topics.

use fric_log::signals::{LengthWindow, Role, WAIT_NANOS, WAITING_LIMIT};

/// Rows that wait for the lengths that their speed depends on.
const FOR_SPEED: u64 = LengthWindow::REACH as u64;

use super::support::*;

#[test]
fn a_topic_that_stops_holds_a_bounded_number_of_rows() {
    let mut log = Log::default();
    log.cables(every(MS, S, 25_000));
    log.references(every(MS, S, 500));
    let joined = log.read(&PATHS[..2], &["a"]);
    assert_eq!(joined.rows.len(), 25_000);
    assert!(joined.most_waiting <= WAIT_NANOS / 1_000_000 + FOR_SPEED, "{}", joined.most_waiting);
    assert_eq!(joined.rows.iter().filter(|row| row.reference_n[0].is_finite()).count(), 500);
}

#[test]
fn log_times_that_stand_still_do_not_fill_the_memory() {
    let count = 3 * i64::try_from(WAITING_LIMIT).unwrap();
    let mut log = Log::default();
    for stamp in every(MS, S, count) {
        log.add("/cables", JOINT_STATES, S, cable(stamp, 1.0, 1.0));
    }
    let joined = log.read_a();
    assert_eq!(joined.rows.len(), 3 * WAITING_LIMIT);
    assert!(joined.most_waiting <= WAITING_LIMIT as u64 + FOR_SPEED);
}

#[test]
fn topics_slower_than_a_second_are_joined() {
    let mut log = Log::default();
    log.cables(every(10 * MS, S, 4000));
    log.references(every(3 * S, S, 13));
    let joined = log.read_a();
    let known = joined.rows.iter().filter(|row| row.reference_n[0].is_finite());
    assert_eq!(known.inspect(|row| assert_near(&row.reference_n, &row.force_n, "reference")).count(), 3601);
    assert_eq!(joined.counts(Role::Reference), [13, 0, 0, 0, 0, 0]);
}

#[test]
fn without_other_topics_a_row_waits_for_the_lengths_of_its_speed_only() {
    let mut log = Log::default();
    log.cables(every(MS, S, 100));
    let joined = log.read(&PATHS[..1], &["a"]);
    assert_eq!((joined.rows.len(), joined.most_waiting), (100, FOR_SPEED));
}

#[test]
fn the_pauses_between_bursts_of_log_times_are_soon_usual() {
    let mut log = Log::default();
    log.cables(every(MS, S, 1000));
    for burst in every(20 * MS, S, 50) {
        for time in every(1000, burst, 5) {
            log.add("/reference", JOINT_STATES, time, joints(0, &["a"], &[], &[], &[ms(time)]));
        }
    }
    let joined = log.read_a();
    assert!(joined.counts(Role::Reference)[4] <= 4);
    assert!(joined.rows[100..980].iter().all(|row| row.reference_n[0].is_finite()));
}
