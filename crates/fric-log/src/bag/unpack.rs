//! Decompresses messages and files that the recorder compressed.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Seek, SeekFrom};
use std::path::Path;

use tempfile::NamedTempFile;

use crate::recording::CHUNK_LIMIT_BYTES;

/// The first bytes of compressed data; a CDR message begins with a zero.
const MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Decompresses those messages that are compressed.
#[derive(Debug, Default)]
pub(crate) struct Unpacker {
    content: Vec<u8>,
    /// Number of messages that could not be decompressed.
    pub lost_count: u64,
}

impl Unpacker {
    /// Returns the content of a message; empty for a damaged one, which no decoder accepts.
    pub fn content<'a>(&'a mut self, data: &'a [u8]) -> &'a [u8] {
        if !data.starts_with(&MAGIC) {
            return data;
        }
        self.content.clear();
        let limit = zstd::zstd_safe::get_frame_content_size(data).ok().flatten().unwrap_or(CHUNK_LIMIT_BYTES);
        let unpacked =
            if limit > CHUNK_LIMIT_BYTES { Err(io::ErrorKind::InvalidData.into()) } else { self.decode(data) };
        if unpacked.is_err() {
            self.lost_count += 1;
            self.content.clear();
        }
        &self.content
    }

    /// Returns a warning if messages could not be decompressed.
    pub fn warning(&self) -> Option<String> {
        let count = self.lost_count;
        let messages =
            if count == 1 { "1 compressed message is".to_owned() } else { format!("{count} compressed messages are") };
        (count > 0).then(|| format!("{messages} damaged, and left out"))
    }

    fn decode(&mut self, data: &[u8]) -> io::Result<()> {
        let decoder = zstd::stream::read::Decoder::new(data)?;
        let read = io::Read::read_to_end(&mut io::Read::take(decoder, CHUNK_LIMIT_BYTES + 1), &mut self.content)?;
        if read as u64 > CHUNK_LIMIT_BYTES { Err(io::ErrorKind::InvalidData.into()) } else { Ok(()) }
    }
}

/// Greatest size to which a file is decompressed, bytes: this, or as many times its own size as no recording is compressed.
const UNPACKED_BYTES: u64 = 256 << 20;
const MOST_COMPRESSED: u64 = 1000;

/// Decompresses a whole file into a temporary one. Also returns a remark if some of it is missing.
pub(super) fn unpacked(path: &Path, file: File) -> io::Result<(NamedTempFile, Option<String>)> {
    let mut target = NamedTempFile::new()?;
    let most_bytes = UNPACKED_BYTES.max(MOST_COMPRESSED.saturating_mul(file.metadata()?.len()));
    let decoder = zstd::stream::read::Decoder::new(BufReader::new(file))?;
    let mut decoder = io::Read::take(decoder, most_bytes + 1);
    let copied = {
        let mut writer = BufWriter::new(target.as_file_mut());
        let copied = io::copy(&mut decoder, &mut writer);
        writer.into_inner().map_err(io::IntoInnerError::into_error)?;
        copied
    };
    let remark = match copied {
        Ok(bytes) if bytes > most_bytes => {
            let text = format!("it unpacks to more than {} MiB", most_bytes >> 20);
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, text));
        }
        Ok(_) => None,
        Err(error) if error.raw_os_error().is_some() => return Err(error),
        Err(_) => Some(format!("`{}` is damaged or cut off: what could be decompressed is read", path.display())),
    };
    target.as_file_mut().seek(SeekFrom::Start(0))?;
    Ok((target, remark))
}
