//! Buffered reading at any position of a file, shared between threads without a common cursor.
//!
//! [`Window`] is for scans: a jump costs one small read, and sequential reading uses increasingly larger reads. Its memory is one buffer of at most
//! [`WINDOW_LEN`] bytes, whatever lengths the file states.

use std::fs::File;
use std::io;

/// Maximum size of a single read of [`Window`].
pub(super) const WINDOW_LEN: usize = 256 * 1024;
/// Size of a read after a jump.
const JUMP_LEN: usize = 4 * 1024;

#[cfg(unix)]
fn read_at(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, buffer, offset)
}

#[cfg(windows)]
fn read_at(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, buffer, offset)
}

/// Fills `buffer` from `offset`; reads fewer bytes only at the end of the file.
pub(super) fn read_up_to(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    let mut filled = 0;
    while let Some(rest) = buffer.get_mut(filled..)
        && !rest.is_empty()
    {
        match read_at(file, rest, offset + filled as u64) {
            Ok(0) => break,
            Ok(count) => filled += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}

/// Reads exactly `length` bytes from `offset` into the cleared `buffer`.
pub(super) fn read_into(file: &File, buffer: &mut Vec<u8>, offset: u64, length: usize) -> io::Result<()> {
    // Shrinking first keeps `resize` from clearing more than the unused part.
    buffer.truncate(length);
    buffer.resize(length, 0);
    if read_up_to(file, buffer, offset)? == length { Ok(()) } else { Err(io::ErrorKind::UnexpectedEof.into()) }
}

/// The CRC-32 of a stretch of a file, part of which may be in memory already.
#[derive(Default)]
pub(super) struct RunningChecksum {
    hasher: crc32fast::Hasher,
    /// Present end of the stretch.
    end: u64,
    buffer: Vec<u8>,
}

impl RunningChecksum {
    /// Returns the checksum of the bytes from `start` to `end`.
    pub(super) fn of(file: &File, start: u64, end: u64) -> io::Result<u32> {
        let mut checksum = Self { end: start, ..Self::default() };
        checksum.catch_up(file, end)?;
        Ok(checksum.finish())
    }

    /// Reads on up to `end`.
    pub(super) fn catch_up(&mut self, file: &File, end: u64) -> io::Result<()> {
        while self.end < end {
            let length = usize::try_from(end - self.end).unwrap_or(WINDOW_LEN).min(WINDOW_LEN);
            read_into(file, &mut self.buffer, self.end, length)?;
            self.hasher.update(&self.buffer);
            self.end += length as u64;
        }
        Ok(())
    }

    /// Adds the following bytes.
    pub(super) fn add(&mut self, bytes: &[u8]) {
        self.hasher.update(bytes);
        self.end += bytes.len() as u64;
    }

    pub(super) fn finish(self) -> u32 {
        self.hasher.finalize()
    }
}

/// A view of a file through one reused buffer.
pub(super) struct Window<'a> {
    file: &'a File,
    file_len: u64,
    buffer: Vec<u8>,
    /// File offset of the buffer's first byte.
    start: u64,
    /// Size of the next sequential read.
    stride: usize,
}

impl<'a> Window<'a> {
    pub(super) fn new(file: &'a File, file_len: u64) -> Self {
        Self { file, file_len, buffer: Vec::new(), start: 0, stride: JUMP_LEN }
    }

    pub(super) fn file_len(&self) -> u64 {
        self.file_len
    }

    /// Returns up to `length` bytes from `offset`: fewer at the end of the file, and never more than [`WINDOW_LEN`].
    pub(super) fn bytes(&mut self, offset: u64, length: usize) -> io::Result<&[u8]> {
        let rest = self.file_len.saturating_sub(offset);
        let length = length.min(WINDOW_LEN).min(usize::try_from(rest).unwrap_or(WINDOW_LEN));
        let mut at = self.position(offset);
        if at.is_none_or(|at| self.buffer.len() - at < length) {
            self.refill(offset, length)?;
            at = Some(0);
        }
        let at = at.unwrap_or(0);
        let end = (at + length).min(self.buffer.len());
        Ok(self.buffer.get(at..end).unwrap_or_default())
    }

    /// Returns all buffered bytes from `offset` on, at least one unless the file ends there.
    pub(super) fn buffered(&mut self, offset: u64) -> io::Result<&[u8]> {
        if self.bytes(offset, 1)?.is_empty() {
            return Ok(&[]);
        }
        let at = self.position(offset).unwrap_or(0);
        Ok(self.buffer.get(at..).unwrap_or_default())
    }

    fn position(&self, offset: u64) -> Option<usize> {
        let at = usize::try_from(offset.checked_sub(self.start)?).ok()?;
        (at <= self.buffer.len()).then_some(at)
    }

    fn refill(&mut self, offset: u64, length: usize) -> io::Result<()> {
        let in_sequence = self.position(offset).is_some() && !self.buffer.is_empty();
        self.stride = if in_sequence { (self.stride * 2).min(WINDOW_LEN) } else { JUMP_LEN };
        let length = length.max(self.stride);
        let rest = self.file_len.saturating_sub(offset);
        let length = length.min(usize::try_from(rest).unwrap_or(length));
        self.buffer.resize(length, 0);
        self.start = offset;
        let filled = match read_up_to(self.file, &mut self.buffer, offset) {
            Ok(filled) => filled,
            Err(error) => {
                self.buffer.clear();
                return Err(error);
            }
        };
        self.buffer.truncate(filled);
        Ok(())
    }
}
