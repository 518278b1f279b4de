//! Presentation of results: text for people, JSON for machines, a page in HTML.
//!
//! The command line and the Python module compute with `fric-lab` on samples that `fric-log` reads, and present the results through this crate, so
//! that both show the same. [`json`] is the text of a result for machines, [`provenance`] records its origin, [`report`] contains the pages, each one
//! file without network access, [`fit_report`] is a fit in the style of lmfit, [`replay`] is the result of a replay, [`set_points`] is the file of a
//! run, [`recording_name`] checks that of a recording, and [`questions`] are those that a designed run is to answer. The texts of the other results are with them in `fric-lab`.
//!
//! This crate neither reads logs nor computes friction, and it depends on neither a terminal nor Python.

#![allow(clippy::doc_markdown, reason = "symbols of equations are no code items")]

pub mod excite;
pub mod fit_report;
pub mod provenance;
pub mod questions;
pub mod recording_name;
pub mod replay;
pub mod report;
pub mod set_points;
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
