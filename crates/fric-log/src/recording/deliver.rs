//! Finds the next message: loads segments when the order requires it, and counts undeliverable messages.

use std::sync::Arc;

use super::Recording;
use super::channels::{Received, Source};
use super::damage::{DamageKind, DamagedPlace};
use super::error::RecordingError;
use super::load::{Loaded, Loader};
use super::merge::{Head, OpenSegment, Step};
use super::reader::Reader;
use super::record::framed_at;
use super::segment::Segment;

impl Recording {
    /// Returns the next deliverable message, with the dense number of its channel.
    #[inline]
    pub(super) fn find_next(&mut self) -> Result<Option<(usize, Head)>, RecordingError> {
        loop {
            match self.merge.step() {
                Step::Deliver(head) => {
                    if let Some(dense) = self.channel_of(&head)? {
                        self.note_time(head.fields.log_time_nanos);
                        return Ok(Some((dense, head)));
                    }
                }
                Step::Load => self.load_next()?,
                Step::Retire(open) => self.retire(open),
                Step::End => {
                    self.note_end();
                    return Ok(None);
                }
            }
        }
    }

    #[inline]
    fn note_time(&mut self, log_time_nanos: u64) {
        let late = &mut self.late;
        if log_time_nanos < late.latest_nanos {
            late.count += 1;
            late.most_nanos = late.most_nanos.max(late.latest_nanos - log_time_nanos);
        } else {
            late.latest_nanos = log_time_nanos;
        }
    }

    /// Returns the channel of a message of the current segment; `None` if the message cannot be delivered.
    #[inline]
    fn channel_of(&mut self, head: &Head) -> Result<Option<usize>, RecordingError> {
        let channel_id = head.fields.channel_id;
        let Some((file, is_rejected)) = self.merge.current_file(channel_id) else {
            return Ok(None);
        };
        if is_rejected {
            self.lose_message(file, DamageKind::Conflict);
            return Ok(None);
        }
        match self.channels.dense(file, channel_id) {
            Some(dense) => Ok(Some(dense)),
            None => self.search_channel(file, channel_id),
        }
    }

    /// Searches a channel that the segments read so far do not define. A chunk that is later in time may be earlier in the file and contain the
    /// definition. Done once per file.
    #[cold]
    fn search_channel(&mut self, file: u32, channel_id: u16) -> Result<Option<usize>, RecordingError> {
        let count = self.counts.get_mut(file as usize);
        if let Some(count) = count
            && !count.is_searched
        {
            count.is_searched = true;
            self.read_definitions(file)?;
        }
        let dense = self.channels.dense(file, channel_id);
        if dense.is_none() {
            self.lose_message(file, DamageKind::UnknownChannel);
        }
        Ok(dense)
    }

    fn read_definitions(&mut self, file: u32) -> Result<(), RecordingError> {
        let segments = Arc::clone(&self.segments);
        let Some(source) = self.files.get(file as usize) else {
            return Ok(());
        };
        let mut loader = Loader::new();
        let mut buffer = Vec::new();
        for (place, segment) in segments.iter().enumerate() {
            // A larger segment is not worth the additional memory.
            if segment.file != file || segment.content_len > super::reader::AHEAD_BYTES {
                continue;
            }
            let found = loader
                .load(&source.file, place, segment, buffer)
                .map_err(|error| source.read_error(segment.offset_bytes, error))?;
            for offset in &found.definitions {
                if let Some(record) = framed_at(&found.content, *offset as usize) {
                    let table = &mut self.channels;
                    table.define(file, record.opcode, record.body, Source::Scan, &mut Vec::new());
                }
            }
            buffer = found.content;
        }
        Ok(())
    }

    fn lose_message(&mut self, file: u32, kind: DamageKind) {
        let place = self.merge.current_segment();
        let offset_bytes = place.and_then(|place| self.segments.get(place)).map_or(0, |segment| segment.offset_bytes);
        if let Some(damage) = self.damage.file_mut(file as usize) {
            damage.add_lost_messages(1);
            damage.add_once(DamagedPlace { kind, offset_bytes, lost_bytes: 0, log_time_nanos: None });
        }
    }

    fn load_next(&mut self) -> Result<(), RecordingError> {
        let reader = if let Some(reader) = &self.reader {
            reader
        } else {
            let reader = Reader::start(Arc::clone(&self.files), Arc::clone(&self.segments))?;
            self.reader.insert(reader)
        };
        let Some((place, segment)) = self.merge.start_next() else {
            return Ok(());
        };
        let loaded = reader.take().ok_or(RecordingError::ReaderStopped)?;
        self.bytes_read += segment.file_len();
        match loaded {
            Ok(loaded) if loaded.segment == place => self.take_in(loaded, &segment),
            Ok(_) => return Err(RecordingError::ReaderStopped),
            Err(error) => {
                let source = self.files.get(segment.file as usize);
                let source = source.ok_or(RecordingError::ReaderStopped)?;
                return Err(source.read_error(segment.offset_bytes, error));
            }
        }
        Ok(())
    }

    /// Records the damage and the definitions of a loaded segment and opens it.
    fn take_in(&mut self, loaded: Loaded, segment: &Segment) {
        let file = segment.file;
        if let Some(kind) = loaded.problem {
            let from = loaded.last_time_nanos.unwrap_or(segment.start_time_nanos);
            let is_dropped = loaded.content.is_empty();
            self.add_damage(
                file,
                DamagedPlace {
                    kind,
                    offset_bytes: segment.offset_bytes,
                    lost_bytes: if is_dropped { segment.file_len() } else { 0 },
                    log_time_nanos: (from <= segment.end_time_nanos).then_some((from, segment.end_time_nanos)),
                },
            );
        }
        if let Some(count) = self.counts.get_mut(file as usize) {
            count.found += loaded.message_count;
        }
        let mut rejected = Vec::new();
        for offset in &loaded.definitions {
            let Some(record) = framed_at(&loaded.content, *offset as usize) else {
                continue;
            };
            let received = self.channels.define(file, record.opcode, record.body, Source::Messages, &mut rejected);
            let kind = match received {
                Received::Fine => continue,
                Received::Broken => DamageKind::Definition,
                Received::TooLarge => DamageKind::TooLarge,
                Received::Conflict => DamageKind::Conflict,
            };
            self.add_damage(
                file,
                DamagedPlace { kind, offset_bytes: segment.offset_bytes, lost_bytes: 0, log_time_nanos: None },
            );
        }
        let open = OpenSegment::new(loaded, segment, rejected);
        if let Some(blank) = self.merge.add(open) {
            self.retire(blank);
        }
    }

    fn add_damage(&mut self, file: u32, place: DamagedPlace) {
        if let Some(damage) = self.damage.file_mut(file as usize) {
            damage.add(place);
        }
    }

    fn retire(&mut self, open: OpenSegment) {
        if let Some(reader) = &self.reader {
            reader.give_back(open.into_buffer());
        }
    }

    /// Computes the number of missing messages from the statistics at the end.
    fn note_end(&mut self) {
        self.bytes_read = self.total_bytes();
        for (file, count) in self.counts.iter().enumerate() {
            let missing = count.expected.unwrap_or(0).saturating_sub(count.found);
            if missing > 0
                && let Some(damage) = self.damage.file_mut(file)
            {
                damage.set_missing_messages(missing);
            }
        }
        self.reader = None;
    }
}
