//! The reference of a cable under a hanging mass, row by row.
//!
//! The force at the platform is `m·(g − a)` ([`KnownReference`]). The acceleration `a` comes from the length: its second difference over rows at
//! least [`WINDOW_NANOS`] apart, which is the mean acceleration under a triangular window of that width. This requires quiet motion: with jerk within
//! the window the mean differs from the momentary acceleration, and afterwards the mass oscillates on the elastic cable, which the length does not
//! show. So a row has a reference only if all accelerations within the window are at most [`KnownReference::quiet_m_per_s2`], and the first and last
//! rows of a log have none. Rows are delayed by twice the window.

use std::collections::VecDeque;

use fric_core::{CableInput, KnownReference, Sample};

use super::SignalPaths;
use super::waiting::Row;

/// Half the width of the window, and the minimum distance of rows for a difference.
#[expect(clippy::cast_possible_truncation, reason = "a whole number of ns")]
const WINDOW_NANOS: i64 = (KnownReference::WINDOW_S * 1e9) as i64;
/// Rows further apart than this say nothing about the acceleration between them.
const FARTHEST_NANOS: i64 = 10 * WINDOW_NANOS;

/// Rows that wait for their reference.
#[derive(Debug)]
pub(super) struct HangingRows {
    reference: KnownReference,
    /// Delivered rows that others still need, then the waiting ones, in the order of arrival.
    rows: VecDeque<Waiting>,
    /// Index of the first waiting row.
    next: usize,
    is_ended: bool,
}

/// A waiting row.
#[derive(Debug)]
struct Waiting {
    row: Row,
    /// The time base it belongs to: a clock that was set back starts another one.
    time: u32,
    /// Accelerations by cable, NaN if unknown; empty until needed.
    accelerations_m_per_s2: Vec<f64>,
}

impl HangingRows {
    /// Returns an empty queue; `None` if no mass hangs on the cables.
    pub fn of(paths: &SignalPaths) -> Option<Self> {
        let is_mass = |known: &KnownReference| matches!(known, KnownReference::HangingMass { .. });
        let reference = paths.known_reference().filter(is_mass)?;
        Some(Self { reference, rows: VecDeque::new(), next: 0, is_ended: false })
    }

    /// Adds the next row.
    pub fn push(&mut self, row: Row) {
        let is_back = |last: &Waiting| last.row.stamp_nanos >= row.stamp_nanos;
        let time = self.rows.back().map_or(0, |last| last.time + u32::from(is_back(last)));
        self.rows.push_back(Waiting { row, time, accelerations_m_per_s2: Vec::new() });
    }

    /// Marks the end: no row follows.
    pub fn end(&mut self) {
        self.is_ended = true;
    }

    /// Whether the next row is final, or there is none to wait for.
    pub fn is_ready(&self) -> bool {
        let next = self.rows.get(self.next).zip(self.rows.back());
        self.is_ended
            || next.is_some_and(|(row, last)| row.time != last.time || last.after_nanos(row) >= 2 * WINDOW_NANOS)
    }

    /// Returns the time of the next row; `None` after the last.
    pub fn next_stamp_nanos(&self) -> Option<i64> {
        self.rows.get(self.next).map(|waiting| waiting.row.stamp_nanos)
    }

    /// Returns the next row; `None` after the last.
    pub fn pop(&mut self) -> Option<Sample<'_>> {
        // Of the rows before the window the last one is needed for the acceleration of the next row.
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
        let greatest_m_per_s2 = self.reference.quiet_m_per_s2();
        let is_quiet =
            |index: usize, cable: usize| acceleration(index, cable).is_some_and(|now| now.abs() <= greatest_m_per_s2);
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

    /// Whether a row is far enough before the next for a difference, or belongs to an earlier time base.
    fn is_behind(&self, row: &Waiting) -> bool {
        self.rows.get(self.next).is_some_and(|next| row.time != next.time || next.after_nanos(row) >= WINDOW_NANOS)
    }

    /// Returns the acceleration of each cable in a row, m/s².
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
    /// Returns how much later it is than another row.
    fn after_nanos(&self, other: &Self) -> i64 {
        self.row.stamp_nanos.saturating_sub(other.row.stamp_nanos)
    }
}
