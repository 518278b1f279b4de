//! Divides the samples into training samples and held-out samples.
//!
//! The log is cut into blocks of equal length. Of every two neighbouring blocks one is used for training and the other held out, by a fixed
//! pseudo-random draw, so that no rhythm of the run coincides with it. The model runs through all blocks, because friction has memory; only the
//! comparison differs.

use std::ops::Range;

use super::cable::CableRecord;

/// Maximum number of blocks of a log, and their minimum duration, s.
const MOST_BLOCKS: f64 = 48.0;
const SHORTEST_S: f64 = 0.25;

/// A stretch of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Its cycles.
    pub cycles: Range<usize>,
    /// Whether the block is held out from the fit.
    pub held_out: bool,
}

/// Returns the blocks of all logs of a cable, in order.
pub fn split(record: &CableRecord<'_>) -> Vec<Block> {
    let mut draw = DRAW;
    record.logs().flat_map(|(start, rows)| cut(start..start + rows.len(), record.interval_s, &mut draw)).collect()
}

/// Blocks of one log of so many cycles; like those of a cable with no other log.
#[must_use]
pub fn blocks(cycle_count: usize, interval_s: f64) -> Vec<Block> {
    cut(0..cycle_count, interval_s, &mut { DRAW })
}

/// Returns which of the samples that count belong to the held-out blocks, or to the training blocks.
pub fn used(blocks: &[Block], counts: &[bool], held_out: bool) -> Vec<bool> {
    let mut used = vec![false; counts.len()];
    for block in blocks.iter().filter(|block| block.held_out == held_out) {
        let cycles = used.iter_mut().zip(counts).skip(block.cycles.start).take(block.cycles.len());
        cycles.for_each(|(used, counts)| *used = *counts);
    }
    used
}

/// Where the draw begins.
const DRAW: u32 = 0x9e37_79b9;

/// Blocks of one log.
fn cut(log: Range<usize>, interval_s: f64, draw: &mut u32) -> Vec<Block> {
    #[expect(clippy::cast_precision_loss, reason = "a count of cycles")]
    let longest = (log.len() as f64 * interval_s / SHORTEST_S).floor();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a small count")]
    let count = longest.clamp(2.0, MOST_BLOCKS) as usize & !1;
    let edge = |place: usize| log.start + place * log.len() / count;
    let mut first_held_out = false;
    let block = |place: usize| {
        if place.is_multiple_of(2) {
            // xorshift: one bit per pair of blocks.
            *draw ^= *draw << 13;
            *draw ^= *draw >> 17;
            *draw ^= *draw << 5;
            first_held_out = *draw & 1 == 1;
        }
        Block { cycles: edge(place)..edge(place + 1), held_out: place.is_multiple_of(2) == first_held_out }
    };
    (0..count).map(block).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_each_two_neighbours_is_held_out() {
        let mut first_of_pair = [0, 0];
        let blocks = cut(0..51_561, 1e-3, &mut 0x9e37_79b9);
        assert_eq!(blocks.len(), 48);
        for pair in blocks.chunks(2) {
            assert_ne!(pair[0].held_out, pair[1].held_out);
            first_of_pair[usize::from(pair[0].held_out)] += 1;
        }
        assert!(first_of_pair.iter().all(|count| *count >= 6), "{first_of_pair:?}");
        assert_eq!(blocks.first().map(|block| block.cycles.start), Some(0));
        assert_eq!(blocks.last().map(|block| block.cycles.end), Some(51_561));
        assert!(blocks.windows(2).all(|pair| pair[0].cycles.end == pair[1].cycles.start));
    }
}
