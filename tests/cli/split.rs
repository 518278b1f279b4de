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
fn a_part_named_twice_counts_once() {
    let place = Place::with_log();
    place.run(&["replay", "log.mcap", "-o", "once.mcap"]).succeeds();
    place.run(&["replay", "log.mcap", "log.mcap", "-o", "twice.mcap"]).warns(&["stamp used before"]);
    assert!(place.read("twice.mcap") == place.read("once.mcap"));
}
