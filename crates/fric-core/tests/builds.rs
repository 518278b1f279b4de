//! What only a build can show: no panic in the cycle, no `std`, no allocator, the same bits however it is built.

use crate::programs::{builds_only_without, printed_in_every_build};

#[test]
fn no_input_can_make_the_cycle_panic() {
    builds_only_without("deliberate-panic", "detected panic in function `step`", "no_panic", &["--release"]);
}

#[test]
fn the_core_needs_neither_std_nor_an_allocator() {
    builds_only_without("deliberate-alloc", "global memory allocator", "no_std", &[]);
}

#[test]
fn the_bits_are_the_same_however_the_core_is_built() {
    let printed = printed_in_every_build("same_bits");
    let every_flag = format!("flags: {:#x}", (1 << fric_core::CableStatus::NAMES.len()) - 1);
    assert!(
        printed.lines().count() > 20 && printed.ends_with(&format!("{every_flag}\n")),
        "not everything was tried:\n{printed}"
    );
}
