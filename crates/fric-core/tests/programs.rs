//! Small packages beside the tests, built by cargo for what only a build can show.
//!
//! The compiler's output is kept in the target folder, so only the first run is slow. The tests of `fric-tendon` build theirs with it too,
//! into the same folders, so that each dependency is compiled once.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Builds the package `tests/<name>`, which must succeed; and again with a feature that puts in what must not be, which must not, and says
/// `complaint`.
pub fn builds_only_without(fault: &str, complaint: &str, name: &str, arguments: &[&str]) {
    let build = |arguments: &[&str]| cargo("build", name, arguments, &folder(name)).output().unwrap();
    let output = build(arguments);
    assert!(output.status.success(), "`{name}` does not build:\n{}", message(&output));
    let output = build(&[arguments, &["--features", fault]].concat());
    let found = message(&output);
    assert!(!output.status.success() && found.contains(complaint), "`{name}` with {fault} is not found out:\n{found}");
}

/// What the program `tests/<name>` prints: the same without optimisation, with it, and for this processor.
pub fn printed_in_every_build(name: &str) -> String {
    // Each build in a folder of its own, or each would undo the other's.
    let ways = [("debug", "", ""), ("release", "--release", ""), ("native", "--release", "-C target-cpu=native")];
    let [debug, release, native] = ways.map(|(way, profile, flags)| {
        let arguments: &[&str] = if profile.is_empty() { &["--quiet"] } else { &["--quiet", profile] };
        let output = cargo("run", name, arguments, &folder(name).join(way)).env("RUSTFLAGS", flags).output().unwrap();
        assert!(output.status.success(), "{way}:\n{}", message(&output));
        String::from_utf8(output.stdout).unwrap()
    });
    assert_eq!(debug, release, "without and with optimisation");
    assert_eq!(release, native, "for any processor and for this one");
    debug
}

/// A command of cargo on the package `tests/<name>`.
fn cargo(subcommand: &str, name: &str, arguments: &[&str], folder: &Path) -> Command {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name);
    let mut command = Command::new(env!("CARGO"));
    command.current_dir(&package).args([subcommand, "--locked"]).args(arguments);
    // What the outer cargo hands on must not change the inner build.
    for variable in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_TARGET", "RUSTC_WRAPPER", "CARGO_INCREMENTAL"]
    {
        command.env_remove(variable);
    }
    command.env("CARGO_TARGET_DIR", folder);
    command
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
