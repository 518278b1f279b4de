//! Outputs that must not or cannot be written: everything stays as it was.

use super::support::{Place, Run};

/// Options that name an output, of `replay`.
const OPTIONS: [&str; 3] = ["-o", "--json", "--report"];

#[test]
fn what_exists_is_replaced_only_with_force() {
    let place = Place::with_log();
    place.write("old", "kept");
    for option in OPTIONS {
        let run = place.run_in_vain(&["replay", "log.mcap", option, "old"]);
        run.fails(1, &["old exists already"]).advises(&["--force"]);
    }
    place.run_in_vain(&["info", "log.mcap", "--json", "old"]).fails(1, &["old exists"]).advises(&["--force"]);
    let simulate = ["simulate", "--model", "robot.toml", "--duration", "0.05", "-o", "old"];
    place.run_in_vain(&simulate).fails(1, &["old exists already"]).advises(&["--force"]);
    // Of several outputs one that exists is enough to write none.
    let several = ["replay", "log.mcap", "-o", "new.mcap", "--report", "new.html", "--json", "old"];
    place.run_in_vain(&several).fails(1, &["old exists already"]);

    for option in OPTIONS {
        place.write("old", "not kept");
        place.run(&["replay", "log.mcap", option, "old", "--force"]).succeeds();
        assert!(place.read("old").len() > 500, "{option}");
    }
    place.run(&[&simulate[..], &["--force"]].concat()).succeeds();
    assert_eq!(place.names(), ["log.mcap", "old", "robot.toml"]);
}

#[test]
fn inputs_are_never_overwritten() {
    let place = Place::with_log();
    // A log named as another kind of file is refused before.
    place.write("robot", place.read("robot.toml"));
    for option in OPTIONS {
        for force in [&[][..], &["--force"]] {
            let over = |output| place.run_in_vain(&[&["replay", "log.mcap", option, output], force].concat());
            over("log.mcap").fails(1, &["log.mcap is an input"]).advises(&["another output"]);
            over("./log.mcap").fails(1, &["./log.mcap is an input"]);
            let start = ["replay", "log.mcap", "--model", "robot", option, "robot"];
            place.run_in_vain(&[&start, force].concat()).fails(1, &["robot is an input"]);
        }
    }
    let simulate = ["simulate", "--model", "robot", "-o", "robot", "--force"];
    place.run_in_vain(&simulate).fails(1, &["robot is an input"]);
    for command in [&["replay", "log.mcap"][..], &["convert", "log.mcap"], &["simulate", "--model", "robot.toml"]] {
        place
            .run_in_vain(&[command, &["-o", "run.csv"]].concat())
            .fails(2, &["what is written is MCAP; name it `.mcap`"]);
    }
    let info = ["info", "log.mcap", "--json", "log.mcap", "--force"];
    place.run_in_vain(&info).fails(1, &["log.mcap is an input"]);
}

#[cfg(unix)]
#[test]
fn inputs_are_known_by_their_other_names() {
    let place = Place::with_log();
    std::fs::hard_link(place.path("log.mcap"), place.path("hard")).unwrap();
    std::os::unix::fs::symlink("log.mcap", place.path("soft")).unwrap();
    for option in OPTIONS {
        for (log, output) in [("log.mcap", "hard"), ("log.mcap", "soft"), ("soft", "log.mcap"), ("soft", "hard")] {
            let run = place.run_in_vain(&["replay", log, option, output, "--force"]);
            run.fails(1, &[&format!("{output} is an input")]);
        }
    }
    assert!(place.path("soft").is_symlink());
}

#[test]
fn places_that_cannot_be_written_are_told_before_the_work() {
    let place = Place::with_log();
    std::fs::create_dir(place.path("folder")).unwrap();
    for option in OPTIONS {
        let run = |output| place.run_in_vain(&["replay", "log.mcap", option, output, "--force"]);
        run("no/such/out").fails(1, &["cannot write no/such/out", "No such file"]).advises(&["no/such", "exists"]);
        run("log.mcap/out").fails(1, &["cannot write log.mcap/out", "Not a directory"]);
        run("folder").fails(1, &["cannot write folder", "directory"]).advises(&["file in it", "folder/result"]);
    }
    let simulate = ["simulate", "--model", "robot.toml", "-o", "no/out.mcap"];
    place.run_in_vain(&simulate).fails(1, &["cannot write no/out.mcap"]).advises(&["directory no exists"]);
}

#[cfg(unix)]
#[test]
fn a_link_that_leads_nowhere_is_not_replaced() {
    let place = Place::with_log();
    std::os::unix::fs::symlink("nowhere", place.path("link")).unwrap();
    for option in OPTIONS {
        for force in [&[][..], &["--force"]] {
            let run = place.run_in_vain(&[&["replay", "log.mcap", option, "link"], force].concat());
            run.fails(1, &["link is no regular file"]);
        }
    }
    assert!(place.path("link").is_symlink());
}

#[cfg(unix)]
#[test]
fn a_directory_that_may_not_be_written_is_told() {
    use std::fs::{Permissions, set_permissions, write};
    use std::os::unix::fs::PermissionsExt;

    let place = Place::with_log();
    std::fs::create_dir(place.path("locked")).unwrap();
    set_permissions(place.path("locked"), Permissions::from_mode(0o555)).unwrap();
    // The superuser may write everywhere: there is nothing to see then.
    if write(place.path("locked/probe"), "").is_ok() {
        return;
    }
    for option in OPTIONS {
        let run = place.run_in_vain(&["replay", "log.mcap", option, "locked/out"]);
        run.fails(1, &["cannot write locked/out", "denied"]).advises(&["locked", "writable"]);
    }
}

#[cfg(unix)]
#[test]
fn outputs_are_ordinary_files() {
    use std::os::unix::fs::PermissionsExt;

    let place = Place::with_log();
    place.run(&["replay", "log.mcap", "-o", "o.mcap", "--json", "j.json", "--report", "r.html"]).succeeds();
    let mode = |name| std::fs::metadata(place.path(name)).unwrap().permissions().mode();
    // The test wrote the log itself, under the same umask.
    for name in ["o.mcap", "j.json", "r.html"] {
        assert_eq!(mode(name), mode("log.mcap"), "{name}");
    }
}

/// Files are limited to 64 KiB, less than the log would have.
#[cfg(unix)]
#[test]
fn a_disk_that_fills_up_is_told_in_one_sentence_and_nothing_is_left() {
    let place = Place::with_log();
    let limited = "trap '' XFSZ; ulimit -f 128; exec \"$0\" \"$@\"";
    for arguments in [
        &["replay", "log.mcap", "-o", "out.mcap", "--report", "r.html", "--json", "j.json"][..],
        &["simulate", "--model", "robot.toml", "-o", "out.mcap", "--duration", "3"],
    ] {
        let mut shell = std::process::Command::new("sh");
        shell.current_dir(place.path("")).args(["-c", limited, super::support::PROGRAM]).args(arguments);
        let run = Run::new(shell.output().unwrap()).fails(1, &["cannot write out.mcap: File too large"]);
        run.advises(&["free", "another disk"]);
        assert_eq!(place.names(), ["log.mcap", "robot.toml"]);
    }
}

#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_never_replaced() {
    use std::os::unix::fs::{FileTypeExt, symlink};

    let place = Place::with_log();
    // Not among the files that are compared: reading it would wait for a writer.
    let elsewhere = tempfile::Builder::new().prefix("elsewhere").tempdir().unwrap();
    let pipe = elsewhere.path().join("pipe");
    nix::unistd::mkfifo(&pipe, nix::sys::stat::Mode::S_IRWXU).unwrap();
    place.write("far", "kept");
    symlink("far", place.path("link")).unwrap();
    symlink("/dev/null", place.path("null")).unwrap();
    let simulate = ["simulate", "--model", "robot.toml", "--duration", "0.05", "-o"];
    for output in [pipe.to_str().unwrap(), "link", "null", "/dev/null", "/dev/full"] {
        for option in OPTIONS {
            let run = place.run_in_vain(&["replay", "log.mcap", option, output, "--force"]);
            run.fails(1, &[output, "no regular file"]).advises(&["another output"]);
        }
        let run = place.run_in_vain(&["replay", "log.mcap", "-o", "/dev/stdout", "--force"]);
        run.fails(1, &["/dev/stdout"]).advises(&["`--json -`"]);
        place.run_in_vain(&[&simulate[..], &[output, "--force"]].concat()).fails(1, &["no regular file"]);
        place.run_in_vain(&["info", "log.mcap", "--json", output, "--force"]).fails(1, &["no regular file"]);
    }
    let kind = |name: &str| std::fs::symlink_metadata(place.path(name)).unwrap().file_type();
    assert!(
        std::fs::metadata(&pipe).unwrap().file_type().is_fifo()
            && kind("/dev/null").is_char_device()
            && kind("link").is_symlink()
    );
    assert_eq!(place.read("far"), b"kept");
}

#[test]
fn what_a_killed_run_left_is_gone_after_the_next() {
    let place = Place::with_log();
    for name in [".fric-new.json-Ab1.part", ".fric-other.json-Ab1.part", ".fric-new.json.bak"] {
        place.write(name, "half");
    }
    place.run(&["replay", "log.mcap", "--json", "new.json"]).succeeds();
    let names = [".fric-new.json.bak", ".fric-other.json-Ab1.part", "log.mcap", "new.json", "robot.toml"];
    assert_eq!(place.names(), names);
}
