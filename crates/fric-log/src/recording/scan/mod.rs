//! Scans the top-level records of one file and notes their positions.
//!
//! The scan reads record headers and definitions, not the content of chunks. Indexes in the file are skipped: they may be missing, wrong or newer
//! than the data, and the scan finds the same without them. It keeps about 80 bytes per chunk, or per mebibyte of messages outside chunks;
//! definitions are kept once each, and no more of them than any robot's log has.

mod accept;
mod end;

use std::collections::{BTreeMap, HashSet};
use std::fs::File;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use crate::recording::damage::{DamageKind, DamagedPlace, FileDamage};
use crate::recording::record::{Compression, RECORD_HEADER_LEN, RecordHeader, op};
use crate::recording::segment::Segment;
use crate::recording::structure::{Verdict, find_record, judge};
use crate::recording::window::{RunningChecksum, Window};

/// Number of bytes of messages outside chunks that form one segment.
const RUN_LEN: u64 = 1024 * 1024;

/// Maximum number of gaps that wait for the next segment.
const WAITING_GAPS: usize = 16;

/// A schema or channel record.
#[derive(Debug)]
pub(super) struct Definition {
    pub(super) opcode: u8,
    pub(super) body: Arc<[u8]>,
    pub(super) offset_bytes: u64,
}

/// An attachment record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct AttachmentPlace {
    pub(super) name: String,
    pub(super) media_type: String,
    pub(super) log_time_nanos: u64,
    pub(super) create_time_nanos: u64,
    pub(super) offset_bytes: u64,
    /// Offset of its data from the start of the record.
    pub(super) data_at: u64,
    pub(super) data_len: u64,
}

/// A metadata record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Metadata {
    /// Its name.
    pub name: String,
    /// Its entries.
    pub entries: BTreeMap<String, String>,
}

/// The result of the scan.
pub(super) struct FileScan {
    pub(super) segments: Vec<Segment>,
    pub(super) definitions: Vec<Definition>,
    pub(super) summary_definitions: Vec<Definition>,
    pub(super) attachments: Vec<AttachmentPlace>,
    pub(super) metadata: Vec<Metadata>,
    /// Number of messages that the file states.
    pub(super) message_count: Option<u64>,
    pub(super) damage: FileDamage,
    /// Whether anything was recognised at all.
    pub(super) is_mcap: bool,
}

/// Scans a file.
///
/// # Errors
///
/// Returns the error of the operating system, with the offset that the scan had reached.
pub(super) fn scan(file: &File, file_len: u64, path: PathBuf) -> Result<FileScan, (u64, io::Error)> {
    let mut scanner = Scanner::new(file, file_len, path);
    let result = scanner.walk().and_then(|()| scanner.finish());
    result.map_err(|error| (scanner.offset, error))?;
    Ok(scanner.found)
}

#[derive(Clone, Copy)]
struct DataEnd {
    offset: u64,
    checksum: u32,
}

#[derive(Clone, Copy)]
struct Footer {
    offset: u64,
    summary_start: u64,
    checksum: u32,
}

struct Scanner<'a> {
    file: &'a File,
    window: Window<'a>,
    found: FileScan,
    /// Known definitions, because they are often repeated.
    known: HashSet<(u8, Arc<[u8]>)>,
    /// Size of what is kept of definitions, metadata and attachments, bytes.
    kept_bytes: u64,
    /// Messages outside chunks that are being collected, with their count.
    run: Option<(Segment, u64)>,
    gaps: Vec<DamagedPlace>,
    /// Checksum of the data section, as long as there are no chunks.
    checksum: Option<RunningChecksum>,
    data_end: Option<DataEnd>,
    footer: Option<Footer>,
    has_closing_magic: bool,
    buffer: Vec<u8>,
    /// Opcode of the last accepted record.
    last_opcode: u8,
    /// Position of the scan.
    offset: u64,
}

impl<'a> Scanner<'a> {
    fn new(file: &'a File, file_len: u64, path: PathBuf) -> Self {
        Self {
            file,
            window: Window::new(file, file_len),
            found: FileScan {
                segments: Vec::new(),
                definitions: Vec::new(),
                summary_definitions: Vec::new(),
                attachments: Vec::new(),
                metadata: Vec::new(),
                message_count: None,
                damage: FileDamage::new(path),
                is_mcap: false,
            },
            known: HashSet::new(),
            kept_bytes: 0,
            run: None,
            gaps: Vec::new(),
            checksum: Some(RunningChecksum::default()),
            data_end: None,
            footer: None,
            has_closing_magic: false,
            buffer: Vec::new(),
            last_opcode: 0,
            offset: 0,
        }
    }

    fn walk(&mut self) -> io::Result<()> {
        let file_len = self.window.file_len();
        let magic_len = mcap::MAGIC.len() as u64;
        let mut offset = 0;
        if self.window.bytes(0, mcap::MAGIC.len())? == mcap::MAGIC {
            self.found.is_mcap = true;
            offset = magic_len;
        } else if find_record(&mut self.window, magic_len)? == Some(magic_len) {
            self.place(DamageKind::Magic, 0, 0);
            offset = magic_len;
        }
        while offset < file_len {
            self.offset = offset;
            offset = self.step(offset)?;
        }
        Ok(())
    }

    /// Processes the record at `offset` and returns where to continue.
    fn step(&mut self, offset: u64) -> io::Result<u64> {
        if self.run.is_some() && self.data_end.is_none() {
            let end = self.take_messages(offset)?;
            if end > offset {
                return Ok(end);
            }
        }
        let file_len = self.window.file_len();
        let rest = file_len - offset;
        if rest <= mcap::MAGIC.len() as u64 {
            let bytes = self.window.bytes(offset, mcap::MAGIC.len())?;
            if mcap::MAGIC.starts_with(bytes) {
                self.has_closing_magic = bytes == mcap::MAGIC;
                return Ok(file_len);
            }
        }
        let end_of = |header: RecordHeader| offset.saturating_add(RECORD_HEADER_LEN + header.body_len);
        match judge(&mut self.window, offset)? {
            Verdict::Whole { header, repaired } => {
                if repaired {
                    self.place(DamageKind::HeaderRepaired, offset, 0);
                }
                self.found.is_mcap = true;
                self.accept(offset, header, repaired)?;
                // A damaged message index does not interrupt its sequence.
                if header.opcode != op::MESSAGE || self.run.is_some() {
                    self.last_opcode = header.opcode;
                }
                Ok(end_of(header))
            }
            Verdict::BrokenChunk { body_len } => {
                let lost = RECORD_HEADER_LEN + body_len;
                self.gap(offset, lost);
                Ok(offset + lost)
            }
            Verdict::Cut(header) if header.opcode == op::CHUNK => {
                self.found.is_mcap = true;
                self.accept(offset, header, false)?;
                Ok(file_len)
            }
            Verdict::Cut(_) => self.resume(offset, offset + 1, false),
            Verdict::Suspect(header) => {
                let end = end_of(header);
                if find_record(&mut self.window, offset + 1)?.is_some() {
                    return self.resume(offset, offset + 1, true);
                }
                // Only garbage follows up to the end of the file, so the message itself is the last good one.
                self.accept(offset, header, false)?;
                self.resume(end, end, true)
            }
            Verdict::None => {
                let is_rubbish = self
                    .window
                    .bytes(offset, 1)?
                    .first()
                    .is_some_and(|opcode| !(op::HEADER..=op::DATA_END).contains(opcode));
                self.resume(offset, offset + 1, is_rubbish)
            }
        }
    }

    /// Searches the next record from `search_from` on and counts the bytes between as lost.
    fn resume(&mut self, offset: u64, search_from: u64, is_rubbish: bool) -> io::Result<u64> {
        let next = find_record(&mut self.window, search_from)?;
        let end = next.unwrap_or(self.window.file_len());
        if next.is_some() || is_rubbish || self.footer.is_some() {
            self.gap(offset, end - offset);
        } else {
            // A record that began properly and is truncated by the end of the file is not a damaged place of its own.
            self.found.damage.add_lost_bytes(end - offset);
        }
        Ok(end)
    }

    fn place(&mut self, kind: DamageKind, offset_bytes: u64, lost_bytes: u64) {
        self.found.damage.add(DamagedPlace { kind, offset_bytes, lost_bytes, log_time_nanos: None });
    }

    /// Records unreadable bytes; the time they cover is known only with the next segment.
    fn gap(&mut self, offset_bytes: u64, lost_bytes: u64) {
        self.close_run();
        if self.gaps.len() >= WAITING_GAPS {
            self.close_gaps(None);
        }
        self.gaps.push(DamagedPlace { kind: DamageKind::Garbage, offset_bytes, lost_bytes, log_time_nanos: None });
    }

    fn close_gaps(&mut self, next_start_nanos: Option<u64>) {
        let last_end = self.found.segments.last().map(|last| last.end_time_nanos);
        let between = last_end.zip(next_start_nanos).filter(|(from, to)| from <= to);
        for mut gap in self.gaps.drain(..) {
            gap.log_time_nanos = between;
            self.found.damage.add(gap);
        }
    }

    fn push_segment(&mut self, mut segment: Segment) {
        self.close_gaps(Some(segment.start_time_nanos));
        // The times in a chunk's header have no checksum. A start that is wrongly late would make its messages late, while one that is too early
        // costs little. So the end of the previous segment, where most chunks continue, is considered too.
        let last = self.found.segments.last().filter(|last| !last.is_blank());
        let last_end = last.map_or(u64::MAX, |last| last.end_time_nanos);
        segment.load_time_nanos = segment.start_time_nanos.min(segment.end_time_nanos).min(last_end);
        self.found.segments.push(segment);
    }

    fn close_run(&mut self) {
        if let Some((segment, messages)) = self.run.take()
            && messages > 0
        {
            self.push_segment(segment);
        }
    }

    fn extend_run(&mut self, offset: u64, total_len: u64) -> &mut (Segment, u64) {
        let is_full =
            self.run.as_ref().is_some_and(|(run, _)| run.end_offset_bytes() != offset || run.stored_len >= RUN_LEN);
        if is_full {
            self.close_run();
        }
        let run = self.run.get_or_insert_with(|| {
            let run = Segment {
                file: 0,
                rank: 0,
                offset_bytes: offset,
                content_offset_bytes: offset,
                stored_len: 0,
                content_len: 0,
                load_time_nanos: 0,
                start_time_nanos: u64::MAX,
                end_time_nanos: 0,
                checksum: 0,
                compression: Compression::None,
                is_cut: false,
                is_chunk: false,
            };
            (run, 0)
        });
        run.0.stored_len += total_len;
        run.0.content_len = run.0.stored_len;
        run
    }
}
