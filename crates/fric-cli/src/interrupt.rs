//! Ctrl-C: loops check a flag and stop, so that unfinished outputs are removed.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::{Failure, Outcome};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Installs the handler; a second Ctrl-C ends the process at once.
pub fn listen() {
    // Without a handler Ctrl-C ends the process as usual; a temporary file may then remain.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
    });
}

/// Returns an error once Ctrl-C has been pressed.
pub fn check() -> Outcome {
    if INTERRUPTED.load(Ordering::Relaxed) {
        return Err(Failure::new("interrupted before the end: nothing was written"));
    }
    Ok(())
}
