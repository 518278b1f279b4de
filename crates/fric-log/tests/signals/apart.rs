//! Signals of other times than the cable signal.

use fric_log::signals::Role;

use super::support::*;

const ADVICE: &str = "Record both at the same time and stamp them by one clock; a stamp of zero counts as the log time";

/// Cables and references of one second, stamped so much later than they are logged; 0 is no stamp.
fn log(cable_offset: Option<i64>, reference_offset: Option<i64>) -> Log {
    let mut log = Log::default();
    let stamp = |time: i64, offset: Option<i64>| offset.map_or(0, |offset| time + offset);
    for time in every(MS, 5 * S, 1000) {
        log.add("/cables", JOINT_STATES, time, cable(stamp(time, cable_offset), 1.0, 1.0));
        let reference = joints(stamp(time, reference_offset), &["a"], &[], &[], &[1.0]);
        log.add("/reference", JOINT_STATES, time, reference);
    }
    log
}

#[test]
fn both_ranges_are_told() {
    let stamped = "stamped 12.000 … 12.999 s";
    let logged = "logged, without stamps, 5.000 … 5.999 s";
    for (cables, references, theirs, its) in [
        (Some(0), Some(7 * S), "stamped 5.000 … 5.999 s", stamped),
        (Some(7 * S), Some(0), stamped, "stamped 5.000 … 5.999 s"),
        (None, Some(7 * S), logged, stamped),
        (Some(7 * S), None, stamped, logged),
    ] {
        let joined = log(cables, references).read_a();
        assert_eq!(joined.rows.len(), 1000);
        let told = format!(
            "reference signal `/reference`: none of its 1000 messages is of a time of the cable signal: it is {its}, the \
             cable signal {theirs}. {ADVICE}"
        );
        assert_eq!(joined.reader.warnings(), [told]);
        assert_eq!(joined.reader.times_apart(Role::Reference).unwrap().role, Role::Reference);
    }
}

#[test]
fn what_meets_anywhere_is_not_apart() {
    for offset in [999 * MS, -999 * MS] {
        let joined = log(Some(0), Some(offset)).read_a();
        assert_eq!(joined.rows.iter().filter(|row| row.reference_n[0].is_finite()).count(), 1);
        assert_eq!(joined.reader.warnings(), [""; 0]);
    }
    let joined = log(Some(0), Some(S)).read_a();
    assert!(joined.reader.times_apart(Role::Reference).is_some());
    assert!([Role::Cable, Role::Pose].iter().all(|role| joined.reader.times_apart(*role).is_none()));
}
