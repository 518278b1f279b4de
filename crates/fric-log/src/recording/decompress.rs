//! Decompresses the content of chunks without trusting their stated sizes.
//!
//! The buffer has at most the stated size, which the caller has limited; beyond [`ONE_SHOT_LIMIT`] it grows as data arrive.

use std::io::{self, BufRead};

use zstd::zstd_safe::{DCtx, InBuffer, OutBuffer, ResetDirective};

use super::damage::DamageKind;
use super::record::Compression;

/// Up to this stated size the buffer is allocated at once, which lets zstd work without a window of its own.
const ONE_SHOT_LIMIT: usize = 16 * 1024 * 1024;
/// Initial size of a growing buffer.
const FIRST_PIECE: usize = 4 * 1024 * 1024;

/// Reusable state of the decompressors.
pub(super) struct Decompressor {
    zstd: DCtx<'static>,
}

impl Decompressor {
    pub(super) fn new() -> Self {
        Self { zstd: DCtx::create() }
    }

    /// Decompresses `stored` into the cleared `content`, which must become `content_len` long unless `stored` is truncated.
    pub(super) fn decompress(
        &mut self,
        compression: Compression,
        stored: &[u8],
        content_len: usize,
        is_cut: bool,
        content: &mut Vec<u8>,
    ) -> Result<(), DamageKind> {
        content.clear();
        let result = match compression {
            Compression::None => {
                content.extend_from_slice(stored);
                Ok(())
            }
            Compression::Zstd if !is_cut && content_len <= ONE_SHOT_LIMIT => {
                content.reserve_exact(content_len);
                match self.zstd.decompress(content, stored) {
                    Ok(_) => Ok(()),
                    Err(_) => Err(DamageKind::ChunkDecompression),
                }
            }
            Compression::Zstd => self.stream_zstd(stored, content_len, content),
            Compression::Lz4 => stream_lz4(stored, content_len, content),
        };
        if is_cut {
            // The decompressed part of a truncated chunk is valid, whatever follows.
            content.truncate(content_len);
            return Ok(());
        }
        result?;
        if content.len() == content_len { Ok(()) } else { Err(DamageKind::ChunkSize) }
    }

    fn stream_zstd(&mut self, stored: &[u8], content_len: usize, content: &mut Vec<u8>) -> Result<(), DamageKind> {
        let failed = |_| DamageKind::ChunkDecompression;
        self.zstd.reset(ResetDirective::SessionOnly).map_err(failed)?;
        let mut input = InBuffer::around(stored);
        loop {
            if content.len() == content.capacity() {
                make_room(content, content_len);
            }
            let filled = content.len();
            let consumed = input.pos();
            let mut output = OutBuffer::around_pos(content, filled);
            let result = self.zstd.decompress_stream(&mut output, &mut input);
            result.map_err(failed)?;
            if content.len() > content_len {
                return Err(DamageKind::ChunkSize);
            }
            if content.len() == filled && input.pos() == consumed {
                return Ok(());
            }
        }
    }
}

/// Doubles a full buffer, but not beyond `content_len`.
fn make_room(content: &mut Vec<u8>, content_len: usize) {
    let left = content_len.saturating_sub(content.len());
    content.reserve_exact(content.len().max(FIRST_PIECE).min(left));
}

fn stream_lz4(stored: &[u8], content_len: usize, content: &mut Vec<u8>) -> Result<(), DamageKind> {
    let mut decoder = lz4_flex::frame::FrameDecoder::new(stored);
    loop {
        let piece = match decoder.fill_buf() {
            Ok([]) => return Ok(()),
            Ok(piece) => piece,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(_) => return Err(DamageKind::ChunkDecompression),
        };
        let length = piece.len();
        if length > content_len.saturating_sub(content.len()) {
            return Err(DamageKind::ChunkSize);
        }
        if content.capacity() - content.len() < length {
            make_room(content, content_len);
        }
        content.extend_from_slice(piece);
        decoder.consume(length);
    }
}
