//! One signal over time: stamps put in order, values between them interpolated.

use std::collections::VecDeque;

use super::TrackCounts;

/// So many messages in a row that go on from an earlier time are a clock that was set back, not late messages.
pub const CLOCK_STEP_MESSAGES: usize = 8;
/// An interval of so many usual ones is a gap.
const GAP_RATIO: f64 = 10.0;
/// How fast the usual interval follows the present one.
const INTERVAL_SHARE: f64 = 0.1;

/// A stamp and what was measured then.
#[derive(Debug, Default)]
pub(super) struct Tracked {
    pub stamp_nanos: i64,
    pub values: Vec<f64>,
    /// Whether more than a usual interval lies before it.
    pub after_gap: bool,
}

/// What a new sample did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Arrival {
    /// It came in its turn, or was left out.
    InTurn,
    /// The clock has been set back; what was waiting belongs to the time before.
    ClockStep,
}

/// The samples of a signal that are still needed, in the order of time.
#[derive(Debug, Default)]
pub(super) struct Track {
    samples: VecDeque<Tracked>,
    /// Samples behind the time, until it is clear what they are.
    suspects: VecDeque<Tracked>,
    spare: Vec<Vec<f64>>,
    last_nanos: Option<i64>,
    counts: TrackCounts,
}

impl Track {
    pub fn counts(&self) -> &TrackCounts {
        &self.counts
    }

    pub fn count_undecodable(&mut self) {
        self.counts.undecodable_count += 1;
    }

    pub fn samples(&self) -> &VecDeque<Tracked> {
        &self.samples
    }

    /// Stamp of the newest sample.
    pub fn newest_nanos(&self) -> Option<i64> {
        self.samples.back().map(|sample| sample.stamp_nanos)
    }

    /// Takes in a sample; `fill` writes its values into an empty vector.
    pub fn push(&mut self, stamp_nanos: i64, fill: impl FnOnce(&mut Vec<f64>)) -> Arrival {
        match self.last_nanos {
            Some(last) if stamp_nanos == last => {
                self.counts.duplicate_count += 1;
                return Arrival::InTurn;
            }
            Some(last) if stamp_nanos < last => return self.suspect(stamp_nanos, fill),
            _ => {}
        }
        self.drop_suspects();
        let sample = self.sample(stamp_nanos, fill);
        self.accept(sample);
        Arrival::InTurn
    }

    /// What is left at the end of the log: single stragglers.
    pub fn finish(&mut self) {
        self.drop_suspects();
    }

    fn sample(&mut self, stamp_nanos: i64, fill: impl FnOnce(&mut Vec<f64>)) -> Tracked {
        let mut values = self.spare.pop().unwrap_or_default();
        values.clear();
        fill(&mut values);
        Tracked { stamp_nanos, values, after_gap: false }
    }

    fn accept(&mut self, mut sample: Tracked) {
        let counts = &mut self.counts;
        if let Some(last) = self.last_nanos {
            #[expect(clippy::cast_precision_loss, reason = "an interval, compared with a usual one")]
            let interval_nanos = sample.stamp_nanos.saturating_sub(last) as f64;
            let usual = if counts.interval_nanos > 0.0 { counts.interval_nanos } else { interval_nanos };
            sample.after_gap = interval_nanos > GAP_RATIO * usual;
            counts.gap_count += u64::from(sample.after_gap);
            counts.interval_nanos = usual + INTERVAL_SHARE * (interval_nanos.min(2.0 * usual) - usual);
        }
        counts.message_count += 1;
        let (first, last) = counts.stamps_nanos.unwrap_or((sample.stamp_nanos, sample.stamp_nanos));
        counts.stamps_nanos = Some((first.min(sample.stamp_nanos), last.max(sample.stamp_nanos)));
        self.last_nanos = Some(sample.stamp_nanos);
        self.samples.push_back(sample);
    }

    fn suspect(&mut self, stamp_nanos: i64, fill: impl FnOnce(&mut Vec<f64>)) -> Arrival {
        // Suspects that do not go on from one another are no clock.
        if self.suspects.back().is_some_and(|before| stamp_nanos <= before.stamp_nanos) {
            self.drop_suspects();
        }
        let sample = self.sample(stamp_nanos, fill);
        self.suspects.push_back(sample);
        if self.suspects.len() < CLOCK_STEP_MESSAGES {
            return Arrival::InTurn;
        }
        self.counts.clock_step_count += 1;
        self.last_nanos = None;
        Arrival::ClockStep
    }

    /// Forgets all samples.
    pub fn clear(&mut self) {
        while let Some(sample) = self.samples.pop_front() {
            self.spare.push(sample.values);
        }
    }

    /// After [`Arrival::ClockStep`]: forgets the time before and goes on in the new one.
    pub fn restart(&mut self) {
        self.clear();
        while let Some(sample) = self.suspects.pop_front() {
            self.accept(sample);
        }
    }

    fn drop_suspects(&mut self) {
        while let Some(sample) = self.suspects.pop_front() {
            self.counts.late_count += 1;
            self.spare.push(sample.values);
        }
    }

    /// Takes out the oldest sample.
    pub fn pop(&mut self) -> Option<Tracked> {
        self.samples.pop_front()
    }

    /// Gives a sample's memory back.
    pub fn recycle(&mut self, sample: Tracked) {
        self.spare.push(sample.values);
    }

    /// Forgets all but the last sample at or before a time: those after it are still needed.
    pub fn advance(&mut self, stamp_nanos: i64) {
        while self.samples.get(1).is_some_and(|next| next.stamp_nanos <= stamp_nanos) {
            if let Some(sample) = self.samples.pop_front() {
                self.spare.push(sample.values);
            }
        }
    }

    /// The samples around a time and the share of the way between them; `None` outside the samples and in gaps.
    ///
    /// Call [`advance`](Self::advance) with the same time first.
    pub fn around(&self, stamp_nanos: i64) -> Option<(&Tracked, &Tracked, f64)> {
        let before = self.samples.front().filter(|sample| sample.stamp_nanos <= stamp_nanos)?;
        if before.stamp_nanos == stamp_nanos {
            return Some((before, before, 0.0));
        }
        let after = self.samples.get(1).filter(|sample| !sample.after_gap)?;
        #[expect(clippy::cast_precision_loss, reason = "a ratio of two intervals")]
        let ratio =
            (stamp_nanos - before.stamp_nanos) as f64 / (after.stamp_nanos.saturating_sub(before.stamp_nanos)) as f64;
        Some((before, after, ratio))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pushed(stamps: &[i64]) -> Track {
        let mut track = Track::default();
        for &stamp in stamps {
            #[expect(clippy::cast_precision_loss, reason = "small numbers")]
            let arrival = track.push(stamp, |values| values.push(stamp as f64));
            if arrival == Arrival::ClockStep {
                track.restart();
            }
        }
        track.finish();
        track
    }

    fn stamps(track: &Track) -> Vec<i64> {
        track.samples().iter().map(|sample| sample.stamp_nanos).collect()
    }

    #[test]
    fn duplicates_and_stragglers_are_left_out_and_counted() {
        let track = pushed(&[10, 20, 20, 30, 15, 16, 40]);
        assert_eq!(stamps(&track), [10, 20, 30, 40]);
        assert_eq!((track.counts().duplicate_count, track.counts().late_count), (1, 2));
    }

    #[test]
    fn a_clock_set_back_goes_on_in_the_new_time() {
        let back: Vec<i64> = (100..120).chain(50..70).collect();
        let track = pushed(&back);
        assert_eq!(stamps(&track), (50..70).collect::<Vec<_>>());
        assert_eq!((track.counts().clock_step_count, track.counts().late_count), (1, 0));
    }

    #[test]
    fn values_are_interpolated_but_not_over_gaps_or_past_the_ends() {
        let mut track = pushed(&[0, 10, 20, 30, 1000, 1010]);
        assert_eq!(track.counts().gap_count, 1);
        assert!(track.around(-1).is_none());
        track.advance(25);
        let (before, after, ratio) = track.around(25).unwrap();
        assert_eq!((before.stamp_nanos, after.stamp_nanos), (20, 30));
        assert!((ratio - 0.5).abs() < 1e-15);
        track.advance(500);
        assert!(track.around(500).is_none());
        track.advance(1011);
        assert!(track.around(1011).is_none());
    }
}
