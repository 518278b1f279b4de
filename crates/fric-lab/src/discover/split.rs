//! Which samples are learned from, and which are held out to judge by.
//!
//! The log is cut into blocks of equal length; of each two neighbours one is learned from and the other held out, by a
//! fixed draw, so that no rhythm of the run falls in step with it. The model runs through all of them, for friction
//! remembers; only what is compared differs.

use std::ops::Range;

use crate::fit::CableRecord;

/// Most blocks of a log, and what they last at least, s.
const MOST_BLOCKS: usize = 48;
const SHORTEST_S: f64 = 0.25;

/// A stretch of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Its cycles.
    pub cycles: Range<usize>,
    /// Held out from the fit.
    pub held_out: bool,
}

/// Blocks of all logs of a cable, in order.
pub fn split(record: &CableRecord<'_>) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut draw = 0x9e37_79b9_u32;
    for (start, rows) in record.logs() {
        #[expect(clippy::cast_precision_loss, reason = "a count of cycles")]
        let longest = (rows.len() as f64 * record.cycle_s / SHORTEST_S).floor();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a small count")]
        let count = longest.clamp(2.0, MOST_BLOCKS as f64) as usize & !1;
        let edge = |place: usize| start + place * rows.len() / count;
        let mut first_held_out = false;
        for place in 0..count {
            if place % 2 == 0 {
                // xorshift: one bit a pair.
                draw ^= draw << 13;
                draw ^= draw >> 17;
                draw ^= draw << 5;
                first_held_out = draw & 1 == 1;
            }
            let held_out = (place % 2 == 0) == first_held_out;
            blocks.push(Block { cycles: edge(place)..edge(place + 1), held_out });
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_of_each_two_neighbours_is_held_out() {
        let mut first_of_pair = [0, 0];
        let blocks = blocks_of(51_561);
        assert_eq!(blocks.len(), MOST_BLOCKS);
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
