//! A bench without a force sensor at the platform: its load is known.

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
        // The bench of the run is faster than a mass can fall at times, and slack there.
        let run = place.run(&["replay", "log.mcap", "--model", "robot.toml", "--json", "replay.json"]);
        if reference.contains("mass") {
            run.warns(&["SLACK"])
        } else {
            run.succeeds()
        };
        let cable = &place.json("replay.json")["cables"][0];
        let error_n = |when: &str| cable[when]["rms_n"].as_f64().unwrap();
        assert!(error_n("after") < 0.8 * error_n("before"), "{cable}");

        // μ without a load that varies goes with the offset; held, it is found.
        let fit = ["fit", "log.mcap", "--model", "robot.toml", "-o", "fitted.toml", "--json", "fit.json"];
        place.run(&[&fit[..], &["--parameters", "mu,sigma_n_per_m,viscous_n_s_per_m"]].concat()).succeeds();
        let cable = &place.json("fit.json")["cables"][0];
        let mu = cable["parameters"]["mu"].as_f64().unwrap();
        assert!((mu - 0.02).abs() < 0.0005, "{reference}: {cable}");
        assert!(cable["after"]["rms_n"].as_f64().unwrap() < 0.05, "{cable}");
        assert!(String::from_utf8(place.read("fitted.toml")).unwrap().contains(reference));
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
    assert!(told.contains("a zero and no friction, offset_n of winch is -68."), "{run:#?}");
    let place = place_of("{ constant_n = 49.05 }");
    let run = place.run(&["fit", "log.mcap", "--model", "robot.toml", "-o", "fitted.toml"]).succeeds();
    assert!(!unwrapped(&run.stdout).contains("a zero and no friction"), "{run:#?}");
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
