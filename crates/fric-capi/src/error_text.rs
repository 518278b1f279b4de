//! Writes text into a buffer of the caller.

use std::ffi::c_char;

/// A buffer for an error text; none if the pointer is null or the size 0.
#[derive(Clone, Copy)]
pub struct ErrorText {
    buffer: *mut c_char,
    size: usize,
}

impl ErrorText {
    /// Wraps the caller's buffer.
    ///
    /// # Safety
    /// `buffer` is null or points to `size` bytes that are writable as long as this is used.
    pub unsafe fn new(buffer: *mut c_char, size: usize) -> Self {
        Self { buffer, size: if buffer.is_null() { 0 } else { size } }
    }

    /// Writes as much of the text as fits, cut between two characters, with a final zero.
    pub fn write(self, text: &str) {
        let Some(room) = self.size.checked_sub(1) else { return };
        let length = (0..=room.min(text.len())).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
        let bytes = text.bytes().take(length).chain([0]);
        for (place, byte) in bytes.enumerate() {
            // SAFETY: `place` ≤ `length` ≤ `size − 1`, within the buffer that `new` was promised.
            unsafe { self.buffer.add(place).write(byte.cast_signed() as c_char) };
        }
    }
}
