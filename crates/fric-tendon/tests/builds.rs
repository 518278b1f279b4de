//! What only a build can show: no panic in the cycle, no `std`, no allocator, the same bits however it is built.

#[path = "../../fric-core/tests/programs.rs"]
mod programs;

use programs::{builds_only_without, printed_in_every_build};

#[test]
fn no_input_can_make_the_model_panic() {
    builds_only_without("deliberate-panic", "detected panic in function `solve`", "no_panic", &["--release"]);
}

#[test]
fn the_model_needs_neither_std_nor_an_allocator() {
    builds_only_without("deliberate-alloc", "global memory allocator", "no_std", &[]);
}

#[test]
fn the_bits_are_the_same_however_the_model_is_built() {
    let printed = printed_in_every_build("same_bits");
    assert!(printed.starts_with("manipulator: ") && printed.lines().count() == 1, "{printed}");
}
