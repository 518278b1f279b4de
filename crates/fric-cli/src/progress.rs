//! A progress bar on a terminal: what is being done, how much of it is done, and the remaining time. Nothing elsewhere.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::terminal;

/// Number of loop steps between two updates of the bar and checks of Ctrl-C.
pub const STRIDE: u64 = 1024;

/// Returns a bar for reading this many bytes.
pub fn bytes(total: u64) -> ProgressBar {
    bar(total, "reading", "{bytes} of {total_bytes}, {eta} left")
}

/// Returns a bar for computing this many cycles.
pub fn cycles(total: u64) -> ProgressBar {
    bar(total, "computing", "{human_pos} of {human_len} cycles, {eta} left")
}

/// Returns a bar for an initially unknown number of steps; `doing` names the work, `steps` what is counted.
pub fn steps(doing: &'static str, steps: &str) -> ProgressBar {
    bar(0, doing, &format!("{{pos}} of {{len}} {steps}, {{elapsed}} so far"))
}

/// Removes a bar from the terminal; with `--verbose` reports the duration of the work.
pub fn finish(bar: &ProgressBar) {
    let elapsed_s = bar.elapsed().as_secs_f64();
    bar.finish_and_clear();
    terminal::note(format_args!("{} took {elapsed_s:.1} s", bar.message()));
}

/// Returns a bar of at most 80 columns.
fn bar(total: u64, doing: &'static str, numbers: &str) -> ProgressBar {
    let target = if terminal::is_quiet() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(total), target).with_message(doing);
    // An invalid style leaves the default one.
    if let Ok(style) = ProgressStyle::with_template(&format!("{{spinner}} {{msg}} {{bar:24}} {numbers}")) {
        bar.set_style(style);
    }
    bar
}
