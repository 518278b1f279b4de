//! What only a build can show: no panic in the cycle, no `std`, no allocator.
//!
//! Each builds a small package beside this file, once as it is and once with a deliberate fault, so that the check
//! itself is checked. The compiler output is kept in the target folder, so only the first run is slow.

use std::path::Path;
use std::process::{Command, Output};

/// Builds the package `tests/<name>`.
fn build(name: &str, arguments: &[&str]) -> Output {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name);
    let mut command = Command::new(env!("CARGO"));
    command.current_dir(&package).args(["build", "--locked"]).args(arguments);
    // What the outer cargo hands on must not change the inner build.
    for variable in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_TARGET", "RUSTC_WRAPPER", "CARGO_INCREMENTAL"]
    {
        command.env_remove(variable);
    }
    command.env("CARGO_TARGET_DIR", Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)).output().unwrap()
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
