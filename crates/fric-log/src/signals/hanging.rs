//! The reference of a cable under a hanging mass, row by row.
//!
//! The force at the platform is `m·(g − a)` ([`KnownReference`]). The acceleration `a` comes from the length: its second
//! difference over rows at least [`WINDOW_NANOS`] apart, which is the mean acceleration under a triangle of that width. The
//! cable has to be in quiet motion for it: with a jerk within the window the mean is not the acceleration of the moment, and
//! after one the mass swings on the stretch of the cable, which no length tells. So a row has a reference only where all
//! accelerations within the window are at most [`GREATEST_ACCELERATION_M_PER_S2`], and the first and last rows of a log have
//! none. Rows come twice the window later than they are read.

use std::collections::VecDeque;

use fric_core::{CableInput, KnownReference, Sample};

use super::waiting::Row;

/// Half the width of the window, and the shortest distance of rows for a difference.
const WINDOW_NANOS: i64 = 20_000_000;
/// Rows further apart than this say nothing about the acceleration between them.
const FARTHEST_NANOS: i64 = 10 * WINDOW_NANOS;
/// Beyond this the motion is not quiet, m/s²: 5 % of the weight. At half, ramps of 0.3 m/s² have no reference; at double, the
/// mass may swing by 10 % of its weight after a ramp has ended.
const GREATEST_ACCELERATION_M_PER_S2: f64 = 0.5;

/// Rows on their way to their reference.
#[derive(Debug)]
pub(super) struct HangingRows {
    reference: KnownReference,
    /// Those given out that others still need, then those that wait, in the order they came.
    rows: VecDeque<Waiting>,
    /// The first of them that waits.
    next: usize,
    is_ended: bool,
}

/// A row that waits.
#[derive(Debug)]
struct Waiting {
    row: Row,
    /// Which time it belongs to: a clock that was set back begins another.
    time: u32,
    /// By cable, NaN where it is not known; empty until it is needed.
    accelerations_m_per_s2: Vec<f64>,
}

impl HangingRows {
    pub fn new(reference: KnownReference) -> Self {
        Self { reference, rows: VecDeque::new(), next: 0, is_ended: false }
    }

    /// Takes in the row that follows.
    pub fn push(&mut self, row: Row) {
        let is_back = |last: &Waiting| last.row.stamp_nanos >= row.stamp_nanos;
        let time = self.rows.back().map_or(0, |last| last.time + u32::from(is_back(last)));
        self.rows.push_back(Waiting { row, time, accelerations_m_per_s2: Vec::new() });
    }

    /// No row follows.
    pub fn end(&mut self) {
        self.is_ended = true;
    }

    /// Whether the next row has all it can get, or there is none to wait for.
    pub fn is_ready(&self) -> bool {
        let next = self.rows.get(self.next).zip(self.rows.back());
        self.is_ended
            || next.is_some_and(|(row, last)| row.time != last.time || last.after_nanos(row) >= 2 * WINDOW_NANOS)
    }

    /// The time of the next row; `None` after the last.
    pub fn next_stamp_nanos(&self) -> Option<i64> {
        self.rows.get(self.next).map(|waiting| waiting.row.stamp_nanos)
    }

    /// The next row; `None` after the last.
    pub fn pop(&mut self) -> Option<Sample<'_>> {
        // What is before the window is needed up to its last row, from which the acceleration of the next one is told.
        while self.next > 0 && self.rows.get(1).is_some_and(|second| self.is_behind(second)) {
            self.rows.pop_front();
            self.next -= 1;
        }
        let around: Vec<usize> =
            (0..self.rows.len()).filter(|index| self.rows.get(*index).is_some_and(|row| self.is_around(row))).collect();
        for index in around.iter().copied() {
            if self.rows.get(index).is_some_and(|row| row.accelerations_m_per_s2.is_empty()) {
                let accelerations_m_per_s2 = self.accelerations_m_per_s2(index);
                if let Some(row) = self.rows.get_mut(index) {
                    row.accelerations_m_per_s2 = accelerations_m_per_s2;
                }
            }
        }
        let acceleration =
            |index: usize, cable: usize| self.rows.get(index)?.accelerations_m_per_s2.get(cable).copied();
        let is_quiet = |index: usize, cable: usize| {
            acceleration(index, cable).is_some_and(|now| now.abs() <= GREATEST_ACCELERATION_M_PER_S2)
        };
        let of_cable = |(cable, input): (usize, &CableInput)| {
            let is_known = input.sensor_force_n.is_finite() && around.iter().all(|index| is_quiet(*index, cable));
            acceleration(self.next, cable).filter(|_| is_known).map_or(f64::NAN, |now| self.reference.force_n(now))
        };
        let forces_n = self.rows.get(self.next)?.row.cables.iter().enumerate().map(of_cable).collect();
        let waiting = self.rows.get_mut(self.next)?;
        self.next += 1;
        waiting.row.reference_force_n = forces_n;
        Some(waiting.row.sample())
    }

    /// Whether a row is within the window around the next.
    fn is_around(&self, row: &Waiting) -> bool {
        self.rows
            .get(self.next)
            .is_some_and(|next| row.time == next.time && row.after_nanos(next).abs() <= WINDOW_NANOS)
    }

    /// Whether a row is as far before the next as a difference takes, or of a time before its own.
    fn is_behind(&self, row: &Waiting) -> bool {
        self.rows.get(self.next).is_some_and(|next| row.time != next.time || next.after_nanos(row) >= WINDOW_NANOS)
    }

    /// Acceleration of each cable in a row, m/s².
    fn accelerations_m_per_s2(&self, index: usize) -> Vec<f64> {
        let Some(now) = self.rows.get(index) else { return Vec::new() };
        let apart = |row: &&Waiting| row.after_nanos(now).abs() >= WINDOW_NANOS;
        let is_near = |row: &&Waiting| row.time == now.time && row.after_nanos(now).abs() <= FARTHEST_NANOS;
        let before = self.rows.iter().take(index).rev().find(apart).filter(is_near);
        let after = self.rows.iter().skip(index + 1).find(apart).filter(is_near);
        let Some((before, after)) = before.zip(after) else { return vec![f64::NAN; now.row.cables.len()] };
        #[expect(clippy::cast_precision_loss, reason = "intervals between rows")]
        let [past_s, future_s] = [now.after_nanos(before), after.after_nanos(now)].map(|nanos| nanos as f64 * 1e-9);
        let cables = before.row.cables.iter().zip(&now.row.cables).zip(&after.row.cables);
        let second_difference = |((before, now), after): ((&CableInput, &CableInput), &CableInput)| {
            let past_m_per_s = (now.length_m - before.length_m) / past_s;
            let future_m_per_s = (after.length_m - now.length_m) / future_s;
            2.0 * (future_m_per_s - past_m_per_s) / (past_s + future_s)
        };
        cables.map(second_difference).collect()
    }
}

impl Waiting {
    /// How much later than another it is.
    fn after_nanos(&self, other: &Self) -> i64 {
        self.row.stamp_nanos.saturating_sub(other.row.stamp_nanos)
    }
}
