//! `continuum`: from load steps to shapes, against what the simulated manipulator really did.

use std::sync::OnceLock;

use serde_json::Value;

use super::report::{assert_self_contained, without_scripts};
use super::support::{Place, Run, assert_close, example_robot, root, unwrapped};

/// The example manipulator.
pub fn prototype() -> String {
    std::fs::read_to_string(root().join("examples/tendon-prototype.toml")).unwrap()
}

/// Files of a simulated run with mixed directions: run, loads, truth, calibrated manipulator.
fn files() -> &'static [(&'static str, Vec<u8>)] {
    static FILES: OnceLock<Vec<(&'static str, Vec<u8>)>> = OnceLock::new();
    FILES.get_or_init(|| {
        let place = Place::empty();
        place.write("arm.toml", prototype());
        let outputs = ["-o", "mixed.csv", "--calibration", "loads.csv", "--truth", "truth.json"];
        let simulate = ["continuum", "simulate", "--model", "arm.toml", "--run", "mixed", "--seed", "5"];
        place.run(&[&simulate[..], &outputs[..]].concat()).succeeds();
        place.run(&["continuum", "calibrate", "loads.csv", "--model", "arm.toml", "-o", "cal.toml"]).succeeds();
        ["arm.toml", "mixed.csv", "loads.csv", "truth.json", "cal.toml"].map(|name| (name, place.read(name))).to_vec()
    })
}

fn place() -> Place {
    let place = Place::empty();
    for (name, content) in files() {
        place.write(name, content);
    }
    place
}

fn text(name: &str) -> String {
    let (_, content) = files().iter().find(|(other, _)| *other == name).unwrap();
    String::from_utf8(content.clone()).unwrap()
}

pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap_or(f64::NAN)).collect()
}

pub fn rows(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().unwrap().iter().map(numbers).collect()
}

/// A column of the run.
pub fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines();
    let place = lines.next().unwrap().split(',').position(|other| other == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

/// The run with each cell through a function of its column and row.
fn changed(csv: &str, change: impl Fn(&str, usize, &str) -> String) -> String {
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let line = |(row, line): (usize, &str)| {
        let cells = line.split(',').zip(&header).map(|(cell, name)| change(name, row, cell));
        cells.collect::<Vec<_>>().join(",") + "\n"
    };
    header.join(",") + "\n" + &csv.lines().skip(1).enumerate().map(line).collect::<String>()
}

/// The run without the columns whose names contain a word.
fn without(csv: &str, word: &str) -> String {
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let line = |line: &str| {
        let cells = line.split(',').zip(&header).filter(|(_, name)| !name.contains(word)).map(|(cell, _)| cell);
        cells.collect::<Vec<_>>().join(",") + "\n"
    };
    csv.lines().map(line).collect()
}

#[test]
#[expect(clippy::cast_precision_loss, reason = "a small count")]
fn calibration_is_the_line_of_least_squares() {
    let place = place();
    let calibrate = ["continuum", "calibrate", "loads.csv", "--model", "arm.toml", "-o", "new.toml"];
    let run = place.run(&[&calibrate[..], &["--json", "c.json", "--report", "c.html"]].concat()).succeeds();
    let result = place.json("c.json");
    assert_eq!(
        (&result["format"], &result["manipulator"]),
        (&"fric-continuum-calibrate/1".into(), &"tendon-prototype".into())
    );
    let loads = column(&text("loads.csv"), "load_n");
    assert_close(loads[9], 0.2 * 9.80665);
    for (place, grating) in result["gratings"].as_array().unwrap().iter().enumerate() {
        let shifts = column(&text("loads.csv"), &format!("shift_{}_nm", place + 1));
        // Normal equations, written out.
        let n = loads.len() as f64;
        let (sx, sy) = (shifts.iter().sum::<f64>(), loads.iter().sum::<f64>());
        let sxx: f64 = shifts.iter().map(|x| x * x).sum();
        let sxy: f64 = shifts.iter().zip(&loads).map(|(x, y)| x * y).sum();
        let slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
        assert_close(grating["newton_per_nm"].as_f64().unwrap(), slope);
        assert!((grating["offset_n"].as_f64().unwrap() - (sy - slope * sx) / n).abs() < 1e-9);
        assert!(grating["largest_residual_ratio"].as_f64().unwrap() < 0.01);
        let row = run.stdout.lines().nth(place + 4).unwrap();
        assert!(row.contains(&format!("{slope:.4}")), "{row}");
    }
    let written = String::from_utf8(place.read("new.toml")).unwrap();
    assert!(written.starts_with(&prototype()) && written.contains("[gratings]"), "{written}");
    assert_eq!(written, text("cal.toml"));
    let html = String::from_utf8(place.read("c.html")).unwrap();
    assert_self_contained(&html);
}

#[test]
fn frictions_are_those_of_the_truth() {
    let place = place();
    let friction =
        ["continuum", "friction", "mixed.csv", "--model", "cal.toml", "--json", "f.json", "--report", "f.html"];
    let run = place.run(&friction).succeeds();
    assert!(run.stdout.contains("Directions differ along the tendon in "), "{run:#?}");
    let (result, truth) = (place.json("f.json"), place.json("truth.json"));
    let (found, errors) = (rows(&result["series"]["friction_n"]), rows(&result["series"]["standard_error_n"]));
    let (mut within, mut all) = (0.0, 0.0);
    for ((found, error), real) in found.iter().zip(&errors).zip(rows(&truth["friction_n"])) {
        for ((found, error), real) in found.iter().zip(error).zip(real) {
            all += 1.0;
            within += f64::from(u8::from((found - real).abs() < 2.0 * error));
        }
    }
    assert!(within > 0.9 * all, "{within} of {all}");
    // Flags are never without cause.
    let bound = rows(&truth["bound_n"]);
    let flags = result["series"]["directions_differ"].as_array().unwrap();
    assert!(flags.iter().filter(|flag| **flag == true).count() > 20);
    let real = rows(&truth["friction_n"]);
    let both = |row: usize| real[row].iter().any(|f| *f > 0.0) && real[row].iter().any(|f| *f < 0.0);
    let wrong = (0..flags.len()).filter(|&row| flags[row] == true && !both(row)).count();
    assert!(wrong < 12, "{wrong} of {} flags", bound.len());
}

#[test]
fn four_ways_are_compared_with_the_markers() {
    let place = place();
    let shape = ["continuum", "shape", "mixed.csv", "--model", "cal.toml", "--json", "s.json", "--report", "s.html"];
    let run = place.run(&[&shape[..], &["--mixed", "--shapes", "4"]].concat()).succeeds();
    let (result, truth) = (place.json("s.json"), place.json("truth.json"));
    assert_eq!(result["shapes"].as_array().unwrap().len(), 4);
    let names: Vec<&Value> = result["ways"].as_array().unwrap().iter().map(|way| &way["way"]).collect();
    assert_eq!(names, ["none", "coulomb", "measured", "history"]);
    // Distances from positions and markers, recomputed.
    let mut sums = [0.0; 4];
    for shape in result["shapes"].as_array().unwrap() {
        let markers = rows(&shape["marker_m"]);
        for (way, sum) in shape["ways"].as_array().unwrap().iter().zip(&mut sums) {
            let distances: Vec<f64> = rows(&way["disk_position_m"])
                .iter()
                .zip(&markers)
                .map(|(p, q)| 1e3 * (p[0] - q[0]).hypot(p[1] - q[1]))
                .collect();
            assert_close(way["max_mm"].as_f64().unwrap(), distances.iter().copied().fold(0.0, f64::max));
            assert_close(way["mean_mm"].as_f64().unwrap(), distances.iter().sum::<f64>() / 8.0);
            *sum += distances.iter().sum::<f64>() / 32.0;
            let lost: f64 = numbers(&way["friction_n"]).iter().sum();
            let tip_n = numbers(&way["tension_n"])[7];
            assert!((lost - (shape["tension_base_n"].as_f64().unwrap() - tip_n)).abs() < 1e-12);
        }
    }
    for (way, sum) in result["ways"].as_array().unwrap().iter().zip(sums) {
        assert_close(way["picked"]["mean_mm"].as_f64().unwrap(), sum);
        let mean = format!("{sum:.2}");
        assert!(run.stdout.lines().any(|line| line.trim_start().starts_with("these 4") && line.contains(&mean)));
    }
    assert!(sums[1] > sums[0] && sums[0] > sums[2] && 5.0 * sums[3] <= sums[1], "{sums:?}");
    // Directions of the history, which looks at no grating.
    let (mut right, mut all) = (0.0, 0.0);
    let history = rows(&result["series"][3]["friction_n"]);
    for ((found, real), bound) in history.iter().zip(rows(&truth["friction_n"])).zip(rows(&truth["bound_n"])) {
        for ((found, real), bound) in found.iter().zip(&real).zip(bound) {
            if real.abs() > 0.1 * bound {
                all += 1.0;
                right += f64::from(u8::from(found * real > 0.0));
            }
        }
    }
    assert!(right >= 0.95 * all, "{right} of {all}");
    let html = String::from_utf8(place.read("s.html")).unwrap();
    assert_self_contained(&html);
    assert!(html.matches("<svg").count() == 9 && html.contains("class=\"marker\""));
    assert!(run.stdout.contains("[C] fig. 12 one way") && run.stdout.contains("[C] fig. 15 mixed"), "{run:#?}");
    // Errors measured on the paper's prototype say nothing of another manipulator.
    for (from, to) in
        [("pitch_m = 0.037", "pitch_m = 0.036"), ("youngs_modulus_pa = 200e9", "youngs_modulus_pa = 250e9")]
    {
        place.write("other.toml", text("cal.toml").replace(from, to));
        let other = place.run(&["continuum", "shape", "mixed.csv", "--model", "other.toml"]).succeeds();
        assert!(other.stdout.contains("all 178") && !other.stdout.contains("[C]"), "{other:#?}");
    }
    let there = place.run(&["continuum", "shape", "mixed.csv", "--model", "cal.toml", "--at-s", "1.02,3"]).succeeds();
    assert!(unwrapped(&there.stdout).contains("shape 1 1.00"), "{there:#?}");
}

#[test]
fn ways_can_be_chosen() {
    let place = place();
    let shape = ["continuum", "shape", "mixed.csv", "--model", "arm.toml"];
    let run = |more: &[&str]| place.run(&[&shape[..], more].concat());
    let in_vain = |ways: &str| place.run_in_vain(&[&shape[..], &["--ways", ways]].concat());
    run(&["--json", "all.json"]).warns(&["`measured` is left out"]);
    // Nothing is missed that is not wanted.
    let chosen = ["--ways", "history,none", "--json", "some.json", "--report", "some.html"];
    run(&chosen).succeeds();
    let (all, some) = (place.json("all.json"), place.json("some.json"));
    assert_eq!(some["series"], Value::Array(vec![all["series"][0].clone(), all["series"][2].clone()]));
    let html = String::from_utf8(place.read("some.html")).unwrap();
    assert!(html.contains("shapes by none, history") && !html.contains("<td>coulomb</td>"));
    let one = run(&["--ways", "none", "--report", "none.html"]).succeeds();
    assert!(one.stdout.contains("all 178"), "{one:#?}");
    in_vain("measured").fails(1, &["no shape follows", "calibrated gratings"]);
    in_vain("histry").fails(2, &["--ways"]);
}

#[test]
fn a_log_says_the_same_as_text() {
    let place = place();
    place
        .run(&["continuum", "simulate", "--model", "arm.toml", "--run", "mixed", "--seed", "5", "-o", "m.mcap"])
        .succeeds();
    let shape = |run: &str, json: &str| {
        place.run(&["continuum", "shape", run, "--model", "cal.toml", "--json", json]).succeeds();
        place.json(json)
    };
    assert!(shape("mixed.csv", "a.json") == shape("m.mcap", "b.json"));
    let info = place.run(&["info", "m.mcap", "--model", "cal.toml"]).succeeds();
    assert!(info.stdout.contains("the run allows"), "{info:#?}");
}

#[test]
fn a_run_cut_off_is_used_up_to_the_cut() {
    let place = place();
    let good = text("mixed.csv");
    let rows = good.lines().count() - 1;
    let last_line = good.trim_end().rfind('\n').unwrap() + 1;
    let last_comma = good.rfind(',').unwrap();
    // Within the line, and within its last number.
    for cut in [last_line + 9, last_comma + 5] {
        place.write("cut.csv", &good[..cut]);
        for command in [
            &["info", "cut.csv", "--model", "cal.toml", "--json", "c.json"][..],
            &["continuum", "shape", "cut.csv", "--model", "cal.toml"],
            &["continuum", "friction", "cut.csv", "--model", "cal.toml"],
            &["discover", "cut.csv", "--model", "cal.toml", "-o", "found.toml", "--force"],
        ] {
            let run = place.run(command).warns(&["`cut.csv` is cut off", "last line", "left out"]);
            assert_eq!(run.stderr.matches("cut off").count(), 1, "{run:#?}");
        }
        assert_eq!(place.json("c.json")["samples"], rows - 1);
        std::fs::remove_file(place.path("c.json")).unwrap();
    }
    place.write("cut.csv", good.replacen("\n0.4,", "\n", 1));
    let run = place.run_in_vain(&["info", "cut.csv", "--model", "cal.toml"]);
    run.fails(1, &["cut.csv, line 6", "cells under a header"]);
}

#[test]
fn a_hole_gives_its_coefficient() {
    let place = Place::empty();
    // F_1 − F_2 = 0.2 (F_1 cos 1 + F_2 cos 1.2), exactly.
    let (one, other) = (1.0_f64, 1.2_f64);
    let ratio = (1.0 - 0.2 * one.cos()) / (1.0 + 0.2 * other.cos());
    let rows: Vec<String> = (1..=6).map(|load| format!("{load},{},1,1.2\n", ratio * f64::from(load))).collect();
    place.write("hole.csv", "tension_1_n,tension_2_n,angle_1_rad,angle_2_rad\n".to_owned() + &rows.concat());
    let run = place.run(&["continuum", "hole", "hole.csv", "--json", "h.json"]).succeeds();
    assert!(run.stdout.starts_with("μ = 0.2000 ± 0.0000 from 6 loads"), "{run:#?}");
    assert_close(place.json("h.json")["mu"].as_f64().unwrap(), 0.2);
    place.write("hole.csv", "tension_1_n,tension_2_n,angle_1_rad,angle_2_rad\n1,0.9,1,1\n");
    place.run_in_vain(&["continuum", "hole", "hole.csv"]).fails(1, &["hole.csv", "fewer than three loads"]);
    place.write("hole.csv", "tension_1_n,tension_2_n,angle_1_rad,angle_2_rad\n1,0.9,74,74\n");
    place
        .run_in_vain(&["continuum", "hole", "hole.csv"])
        .fails(1, &["hole.csv", "`angle_1_rad` is 74 in row 1", "in rad"]);
}

/// What was left out is told before what is then missing.
#[test]
fn loads_cut_off_are_told_before_their_number() {
    let place = Place::empty();
    let header = "tension_1_n,tension_2_n,angle_1_rad,angle_2_rad\n";
    place.write("hole.csv", format!("{header}1,0.9,1,1\n2,1.8,1,1\n3,2.7,1,1"));
    let run = place.run_in_vain(&["continuum", "hole", "hole.csv"]);
    assert!(run.stderr.starts_with("warning: `hole.csv` is cut off: its last line has no line end"), "{run:#?}");
    run.fails(1, &["hole.csv", "fewer than three loads"]);
    place.write("hole.csv", format!("{header}1,0.9,1,1"));
    let run = place.run_in_vain(&["continuum", "hole", "hole.csv"]);
    run.fails(1, &["hole.csv has no whole row", "no line end and is left out"]).advises(&["put a line end behind it"]);
}

#[test]
fn info_says_what_is_impossible() {
    let place = place();
    let run = place.run(&["info", "mixed.csv", "--model", "cal.toml", "--json", "i.json"]).succeeds();
    assert!(run.stdout.contains("manipulator tendon-prototype"), "{run:#?}");
    let possible = |json: &str| -> Vec<bool> {
        place.json(json)["steps"].as_array().unwrap().iter().map(|step| step["possible"] == true).collect()
    };
    assert_eq!(possible("i.json"), [true, true, true, true, false]);
    for (word, file, expected) in [
        ("shift", "a", [false, true, false, true, false]),
        ("marker", "b", [true, true, true, false, false]),
        ("tension", "c", [true, false, true, true, false]),
    ] {
        place.write("part.csv", without(&text("mixed.csv"), word));
        place.run(&["info", "part.csv", "--model", "cal.toml", "--json", file]).succeeds();
        assert_eq!(possible(file), expected, "without {word}");
    }
    let bare = place.run(&["info", "mixed.csv"]).succeeds();
    assert!(unwrapped(&bare.stdout).contains("name a manipulator file"), "{bare:#?}");
}

#[test]
fn groups_that_are_missing_are_told() {
    let place = place();
    let shape = |word: &str| {
        place.write("part.csv", without(&text("mixed.csv"), word));
        place.run(&["continuum", "shape", "part.csv", "--model", "cal.toml"])
    };
    let head = |run: &Run| run.stdout.lines().take(5).collect::<String>();
    let run = shape("shift").warns(&["`measured` is left out", "no gratings"]);
    assert!(head(&run).contains("history") && !head(&run).contains("measured"), "{run:#?}");
    let run = shape("marker").succeeds();
    assert!(run.stdout.contains("No markers to compare with."), "{run:#?}");
    let run = shape("tension").warns(&["no `tension_base_n`", "`history` are left out"]);
    assert!(head(&run).contains("measured") && !head(&run).contains("history"), "{run:#?}");
    let friction = ["continuum", "friction", "part.csv", "--model", "cal.toml"];
    place.run(&friction).warns(&["hole 1 is not known"]);
    place.write("part.csv", without(&text("mixed.csv"), "shift"));
    place.run_in_vain(&friction).fails(1, &["part.csv", "no gratings"]).advises(&["continuum shape"]);
    let uncalibrated = ["continuum", "friction", "mixed.csv", "--model", "arm.toml"];
    place.run_in_vain(&uncalibrated).fails(1, &["arm.toml", "[gratings]"]).advises(&["calibration"]);
    place
        .run(&["continuum", "shape", "mixed.csv", "--model", "arm.toml"])
        .warns(&["`measured` is left out", "[gratings]"]);
}

#[test]
fn a_dead_grating_is_bridged_and_flagged() {
    let place = place();
    for dead in ["", "nan", "0.0123"] {
        let run = changed(
            &text("mixed.csv"),
            |name, _, cell| {
                if name == "shift_4_nm" { dead.to_owned() } else { cell.to_owned() }
            },
        );
        place.write("dead.csv", run);
        let shape = ["continuum", "shape", "dead.csv", "--model", "cal.toml", "--json", "d.json", "--force"];
        place.run(&shape).warns(&["grating 4 is dead in", "between its neighbours"]);
        let result = place.json("d.json");
        assert_eq!(result["bridged"][0]["grating"], 4);
        assert!(result["ways"][2]["all"]["mean_mm"].as_f64().unwrap() < 1.0, "{}", result["ways"][2]);
        place.run(&["continuum", "friction", "dead.csv", "--model", "cal.toml"]).warns(&["grating 4 is dead in"]);
    }
}

#[test]
fn guards_are_reported() {
    let place = place();
    let shifted = |nanometres: f64, is_there: &dyn Fn(&str, usize) -> bool| {
        changed(&text("mixed.csv"), |name, row, cell| {
            let is_shift = name.starts_with("shift") && is_there(name, row);
            if is_shift { (cell.parse::<f64>().unwrap() + nanometres).to_string() } else { cell.to_owned() }
        })
    };
    let command = |what: &str, csv: String| {
        place.write("guard.csv", csv);
        place.run(&["continuum", what, "guard.csv", "--model", "cal.toml", "--json", "g.json", "--force"])
    };
    let clean = text("mixed.csv");
    for what in ["shape", "friction"] {
        command(what, clean.clone()).succeeds();
        assert_eq!(place.json("g.json")["guards"].as_array().unwrap().len(), 0);
        command(what, shifted(0.05, &|_, row| row >= 60)).warns(&["all gratings step by +0.0", "6 s"]);
        let guard = &place.json("g.json")["guards"][0];
        assert_eq!((guard["kind"].as_str(), guard["time_s"].as_f64()), (Some("common_step"), Some(6.0)));
        assert!((guard["step_nm"].as_f64().unwrap() - 0.05).abs() < 0.001, "{guard}");
        let lone = shifted(0.02, &|name, row| name == "shift_5_nm" && row >= 60);
        command(what, lone).warns(&["grating 5 contradicts its neighbours"]);
        let guard = &place.json("g.json")["guards"][0];
        assert_eq!((guard["kind"].as_str(), guard["grating"].as_u64()), (Some("contradicting_grating"), Some(5)));
    }
    // Cut after a release has begun.
    let mut lines = clean.lines();
    let cut = [lines.next().unwrap()].into_iter().chain(lines.skip(46)).map(|line| format!("{line}\n")).collect();
    command("shape", cut).warns(&["the run begins at 0.9", "the gratings show it", "MEMORY_UNCERTAIN"]);
    let result = place.json("g.json");
    assert_eq!(result["ways"][3]["begin"]["source"], "gratings");
    assert_eq!(result["series"][3]["status"][0], "MEMORY_UNCERTAIN");
}

/// A wrong unit is told by its order of magnitude, not by its dead gratings.
#[test]
fn a_wrong_unit_is_told() {
    let place = place();
    let scaled = |csv: &str, word: &str, factor: f64| {
        changed(csv, |name, _, cell| {
            if name.contains(word) { (cell.parse::<f64>().unwrap() * factor).to_string() } else { cell.to_owned() }
        })
    };
    let (run, loads) = (text("mixed.csv"), text("loads.csv"));
    let calibrate = ["continuum", "calibrate", "bad.csv", "--model", "arm.toml", "-o", "bad.toml"];
    // pm for nm, which would strain the fibre by ten per cent.
    place.write("bad.csv", scaled(&loads, "shift", 1e3));
    place.run_in_vain(&calibrate).fails(1, &["bad.csv: `shift_1_nm` goes up to", "likely in pm"]).advises(&["in nm"]);
    place.write("bad.csv", scaled(&run, "shift", 1e3));
    let of_run = [
        &["continuum", "shape", "bad.csv", "--model", "cal.toml"][..],
        &["continuum", "friction", "bad.csv", "--model", "cal.toml"],
        &["discover", "bad.csv", "--model", "cal.toml", "-o", "x.toml"],
    ];
    for command in of_run {
        place.run_in_vain(command).fails(1, &["bad.csv: `shift_1_nm` goes up to", "likely in pm"]);
    }
    // g for N.
    place.write("bad.csv", scaled(&loads, "load_n", 1e3 / 9.80665));
    place
        .run_in_vain(&calibrate)
        .fails(1, &["bad.csv: `load_n` goes up to 200", "4 N", "likely in g"])
        .advises(&["`load_g`"]);
    // N for g, and nm for what was calibrated in pm: the run gives it away.
    place.write("bad.csv", loads.replacen("load_n", "load_g", 1));
    place.run(&calibrate).succeeds();
    let weak =
        of_run.map(|command| command.iter().map(|word| word.replace("cal.toml", "bad.toml")).collect::<Vec<_>>());
    place.write("bad.csv", &run);
    for command in &weak {
        let command: Vec<&str> = command.iter().map(String::as_str).collect();
        let words = ["bad.csv: by `shift_1_nm`", "times `tension_base_n`", "`load_g` was in N"];
        place.run_in_vain(&command).fails(1, &words).advises(&["calibrate again"]);
    }
    // kg for N at the base, and mm for m.
    place.write("bad.csv", scaled(&run, "tension_base_n", 1.0 / 9.80665));
    for command in of_run {
        place.run_in_vain(command).fails(1, &["times `tension_base_n`: `tension_base_n` is likely in kg"]);
    }
    place.write("bad.csv", scaled(&run, "marker", 1e3));
    for command in of_run {
        place.run_in_vain(command).fails(1, &["bad.csv: the markers are", "likely in mm"]).advises(&["in m"]);
    }
    // Some spikes of the demodulator are no unit.
    let spikes =
        changed(&run, |name, row, cell| if name == "shift_3_nm" && row % 9 == 0 { "1500" } else { cell }.to_owned());
    place.write("spikes.csv", spikes);
    place.run(&["continuum", "friction", "spikes.csv", "--model", "cal.toml"]).warns(&["grating 3 is dead in"]);
}

#[test]
fn bad_runs_get_their_sentence() {
    let place = place();
    let refused = |csv: String, words: &[&str], advice: &str| {
        place.write("bad.csv", csv);
        for command in ["shape", "friction"] {
            let run = place.run_in_vain(&["continuum", command, "bad.csv", "--model", "cal.toml", "--json", "j.json"]);
            run.fails(1, &[&["bad.csv"], words].concat()).advises(&[advice]);
        }
    };
    let good = text("mixed.csv");
    let at = |column: &'static str, row: usize, value: &'static str| {
        changed(&good, |name, place, cell| if name == column && place == row { value } else { cell }.to_owned())
    };
    refused(at("time_s", 4, "0.1"), &["time goes from 0.3 s to 0.1 s at sample 5"], "Sort the run");
    refused(at("tension_base_n", 4, ""), &["`tension_base_n` is NaN at 0.4 s"], "Take the sample out");
    refused(at("tension_base_n", 4, "4.2"), &["4.2 N at 0.4 s", "capacity of 4 N"], "Check the unit");
    refused(at("shift_2_nm", 4, "x"), &["line 6, column `shift_2_nm`: `x`"], "Write digits");
    refused(
        good.replacen("shift_2_nm", "shft_2_nm", 1),
        &["unknown column `shft_2_nm`; did you mean `shift_2_nm`"],
        "Correct its name",
    );
    refused(without(&good, "shift_2_"), &["`shift_2_nm` is missing beside"], "Add it");
    refused(without(&good, "time_s"), &["`time_s` is missing"], "Add it");
    refused(good.lines().next().unwrap().to_owned() + "\n", &["no row of numbers"], "Record again");
    refused("1;2\n".to_owned(), &["line 1: there are numbers"], "Put a line with the names in front");

    // A backbone so limp that the bend leaves the model.
    place.write("limp.toml", text("cal.toml").replace("youngs_modulus_pa = 200e9", "youngs_modulus_pa = 2e9"));
    let limp = ["continuum", "shape", "mixed.csv", "--model", "limp.toml"];
    place.run_in_vain(&limp).fails(1, &["mixed.csv", "beyond the model", "DISKS_TOUCH"]).advises(&["stiffness"]);
    // A grating that would run into a disk.
    let near = "from_base_side_m = 0.01\nlength_m = 0.004\n";
    place.write("near.toml", text("cal.toml") + near);
    let near = ["continuum", "shape", "mixed.csv", "--model", "near.toml"];
    place.run_in_vain(&near).fails(1, &["grating 1 leaves its segment"]).advises(&["tip side"]);
}

#[test]
fn command_lines_are_checked() {
    let place = place();
    place.write("old", "kept");
    place.run_in_vain(&["continuum", "shape", "mixed.csv"]).fails(2, &["--model"]);
    place.run_in_vain(&["continuum", "shape", "none.csv", "--model", "cal.toml"]).fails(1, &["none.csv"]);
    place.run_in_vain(&["continuum", "shape", "mixed.csv", "--model", "none.toml"]).fails(1, &["none.toml"]);
    let shape = ["continuum", "shape", "mixed.csv", "--model", "cal.toml"];
    let shape = |more: &[&str]| place.run_in_vain(&[&shape[..], more].concat());
    shape(&["--shapes", "0"]).fails(2, &["--shapes"]);
    shape(&["--at-s", "99"]).fails(2, &["99 s is not within the run"]);
    shape(&["--json", "old"]).fails(1, &["old exists"]).advises(&["--force"]);
    shape(&["--report", "mixed.csv", "--force"]).fails(1, &["mixed.csv is an input"]);
    shape(&["--report", "a", "--json", "a"]).fails(2, &["two outputs"]);
    let simulate = ["continuum", "simulate", "--model", "arm.toml", "-o", "new.csv"];
    let simulate = |more: &[&str]| place.run_in_vain(&[&simulate[..], more].concat());
    simulate(&["--mu-spread-ratio", "2"]).fails(2, &["--mu-spread-ratio", "0 to 1"]);
    simulate(&["--marker-noise-m", "nan"]).fails(2, &["--marker-noise-m"]);
    simulate(&["--truth", "new.csv"]).fails(2, &["two outputs"]);
    simulate(&["--greatest-tension-n", "4.1"])
        .fails(2, &["--greatest-tension-n is 4.1, above the tendon's capacity of 4 N"])
        .advises(&["`capacity_n` in the manipulator file"]);
    place.write("loads.csv", "load_g,shift_1_nm\n1,2\n");
    let calibrate = ["continuum", "calibrate", "loads.csv", "--model", "arm.toml", "-o", "new.toml"];
    place.run_in_vain(&calibrate).fails(1, &["loads.csv", "`shift_2_nm` is missing"]);
    place.run_in_vain(&[&calibrate[..6], &["arm.toml", "--force"]].concat()).fails(1, &["arm.toml is an input"]);
}

#[test]
fn discovery_names_the_memory_of_the_holes() {
    let place = place();
    let text = text("cal.toml");
    let plain: Vec<&str> = text.lines().filter(|line| !line.starts_with("sigma_n_per_m")).collect();
    place.write("plain.toml", plain.join("\n"));
    let discover =
        ["discover", "mixed.csv", "--model", "plain.toml", "-o", "new.toml", "--json", "d.json", "--report", "d.html"];
    let run = place.run(&discover).succeeds();
    assert!(run.stdout.contains("presliding: sigma_n_per_m = 20000"), "{run:#?}");
    let result = place.json("d.json");
    assert_eq!((&result["format"], &result["robot"]), (&"fric-discover/1".into(), &"tendon-prototype".into()));
    let tendon = &result["cables"][0];
    assert_eq!((&tendon["verdict"], &tendon["effects"][0]["kind"]), (&"extended".into(), &"presliding".into()));
    let rms = |when: &str| tendon[when]["rms_n"].as_f64().unwrap();
    let floor = tendon["noise_floor_n"].as_f64().unwrap();
    // A share is at most one; what is held out may scatter a little less than the noise.
    let closed = (1.0 - (rms("after") - floor) / (rms("before") - floor)).min(1.0);
    assert_close(tendon["gap_closed"].as_f64().unwrap(), closed);
    assert!(tendon["effects"][0]["evidence"]["delta_bic"].as_f64().unwrap() < -10.0);
    assert_self_contained(&String::from_utf8(place.read("d.html")).unwrap());
    let again = ["discover", "mixed.csv", "--model", "new.toml", "-o", "again.toml"];
    let again = place.run(&again).succeeds();
    assert!(again.stdout.contains("complete"), "{again:#?}");
    let two = ["discover", "mixed.csv", "loads.csv", "--model", "plain.toml", "-o", "x.toml"];
    place.run_in_vain(&two).fails(2, &["one by one"]);
    place
        .run_in_vain(&["discover", "mixed.csv", "-o", "x.toml"])
        .fails(2, &["mixed.csv is the run of a manipulator"])
        .advises(&["--model"]);
    let uncalibrated = ["discover", "mixed.csv", "--model", "arm.toml", "-o", "x.toml"];
    place.run_in_vain(&uncalibrated).fails(1, &["mixed.csv", "[gratings]"]);
}

#[test]
fn fit_finds_a_stiffness_that_was_stated_wrong() {
    let place = place();
    // As an editor on Windows writes it.
    let soft = format!("\u{feff}{}", text("cal.toml").replace("200e9", "180e9").replace('\n', "\r\n"));
    place.write("soft.toml", soft);
    let fit = ["continuum", "fit", "mixed.csv", "--model", "soft.toml", "-o", "fitted.toml", "--json", "f.json"];
    let run = place.run(&[&fit[..], &["--parameters", "backbone_stiffness,tendon_offset,mu"]].concat()).succeeds();
    assert!(run.stdout.contains("undetermined: the runs do not tell `hole_radius_m` apart"), "{run:#?}");
    let result = place.json("f.json");
    assert_eq!(result["format"], "fric-continuum-fit/1");
    // The stiffness of the simulated one, E·b·h³/12.
    let stiffness = result["parameters"]["bending_stiffness_n_m2"].as_f64().unwrap();
    assert!((stiffness / 2.7e-3 - 1.0).abs() < 0.01, "{stiffness}");
    let fitted = String::from_utf8(place.read("fitted.toml")).unwrap();
    assert!(fitted.starts_with('\u{feff}') && !fitted.replace("\r\n", "").contains(['\r', '\n']), "{fitted:?}");
    let modulus = fitted.lines().find_map(|line| line.strip_prefix("youngs_modulus_pa = ")).unwrap();
    assert!((modulus.trim().parse::<f64>().unwrap() / 200e9 - 1.0).abs() < 0.01);
    let misspelt = [&fit[..5], &["-o", "x.toml", "--parameters", "stiffness"]].concat();
    place.run_in_vain(&misspelt).fails(2, &["--parameters", "backbone_stiffness"]);
    let cables = ["fit", "mixed.csv", "--model", "cal.toml", "-o", "x.toml"];
    place.run_in_vain(&cables).fails(2, &["cal.toml is a manipulator file"]).advises(&["continuum fit"]);
}

#[test]
fn pages_escape_what_files_say() {
    let place = place();
    place.write("arm<b>.toml", text("cal.toml").replace("\"tendon-prototype\"", "\"<script>alert(1)</script>\""));
    place.write("run&<i>.csv", text("mixed.csv"));
    for command in ["shape", "friction"] {
        place
            .run(&["continuum", command, "run&<i>.csv", "--model", "arm<b>.toml", "--report", "r.html", "--force"])
            .succeeds();
        let html = String::from_utf8(place.read("r.html")).unwrap();
        assert_self_contained(&html);
        assert!(
            html.contains("&lt;script&gt;") && !without_scripts(&html).0.contains("<script") && !html.contains("<i>")
        );
    }
}

#[test]
fn a_model_of_the_other_kind_is_told() {
    let place = place();
    place.write("robot.toml", example_robot());
    let shape = ["continuum", "shape", "mixed.csv", "--model", "robot.toml"];
    place
        .run_in_vain(&shape)
        .fails(1, &["robot.toml is a robot file (`fric-robot/1`)"])
        .advises(&["a manipulator file"]);
    let simulate = ["simulate", "--model", "arm.toml", "-o", "log.mcap"];
    place.run_in_vain(&simulate).fails(1, &["arm.toml is a manipulator file"]).advises(&["a robot file"]);
}
