//! Verdicts: a result in a sentence, with what to do, at the beginning of every page.
//!
//! Numbers in the sentences equal those of the tables, including the rounding.

mod compensation;
mod discovery;
mod manipulator;

use std::fmt;

use fric_lab::text::wrapped;

pub use compensation::{left_in_words, of_fit, of_hysteresis};
pub use discovery::of_discovery;
pub use manipulator::{of_calibration, of_hole, of_hole_frictions, of_shapes, of_tendon, of_tendon_fit};

/// The tone of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// Nothing to do.
    Well,
    /// Something to look at.
    Mixed,
    /// Something became worse, or no verdict is possible.
    Bad,
}

/// A result in a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Its tone.
    pub tone: Tone,
    /// The sentence.
    pub sentence: String,
    /// What to do, in sentences.
    pub todo: Vec<String>,
}

impl Verdict {
    /// Returns what to do, for a terminal; empty if all is well.
    #[must_use]
    pub fn steps(&self) -> String {
        if self.tone == Tone::Well {
            return String::new();
        }
        std::iter::once("What to do:\n".to_owned())
            .chain(self.todo.iter().map(|sentence| wrapped("- ", sentence)))
            .collect()
    }
}

/// Formats a number of things, such as "1 cable" or "2 cables".
#[must_use]
pub fn counted<T: Copy + fmt::Display + From<u8> + PartialEq>(count: T, thing: &str) -> String {
    if count == T::from(1) { format!("{count} {thing}") } else { format!("{count} {thing}s") }
}
