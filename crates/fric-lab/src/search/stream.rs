//! Forces of several models beside each other, a few cycles at a time: memory does not grow with the log.

use std::ops::Range;

use fric_core::LANES;
use rayon::prelude::*;

use super::pass::{Forces, LanePass, Part, with_width_for};

/// Number of cycles that are computed at once.
const CHUNK: usize = 2048;

/// A pass with any number of derivatives per lane.
trait Pass: Send {
    /// Starts a log with an empty memory.
    fn rest(&mut self);

    /// Runs the cycles `from..to` and appends the forces of each part to `forces`.
    fn advance(&mut self, from: usize, to: usize, forces: &mut [Forces]);
}

impl<const N: usize> Pass for LanePass<'_, N> {
    fn rest(&mut self) {
        Self::rest(self);
    }

    fn advance(&mut self, from: usize, to: usize, forces: &mut [Forces]) {
        Self::advance(self, from, to, forces);
    }
}

/// The forces of several parts, with records of the same length, in one cycle after the other.
pub struct Stream<'a> {
    parts: Vec<Part<'a>>,
    passes: Vec<Box<dyn Pass + 'a>>,
    /// The forces of each part in the cycles of `chunk`.
    forces: Vec<Forces>,
    chunk: Range<usize>,
}

impl<'a> Stream<'a> {
    /// Creates the stream before its first cycle.
    pub fn new(parts: Vec<Part<'a>>) -> Self {
        let passes = parts.chunks(LANES).map(|parts| with_width_for!(parts, pass_of(parts))).collect();
        Self { forces: vec![Forces::default(); parts.len()], passes, parts, chunk: 0..0 }
    }

    /// Goes on to a cycle, which must not be before the last one. Returns whether cycles had to be computed.
    pub fn advance_to(&mut self, cycle: usize) -> bool {
        let before = self.chunk.end;
        while cycle >= self.chunk.end && self.advance() {}
        self.chunk.end > before
    }

    /// Returns the force of a part, N, and its derivatives, in a cycle of those reached last; NaN past the end.
    pub fn at(&self, part: usize, cycle: usize) -> (f64, &[f64]) {
        let of_part = self.forces.get(part).zip(cycle.checked_sub(self.chunk.start));
        of_part.map_or((f64::NAN, &[]), |(forces, place)| forces.at(place))
    }

    /// Computes the next cycles. Returns false past the end.
    fn advance(&mut self) -> bool {
        let Some(record) = self.parts.first().map(|part| part.record) else { return false };
        let from = self.chunk.end;
        if from >= record.rows.len() {
            return false;
        }
        let log = record.log_of(from);
        if from == log.start {
            self.passes.iter_mut().for_each(|pass| pass.rest());
        }
        self.chunk = from..(from + CHUNK).min(log.end);
        for (forces, part) in self.forces.iter_mut().zip(&self.parts) {
            forces.clear(part.free.len(), CHUNK);
        }
        let Range { start, end } = self.chunk;
        let passes = self.passes.par_iter_mut().zip(self.forces.par_chunks_mut(LANES));
        passes.for_each(|(pass, forces)| pass.advance(start, end, forces));
        true
    }
}

fn pass_of<'a, const N: usize>(parts: &[Part<'a>]) -> Box<dyn Pass + 'a> {
    Box::new(LanePass::<N>::new(parts.iter().cloned()))
}
