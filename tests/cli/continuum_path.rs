//! `continuum track`: the tensions for a path.

use super::continuum::{column, numbers, prototype, rows};
use super::support::Place;

#[test]
fn a_path_becomes_tensions() {
    let place = Place::empty();
    place.write("arm.toml", prototype());
    place.write("path.csv", "time_s,bend_rad\n0,0.4\n0.5,0.9\n1,0.7\n1.5,0.72\n");
    let track = ["continuum", "track", "path.csv", "--model", "arm.toml", "--json", "t.json"];
    let run = place.run(&[&track[..], &["-o", "tensions.csv", "--simulate"]].concat()).succeeds();
    assert!(
        run.stdout.starts_with("tendon-prototype: by `history` 4 of 4 goals reached; REVERSAL 2, DEAD_BAND "),
        "{run:#?}"
    );
    assert!(run.stdout.lines().all(|line| line.chars().count() <= 80), "{run:#?}");
    let (result, csv) = (place.json("t.json"), String::from_utf8(place.read("tensions.csv")).unwrap());
    assert_eq!(result["format"], "fric-continuum-track/1");
    let tension_n: Vec<f64> = rows(&result["tension_base_n"]).iter().map(|pair| pair[0]).collect();
    assert_eq!(column(&csv, "tension_base_n"), tension_n);
    let flags = |name: &str| column(&csv, name).iter().map(|flag| *flag > 0.5).collect::<Vec<bool>>();
    assert_eq!((flags("reversal"), flags("out_of_reach")), (vec![false, false, true, true], vec![false; 4]));
    for (wanted, predicted) in column(&csv, "bend_rad").iter().zip(column(&csv, "predicted_bend_rad")) {
        assert!((wanted - predicted).abs() < 1e-8, "{wanted} {predicted}");
    }
    // A run of these tensions from slack has these bends, by the same holes.
    place.write(
        "run.csv",
        csv.lines()
            .map(|line| line.split(',').collect::<Vec<_>>())
            .fold(String::new(), |text, cells| text + cells[0] + "," + cells[2] + "\n")
            .replacen('\n', "\n-1,0\n", 1),
    );
    place.run(&["continuum", "shape", "run.csv", "--model", "arm.toml", "--ways", "history", "--json", "s.json"]);
    let shapes = place.json("s.json");
    for (bend_rad, wanted) in numbers(&shapes["series"][0]["bend_rad"]).iter().skip(1).zip([0.4, 0.9, 0.7, 0.72]) {
        assert!((bend_rad - wanted).abs() < 1e-8, "{bend_rad} {wanted}");
    }
    let ways = result["simulation"]["ways"].as_array().unwrap();
    let error_rad = |place: usize| ways[place]["mean_bend_error_rad"].as_f64().unwrap();
    assert!(error_rad(2) < 0.1 * error_rad(0), "{ways:?}");

    // The same as a log, and what the holes remember of a run before.
    place.run(&[&track[..5], &["-o", "tensions.mcap"]].concat()).succeeds();
    assert!(place.read("tensions.mcap").starts_with(b"\x89MCAP0\r\n"));
    place.write("before.csv", "time_s,tension_base_n\n0,0\n1,1.4\n2,0.9\n");
    let after = [&track[..5], &["--after", "before.csv", "--json", "after.json"]].concat();
    place.run(&after).succeeds();
    let first_n = |name: &str| rows(&place.json(name)["tension_base_n"])[0][0];
    assert!((first_n("after.json") - first_n("t.json")).abs() > 0.01, "{}", first_n("after.json"));
}

#[test]
fn mistakes_in_a_path_get_their_sentence() {
    let place = Place::empty();
    place.write("arm.toml", prototype());
    let track = |path: &str, more: &[&str]| {
        place.write("path.csv", path);
        place.run_in_vain(&[&["continuum", "track", "path.csv", "--model", "arm.toml"], more].concat())
    };
    track("bend_rad,tip_x_m,tip_y_m\n0.1,0.2,0.1\n", &[]).fails(1, &["path.csv", "both `bend_rad` and `tip_x_m`"]);
    track("time_s\n1\n", &[]).fails(1, &["path.csv", "neither `bend_rad` nor `tip_x_m`"]);
    track("bend_deg\n30\n", &[]).fails(1, &["path.csv", "bend_deg", "bend_rad"]);
    track("bend_rad\n0.1\n\"\"\n", &[]).fails(1, &["path.csv", "`bend_rad` is NaN in row 2"]);
    let good = "bend_rad\n0.4\n";
    track(good, &["--least-tension-n", "1,2,3"]).fails(2, &["--least-tension-n has 3 numbers"]);
    track(good, &["--greatest-tension-n", "9"]).fails(2, &["--greatest-tension-n of the first tendon is 9", "0 to 4"]);
    track(good, &["--hold-rad", "nan"]).fails(2, &["--hold-rad", "NaN"]);
    track(good, &["--simulate", "--mu-spread-ratio", "2"]).fails(2, &["--mu-spread-ratio is 2.0", "0 to 1"]);
    track(good, &["--seed", "3"]).fails(2, &["--simulate"]);
    track("bend_rad\n9\n", &["--simulate"]).fails(1, &["path.csv", "no bend of 9.0000 rad (goal 1)"]);
    track("time_s,bend_rad\n-1,0.4\n", &["-o", "x.mcap"]).fails(1, &["path.csv", "begins before 0 s"]);
    place.write("path.csv", "bend_rad\n0.4\n9\n");
    let far = place.run(&["continuum", "track", "path.csv", "--model", "arm.toml"]);
    far.warns(&["1 of 2 goals", "out of reach"]);
}
