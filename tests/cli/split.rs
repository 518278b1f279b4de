//! A recording split into files is one recording, in whichever order they are named.

use super::logs::{Storage, attached_robot, messages, rewrite};
use super::support::{Place, short_log};

#[test]
fn a_split_recording_replays_like_the_whole() {
    let log = short_log();
    let robot = attached_robot(log);
    let times: Vec<u64> = messages(log).iter().map(|message| message.log_time_nanos).collect();
    let cut = times[times.len() / 3];
    let place = Place::with_log();
    place.run(&["replay", "log.mcap", "-o", "whole.mcap"]).succeeds();
    let whole = place.read("whole.mcap");
    // A recorder attaches the robot file to the first part, or to each.
    for (case, second_robot) in [("first", None), ("each", Some(robot.as_str()))] {
        for storage in [Storage::Zstd, Storage::Unchunked] {
            place.write("part_0.mcap", rewrite(log, storage, Some(&robot), |_, time| time < cut));
            place.write("part_1.mcap", rewrite(log, storage, second_robot, |_, time| time >= cut));
            for parts in [["part_0.mcap", "part_1.mcap"], ["part_1.mcap", "part_0.mcap"]] {
                let arguments = [&["replay"], &parts[..], &["-o", "parts.mcap", "--force"]].concat();
                place.run(&arguments).succeeds();
                assert!(place.read("parts.mcap") == whole, "robot in {case}, {storage:?}, {parts:?}");
            }
        }
    }
    // One part alone is a log too; its first rows come before its first pose.
    place.run(&["replay", "part_1.mcap", "-o", "alone.mcap"]).warns(&["POSE_MISSING"]);
    assert!(place.read("alone.mcap").len() < whole.len());
}

#[test]
fn recordings_of_two_robots_are_not_parts_of_one() {
    let log = short_log();
    let (robot, times) = (attached_robot(log), messages(log));
    let cut = times[times.len() / 3].log_time_nanos;
    let place = Place::with_log();
    place.write("a.mcap", rewrite(log, Storage::Zstd, Some(&robot), |_, time| time < cut));
    let other = robot.replacen("mu = 0.0", "mu = 0.1", 1);
    assert_ne!(other, robot);
    place.write("b.mcap", rewrite(log, Storage::Zstd, Some(&other), |_, time| time >= cut));
    place.run(&["replay", "a.mcap", "b.mcap"]).fails(1, &["different robot files"]);
    // A file that is named holds for both.
    place.write("robot.toml", robot);
    place.run(&["replay", "a.mcap", "b.mcap", "--model", "robot.toml"]).succeeds();
}

#[test]
fn a_part_named_twice_counts_once() {
    let place = Place::with_log();
    place.run(&["replay", "log.mcap", "-o", "once.mcap"]).succeeds();
    let run = place.run(&["replay", "log.mcap", "log.mcap", "-o", "twice.mcap"]).warns(&["stamp used before"]);
    run.warns(&["`log.mcap` and `log.mcap`", "0.000 s to 0.399 s"]);
    assert!(place.read("twice.mcap") == place.read("once.mcap"));
}

#[test]
fn recordings_of_the_same_time_are_not_parts_of_one() {
    let place = Place::with_log();
    let log = short_log();
    let start = messages(log)[0].log_time_nanos;
    let part = |from_ms: u64, to_ms: u64| {
        let range = start + from_ms * 1_000_000..start + to_ms * 1_000_000;
        rewrite(log, Storage::Unchunked, Some(&attached_robot(log)), |_, time| range.contains(&time))
    };
    place.write("a.mcap", part(0, 250));
    place.write("b.mcap", part(150, 400));
    for command in ["replay", "info"] {
        for logs in [["a.mcap", "b.mcap"], ["b.mcap", "a.mcap"]] {
            let run = place.run(&[&[command], &logs[..]].concat());
            run.warns(&["`a.mcap` and `b.mcap`", "from 0.150 s to 0.249 s", "one split recording"]);
        }
    }
    // A few messages at the seam are none of a user's doing.
    place.write("b.mcap", part(245, 400));
    let run = place.run(&["info", "a.mcap", "b.mcap"]);
    assert!(!run.stderr.contains("split recording"), "{run:#?}");
}
