//! What a user gets of a result: text for people, JSON for machines, a page in HTML.
//!
//! The command line and the Python module compute with `fric-lab` on samples that `fric-log` reads, and show what comes out by
//! what is here, so that both show the same: [`json`] is the text of a result for machines, [`provenance`] says what it was made of, [`report`] are the pages, each one
//! file without network access, [`fit_report`] is a fit as
//! users of lmfit read it, [`replay`] the result of a replay, [`set_points`] the file of a run and [`questions`] what a designed run is to tell. The texts of
//! the other results stand beside them in `fric-lab`.
//!
//! Nothing here reads a log or computes friction, and nothing knows a terminal or Python.

#![allow(clippy::doc_markdown, reason = "symbols of equations are no code items")]

pub mod excite;
pub mod fit_report;
pub mod provenance;
pub mod questions;
pub mod replay;
pub mod report;
pub mod set_points;
pub mod verdict;

use serde::Serialize;

use provenance::Provenance;

/// A result for machines, as text with an end of line; `provenance` stands behind its own fields.
///
/// # Errors
/// What serde_json refuses, such as a map whose keys are no text; no result of this workspace is such.
pub fn json(result: &impl Serialize, provenance: &Provenance) -> Result<String, serde_json::Error> {
    #[derive(Serialize)]
    struct WithProvenance<'a, T> {
        #[serde(flatten)]
        result: &'a T,
        provenance: &'a Provenance,
    }
    serde_json::to_string_pretty(&WithProvenance { result, provenance }).map(|text| text + "\n")
}
