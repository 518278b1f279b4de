//! Ctrl-C: loops look here and stop, so that outputs in the making are taken away.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::{Failure, Outcome};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Starts listening; a second Ctrl-C ends the process at once.
pub fn listen() {
    // Without a handler Ctrl-C ends the process as ever; a temporary file may then stay.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
    });
}

/// An error once Ctrl-C has been pressed.
pub fn check() -> Outcome {
    if INTERRUPTED.load(Ordering::Relaxed) {
        return Err(Failure::new("interrupted before the end: nothing was written"));
    }
    Ok(())
}
