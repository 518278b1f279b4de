//! Signals in coarse steps.

/// The maximum distance of a value from a multiple of a coarse converter's step, which allows for rounding.
const OFF_STEP: f64 = 1e-3;
/// Minimum fraction of the values that a coarse converter shows twice or more in a row. A step as great as the noise gives 0.28; it adds a twelfth to
/// the variance of the noise. Half and twice this fraction find the same in 199 logs, of which the eight with such a converter have 0.4 and more, all others 0.0001.
const LEAST_REPEATED: f64 = 0.25;
/// Maximum of the usual change from one value to another, in steps. More is a signal that is shown several times, with as many digits as it was
/// written; noise is then tens of the last digit. Half and twice as many find the same in those logs.
const MOST_STEPS: f64 = 2.0;
/// One in so many changes is smaller than the steps of a signal without coarse ones. Of noise they are a tenth of the median, of a wave a ninth.
const FEW_IN: usize = 20;

/// The steps of a coarse converter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoarseSteps {
    /// The step, in the unit of the signal.
    pub step: f64,
    /// Average number of samples that show the same value.
    pub samples_a_value: usize,
}

impl CoarseSteps {
    /// Returns the steps of a signal, NaN where it shows nothing; `None` if they are not coarse: the values are not multiples of one step apart, or
    /// change in nearly every sample, or usually by many steps.
    pub fn of(shown: &[f64]) -> Option<Self> {
        let finite: Vec<f64> = shown.iter().copied().filter(|value| value.is_finite()).collect();
        let (mut runs, mut repeated, mut changes) = (0.0, 0.0, Vec::new());
        let mut last = None;
        for run in finite.chunk_by(|one, next| one.to_bits() == next.to_bits()) {
            runs += 1.0;
            repeated += if run.len() > 1 { 1.0 } else { 0.0 };
            changes.extend(last.map(|last: f64| (run[0] - last).abs()));
            last = Some(run[0]);
        }
        if changes.is_empty() || repeated < LEAST_REPEATED * runs {
            return None;
        }
        let mut values = finite.clone();
        values.sort_by(f64::total_cmp);
        values.dedup();
        // Any two values are one step apart, such as those of two weights.
        if values.len() < 3 {
            return None;
        }
        let gaps = || values.windows(2).map(|pair| pair[1] - pair[0]);
        let step = gaps().fold(f64::INFINITY, f64::min);
        let middle = changes.len() / 2;
        let usual = *changes.select_nth_unstable_by(middle, f64::total_cmp).1;
        let is_multiple = |gap: f64| (gap / step - (gap / step).round()).abs() < OFF_STEP;
        (usual < (MOST_STEPS + 0.5) * step && gaps().all(is_multiple))
            .then(|| Self { step, samples_a_value: finite.len() / values.len() })
    }
}

/// Whether a signal usually changes by more than one step. Steps of a coarse sensor or encoder are all alike, and in a steady motion come regularly too.
pub fn changes_vary(shown: &[f64]) -> bool {
    let changes = shown.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut changes: Vec<f64> = changes.filter(|change| *change > 0.0 && change.is_finite()).collect();
    changes.sort_unstable_by(f64::total_cmp);
    let quantile = |of: usize| changes.get(changes.len() / of).copied().unwrap_or(0.0);
    quantile(2) > (MOST_STEPS + 0.5) * quantile(FEW_IN)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::test_signals::shown_n;

    #[test]
    fn steps_are_coarse_beside_the_noise() {
        let step = |shown_n: &[f64]| CoarseSteps::of(shown_n).map(|coarse| coarse.step);
        // Some 150 values, 27 samples each; 600 values, 7 samples each.
        for coarse_n in [0.04, 0.01] {
            assert!(step(&shown_n(coarse_n, |_| 1)).is_some_and(|found_n| (found_n / coarse_n - 1.0).abs() < 1e-6));
        }
        // Digits below the noise, also where every value is shown ten times.
        assert_eq!([1e-3, 1e-5].map(|written_n| step(&shown_n(written_n, |_| 1))), [None; 2]);
        assert_eq!(step(&shown_n(1e-5, |_| 10)), None);
        // A sensor that is frozen half of the time.
        let mut frozen_n = shown_n(1e-5, |_| 1);
        frozen_n[1000..3000].fill(10.0);
        assert_eq!(step(&frozen_n), None);
        // Two weights, one after the other.
        assert_eq!(step(&[[49.05; 100], [98.1; 100]].concat()), None);
    }
}
