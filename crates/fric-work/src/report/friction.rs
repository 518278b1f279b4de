//! Friction of a cable over its speed and over its length, collected cycle by cycle. Memory does not grow with the log.
//!
//! Measured friction is the reference minus the frictionless force; the model's is the compensated force minus the frictionless one. Both are at the
//! platform, and negative where the platform feels less than the sensor.

use fric_core::{CableInput, CableOutput};

/// Number of bins over a condition, half of them below zero.
const BINS: usize = 64;
/// Initial width of a bin, in the condition's unit.
const FIRST_WIDTH: f64 = 1e-6;

/// Count, mean and scatter of numbers, from running sums.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Scatter {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Scatter {
    fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.count += 1.0;
            let before = value - self.mean;
            self.mean += before / self.count;
            self.squares += before * (value - self.mean);
        }
    }

    fn merge(&mut self, other: Self) {
        let count = self.count + other.count;
        if count > 0.0 {
            let apart = other.mean - self.mean;
            self.squares += other.squares + apart * apart * self.count * other.count / count;
            self.mean += apart * other.count / count;
            self.count = count;
        }
    }

    /// Returns the mean; NaN without a number.
    pub(crate) fn mean(&self) -> f64 {
        if self.count > 0.0 { self.mean } else { f64::NAN }
    }

    /// Returns the standard deviation; NaN without a number.
    pub(crate) fn deviation(&self) -> f64 {
        if self.count > 0.0 { (self.squares / self.count).sqrt() } else { f64::NAN }
    }
}

/// Friction in one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Friction {
    /// Measured friction, N.
    pub measured: Scatter,
    /// Friction of the model, N.
    pub model: Scatter,
    /// Measured friction minus that of the model, N.
    pub left: Scatter,
}

impl Friction {
    fn merge(&mut self, other: Self) {
        self.measured.merge(other.measured);
        self.model.merge(other.model);
        self.left.merge(other.left);
    }
}

/// Friction over a condition of initially unknown range: bins on both sides of zero, whose width doubles when the range is exceeded.
#[derive(Clone, Debug)]
pub(crate) struct Binned {
    width: f64,
    bins: Vec<Friction>,
}

impl Default for Binned {
    fn default() -> Self {
        Self { width: FIRST_WIDTH, bins: vec![Friction::default(); BINS] }
    }
}

impl Binned {
    fn add(&mut self, at: f64, measured_n: f64, model_n: f64) {
        if !at.is_finite() {
            return;
        }
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let half = (BINS / 2) as f64;
        while (at / self.width).abs() >= half {
            self.widen();
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to BINS")]
        let place = (at / self.width + half).floor() as usize;
        if let Some(bin) = self.bins.get_mut(place) {
            bin.measured.add(measured_n);
            bin.model.add(model_n);
            bin.left.add(measured_n - model_n);
        }
    }

    fn widen(&mut self) {
        let mut wide = vec![Friction::default(); BINS];
        for (place, bin) in self.bins.iter().enumerate() {
            // Two bins merge, and zero stays an edge.
            if let Some(both) = wide.get_mut(place.midpoint(BINS / 2)) {
                both.merge(*bin);
            }
        }
        self.bins = wide;
        self.width *= 2.0;
    }

    /// Returns the centres of the bins from the first to the last non-empty one, with their content.
    pub(crate) fn filled(&self) -> impl Iterator<Item = (f64, &Friction)> {
        let is_filled = |bin: &Friction| bin.model.count > 0.0;
        let first = self.bins.iter().position(is_filled).unwrap_or(0);
        let end = self.bins.iter().rposition(is_filled).map_or(0, |last| last + 1);
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let middle = |place: usize| (place as f64 + 0.5 - (BINS / 2) as f64) * self.width;
        self.bins.iter().enumerate().take(end).skip(first).map(move |(place, bin)| (middle(place), bin))
    }
}

/// Friction of one cable.
#[derive(Clone, Debug, Default)]
pub(crate) struct CableFriction {
    /// Friction over the speed, m/s, positive paying out.
    pub over_speed: Binned,
    /// Friction over the length since the first sample, m: reeling in, and paying out.
    pub over_length: [Binned; 2],
    first_length_m: Option<f64>,
    last: Option<(i64, f64)>,
    is_paying_out: Option<bool>,
}

impl CableFriction {
    /// Adds a cycle without a flag.
    pub(crate) fn add(&mut self, stamp_nanos: i64, input: &CableInput, output: &CableOutput, reference_n: f64) {
        let (measured_n, model_n) =
            (reference_n - output.frictionless_n, output.force_at_platform_n - output.frictionless_n);
        let CableInput { length_m, speed_m_per_s, .. } = *input;
        #[expect(clippy::cast_precision_loss, reason = "a time between two samples")]
        let derived = self.last.map_or(f64::NAN, |(last_nanos, last_m)| {
            (length_m - last_m) / (stamp_nanos.saturating_sub(last_nanos) as f64 * 1e-9)
        });
        let speed = if speed_m_per_s.is_finite() { speed_m_per_s } else { derived };
        self.over_speed.add(speed, measured_n, model_n);
        if !length_m.is_finite() {
            return;
        }
        let first_m = *self.first_length_m.get_or_insert(length_m);
        if let Some((_, last_m)) =
            self.last.replace((stamp_nanos, length_m)).filter(|(_, last_m)| (*last_m - length_m).abs() > 0.0)
        {
            self.is_paying_out = Some(length_m > last_m);
        }
        if let Some(is_paying_out) = self.is_paying_out {
            self.over_length[usize::from(is_paying_out)].add(length_m - first_m, measured_n, model_n);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with sums over the samples themselves.
    #[test]
    fn bins_that_grow_keep_mean_and_scatter() {
        let mut binned = Binned::default();
        let samples: Vec<(f64, f64)> = (0..5000)
            .map(|index| {
                let phase = f64::from(index) * 0.013;
                (0.001 * phase.sin() * phase, (3.0 * phase).cos())
            })
            .collect();
        for (at, value) in &samples {
            binned.add(*at, *value, 2.0 * value);
        }
        let filled: Vec<(f64, &Friction)> = binned.filled().collect();
        assert!(filled.len() > BINS / 4 && filled.len() <= BINS, "{}", filled.len());
        for (middle, bin) in filled {
            let inside: Vec<f64> = samples
                .iter()
                .filter(|(at, _)| ((at / binned.width).floor() - (middle / binned.width).floor()).abs() < 0.5)
                .map(|(_, value)| *value)
                .collect();
            let count = f64::from(u32::try_from(inside.len()).unwrap());
            assert!((bin.measured.count - count).abs() < 0.5);
            if count > 0.0 {
                let mean = inside.iter().sum::<f64>() / count;
                let variance = inside.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
                assert!((bin.measured.mean() - mean).abs() < 1e-12);
                assert!((bin.measured.deviation() - variance.sqrt()).abs() < 1e-9);
                assert!((bin.left.mean() + mean).abs() < 1e-12);
            }
        }
    }
}
