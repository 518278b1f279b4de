//! Signals that stand still: the device behind them hangs.

use std::ops::Range;

/// Maximum number of runs of bit-identical values in a log that are as long by chance, if values repeat independently. Half and twice as many change the
/// least number of samples by one at most.
const BY_CHANCE: f64 = 1e-3;
/// Number of samples on either side that tell how often a value repeats: more than are needed to tell one in ten from one in a hundred.
const SAMPLES_BESIDE: usize = 50;
/// The least probability of a repeat that so many samples give: that of none among the pairs of those beside one.
#[expect(clippy::cast_precision_loss, reason = "a small constant")]
const LEAST_PROBABILITY: f64 = 1.0 / (SAMPLES_BESIDE as f64 + 1.0);

/// Whether so long a run of identical values is not by chance, given how often the values repeat on the side of it where they do so more often. The longest
/// run on a side does not count, which may be another of the kind; nor do missing values, NaN.
pub fn stands_still(values: &[f64], run: &Range<usize>) -> bool {
    #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
    let (samples, repeats) = (values.len() as f64, run.len() as f64 - 1.0);
    let is_improbable = |probability: f64| samples * probability.powf(repeats) < BY_CHANCE;
    // Most runs are too short whatever the samples beside them.
    if !is_improbable(LEAST_PROBABILITY) {
        return false;
    }
    let before = values.get(..run.start).unwrap_or_default().iter().rev();
    let after = values.get(run.end..).unwrap_or_default().iter();
    is_improbable(repeat_probability(before).max(repeat_probability(after)))
}

/// Returns the probability that a value repeats, from the next ones without their longest run.
fn repeat_probability<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let nearest: Vec<f64> = values.copied().filter(|value| value.is_finite()).take(SAMPLES_BESIDE).collect();
    let lengths: Vec<usize> = runs(&nearest).map(|run| run.len()).collect();
    let longest = lengths.iter().max().copied().unwrap_or(0);
    let repeats = nearest.len() - lengths.len() - longest.saturating_sub(1);
    #[expect(clippy::cast_precision_loss, reason = "small counts")]
    let (repeats, pairs) = (repeats as f64, (nearest.len() - longest) as f64);
    // The mean of a probability of which nothing else is known.
    (repeats + 1.0) / (pairs + 2.0)
}

/// Returns the runs of bit-identical values.
pub fn runs(values: &[f64]) -> impl Iterator<Item = Range<usize>> {
    values.chunk_by(|one, next| one.to_bits() == next.to_bits()).scan(0, |start, run| {
        *start += run.len();
        Some(*start - run.len()..*start)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::test_signals::shown_n;

    /// A sensor that hangs stands still before it is missing, and often more than once.
    #[test]
    fn a_sensor_stands_still_beside_gaps_and_other_stretches() {
        let mut force_n = shown_n(1e-5, |_| 1);
        for start in [500, 550, 2000] {
            let shown_n = force_n[start];
            force_n[start..start + 20].fill(shown_n);
        }
        force_n[2020..2080].fill(f64::NAN);
        let still = runs(&force_n).filter(|run| force_n[run.start].is_finite() && stands_still(&force_n, run));
        assert_eq!(still.collect::<Vec<_>>(), [500..520, 550..570, 2000..2020]);
        // Digits as coarse as the noise repeat a value in a third of the cases.
        let coarse_n = shown_n(0.02, |_| 1);
        assert!(!runs(&coarse_n).any(|run| run.len() < 8 && stands_still(&coarse_n, &run)));
    }
}
