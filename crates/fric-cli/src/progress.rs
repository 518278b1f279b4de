//! A progress bar on a terminal, nothing elsewhere.

use indicatif::{ProgressBar, ProgressStyle};

/// How many steps of a loop pass between two looks at the bar and at Ctrl-C.
pub const STRIDE: u64 = 1024;

/// A bar up to a total of bytes.
pub fn bytes(total: u64) -> ProgressBar {
    bar(total, "{bar:40} {bytes}/{total_bytes} {eta}")
}

/// A bar up to a total of cycles.
pub fn cycles(total: u64) -> ProgressBar {
    bar(total, "{bar:40} {human_pos}/{human_len} cycles {eta}")
}

/// A bar of steps, whose number is not known yet, and what they are when `done`.
pub fn steps(done: &'static str) -> ProgressBar {
    bar(0, &format!("{{bar:40}} {{pos}}/{{len}} {done} {{elapsed}}"))
}

fn bar(total: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::new(total);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}
