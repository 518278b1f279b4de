//! `init`: a robot file to start from.

use super::support::{Place, assert_close, short_log};

/// The drafted robot file of a log, and its text.
fn drafted(place: &Place, log: &str) -> String {
    place.run(&["init", log, "-o", "draft.toml"]).succeeds();
    String::from_utf8(place.read("draft.toml")).unwrap()
}

/// How many samples and cables a result of `replay` has.
fn counts(json: &[u8]) -> (u64, usize) {
    let replay: serde_json::Value = serde_json::from_slice(json).unwrap();
    let cables = replay["cables"].as_array().unwrap();
    (cables[0]["samples"].as_u64().unwrap(), cables.len())
}

#[test]
fn the_robot_file_of_a_log_of_messages_replays_it() {
    let place = Place::with_log();
    let text = drafted(&place, "log.mcap");
    place.run(&["replay", "log.mcap", "--json", "own.json"]).succeeds();
    place.run(&["replay", "log.mcap", "--model", "draft.toml", "--json", "drafted.json"]).warns(&[
        "cable1, cable2, cable3, cable4, cable5, cable6, cable7, cable8: the force by the sensor",
        "a sensor that holds a pulley of 180°",
    ]);
    assert_eq!(counts(&place.read("drafted.json")), counts(&place.read("own.json")));
    // The topics are the usual ones, the geometry cannot be known.
    assert!(!text.contains("[log]") && text.contains("cycle_s = 0.001 ") && text.contains("# ? base_m"), "{text}");
}

#[test]
fn columns_are_found_by_their_names_and_units() {
    let place = Place::empty();
    let rows: String = (0..200).map(|at| format!("{};3.0{};{};{at}\n", 2 * at, at % 7, 800 - at)).collect();
    place.write("run.csv", format!("Zeit [ms];Load cell 3 [kg];wound 3 (mm);note\n{rows}"));
    let text = drafted(&place, "run.csv");
    place.run(&["replay", "run.csv", "--model", "draft.toml", "--json", "replay.json"]).warns(&["no reference forces"]);
    assert_eq!(counts(&place.read("replay.json")), (200, 1));
    for part in [
        "cycle_s = 0.002 ",
        "name = \"cable3\"",
        "\"cable3.force_n\" = { column = \"Load cell 3 [kg]\", factor = 9.80665 }",
        "\"cable3.length_m\" = { column = \"wound 3 (mm)\", factor = 0.001 }",
        "# ? not used: note",
        "# ? reference: ",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    place.run(&["convert", "run.csv", "--model", "draft.toml", "-o", "run.mcap"]).succeeds();
    let states = super::logs::on_topic(&place.read("run.mcap"), "/cable_states", super::cdr::joint_state);
    assert_close(states[3].effort[0], 3.03 * 9.80665);
    assert_close(states[3].position[0], 0.797);
}

/// As a data logger with German settings writes it: lines about the recording, names, units, dates, decimal commas.
#[test]
fn a_loggers_own_file_is_read_with_its_dates_units_and_remarks() {
    let place = Place::empty();
    let row = |at: i32| {
        let (second, ms) = (at / 100, at % 100 * 10);
        format!("03.05.2024 12:00:{second:02},{ms:03};0,05{};{};0,07;OK\n", at % 9, at % 50)
    };
    let rows: String = (0..300).map(row).collect();
    let heading = "Messung 7;;;;\nRate;100;;;\n\nZeit;Seilkraft;Weg;Kraft Plattform;Zustand\n;kN;mm;kN;\n";
    place.write("run.csv", format!("{heading}{rows}"));
    let text = drafted(&place, "run.csv");
    for part in [
        "cycle_s = 0.01 ",
        "time_s = { column = \"Zeit\" }",
        "\"cable1.force_n\" = { column = \"Seilkraft\", factor = 1000.0 }",
        "\"cable1.length_m\" = { column = \"Weg\", factor = 0.001 }",
        "\"cable1.reference_n\" = { column = \"Kraft Plattform\", factor = 1000.0 }",
    ] {
        assert!(text.replace("\"time_s\"", "time_s").contains(part), "{part}: {text}");
    }
    place.run(&["convert", "run.csv", "--model", "draft.toml", "-o", "run.mcap"]).succeeds();
    let states = super::logs::on_topic(&place.read("run.mcap"), "/cable_states", super::cdr::joint_state);
    assert_eq!(states.len(), 300);
    assert_close(states[150].effort[0], 56.0);
    assert_close(states[150].position[0], 0.0);
}

#[test]
fn units_that_nothing_applies_are_told() {
    let place = Place::empty();
    let rows: String = (0..200).map(|at| format!("{},3{}.5,{}\n", f64::from(at) * 0.002, at % 7, at % 50)).collect();
    place.write("run.csv", format!("time_s,cable1.force_n,cable1.length_m\ns,N,mm\n{rows}"));
    let columns = "[log.columns]\n\"cable1.length_m\" = { column = \"cable1.length_m\", factor = 0.001 }\n";
    let robot = |columns: &str| {
        format!(
            "format = \"fric-robot/1\"\nname = \"b\"\ncycle_s = 0.002\n{columns}[[cable]]\nname = \"cable1\"\n\
             pulleys = [{{ wrap_deg = 90.0 }}]\nfriction = {{ mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.0 }}\n"
        )
    };
    place.write("plain.toml", robot(""));
    place.write("factor.toml", robot(columns));
    place
        .run(&["convert", "run.csv", "--model", "plain.toml", "-o", "a.mcap"])
        .warns(&["`cable1.length_m` is in mm", "factor"]);
    place.run(&["convert", "run.csv", "--model", "factor.toml", "-o", "b.mcap"]).succeeds();
}

#[test]
fn the_rate_is_found_though_a_column_is_not() {
    let place = Place::empty();
    let rows: String = (0..200).map(|at| format!("{},3.0{},{}\n", 4 * at, at % 7, at)).collect();
    place.write("run.csv", format!("t [ms],F [N],thing\n{rows}"));
    let text = drafted(&place, "run.csv");
    for part in ["cycle_s = 0.004 ", "# ? cable1.length_m: no column", "# ? not used: thing"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("\"cable1.length_m\" ="), "{text}");
}

#[test]
fn what_is_no_log_or_is_there_already_is_refused_and_nothing_written() {
    let place = Place::with_log();
    place.run(&["init", "none.mcap", "-o", "draft.toml"]).fails(1, &["none.mcap"]);
    assert!(!place.names().contains(&"draft.toml".to_owned()));
    place.run(&["init", "log.mcap", "-o", "log.mcap", "--force"]).fails(1, &["log.mcap"]);
    assert_eq!(place.read("log.mcap"), short_log());
    place.write("draft.toml", "mine");
    place.run(&["init", "log.mcap", "-o", "draft.toml"]).fails(1, &["draft.toml", "--force"]);
    assert_eq!(place.read("draft.toml"), b"mine");
}
