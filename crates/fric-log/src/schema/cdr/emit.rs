//! Programs under construction: appends ops and tracks what is known about the position.

use crate::path::FieldPath;
use crate::schema::error::SchemaError;
use crate::schema::types::{Element, TypeTable};

use super::program::{Op, Program};

/// Maximum number of steps of a program, so that a short schema cannot unroll into an endless one.
pub(super) const MAX_OPS: usize = 50_000;

/// The two versions of plain CDR.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Generation {
    /// Numbers of eight bytes are aligned to eight.
    Cdr1,
    /// Numbers of eight bytes are aligned to four; arrays of anything but numbers start with their size in bytes.
    Cdr2,
}

/// What is known about the position: its remainder modulo `modulus`, a power of two.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub modulus: usize,
    pub residue: usize,
}

impl Place {
    pub const UNKNOWN: Self = Self { modulus: 1, residue: 0 };

    /// Returns what is known after a counted sequence of elements of `size` bytes, which may be empty.
    pub fn after_sequence(size: usize) -> Self {
        let modulus = if size.is_multiple_of(4) { 4 } else { 1 };
        Self { modulus, residue: 0 }
    }
}

/// The data that a compiler shares with those of inner programs.
pub(super) struct Shared<'t> {
    pub types: &'t TypeTable,
    pub generation: Generation,
    /// Number of slots in use.
    pub slots: usize,
    pub ops_left: usize,
}

/// A program under construction.
pub(super) struct Compiler<'s, 't> {
    pub shared: &'s mut Shared<'t>,
    pub program: Program,
    pub place: Place,
    /// Whether these ops run exactly once per message.
    pub once: bool,
    /// The first `wstring`, after which no position is known.
    pub wide: Option<String>,
}

impl<'t> Compiler<'_, 't> {
    /// Returns a compiler for a program within this one.
    pub(super) fn part(&mut self, place: Place, once: bool) -> Compiler<'_, 't> {
        Compiler { wide: self.wide.clone(), shared: &mut *self.shared, program: Program::default(), place, once }
    }

    /// Returns the strictest alignment.
    pub(super) fn max_align(&self) -> usize {
        match self.shared.generation {
            Generation::Cdr1 => 8,
            Generation::Cdr2 => 4,
        }
    }

    /// Reads the size that CDR2 puts before arrays of anything but numbers.
    pub(super) fn start_array(&mut self, element: Element, name: &str) -> Result<(), SchemaError> {
        match (self.shared.generation, element) {
            (Generation::Cdr1, _) | (_, Element::Number(_)) => Ok(()),
            (Generation::Cdr2, _) => self.skip(4, 4, name),
        }
    }

    /// Skips bytes that are aligned to `align`.
    pub(super) fn skip(&mut self, align: usize, bytes: usize, name: &str) -> Result<(), SchemaError> {
        self.align(align, name)?;
        self.advance(1, bytes, self.place_after(bytes), name)
    }

    /// Moves to the next multiple of `align`, or of the limit of the CDR version.
    pub(super) fn align(&mut self, align: usize, name: &str) -> Result<(), SchemaError> {
        let align = align.min(self.max_align());
        if self.place.modulus < align {
            let aligned = Place { modulus: align, residue: 0 };
            return self.advance(align, 0, aligned, name);
        }
        let padding = (align - self.place.residue % align) % align;
        self.advance(1, padding, self.place_after(padding), name)
    }

    /// Moves on, by extending the last op if that only moves too.
    fn advance(&mut self, align: usize, bytes: usize, after: Place, name: &str) -> Result<(), SchemaError> {
        if align == 1 && bytes == 0 || self.wide.is_some() {
            return Ok(());
        }
        if let (1, Some(Op::Advance { bytes: before, .. })) = (align, self.program.ops.last_mut()) {
            *before = before.saturating_add(bytes);
            self.place = after;
            return Ok(());
        }
        self.push(Op::Advance { align, bytes }, after, name)
    }

    /// Returns what is known about the position after `bytes`.
    pub(super) fn place_after(&self, bytes: usize) -> Place {
        let Place { modulus, residue } = self.place;
        Place { modulus, residue: residue.wrapping_add(bytes) % modulus }
    }

    /// Appends an op, after which the position is known as stated.
    pub(super) fn push(&mut self, op: Op, after: Place, name: &str) -> Result<(), SchemaError> {
        // Nothing after a wide text is read.
        if self.wide.is_some() && op.only_skips() {
            return Ok(());
        }
        self.shared.ops_left = self.shared.ops_left.checked_sub(1).ok_or_else(|| {
            let types = self.shared.types;
            SchemaError::TooLarge {
                name: types.message(types.root).name.clone(),
                limit: MAX_OPS,
                what: "fields in all",
            }
        })?;
        self.program.ops.push(op);
        self.program.fields.push(name.to_owned());
        self.place = after;
        Ok(())
    }

    /// Checks whether the position of the wanted field `path` can be known.
    pub(super) fn readable(&self, path: &FieldPath) -> Result<(), SchemaError> {
        match &self.wide {
            None => Ok(()),
            Some(wide) => Err(SchemaError::WideText { path: path.to_string(), wide: wide.clone() }),
        }
    }
}
