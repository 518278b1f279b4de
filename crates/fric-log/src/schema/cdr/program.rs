//! The steps that read wanted fields from CDR bytes.
//!
//! Every program consumes exactly the field or message that it was compiled for, so programs for the same bytes can run one after the other from the
//! same position.

use crate::path::{Literal, Selection};
use crate::schema::types::Primitive;

/// Steps run in order, each with the name of its field.
#[derive(Debug, Clone, Default)]
pub(super) struct Program {
    pub ops: Vec<Op>,
    /// One name per op; the first field if an op skips several.
    pub fields: Vec<String>,
}

/// The number of elements that follow.
#[derive(Debug, Clone, Copy)]
pub(super) enum Length {
    Fixed(usize),
    /// A 32-bit count comes first; the position is already aligned for it.
    Counted,
}

/// One step. If an op reads a number or a count, the position is already aligned for it.
#[derive(Debug, Clone)]
pub(super) enum Op {
    /// Moves to the next multiple of `align` (a power of two), then on by `bytes`.
    Advance { align: usize, bytes: usize },
    /// Skips a counted sequence of elements of `size` bytes each, without gaps.
    SkipBlocks { size: usize, align: usize },
    /// Skips texts.
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
        /// Whether it runs exactly once per message, so that the bytes can be compared with the last message's.
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
    /// Minimum number of bytes of an element.
    pub min_bytes: usize,
    pub selection: Selection,
    /// Program for the elements of the selection.
    pub selected: Program,
    /// Program for the elements outside the selection, if there are any.
    pub others: Program,
}

/// A message that is read only if a member has, or does not have, a value.
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
