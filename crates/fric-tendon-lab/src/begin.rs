//! The holes' memory at the beginning of a run that begins under tension.
//!
//! What the holes hold then comes from before the run. The gratings show it. Without them, markers decide between the memories that a single release
//! leaves: from the tendon pulled from slack to the one released so far that all holes have turned round. With neither, the middle of what the holes
//! can hold is taken, which is no friction.

use fric_tendon::{AnyStaticModel, Friction, ManipulatorError, ManipulatorParams, ShapeStatus, Tendon};
use serde::Serialize;

use super::gratings::GratingSample;
use super::run::{Run, RunSample};
use super::shape_errors::ComputedShape;

/// Number of samples whose markers decide, and number of tensions that are tried in each round of the search.
const MARKER_SAMPLES: usize = 5;
const TRIALS: u32 = 12;
const ROUNDS: u32 = 4;
/// Greatest ratio of the tension before the release to that at the beginning: with 2 rad of bend and μ = 0.18 all holes have turned round at 2.
const MOST_RATIO: f64 = 4.0;

/// The signal that shows the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BeginSource {
    /// The tensions of the gratings.
    Gratings,
    /// The markers.
    Markers,
    /// None: the middle of what the holes can hold.
    Middle,
}

/// The beginning of a run under tension.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Begin {
    /// Tension at the base, N.
    pub tension_base_n: f64,
    /// The signal that shows what the holes hold.
    pub source: BeginSource,
    /// Tension in each segment from it, N.
    pub tension_n: Vec<f64>,
    /// Number of samples until every hole has slid and has forgotten the beginning; their status is `MEMORY_UNCERTAIN`.
    pub uncertain_samples: usize,
}

impl Begin {
    /// Returns the beginning of a run; `None` if it begins with a slack tendon, as the history takes it anyway.
    ///
    /// # Errors
    /// Checked parameters cause no error; the signature is that of the model's constructor.
    pub fn of(
        params: &ManipulatorParams,
        run: &Run,
        measured: Option<&[GratingSample]>,
    ) -> Result<Option<Self>, ManipulatorError> {
        let Some(tension_base_n) = run.begin_tension_n() else { return Ok(None) };
        let live = |first: &&GratingSample| first.is_bridged.iter().any(|is_bridged| !is_bridged);
        let gratings = measured.and_then(<[_]>::first).filter(live);
        let (source, tension_n) = if let Some(first) = gratings {
            (BeginSource::Gratings, first.tension.iter().map(|tension| tension.value_n.max(0.0)).collect())
        } else if let Some(tension_n) = from_markers(params, run.samples(), tension_base_n)? {
            (BeginSource::Markers, tension_n)
        } else {
            (BeginSource::Middle, vec![tension_base_n; params.disk_count()])
        };
        Ok(Some(Self { tension_base_n, source, tension_n, uncertain_samples: 0 }))
    }

    /// Returns a model whose history begins here.
    ///
    /// # Errors
    /// Checked parameters cause no error; the signature is that of the model's constructor.
    pub fn model(&self, params: &ManipulatorParams) -> Result<AnyStaticModel, ManipulatorError> {
        let mut model = AnyStaticModel::new(params)?;
        if !model.begin_history([self.tension_base_n, 0.0], [&self.tension_n, &[]]).has_shape() {
            model.reset();
        }
        Ok(model)
    }

    /// Counts the samples whose memory is uncertain.
    pub fn count(&mut self, shapes: &[ComputedShape]) {
        let is_uncertain = |shape: &&ComputedShape| shape.status.contains(ShapeStatus::MEMORY_UNCERTAIN);
        self.uncertain_samples = shapes.iter().filter(is_uncertain).count();
    }

    /// Returns a warning in one sentence.
    #[must_use]
    pub fn warning(&self, sample_count: usize) -> String {
        let source = match self.source {
            BeginSource::Gratings => "the gratings show it",
            BeginSource::Markers => "the markers show which release before fits best",
            BeginSource::Middle => {
                "with neither gratings nor markers the middle of what they can hold is taken, which is no friction"
            }
        };
        format!(
            "the run begins at {:.2} N at the base, so that what the holes hold is left from before: {source}; by `history` it \
             is uncertain in {} of {sample_count} samples, until each hole has slid (`MEMORY_UNCERTAIN`). Begin runs with a \
             slack tendon",
            self.tension_base_n, self.uncertain_samples
        )
    }
}

/// Returns the tensions in the segments after the release, from slack and a tension above that at the beginning, with which the first shapes are
/// nearest to their markers; `None` without markers.
fn from_markers(
    params: &ManipulatorParams,
    samples: &[RunSample],
    tension_base_n: f64,
) -> Result<Option<Vec<f64>>, ManipulatorError> {
    let first = samples.get(..MARKER_SAMPLES).unwrap_or(samples);
    if !first.iter().flat_map(|sample| sample.marker_m.as_flattened()).any(|coordinate_m| coordinate_m.is_finite()) {
        return Ok(None);
    }
    let mut model = AnyStaticModel::new(params)?;
    let mut tried = |peak_n: f64| {
        model.reset();
        if !model.solve([peak_n, 0.0], Friction::History).has_shape() {
            return None;
        }
        let (mut squares, mut begin_n) = (0.0, None);
        for sample in first {
            if !model.solve([sample.tension_base_n, 0.0], Friction::History).has_shape() {
                return None;
            }
            begin_n.get_or_insert_with(|| model.tension_n(Tendon::Agonist).to_vec());
            let pairs = model.disk_position_m().as_flattened().iter().zip(sample.marker_m.as_flattened());
            squares +=
                pairs.map(|(at_m, marker_m)| (at_m - marker_m).powi(2)).filter(|one| one.is_finite()).sum::<f64>();
        }
        Some((squares, begin_n?))
    };
    let (mut from_n, mut to_n) =
        (tension_base_n, (MOST_RATIO * tension_base_n).min(params.capacity_n(Tendon::Agonist)));
    let mut best: Option<(f64, f64, Vec<f64>)> = None;
    for _ in 0..ROUNDS {
        let part_n = (to_n - from_n) / f64::from(TRIALS);
        for trial in 0..=TRIALS {
            let peak_n = from_n + part_n * f64::from(trial);
            if let Some((squares, begin_n)) = tried(peak_n)
                && best.as_ref().is_none_or(|(least, ..)| squares < *least)
            {
                best = Some((squares, peak_n, begin_n));
            }
        }
        let Some((_, peak_n, _)) = &best else { break };
        (from_n, to_n) = ((peak_n - part_n).max(tension_base_n), (peak_n + part_n).min(to_n));
    }
    Ok(best.map(|(.., begin_n)| begin_n))
}
