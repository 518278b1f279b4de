//! The rate of a topic's messages, and the detection of gaps.

/// A gap is longer than this many usual intervals.
const GAP_RATIO: i64 = 10;
/// Number of intervals considered.
const WINDOW: usize = 32;
/// The usual interval is updated after this many messages.
const STRIDE: usize = 8;

/// The recent intervals and their usual value.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pace {
    recent_nanos: [i64; WINDOW],
    count: usize,
    longest_usual_nanos: i64,
    median_nanos: i64,
}

impl Pace {
    /// Adds an interval. Returns whether the usual interval was updated.
    pub fn add(&mut self, interval_nanos: i64) -> bool {
        if let Some(place) = self.recent_nanos.get_mut(self.count % WINDOW) {
            *place = interval_nanos;
        }
        self.count += 1;
        let is_due = self.count.is_multiple_of(STRIDE) || !self.is_settled();
        if is_due {
            self.measure();
        }
        is_due
    }

    /// Whether enough intervals have been seen to detect a gap.
    pub const fn is_settled(&self) -> bool {
        self.count >= STRIDE
    }

    /// Whether an interval is longer than ten usual ones.
    ///
    /// The usual ones are the last 32 without the longest eighth (at least one, if there is another). So neither a bad start nor single pauses count,
    /// while messages in bursts have the pause between bursts as their usual interval.
    pub const fn is_gap(&self, interval_nanos: i64) -> bool {
        interval_nanos > self.longest_usual_nanos.saturating_mul(GAP_RATIO)
    }

    /// Returns the number of gaps among the intervals before the pace was settled.
    pub fn early_gap_count(&self) -> u64 {
        let early = self.recent_nanos.iter().take(self.count.min(STRIDE));
        early.map(|interval| u64::from(self.is_gap(*interval))).sum()
    }

    /// Returns the median of the last 32 intervals.
    pub const fn median_nanos(&self) -> i64 {
        self.median_nanos
    }

    fn measure(&mut self) {
        let mut sorted = self.recent_nanos;
        let count = self.count.min(WINDOW);
        let Some(sorted) = sorted.get_mut(..count) else { return };
        sorted.sort_unstable();
        let left_out = (count / 8).max(usize::from(count > 1));
        let at = |index: usize| sorted.get(index).copied().unwrap_or(0);
        self.longest_usual_nanos = at(count.saturating_sub(1 + left_out));
        self.median_nanos = at(count.saturating_sub(1) / 2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pace(intervals: impl IntoIterator<Item = i64>) -> Pace {
        let mut pace = Pace::default();
        for interval in intervals {
            pace.add(interval);
        }
        pace
    }

    #[test]
    fn a_bad_first_interval_does_not_count() {
        let settled = |first| pace(std::iter::once(first).chain([100; 7]));
        assert!(settled(30_000).is_gap(30_000) && settled(30_000).is_settled());
        assert!(!settled(1).is_gap(1000) && settled(1).is_gap(1001));
        assert_eq!(settled(30_000).early_gap_count(), 1);
        assert!(!pace([5]).is_gap(5));
    }

    #[test]
    fn pauses_between_bursts_are_usual() {
        let bursts = pace((0..64).map(|index| if index % 6 == 0 { 10_000 } else { 1 }));
        assert!(!bursts.is_gap(10_000));
        assert_eq!(bursts.median_nanos(), 1);
    }

    #[test]
    fn a_new_rate_becomes_usual() {
        let slower = pace([1; 100].into_iter().chain([100; 12]));
        assert!(!slower.is_gap(100));
    }
}
