//! Accumulated deviation between two signals.

/// Root mean square and mean of the magnitude of a series of deviations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    count: u64,
    squares: f64,
    magnitudes: f64,
}

impl Deviation {
    /// Adds a deviation; non-finite ones are ignored.
    pub fn add(&mut self, deviation: f64) {
        if deviation.is_finite() {
            self.count += 1;
            self.squares += deviation * deviation;
            self.magnitudes += deviation.abs();
        }
    }

    /// Returns the number of deviations.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Returns the root mean square; `None` if there are no deviations.
    #[must_use]
    pub fn rms(&self) -> Option<f64> {
        self.mean(self.squares).map(f64::sqrt)
    }

    /// Returns the mean of the magnitude; `None` if there are no deviations.
    #[must_use]
    pub fn mean_magnitude(&self) -> Option<f64> {
        self.mean(self.magnitudes)
    }

    fn mean(&self, sum: f64) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = self.count as f64;
        (self.count > 0).then(|| sum / count)
    }
}
