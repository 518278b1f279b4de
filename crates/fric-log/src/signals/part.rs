//! A part of a log.

use super::TrackCounts;

/// The part of a log to deliver: from one time up to another, seconds after the first row.
///
/// Everything before it is read all the same, so that rows are the same as in the whole log: derived speeds, interpolated values. Everything after it
/// is not read.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Part {
    /// Start of the part; the first row if `None`.
    pub start_s: Option<f64>,
    /// End of the part, exclusive; the end of the log if `None`.
    pub end_s: Option<f64>,
}

/// The position of a row relative to the part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Before,
    Within,
    After,
}

/// The part to deliver, and the progress of the log.
#[derive(Debug, Default)]
pub(super) struct Progress {
    pub part: Part,
    first_nanos: Option<i64>,
    /// Time of the last row, s after the first.
    pub last_s: f64,
    pub has_begun: bool,
    pub is_over: bool,
    /// The counts before the part began, by role.
    pub before: [TrackCounts; 6],
}

impl Progress {
    /// Returns the position of a row; rows must come in order.
    pub fn side(&mut self, stamp_nanos: i64) -> Side {
        let first_nanos = *self.first_nanos.get_or_insert(stamp_nanos);
        #[expect(clippy::cast_precision_loss, reason = "as the times of a log are given in seconds")]
        let time_s = stamp_nanos.saturating_sub(first_nanos) as f64 / 1e9;
        self.last_s = time_s;
        if self.part.end_s.is_some_and(|end_s| time_s >= end_s) {
            return Side::After;
        }
        if self.part.start_s.is_some_and(|start_s| time_s < start_s) { Side::Before } else { Side::Within }
    }
}

impl TrackCounts {
    /// Returns the counts since then.
    pub(super) fn since(&self, before: &Self) -> Self {
        Self {
            message_count: self.message_count.saturating_sub(before.message_count),
            duplicate_count: self.duplicate_count.saturating_sub(before.duplicate_count),
            partial_count: self.partial_count.saturating_sub(before.partial_count),
            late_count: self.late_count.saturating_sub(before.late_count),
            clock_step_count: self.clock_step_count.saturating_sub(before.clock_step_count),
            gap_count: self.gap_count.saturating_sub(before.gap_count),
            undecodable_count: self.undecodable_count.saturating_sub(before.undecodable_count),
            stamps_nanos: self.stamps_nanos,
            interval_nanos: self.interval_nanos,
        }
    }
}
