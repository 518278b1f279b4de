//! `excite`: the set points in the file against the robot, and what is refused.

use std::collections::BTreeMap;

use fric_core::Pose;
use fric_core::platform::structure_matrix;
use fric_core::robot::file::RobotFile;
use nalgebra::{SVector, Vector3, Vector6};

use super::report::assert_self_contained;
use super::simulate::bench_robot;
use super::support::{Place, Run, slow_robot, unwrapped};

/// The columns of a CSV file by name, the phases apart.
fn columns(file: &[u8]) -> (BTreeMap<String, Vec<f64>>, Vec<String>) {
    let mut reader = csv::Reader::from_reader(file);
    let header: Vec<String> = reader.headers().unwrap().iter().map(ToOwned::to_owned).collect();
    let (mut columns, mut phases) = (BTreeMap::<String, Vec<f64>>::new(), Vec::new());
    for record in reader.records().map(Result::unwrap) {
        for (name, field) in header.iter().zip(&record) {
            if name == "phase" {
                phases.push(field.to_owned());
            } else {
                columns.entry(name.clone()).or_default().push(field.parse().unwrap());
            }
        }
    }
    (columns, phases)
}

/// `excite` with options.
fn excite(place: &Place, options: &[&str]) -> Run {
    place.run(&[&["excite", "--model", "robot.toml", "-o", "run.csv"], options].concat())
}

fn place_with(robot: &str) -> Place {
    let place = Place::empty();
    place.write("robot.toml", robot);
    place
}

const LIMITS: [&str; 9] = [
    "--box=-0.1,-0.08,-0.1,0.12,0.08,0.1",
    "--max-speed-m-per-s",
    "0.5",
    "--max-acceleration-m-per-s2",
    "6",
    "--min-tension-n",
    "2",
    "--max-tension-n",
    "25",
];

/// A spreadsheet would execute a cell that begins so.
#[test]
fn a_name_is_no_formula_of_a_spreadsheet() {
    for sign in ["=", "+", "-", "@"] {
        let robot = slow_robot().replace("name = \"cable1\"", &format!("name = \"{sign}cmd\""));
        let place = place_with(&robot);
        excite(&place, &LIMITS).succeeds();
        let file = String::from_utf8(place.read("run.csv")).unwrap();
        let header: Vec<&str> = file.lines().next().unwrap().split(',').collect();
        assert!(header.contains(&format!("'{sign}cmd_length_m").as_str()), "{header:?}");
        assert!(header.iter().all(|cell| !cell.starts_with(sign)), "{header:?}");
    }
}

#[test]
fn the_set_points_hold_what_they_promise() {
    let place = place_with(&slow_robot());
    let run = excite(&place, &LIMITS).succeeds();
    assert!(run.stdout.contains("run.csv") && run.stdout.contains("0.500 m/s"), "{run:#?}");
    let (columns, phases) = columns(&place.read("run.csv"));
    let robot = RobotFile::parse(&slow_robot(), "robot").unwrap();
    let params = robot.params();
    let vector = |names: [&str; 3], row: usize| Vector3::from(names.map(|name| columns[name][row]));
    let rows = columns["time_s"].len();
    assert!(rows > 3000 && phases.len() == rows);
    let cable = |name: &str, row: usize| {
        SVector::<f64, 8>::from_fn(|index, _| columns[&format!("cable{}_{name}", index + 1)][row])
    };
    for row in 0..rows {
        let place_m = vector(["x_m", "y_m", "z_m"], row);
        let velocity = vector(["vx_m_per_s", "vy_m_per_s", "vz_m_per_s"], row);
        let acceleration = vector(["ax_m_per_s2", "ay_m_per_s2", "az_m_per_s2"], row);
        assert!(velocity.norm() <= 0.5 + 1e-12 && acceleration.norm() <= 6.0 + 1e-12, "{row}");
        let middle_m = Vector3::new(0.01, 0.0, 0.0);
        assert!(((place_m - middle_m).abs() - Vector3::new(0.11, 0.08, 0.1)).max() < 1e-12, "{row}: {place_m}");
        let quaternion = ["qx", "qy", "qz", "qw"].map(|name| columns[name][row]);
        let pose = Pose::from_parts(place_m.into(), quaternion).unwrap();
        let forces_n = cable("tension_n", row);
        assert!(forces_n.iter().all(|force_n| (2.0..=25.0).contains(force_n)), "{row}: {forces_n}");
        let weight_n = (Vector3::new(0.0, 0.0, -9.80665) - acceleration) * 0.41;
        let outside = Vector6::new(weight_n.x, weight_n.y, weight_n.z, 0.0, 0.0, 0.0);
        assert!((structure_matrix::<8>(&params, &pose).unwrap() * forces_n + outside).amax() < 1e-9, "{row}");
        for (length_m, params) in cable("length_m", row).iter().zip(params.cables()) {
            assert!((length_m - params.length_m(&pose).unwrap()).abs() < 1e-12, "{row}");
        }
        if row > 0 {
            assert!((columns["time_s"][row] - columns["time_s"][row - 1] - 0.01).abs() < 1e-9);
            // Trapezoids of 10 ms over accelerations that change within 30 ms.
            let mean = (place_m - vector(["x_m", "y_m", "z_m"], row - 1)) / 0.01;
            let before = vector(["vx_m_per_s", "vy_m_per_s", "vz_m_per_s"], row - 1);
            assert!((mean - 0.5 * (velocity + before)).norm() < 0.02, "{row}");
            let mean = (cable("length_m", row) - cable("length_m", row - 1)) / 0.01;
            let speeds = (cable("speed_m_per_s", row) + cable("speed_m_per_s", row - 1)) * 0.5;
            assert!((mean - speeds).amax() < 0.02, "{row}");
        }
    }
    let mut order = phases;
    order.dedup();
    assert_eq!(order, ["stop_and_go", "alternating", "stroke", "rectangle"]);
}

#[test]
fn a_winch_on_a_bench_gets_lengths() {
    let place = place_with(&bench_robot().replace("0.001", "0.01").replace("'winch'", "'a \"winch\", rubbing'"));
    let run = excite(&place, &["--preview", "run.html"]).succeeds();
    assert!(unwrapped(&run.stdout).contains("cable lengths 0.800 to 1.200 m"), "{run:#?}");
    let (columns, phases) = columns(&place.read("run.csv"));
    let names: Vec<&str> = columns.keys().map(String::as_str).collect();
    assert_eq!(names, ["a \"winch\", rubbing_length_m", "a \"winch\", rubbing_speed_m_per_s", "time_s"]);
    assert!(columns[names[0]].iter().all(|length_m| (0.8 - 1e-9..=1.2 + 1e-9).contains(length_m)));
    assert_eq!(phases.len(), columns["time_s"].len());
    assert_self_contained(&String::from_utf8(place.read("run.html")).unwrap());
    let box_of = ["excite", "--model", "robot.toml", "-o", "new.csv", "--box", "0,0,0,1,1,1"];
    place.run_in_vain(&box_of).fails(2, &["--box", "platform", "rubbing"]).advises(&["Leave it out"]);
}

#[test]
fn the_preview_is_self_contained_and_names_are_text() {
    let robot = slow_robot().replacen("\"mini-ipanema\"", "'<b>&\"robot</b>'", 1).replacen(
        "\"cable1\"",
        "'<b>&\"1<script>alert(1)</script>'",
        1,
    );
    let place = place_with(&robot);
    excite(&place, &[&LIMITS[..], &["--preview", "run.html"]].concat()).succeeds();
    let page = String::from_utf8(place.read("run.html")).unwrap();
    assert_self_contained(&page);
    assert_eq!(page.matches("<svg").count(), 4);
    assert!(!page.contains("<b>") && !page.contains("alert(1)<") && page.contains("&lt;b&gt;&amp;&quot;1"));
    for word in ["Plan view", "Side view", "rectangle", "stop and go", "25.00 N", "2.00 N", "prefers-color-scheme"] {
        assert!(page.contains(word), "{word}");
    }
}

#[test]
fn flags_out_of_range_are_told() {
    let place = place_with(&slow_robot());
    let refused = |option: &str, value: &str| {
        place.run_in_vain(&["excite", "--model", "robot.toml", "-o", "run.csv", option, value])
    };
    for option in ["--max-speed-m-per-s", "--max-acceleration-m-per-s2", "--min-tension-n", "--max-tension-n"] {
        for value in ["nan", "inf", "-1", "0", "1e300"] {
            refused(option, value).fails(2, &[option, "allowed is"]);
        }
        refused(option, "1N").fails(2, &[option, "1N", "a number in digits"]);
    }
    refused("--box", "0,0,0,1,1").fails(2, &["--box", "x0,y0,z0,x1,y1,z1"]);
    refused("--box", "0,0,0,1,1,x").fails(2, &["--box"]);
    refused("--box", "-0.1,0,0,nan,0.1,0.1").fails(2, &["--box is NaN", "allowed is"]);
    refused("--box", "0.1,0,0,-0.1,0.1,0.1").fails(2, &["--box goes from 0.1 to -0.1 m along x"]);
    refused("--box", "0,0,0,0,0,0").fails(2, &["--box"]).advises(&["edge"]);
}

#[test]
fn forces_that_there_are_not_are_told_and_nothing_is_left() {
    let place = place_with(&slow_robot());
    let start = ["excite", "--model", "robot.toml", "-o", "run.csv", "--preview", "run.html"];
    let refused = |options: &[&str]| place.run_in_vain(&[&start, options].concat());
    refused(&["--max-tension-n", "4"])
        .fails(1, &["cable", "N hold the platform at ("])
        .advises(&["lower acceleration"]);
    refused(&["--box=-0.1,-0.1,0.6,0.1,0.1,0.7"]).fails(1, &["hold the platform at"]).advises(&["another box"]);
    // Exactly where a cable enters its pulley there is no way out.
    refused(&["--box=0.5,0.35,0.5,0.6,0.45,0.6"]).fails(1, &["(0.5"]);
    refused(&["--max-speed-m-per-s", "0.001"]).fails(1, &["the run would take"]).advises(&["smaller box"]);
}

#[test]
fn outputs_appear_whole_or_not_at_all() {
    let place = place_with(&slow_robot());
    place.write("old", "kept");
    let start = ["excite", "--model", "robot.toml"];
    let vain = |options: &[&str]| place.run_in_vain(&[&start, options].concat());
    vain(&["-o", "old"]).fails(1, &["old exists already"]).advises(&["--force"]);
    vain(&["-o", "run.csv", "--preview", "old"]).fails(1, &["old exists already"]);
    vain(&["-o", "robot.toml", "--force"]).fails(1, &["robot.toml is an input"]);
    vain(&["-o", "run.csv", "--preview", "robot.toml", "--force"]).fails(1, &["robot.toml is an input"]);
    vain(&["-o", "run.csv", "--preview", "./run.csv"]).fails(2, &["named for two outputs"]);
    vain(&["-o", "no/run.csv"]).fails(1, &["cannot write no/run.csv"]).advises(&["directory no exists"]);
    place.run(&[&start[..], &["-o", "old", "--force"]].concat()).succeeds();
    assert!(place.read("old").len() > 100_000);
    assert_eq!(place.names(), ["old", "robot.toml"]);
}

/// A drive whose cycle takes 4 ms.
const DRIVE: &str = "format = 'fric-robot/1'\nname = 'bench'\ncycle_s = 0.004\n[platform]\nmass_kg = 0.5\n[[cable]]\nname = 'drive'\n\
                     pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]\n\
                     friction = { mu = 0.019, sigma_n_per_m = 950.0, viscous_n_s_per_m = 0.2 }\n";

/// What `discover --json` writes of a cable, as far as it matters: a drag of the bearings for which another effect would do as well.
const FOUND: &str = r#"{ "format": "fric-discover/1", "robot": "bench", "log": ["a.csv"], "cables": [ { "name": "drive", "noise_floor_n": 0.02,
    "effects": [ { "kind": "bearing_drag", "parameters": { "drag_n": 0.05 },
                   "runner_up": { "kind": "load_nonlinearity", "delta_bic": -50.0, "held_out_rms_n": 0.02, "as_good": true } } ],
    "tried": [], "parameters": { "mu": 0.018, "bearing_drag.drag_n": 0.05 },
    "standard_errors": { "mu": 0.0001, "bearing_drag.drag_n": 0.001 } } ] }"#;

#[test]
fn a_run_is_designed_for_what_a_discovery_left_open() {
    let place = place_with(DRIVE);
    place.write("found.json", FOUND);
    let loads = ["--min-tension-n", "2", "--max-tension-n", "10", "--duration", "8"];
    let run = excite(&place, &[&["--for", "found.json", "--preview", "run.html"], &loads[..]].concat()).succeeds();
    let (columns, _) = columns(&place.read("run.csv"));
    assert!(columns["drive_tension_n"].iter().all(|tension_n| (2.0..=10.0).contains(tension_n)));
    assert_eq!(columns["time_s"].len(), 2000);
    let shown = unwrapped(&run.stdout);
    let (_, told) = shown.split_once("the run, drawn ").unwrap();
    for words in [
        "drive: bearing_drag or load_nonlinearity",
        "if it is bearing_drag",
        "the identification run",
        "noise 0.0200 N",
    ] {
        assert!(told.contains(words), "{words} in {told}");
    }
    let page = String::from_utf8(place.read("run.html")).unwrap();
    assert!(page.contains("designed run") && page.contains(told), "{told}");
    assert_self_contained(&page);
    // Under one load they are the same.
    place
        .run_in_vain(&["excite", "--model", "robot.toml", "-o", "new.csv", "--for", "found.json", "--duration", "8"])
        .fails(1, &["no run of 8 s within these limits tells bearing_drag from load_nonlinearity on drive"])
        .advises(&["greater limits"]);
}

#[test]
fn parameters_to_determine_may_go_without_their_units() {
    let place = place_with(DRIVE);
    let run = excite(&place, &["--determine", "sigma,mu", "--duration", "6", "--noise-n", "0.01"]).succeeds();
    assert!(run.stdout.contains("sigma_n_per_m 950") && run.stdout.contains("mu 0.019"), "{run:#?}");
}

#[test]
fn questions_that_cannot_be_asked_are_told() {
    let place = place_with(DRIVE);
    place.write("wrong.json", "{}");
    place.write("other.json", FOUND.replace("bench", "another"));
    place.write("by-wrench.json", FOUND.replacen('{', "{ \"wrench\": {},", 1));
    place.write("nothing.json", FOUND.replace("true", "false"));
    let refused = |options: &[&str]| {
        place.run_in_vain(&[&["excite", "--model", "robot.toml", "-o", "run.csv"], options].concat())
    };
    refused(&["--separate", "stribeck,dwel_stiction"]).fails(2, &["--separate", "dwel_stiction", "did you mean"]);
    refused(&["--separate", "stribeck"]).fails(2, &["--separate", "two effects"]);
    refused(&["--determine", "mju"]).fails(2, &["--determine", "mju"]);
    refused(&["--determine", "mu", "--cables", "drve"]).fails(2, &["drve", "did you mean `drive`"]);
    refused(&["--determine", "mu", "--separate", "stribeck,coulomb"]).fails(2, &["cannot be used with"]);
    refused(&["--duration", "8"]).fails(2, &["--for"]);
    refused(&["--determine", "mu", "--duration", "1e9"]).fails(2, &["--duration is", "allowed is 3 to 600"]);
    refused(&["--determine", "mu", "--noise-n", "0"]).fails(2, &["--noise-n is 0"]);
    refused(&["--determine", "stribeck.ratio"]).fails(1, &["drive has no `stribeck`"]);
    refused(&["--for", "missing.json"]).fails(1, &["missing.json"]);
    refused(&["--for", "wrong.json"]).fails(1, &["wrong.json", "not what `discover --json` writes"]);
    refused(&["--for", "other.json"]).fails(1, &["robot `another`"]);
    refused(&["--for", "by-wrench.json"]).fails(1, &["by the wrench", "--separate"]);
    refused(&["--for", "nothing.json"]).fails(1, &["leaves nothing open"]);
}
