//! What is said when there are no rows.

use super::support::*;
use fric_log::signals::Role;

#[track_caller]
fn assert_says(sentence: &str, parts: &[&str]) {
    for part in parts {
        assert!(sentence.contains(part), "`{part}` is not in: {sentence}");
    }
}

#[test]
fn a_missing_topic_is_named_with_those_there_are() {
    let mut log = Log::default();
    log.references(every(MS, S, 3));
    log.add("/other", WRENCHES, S, wrench(S, [0.0; 6]));
    let joined = log.read_a();
    assert!(joined.rows.is_empty());
    let parts = ["no messages on `/cables`", "it has /other, /reference. Name the right one as `cable` under `[log]`"];
    assert_says(&joined.sentence(), &parts);
    assert_says(&Log::default().read_a().sentence(), &["no messages on `/cables`", "no other topics"]);
}

#[test]
fn the_wrong_type_is_named_with_what_it_has() {
    let mut log = Log::default();
    log.add("/cables", WRENCHES, S, wrench(S, [0.0; 6]));
    let parts = ["`/cables`", "no member `effort`; it has header, wrench", "as `cable` under `[log]`"];
    assert_says(&log.read_a().sentence(), &parts);
}

#[test]
fn forces_without_lengths_ask_for_the_lengths() {
    let kind = ("demo/Forces", "ros2msg", &b"float64[] effort"[..], "cdr");
    let mut log = Log::default();
    log.add("/cables", kind, S, Cdr::default().array(&[1.0]).bytes());
    assert_says(&log.read_a().sentence(), &["`/cables`", "no cable lengths", "as `length` under `[log]`"]);
    let mut log = Log::default();
    for stamp in every(MS, S, 5) {
        log.add("/cables", JOINT_STATES, stamp, joints(stamp, &["a"], &[], &[1.0], &[1.0]));
    }
    assert_says(&log.read_a().sentence(), &["`/cables`", "no cable lengths", "as `length` under `[log]`"]);
}

#[test]
fn foreign_names_are_listed() {
    let mut log = Log::default();
    log.add("/cables", JOINT_STATES, S, joints(S, &["x", "y"], &[1.0, 2.0], &[], &[1.0, 2.0]));
    assert_says(&log.read_a().sentence(), &["`/cables`", "none of the robot's cables (a), but x, y"]);
    let mut log = Log::default();
    log.add("/cables", JOINT_STATES, S, joints(S, &[], &[1.0], &[], &[1.0]));
    assert_says(&log.read_a().sentence(), &["none of the robot's cables (a), but nothing at all"]);
}

#[test]
fn another_signal_that_cannot_be_read_is_said_but_does_not_stop_the_rows() {
    let mut log = Log::default();
    log.cables(every(MS, S, 100));
    log.add("/pose", WRENCHES, S, wrench(S, [0.0; 6]));
    let joined = log.read_a();
    assert_eq!(joined.rows.len(), 100);
    assert_says(joined.problem(Role::Pose), &["pose.position.x", "no member `pose`; it has header, wrench"]);
}
