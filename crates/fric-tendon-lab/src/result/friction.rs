//! The friction at every hole over a run, as in figures 7, 11 and 14 of \[C\].

use std::fmt::Write as _;

use fric_lab::text::{table, wrapped};
use serde::Serialize;

use super::{intervals_s, intervals_text};
use crate::friction::{FrictionDistribution, MeasuredFriction, distributions};
use crate::gratings::GratingSample;
use crate::guard::{Guard, Guarded};
use crate::run::Run;

/// `fric-continuum-friction/1`. Friction is positive if the base side is tighter, and null if it is unknown.
#[derive(Clone, Debug, Serialize)]
pub struct FrictionResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// Name of the manipulator.
    pub manipulator: String,
    /// Number of samples.
    pub samples: usize,
    /// One entry per hole, starting at the base plate.
    pub holes: Vec<HoleSummary>,
    /// Number of samples in which both directions occur with certainty.
    pub directions_differ_samples: usize,
    /// Time intervals of these samples, s.
    pub directions_differ_s: Vec<[f64; 2]>,
    /// Gratings that were dead in some samples.
    pub bridged: Vec<BridgedGrating>,
    /// What the guards of the gratings have found.
    pub guards: Vec<Guard>,
    /// The values, sample by sample.
    pub series: FrictionSeries,
}

/// A hole over the whole run.
#[derive(Clone, Debug, Serialize)]
pub struct HoleSummary {
    /// Its number, from 1 in the base plate.
    pub hole: usize,
    /// Mean friction, N.
    pub mean_n: f64,
    /// Least friction, N.
    pub least_n: f64,
    /// Greatest friction, N.
    pub greatest_n: f64,
    /// Mean standard error of one sample, N.
    pub standard_error_n: f64,
    /// Fraction of the samples with positive friction beyond two standard errors.
    pub positive_ratio: f64,
    /// Fraction of the samples with negative friction beyond two standard errors.
    pub negative_ratio: f64,
}

/// A dead grating, whose tension was interpolated.
#[derive(Clone, Debug, Serialize)]
pub struct BridgedGrating {
    /// Its number, from 1 at the base.
    pub grating: usize,
    /// Number of samples.
    pub samples: usize,
    /// Time intervals, s.
    pub intervals_s: Vec<[f64; 2]>,
}

/// Lists with one entry per sample; inner lists have one entry per hole.
#[derive(Clone, Debug, Serialize)]
pub struct FrictionSeries {
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Friction, N.
    pub friction_n: Vec<Vec<f64>>,
    /// Its standard error, N.
    pub standard_error_n: Vec<Vec<f64>>,
    /// Whether both directions occur with certainty.
    pub directions_differ: Vec<bool>,
}

impl BridgedGrating {
    /// Returns the dead gratings of a run.
    #[must_use]
    pub fn all(run: &Run, measured: &[GratingSample]) -> Vec<Self> {
        let time_s: Vec<f64> = run.samples().iter().map(|sample| sample.time_s).collect();
        (0..run.disk_count())
            .filter_map(|place| {
                let is_dead = |sample: &GratingSample| sample.is_bridged.get(place).copied().unwrap_or(false);
                let samples = measured.iter().filter(|sample| is_dead(sample)).count();
                let intervals_s = intervals_s(&time_s, measured.iter().map(is_dead));
                (samples > 0).then_some(Self { grating: place + 1, samples, intervals_s })
            })
            .collect()
    }

    /// Returns a warning in one sentence.
    #[must_use]
    pub fn warning(&self, sample_count: usize) -> String {
        let when = if self.samples == sample_count {
            "the whole run".to_owned()
        } else {
            format!("{} of {sample_count} samples ({})", self.samples, intervals_text(&self.intervals_s))
        };
        format!(
            "grating {} is dead in {when}: its tension is put on the line between its neighbours; check fibre and demodulator",
            self.grating
        )
    }
}

/// Returns the warnings about the gratings of a run, one sentence each.
pub(super) fn grating_warnings(bridged: &[BridgedGrating], guards: &[Guard], sample_count: usize) -> Vec<String> {
    bridged.iter().map(|one| one.warning(sample_count)).chain(guards.iter().map(Guard::warning)).collect()
}

impl FrictionResult {
    /// Name and version of the format.
    pub const FORMAT: &str = "fric-continuum-friction/1";

    /// Computes the friction from the gratings. The tension at the base counts as exact.
    #[must_use]
    pub fn new(manipulator: &str, run: &Run, guarded: &Guarded) -> Self {
        let Guarded { measured, guards } = guarded;
        let distributions: Vec<FrictionDistribution> = distributions(run, measured).collect();
        let time_s: Vec<f64> = run.samples().iter().map(|sample| sample.time_s).collect();
        let differ: Vec<bool> = distributions.iter().map(|one| one.directions_differ).collect();
        let each = |of: fn(&MeasuredFriction) -> f64| -> Vec<Vec<f64>> {
            distributions.iter().map(|one| one.holes.iter().map(of).collect()).collect()
        };
        Self {
            format: Self::FORMAT,
            manipulator: manipulator.to_owned(),
            samples: time_s.len(),
            holes: (0..run.disk_count()).map(|hole| HoleSummary::new(hole, &distributions)).collect(),
            directions_differ_samples: differ.iter().filter(|differ| **differ).count(),
            directions_differ_s: intervals_s(&time_s, differ.iter().copied()),
            bridged: BridgedGrating::all(run, measured),
            guards: guards.clone(),
            series: FrictionSeries {
                friction_n: each(|hole| hole.friction_n),
                standard_error_n: each(|hole| hole.standard_error_n),
                directions_differ: differ,
                time_s,
            },
        }
    }

    /// Returns the warnings about the gratings, one sentence each.
    #[must_use]
    pub fn grating_warnings(&self) -> Vec<String> {
        grating_warnings(&self.bridged, &self.guards, self.samples)
    }

    /// Returns a summary for people.
    #[must_use]
    pub fn summary(&self) -> String {
        let number = |value: f64| if value.is_finite() { format!("{value:.4}") } else { "–".to_owned() };
        let rows: Vec<_> = self
            .holes
            .iter()
            .map(|hole| {
                [
                    hole.hole.to_string(),
                    number(hole.mean_n),
                    number(hole.least_n),
                    number(hole.greatest_n),
                    number(hole.standard_error_n),
                    format!("{:.0} %", 100.0 * hole.positive_ratio),
                    format!("{:.0} %", 100.0 * hole.negative_ratio),
                ]
            })
            .collect();
        let header = [
            "hole",
            "mean\n[N]",
            "least\n[N]",
            "greatest\n[N]",
            "standard\nerror [N]",
            "base side\ntighter",
            "tip side\ntighter",
        ];
        let mut text = format!(
            "{}: friction at the holes over {} samples\n\n{}\n\
             Friction is positive where the base side is tighter. The last columns are the\n\
             share of samples in which that is sure (beyond two standard errors).\n",
            self.manipulator,
            self.samples,
            table(&header, 0, &rows)
        );
        // Writing to a String cannot fail.
        let _ = match self.directions_differ_samples {
            0 => writeln!(text, "No sample has both directions beyond doubt."),
            count => {
                let intervals = intervals_text(&self.directions_differ_s);
                let told = format!("Directions differ along the tendon in {count} samples: {intervals}.");
                write!(text, "{}", wrapped("", &told))
            }
        };
        text
    }
}

impl HoleSummary {
    fn new(place: usize, distributions: &[FrictionDistribution]) -> Self {
        let known =
            distributions.iter().filter_map(|one| one.holes.get(place)).filter(|hole| hole.friction_n.is_finite());
        let holes: Vec<&MeasuredFriction> = known.collect();
        #[expect(clippy::cast_precision_loss, reason = "a number of samples")]
        let mean =
            |of: &dyn Fn(&MeasuredFriction) -> f64| holes.iter().map(|hole| of(hole)).sum::<f64>() / holes.len() as f64;
        let share = |direction: i8| {
            let ratio = mean(&|hole| f64::from(u8::from(hole.direction() == direction)));
            if holes.is_empty() { 0.0 } else { ratio }
        };
        // Without finite values, least and greatest are unknown.
        let end = |pick: fn(f64, f64) -> f64| holes.iter().map(|hole| hole.friction_n).fold(f64::NAN, pick);
        Self {
            hole: place + 1,
            mean_n: mean(&|hole| hole.friction_n),
            least_n: end(f64::min),
            greatest_n: end(f64::max),
            standard_error_n: mean(&|hole| hole.standard_error_n),
            positive_ratio: share(1),
            negative_ratio: share(-1),
        }
    }
}
