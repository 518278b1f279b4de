//! `fit` on what it cannot or can hardly use: one clear sentence each, and everything left as it was.

use super::fit::{bench_log, platform_log, platform_robot};
use super::logs::{Storage, rewrite, without};
use super::simulate::bench_robot;
use super::support::{Place, Run, command};

/// A place with a log of the bench and its robot file.
fn bench() -> Place {
    let place = Place::empty();
    place.write("log.mcap", bench_log());
    place.write("robot.toml", bench_robot());
    place
}

/// A place with a log of the robot of eight cables and its robot file.
fn platform() -> Place {
    let place = Place::empty();
    place.write("log.mcap", platform_log());
    place.write("robot.toml", platform_robot());
    place
}

/// Fits in vain.
fn refused(place: &Place, arguments: &[&str]) -> Run {
    place.run_in_vain(&[&["fit"], arguments, &["-o", "fitted.toml", "--json", "fit.json"]].concat())
}

/// 64 MB of rows in few bytes: many cables, on which nothing happens.
#[test]
fn samples_beyond_memory_need_a_folder() {
    let place = Place::empty();
    let names: Vec<String> = (0..64).map(|cable| format!("c{cable}")).collect();
    let mut robot = "format = \"fric-robot/1\"\nname = \"loom\"\ncycle_s = 0.001\n".to_owned();
    let mut log = "time_s".to_owned();
    for name in &names {
        robot += &format!("[[cable]]\nname = \"{name}\"\npulleys = [{{ wrap_deg = 180.0, sensor = true }}]\n");
        log += &format!(",{name}.force_n,{name}.length_m,{name}.reference_n");
    }
    for sample in 0..13_200 {
        log += &format!("\n{}e-3{}", sample, ",1,1,1".repeat(names.len()));
    }
    place.write("robot.toml", robot);
    place.write("log.csv", log);
    for arguments in [&["fit", "log.csv", "-o", "fitted.toml"][..], &["discover", "log.csv"]] {
        let mut command = command(&place.path(""), &[arguments, &["--model", "robot.toml"]].concat());
        // The first is Unix's, the others are of Windows.
        for variable in ["TMPDIR", "TMP", "TEMP"] {
            command.env(variable, "nowhere");
        }
        let run = Run::new(command.output().unwrap());
        run.fails(1, &["too many for memory", "temporary file in nowhere"]).advises(&["TMP", "72 free bytes"]);
        assert!(!place.path("fitted.toml").exists());
    }
}

#[test]
fn command_lines_that_are_wrong_are_told() {
    let place = bench();
    place.run_in_vain(&["fit", "log.mcap"]).fails(2, &["--output"]);
    place.run_in_vain(&["fit", "-o", "fitted.toml"]).fails(2, &["LOG"]);
    place.run_in_vain(&["fit", "log.mcap", "-o", "-"]).fails(2, &["'-'", "stdout", "name a file"]);
    refused(&place, &["log.mcap", "--reference", "force"]).fails(2, &["force", "forces", "wrench"]);
    refused(&place, &["log.mcap", "./log.mcap"]).fails(2, &["./log.mcap is named twice"]).advises(&["once"]);
    let same = ["fit", "log.mcap", "-o", "a", "--json", "./a"];
    place.run_in_vain(&same).fails(2, &["./a is named for two outputs"]);
    for (names, words) in [
        ("my", &["unknown parameter `my`", "did you mean `mu`"][..]),
        ("mu,sigma_n_per_mm", &["`sigma_n_per_mm`", "did you mean `sigma_n_per_m`"]),
        ("stribek.ratio", &["`stribek.ratio`", "did you mean `stribeck.ratio`"]),
        ("mu,sigma,viscous", &["`sigma`", "did you mean `sigma_n_per_m`? (known here: `sigma_n_per_m`, ", " more)"]),
        ("", &["--parameters", "unknown parameter ``"]),
        ("mu,offset_n,mu", &["`mu` is named twice"]),
    ] {
        refused(&place, &["log.mcap", "--parameters", names]).fails(2, &["--parameters"]).fails(2, words);
    }
}

#[test]
fn logs_that_are_none_are_told() {
    let place = bench();
    place.write("empty.mcap", "");
    place.write("bare.mcap", rewrite(bench_log(), Storage::Zstd, None, |_, _| true));
    place.write("silent.mcap", rewrite(bench_log(), Storage::Zstd, Some(&bench_robot()), |_, _| false));
    refused(&place, &["nowhere.mcap"]).fails(1, &["no file", "`nowhere.mcap`"]);
    refused(&place, &["log.mcap", "nowhere.mcap"]).fails(1, &["`nowhere.mcap`"]);
    refused(&place, &["robot.toml"]).fails(1, &["`robot.toml` is not an MCAP recording"]);
    refused(&place, &["empty.mcap"]).fails(1, &["`empty.mcap` is empty"]);
    refused(&place, &["silent.mcap"]).fails(1, &["no messages on `/cable_states`"]);
    refused(&place, &["bare.mcap"]).fails(1, &["no robot file attached"]).advises(&["--model"]);
    refused(&place, &["log.mcap", "--model", "nowhere.toml"]).fails(1, &["robot file nowhere.toml"]);
    place.write("bad.toml", bench_robot().replace("mu = 0.02", "nu = 0.02"));
    let run = refused(&place, &["log.mcap", "--model", "bad.toml"]);
    run.fails(1, &["bad.toml, line 8", "`nu`", "did you mean `mu`"]).advises(&["--model"]);
    place.write("rope.toml", bench_robot().replace("'winch'", "'rope'"));
    let run = refused(&place, &["log.mcap", "--model", "rope.toml"]);
    run.fails(1, &["`/cable_states`", "none of the robot's cables (rope)", "winch"]);
}

#[test]
fn outputs_that_cannot_be_written_are_told_before_the_work() {
    let place = bench();
    place.write("old", "kept");
    std::fs::create_dir(place.path("folder")).unwrap();
    let fit = |output: &str, rest: &[&str]| {
        place.run_in_vain(&[&["fit", "log.mcap", "--model", "robot.toml", "-o", output], rest].concat())
    };
    fit("old", &[]).fails(1, &["old exists already"]).advises(&["--force"]);
    fit("new", &["--json", "old"]).fails(1, &["old exists already"]).advises(&["--force"]);
    for force in [&[][..], &["--force"]] {
        fit("log.mcap", force).fails(1, &["log.mcap is an input"]).advises(&["another output"]);
        fit("./robot.toml", force).fails(1, &["./robot.toml is an input"]).advises(&["another output"]);
        fit("new", &[&["--json", "robot.toml"], force].concat()).fails(1, &["robot.toml is an input"]);
    }
    fit("folder", &["--force"]).fails(1, &["cannot write folder", "directory"]).advises(&["file in it"]);
    fit("no/such/out", &[]).fails(1, &["cannot write no/such/out"]).advises(&["no/such", "exists"]);
    place.run(&["fit", "log.mcap", "-o", "old", "--force"]).succeeds();
    assert!(place.read("old").starts_with(b"format = 'fric-robot/1'"));
}

#[test]
fn without_a_reference_the_wrench_is_advised() {
    let place = platform();
    place.write("log.mcap", without(platform_log(), &["/reference_forces"]));
    let run = refused(&place, &["log.mcap"]).fails(1, &["no reference forces on /reference_forces"]);
    let run = run.advises(&["`reference` under `[log]`", "--reference wrench"]);
    assert_eq!(run.stderr.lines().count(), 2, "{run:#?}");
    // A topic of another kind: what is wrong with it is said before.
    place.write("other.toml", platform_robot() + "\n[log]\nreference = '/platform_pose'\n");
    let run = refused(&place, &["log.mcap", "--model", "other.toml"]);
    let run = run.fails(1, &["no reference forces on /platform_pose"]);
    assert!(run.stderr.starts_with("warning: reference signal `/platform_pose`"), "{run:#?}");
}

#[test]
fn what_the_wrench_needs_is_told() {
    let by_wrench = |place: &Place, rest: &[&str]| refused(place, &[&["--reference", "wrench"], rest].concat());
    let place = bench();
    let run = by_wrench(&place, &["log.mcap", "--model", "robot.toml"]);
    let run = run.fails(1, &["robot.toml", "`base_m` and `platform_m` of winch"]);
    run.advises(&["--reference forces"]);

    let place = platform();
    let part = platform_robot().replacen("base_m = [0.55, 0.4, 0.5]\nplatform_m = [0.06, 0.05, -0.05]\n", "", 1);
    let part = part.replacen("{ wrap = \"pose\", radius_m = 0.01, axis = [0.0, 0.0, 1.0] }", "{ wrap_deg = 90.0 }", 1);
    place.write("part.toml", part);
    let run = by_wrench(&place, &["log.mcap", "--model", "part.toml"]);
    run.fails(1, &["part.toml has no `base_m` and `platform_m` of cable1, which"]);

    place.write("light.toml", platform_robot().replace("mass_kg = 0.41", ""));
    place.write("log.mcap", without(platform_log(), &["/platform_wrench"]));
    let run = by_wrench(&place, &["log.mcap", "--model", "light.toml"]);
    let run = run.fails(1, &["no wrench on /platform_wrench", "no mass"]);
    run.advises(&["`wrench` under `[log]`", "`mass_kg` under `[platform]`"]);

    place.write("log.mcap", without(platform_log(), &["/platform_pose"]));
    for reference in ["wrench", "forces"] {
        let run = refused(&place, &["log.mcap", "--reference", reference]).fails(1, &["no pose on /platform_pose"]);
        run.advises(&["`pose` under `[log]`"]);
    }

    place.write("log.mcap", platform_log());
    place.write("rope.toml", platform_robot().replace("\"cable3\"", "\"rope3\""));
    let run = by_wrench(&place, &["log.mcap", "--model", "rope.toml"]);
    run.fails(1, &["no signal of rope3", "wrench is that of all"]).advises(&["names"]);
}

#[test]
fn a_cable_that_the_log_does_not_know_keeps_its_values() {
    let place = platform();
    place.write("rope.toml", platform_robot().replace("\"cable3\"", "\"rope3\""));
    let run = place.run(&["fit", "log.mcap", "--model", "rope.toml", "-o", "fitted.toml"]);
    let run = run.warns(&["no signal of rope3: its values are kept"]);
    assert_eq!(run.stderr.lines().count(), 1, "{run:#?}");
}

#[test]
fn a_log_without_motion_is_told() {
    let place = Place::with_log();
    let run = refused(&place, &["log.mcap"]).fails(1, &["no sample can be used", "move too little"]);
    run.advises(&["longer strokes"]);
}

#[test]
fn a_log_cut_in_half_is_used_as_far_as_it_goes() {
    let place = bench();
    place.write("half.mcap", &bench_log()[..bench_log().len() / 2]);
    let run = place.run(&["fit", "half.mcap", "--model", "robot.toml", "-o", "fitted.toml", "--json", "fit.json"]);
    run.warns(&["`half.mcap` is cut off"]);
    let samples = place.json("fit.json")["cables"][0]["samples"].as_u64().unwrap();
    assert!((1000..6000).contains(&samples), "{samples}");
}

#[test]
fn another_rate_than_the_robot_files_is_warned_of() {
    let place = bench();
    place.write("slow.toml", bench_robot().replace("cycle_s = 0.001", "cycle_s = 0.004"));
    let run = place.run(&["fit", "log.mcap", "--model", "slow.toml", "-o", "fitted.toml"]);
    run.warns(&["every 0.001000 s", "`cycle_s`", "0.004"]);
}
