//! The steps by which wanted fields are read from CDR bytes.
//!
//! Every program consumes exactly the field or message it was compiled for, so that programs for the same bytes
//! can be run one after the other from the same place.

use crate::path::{Literal, Selection};
use crate::schema::types::Primitive;

/// Steps run in order, each with the name of the field it is about.
#[derive(Debug, Clone, Default)]
pub(super) struct Program {
    pub ops: Vec<Op>,
    /// One for each of `ops`; the first field where an op passes over several.
    pub fields: Vec<String>,
}

/// How many elements follow.
#[derive(Debug, Clone, Copy)]
pub(super) enum Length {
    Fixed(usize),
    /// A 32-bit count comes first; the position is aligned for it.
    Counted,
}

/// One step. Where an op reads a number or a count, the position is aligned for it already.
#[derive(Debug, Clone)]
pub(super) enum Op {
    /// Moves to the next multiple of `align` (a power of two), then on by `bytes`.
    Advance { align: usize, bytes: usize },
    /// Passes over a counted sequence of elements, each of `size` bytes without gaps.
    SkipBlocks { size: usize, align: usize },
    /// Passes over texts.
    SkipTexts { length: Length },
    /// Reads a number.
    Number { primitive: Primitive, slot: usize },
    /// Reads an array of numbers.
    Numbers { primitive: Primitive, align: usize, length: Length, selection: Selection, slot: usize },
    /// Reads texts.
    Texts {
        length: Length,
        selection: Selection,
        slot: usize,
        /// Run exactly once a message, so that the bytes can be compared with the last message's.
        once: bool,
    },
    /// Reads seconds and nanoseconds.
    Time { slot: usize },
    /// Runs several programs on the same bytes.
    Each(Vec<Program>),
    /// Runs a program on every element of an array of messages.
    Elements(Box<Elements>),
    /// Runs `passed` or `failed` on a message, depending on what `test` reads from it.
    Filter(Box<Filter>),
}

/// An array of messages.
#[derive(Debug, Clone)]
pub(super) struct Elements {
    pub length: Length,
    /// The fewest bytes an element can take.
    pub min_bytes: usize,
    pub selection: Selection,
    /// For the elements of the selection.
    pub selected: Program,
    /// For the elements outside the selection, if it leaves any.
    pub others: Program,
}

/// A message read only where a member has, or has not, a value.
#[derive(Debug, Clone)]
pub(super) struct Filter {
    /// Reads the member into `slot`; need not consume the message.
    pub test: Program,
    pub slot: usize,
    pub equal: bool,
    pub value: Literal,
    pub passed: Program,
    pub failed: Program,
}

impl Op {
    /// Whether the op stores nothing.
    pub(super) fn only_skips(&self) -> bool {
        matches!(self, Self::Advance { .. } | Self::SkipBlocks { .. } | Self::SkipTexts { .. })
    }
}

impl Program {
    pub(super) fn field(&self, index: usize) -> &str {
        self.fields.get(index).map_or("", String::as_str)
    }
}
