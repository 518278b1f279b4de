//! The page of `replay --report`: errors over time, one file without network access.

use std::path::PathBuf;

use fric_core::{CableOutput, Sample};

use crate::commands::replay::ReplayResult;

/// Errors over time, thinned out to what a screen can show.
#[derive(Debug)]
pub struct Series;

impl Series {
    pub fn new(_cable_count: usize) -> Self {
        Self
    }
    pub fn add(&mut self, _sample: &Sample<'_>, _cables: &[CableOutput]) {}
}

/// The page.
pub fn page(_result: &ReplayResult, _series: &Series, _logs: &[PathBuf]) -> String {
    String::new()
}
