//! The result of a tendon's discovery: `fric-discover/1`, with the tendon in the place of a cable.

use fric_lab::discover::result::Evidence;
use fric_lab::errors::ForceError;
use fric_lab::fit::result::Numbers;
use serde::Serialize;

use super::goes_with::GoesWith;

/// `fric-discover/1` of a manipulator.
#[derive(Clone, Debug, Serialize)]
pub struct TendonDiscoverResult {
    /// Name and version of the form.
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
    /// Samples of the run.
    pub samples: usize,
    /// Standard deviation of the gratings' noise, N.
    pub noise_floor_n: f64,
    /// What one standard error of the gratings' lines is over the run, N.
    pub calibration_error_n: f64,
    /// Error of the given model, fitted, on samples held out.
    pub before: Option<ForceError>,
    /// Error of the extended one.
    pub after: Option<ForceError>,
    /// Share of the gap that the extended model has closed.
    pub gap_closed: Option<f64>,
    /// `complete`, `extended` or `unexplained`.
    pub verdict: &'static str,
    /// Segments in which the given model disagrees, what tells most first.
    #[serde(rename = "where")]
    pub places: Vec<TendonPlace>,
    /// Distances between disks and markers under the tensions that the gratings show; absent where too few markers tell their noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub markers: Option<TendonMarkers>,
    /// What was found, in the order in which it entered.
    pub effects: Vec<TendonEffect>,
    /// Candidates that helped and did not suffice, best first.
    pub tried: Vec<TendonTried>,
    /// Why the file keeps a μ that the run contradicts; absent where it keeps none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kept: Option<String>,
    /// Where what no effect accounts for lies.
    pub unexplained: Option<TendonRest>,
}

/// Disks against markers; the friction has no part in it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TendonMarkers {
    /// Noise of a distance, root mean square, mm: of markers and gratings.
    pub noise_mm: f64,
    /// What one standard error of the gratings' lines moves the disks by, root mean square, mm.
    pub calibration_error_mm: f64,
    /// With the given file.
    pub before: MarkerError,
    /// With the extended one.
    pub after: MarkerError,
}

/// Distances over all disks and samples.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MarkerError {
    /// Root mean square, mm.
    pub rms_mm: f64,
    /// Greatest, mm.
    pub max_mm: f64,
}

/// A candidate that helped and did not suffice.
#[derive(Clone, Debug, Serialize)]
pub struct TendonTried {
    /// Its name.
    pub kind: &'static str,
    /// Which: `grating` or `hole`, from 1 at the base.
    pub parameters: Numbers,
    /// What speaks for it.
    pub evidence: Evidence,
    /// Why it is not named.
    pub reason: String,
}

/// A segment, or a disk.
#[derive(Clone, Debug, Serialize)]
pub struct TendonPlace {
    /// `grating` or `marker`.
    pub signal: &'static str,
    /// Which, from 1 at the base.
    pub from: usize,
    /// The same.
    pub to: usize,
    /// `1`.
    pub unit: &'static str,
    /// Share of the squared residual that it holds.
    pub share_of_excess: f64,
}

/// An effect that was found.
#[derive(Clone, Debug, Serialize)]
pub struct TendonEffect {
    /// Its name.
    pub kind: &'static str,
    /// Its parameters by key; `grating` and `hole` count from 1 at the base.
    pub parameters: Numbers,
    /// Standard errors of those that were fitted, by key.
    pub standard_errors: Numbers,
    /// Share of the gap closed with it and all before it.
    pub gap_closed: Option<f64>,
    /// What speaks for it.
    pub evidence: Evidence,
    /// The best other candidate.
    pub runner_up: Option<TendonRunnerUp>,
    /// Effects that the run does not tell from it: any one of them may be there in its place.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub alike: Vec<&'static str>,
    /// Cause and remedy.
    #[serde(skip)]
    pub words: [&'static str; 2],
}

/// Another effect that might have been it.
#[derive(Clone, Debug, Serialize)]
pub struct TendonRunnerUp {
    /// Its name.
    pub kind: &'static str,
    /// Schwarz's criterion with it less without it.
    pub delta_bic: f64,
}

/// What no effect accounts for.
#[derive(Clone, Debug, Serialize)]
pub struct TendonRest {
    /// Error of the tensions above the noise, N.
    pub rms_n: f64,
    /// Distance of the disks from their markers above the noise, mm; absent where it is noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms_mm: Option<f64>,
    /// Segments and disks in which it lies: those of the signal that is not noise.
    #[serde(rename = "where")]
    pub places: Vec<TendonPlace>,
    /// What it goes with, where it does so with one thing for the most part.
    pub goes_with: Vec<GoesWith>,
}
