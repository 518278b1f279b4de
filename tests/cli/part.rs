//! A part of a log: `--start` and `--end`.

use serde_json::Value;

use super::cdr::joint_state;
use super::discover::hidden_stribeck;
use super::logs::on_topic;
use super::support::{Place, short_log};

fn stamps(log: &[u8]) -> Vec<u64> {
    on_topic(log, "/cable_states", |data| joint_state(data).stamp_nanos)
}

/// The stamps of a replay of a part, which the log's own say what they have to be.
fn replayed(place: &Place, part: &[&str]) -> Vec<u64> {
    place.run(&[&["replay", "log.mcap", "-o", "out.mcap", "--json", "r.json", "--force"], part].concat()).succeeds();
    on_topic(&place.read("out.mcap"), "/fric/cable_forces", |data| joint_state(data).stamp_nanos)
}

#[test]
fn a_replay_of_a_part_has_its_rows() {
    let place = Place::with_log();
    let all = stamps(short_log());
    let within = |from_ms: u64, to_ms: u64| -> Vec<u64> {
        let since_start = |stamp: &u64| (stamp - all[0]) / 1_000_000;
        all.iter().copied().filter(|stamp| (from_ms..to_ms).contains(&since_start(stamp))).collect()
    };
    assert_eq!(replayed(&place, &["--start", "0.1", "--end", "0.25"]), within(100, 250));
    assert_eq!(place.json("r.json")["cables"][0]["samples"], 150);
    assert_eq!(replayed(&place, &["--end", "0.05"]), within(0, 50));
    assert_eq!(replayed(&place, &["--start=0.39"]), within(390, 400));
    assert_eq!(replayed(&place, &["--start", "0", "--end", "1e3"]), all);
}

#[test]
fn info_counts_what_is_in_the_part() {
    let place = Place::with_log();
    place.run(&["info", "log.mcap", "--start", "0.1", "--end", "0.3", "--json", "i.json"]).succeeds();
    let info = place.json("i.json");
    let of = |list: &str, key: &str, name: &str| -> Value {
        let items = info[list].as_array().unwrap();
        items.iter().find(|item| item[key] == name).unwrap()["messages"].clone()
    };
    assert_eq!(of("topics", "topic", "/cable_states"), 200);
    assert_eq!(of("topics", "topic", "/platform_pose"), 50);
    let used = of("signals", "signal", "cable").as_u64().unwrap();
    // Rows wait for a few messages of the others.
    assert!((190..=210).contains(&used), "{used}");
}

#[test]
fn a_part_that_is_none_is_told() {
    let place = Place::with_log();
    let run = |arguments: &[&str]| place.run_in_vain(&[&["replay", "log.mcap"], arguments].concat());
    run(&["--start", "2", "--end", "2"]).fails(2, &["--start 2 is not before --end 2"]);
    run(&["--start=-1"]).fails(2, &["--start", "0 or greater"]);
    run(&["--end", "nan"]).fails(2, &["--end", "number of seconds"]);
    run(&["--start", "7.5"]).fails(1, &["no row of the log is from 7.5 s on: its last is 0.399 s after its first"]);
    run(&["--start", "0.1001", "--end", "0.1002"])
        .fails(1, &["to before 0.1002 s: its next is 0.101 s after its first"]);
    place.run_in_vain(&["discover", "log.mcap", "--start", "7", "--end", "8"]).fails(1, &["from 7 s to before 8 s"]);
}

#[test]
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples"
)]
fn a_fit_of_a_part_takes_its_samples() {
    let place = Place::empty();
    place.write("log.mcap", hidden_stribeck());
    let interval_s = 25.0 / stamps(hidden_stribeck()).len() as f64;
    let fit = |log: &str, part: &[&str]| {
        let run = place.run(&[&["fit", log, "-o", "f.toml", "--json", "f.json", "--force"], part].concat());
        assert_eq!(run.code, Some(0), "{run:#?}");
        place.json("f.json")["cables"][0]["samples"].as_u64().unwrap()
    };
    let (whole, part) = (fit("log.mcap", &[]), fit("log.mcap", &["--start", "5", "--end", "15"]));
    let most = (10.0 / interval_s).round() as u64;
    // A part begins with samples that do not count too, no more than the whole log has.
    let left_out = (25.0 / interval_s).round() as u64 - whole;
    assert!(part < whole && (most - left_out..=most).contains(&part), "{part} of {whole}");
}
