//! The model of a manipulator without `std` and without `alloc`.
//!
//! A static library is complete in itself: were `std` anywhere in it, the panic handler below would be the second; were
//! `alloc`, an allocator would be missing.
#![no_std]

#[cfg(feature = "deliberate-alloc")]
extern crate alloc;

use fric_tendon::{Friction, ShapeStatus, StaticModel};

/// One shape, so that there is something in the library.
pub fn solve(model: &mut StaticModel<8>, base_tension_n: [f64; 2]) -> ShapeStatus {
    model.solve(base_tension_n, Friction::History)
}

#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
