//! Writes text into a buffer of the caller.

use std::ffi::c_char;
use std::fmt::{self, Display, Write as _};

/// A buffer for a text; none if the pointer is null or the size 0.
#[derive(Clone, Copy)]
pub struct TextBuffer {
    buffer: *mut c_char,
    size: usize,
}

impl TextBuffer {
    /// Wraps the caller's buffer.
    ///
    /// # Safety
    /// `buffer` is null or points to `size` bytes that are writable as long as this is used.
    pub unsafe fn new(buffer: *mut c_char, size: usize) -> Self {
        Self { buffer, size: if buffer.is_null() { 0 } else { size } }
    }

    /// Writes as much of the text as fits, cut between two characters, with a final zero.
    pub fn write(self, text: &str) {
        self.show(text);
    }

    /// Does the same with what a value displays, without allocating. Returns the length of the whole text in bytes, without the final zero.
    pub fn show(self, value: impl Display) -> usize {
        let mut text = Text { buffer: self, written: 0, length: 0 };
        // Nothing here reports an error, so a value that displays as text does not either.
        let shown = write!(text, "{value}");
        text.end();
        shown.map_or(0, |()| text.length)
    }

    /// Writes a byte; none beyond the buffer.
    fn put(self, place: usize, byte: u8) {
        if place < self.size {
            // SAFETY: within the buffer that `new` was promised.
            unsafe { self.buffer.add(place).write(byte.cast_signed() as c_char) };
        }
    }
}

/// A text that arrives in pieces.
struct Text {
    buffer: TextBuffer,
    /// Bytes of it in the buffer.
    written: usize,
    /// Bytes of it so far, those that did not fit included.
    length: usize,
}

impl Text {
    fn end(&self) {
        self.buffer.put(self.written, 0);
    }
}

impl fmt::Write for Text {
    fn write_str(&mut self, piece: &str) -> fmt::Result {
        // After a piece that was cut, none follows.
        let room = if self.written == self.length { self.buffer.size.saturating_sub(self.written + 1) } else { 0 };
        let length = (0..=room.min(piece.len())).rev().find(|end| piece.is_char_boundary(*end)).unwrap_or(0);
        for byte in piece.bytes().take(length) {
            self.buffer.put(self.written, byte);
            self.written += 1;
        }
        self.length += piece.len();
        Ok(())
    }
}
