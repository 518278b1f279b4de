//! Speed where none is measured.
//!
//! The derivative, at the row's time, of the parabola through the lengths before, in and after the row. It does not lag: the change
//! since the row before would be the speed of half a cycle ago, and with it viscous friction and what the pulleys take to be
//! accelerated would be too late. A control loop that has no speed of its own has to live with that lag; a log has not.

use std::collections::VecDeque;
use std::ops::Range;

use super::waiting::Row;

/// A length of a cable that is known, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownLength {
    /// Nanoseconds since 1970.
    pub stamp_nanos: i64,
    /// m.
    pub length_m: f64,
}

impl KnownLength {
    /// `None` where the length is not finite.
    #[must_use]
    pub fn new(stamp_nanos: i64, length_m: f64) -> Option<Self> {
        length_m.is_finite().then_some(Self { stamp_nanos, length_m })
    }

    /// Speed at this time by the lengths that were known before and after; by one of them where the other is not known, 0 by none. One that
    /// is not earlier, or not later, counts as not known.
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

    /// The time to a later one, and the change of length by that time.
    fn change_to(self, later: Self) -> Option<(f64, f64)> {
        #[expect(clippy::cast_precision_loss, reason = "an interval between rows")]
        let interval_s = later.stamp_nanos.saturating_sub(self.stamp_nanos) as f64 * 1e-9;
        (interval_s > 0.0).then(|| (interval_s, (later.length_m - self.length_m) / interval_s))
    }
}

/// Rows on their way to their speeds.
///
/// The next length of a cable is looked for in as many rows as there are cables: where each has messages of its own, it
/// comes within them.
#[derive(Debug)]
pub(super) struct SpeedRows {
    rows: VecDeque<Row>,
    /// By cable: what was known before the row in front.
    before: Vec<Option<KnownLength>>,
    is_ended: bool,
}

impl SpeedRows {
    pub fn new(cable_count: usize) -> Self {
        Self { rows: VecDeque::new(), before: vec![None; cable_count], is_ended: false }
    }

    /// Whether the row that follows has all its speeds and none waits before it: it need not be taken in.
    pub fn passes(&mut self, row: &Row) -> bool {
        if !self.rows.is_empty() || self.cables().any(|cable| row.lacks_speed(cable)) {
            return false;
        }
        for (cable, before) in self.before.iter_mut().enumerate() {
            *before = row.known_length(cable).or(*before);
        }
        true
    }

    /// Takes in the row that follows.
    pub fn push(&mut self, row: Row) {
        self.rows.push_back(row);
    }

    /// No row follows.
    pub fn end(&mut self) {
        self.is_ended = true;
    }

    /// Whether the row in front has all it can get, or there is none to wait for.
    pub fn is_ready(&self) -> bool {
        let has_all = |row: &Row| self.cables().all(|cable| !row.lacks_speed(cable) || self.after(cable).is_some());
        self.is_ended || self.rows.len() > self.before.len() || self.rows.front().is_some_and(has_all)
    }

    /// The row in front; `None` after the last.
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

    /// The next length of a cable after the row in front.
    fn after(&self, cable: usize) -> Option<KnownLength> {
        self.rows.iter().skip(1).find_map(|row| row.known_length(cable))
    }
}
