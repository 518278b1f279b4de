//! Bins of an operating condition.

use super::conditions::{Condition, Spacing};

/// Bins of a condition with equal numbers of samples.
pub struct Bins {
    /// Bin edges: one more than there are bins.
    pub edges: Vec<f64>,
}

impl Bins {
    /// Creates the bins over the samples that have both condition and residual. Returns `None` if the condition is constant.
    pub fn new(condition: &Condition<'_>, residual_n: &[f64]) -> Option<Self> {
        let mut sorted: Vec<f64> = condition
            .values()
            .zip(residual_n)
            .filter(|(value, residual_n)| value.is_finite() && residual_n.is_finite())
            .map(|(value, _)| value)
            .collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let (first, last) = (*sorted.first()?, sorted.len().checked_sub(1)?);
        let mut edges: Vec<f64> = match condition.bins {
            Spacing::Crowds(count) => (0..=count).filter_map(|bin| sorted.get(bin * last / count).copied()).collect(),
            #[expect(clippy::cast_precision_loss, reason = "small counts")]
            Spacing::Widths(count) => {
                let width = (sorted.get(last)? - first) / count as f64;
                (0..=count).map(|bin| first + bin as f64 * width).collect()
            }
        };
        edges.dedup_by(|one, other| one.to_bits() == other.to_bits());
        if let ([low, high], Spacing::Crowds(2 | 3)) = (edges.as_slice(), condition.bins) {
            // Two distinct values get a bin each.
            edges = vec![*low, f64::midpoint(*low, *high), *high];
        }
        (edges.len() > 2).then_some(Self { edges })
    }

    /// Returns the number of bins.
    pub fn count(&self) -> usize {
        self.edges.len() - 1
    }

    /// Returns the bin of a value.
    pub fn of(&self, value: f64) -> Option<usize> {
        let inside = value.is_finite() && value <= *self.edges.last()?;
        let place = self.edges.partition_point(|edge| *edge <= value);
        (inside && place > 0).then(|| (place - 1).min(self.count() - 1))
    }
}
