//! Scans the top-level records of one file and notes their positions.
//!
//! The scan reads record headers and definitions, not the content of chunks. Indexes in the file are skipped: they may be missing, wrong or newer
//! than the data, and the scan finds the same without them. It keeps about 80 bytes per chunk, or per mebibyte of messages outside chunks;
//! definitions are kept once each.

use std::collections::{BTreeMap, HashSet};
use std::fs::File;
use std::io;
use std::path::PathBuf;

use super::damage::{DamageKind, DamagedPlace, FileDamage, FileEnd};
use super::record::{
    AttachmentFields, CHUNK_PREFIX_LEN, ChunkFields, Compression, MESSAGE_FIELDS_LEN, MessageFields, RECORD_HEADER_LEN,
    RecordHeader, op, parse_footer, parse_metadata, parse_statistics,
};
use super::segment::Segment;
use super::structure::{MessageBatch, Verdict, find_record, judge, looks_like_message_index};
use super::window::{RunningChecksum, Window, read_into};

/// Number of bytes of messages outside chunks that form one segment.
const RUN_LEN: u64 = 1024 * 1024;
/// Minimum number of bytes of messages outside chunks that are examined together.
const SEQUENCE_LEN: usize = 64 * 1024;
/// Maximum size of a schema, channel or metadata record.
const DEFINITION_LIMIT: u64 = 64 * 1024 * 1024;
/// Number of bytes of an attachment record that are read to find its name.
const ATTACHMENT_PREFIX_LEN: usize = 64 * 1024;
/// Maximum number of gaps that wait for the next segment.
const WAITING_GAPS: usize = 16;

/// A schema or channel record.
#[derive(Debug)]
pub(super) struct Definition {
    pub(super) opcode: u8,
    pub(super) body: Box<[u8]>,
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
    known: HashSet<(u8, Box<[u8]>)>,
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

    fn accept(&mut self, offset: u64, header: RecordHeader, is_repaired: bool) -> io::Result<()> {
        match header.opcode {
            op::MESSAGE => return self.accept_message(offset, header),
            op::SCHEMA | op::CHANNEL => {
                return self.accept_definition(offset, header, is_repaired);
            }
            op::MESSAGE_INDEX => return Ok(()),
            _ => self.close_run(),
        }
        match header.opcode {
            op::CHUNK => {
                // Chunks have checksums of their own and are not read here.
                self.checksum = None;
                self.accept_chunk(offset, header, is_repaired)?;
            }
            op::ATTACHMENT => self.accept_attachment(offset, header)?,
            op::METADATA => self.accept_metadata(offset, header)?,
            op::STATISTICS => {
                let body = self.window.bytes(offset + RECORD_HEADER_LEN, 8)?;
                self.found.message_count = parse_statistics(body);
            }
            // In joined files, data follow again here.
            op::HEADER => self.data_end = None,
            op::DATA_END => {
                let body = self.window.bytes(offset + RECORD_HEADER_LEN, 4)?;
                let checksum = super::record::Fields::new(body).u32().unwrap_or(0);
                self.data_end = Some(DataEnd { offset, checksum });
            }
            op::FOOTER => {
                let body = self.window.bytes(offset + RECORD_HEADER_LEN, 20)?;
                if let Some((summary_start, checksum)) = parse_footer(body) {
                    self.footer = Some(Footer { offset, summary_start, checksum });
                }
            }
            _ => {}
        }
        Ok(())
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

    /// Accepts the unambiguous messages in the window, and stops before anything that needs closer examination.
    fn take_messages(&mut self, offset: u64) -> io::Result<u64> {
        let file_len = self.window.file_len();
        let mut batch = MessageBatch::find(self.window.buffered(offset)?, file_len - offset);
        if batch.count == 0 {
            // The window may only need to advance.
            self.window.bytes(offset, SEQUENCE_LEN)?;
            batch = MessageBatch::find(self.window.buffered(offset)?, file_len - offset);
        }
        if batch.count == 0 {
            return Ok(offset);
        }
        let bytes = self.window.buffered(offset)?;
        if let Some(checksum) = &mut self.checksum {
            checksum.catch_up(self.file, offset)?;
            checksum.add(bytes.get(..batch.len).unwrap_or_default());
        }
        let (run, messages) = self.extend_run(offset, batch.len as u64);
        run.start_time_nanos = run.start_time_nanos.min(batch.start_time_nanos);
        run.end_time_nanos = run.end_time_nanos.max(batch.end_time_nanos);
        *messages += batch.count;
        Ok(offset + batch.len as u64)
    }

    fn accept_message(&mut self, offset: u64, header: RecordHeader) -> io::Result<()> {
        let body = self.window.bytes(offset + RECORD_HEADER_LEN, MESSAGE_FIELDS_LEN)?;
        // After the index of a chunk, or in the summary, no message is expected: it is a damaged record of these.
        let is_index = matches!(self.last_opcode, op::CHUNK | op::MESSAGE_INDEX)
            && looks_like_message_index(body, header.body_len);
        if is_index || self.data_end.is_some() {
            self.place(DamageKind::Garbage, offset, RECORD_HEADER_LEN + header.body_len);
            return Ok(());
        }
        let Some(message) = MessageFields::parse(body) else {
            return Ok(());
        };
        let (run, messages) = self.extend_run(offset, RECORD_HEADER_LEN + header.body_len);
        run.start_time_nanos = run.start_time_nanos.min(message.log_time_nanos);
        run.end_time_nanos = run.end_time_nanos.max(message.log_time_nanos);
        *messages += 1;
        Ok(())
    }

    fn accept_definition(&mut self, offset: u64, header: RecordHeader, is_repaired: bool) -> io::Result<()> {
        let is_summary = self.data_end.is_some();
        if is_repaired {
            // A run is loaded as it is in the file, where the header is still wrong.
            self.close_run();
        } else if !is_summary {
            self.extend_run(offset, RECORD_HEADER_LEN + header.body_len);
        }
        if !self.read_body(offset, header)? {
            return Ok(());
        }
        let body: Box<[u8]> = self.buffer.as_slice().into();
        if self.known.insert((header.opcode, body.clone())) {
            let definition = Definition { opcode: header.opcode, body, offset_bytes: offset };
            if is_summary {
                self.found.summary_definitions.push(definition);
            } else {
                self.found.definitions.push(definition);
            }
        }
        Ok(())
    }

    /// Reads a body into the buffer. If it is too large, records the damage and returns false.
    fn read_body(&mut self, offset: u64, header: RecordHeader) -> io::Result<bool> {
        let length = usize::try_from(header.body_len).ok();
        let Some(length) = length.filter(|_| header.body_len <= DEFINITION_LIMIT) else {
            self.place(DamageKind::Definition, offset, header.body_len + RECORD_HEADER_LEN);
            return Ok(false);
        };
        read_into(self.file, &mut self.buffer, offset + RECORD_HEADER_LEN, length)?;
        Ok(true)
    }

    fn accept_chunk(&mut self, offset: u64, header: RecordHeader, is_repaired: bool) -> io::Result<()> {
        let body_offset = offset + RECORD_HEADER_LEN;
        let Some(chunk) = ChunkFields::parse(self.window.bytes(body_offset, CHUNK_PREFIX_LEN)?) else {
            self.gap(offset, header.body_len + RECORD_HEADER_LEN);
            return Ok(());
        };
        // After the content there may be fields of a newer format, unless the header itself was repaired.
        let body_len = match chunk.body_len() {
            Some(body_len) if !is_repaired => body_len,
            _ => header.body_len,
        };
        let body_end = body_offset.saturating_add(body_len);
        let content_offset_bytes = body_offset + chunk.content_at;
        let stored_end = body_end.min(self.window.file_len());
        self.push_segment(Segment {
            file: 0,
            rank: 0,
            offset_bytes: offset,
            content_offset_bytes,
            stored_len: stored_end.saturating_sub(content_offset_bytes),
            content_len: chunk.uncompressed_len,
            load_time_nanos: 0,
            start_time_nanos: chunk.start_time_nanos,
            end_time_nanos: chunk.end_time_nanos,
            checksum: chunk.uncompressed_crc,
            compression: chunk.compression,
            is_cut: body_end > self.window.file_len(),
            is_chunk: true,
        });
        Ok(())
    }

    fn accept_attachment(&mut self, offset: u64, header: RecordHeader) -> io::Result<()> {
        let body_offset = offset + RECORD_HEADER_LEN;
        let prefix = self.window.bytes(body_offset, ATTACHMENT_PREFIX_LEN)?;
        let attachment = AttachmentFields::parse(prefix)
            .filter(|fields| fields.body_len().is_some_and(|len| len <= header.body_len));
        if let Some(fields) = attachment {
            let place = AttachmentPlace {
                name: fields.name.to_owned(),
                media_type: fields.media_type.to_owned(),
                log_time_nanos: fields.log_time_nanos,
                create_time_nanos: fields.create_time_nanos,
                offset_bytes: offset,
                data_at: RECORD_HEADER_LEN + fields.data_at,
                data_len: fields.data_len,
            };
            self.found.attachments.push(place);
        } else {
            self.place(DamageKind::Definition, offset, header.body_len + RECORD_HEADER_LEN);
        }
        Ok(())
    }

    fn accept_metadata(&mut self, offset: u64, header: RecordHeader) -> io::Result<()> {
        if !self.read_body(offset, header)? {
            return Ok(());
        }
        match parse_metadata(&self.buffer) {
            Some((name, entries)) => self.found.metadata.push(Metadata { name: name.to_owned(), entries }),
            None => self.place(DamageKind::Definition, offset, header.body_len + RECORD_HEADER_LEN),
        }
        Ok(())
    }

    fn finish(&mut self) -> io::Result<()> {
        self.close_run();
        self.close_gaps(None);
        let end = match (self.data_end, self.footer) {
            (_, Some(_)) if self.has_closing_magic => FileEnd::Complete,
            (None, None) if !self.has_closing_magic => FileEnd::MessagesCut,
            (None, None) => FileEnd::Complete,
            _ => FileEnd::SummaryCut,
        };
        self.found.damage.set_end(end);
        self.check_summary()?;
        self.check_data()
    }

    fn check_summary(&mut self) -> io::Result<()> {
        let Some(footer) = self.footer else {
            return Ok(());
        };
        if footer.checksum == 0 {
            return Ok(());
        }
        // The checksum covers the footer up to itself.
        let end = footer.offset + RECORD_HEADER_LEN + 16;
        let start = if footer.summary_start == 0 { footer.offset } else { footer.summary_start };
        let is_place =
            start <= footer.offset && self.found.segments.last().is_none_or(|last| last.end_offset_bytes() <= start);
        if !is_place || RunningChecksum::of(self.file, start, end)? != footer.checksum {
            self.place(DamageKind::SummaryChecksum, footer.offset, 0);
            self.found.summary_definitions.clear();
            self.found.message_count = None;
        }
        Ok(())
    }

    /// Checks the data section. Its checksum is the only one that covers messages outside chunks.
    fn check_data(&mut self) -> io::Result<()> {
        let (Some(data_end), Some(mut checksum)) = (self.data_end, self.checksum.take()) else {
            return Ok(());
        };
        let is_intact = self.found.damage.place_count() == 0;
        if data_end.checksum == 0 || !is_intact || self.found.segments.is_empty() {
            return Ok(());
        }
        checksum.catch_up(self.file, data_end.offset)?;
        if checksum.finish() != data_end.checksum {
            self.place(DamageKind::DataChecksum, data_end.offset, 0);
        }
        Ok(())
    }
}
