//! One signal over time: sorts stamps and interpolates values between them.
//!
//! A track holds the samples that rows may still need. When its clock is set back, later samples are kept apart until the rows reach that time too: a
//! topic may notice the step earlier or later than the cable signal.

use std::collections::VecDeque;

use super::pace::Pace;
use super::{TrackCounts, WAITING_LIMIT};

/// This many consecutive messages that continue from an earlier time mean that the clock was set back; fewer are late messages.
pub const CLOCK_STEP_MESSAGES: usize = 8;

/// A stamp and the values measured then.
#[derive(Debug, Default)]
pub(super) struct Tracked {
    pub stamp_nanos: i64,
    /// Time of recording.
    pub log_time_nanos: u64,
    /// Number of the sample in the track.
    pub number: u64,
    pub values: Vec<f64>,
    /// The cables that no message of this time has named yet, as bits.
    pub missing_cables: u64,
    /// Whether more than a usual interval precedes it.
    after_gap: bool,
}

/// The samples of a signal that are still needed, in the order of time.
#[derive(Debug, Default)]
pub(super) struct Track {
    samples: VecDeque<Tracked>,
    /// Samples since the clock was set back, until the rows follow.
    ahead: VecDeque<Tracked>,
    is_stepped: bool,
    /// Samples with earlier stamps, until their cause is clear.
    suspects: VecDeque<Tracked>,
    /// Number of messages during which the cable signal's clock step makes this topic's likely.
    expecting: usize,
    spare: Vec<Vec<f64>>,
    last_nanos: Option<i64>,
    /// Rows up to this time are final for this track.
    reached_nanos: Option<i64>,
    pace: Pace,
    counts: TrackCounts,
    /// The cables that any message has named, as bits.
    named_cables: u64,
}

impl Track {
    pub fn counts(&self) -> &TrackCounts {
        &self.counts
    }

    pub fn count_undecodable(&mut self) {
        self.counts.undecodable_count += 1;
    }

    /// Returns the samples of the rows' present time base.
    pub fn samples(&self) -> &VecDeque<Tracked> {
        &self.samples
    }

    /// Adds a sample without the missing cables (as bits); `fill` writes its values into an empty vector.
    pub fn push(
        &mut self,
        stamp_nanos: i64,
        log_time_nanos: u64,
        missing_cables: u64,
        fill: impl FnOnce(&mut Vec<f64>),
    ) {
        let is_behind = self.last_nanos.is_some_and(|last| stamp_nanos <= last);
        let is_expecting = self.expecting > 0;
        self.expecting = self.expecting.saturating_sub(1);
        if is_behind {
            let suspected_nanos = self.suspects.back().map(|suspect| suspect.stamp_nanos);
            if [self.last_nanos, suspected_nanos].contains(&Some(stamp_nanos)) {
                self.complete(stamp_nanos, missing_cables, fill);
                return;
            }
            // If this sample does not continue from the suspects, they are no clock step.
            if suspected_nanos > Some(stamp_nanos) {
                self.drop_suspects(stamp_nanos);
            }
        }
        let mut values = self.spare.pop().unwrap_or_default();
        values.clear();
        fill(&mut values);
        let sample = Tracked { stamp_nanos, log_time_nanos, number: 0, values, missing_cables, after_gap: false };
        if is_behind {
            self.suspects.push_back(sample);
            if is_expecting || self.suspects.len() >= CLOCK_STEP_MESSAGES {
                self.step_back();
            }
        } else {
            self.drop_suspects(i64::MIN);
            self.accept(sample);
        }
    }

    /// Counts the remaining suspects at the end of the log as late messages.
    pub fn finish(&mut self) {
        self.drop_suspects(i64::MIN);
    }

    /// Merges a message with the time of the newest sample or suspect: it contains cables that were missing there.
    #[cold]
    fn complete(&mut self, stamp_nanos: i64, missing_cables: u64, fill: impl FnOnce(&mut Vec<f64>)) {
        let accepted = if self.is_stepped { &mut self.ahead } else { &mut self.samples };
        let mut newest = self.suspects.back_mut().into_iter().chain(accepted.back_mut());
        let sample = newest.find(|sample| sample.stamp_nanos == stamp_nanos);
        let Some(sample) = sample.filter(|sample| sample.missing_cables & !missing_cables != 0) else {
            self.counts.duplicate_count += 1;
            return;
        };
        let mut values = self.spare.pop().unwrap_or_default();
        values.clear();
        fill(&mut values);
        // Only one of the two may have speeds.
        sample.values.resize(sample.values.len().max(values.len()), f64::NAN);
        for (place, value) in sample.values.iter_mut().zip(&values).filter(|(place, _)| place.is_nan()) {
            *place = *value;
        }
        self.spare.push(values);
        sample.missing_cables &= missing_cables;
        let is_whole = sample.missing_cables == 0;
        self.named_cables |= !missing_cables;
        self.counts.message_count += 1;
        if is_whole && self.last_nanos == Some(stamp_nanos) {
            self.reach(Some(stamp_nanos));
        }
    }

    fn reach(&mut self, stamp_nanos: Option<i64>) {
        if self.pace.is_settled() {
            self.reached_nanos = self.reached_nanos.max(stamp_nanos);
        }
    }

    fn accept(&mut self, mut sample: Tracked) {
        let interval_nanos = self.last_nanos.map(|last| sample.stamp_nanos.saturating_sub(last));
        let was_settled = self.pace.is_settled();
        if let Some(interval_nanos) = interval_nanos {
            sample.after_gap = self.pace.is_gap(interval_nanos);
            self.counts.gap_count += u64::from(was_settled && sample.after_gap);
            if self.pace.add(interval_nanos) {
                #[expect(clippy::cast_precision_loss, reason = "an interval")]
                let median_nanos = self.pace.median_nanos() as f64;
                self.counts.interval_nanos = median_nanos;
            }
        }
        self.counts.message_count += 1;
        sample.number = self.counts.message_count;
        let (stamp_nanos, missing_cables) = (sample.stamp_nanos, sample.missing_cables);
        let (first, last) = self.counts.stamps_nanos.unwrap_or((stamp_nanos, stamp_nanos));
        self.counts.stamps_nanos = Some((first.min(stamp_nanos), last.max(stamp_nanos)));
        let samples = if self.is_stepped { &mut self.ahead } else { &mut self.samples };
        let is_partial = samples.back().is_some_and(|before| before.missing_cables & self.named_cables != 0);
        self.counts.partial_count += u64::from(is_partial);
        samples.push_back(sample);
        self.named_cables |= !missing_cables;
        let before_nanos = self.last_nanos.replace(stamp_nanos);
        // More messages of this time may come.
        self.reach(if missing_cables == 0 { Some(stamp_nanos) } else { before_nanos });
        if self.samples.len().max(self.ahead.len()) > WAITING_LIMIT {
            self.keep_within_limit();
        }
        if !was_settled {
            self.judge_early_intervals();
        }
    }

    /// Judges the first intervals by one another.
    #[cold]
    fn judge_early_intervals(&mut self) {
        self.counts.gap_count = self.pace.early_gap_count();
        for samples in [&mut self.samples, &mut self.ahead] {
            let mut before = None;
            for sample in samples {
                let interval_nanos = before.map(|before| sample.stamp_nanos.saturating_sub(before));
                sample.after_gap = interval_nanos.is_some_and(|interval| self.pace.is_gap(interval));
                before = Some(sample.stamp_nanos);
            }
        }
    }

    #[cold]
    fn step_back(&mut self) {
        self.counts.clock_step_count += 1;
        self.expecting = 0;
        self.last_nanos = None;
        if self.is_stepped {
            self.follow_step();
        }
        self.is_stepped = !self.samples.is_empty();
        let mut suspects = std::mem::take(&mut self.suspects);
        suspects.drain(..).for_each(|suspect| self.accept(suspect));
        self.suspects = suspects;
    }

    /// Whether the clock was set back and the rows have not followed yet.
    pub fn is_stepped(&self) -> bool {
        self.is_stepped
    }

    /// Switches to the new time and discards the rest of the old one.
    pub fn follow_step(&mut self) {
        self.clear();
        self.is_stepped = false;
        std::mem::swap(&mut self.samples, &mut self.ahead);
        let is_whole = self.samples.back().is_none_or(|newest| newest.missing_cables == 0);
        let newest_whole = self.samples.iter().rev().nth(usize::from(!is_whole));
        let newest_nanos = newest_whole.map(|sample| sample.stamp_nanos);
        self.reach(newest_nanos);
    }

    /// Expects a clock step because the cable signal had one; one message then suffices to detect it.
    pub fn expect_step(&mut self) {
        self.clear();
        self.expecting = CLOCK_STEP_MESSAGES;
        if !self.suspects.is_empty() {
            self.step_back();
        }
    }

    /// Discards the samples of the rows' present time base.
    fn clear(&mut self) {
        self.reached_nanos = None;
        self.spare.extend(self.samples.drain(..).map(|sample| sample.values));
    }

    /// Limits the samples kept for rows that may never come.
    #[cold]
    fn keep_within_limit(&mut self) {
        if self.samples.len() > WAITING_LIMIT {
            self.spare.extend(self.samples.pop_front().map(|sample| sample.values));
        }
        if self.ahead.len() > WAITING_LIMIT {
            self.follow_step();
            self.keep_within_limit();
        }
    }

    /// Drops the suspects from a time on.
    fn drop_suspects(&mut self, from_nanos: i64) {
        while self.suspects.back().is_some_and(|suspect| suspect.stamp_nanos >= from_nanos) {
            self.counts.late_count += 1;
            self.spare.extend(self.suspects.pop_back().map(|suspect| suspect.values));
        }
    }

    /// Removes and returns the oldest sample.
    pub fn pop(&mut self) -> Option<Tracked> {
        self.samples.pop_front()
    }

    /// Takes a sample's memory for reuse.
    pub fn recycle(&mut self, sample: Tracked) {
        self.spare.push(sample.values);
    }

    /// Whether everything is available that a row of this time can get.
    #[inline]
    pub fn has_reached(&self, stamp_nanos: i64) -> bool {
        self.reached_nanos >= Some(stamp_nanos)
    }

    /// Prepares for the row of a time: follows a clock step if the time rather belongs after it, and discards all but the last sample at or before
    /// the time.
    pub fn advance(&mut self, stamp_nanos: i64) {
        while self.samples.get(1).is_some_and(|next| next.stamp_nanos <= stamp_nanos) {
            self.spare.extend(self.samples.pop_front().map(|sample| sample.values));
        }
        if self.is_stepped && self.is_rather_ahead(stamp_nanos) {
            self.follow_step();
            self.advance(stamp_nanos);
        }
    }

    #[cold]
    fn is_rather_ahead(&self, stamp_nanos: i64) -> bool {
        if self.around(stamp_nanos).is_some() {
            return false;
        }
        let distance = |sample: Option<&Tracked>| sample.map_or(u64::MAX, |it| it.stamp_nanos.abs_diff(stamp_nanos));
        let (first, last) = (self.ahead.front(), self.ahead.back());
        let is_within = first.is_some_and(|first| first.stamp_nanos <= stamp_nanos)
            && last.is_some_and(|last| last.stamp_nanos >= stamp_nanos);
        let ahead = if is_within { 0 } else { distance(first).min(distance(last)) };
        ahead < distance(self.samples.front()).min(distance(self.samples.get(1)))
    }

    /// Returns the samples around a time and the interpolation ratio between them; `None` outside the samples and in gaps.
    ///
    /// Call [`advance`](Self::advance) with the same time first.
    pub fn around(&self, stamp_nanos: i64) -> Option<Around<'_>> {
        let before = self.samples.front().filter(|sample| sample.stamp_nanos <= stamp_nanos)?;
        if before.stamp_nanos == stamp_nanos {
            return Some(Around { before, after: before, ratio: 0.0 });
        }
        let after = self.samples.get(1).filter(|sample| !sample.after_gap)?;
        let [since, interval] = [stamp_nanos, after.stamp_nanos].map(|nanos| nanos.saturating_sub(before.stamp_nanos));
        #[expect(clippy::cast_precision_loss, reason = "a ratio of two intervals")]
        let ratio = since as f64 / interval as f64;
        Some(Around { before, after, ratio })
    }
}

/// The samples before and after a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around<'a> {
    pub before: &'a Tracked,
    pub after: &'a Tracked,
    /// Interpolation ratio; 0 if the sample before has exactly this time.
    pub ratio: f64,
}

impl Around<'_> {
    /// Writes the values at the time, as many as `out` holds; a sample's own values are passed on unchanged.
    pub fn interpolate(&self, out: &mut [f64]) {
        let Self { before, after, ratio } = self;
        // Without this distinction a NaN in the unused message would spoil the number.
        if *ratio == 0.0 {
            for (place, value) in out.iter_mut().zip(&before.values) {
                *place = *value;
            }
            return;
        }
        for ((place, before), after) in out.iter_mut().zip(&before.values).zip(&after.values) {
            *place = before + ratio * (after - before);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pushed(stamps: impl IntoIterator<Item = i64>) -> Track {
        let mut track = Track::default();
        for stamp in stamps {
            #[expect(clippy::cast_precision_loss, reason = "small numbers")]
            track.push(stamp, 0, 0, |values| values.push(stamp as f64));
        }
        track.finish();
        track
    }

    fn stamps(samples: &VecDeque<Tracked>) -> Vec<i64> {
        samples.iter().map(|sample| sample.stamp_nanos).collect()
    }

    #[test]
    fn duplicates_and_stragglers_are_left_out_and_counted() {
        let track = pushed([10, 20, 20, 30, 15, 16, 16, 40]);
        assert_eq!(stamps(&track.samples), [10, 20, 30, 40]);
        assert_eq!((track.counts().duplicate_count, track.counts().late_count), (2, 2));
    }

    #[test]
    fn a_clock_set_back_is_followed_when_the_rows_are() {
        let mut track = pushed((100..120).chain(50..70));
        assert_eq!(stamps(&track.samples), (100..120).collect::<Vec<_>>());
        assert_eq!((track.counts().clock_step_count, track.counts().late_count), (1, 0));
        track.advance(119);
        assert_eq!(stamps(&track.samples), [119]);
        track.advance(50);
        assert_eq!(stamps(&track.samples), (50..70).collect::<Vec<_>>());
    }

    #[test]
    fn a_clock_set_back_with_disorder_is_found_too() {
        let track = pushed((100..120).chain([90, 50, 51, 51, 52, 54, 53, 55, 56, 57, 58, 59]));
        assert_eq!(stamps(&track.ahead), [50, 51, 52, 53, 55, 56, 57, 58, 59]);
        let counts = track.counts();
        assert_eq!((counts.clock_step_count, counts.late_count, counts.duplicate_count), (1, 2, 1));
    }

    #[test]
    fn one_stamp_in_the_far_future_costs_no_more_than_a_clock_step() {
        let mut track = pushed((0..20).chain([1_000_000]).chain(20..60));
        track.advance(19);
        track.advance(30);
        assert_eq!(track.around(30).unwrap().before.stamp_nanos, 30);
    }

    #[test]
    fn values_are_interpolated_but_not_over_gaps_or_past_the_ends() {
        let mut track = pushed([0, 10, 20, 30, 40, 50, 60, 1000, 1010]);
        assert_eq!(track.counts().gap_count, 1);
        assert!(track.around(-1).is_none());
        track.advance(25);
        let Around { before, after, ratio } = track.around(25).unwrap();
        assert_eq!((before.stamp_nanos, after.stamp_nanos), (20, 30));
        assert!((ratio - 0.5).abs() < 1e-15);
        track.advance(500);
        assert!(track.around(500).is_none());
        track.advance(1011);
        assert!(track.around(1011).is_none());
    }

    #[test]
    fn what_nobody_takes_is_limited() {
        let limit = i64::try_from(WAITING_LIMIT).unwrap();
        let track = pushed((0..3 * limit).map(|index| index + 10 * limit).chain(0..3 * limit));
        assert_eq!(track.samples.len(), WAITING_LIMIT);
        assert_eq!(track.samples.back().unwrap().stamp_nanos, 3 * limit - 1);
        assert!(track.ahead.is_empty() && track.spare.len() <= 2 * WAITING_LIMIT);
    }
}
