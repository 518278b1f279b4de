//! A progress bar on a terminal: what is being done, how much of it is done, and how long the rest takes. Nothing elsewhere.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::terminal;

/// How many steps of a loop pass between two looks at the bar and at Ctrl-C.
pub const STRIDE: u64 = 1024;

/// A bar for reading so many bytes.
pub fn bytes(total: u64) -> ProgressBar {
    bar(total, "reading", "{bytes} of {total_bytes}, {eta} left")
}

/// A bar for computing so many cycles.
pub fn cycles(total: u64) -> ProgressBar {
    bar(total, "computing", "{human_pos} of {human_len} cycles, {eta} left")
}

/// A bar of steps, whose number is not known yet: `doing` is the work, `steps` what is counted.
pub fn steps(doing: &'static str, steps: &str) -> ProgressBar {
    bar(0, doing, &format!("{{pos}} of {{len}} {steps}, {{elapsed}} so far"))
}

/// Takes a bar off the terminal; with `--verbose` says how long the work took.
pub fn finish(bar: &ProgressBar) {
    let elapsed_s = bar.elapsed().as_secs_f64();
    bar.finish_and_clear();
    terminal::note(format_args!("{} took {elapsed_s:.1} s", bar.message()));
}

/// At most 80 columns wide.
fn bar(total: u64, doing: &'static str, numbers: &str) -> ProgressBar {
    let target = if terminal::is_quiet() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(total), target).with_message(doing);
    // A style that cannot be read leaves the default one.
    if let Ok(style) = ProgressStyle::with_template(&format!("{{spinner}} {{msg}} {{bar:24}} {numbers}")) {
        bar.set_style(style);
    }
    bar
}
