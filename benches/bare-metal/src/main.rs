//! Nothing but the cycle: the linker leaves out what it does not reach.
#![no_std]
#![no_main]

use fric_core::{Compensator, CycleInput, CycleOutput};

/// One cycle of up to eight cables, of up to eight pulleys, with any effect.
#[unsafe(no_mangle)]
pub extern "C" fn step(compensator: &mut Compensator<8>, input: &CycleInput<8>, output: &mut CycleOutput<8>) {
    compensator.step_into(input, output);
}

#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
