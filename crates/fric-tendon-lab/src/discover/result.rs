//! The result of a tendon's discovery: `fric-discover/1`, with the tendon in place of a cable.

use fric_lab::discover::result::Evidence;
use fric_lab::errors::ForceError;
use fric_lab::fit::result::Numbers;
use serde::Serialize;

use super::goes_with::GoesWith;

/// `fric-discover/1` of a manipulator.
#[derive(Clone, Debug, Serialize)]
pub struct TendonDiscoverResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// The run.
    pub log: Vec<String>,
    /// Name of the manipulator.
    pub robot: String,
    /// The tendon.
    pub cables: Vec<TendonResult>,
}

/// The tendon.
#[derive(Clone, Debug, Serialize)]
pub struct TendonResult {
    /// `tendon`.
    pub name: &'static str,
    /// Number of samples of the run.
    pub samples: usize,
    /// Standard deviation of the gratings' noise, N.
    pub noise_floor_n: f64,
    /// Root mean square error of the tensions for one standard error of the calibration lines, N.
    pub calibration_error_n: f64,
    /// Error of the given model, fitted, on held-out samples.
    pub before: Option<ForceError>,
    /// Error of the extended model on held-out samples.
    pub after: Option<ForceError>,
    /// Fraction of the gap that the extended model closes.
    pub gap_closed: Option<f64>,
    /// `complete`, `extended` or `unexplained`.
    pub verdict: &'static str,
    /// Segments in which the given model disagrees, the most informative first.
    #[serde(rename = "where")]
    pub places: Vec<TendonPlace>,
    /// Distances between disks and markers under the measured tensions; absent if too few markers allow a noise estimate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub markers: Option<TendonMarkers>,
    /// The findings, in the order in which they entered.
    pub effects: Vec<TendonEffect>,
    /// Candidates that helped but did not suffice, the best first.
    pub tried: Vec<TendonTried>,
    /// The reason why the file keeps a μ that the run contradicts; absent if it keeps none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kept: Option<String>,
    /// The rest that no effect explains.
    pub unexplained: Option<TendonRest>,
}

/// Distances between disks and markers, which do not depend on the friction.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TendonMarkers {
    /// Root mean square noise of a distance, mm, due to markers and gratings.
    pub noise_mm: f64,
    /// Root mean square displacement of the disks for one standard error of the calibration lines, mm.
    pub calibration_error_mm: f64,
    /// Distances with the given file.
    pub before: MarkerError,
    /// Distances with the extended file.
    pub after: MarkerError,
}

/// Distances over all disks and samples.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MarkerError {
    /// Root mean square, mm.
    pub rms_mm: f64,
    /// Greatest distance, mm.
    pub max_mm: f64,
}

/// A candidate that helped but did not suffice.
#[derive(Clone, Debug, Serialize)]
pub struct TendonTried {
    /// Its name.
    pub kind: &'static str,
    /// Its index: `grating` or `hole`, from 1 at the base.
    pub parameters: Numbers,
    /// Evidence for it.
    pub evidence: Evidence,
    /// The reason why it is not named.
    pub reason: String,
}

/// A segment, or a disk.
#[derive(Clone, Debug, Serialize)]
pub struct TendonPlace {
    /// `grating` or `marker`.
    pub signal: &'static str,
    /// Its number, from 1 at the base.
    pub from: usize,
    /// The same number.
    pub to: usize,
    /// Always `1`.
    pub unit: &'static str,
    /// Its fraction of the squared residual.
    pub share_of_excess: f64,
}

/// An effect that was found.
#[derive(Clone, Debug, Serialize)]
pub struct TendonEffect {
    /// Its name.
    pub kind: &'static str,
    /// Its parameters by key; `grating` and `hole` count from 1 at the base.
    pub parameters: Numbers,
    /// Standard errors of the fitted parameters, by key.
    pub standard_errors: Numbers,
    /// Fraction of the gap closed by this effect and all before it.
    pub gap_closed: Option<f64>,
    /// Evidence for it.
    pub evidence: Evidence,
    /// The best other candidate.
    pub runner_up: Option<TendonRunnerUp>,
    /// Effects that the run does not distinguish from it: any of them may be present instead.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub alike: Vec<&'static str>,
    /// Cause and remedy.
    #[serde(skip)]
    pub words: [&'static str; 2],
}

/// Another effect that may be present instead.
#[derive(Clone, Debug, Serialize)]
pub struct TendonRunnerUp {
    /// Its name.
    pub kind: &'static str,
    /// BIC with the effect minus BIC without it.
    pub delta_bic: f64,
}

/// A rest that no effect explains.
#[derive(Clone, Debug, Serialize)]
pub struct TendonRest {
    /// Error of the tensions above the noise, N.
    pub rms_n: f64,
    /// Distance of the disks from their markers above the noise, mm; absent if it is noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms_mm: Option<f64>,
    /// Segments and disks in which it is concentrated, for the signals that exceed the noise.
    #[serde(rename = "where")]
    pub places: Vec<TendonPlace>,
    /// The cause that explains most of it, if there is one.
    pub goes_with: Vec<GoesWith>,
}
