//! Every write, read, opening, renaming and allocation of a run fails once: nothing is half written, one sentence says why.
//!
//! `failing.c`, loaded into the program, counts the calls of a kind and makes the n-th fail. `make soak` lets n go through all of them.
#![cfg(all(target_os = "linux", target_env = "gnu", target_arch = "x86_64"))]

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::OnceLock;

use tempfile::TempDir;

use super::simulate::bench_robot;
use super::support::{Place, Run, root, short_log, slow_robot};

/// A command line, and the outputs it names.
struct Case {
    arguments: &'static [&'static str],
    outputs: &'static [&'static str],
}

const CASES: [Case; 15] = [
    Case {
        arguments: &["simulate", "--model", "robot.toml", "-o", "out", "--duration", "0.1", "--seed", "3"],
        outputs: &["out"],
    },
    Case {
        arguments: &["replay", "log.mcap", "-o", "out", "--report", "page", "--json", "json"],
        outputs: &["out", "page", "json"],
    },
    Case { arguments: &["fit", "bench.mcap", "-o", "out", "--json", "json"], outputs: &["out", "json"] },
    Case {
        arguments: &["discover", "bench.mcap", "-o", "out", "--report", "page", "--json", "json"],
        outputs: &["out", "page", "json"],
    },
    Case { arguments: &["info", "log.mcap", "--json", "-"], outputs: &[] },
    Case { arguments: &["convert", "log.mcap", "-o", "out"], outputs: &["out"] },
    Case { arguments: &["init", "table.csv", "-o", "out"], outputs: &["out"] },
    Case {
        arguments: &["replay", "table.csv", "--model", "bench.toml", "-o", "out", "--json", "json"],
        outputs: &["out", "json"],
    },
    Case {
        arguments: &[
            "excite",
            "--model",
            "slow.toml",
            "-o",
            "out",
            "--preview",
            "page",
            "--box=-0.1,-0.08,-0.1,0.12,0.08,0.1",
            "--max-speed-m-per-s",
            "0.5",
            "--max-acceleration-m-per-s2",
            "6",
            "--min-tension-n",
            "2",
            "--max-tension-n",
            "25",
        ],
        outputs: &["out", "page"],
    },
    Case {
        arguments: &["hysteresis", "crossing.mcap", "--report", "page", "--json", "json"],
        outputs: &["page", "json"],
    },
    Case {
        arguments: &["continuum", "calibrate", "loads.csv", "--model", "arm.toml", "-o", "out", "--json", "json"],
        outputs: &["out", "json"],
    },
    Case {
        arguments: &["continuum", "track", "path.csv", "--model", "arm.toml", "-o", "out", "--json", "json"],
        outputs: &["out", "json"],
    },
    Case {
        arguments: &["continuum", "shape", "run.csv", "--model", "cal.toml", "--report", "page", "--json", "json"],
        outputs: &["page", "json"],
    },
    Case {
        arguments: &["continuum", "fit", "run.csv", "--model", "cal.toml", "-o", "out", "--parameters", "mu"],
        outputs: &["out"],
    },
    Case {
        arguments: &["discover", "run.csv", "--model", "cal.toml", "-o", "out", "--report", "page"],
        outputs: &["out", "page"],
    },
];

/// The shim, compiled once.
fn shim() -> PathBuf {
    static SHIM: OnceLock<TempDir> = OnceLock::new();
    let directory = SHIM.get_or_init(|| {
        let directory = tempfile::tempdir().unwrap();
        let mut compiler = Command::new("cc");
        compiler.args(["-O1", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-o"]);
        compiler.arg(directory.path().join("failing.so")).arg(root().join("tests/cli/failing.c"));
        let output = compiler.output().expect("this test needs a C compiler called `cc`, such as Debian's gcc");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        directory
    });
    directory.path().join("failing.so")
}

/// All inputs of the commands, by name; the bench's log is long enough to identify it, at a cycle of 10 ms.
fn inputs() -> &'static [(&'static str, Vec<u8>)] {
    static INPUTS: OnceLock<Vec<(&'static str, Vec<u8>)>> = OnceLock::new();
    INPUTS.get_or_init(|| {
        let place = Place::with_log();
        place.write("bench.toml", bench_robot().replace("0.001", "0.01"));
        place.write("arm.toml", fs::read(root().join("examples/tendon-prototype.toml")).unwrap());
        let bench = ["simulate", "--model", "bench.toml", "-o", "bench.mcap", "--duration", "15", "--seed", "3"];
        place.run(&bench).succeeds();
        let arm = ["continuum", "simulate", "--model", "arm.toml", "-o", "run.csv", "--calibration", "loads.csv"];
        place.run(&arm).succeeds();
        place.run(&["continuum", "calibrate", "loads.csv", "--model", "arm.toml", "-o", "cal.toml"]).succeeds();
        place.write("slow.toml", slow_robot());
        place.run(&["simulate", "--model", "slow.toml", "-o", "crossing.mcap", "--run", "crossing"]).succeeds();
        let rows = (0..200).map(|row| format!("{},{},{}\n", f64::from(row) / 100.0, 5 + row % 7, f64::from(row) / 1e3));
        place.write("table.csv", "time_s,winch.force_n,winch.length_m\n".to_owned() + &rows.collect::<String>());
        place.write("path.csv", "time_s,bend_rad\n0,0.4\n0.5,0.9\n1,0.7\n");
        assert_eq!(place.read("log.mcap"), short_log());
        [
            "robot.toml",
            "log.mcap",
            "bench.toml",
            "bench.mcap",
            "table.csv",
            "crossing.mcap",
            "slow.toml",
            "arm.toml",
            "cal.toml",
            "run.csv",
            "loads.csv",
            "path.csv",
        ]
        .map(|name| (name, place.read(name)))
        .to_vec()
    })
}

/// What a run gave, without the times it took, which differ from run to run.
#[derive(PartialEq, Eq, Clone)]
struct Outcome {
    stdout: String,
    files: BTreeMap<String, Vec<u8>>,
}

/// A JSON result or a page without when and how it was made; whether that is there to its end counts.
fn without_origin(text: &str) -> String {
    if let Some((result, origin)) = text.split_once("\"provenance\": {") {
        return result.to_owned() + if origin.ends_with("}\n}\n") { "whole" } else { "" };
    }
    match text.split_once("<footer>").and_then(|(page, rest)| Some((page, rest.split_once("</footer>")?.1))) {
        Some((page, end)) => page.to_owned() + end,
        None => text.to_owned(),
    }
}

fn without_times(text: &str) -> String {
    let text = without_origin(text);
    let without_numbers: String = text.split_inclusive('\n').filter(|line| !line.contains("_ns\": ")).collect();
    let mut parts = without_numbers.split("one takes ");
    let begin = parts.next().unwrap_or_default().to_owned();
    // Where the text is cut off among the times, it ends before them.
    parts.fold(begin, |text, part| text + part.split_once("(longest)").map_or("", |(_, rest)| rest))
}

fn outcome(place: &Place, stdout: &[u8]) -> Outcome {
    let file = |name: String| {
        let bytes = place.read(&name);
        let has_times = ["json", "page"].contains(&name.as_str());
        let bytes = if has_times { without_times(str::from_utf8(&bytes).unwrap()).into_bytes() } else { bytes };
        (name, bytes)
    };
    let files = place.names().into_iter().map(file).collect();
    Outcome { stdout: without_times(str::from_utf8(stdout).unwrap()), files }
}

/// A place with the inputs and, to be replaced, old outputs.
fn place(case: &Case, with_old: bool) -> Place {
    let place = Place::empty();
    for (name, content) in inputs() {
        place.write(name, content);
    }
    for name in case.outputs.iter().filter(|_| with_old) {
        place.write(name, "old\n");
    }
    place
}

/// Runs the program with its n-th call of a kind failing; how many calls there were, and whether that one was among them.
fn run(case: &Case, place: &Place, kind: &str, n: u64) -> (Output, u64, bool) {
    let seen = tempfile::NamedTempFile::new().unwrap();
    let mut command = place.command(case.arguments);
    if !case.outputs.is_empty() {
        command.arg("--force");
    }
    command.env("LD_PRELOAD", shim()).env("FRIC_FAIL", kind).env("FRIC_FAIL_AT", n.to_string());
    let output = command.env("FRIC_FAIL_SEEN", seen.path()).env("RUST_BACKTRACE", "0").output().unwrap();
    let [calls, failed] = *fs::read(seen.path()).unwrap().as_chunks::<8>().0 else {
        panic!("the shim was not loaded: {output:?}")
    };
    (output, u64::from_le_bytes(calls), u64::from_le_bytes(failed) == 1)
}

/// The run is as if nothing had failed, or says in one sentence why it ended, and each output is the old one or the new one, whole.
fn check(case: &Case, label: &str, place: &Place, old: &Outcome, undisturbed: &Outcome, output: Output) {
    let found = outcome(place, &output.stdout);
    if output.status.success() {
        assert!(found == *undisturbed, "{label}: other outputs {:?}, {output:?}", place.names());
        return;
    }
    let stderr = String::from_utf8(output.stderr.clone()).unwrap();
    let was_aborted = output.status.signal() == Some(nix::sys::signal::Signal::SIGABRT as i32);
    let placed: Vec<&str> =
        case.outputs.iter().copied().filter(|name| found.files.get(*name) != old.files.get(*name)).collect();
    for name in &placed {
        assert!(found.files.get(*name) == undisturbed.files.get(*name), "{label}: {name} is half written");
    }
    for name in found.files.keys() {
        assert!(
            undisturbed.files.contains_key(name) || was_aborted && name.starts_with(".fric-"),
            "{label}: {name} is left"
        );
    }
    // The compressor's wrapper has no error for a context that gets no memory.
    if label.contains("memory") && stderr.contains("zstd returned null pointer when creating new context") {
        return;
    }
    if was_aborted {
        // Rust ends the process where it gets no memory, and so does the C library where it has to keep in mind what a thread ends with.
        const ENDS: [&str; 2] = ["memory allocation of ", "failed to register TLS destructor: out of memory"];
        assert!(label.contains("memory"), "{label}: {stderr}");
        assert!(ENDS.iter().any(|end| stderr.contains(end)) && !stderr.contains("panicked"), "{label}: {stderr}");
        return;
    }
    if stderr.contains("cannot print the result to ") {
        // A text may be cut off there; the files come first.
        assert_eq!((output.status.code(), placed), (Some(1), case.outputs.to_vec()), "{label}: {stderr}");
        assert!(undisturbed.stdout.starts_with(&found.stdout) && !stderr.contains("panicked"), "{label}: {stderr}");
        return;
    }
    Run::new(output).fails(1, &[]).advises(&[]);
    let sentence: Vec<_> = stderr.lines().filter(|line| !line.starts_with("warning: ")).collect();
    assert_eq!(sentence.len(), 2, "{label}: {stderr}");
    let told = format!("; written before: {}", placed.join(", "));
    assert!(placed.is_empty() || sentence[0].ends_with(&told), "{label}: {stderr}");
}

/// One kind of call in all commands, with and without old outputs, at the numbers picked from how many calls there are.
fn fail_each(kind: &str, pick: impl Fn(u64) -> Vec<u64>) {
    // Reading is over before the old outputs matter.
    let replaces = |case: &Case| !case.outputs.is_empty() && ["write", "short", "rename", "sync"].contains(&kind);
    for (case, with_old) in CASES.iter().flat_map(|case| [false, true].map(|with_old| (case, with_old))) {
        if with_old && !replaces(case) {
            continue;
        }
        let undisturbed = place(case, with_old);
        let old = outcome(&undisturbed, b"");
        let (output, calls, _) = run(case, &undisturbed, kind, 0);
        assert!(output.status.success(), "{output:?}");
        let undisturbed = outcome(&undisturbed, &output.stdout);
        assert!(calls > 0 || case.outputs.is_empty(), "{kind} is not seen");
        for n in pick(calls) {
            let label = format!("{} with {kind} {n} of {calls} failing", case.arguments.join(" "));
            let place = place(case, with_old);
            let (output, _, was_reached) = run(case, &place, kind, n);
            // Threads do not allocate in the same order every time.
            assert!(was_reached || kind == "memory", "{label}");
            check(case, &label, &place, &old, &undisturbed, output);
            let is_left = |place: &Place| place.names().iter().any(|name| name.starts_with(".fric-"));
            if is_left(&place) {
                let (again, _, _) = run(case, &place, kind, 0);
                assert!(again.status.success() && !is_left(&place), "{label}, then again: {again:?}");
                assert!(outcome(&place, &again.stdout) == undisturbed, "{label}, then again");
            }
        }
    }
}

/// The first calls, later ones ever farther apart, and the last one.
fn some(calls: u64) -> Vec<u64> {
    let later = std::iter::successors(Some(4_u64), |n| Some(n + n.div_ceil(2))).take_while(|n| *n < calls);
    (1..=calls.min(3)).chain(later).chain((calls > 3).then_some(calls)).collect()
}

fn every(calls: u64) -> Vec<u64> {
    (1..=calls).collect()
}

/// There are thousands of allocations: each of the first 50, then every tenth more, by which the later ones are farther apart.
fn each_tenth_more(calls: u64) -> Vec<u64> {
    let later = std::iter::successors(Some(55), |n| Some(n + n / 10)).take_while(|n| *n <= calls);
    (1..=50).chain(later).collect()
}

#[test]
fn a_write_that_fails_leaves_nothing_half() {
    fail_each("write", some);
    fail_each("short", some);
}

#[test]
#[ignore = "minutes; `make soak` runs it"]
fn every_write_that_fails_leaves_nothing_half() {
    fail_each("write", every);
    fail_each("short", every);
}

#[test]
fn an_output_that_cannot_be_put_in_its_place_is_told() {
    for kind in ["rename", "sync"] {
        fail_each(kind, every);
    }
}

#[test]
fn a_read_that_fails_is_told() {
    for kind in ["read", "open", "look"] {
        fail_each(kind, some);
    }
}

#[test]
#[ignore = "minutes; `make soak` runs it"]
fn every_read_that_fails_is_told() {
    for kind in ["read", "open", "look"] {
        fail_each(kind, every);
    }
}

#[test]
fn an_allocation_that_is_refused_leaves_nothing_half() {
    fail_each("memory", some);
}

#[test]
#[ignore = "minutes; `make soak` runs it"]
fn most_allocations_that_are_refused_leave_nothing_half() {
    fail_each("memory", each_tenth_more);
}
