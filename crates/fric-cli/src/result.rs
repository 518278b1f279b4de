//! What `replay` and `fit` give to machines, `format = "fric-replay/1"` and `"fric-fit/1"`.

use fric_lab::replay::Deviation;
use serde::ser::SerializeMap as _;
use serde::{Serialize, Serializer};

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
pub struct ForceError {
    pub rms_n: f64,
    pub mae_n: f64,
}

#[derive(Debug, Serialize)]
pub struct WrenchResult {
    pub before: WrenchError,
    pub after: WrenchError,
}

#[derive(Debug, Serialize)]
pub struct WrenchError {
    pub force_rms_n: f64,
    pub torque_rms_nm: f64,
}

#[derive(Debug, Serialize)]
pub struct CycleResult {
    pub count: u64,
    pub median_ns: u64,
    pub p999_ns: u64,
    pub max_ns: u64,
}

/// Root mean square and mean of the magnitude; `None` without any deviation.
pub fn force_error(deviation: &Deviation) -> Option<ForceError> {
    Some(ForceError { rms_n: deviation.rms()?, mae_n: deviation.mean_magnitude()? })
}

/// All of an identification.
#[derive(Debug, Serialize)]
pub struct FitResult {
    pub format: &'static str,
    pub robot: String,
    /// `forces`, `wrench`, or `mass` where the wrench is that of the platform's mass.
    pub reference: &'static str,
    pub cables: Vec<FitCableResult>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrench: Option<WrenchResult>,
}

impl FitResult {
    /// Name and version of the form.
    pub const FORMAT: &str = "fric-fit/1";
}

#[derive(Debug, Serialize)]
pub struct FitCableResult {
    pub name: String,
    pub samples: usize,
    pub left_out: LeftOut,
    pub termination: &'static str,
    pub evaluations: usize,
    pub parameters: Numbers,
    pub standard_errors: Numbers,
    pub undetermined: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<ForceError>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<ForceError>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_reference_n: Option<f64>,
}

/// Samples that were not learned from.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LeftOut {
    pub flagged: usize,
    pub without_reference: usize,
    pub warm_up: usize,
    pub outliers: usize,
}

/// Numbers by name, in order.
#[derive(Debug)]
pub struct Numbers(pub Vec<(String, f64)>);

impl Numbers {
    /// The number of a name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(of, _)| of == name).map(|(_, value)| *value)
    }
}

impl Serialize for Numbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}
