//! Noise on the tension at the base.
//!
//! The history of the holes goes with every change of that tension, so noise that exceeds the change from one sample to the next turns holes round
//! that did not turn. [`steadied`] replaces the tension by a piecewise linear estimate (`trend`), which needs the samples after as well and is
//! therefore for recordings only.

use serde::Serialize;

use super::run::Run;
use super::trend::{estimate, noise};

/// Least and greatest noise that is taken off, as a fraction of the run's greatest tension. Noise below the first moves no disk visibly; with half of
/// it the steps of a usual converter count as noise, with twice 1.7 mN of 1.7 N stay. Above the second, neighbouring samples differ too much to tell
/// noise from a staircase with one sample a step; with half of it more than 25 mN of 1.7 N stay, with twice such a staircase is smoothed.
const LEAST_RATIO: f64 = 0.0005;
const MOST_RATIO: f64 = 0.03;
/// Minimum number of samples.
const LEAST_SAMPLES: usize = 40;

/// The noise of a run's base tension.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BaseNoise {
    /// Standard deviation, N.
    pub noise_n: f64,
    /// Standard error of the estimate that takes its place, N.
    pub error_n: f64,
    /// Number of samples at which noise alone reverses the measured tension.
    pub false_turns: usize,
}

impl BaseNoise {
    /// Returns a warning in one sentence.
    #[must_use]
    pub fn warning(&self) -> String {
        format!(
            "the tension at the base has {:.1} mN of noise, which reverses it at {} samples: the history of the holes follows an estimate without \
             it; record a filtered tension, or more samples per second",
            1e3 * self.noise_n,
            self.false_turns
        )
    }
}

/// Returns the run with an estimate of its base tension, and the noise that is taken off; `None` if there is too little of it, or so much that it may
/// be no noise.
#[must_use]
pub fn steadied(run: &Run) -> (Run, Option<BaseNoise>) {
    let found = if run.has_tension() && run.samples().len() >= LEAST_SAMPLES { of(run) } else { None };
    match found {
        Some((tension_n, noise)) => (run.with_base_tension(&tension_n), Some(noise)),
        None => (run.clone(), None),
    }
}

fn of(run: &Run) -> Option<(Vec<f64>, BaseNoise)> {
    let times_s: Vec<f64> = run.samples().iter().map(|sample| sample.time_s).collect();
    let shown_n: Vec<f64> = run.samples().iter().map(|sample| sample.tension_base_n).collect();
    let greatest_n = shown_n.iter().copied().fold(0.0, f64::max);
    let noise_n = noise(&times_s, &shown_n)?;
    if !(LEAST_RATIO * greatest_n..=MOST_RATIO * greatest_n).contains(&noise_n) || noise_n <= 0.0 {
        return None;
    }
    let (found_n, error_n) = estimate(&times_s, &shown_n, noise_n);
    let tension_n: Vec<f64> = found_n.iter().map(|value_n| value_n.max(0.0)).collect();
    let changes = shown_n.windows(2).zip(tension_n.windows(2));
    let false_turns = changes.filter(|(shown, found)| (shown[1] - shown[0]) * (found[1] - found[0]) < 0.0).count();
    Some((tension_n, BaseNoise { noise_n, error_n, false_turns }))
}
