//! Where a model and a log disagree, and the rest that no effect explains.

use serde::Serialize;

use super::finite;
use super::machine::{Machine, Robot, is_absent};
use crate::discover::report::Unexplained;
use crate::discover::rest::neighbours::Neighbour;
use crate::discover::rest::places::Place;
use crate::recording_fault::RecordingFault;

/// A range of a condition in which the disagreement is concentrated.
#[derive(Clone, Debug, Serialize)]
#[serde(bound = "")]
pub struct WhereResult<M: Machine = Robot> {
    /// The condition, or the kind of the signal that is wrong.
    pub signal: &'static str,
    /// Lower end of the range, in `unit`.
    pub from: M::Bound,
    /// Upper end of the range, in `unit`.
    pub to: M::Bound,
    /// Its unit.
    pub unit: &'static str,
    /// Fraction of the excess above the noise in this range.
    pub share_of_excess: Option<f64>,
    /// Fraction of the samples in this range.
    #[serde(skip_serializing_if = "is_absent")]
    pub share_of_samples: M::OfRobots<Option<f64>>,
    /// Fraction of the excess above the noise that is a function of this condition and of the direction of motion.
    #[serde(skip_serializing_if = "is_absent")]
    pub explains: M::OfRobots<Option<f64>>,
    /// Number of standard errors above chance.
    #[serde(skip_serializing_if = "is_absent")]
    pub significance: M::OfRobots<Option<f64>>,
    /// Time intervals to look at, s since the first sample.
    #[serde(skip_serializing_if = "is_absent")]
    pub intervals_s: M::OfRobots<Vec<[f64; 2]>>,
    /// Least and greatest value of the condition.
    #[serde(skip)]
    pub range: M::OfRobots<[f64; 2]>,
}

/// A rest that no effect explains.
#[derive(Clone, Debug, Serialize)]
#[serde(bound = "")]
pub struct UnexplainedResult<M: Machine = Robot> {
    /// Error above the noise, N.
    pub rms_n: Option<f64>,
    /// Distance from the markers above the noise, mm; absent if it is noise, or without markers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms_mm: Option<f64>,
    /// Conditions in which it is concentrated.
    #[serde(rename = "where")]
    pub places: Vec<WhereResult<M>>,
    /// Time intervals in which it is large, s since the first sample.
    #[serde(skip_serializing_if = "is_absent")]
    pub intervals_s: M::OfRobots<Vec<[f64; 2]>>,
    /// Signals that correlate with it: conditions that it is a function of, the most informative first, then signals of other cables, such as `cable2
    /// sensor_force`.
    pub goes_with: Vec<M::GoesWith>,
}

impl WhereResult {
    pub(super) fn of(place: &Place) -> Self {
        Self {
            signal: place.signal,
            from: place.from,
            to: place.to,
            unit: place.unit,
            share_of_excess: finite(place.share_of_excess),
            share_of_samples: finite(place.share_of_samples),
            explains: finite(place.explains),
            significance: finite(place.significance),
            intervals_s: place.intervals_s.clone(),
            range: place.range,
        }
    }

    /// Creates the entry of a spectral line from its mean square above the noise.
    pub(super) fn of_hum(fault: &RecordingFault, excess: f64) -> Option<Self> {
        let value = |key: &str| fault.parameters.iter().find(|(of, _)| *of == key).map(|(_, value)| *value);
        let (frequency_hz, amplitude_n) = (value("frequency_hz")?, value("amplitude_n")?);
        let share = finite((0.5 * amplitude_n.powi(2) / excess).clamp(0.0, 1.0));
        Some(Self {
            signal: "frequency",
            from: frequency_hz,
            to: frequency_hz,
            unit: "Hz",
            share_of_excess: share,
            share_of_samples: Some(1.0),
            explains: share,
            significance: None,
            intervals_s: Vec::new(),
            range: [f64::NAN; 2],
        })
    }
}

pub fn unexplained(rest: &Unexplained, names: &[&str]) -> UnexplainedResult {
    let of_cable = rest.places.iter().map(|place| place.signal.to_owned());
    let of_others = rest.neighbours.iter().map(|Neighbour { cable, signal, .. }| {
        let name = names.get(*cable).copied().unwrap_or_default();
        format!("{name} {signal}")
    });
    UnexplainedResult {
        rms_n: finite(rest.rms_n),
        rms_mm: None,
        places: rest.places.iter().map(WhereResult::of).collect(),
        intervals_s: rest.intervals_s.clone(),
        goes_with: of_cable.chain(of_others).collect(),
    }
}
