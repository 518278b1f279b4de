//! CSV in place of MCAP: the same run gives the same results, whatever the columns are called and the units are.

use std::collections::BTreeMap;

use serde_json::Value;

use super::cdr::{joint_state, pose, wrench};
use super::discover::{hidden_stribeck, two_cables};
use super::logs::messages;
use super::support::{Place, example_robot, short_log, unwrapped};

/// The signals of a log by time and column, as its messages have them.
struct Rows {
    /// In the order in which they come up.
    columns: Vec<String>,
    rows: BTreeMap<u64, BTreeMap<String, f64>>,
}

impl Rows {
    fn of(log: &[u8]) -> Self {
        let mut all = Self { columns: Vec::new(), rows: BTreeMap::new() };
        for message in messages(log) {
            match message.topic.as_str() {
                "/cable_states" => {
                    let it = joint_state(&message.data);
                    for (cable, name) in it.names.iter().enumerate() {
                        all.add(it.stamp_nanos, format!("{name}.force_n"), it.effort[cable]);
                        all.add(it.stamp_nanos, format!("{name}.length_m"), it.position[cable]);
                        all.add(it.stamp_nanos, format!("{name}.speed_m_per_s"), it.velocity[cable]);
                    }
                }
                "/reference_forces" => {
                    let it = joint_state(&message.data);
                    for (name, effort) in it.names.iter().zip(it.effort) {
                        all.add(it.stamp_nanos, format!("{name}.reference_n"), effort);
                    }
                }
                "/platform_pose" => all.add_vector(pose(&message.data), "pose", "x_m y_m z_m qx qy qz qw"),
                "/platform_wrench" => {
                    all.add_vector(wrench(&message.data), "wrench", "fx_n fy_n fz_n tx_nm ty_nm tz_nm");
                }
                other => panic!("{other}"),
            }
        }
        all
    }

    fn add(&mut self, stamp_nanos: u64, column: String, value: f64) {
        if !self.columns.contains(&column) {
            self.columns.push(column.clone());
        }
        self.rows.entry(stamp_nanos).or_default().insert(column, value);
    }

    fn add_vector<const COUNT: usize>(&mut self, (stamp_nanos, values): (u64, [f64; COUNT]), group: &str, names: &str) {
        for (name, value) in names.split(' ').zip(values) {
            self.add(stamp_nanos, format!("{group}.{name}"), value);
        }
    }

    /// The columns as they are, with numbers to the last bit.
    fn plain(&self) -> String {
        let mut text = format!("time_s,{}\n", self.columns.join(","));
        for (stamp, values) in &self.rows {
            let cell =
                |column: &String| values.get(column).map_or_else(|| ",".to_owned(), |value| format!(",{value:?}"));
            let cells: String = self.columns.iter().map(cell).collect();
            text += &format!("{}.{:09}{cells}\n", stamp / 1_000_000_000, stamp % 1_000_000_000);
        }
        text
    }

    /// As a lab would have it: other names, kilograms, millimetres, wound length, semicolons and decimal commas; and what
    /// the robot file has to say of it.
    fn foreign(&self) -> (String, String) {
        let mut columns = String::from("[log.columns]\ntime_s = { column = \"Zeit [ms]\", factor = 0.001 }\n");
        let mut header = String::from("\u{feff}# Prüfstand 3\nZeit [ms]");
        let foreign: Vec<(String, f64)> = self
            .columns
            .iter()
            .map(|key| match key.split_once('.').unwrap() {
                (cable, "force_n") => (format!("\"Kraft; {cable} [kg]\""), 9.80665),
                (cable, "length_m") => (format!("gewickelt {cable} [mm]"), -0.001),
                (cable, "speed_m_per_s") => (format!("Tempo {cable} [mm/s]"), -0.001),
                _ => (key.clone(), 1.0),
            })
            .collect();
        for (key, (name, factor)) in self.columns.iter().zip(&foreign) {
            header += &format!(";{name}");
            if factor.to_bits() != 1.0_f64.to_bits() {
                columns += &format!("{key:?} = {{ column = {:?}, factor = {factor} }}\n", name.trim_matches('"'));
            }
        }
        let mut text = header + "\r\n";
        for (stamp, values) in &self.rows {
            let mut line = format!("{}.{:06}", stamp / 1_000_000, stamp % 1_000_000);
            for (key, (_, factor)) in self.columns.iter().zip(&foreign) {
                line += &values.get(key).map_or_else(|| ";".to_owned(), |value| format!(";{:?}", value / factor));
            }
            text += &(line.replace('.', ",") + "\r\n");
        }
        (text, columns)
    }
}

/// A result without what differs from run to run.
fn without_times(mut result: Value) -> Value {
    result.as_object_mut().unwrap().remove("cycle");
    result
}

/// What is printed, without the line about the duration of a cycle and the name of the log.
fn printed(text: &str) -> Vec<String> {
    let lines = text.lines().filter(|line| !line.contains(" cycles; one takes "));
    lines.map(|line| line.replace("foreign.csv", "LOG").replace("log.mcap", "LOG")).collect()
}

fn with_columns(robot: &str, columns: &str) -> String {
    robot.replacen("[[cable]]", &format!("{columns}\n[[cable]]"), 1)
}

#[test]
fn a_table_with_the_numbers_of_a_log_is_replayed_to_the_same_bits() {
    let place = Place::with_log();
    place.write("plain.csv", Rows::of(short_log()).plain());
    let replay = |log: &str, out: &str| {
        place.run(&["replay", log, "--model", "robot.toml", "-o", out, "--json", "r.json", "--force"]).succeeds();
        (messages(&place.read(out)), without_times(place.json("r.json")))
    };
    assert!(replay("log.mcap", "a.mcap") == replay("plain.csv", "b.mcap"));
}

#[test]
fn other_names_units_and_signs_give_what_the_log_gives_to_the_printed_digit() {
    let place = Place::with_log();
    let (text, columns) = Rows::of(short_log()).foreign();
    place.write("foreign.csv", text);
    place.write("foreign.toml", with_columns(&example_robot(), &columns));
    let replay = |arguments: &[&str]| printed(&place.run(&[&["replay"], arguments].concat()).succeeds().stdout);
    assert_eq!(replay(&["foreign.csv", "--model", "foreign.toml"]), replay(&["log.mcap"]));

    let info = place.run(&["info", "foreign.csv", "--model", "foreign.toml", "--json", "i.json"]).succeeds().stdout;
    assert!(info.contains("Kraft; cable1 [kg]") && info.contains("9.80665") && info.contains("possible"), "{info}");
    assert!(info.contains("rows:        400, 1000.0 Hz, longest gap 1.000 ms"), "{info}");
    let info = place.json("i.json");
    assert_eq!(info["columns"][1]["signal"], "cable1.force_n");
    assert_eq!(info["signals"][0]["messages"], 400);
}

#[test]
fn fit_and_discovery_of_a_table_are_those_of_the_log() {
    let place = Place::empty();
    let (text, columns) = Rows::of(hidden_stribeck()).foreign();
    place.write("log.mcap", hidden_stribeck());
    place.write("robot.toml", two_cables());
    place.write("foreign.csv", text);
    place.write("foreign.toml", with_columns(&two_cables(), &columns));
    let print = |command: &str, log: &str, model: &str| {
        printed(&place.run(&[command, log, "--model", model, "-o", "out.toml", "--force"]).succeeds().stdout)
    };
    for command in ["fit", "discover"] {
        assert_eq!(
            print(command, "foreign.csv", "foreign.toml"),
            print(command, "log.mcap", "robot.toml"),
            "{command}"
        );
    }
    // The file that comes out reads the same log.
    let fitted = String::from_utf8(place.read("out.toml")).unwrap();
    assert!(fitted.contains("stribeck"), "{fitted}");
}

#[test]
fn what_is_missing_in_a_table_is_told_in_a_sentence() {
    let place = Place::with_log();
    place.write("run.csv", "t,F1,L1\n0,1,2\n0.001,1,2\n");
    for command in ["replay", "hysteresis"] {
        place
            .run_in_vain(&[command, "run.csv", "--model", "robot.toml"])
            .fails(1, &["`run.csv` has no column `time_s`; it has `t`, `F1`, `L1`"])
            .advises(&["[log.columns]", "column ="]);
    }
    place.run_in_vain(&["fit", "run.csv", "--model", "robot.toml", "-o", "f.toml"]).fails(1, &["no column `time_s`"]);
    place.run_in_vain(&["discover", "run.csv", "--model", "robot.toml"]).fails(1, &["no column `time_s`"]);
    for command in ["replay", "discover"] {
        place.run_in_vain(&[command, "run.csv"]).fails(1, &["no robot file"]).advises(&["fric-cli init", "--model"]);
    }
    let info = place.run(&["info", "run.csv"]).succeeds().stdout;
    assert!(info.contains("F1") && info.contains("--model") && info.contains("init"), "{info}");
    let info = place.run(&["info", "run.csv", "--model", "robot.toml"]).succeeds().stdout;
    assert_eq!(unwrapped(&info).matches("has no column `time_s`").count(), 1, "{info}");
    assert!(info.contains("impossible"), "{info}");
    place.write("run.csv", "t;F1;L1;\n0;1;2;\n1;1;2;\n");
    let info = place.run(&["info", "run.csv"]).succeeds().stdout;
    assert!(!info.lines().any(|line| line.trim() == "–"), "{info}");
    place.write("run.csv", "time_s,cable1.force_n,cable1.length_m\n0,1,2\n0.001,x,2\n");
    place
        .run_in_vain(&["replay", "run.csv", "--model", "robot.toml"])
        .fails(1, &["`run.csv`, line 3, column `cable1.force_n`: `x` is no number"]);
    place
        .run_in_vain(&["replay", "run.csv", "log.mcap", "--model", "robot.toml"])
        .fails(1, &["`run.csv` is CSV and `log.mcap` is not"]);
}

#[test]
fn a_force_of_the_other_sign_is_told() {
    let place = Place::with_log();
    let plain = Rows::of(short_log()).plain();
    let mut lines = plain.lines();
    let header = lines.next().unwrap();
    let forces: Vec<bool> = header.split(',').map(|name| name.ends_with(".force_n")).collect();
    let turned = |line: &str| -> String {
        let cells = line.split(',').zip(&forces);
        cells
            .map(|(cell, is_force)| if *is_force { format!("-{cell}") } else { cell.to_owned() })
            .collect::<Vec<_>>()
            .join(",")
    };
    let text = [header.to_owned()].into_iter().chain(lines.map(turned)).collect::<Vec<String>>().join("\n");
    place.write("run.csv", text + "\n");
    let run = place.run(&["replay", "run.csv", "--model", "robot.toml"]);
    let told = unwrapped(&run.stderr);
    assert!(
        told.contains("most samples have a force below 0 by the sensor of") && told.contains("factor = -1"),
        "{told}"
    );
    for command in [&["fit", "-o", "f.toml"][..], &["discover"]] {
        let arguments = [command, &["run.csv", "--model", "robot.toml"]].concat();
        place.run_in_vain(&arguments).fails(1, &["most samples have a force below 0"]).advises(&["factor = -1"]);
    }
}

/// With lengths that shrink where the cable is paid out, friction seems to drive the motion, and no friction is found.
#[test]
fn a_length_of_the_other_sign_is_told() {
    let place = Place::empty();
    let bench = "format = 'fric-robot/1'\nname = 'bench'\ncycle_s = 0.001\n[[cable]]\nname = 'winch'\n\
                 pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]\n\
                 friction = { mu = 0.02, sigma_n_per_m = 5000.0, viscous_n_s_per_m = 0.5 }\n";
    place.write("bench.toml", bench);
    place.run(&["simulate", "--model", "bench.toml", "-o", "log.mcap", "--duration", "40"]).succeeds();
    place.write("run.csv", Rows::of(&place.read("log.mcap")).plain());
    let turn = |key: &str| format!("\"winch.{key}\" = {{ column = \"winch.{key}\", factor = -1.0 }}\n");
    let turned = format!("[log.columns]\n{}{}", turn("length_m"), turn("speed_m_per_s"));
    place.write("turned.toml", with_columns(bench, &turned));
    place.run(&["replay", "run.csv", "--model", "bench.toml"]).succeeds();
    for command in ["replay", "discover"] {
        let run = place.run(&[command, "run.csv", "--model", "turned.toml"]);
        run.warns(&["winch: ", "a length of the wrong sign"]);
    }
    let fit = ["fit", "run.csv", "--model", "turned.toml", "-o", "fitted.toml", "--parameters", "mu"];
    let run = place.run_in_vain(&fit).fails(1, &["determines none of the parameters"]);
    assert!(run.stderr.contains("a length of the wrong sign"), "{run:#?}");
}

/// A cable that never moves, or whose sensor shows nothing, says nothing about friction: neither `info` promises a fit nor `replay` judges the model by it.
#[test]
fn a_cable_that_rests_or_has_no_force_is_told() {
    let place = Place::empty();
    place.write(
        "bench.toml",
        "format = 'fric-robot/1'\nname = 'bench'\ncycle_s = 0.001\n[[cable]]\nname = 'winch'\npulleys = [{ wrap_deg = 90.0 }]\n\
         friction = { mu = 0.02, sigma_n_per_m = 5000.0 }\n",
    );
    let table = |force: &str, length: &dyn Fn(u32) -> f64| {
        let row = |row: u32| format!("{:.3},{force},{:.6},20\n", f64::from(row) * 1e-3, length(row));
        let rows: String = (0..9000).map(row).collect();
        format!("time_s,winch.force_n,winch.length_m,winch.reference_n\n{rows}")
    };
    place.write("rests.csv", table("19.7", &|_| 0.5));
    place.write("silent.csv", table("", &|row| 0.5 + 0.1 * (1e-3 * f64::from(row)).sin()));
    let never = "the length of winch never changes";
    place.run(&["replay", "rests.csv", "--model", "bench.toml"]).warns(&[never]);
    place.run_in_vain(&["fit", "rests.csv", "--model", "bench.toml", "-o", "f.toml"]).fails(1, &[never]);
    let info = place.run(&["info", "rests.csv", "--model", "bench.toml"]).succeeds();
    assert!(unwrapped(&info.stdout).contains(&format!("fit: forces impossible {never}")), "{info:#?}");
    let run = place.run(&["replay", "silent.csv", "--model", "bench.toml"]);
    assert!(run.stdout.starts_with("Nothing is compensated: the log has no force of any sensor."), "{run:#?}");
}

/// A load that changes faster than the model's stiffness allows, and a cable that runs faster than 10 m/s.
#[test]
fn jumps_are_told_with_the_limit_and_what_the_log_shows() {
    let place = Place::empty();
    let bench = "format = 'fric-robot/1'\nname = 'bench'\ncycle_s = 0.01\n[[cable]]\nname = 'winch'\npulleys = [{ wrap_deg = 90.0 }]\n\
                 friction = { mu = 0.02, sigma_n_per_m = 1000.0 }\n";
    place.write("bench.toml", bench);
    let row = |row: u32| {
        let length_m = f64::from(row.min(200)) * 0.02 + f64::from(row.max(200) - 200) * 0.2;
        format!("{:.2},{},{length_m:.2},20\n", f64::from(row) * 0.01, [100, 140][row as usize / 5 % 2])
    };
    let rows: String = (0..400).map(row).collect();
    place.write("run.csv", format!("time_s,winch.force_n,winch.length_m,winch.reference_n\n{rows}"));
    let run = place.run(&["replay", "run.csv", "--model", "bench.toml"]);
    let told = unwrapped(&run.stderr);
    for words in [
        "winch: SENSOR_JUMP is raised for up to 5 s where",
        "`sensor_jump_n` in a cycle, here 5 N (from σ and `length_jump_m`); in the log 79 of 399 changes are greater, up to 40 N.",
        "state a larger `sensor_jump_n` under `[monitor]`",
        "`length_jump_m` in a cycle, here 0.1 m (10 m/s); in the log 199 of 399 changes are greater, up to 0.2 m.",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }
    place.write("wide.toml", format!("{bench}[monitor]\nsensor_jump_n = 50.0\nlength_jump_m = 0.3\n"));
    let run = place.run(&["replay", "run.csv", "--model", "wide.toml"]);
    assert!(!run.stderr.contains("_JUMP"), "{run:#?}");
}

#[test]
fn rows_that_are_not_in_order_are_told() {
    let place = Place::with_log();
    let plain = Rows::of(short_log()).plain();
    let mut lines: Vec<&str> = plain.lines().collect();
    lines.swap(50, 200);
    place.write("run.csv", lines.join("\n"));
    let told = unwrapped(&place.run(&["replay", "run.csv", "--model", "robot.toml"]).stderr);
    assert!(told.contains("late message left out") && told.contains("sort them"), "{told}");
}

/// Times that are no seconds make speeds, and with them viscous friction, a thousand times too small.
#[test]
fn times_in_another_unit_are_told() {
    let place = Place::with_log();
    let table = |start: f64, step: f64, rows: u32| -> String {
        let rows = (0..rows)
            .map(|row| format!("{},3.{},{}\n", start + step * f64::from(row), row % 7, 2.0 + 1e-3 * f64::from(row)));
        format!("time_s,cable1.force_n,cable1.length_m\n{}", rows.collect::<String>())
    };
    let replayed = |table: String| {
        place.write("run.csv", table);
        place.run(&["replay", "run.csv", "--model", "robot.toml"])
    };
    let factor = ["if it is in milliseconds, give the column of `time_s` `factor = 0.001`"];
    replayed(table(0.0, 4.0, 200)).warns(&["the time is at least 4.0000 s from row to row", factor[0]]);
    assert!(!replayed(table(0.0, 0.004, 200)).stderr.contains("from row to row"));
    replayed(table(1.78e12, 4.0, 200)).fails(1, &["line 2, column `time_s`: `1780000000000` is no time in seconds"]);
    // `init` takes what cannot be seconds for milliseconds, and asks where it may be.
    for (start, factor, note) in
        [(1.78e12, true, "does not look like seconds"), (0.0, false, "is the time in milliseconds?")]
    {
        place.write("run.csv", table(start, 4.0, 200));
        let run = place.run(&["init", "run.csv", "-o", "draft.toml", "--force"]).succeeds();
        let draft = String::from_utf8(place.read("draft.toml")).unwrap();
        assert!(draft.contains(note) && draft.contains("factor = 0.001") == factor, "{run:#?} {draft}");
        assert!(draft.contains(if factor { "cycle_s = 0.004 " } else { "cycle_s = 4.0 " }), "{draft}");
    }
    place.write("run.csv", table(0.0, 4000.0, 200));
    place.run(&["init", "run.csv", "-o", "draft.toml", "--force"]).succeeds();
    let draft = String::from_utf8(place.read("draft.toml")).unwrap();
    assert!(draft.contains("factor = 1e-6") && draft.contains("cycle_s = 0.004 "), "{draft}");
    // Seconds since 1970 of a slow log.
    place.write("run.csv", table(1.78e9, 0.5, 200).replacen("time_s", "t", 1));
    place.run(&["init", "run.csv", "-o", "draft.toml", "--force"]).succeeds();
    let draft = String::from_utf8(place.read("draft.toml")).unwrap();
    assert!(draft.contains("cycle_s = 0.5 ") && !draft.contains("factor"), "{draft}");
    place.write("run.csv", table(0.0, 4.0, 200).replacen("time_s", "t", 1));
    place.run(&["init", "run.csv", "-o", "draft.toml", "--force"]).succeeds();
    let draft = String::from_utf8(place.read("draft.toml")).unwrap();
    assert!(draft.contains("\"time_s\" = { column = \"t\", factor = 0.001 }"), "{draft}");
}

#[test]
fn a_wrong_entry_of_the_columns_names_its_line() {
    let place = Place::with_log();
    for (entry, words) in [
        ("\"cable1.forc_n\" = { column = \"F\" }", "unknown signal `cable1.forc_n`; did you mean `cable1.force_n`?"),
        (
            "time_s = { column = \"t\", factor = 0 }",
            "`factor` of `time_s` is 0; it must be a finite number other than 0",
        ),
        ("time_s = { column = \"t\", offset = nan }", "`offset` of `time_s` is NaN; it must be a finite number"),
        ("time_s = { column = \" \" }", "`column` of `time_s` is empty"),
        ("time_s = { factor = 2 }", "`column` is missing in `time_s`"),
        ("time_s = { column = \"t\", unit = \"ms\" }", "unknown key `unit`"),
    ] {
        let columns = format!("[log.columns]\n\"cable1.length_m\" = {{ column = \"L\" }}\n{entry}\n");
        let robot = with_columns(&example_robot(), &columns);
        let line = robot.lines().position(|line| line == entry).unwrap() + 1;
        place.write("robot.toml", robot);
        let line = format!("robot.toml, line {line}: ");
        place.run_in_vain(&["replay", "log.mcap", "--model", "robot.toml"]).fails(1, &[&line, words]);
    }
}
