//! What only a build can show: no panic in the cycle, no `std`, no allocator, the same bits however it is built.
//!
//! Each builds a small package beside this file; where it looks for something that must not be, once more with a deliberate
//! fault, so that the check itself is checked. The compiler output is kept in the target folder, so only the first run is slow.

use std::path::Path;
use std::process::{Command, Output};

/// Builds the package `tests/<name>`.
fn build(name: &str, arguments: &[&str]) -> Output {
    cargo("build", name, arguments).output().unwrap()
}

/// A command of cargo on the package `tests/<name>`.
fn cargo(subcommand: &str, name: &str, arguments: &[&str]) -> Command {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name);
    let mut command = Command::new(env!("CARGO"));
    command.current_dir(&package).args([subcommand, "--locked"]).args(arguments);
    // What the outer cargo hands on must not change the inner build.
    for variable in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_TARGET", "RUSTC_WRAPPER", "CARGO_INCREMENTAL"]
    {
        command.env_remove(variable);
    }
    command.env("CARGO_TARGET_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join(name));
    command
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn no_input_can_make_the_cycle_panic() {
    let output = build("no_panic", &["--release"]);
    assert!(output.status.success(), "the cycle can panic, or the check does not build:\n{}", message(&output));
    let output = build("no_panic", &["--release", "--features", "deliberate-panic"]);
    let found = message(&output);
    assert!(
        !output.status.success() && found.contains("detected panic in function `step`"),
        "no panic found:\n{found}"
    );
}

#[test]
fn the_core_needs_neither_std_nor_an_allocator() {
    let output = build("no_std", &[]);
    assert!(output.status.success(), "something needs std or alloc:\n{}", message(&output));
    let output = build("no_std", &["--features", "deliberate-alloc"]);
    let found = message(&output);
    assert!(!output.status.success() && found.contains("global memory allocator"), "no allocator missed:\n{found}");
}

#[test]
fn the_bits_are_the_same_however_the_core_is_built() {
    // Each build in a folder of its own, or each would undo the other's.
    let ways = [("debug", "", ""), ("release", "--release", ""), ("native", "--release", "-C target-cpu=native")];
    let printed = ways.map(|(way, profile, flags)| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("same_bits").join(way);
        let arguments: &[&str] = if profile.is_empty() { &["--quiet"] } else { &["--quiet", profile] };
        let output = cargo("run", "same_bits", arguments)
            .env("CARGO_TARGET_DIR", folder)
            .env("RUSTFLAGS", flags)
            .output()
            .unwrap();
        assert!(output.status.success(), "{way}:\n{}", message(&output));
        String::from_utf8(output.stdout).unwrap()
    });
    let [debug, release, native] = &printed;
    assert_eq!(debug, release, "without and with optimisation");
    assert_eq!(release, native, "for any processor and for this one");
    let every_flag = format!("flags: {:#x}", (1 << fric_core::CableStatus::NAMES.len()) - 1);
    assert!(
        debug.lines().count() > 20 && debug.ends_with(&format!("{every_flag}\n")),
        "not everything was tried:\n{debug}"
    );
}
