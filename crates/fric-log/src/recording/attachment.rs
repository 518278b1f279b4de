//! Files stored inside a recording.

use super::error::RecordingError;
use super::reader::SourceFile;
use super::scan::AttachmentPlace;
use super::window::{read_into, read_up_to};

/// The largest attachment that is read into memory.
pub const ATTACHMENT_LIMIT_BYTES: u64 = 64 * 1024 * 1024;

/// Name and size of an attachment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AttachmentInfo {
    /// Its name.
    pub name: String,
    /// Its media type, for example `application/toml`.
    pub media_type: String,
    /// Time of recording.
    pub log_time_nanos: u64,
    /// Time of creation.
    pub create_time_nanos: u64,
    /// Its size.
    pub size_bytes: u64,
}

impl AttachmentInfo {
    pub(super) fn new(place: &AttachmentPlace) -> Self {
        Self {
            name: place.name.clone(),
            media_type: place.media_type.clone(),
            log_time_nanos: place.log_time_nanos,
            create_time_nanos: place.create_time_nanos,
            size_bytes: place.data_len,
        }
    }
}

/// An attachment with its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Its name and size.
    pub info: AttachmentInfo,
    /// Its content.
    pub data: Vec<u8>,
}

/// Reads an attachment and verifies it.
pub(super) fn read_attachment(source: &SourceFile, place: &AttachmentPlace) -> Result<Attachment, RecordingError> {
    let failed = |error| source.read_error(place.offset_bytes, error);
    let length = usize::try_from(place.data_len).ok().filter(|_| place.data_len <= ATTACHMENT_LIMIT_BYTES);
    let (Some(length), Ok(data_at)) = (length, usize::try_from(place.data_at)) else {
        return Err(RecordingError::AttachmentTooLarge {
            name: place.name.clone(),
            path: source.path.clone(),
            offset_bytes: place.offset_bytes,
            size_bytes: place.data_len,
            limit_bytes: ATTACHMENT_LIMIT_BYTES,
        });
    };
    let mut prefix = Vec::new();
    read_into(&source.file, &mut prefix, place.offset_bytes, data_at).map_err(failed)?;
    let data_offset = place.offset_bytes + place.data_at;
    let mut data = Vec::new();
    read_into(&source.file, &mut data, data_offset, length).map_err(failed)?;
    let mut stored = [0; 4];
    read_up_to(&source.file, &mut stored, data_offset + place.data_len).map_err(failed)?;

    let expected = u32::from_le_bytes(stored);
    let mut hasher = crc32fast::Hasher::new();
    // The checksum covers the record's body, not its header.
    hasher.update(prefix.get(super::record::HEADER_LEN..).unwrap_or_default());
    hasher.update(&data);
    let found = hasher.finalize();
    if expected != 0 && expected != found {
        return Err(RecordingError::AttachmentChecksum {
            name: place.name.clone(),
            path: source.path.clone(),
            offset_bytes: place.offset_bytes,
            expected,
            found,
        });
    }
    Ok(Attachment { info: AttachmentInfo::new(place), data })
}
