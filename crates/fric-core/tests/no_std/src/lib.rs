//! The cycle without `std` and without `alloc`.
//!
//! A static library is complete in itself: were `std` anywhere in it, the panic handler below would be the second; were
//! `alloc`, an allocator would be missing.
#![no_std]

#[cfg(feature = "deliberate-alloc")]
extern crate alloc;

use fric_core::{Compensator, CycleInput, CycleOutput};

/// One cycle, so that there is something in the library.
pub fn cycle(compensator: &mut Compensator<8>, input: &CycleInput<8>) -> CycleOutput<8> {
    compensator.step(input)
}

#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
