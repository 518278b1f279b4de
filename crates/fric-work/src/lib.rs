//! What the command line and the Python module share: the work on logs from their samples to the result, results as JSON, verdicts and pages, and the
//! files around them.
//!
//! - [`replay`], [`fit`], [`discover`] and [`hysteresis`] each `run` the computation of `fric-lab` on a log, with its warnings in their order; [`runs`]
//!   are the logs of a fit or a discovery.
//! - A log is a [`source`] of samples: files, or arrays in memory. A [`supervisor`] shows progress and warnings, and ends work early.
//! - [`json`] is a result for machines; [`provenance`] records its origin.
//! - [`verdict`] is the first sentence about a result and what to do next; [`report`] contains the pages, each one file without network access.
//! - [`replay::ReplayResult`] is the result of a replay, [`fit_report`] a fit in the style of lmfit. The texts of the other results are in `fric-lab`.
//! - [`set_points`] writes the run of [`excite`]; [`questions`] reads those that a designed run answers; [`recording_name`] checks the name of an
//!   output.
//!
//! # Example
//!
//! ```
//! use fric_work::provenance::Provenance;
//!
//! #[derive(serde::Serialize)]
//! struct Result {
//!     rms_n: f64,
//! }
//!
//! # fn main() -> std::result::Result<(), serde_json::Error> {
//! let origin = Provenance::of_call("fric.replay", &[], None);
//! let text = fric_work::json(&Result { rms_n: 0.25 }, &origin)?;
//! assert!(text.contains("\"rms_n\": 0.25") && text.contains("\"provenance\""));
//! # Ok(())
//! # }
//! ```
//!
//! This crate decodes no log and computes no friction, and it depends on neither a terminal nor Python.

#![allow(clippy::doc_markdown, reason = "symbols of equations are no code items")]

pub mod discover;
pub mod excite;
pub mod fit;
pub mod fit_report;
pub mod hysteresis;
pub mod provenance;
pub mod questions;
pub mod recording_name;
pub mod replay;
pub mod report;
pub mod runs;
pub mod set_points;
pub mod source;
pub mod supervisor;
pub mod verdict;

use serde::Serialize;

use provenance::Provenance;

/// Returns a result for machines as text with a final newline; `provenance` follows the result's own fields.
///
/// # Errors
/// Returns the error of serde_json, for instance for a map whose keys are not text; no result of this workspace causes one.
pub fn json(result: &impl Serialize, provenance: &Provenance) -> Result<String, serde_json::Error> {
    #[derive(Serialize)]
    struct WithProvenance<'a, T> {
        #[serde(flatten)]
        result: &'a T,
        provenance: &'a Provenance,
    }
    let text = serde_json::to_string_pretty(&WithProvenance { result, provenance })?;
    Ok(without_c1(&text) + "\n")
}

/// Escapes the control characters that JSON leaves in its strings, which some terminals obey.
fn without_c1(text: &str) -> String {
    let is_order = |character: char| ('\u{7f}'..='\u{9f}').contains(&character);
    if !text.contains(is_order) {
        return text.to_owned();
    }
    let escaped = |character: char| {
        if is_order(character) { format!("\\u{:04x}", u32::from(character)) } else { character.to_string() }
    };
    text.chars().map(escaped).collect()
}
