//! What oscillates in a residual by itself: lines and a vibration.

use std::borrow::Cow;

use super::lines::{Line, lines};
use super::passes::Passes;
use super::spectrum::{Times, Together};
use super::vibration::{Vibration, Way, steady, vibration};
use crate::fit::{CableRecord, Row};
use crate::recording_fault::RecordingFault;

/// Frequencies that differ by less than this share are the same; of a vibration, which is broader, by less than its second number.
const SAME_RATIO: [f64; 2] = [1e-3, 1e-2];

/// Oscillations that have nothing to do with motion and load.
pub struct Oscillations {
    lines: Vec<Line>,
    /// With what it is in each row, N.
    vibration: Option<(Vibration, Vec<f64>)>,
}

impl Oscillations {
    /// The lines of a residual, N, NaN where there is no sample.
    pub fn lines_of(residual_n: &[f64], times: &Times, record: &CableRecord<'_>, signals: &[Together<'_>]) -> Self {
        Self { lines: lines(residual_n, times, signals, &Passes::of(record)), vibration: None }
    }

    /// The lines and the vibration of a residual, N, NaN where there is no sample. Where there is a vibration, lines within its peak are parts of it.
    pub fn of(residual_n: &[f64], times: &Times, record: &CableRecord<'_>, signals: &[Together<'_>]) -> Self {
        let all = Self::lines_of(residual_n, times, record, signals);
        let humming = steady(&all.lines, residual_n, times);
        let mut rest = residual_n.to_vec();
        for line in &humming {
            line.add_to(rest.iter_mut(), -1.0, times);
        }
        let way = |row: &Row| Way { length_m: row.signals.length_m, speed_m_per_s: row.signals.speed_m_per_s };
        let way: Vec<Way> = record.rows.iter().map(way).collect();
        // A hum that swells leaves a peak where it was.
        let is_of_hum =
            |found: &Vibration| humming.iter().any(|line| found.overlaps(line.frequency_hz, times.place_hz()));
        let Some(found) = vibration(&rest, times, &way, signals).filter(|found| !is_of_hum(found)) else {
            return all;
        };
        let shown_n = found.in_signal(&rest, times);
        let without: Vec<f64> = residual_n.iter().zip(&shown_n).map(|(residual, shown)| residual - shown).collect();
        let vibration = Some((found, shown_n));
        Self { vibration, ..Self::lines_of(&without, times, record, signals) }
    }

    /// Whether there is a vibration among them.
    pub fn vibrate(&self) -> bool {
        self.vibration.is_some()
    }

    /// Whether others are at the same frequencies.
    pub fn are_like(&self, other: &Self) -> bool {
        let same = |one: f64, other: f64, ratio: f64| (one / other - 1.0).abs() < ratio;
        let [narrow, broad] = SAME_RATIO;
        let is_in = |line: &Line| other.lines.iter().any(|of| same(of.frequency_hz, line.frequency_hz, narrow));
        let vibrations = match (&self.vibration, &other.vibration) {
            (None, None) => true,
            (Some((one, _)), Some((other, _))) => same(one.frequency_hz, other.frequency_hz, broad),
            _ => false,
        };
        vibrations && self.lines.len() == other.lines.len() && self.lines.iter().all(is_in)
    }

    /// A record's references with all of it taken off: the residual is what the model says less the reference.
    pub fn taken_off<'a>(&self, record: &CableRecord<'a>, times: &Times) -> Cow<'a, [f64]> {
        if self.lines.is_empty() && self.vibration.is_none() {
            return Cow::Borrowed(record.references_n);
        }
        let mut references_n = record.references_n.to_vec();
        for line in &self.lines {
            line.add_to(references_n.iter_mut(), 1.0, times);
        }
        let shown_n = self.vibration.iter().flat_map(|(_, shown_n)| shown_n);
        references_n.iter_mut().zip(shown_n).for_each(|(reference_n, shown_n)| *reference_n += shown_n);
        Cow::Owned(references_n)
    }

    /// The faults of the recording that they are.
    pub fn faults(&self) -> Vec<RecordingFault> {
        let vibration = self.vibration.iter().map(|(vibration, _)| vibration.fault());
        self.lines.iter().map(Line::fault).chain(vibration).collect()
    }
}
