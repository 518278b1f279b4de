//! Recordings: one or several MCAP files as one stream of messages in the order of their log time.
//!
//! The module reads logs from the field: truncated when the recorder lost power, damaged on the disk, split into several files, written topic by
//! topic. Everything readable is read, and the rest is counted in [`Damage`]; only a file that is not MCAP at all, or that the operating system
//! cannot read, is a [`RecordingError`].
//!
//! The meaning of a message's bytes, and the treatment of gaps, are handled elsewhere. The indexes in the file are not used, so that a wrong index
//! cannot hide messages.
//!
//! # Bounds
//!
//! - Memory: 40 MiB of chunks that overlap in time and 8 MiB of read-ahead, both decompressed, plus one chunk as stored and the recycled buffers. It
//!   takes more only for a single chunk that is larger than that, up to [`CHUNK_LIMIT_BYTES`], beyond which a chunk counts as damaged. In addition,
//!   about 80 bytes per chunk of the recording.
//! - Order: exact as long as the overlapping chunks fit into these 40 MiB and the times in the chunks' headers do not begin too late; otherwise
//!   messages come as early as possible, and [`Recording::late_count`] counts late ones.
//! - One thread reads and decompresses ahead; it starts with the first requested message and ends with the [`Recording`].
//!
//! # What is trusted
//!
//! A chunk with a checksum is delivered only if it matches. A chunk without one, or a truncated one, is delivered as far as its records are complete.
//! Messages outside chunks have no checksum of their own: if that of the data section does not match, they are delivered and [`Damage`] reports it.

mod attachment;
mod channels;
mod damage;
mod decompress;
mod deliver;
mod error;
mod load;
mod merge;
mod open;
mod reader;
mod record;
mod scan;
mod segment;
mod structure;
mod window;

use std::path::Path;
use std::sync::Arc;

pub use self::attachment::{ATTACHMENT_LIMIT_BYTES, Attachment, AttachmentInfo};
pub use self::channels::{Channel, Schema};
pub use self::damage::{Damage, DamageKind, DamagedPlace, FileDamage, FileEnd, PLACES_KEPT};
pub use self::error::RecordingError;
pub(crate) use self::open::open_file;
pub use self::scan::Metadata;
pub use self::segment::CHUNK_LIMIT_BYTES;

use self::channels::ChannelTable;
use self::merge::Merge;
use self::reader::Reader;
pub(crate) use self::reader::SourceFile;
use self::scan::AttachmentPlace;
use self::segment::Segment;
use crate::log::Chunks;

/// A message, borrowed from the recording until the next one is requested.
#[derive(Debug, Clone, Copy)]
pub struct Message<'a> {
    /// Its channel.
    pub channel: &'a Arc<Channel>,
    /// Its sequence number from the publisher.
    pub sequence: u32,
    /// Time of recording.
    pub log_time_nanos: u64,
    /// Time of publication.
    pub publish_time_nanos: u64,
    /// Its content, in the channel's encoding.
    pub data: &'a [u8],
}

/// The message counts of a file.
#[derive(Debug, Clone, Copy)]
struct FileCount {
    /// Count in its own statistics.
    expected: Option<u64>,
    /// Count in the readable segments.
    found: u64,
    /// Whether all its chunks were searched for a missing channel.
    is_searched: bool,
}

/// Two files of a recording that contain messages of the same time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Overlap<'a> {
    /// The file that begins first.
    pub earlier: &'a Path,
    /// The other file.
    pub later: &'a Path,
    /// First and last log time that both cover.
    pub log_time_nanos: (u64, u64),
}

/// Messages that were delivered after a later one.
#[derive(Debug, Clone, Copy, Default)]
struct Late {
    latest_nanos: u64,
    count: u64,
    most_nanos: u64,
}

/// One or several MCAP files, read as one recording.
///
/// ```no_run
/// use fric_log::recording::Recording;
///
/// let mut recording = Recording::open(&["run_0.mcap", "run_1.mcap"])?;
/// while let Some(message) = recording.next_message()? {
///     println!("{} {}", message.log_time_nanos, message.channel.topic);
/// }
/// if !recording.damage().is_empty() {
///     eprintln!("{}", recording.damage());
/// }
/// # Ok::<(), fric_log::recording::RecordingError>(())
/// ```
pub struct Recording {
    files: Arc<[SourceFile]>,
    segments: Arc<[Segment]>,
    channels: ChannelTable,
    attachments: Vec<(usize, AttachmentPlace)>,
    metadata: Vec<Metadata>,
    counts: Vec<FileCount>,
    damage: Damage,
    merge: Merge,
    reader: Option<Reader>,
    late: Late,
    bytes_read: u64,
}

impl std::fmt::Debug for Recording {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recording")
            .field("files", &self.damage.files())
            .field("channels", &self.channels.channels())
            .finish_non_exhaustive()
    }
}

impl Recording {
    /// Opens the files of one recording, in any order, and determines their content without reading their chunks.
    ///
    /// # Errors
    ///
    /// Returns a [`RecordingError`] if no file is named, or one of them cannot be opened or read, is empty, or is not MCAP. Damage is not an error.
    pub fn open<P: AsRef<Path>>(paths: &[P]) -> Result<Self, RecordingError> {
        let paths: Vec<&Path> = paths.iter().map(AsRef::as_ref).collect();
        open::open(&paths)
    }

    /// Creates the same from open files, with their names for people.
    pub(crate) fn of_files(files: Vec<SourceFile>) -> Result<Self, RecordingError> {
        open::open_sources(files)
    }

    /// Returns the channels known so far, each at the index [`Channel::id`].
    ///
    /// For a file with a complete summary all of them are known from the start; others are appended when the chunks that define them are read.
    #[must_use]
    pub fn channels(&self) -> &[Arc<Channel>] {
        self.channels.channels()
    }

    /// Returns the attachments of the recording.
    #[must_use]
    pub fn attachments(&self) -> impl ExactSizeIterator<Item = AttachmentInfo> {
        self.attachments.iter().map(|(_, place)| AttachmentInfo::new(place))
    }

    /// Reads the attachments of a name, one of each file that has it: the last one if there are several in it.
    ///
    /// # Errors
    ///
    /// Returns a [`RecordingError`] if an attachment cannot be read, does not match its checksum, or exceeds [`ATTACHMENT_LIMIT_BYTES`].
    pub fn attachments_named(&self, name: &str) -> Result<Vec<Attachment>, RecordingError> {
        let of_file = |(file, source)| {
            let mut places = self.attachments.iter().rev();
            let (_, place) = places.find(|(of, place)| *of == file && place.name == name)?;
            Some(attachment::read_attachment(source, place))
        };
        self.files.iter().enumerate().filter_map(of_file).collect()
    }

    /// Returns the metadata records of all files.
    #[must_use]
    pub fn metadata(&self) -> &[Metadata] {
        &self.metadata
    }

    /// Returns the unreadable parts, complete when all messages have been read.
    #[must_use]
    pub fn damage(&self) -> &Damage {
        &self.damage
    }

    /// Returns the first and the last log time from the chunks' headers; `None` if there are no messages.
    #[must_use]
    pub fn log_time_range_nanos(&self) -> Option<(u64, u64)> {
        let segments = || self.segments.iter().filter(|segment| !segment.is_blank());
        let start = segments().map(|segment| segment.start_time_nanos).min()?;
        let end = segments().map(|segment| segment.end_time_nanos).max()?;
        Some((start, end))
    }

    /// Returns its chunks, from their headers; `None` if there are none.
    #[must_use]
    pub fn chunks(&self) -> Option<Chunks> {
        let mut chunks = Chunks::default();
        for segment in self.segments.iter().filter(|segment| segment.is_chunk) {
            chunks.count += 1;
            chunks.stored_bytes += segment.stored_len;
            chunks.content_bytes = chunks.content_bytes.saturating_add(segment.content_len);
            let compression = segment.compression.name();
            if !chunks.compressions.contains(&compression) {
                chunks.compressions.push(compression);
            }
        }
        (chunks.count > 0).then_some(chunks)
    }

    /// Returns files that are probably not parts of one recording: pairs whose times in the chunks' headers overlap by more than a tenth of the
    /// shorter one. Each file is compared with the preceding one that lasts longest. At the boundary of a split recording a few messages may be
    /// swapped.
    #[must_use]
    pub fn overlaps(&self) -> Vec<Overlap<'_>> {
        let mut overlaps = Vec::new();
        let mut longest: Option<(&Path, (u64, u64))> = None;
        for (place, file) in self.files.iter().enumerate() {
            let own = self.segments.iter().filter(|segment| segment.file as usize == place && !segment.is_blank());
            let range = own.map(|segment| (segment.start_time_nanos, segment.end_time_nanos));
            let Some((start, end)) = range.reduce(|(start, end), (from, to)| (start.min(from), end.max(to))) else {
                continue;
            };
            if let Some((earlier, (earlier_start, earlier_end))) = longest {
                let to = end.min(earlier_end);
                let shorter = (end.saturating_sub(start)).min(earlier_end.saturating_sub(earlier_start));
                if to.saturating_sub(start) > shorter / 10 {
                    overlaps.push(Overlap { earlier, later: &file.path, log_time_nanos: (start, to) });
                }
            }
            if longest.is_none_or(|(_, (_, longest_end))| end > longest_end) {
                longest = Some((&file.path, (start, end)));
            }
        }
        overlaps
    }

    /// Returns the number of messages that the files state, if all of them state it.
    #[must_use]
    pub fn expected_message_count(&self) -> Option<u64> {
        self.counts.iter().map(|count| count.expected).sum()
    }

    /// Returns the number of messages that came after one with a later log time.
    #[must_use]
    pub fn late_count(&self) -> u64 {
        self.late.count
    }

    /// Returns the greatest delay of a late message.
    #[must_use]
    pub fn most_late_nanos(&self) -> u64 {
        self.late.most_nanos
    }

    /// Returns the bytes read so far, for a progress bar: [`Self::total_bytes`] at the end.
    #[must_use]
    pub fn bytes_read(&self) -> u64 {
        self.bytes_read
    }

    /// Returns the size of all files.
    #[must_use]
    pub fn total_bytes(&self) -> u64 {
        self.files.iter().map(|source| source.len).sum()
    }

    /// Returns the next message in the order of log time, and at equal times as in the files; `None` at the end.
    ///
    /// # Errors
    ///
    /// Returns a [`RecordingError`] if an opened file can no longer be read. The next call continues after the affected part.
    #[inline]
    pub fn next_message(&mut self) -> Result<Option<Message<'_>>, RecordingError> {
        let Some((dense, head)) = self.find_next()? else {
            return Ok(None);
        };
        let Some(channel) = self.channels.get(dense) else {
            return Ok(None);
        };
        Ok(Some(Message {
            channel,
            sequence: head.fields.sequence,
            log_time_nanos: head.fields.log_time_nanos,
            publish_time_nanos: head.fields.publish_time_nanos,
            data: self.merge.payload(&head),
        }))
    }
}
