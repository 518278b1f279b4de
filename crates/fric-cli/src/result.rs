//! What `replay` gives to machines, `format = "fric-replay/1"`.

use fric_lab::errors::{ForceError, WrenchResult};
use serde::Serialize;

/// All of it.
#[derive(Debug, Serialize)]
pub struct ReplayResult {
    pub format: &'static str,
    pub robot: String,
    pub cables: Vec<CableResult>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrench: Option<WrenchResult>,
    pub cycle: CycleResult,
}

impl ReplayResult {
    /// Name and version of the form.
    pub const FORMAT: &str = "fric-replay/1";
}

#[derive(Debug, Serialize)]
pub struct CableResult {
    pub name: String,
    pub samples: u64,
    pub flagged: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<ForceError>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<ForceError>,
}

#[derive(Debug, Serialize)]
pub struct CycleResult {
    pub count: u64,
    pub median_ns: u64,
    pub p999_ns: u64,
    pub max_ns: u64,
}
