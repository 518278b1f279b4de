//! What each kind of record adds to the result of a scan.

use std::io;
use std::sync::Arc;

use super::{AttachmentPlace, DataEnd, Definition, Footer, Metadata, Scanner};
use crate::recording::damage::DamageKind;
use crate::recording::record::{
    AttachmentFields, CHUNK_PREFIX_LEN, ChunkFields, ENTRY_COST, Fields, MESSAGE_FIELDS_LEN, MessageFields,
    RECORD_HEADER_LEN, RecordHeader, op, parse_footer, parse_metadata, parse_statistics,
};
use crate::recording::segment::Segment;
use crate::recording::structure::{MessageBatch, looks_like_message_index};
use crate::recording::window::read_into;

/// Minimum number of bytes of messages outside chunks that are examined together.
const SEQUENCE_LEN: usize = 64 * 1024;

/// Size of all that is kept of a file's schema, channel, metadata and attachment records together, bytes; a robot's log has some hundred kilobytes of it.
const KEPT_LIMIT: u64 = 32 << 20;

/// Number of bytes of an attachment record that are read to find its name.
const ATTACHMENT_PREFIX_LEN: usize = 64 * 1024;

impl Scanner<'_> {
    pub(super) fn accept(&mut self, offset: u64, header: RecordHeader, is_repaired: bool) -> io::Result<()> {
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
                let checksum = Fields::new(body).u32().unwrap_or(0);
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

    /// Accepts the unambiguous messages in the window, and stops before anything that needs closer examination.
    pub(super) fn take_messages(&mut self, offset: u64) -> io::Result<u64> {
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
        let body: Arc<[u8]> = self.buffer.as_slice().into();
        let key = (header.opcode, Arc::clone(&body));
        if self.known.contains(&key) || !self.keeps(offset, header, header.body_len) {
            return Ok(());
        }
        self.known.insert(key);
        let definition = Definition { opcode: header.opcode, body, offset_bytes: offset };
        if is_summary {
            self.found.summary_definitions.push(definition);
        } else {
            self.found.definitions.push(definition);
        }
        Ok(())
    }

    /// Reads a body into the buffer. If it is too large, records the damage and returns false.
    fn read_body(&mut self, offset: u64, header: RecordHeader) -> io::Result<bool> {
        let length = usize::try_from(header.body_len).ok();
        let Some(length) = length.filter(|_| header.body_len <= KEPT_LIMIT) else {
            self.place(DamageKind::TooLarge, offset, header.body_len + RECORD_HEADER_LEN);
            return Ok(false);
        };
        read_into(self.file, &mut self.buffer, offset + RECORD_HEADER_LEN, length)?;
        Ok(true)
    }

    /// Takes room for so many bytes of a record. If there is none, records the damage and returns false.
    fn keeps(&mut self, offset: u64, header: RecordHeader, bytes: u64) -> bool {
        let kept_bytes = self.kept_bytes + ENTRY_COST + bytes;
        if kept_bytes > KEPT_LIMIT {
            self.place(DamageKind::TooLarge, offset, header.body_len + RECORD_HEADER_LEN);
            return false;
        }
        self.kept_bytes = kept_bytes;
        true
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
            if self.keeps(offset, header, (place.name.len() + place.media_type.len()) as u64) {
                self.found.attachments.push(place);
            }
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
            Some((name, entries)) => {
                let metadata = Metadata { name: name.to_owned(), entries };
                if self.keeps(offset, header, header.body_len + ENTRY_COST * metadata.entries.len() as u64) {
                    self.found.metadata.push(metadata);
                }
            }
            None => self.place(DamageKind::Definition, offset, header.body_len + RECORD_HEADER_LEN),
        }
        Ok(())
    }
}
