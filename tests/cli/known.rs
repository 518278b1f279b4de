//! A bench without a force sensor at the platform: its load is known.

use super::logs::{Storage, rewrite};
use super::support::{Place, unwrapped};

fn bench(reference: &str, mu: f64) -> String {
    format!(
        "format = 'fric-robot/1'\nname = 'bench'\ncycle_s = 0.001\n[log]\nreference = {reference}\n[[cable]]\nname = 'winch'\n\
         pulleys = [{{ wrap_deg = 180.0, sensor = true }}, {{ wrap_deg = 90.0 }}]\n\
         friction = {{ mu = {mu}, sigma_n_per_m = 5000.0, viscous_n_s_per_m = 0.5 }}\n"
    )
}

/// A simulated log of a known load with μ = 0.02, and a robot file beside it that says 0.01.
fn place_of(reference: &str) -> Place {
    let place = Place::empty();
    place.write("truth.toml", bench(reference, 0.02));
    place.write("robot.toml", bench(reference, 0.01));
    let simulate = ["simulate", "--model", "truth.toml", "-o", "log.mcap", "--duration", "20", "--seed", "3"];
    place.run(&simulate).succeeds();
    place
}

#[test]
fn a_known_load_is_the_reference_of_every_command() {
    for reference in ["{ constant_n = 49.05 }", "{ hanging_mass_kg = 5.0 }"] {
        let place = place_of(reference);
        let run = place.run(&["info", "log.mcap", "--model", "robot.toml"]).succeeds();
        let known = reference.trim_matches(['{', ' ', '}']);
        assert!(run.stdout.contains(known) && unwrapped(&run.stdout).contains("known and not measured"), "{run:#?}");
        assert!(!run.stdout.contains("/reference_forces"), "{run:#?}");
        place.run(&["replay", "log.mcap", "--model", "robot.toml", "--json", "replay.json"]).succeeds();
        let cable = &place.json("replay.json")["cables"][0];
        let error_n = |when: &str| cable[when]["rms_n"].as_f64().unwrap();
        assert!(error_n("after") < 0.8 * error_n("before"), "{cable}");

        // μ without a load that varies goes with the offset; held, it is found.
        let fit = ["fit", "log.mcap", "--model", "robot.toml", "-o", "fitted.toml", "--json", "fit.json"];
        place.run(&[&fit[..], &["--parameters", "mu,sigma_n_per_m,viscous_n_s_per_m"]].concat()).succeeds();
        let cable = &place.json("fit.json")["cables"][0];
        let mu = cable["parameters"]["mu"].as_f64().unwrap();
        assert!((mu - 0.02).abs() < 0.0005, "{reference}: {cable}");
        // What is left is mostly the friction that was stored when the log began.
        let [before_n, after_n] = ["before", "after"].map(|when| cable[when]["rms_n"].as_f64().unwrap());
        assert!(after_n < 0.05 * before_n, "{cable}");
        assert!(String::from_utf8(place.read("fitted.toml")).unwrap().contains(reference));
    }
}

/// Two weights on one bench: the robot file attached to each log states its own.
#[test]
fn each_log_has_the_load_that_its_attached_file_states() {
    let place = Place::empty();
    for mass_kg in ["5.0", "10.0"] {
        place.write("truth.toml", bench(&format!("{{ hanging_mass_kg = {mass_kg} }}"), 0.02));
        let log = format!("{mass_kg}.mcap");
        place.run(&["simulate", "--model", "truth.toml", "-o", &log, "--duration", "20", "--seed", "3"]).succeeds();
    }
    let fit = ["fit", "5.0.mcap", "10.0.mcap", "-o", "fitted.toml", "--json", "fit.json", "--force"];
    place.run(&fit).succeeds();
    let cable = &place.json("fit.json")["cables"][0];
    // Two loads tell μ from the offset, and leave what one does.
    let value = |key: &str| cable["parameters"][key].as_f64().unwrap();
    assert!((value("mu") - 0.02).abs() < 2e-4 && value("offset_n").abs() < 0.05, "{cable}");
    // A file that is named states one load for all logs, which the sensor contradicts.
    place.run(&[&fit[..], &["--model", "truth.toml"]].concat()).warns(&["the sensor is 0.75 times the reference"]);

    // Another machine is told, and a load that only one file states is an error.
    place.write("other.toml", bench("{ hanging_mass_kg = 10.0 }", 0.03));
    let simulate = ["simulate", "-o", "other.mcap", "--duration", "20", "--seed", "3", "--force", "--model"];
    place.run(&[&simulate[..], &["other.toml"]].concat()).succeeds();
    let both = ["fit", "5.0.mcap", "other.mcap", "-o", "fitted.toml", "--force"];
    place.run(&both).warns(&["`other.mcap`: the robot file attached to it has other values"]);
    place.write("measured.toml", bench("'/reference_forces'", 0.02));
    place.run(&[&simulate[..], &["measured.toml"]].concat()).succeeds();
    place.run(&both).fails(1, &["`other.mcap`", "states no load"]).advises(&["--model"]);
    place.write("other.mcap", rewrite(&place.read("10.0.mcap"), Storage::Zstd, None, |_, _| true));
    place.run(&both).fails(1, &["`other.mcap`", "no robot file attached"]).advises(&["convert", "--model"]);
}

#[test]
fn a_decimal_comma_is_told() {
    let place = place_of("{ hanging_mass_kg = 5.0 }");
    for (written, told) in [("{ hanging_mass_kg = 5,25 }", "`5,25`"), ("{ constant_n = 49,05 } # N", "`49,05`")] {
        place.write("comma.toml", bench(written, 0.02));
        let run = place.run(&["replay", "log.mcap", "--model", "comma.toml"]);
        run.fails(1, &["comma.toml, line 5", told, "decimal point"]);
    }
}

/// A fit that takes a wrong weight for a zero of the sensor says so.
#[test]
fn a_zero_that_is_most_of_the_error_is_told() {
    let place = place_of("{ hanging_mass_kg = 12.0 }");
    place.write("robot.toml", bench("{ hanging_mass_kg = 5.0 }", 0.02));
    let run = place.run(&["fit", "log.mcap", "--model", "robot.toml", "-o", "fitted.toml", "--parameters", "offset_n"]);
    let told = unwrapped(&run.stdout);
    // 7 kg that the file does not know.
    assert!(told.contains("a zero or a scale and no friction, offset_n of winch is -68."), "{run:#?}");
    let place = place_of("{ constant_n = 49.05 }");
    let run = place.run(&["fit", "log.mcap", "--model", "robot.toml", "-o", "fitted.toml"]).succeeds();
    assert!(!unwrapped(&run.stdout).contains("and no friction"), "{run:#?}");
}

/// One load tells no gain from an offset: no gain is named, whichever of the two is wrong, and what cannot be told apart is said.
#[test]
fn under_one_load_no_gain_is_named() {
    let place = place_of("{ constant_n = 49.05 }");
    let off = |offset_n: &str| {
        bench("{ constant_n = 49.05 }", 0.02).replace("0.5 }", &format!("0.5, offset_n = {offset_n} }}"))
    };
    place.write("off.toml", off("0.8"));
    let gain = ["--effect", "sensor_gain:gain=1.02", "-o", "gain.mcap", "--duration", "20", "--seed", "4"];
    place.run(&[&["simulate", "--model", "truth.toml"], &gain[..]].concat()).succeeds();
    for (log, robot) in [("log.mcap", "off.toml"), ("gain.mcap", "truth.toml"), ("gain.mcap", "off.toml")] {
        let run = place.run(&["discover", log, "--model", robot, "--json", "found.json", "--force"]).succeeds();
        let cable = &place.json("found.json")["cables"][0];
        for effect in cable["effects"].as_array().unwrap() {
            assert_eq!(effect["kind"], "sensor_offset", "{log} {robot}: {cable}");
            let other = &effect["runner_up"];
            assert!(other["kind"] == "sensor_gain" && other["as_good"] == true, "{log} {robot}: {cable}");
        }
        let told = run.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(told.contains("nothing is known of a gain, or of what goes with the load"), "{run:#?}");
    }
}

#[test]
fn a_weight_that_never_moves_quietly_is_told() {
    let place = place_of("{ hanging_mass_kg = 5.0 }");
    // An encoder with noise of 2 mm: no difference of lengths is quiet.
    let options = ["--model", "truth.toml", "-o", "rough.mcap", "--duration", "5", "--length-noise-m", "0.002"];
    place.run(&[&["simulate"], &options[..]].concat()).succeeds();
    let run = place.run_in_vain(&["fit", "rough.mcap", "--model", "robot.toml", "-o", "fitted.toml"]);
    run.fails(1, &["hanging_mass_kg = 5.0", "quiet motion", "constant_n"]);
    place.run(&["replay", "rough.mcap", "--model", "robot.toml"]).warns(&["hanging_mass_kg = 5.0", "stay empty"]);
}

#[test]
fn a_load_of_cables_that_hold_a_platform_is_not_simulated() {
    let place = Place::empty();
    let robot = super::support::example_robot() + "\n[log]\nreference = { constant_n = 10.0 }\n";
    place.write("robot.toml", robot);
    let run = place.run_in_vain(&["simulate", "--model", "robot.toml", "-o", "log.mcap"]);
    run.fails(1, &["`reference` under [log]", "platform"]);
}

/// Under a hanging mass a run keeps to accelerations at which the force is known; in free fall the cable would be slack.
#[test]
fn a_run_keeps_the_weight_on_its_cable() {
    let place = place_of("{ hanging_mass_kg = 5.0 }");
    place.run(&["excite", "--model", "robot.toml", "-o", "run.csv"]).succeeds();
    let text = String::from_utf8(place.read("run.csv")).unwrap();
    let points = text.lines().skip(1).map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        (cells[0].parse::<f64>().unwrap(), cells[3].parse::<f64>().unwrap())
    });
    let points: Vec<(f64, f64)> = points.collect();
    let steps = points.windows(2).map(|pair| ((pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)).abs());
    let greatest_m_per_s2 = steps.fold(0.0, f64::max);
    assert!((0.3..0.41).contains(&greatest_m_per_s2), "{greatest_m_per_s2} m/s²");
    let run = place.run(&["excite", "--model", "robot.toml", "-o", "fast.csv", "--max-acceleration-m-per-s2", "2"]);
    run.succeeds();
}

/// Where a constant load and a motion one way leave friction and a zero open, the fit keeps the zero: with both free, friction as large as the load agrees
/// with any log.
#[test]
fn motion_one_way_leaves_the_zero_as_given() {
    let place = Place::empty();
    let columns = "[log]\nreference = { constant_n = 10.0 }\n[log.columns]\n'time_s' = { column = 't' }\n\
                   'w.length_m' = { column = 'l' }\n'w.force_n' = { column = 'f' }\n";
    let robot = format!(
        "format = 'fric-robot/1'\nname = 'bench'\ncycle_s = 0.01\n{columns}[[cable]]\nname = 'w'\npulleys = [{{ wrap_deg = 180.0 }}]\n\
         friction = {{ mu = 0.01, sigma_n_per_m = 100.0, viscous_n_s_per_m = 0.0 }}\n"
    );
    place.write("robot.toml", robot);
    // A motor that reels in at several speeds: 0.7 N of friction and 0.6 N s/m, with a ripple in place of noise. A pulley of 180° bears twice the mean force.
    let mut logs = Vec::new();
    for (name, speed_m_per_s) in [("a", 0.1), ("b", 0.5), ("c", 1.0), ("d", 1.5)] {
        let row = |cycle: i32| {
            let time_s = 0.01 * f64::from(cycle);
            let force_n = 10.7 + 0.6 * speed_m_per_s + 0.2 * (17.0 * time_s).sin();
            format!("{time_s},{},{force_n}\n", 20.0 - speed_m_per_s * time_s)
        };
        let rows: String = (0..400).map(row).collect();
        place.write(&format!("{name}.csv"), format!("t,l,f\n{rows}"));
        logs.push(format!("{name}.csv"));
    }
    let logs: Vec<&str> = logs.iter().map(String::as_str).collect();
    let fit = [&["fit"], &logs[..], &["--model", "robot.toml", "-o", "fitted.toml", "--json", "fit.json"]].concat();
    let run = place.run(&fit);
    let cable = &place.json("fit.json")["cables"][0];
    let value = |key: &str| cable["parameters"][key].as_f64().unwrap();
    assert!(
        (value("mu") - 0.7 / (2.0 * 10.35)).abs() < 0.002 && (value("viscous_n_s_per_m") - 0.6).abs() < 0.1,
        "{cable}"
    );
    assert_eq!((value("offset_n"), cable["undetermined"][0].as_str()), (0.0, Some("offset_n")), "{cable}");
    let told = unwrapped(&run.stdout);
    assert!(told.contains("offset_n of w is kept as given") && told.contains("in both directions"), "{told}");
    // A contact of 100 N/m is too soft for it, and nothing says how stiff it is.
    assert!(
        told.contains("contradicts the given σ (sigma_n_per_m) of w") && !told.contains("kept from the robot file"),
        "{told}"
    );
}
