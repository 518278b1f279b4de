//! Errors over time, thinned out to what a screen can show; memory does not grow with the log.

use fric_core::{CableOutput, Sample};

/// Intervals are merged in pairs when there would be more.
const MOST_INTERVALS: usize = 1600;

/// Least and greatest of what was added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent {
    pub least: f64,
    pub greatest: f64,
}

impl Extent {
    pub(crate) const NOTHING: Self = Self { least: f64::INFINITY, greatest: f64::NEG_INFINITY };

    pub(crate) fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.least = self.least.min(value);
            self.greatest = self.greatest.max(value);
        }
    }

    pub(crate) fn merge(&mut self, other: Self) {
        self.add(other.least);
        self.add(other.greatest);
    }

    pub(crate) fn is_something(self) -> bool {
        self.least <= self.greatest
    }
}

/// What a cable did in one interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub before_n: Extent,
    pub after_n: Extent,
    pub is_flagged: bool,
}

const EMPTY: Interval = Interval { before_n: Extent::NOTHING, after_n: Extent::NOTHING, is_flagged: false };

/// Deviations of all cables, interval by interval.
#[derive(Debug)]
pub struct Series {
    cable_count: usize,
    /// Intervals one after the other, all cables of one together.
    intervals: Vec<Interval>,
    /// Time of each interval's first sample since the start, s.
    starts_s: Vec<f64>,
    samples_per_interval: u64,
    samples_in_last: u64,
    first_nanos: Option<i64>,
    end_s: f64,
}

impl Series {
    /// Before the first cycle of so many cables.
    #[must_use]
    pub fn new(cable_count: usize) -> Self {
        Self {
            cable_count,
            intervals: Vec::new(),
            starts_s: Vec::new(),
            samples_per_interval: 1,
            samples_in_last: 0,
            first_nanos: None,
            end_s: 0.0,
        }
    }

    /// Takes in one cycle.
    pub fn add(&mut self, sample: &Sample<'_>, cables: &[CableOutput]) {
        let first_nanos = *self.first_nanos.get_or_insert(sample.stamp_nanos);
        #[expect(clippy::cast_precision_loss, reason = "to be drawn")]
        let time_s = sample.stamp_nanos.saturating_sub(first_nanos) as f64 * 1e-9;
        self.end_s = self.end_s.max(time_s);
        if self.starts_s.is_empty() || self.samples_in_last == self.samples_per_interval {
            if self.starts_s.len() == MOST_INTERVALS {
                self.merge_pairs();
            }
            self.starts_s.push(time_s);
            self.intervals.resize(self.intervals.len() + self.cable_count, EMPTY);
            self.samples_in_last = 0;
        }
        self.samples_in_last += 1;
        let last = self.intervals.len().saturating_sub(self.cable_count);
        let places = self.intervals.iter_mut().skip(last);
        for ((place, output), reference_n) in places.zip(cables).zip(sample.reference_force_n) {
            place.before_n.add(output.frictionless_n - reference_n);
            place.after_n.add(output.force_at_platform_n - reference_n);
            place.is_flagged |= !output.status.is_ok();
        }
    }

    fn merge_pairs(&mut self) {
        let count = self.cable_count;
        let mut merged = Vec::with_capacity(self.intervals.len());
        for pair in self.intervals.chunks(2 * count) {
            let (first, second) = pair.split_at(count.min(pair.len()));
            let second = second.iter().copied().chain(std::iter::repeat(EMPTY));
            merged.extend(first.iter().zip(second).map(|(first, second)| {
                let mut both = *first;
                both.before_n.merge(second.before_n);
                both.after_n.merge(second.after_n);
                both.is_flagged |= second.is_flagged;
                both
            }));
        }
        self.intervals = merged;
        self.starts_s = self.starts_s.iter().copied().step_by(2).collect();
        self.samples_per_interval *= 2;
        self.samples_in_last = self.samples_per_interval;
    }

    /// Starts of the intervals, s, and what a cable did in them.
    pub(crate) fn of_cable(&self, cable: usize) -> impl Iterator<Item = (f64, Interval)> {
        let intervals = self.intervals.iter().skip(cable).step_by(self.cable_count.max(1));
        self.starts_s.iter().copied().zip(intervals.copied())
    }

    /// Time of the last sample since the start, s.
    pub(crate) fn end_s(&self) -> f64 {
        self.end_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(clippy::float_cmp, reason = "whole numbers")]
    fn thinning_keeps_every_extreme() {
        let mut series = Series::new(2);
        for index in 0..10_000_i32 {
            let output = CableOutput { force_at_platform_n: f64::from(index), ..CableOutput::default() };
            let sample = Sample {
                stamp_nanos: i64::from(index) * 1_000_000,
                cables: &[],
                reference_force_n: &[0.0, f64::NAN],
                pose: None,
                outside_wrench: None,
            };
            series.add(&sample, &[output, output]);
        }
        let first: Vec<_> = series.of_cable(0).collect();
        assert!(first.len() <= MOST_INTERVALS);
        assert!(first.windows(2).all(|pair| pair[0].1.after_n.greatest + 1.0 == pair[1].1.after_n.least));
        assert_eq!(first.last().map(|(_, interval)| interval.after_n.greatest), Some(9999.0));
        assert!(series.of_cable(1).all(|(_, interval)| !interval.after_n.is_something()));
    }
}
