//! Derives the speed if it is not measured.
//!
//! It is the derivative, at the row's time, of the parabola through the lengths before, in and after the row, and has no lag. The difference to the
//! previous row would be the speed of half a cycle ago, which would delay viscous friction and the acceleration of the pulleys. A control loop
//! without a measured speed has this lag; a log need not.

use std::collections::VecDeque;
use std::ops::Range;

use super::waiting::Row;

/// A known length of a cable, and its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownLength {
    /// Nanoseconds since 1970.
    pub stamp_nanos: i64,
    /// Length, m.
    pub length_m: f64,
}

impl KnownLength {
    /// Creates a known length; `None` if it is not finite.
    #[must_use]
    pub fn new(stamp_nanos: i64, length_m: f64) -> Option<Self> {
        length_m.is_finite().then_some(Self { stamp_nanos, length_m })
    }

    /// Returns the speed at this time from the known lengths before and after; from one of them if the other is unknown, 0 from none. A length that
    /// is not earlier, or not later, counts as unknown.
    ///
    /// ```
    /// use fric_log::signals::KnownLength;
    /// // x = t², at 0, 1 and 3 seconds.
    /// let [before, now, after] = [(0, 0.0), (1, 1.0), (3, 9.0)].map(|(s, length_m)| {
    ///     KnownLength::new(s * 1_000_000_000, length_m)
    /// });
    /// let now = now.unwrap();
    /// assert_eq!(now.speed_m_per_s(before, after), 2.0);
    /// assert_eq!(now.speed_m_per_s(before, None), 1.0);
    /// assert_eq!(now.speed_m_per_s(None, None), 0.0);
    /// ```
    #[must_use]
    pub fn speed_m_per_s(self, before: Option<Self>, after: Option<Self>) -> f64 {
        match (before.and_then(|before| before.change_to(self)), after.and_then(|after| self.change_to(after))) {
            (Some((past_s, past_m_per_s)), Some((future_s, future_m_per_s))) => {
                (past_m_per_s * future_s + future_m_per_s * past_s) / (past_s + future_s)
            }
            (Some((_, m_per_s)), None) | (None, Some((_, m_per_s))) => m_per_s,
            (None, None) => 0.0,
        }
    }

    /// Returns the time to a later length, and the change of length.
    fn change_to(self, later: Self) -> Option<(f64, f64)> {
        #[expect(clippy::cast_precision_loss, reason = "an interval between rows")]
        let interval_s = later.stamp_nanos.saturating_sub(self.stamp_nanos) as f64 * 1e-9;
        (interval_s > 0.0).then(|| (interval_s, (later.length_m - self.length_m) / interval_s))
    }
}

/// Rows that wait for their speeds.
///
/// The next length of a cable is searched in as many rows as there are cables: if each has its own messages, it is among them.
#[derive(Debug)]
pub(super) struct SpeedRows {
    rows: VecDeque<Row>,
    /// By cable: the known length before the front row.
    before: Vec<Option<KnownLength>>,
    is_ended: bool,
}

impl SpeedRows {
    pub fn new(cable_count: usize) -> Self {
        Self { rows: VecDeque::new(), before: vec![None; cable_count], is_ended: false }
    }

    /// Whether the next row has all its speeds and none waits before it, so that it need not be stored.
    pub fn passes(&mut self, row: &Row) -> bool {
        if !self.rows.is_empty() || self.cables().any(|cable| row.lacks_speed(cable)) {
            return false;
        }
        for (cable, before) in self.before.iter_mut().enumerate() {
            *before = row.known_length(cable).or(*before);
        }
        true
    }

    /// Adds the next row.
    pub fn push(&mut self, row: Row) {
        self.rows.push_back(row);
    }

    /// Marks the end: no row follows.
    pub fn end(&mut self) {
        self.is_ended = true;
    }

    /// Whether the front row is final, or there is none to wait for.
    pub fn is_ready(&self) -> bool {
        let has_all = |row: &Row| self.cables().all(|cable| !row.lacks_speed(cable) || self.after(cable).is_some());
        self.is_ended || self.rows.len() > self.before.len() || self.rows.front().is_some_and(has_all)
    }

    /// Returns the front row; `None` after the last.
    pub fn pop(&mut self) -> Option<Row> {
        let after: Vec<Option<KnownLength>> = self.cables().map(|cable| self.after(cable)).collect();
        let mut row = self.rows.pop_front()?;
        let lacks: Vec<bool> = self.cables().map(|cable| row.lacks_speed(cable)).collect();
        let stamp_nanos = row.stamp_nanos;
        for (((cable, before), after), lacks_speed) in row.cables.iter_mut().zip(&mut self.before).zip(after).zip(lacks)
        {
            let Some(now) = KnownLength::new(stamp_nanos, cable.length_m) else { continue };
            if lacks_speed {
                cable.speed_m_per_s = now.speed_m_per_s(*before, after);
            }
            *before = Some(now);
        }
        Some(row)
    }

    fn cables(&self) -> Range<usize> {
        0..self.before.len()
    }

    /// Returns the next length of a cable after the front row.
    fn after(&self, cable: usize) -> Option<KnownLength> {
        self.rows.iter().skip(1).find_map(|row| row.known_length(cable))
    }
}
