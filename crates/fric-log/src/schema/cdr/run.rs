//! Runs a [`Program`] on the bytes of one message.

use std::str;

use crate::path::{Literal, Selection};
use crate::schema::error::DecodeError;
use crate::schema::values::Slot;

use super::HEADER_BYTES;
use super::order::{self, Order};
use super::program::{Filter, Length, Op, Program};

const NANOS_PER_S: u32 = 1_000_000_000;

/// Runs the program on `body`, the message after its header.
pub(super) fn run<O: Order>(program: &Program, body: &[u8], slots: &mut [Slot]) -> Result<(), DecodeError> {
    let mut reader = Reader { body, at: 0 };
    reader.program::<O>(program, slots)
}

struct Reader<'a> {
    body: &'a [u8],
    at: usize,
}

/// The reason why an op failed; the program adds the field's name.
enum Failure {
    Truncated,
    Count(usize),
    Text(usize),
    Time,
    /// An inner program failed, which has named the field.
    Inner(DecodeError),
}

impl<'a> Reader<'a> {
    fn program<O: Order>(&mut self, program: &Program, slots: &mut [Slot]) -> Result<(), DecodeError> {
        for (index, op) in program.ops.iter().enumerate() {
            self.op::<O>(op, slots).map_err(|failure| self.error(failure, program.field(index)))?;
        }
        Ok(())
    }

    fn op<O: Order>(&mut self, op: &Op, slots: &mut [Slot]) -> Result<(), Failure> {
        match op {
            Op::Advance { align, bytes } => {
                self.align(*align);
                self.take(*bytes)?;
            }
            Op::Number { primitive, slot } => {
                let bytes = self.take(primitive.size())?;
                if let Some(slot) = slots.get_mut(*slot) {
                    order::append::<O>(*primitive, bytes, &mut slot.numbers);
                }
            }
            Op::Numbers { primitive, align, length, selection, slot } => {
                let size = primitive.size();
                let count = self.count::<O>(*length, size)?;
                if count > 0 {
                    self.align(*align);
                }
                let bytes = self.take(count.saturating_mul(size))?;
                let range = selection.range(count);
                let chosen = bytes.get(range.start * size..range.end * size);
                if let (Some(slot), Some(chosen)) = (slots.get_mut(*slot), chosen) {
                    order::append::<O>(*primitive, chosen, &mut slot.numbers);
                }
            }
            Op::Texts { length, selection, slot, once } => {
                if let Some(slot) = slots.get_mut(*slot) {
                    self.texts::<O>(*length, *selection, slot, *once)?;
                }
            }
            Op::Time { slot } => {
                let seconds = i64::from(self.u32::<O>()?.cast_signed());
                let nanos = self.u32::<O>()?;
                if nanos >= NANOS_PER_S {
                    return Err(Failure::Time);
                }
                let time_nanos = seconds * i64::from(NANOS_PER_S) + i64::from(nanos);
                if let Some(slot) = slots.get_mut(*slot) {
                    slot.times_nanos.push(time_nanos);
                }
            }
            Op::SkipBlocks { size, align } => {
                let count = self.count::<O>(Length::Counted, *size)?;
                if count > 0 {
                    self.align(*align);
                }
                self.take(count.saturating_mul(*size))?;
            }
            Op::SkipTexts { length } => {
                for _ in 0..self.count::<O>(*length, 4)? {
                    self.text::<O>()?;
                }
            }
            Op::Each(programs) => {
                let start = self.at;
                for program in programs {
                    self.at = start;
                    self.program::<O>(program, slots).map_err(Failure::Inner)?;
                }
            }
            Op::Elements(array) => {
                let count = self.count::<O>(array.length, array.min_bytes)?;
                let range = array.selection.range(count);
                for index in 0..count {
                    let program = if range.contains(&index) { &array.selected } else { &array.others };
                    self.program::<O>(program, slots).map_err(Failure::Inner)?;
                }
            }
            Op::Filter(filter) => self.filter::<O>(filter, slots)?,
        }
        Ok(())
    }

    fn texts<O: Order>(
        &mut self,
        length: Length,
        selection: Selection,
        slot: &mut Slot,
        once: bool,
    ) -> Result<(), Failure> {
        let start = self.at;
        let rest = self.body.get(start..).unwrap_or_default();
        if once && let Some(length) = slot.texts.keep_if_same(rest) {
            self.at += length;
            return Ok(());
        }
        let count = self.count::<O>(length, 4)?;
        let range = selection.range(count);
        for index in 0..count {
            let bytes = self.text::<O>()?;
            if range.contains(&index) {
                let text = str::from_utf8(bytes.strip_suffix(b"\0").unwrap_or(bytes));
                slot.texts.push(text.map_err(|_| Failure::Text(self.at - bytes.len()))?);
            }
        }
        if once {
            slot.texts.remember_raw(self.body.get(start..self.at).unwrap_or_default());
        }
        Ok(())
    }

    fn filter<O: Order>(&mut self, filter: &Filter, slots: &mut [Slot]) -> Result<(), Failure> {
        let start = self.at;
        if let Some(slot) = slots.get_mut(filter.slot) {
            slot.numbers.clear();
            slot.texts.forget_read();
        }
        self.program::<O>(&filter.test, slots).map_err(Failure::Inner)?;
        let equal = slots.get(filter.slot).is_some_and(|slot| match &filter.value {
            Literal::Text(text) => slot.texts.last_read() == Some(text),
            Literal::Integer(value) => slot.numbers.last() == Some(&order::signed(*value)),
        });
        self.at = start;
        let program = if equal == filter.equal { &filter.passed } else { &filter.failed };
        self.program::<O>(program, slots).map_err(Failure::Inner)
    }

    /// Returns the bytes of one text, including its final NUL.
    fn text<O: Order>(&mut self) -> Result<&'a [u8], Failure> {
        self.align(4);
        let length = self.count::<O>(Length::Counted, 1)?;
        self.take(length)
    }

    /// Returns the number of elements that follow, checked to be possible if each takes at least `min_bytes`.
    fn count<O: Order>(&mut self, length: Length, min_bytes: usize) -> Result<usize, Failure> {
        let count = match length {
            Length::Fixed(count) => count,
            Length::Counted => usize::try_from(self.u32::<O>()?).unwrap_or(usize::MAX),
        };
        if count.saturating_mul(min_bytes) <= self.body.len().saturating_sub(self.at) {
            return Ok(count);
        }
        match length {
            Length::Fixed(_) => Err(Failure::Truncated),
            Length::Counted => Err(Failure::Count(count)),
        }
    }

    /// Moves to the next multiple of `align`, a power of two; it may be beyond the end.
    fn align(&mut self, align: usize) {
        self.at = (self.at + (align - 1)) & !(align - 1);
    }

    fn u32<O: Order>(&mut self) -> Result<u32, Failure> {
        let bytes = self.body.get(self.at..).and_then(<[u8]>::first_chunk);
        let bytes = *bytes.ok_or(Failure::Truncated)?;
        self.at += bytes.len();
        Ok(O::u32(bytes))
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], Failure> {
        let end = self.at.checked_add(count).ok_or(Failure::Truncated)?;
        let bytes = self.body.get(self.at..end).ok_or(Failure::Truncated)?;
        self.at = end;
        Ok(bytes)
    }

    #[cold]
    fn error(&self, failure: Failure, field: &str) -> DecodeError {
        let field = field.to_owned();
        let offset = self.at + HEADER_BYTES;
        match failure {
            Failure::Truncated => DecodeError::Truncated { field, offset, length: self.body.len() + HEADER_BYTES },
            Failure::Count(count) => DecodeError::Count {
                field,
                offset: offset.saturating_sub(4),
                count,
                remaining: self.body.len().saturating_sub(self.at),
            },
            Failure::Text(start) => DecodeError::Text { field, offset: start + HEADER_BYTES },
            Failure::Time => DecodeError::TimeRange { field },
            Failure::Inner(error) => error,
        }
    }
}
