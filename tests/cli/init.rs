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

/// A robot file of one cable, with these lines under `[log.columns]`.
fn one_cable(columns: &str) -> String {
    format!(
        "format = \"fric-robot/1\"\nname = \"b\"\ncycle_s = 0.01\n[log.columns]\n{columns}[[cable]]\nname = \"cable1\"\n\
         pulleys = [{{ wrap_deg = 90.0 }}]\nfriction = {{ mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.0 }}\n"
    )
}

/// A remark with as many cells as the table, and a second force whose place nobody can know.
#[test]
fn a_remark_is_no_header_and_a_second_force_is_offered_as_reference() {
    let place = Place::empty();
    let rows: String =
        (0..200).map(|at| format!("{},00;1,4{};{};1,5{}\n", 5 * at, at % 9, 3000 - at, at % 7)).collect();
    let header = "Prüfstand 3;Seil A;Datum;12.03.2026\nZeit [ms];Kraft Winde [kN];Seillänge [mm];Kraft Haken [kN]\n";
    place.write("run.csv", format!("{header}{rows}"));
    let text = drafted(&place, "run.csv");
    for part in [
        "cycle_s = 0.005 ",
        "\"time_s\" = { column = \"Zeit [ms]\", factor = 0.001 }",
        "\"cable1.force_n\" = { column = \"Kraft Winde [kN]\", factor = 1000.0 }",
        "# ? \"cable1.reference_n\" = { column = \"Kraft Haken [kN]\", factor = 1000.0 } # if this is the force at the platform",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    // The comment taken away, it is the reference.
    place.write("own.toml", text.replace("# ? \"cable1.reference_n\"", "\"cable1.reference_n\""));
    place.run(&["info", "run.csv", "--model", "own.toml"]).succeeds();
    assert!(place.run(&["replay", "run.csv", "--model", "own.toml"]).stdout.contains("against the reference"));
    // Without a second force a known load is the other way.
    place.write("run.csv", "time_s,F [N],l [m]\n0,1,2\n0.01,1,2.1\n0.02,1,2.2\n");
    place.run(&["init", "run.csv", "-o", "draft.toml", "--force"]).succeeds();
    let text = String::from_utf8(place.read("draft.toml")).unwrap();
    assert!(text.contains("{ constant_n = 49.05 } or reference = { hanging_mass_kg = 5.0 }"), "{text}");
}

/// A date takes no factor, whatever unit stands beside its name.
#[test]
fn dates_get_no_factor() {
    let place = Place::empty();
    let row = |at: i32| format!("03.05.2026 12:00:{:02},{:03};{};{}\n", at / 100, at % 100 * 10, 20 + at % 3, at);
    place.write("run.csv", format!("Zeit [ms];F [N];l [mm]\n{}", (0..300).map(row).collect::<String>()));
    let text = drafted(&place, "run.csv");
    assert!(text.contains("\"time_s\" = { column = \"Zeit [ms]\" }") && text.contains("cycle_s = 0.01 "), "{text}");
    place.run(&["convert", "run.csv", "--model", "draft.toml", "-o", "run.mcap"]).succeeds();
    place.write("own.toml", text.replace("\"Zeit [ms]\" }", "\"Zeit [ms]\", factor = 0.001 }"));
    place
        .run(&["convert", "run.csv", "--model", "own.toml", "-o", "own.mcap"])
        .fails(1, &["column `Zeit [ms]`: `03.05.2026 12:00:00,000` is a date or a time of day"])
        .advises(&["takes no factor", "remove", "`time_s`", "[log.columns]"]);
}

/// As many a script writes it.
#[test]
fn a_table_with_blanks_between_cells_is_drafted_and_replayed() {
    let place = Place::empty();
    let rows: String = (0..200)
        .map(|at| format!("{:.3}  1.9{}   0.{at:03}\t-0.{}\n", f64::from(at) * 0.01, at % 5, 3 + at % 4))
        .collect();
    place.write("run.csv", format!("time  load  position   torque\n{rows}"));
    let text = drafted(&place, "run.csv");
    for part in ["{ column = \"time\" }", "{ column = \"load\" }", "{ column = \"position\" }", "not used: torque"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    place.run(&["convert", "run.csv", "--model", "draft.toml", "-o", "run.mcap"]).succeeds();
    let states = super::logs::on_topic(&place.read("run.mcap"), "/cable_states", super::cdr::joint_state);
    assert_eq!((states.len(), states[7].position[0]), (200, 0.007));
    place.write("rows.csv", rows);
    place
        .run_in_vain(&["init", "rows.csv", "-o", "other.toml"])
        .fails(1, &["line 1: there are numbers where the names"]);
    place.write("mixed.csv", "time load position\n0 1 2\n1 2 3 4 5\n");
    place.run_in_vain(&["init", "mixed.csv", "-o", "other.toml"]).fails(1, &["one column alone, `time load position`"]);
}

/// A joint shows a torque, and a station of a kite its place, which never changes.
#[test]
fn what_is_no_length_is_not_taken_and_a_torque_is_offered() {
    let place = Place::empty();
    let rows: String =
        (0..200).map(|at| format!("{:.2},52.17,7.5,{at},0.{}\n", f64::from(at) * 0.01, at % 9)).collect();
    place.write("run.csv", format!("time,ground_pos_latitude,mast_pos,joint_pos,tau_measured\n{rows}"));
    let text = drafted(&place, "run.csv");
    for part in [
        "\"cable1.length_m\" = { column = \"joint_pos\" }",
        "# ? cable1.length_m: column \"mast_pos\" never changes",
        "# ? \"cable1.force_n\" = { column = \"tau_measured\" } # with a `factor` to newtons",
        "not used: ground_pos_latitude, tau_measured",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    place.write(
        "plain.toml",
        one_cable("time_s = { column = \"time\" }\n\"cable1.force_n\" = { column = \"tau_measuret\" }\n"),
    );
    place
        .run_in_vain(&["info", "run.csv", "--model", "plain.toml"])
        .fails(1, &["has no column `tau_measuret`, which the robot file names for `cable1.force_n`", "`tau_measured`?"])
        .advises(&["as it stands in the header"]);
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
