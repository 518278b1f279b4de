//! The end of a scan: whether the file is whole, and whether its checksums agree.

use std::io;

use super::Scanner;
use crate::recording::damage::{DamageKind, FileEnd};
use crate::recording::record::RECORD_HEADER_LEN;
use crate::recording::window::RunningChecksum;

impl Scanner<'_> {
    pub(super) fn finish(&mut self) -> io::Result<()> {
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
