//! The pace of messages or rows: their rate, and how far their times are from it.

use serde::Serialize;

/// Rate and intervals; empty for fewer than two times.
#[derive(Debug, Default, Serialize)]
pub struct Pace {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate_hz: Option<f64>,
    /// Standard deviation of the intervals.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jitter_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub longest_interval_s: Option<f64>,
}

/// Accumulated times, ns.
#[derive(Debug, Default)]
pub struct Times {
    pub count: u64,
    /// Number of intervals; a clock that was set back makes none.
    interval_count: u64,
    first_nanos: i64,
    last_nanos: i64,
    interval_sum_s: f64,
    interval_squares_s2: f64,
    longest_s: f64,
}

impl Times {
    pub fn add(&mut self, at_nanos: i64) {
        if self.count == 0 {
            self.first_nanos = at_nanos;
        } else {
            let interval_s = seconds_between(self.last_nanos, at_nanos);
            if interval_s >= 0.0 {
                self.interval_count += 1;
                self.interval_sum_s += interval_s;
                self.interval_squares_s2 += interval_s * interval_s;
                self.longest_s = self.longest_s.max(interval_s);
            }
        }
        self.count += 1;
        self.last_nanos = at_nanos;
    }

    /// Returns the times of the first and the last, ns since 1970; `None` without any.
    pub fn range_nanos(&self) -> Option<[i64; 2]> {
        (self.count > 0).then_some([self.first_nanos, self.last_nanos])
    }

    /// Returns the time from the first to the last, s. Where the clock was set back that of the parts is added up.
    pub fn duration_s(&self) -> f64 {
        let is_in_order = self.interval_count + 1 >= self.count;
        if is_in_order { seconds_between(self.first_nanos, self.last_nanos) } else { self.interval_sum_s }
    }

    pub fn pace(&self) -> Pace {
        #[expect(clippy::cast_precision_loss, reason = "a count of messages")]
        let intervals = self.interval_count as f64;
        let mean_s = self.interval_sum_s / intervals;
        if self.interval_count == 0 || mean_s <= 0.0 {
            return Pace::default();
        }
        let variance = self.interval_squares_s2 / intervals - mean_s * mean_s;
        Pace {
            rate_hz: Some(1.0 / mean_s),
            jitter_s: Some(variance.max(0.0).sqrt()),
            longest_interval_s: Some(self.longest_s),
        }
    }
}

/// Returns the time from one to another, s; negative if the clock was set back.
#[expect(clippy::cast_precision_loss, reason = "for people")]
pub fn seconds_between(from_nanos: i64, to_nanos: i64) -> f64 {
    to_nanos.saturating_sub(from_nanos) as f64 * 1e-9
}
