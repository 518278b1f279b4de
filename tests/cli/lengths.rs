//! A robot whose pose nobody measured: `[log] pose = "lengths"`.

use serde_json::Value;

use super::support::{Place, example_robot, unwrapped};

/// The example with the poses from the lengths.
fn robot() -> String {
    format!("{}\n[log]\npose = \"lengths\"\n", example_robot())
}

/// A log with poses, without noise of the lengths, and beside its robot file one that takes them from the lengths.
fn place() -> Place {
    let place = Place::empty();
    place.write("measured.toml", example_robot());
    place.write("lengths.toml", robot());
    let simulate = ["simulate", "--model", "measured.toml", "-o", "log.mcap", "--duration", "6", "--seed", "3"];
    place.run(&simulate).succeeds();
    place
}

fn number(json: &Value, key: &str) -> f64 {
    json[key].as_f64().unwrap_or_else(|| panic!("no number `{key}` in {json}"))
}

#[test]
fn every_command_takes_the_pose_from_the_lengths() {
    let place = place();
    for model in ["measured", "lengths"] {
        let file = format!("{model}.toml");
        let json = format!("{model}.json");
        place.run(&["replay", "log.mcap", "--model", &file, "--json", &json]).succeeds();
    }
    let [measured, lengths] = ["measured.json", "lengths.json"].map(|name| place.json(name));
    assert!(measured.get("pose").is_none());
    let pose = &lengths["pose"];
    assert_eq!((&pose["source"], &pose["samples"], &pose["missing"]), (&"lengths".into(), &6000.into(), &0.into()));
    assert!(number(pose, "residual_rms_m") < 1e-4, "{pose}");
    // The log's poses end 4 ms before its cables do.
    let error = |result: &Value| number(&result["wrench"]["after"], "force_rms_n");
    assert!((error(&lengths) / error(&measured) - 1.0).abs() < 0.05, "{lengths} {measured}");

    let run = place.run(&["info", "log.mcap", "--model", "lengths.toml", "--json", "info.json"]).succeeds();
    assert!(
        unwrapped(&run.stdout).contains("computed from the cable lengths") && unwrapped(&run.stdout).contains("mm rms"),
        "{run:#?}"
    );
    let info = place.json("info.json");
    let signal = info["signals"].as_array().unwrap().iter().find(|signal| signal["signal"] == "pose").unwrap();
    assert!(signal["path"] == "lengths" && number(signal, "residual_rms_m") < 1e-4, "{signal}");

    // What is converted has the poses as messages.
    place.run(&["convert", "log.mcap", "--model", "lengths.toml", "-o", "converted.mcap"]).succeeds();
    let run = place.run(&["info", "converted.mcap"]).succeeds();
    assert!(run.stdout.contains("/platform_pose"), "{run:#?}");

    // And what is simulated for such a robot has none.
    let simulate = ["simulate", "--model", "lengths.toml", "-o", "without.mcap", "--duration", "1", "--seed", "3"];
    place.run(&simulate).succeeds();
    let run =
        place.run(&["replay", "without.mcap", "--json", "without.json", "--start", "0.2", "--end", "0.7"]).succeeds();
    assert!(!run.stdout.contains("/platform_pose"), "{run:#?}");
    let pose = &place.json("without.json")["pose"];
    assert_eq!((&pose["samples"], &pose["missing"]), (&500.into(), &0.into()), "{pose}");
}

#[test]
fn a_cable_that_is_a_centimetre_off_is_told() {
    let place = place();
    // As if the pulley of a cable stood a centimetre further along it than the robot file says.
    place.write("off.toml", robot().replacen("base_m = [0.55, 0.4, 0.5]", "base_m = [0.557, 0.405, 0.505]", 1));
    let off = place.run(&["replay", "log.mcap", "--model", "off.toml", "--json", "off.json"]);
    off.warns(&["do not agree with one pose", "mm rms", "base_m"]);
    let residual_m = number(&place.json("off.json")["pose"], "residual_rms_m");
    assert!((0.0005..0.004).contains(&residual_m), "{residual_m}");
}

#[test]
fn lengths_that_have_another_zero_give_no_pose() {
    let place = place();
    place.write("far.toml", robot().replace("[0.55,", "[5.5,").replace("[-0.55,", "[-5.5,"));
    let run = place.run(&["replay", "log.mcap", "--model", "far.toml", "--end", "0.5"]);
    run.warns(&["500 samples have no pose", "no pose has such lengths"]);
    let fit = ["fit", "log.mcap", "--model", "far.toml", "-o", "fitted.toml", "--end", "0.5"];
    place.run(&fit).fails(1, &["no sample has a pose from its cable lengths", "count from `base_m`"]);
}

#[test]
fn fewer_than_six_cables_are_refused_where_the_pose_is_asked_for() {
    let place = Place::with_log();
    let text = robot();
    let mut cables: Vec<&str> = text.split("[[cable]]").collect();
    let last = cables.pop().unwrap();
    let log = last.split_once("[log]").unwrap().1;
    cables.truncate(6);
    place.write("five.toml", format!("{}[log]{log}", cables.join("[[cable]]")));
    let run = place.run(&["info", "log.mcap", "--model", "five.toml"]);
    run.fails(1, &["five.toml, line", "`pose` is \"lengths\"", "6 cables or more", "5 of the 5", "measured pose"]);
}
