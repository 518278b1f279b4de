//! Unreadable parts of a recording, and their description for people.
//!
//! The account is bounded: every file keeps counts and the first [`PLACES_KEPT`] places, however damaged it is.

use std::fmt;
use std::path::{Path, PathBuf};

/// Maximum number of places stored per file; the rest are only counted.
pub const PLACES_KEPT: usize = 16;

/// The kind of damage at one place of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DamageKind {
    /// The file does not begin with the MCAP magic bytes.
    Magic,
    /// Bytes that are no record, or a record whose structure is broken.
    Garbage,
    /// The length or the kind of a record was wrong; the record was recovered from its other lengths.
    HeaderRepaired,
    /// The checksum of a chunk does not match its content; none of its messages is delivered.
    ChunkChecksum,
    /// A chunk cannot be decompressed; none of its messages is delivered.
    ChunkDecompression,
    /// A chunk's content is shorter or longer than its header states; none of its messages is delivered.
    ChunkSize,
    /// A chunk claims to be larger than [`CHUNK_LIMIT_BYTES`](super::CHUNK_LIMIT_BYTES); it is not read.
    ChunkTooLarge,
    /// A chunk is truncated; the messages before the end are delivered.
    ChunkCut,
    /// The records inside a chunk are inconsistent; the messages before the break are delivered.
    ChunkRecords,
    /// A schema or channel record cannot be parsed.
    Definition,
    /// A schema, channel or metadata record is beyond the 32 MiB that are read of them.
    TooLarge,
    /// A schema or channel id is redefined with another content; messages that this makes ambiguous are not delivered.
    Conflict,
    /// Messages of an undefined channel; they are not delivered.
    UnknownChannel,
    /// The checksum of the data section does not match; its messages are delivered, but some may be wrong.
    DataChecksum,
    /// The checksum of the summary section does not match; the summary is not used.
    SummaryChecksum,
}

impl DamageKind {
    fn describe(self) -> &'static str {
        match self {
            Self::Magic => "wrong magic bytes",
            Self::Garbage => "unreadable bytes",
            Self::HeaderRepaired => "a wrong record header, which could be repaired",
            Self::ChunkChecksum => "a chunk with a wrong checksum",
            Self::ChunkDecompression => "a chunk that cannot be decompressed",
            Self::ChunkSize => "a chunk of the wrong size",
            Self::ChunkTooLarge => "a chunk that claims an impossible size",
            Self::ChunkCut => "a chunk that is cut off",
            Self::ChunkRecords => "a chunk with broken records",
            Self::Definition => "a broken schema or channel record",
            Self::TooLarge => "a schema, channel or metadata record beyond the 32 MiB that are read of them",
            Self::Conflict => "a schema or channel id defined twice with different content",
            Self::UnknownChannel => "messages of an unknown channel",
            Self::DataChecksum => "a wrong checksum over all messages, some of which may be wrong",
            Self::SummaryChecksum => "a wrong checksum over the summary, which is not used",
        }
    }
}

/// One damaged place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DamagedPlace {
    /// The kind of damage.
    pub kind: DamageKind,
    /// Position in the file.
    pub offset_bytes: u64,
    /// Number of bytes of the file that are unusable because of it.
    pub lost_bytes: u64,
    /// First and last log time between which messages may be missing, as far as known.
    pub log_time_nanos: Option<(u64, u64)>,
}

/// The completeness of the end of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FileEnd {
    /// The file is complete.
    #[default]
    Complete,
    /// All messages were written, but the summary after them is truncated.
    SummaryCut,
    /// The file ends within the messages: the recorder was stopped abruptly, or the copy did not finish.
    MessagesCut,
}

/// The unreadable parts of one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileDamage {
    path: PathBuf,
    places: Vec<DamagedPlace>,
    place_count: u64,
    lost_bytes: u64,
    /// Messages that were read but cannot be delivered.
    lost_messages: u64,
    /// Messages that the statistics count but that were not read.
    missing_messages: u64,
    last_place: Option<(DamageKind, u64)>,
    log_time_nanos: Option<(u64, u64)>,
    end: FileEnd,
    /// Log time of the first message of the recording, the origin of relative times.
    start_time_nanos: u64,
}

impl FileDamage {
    pub(super) fn new(path: PathBuf) -> Self {
        Self {
            path,
            places: Vec::new(),
            place_count: 0,
            lost_bytes: 0,
            lost_messages: 0,
            missing_messages: 0,
            last_place: None,
            log_time_nanos: None,
            end: FileEnd::Complete,
            start_time_nanos: 0,
        }
    }

    /// Returns the path of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the first [`PLACES_KEPT`] damaged places, in the order in which they were found.
    #[must_use]
    pub fn places(&self) -> &[DamagedPlace] {
        &self.places
    }

    /// Returns the number of damaged places.
    #[must_use]
    pub fn place_count(&self) -> u64 {
        self.place_count
    }

    /// Returns the number of unusable bytes of the file.
    #[must_use]
    pub fn lost_bytes(&self) -> u64 {
        self.lost_bytes
    }

    /// Returns the number of messages known to be lost. It is final only at the end of the recording, and a lower bound if the file has no
    /// statistics.
    #[must_use]
    pub fn lost_messages(&self) -> u64 {
        self.lost_messages.saturating_add(self.missing_messages)
    }

    /// Returns the first and the last log time between which messages may be missing, as far as known.
    #[must_use]
    pub fn log_time_nanos(&self) -> Option<(u64, u64)> {
        self.log_time_nanos
    }

    /// Returns the completeness of the end of the file.
    #[must_use]
    pub fn end(&self) -> FileEnd {
        self.end
    }

    /// Whether the file does not begin like a recording: everything before its first readable record is lost.
    #[must_use]
    pub fn lacks_beginning(&self) -> bool {
        self.places.iter().any(|place| place.offset_bytes == 0)
    }

    /// Whether the file has no damage.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.place_count == 0 && self.lost_messages() == 0 && self.end == FileEnd::Complete
    }

    pub(super) fn add(&mut self, place: DamagedPlace) {
        self.place_count += 1;
        self.last_place = Some((place.kind, place.offset_bytes));
        self.lost_bytes = self.lost_bytes.saturating_add(place.lost_bytes);
        if let Some((from, to)) = place.log_time_nanos {
            let (start, end) = self.log_time_nanos.unwrap_or((from, to));
            self.log_time_nanos = Some((start.min(from), end.max(to)));
        }
        if self.places.len() < PLACES_KEPT {
            self.places.push(place);
        }
    }

    pub(super) fn add_lost_messages(&mut self, count: u64) {
        self.lost_messages = self.lost_messages.saturating_add(count);
    }

    pub(super) fn add_lost_bytes(&mut self, count: u64) {
        self.lost_bytes = self.lost_bytes.saturating_add(count);
    }

    /// Adds a place unless it equals the last one.
    pub(super) fn add_once(&mut self, place: DamagedPlace) {
        if self.last_place != Some((place.kind, place.offset_bytes)) {
            self.add(place);
        }
    }

    /// Sets the number of messages that the statistics count but that were not found.
    pub(super) fn set_missing_messages(&mut self, count: u64) {
        self.missing_messages = count;
    }

    pub(super) fn set_end(&mut self, end: FileEnd) {
        self.end = end;
    }

    pub(super) fn set_start_time(&mut self, start_time_nanos: u64) {
        self.start_time_nanos = start_time_nanos;
    }

    fn write_places(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(first) = self.places.first() else {
            return Ok(());
        };
        let (plural, which) = if self.place_count == 1 { ("", "") } else { ("s", "the first ") };
        let (offset_bytes, kind) = (first.offset_bytes, first.kind.describe());
        write!(f, "{} damaged place{plural} ({which}at byte {offset_bytes}: {kind})", self.place_count)
    }

    fn write_losses(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "; ";
        if self.lost_bytes > 0 {
            write!(f, "{separator}{} bytes skipped", self.lost_bytes)?;
            separator = ", ";
        }
        let lost_messages = self.lost_messages();
        if lost_messages > 0 {
            let plural = if lost_messages == 1 { "" } else { "s" };
            write!(f, "{separator}{lost_messages} message{plural} lost")?;
            separator = ", ";
        }
        if let Some((from, to)) = self.log_time_nanos {
            let from = seconds_after(self.start_time_nanos, from);
            let to = seconds_after(self.start_time_nanos, to);
            let unknown = if separator == "; " { "messages may be missing " } else { "" };
            write!(f, "{separator}{unknown}between {from:.3} s and {to:.3} s after the start")?;
        }
        Ok(())
    }
}

/// Returns the seconds from `start` to `time`, for people.
fn seconds_after(start_nanos: u64, time_nanos: u64) -> f64 {
    #[expect(
        clippy::cast_precision_loss,
        reason = "printed with three decimals; the error is below a nanosecond for a hundred days"
    )]
    let seconds = |nanos: u64| nanos as f64 * 1e-9;
    if time_nanos >= start_nanos { seconds(time_nanos - start_nanos) } else { -seconds(start_nanos - time_nanos) }
}

/// Writes one sentence about the file; empty if it has no damage.
impl fmt::Display for FileDamage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return Ok(());
        }
        write!(f, "`{}` ", self.path.display())?;
        match (self.end, self.places.is_empty()) {
            (FileEnd::Complete, false) => f.write_str("has ")?,
            (FileEnd::Complete, true) => f.write_str("holds fewer messages than it counts")?,
            (FileEnd::SummaryCut, true) => {
                f.write_str("is cut off behind its last message, which loses none")?;
            }
            (FileEnd::SummaryCut, false) => {
                f.write_str("is cut off behind its last message and has ")?;
            }
            (FileEnd::MessagesCut, true) => f.write_str("is cut off, its end is missing")?,
            (FileEnd::MessagesCut, false) => {
                f.write_str("is cut off, its end is missing, and it has ")?;
            }
        }
        self.write_places(f)?;
        self.write_losses(f)
    }
}

/// The unreadable parts of a recording, file by file.
///
/// The account grows while messages are read, because a chunk is checked only when it is reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Damage {
    files: Vec<FileDamage>,
}

impl Damage {
    pub(super) fn new(files: Vec<FileDamage>) -> Self {
        Self { files }
    }

    /// Returns all files of the recording in the order of recording, including undamaged ones.
    #[must_use]
    pub fn files(&self) -> &[FileDamage] {
        &self.files
    }

    /// Whether there is no damage, as far as the recording has been read.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.files.iter().all(FileDamage::is_empty)
    }

    /// Returns the number of damaged places of all files.
    #[must_use]
    pub fn place_count(&self) -> u64 {
        self.files.iter().map(FileDamage::place_count).sum()
    }

    /// Returns the number of messages known to be lost; see [`FileDamage::lost_messages`].
    #[must_use]
    pub fn lost_messages(&self) -> u64 {
        self.files.iter().map(FileDamage::lost_messages).sum()
    }

    /// Whether the end of a file is missing, including messages.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        self.files.iter().any(|file| file.end == FileEnd::MessagesCut)
    }

    pub(super) fn file_mut(&mut self, file: usize) -> Option<&mut FileDamage> {
        self.files.get_mut(file)
    }
}

/// Writes one sentence per damaged file, each on its own line; empty if there is no damage.
impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let damaged = self.files.iter().filter(|file| !file.is_empty());
        for (place, file) in damaged.enumerate() {
            if place > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{file}")?;
        }
        Ok(())
    }
}
