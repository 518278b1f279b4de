//! Storage, duration and start of a log.

use std::fmt::Write as _;

use fric_core::text_file::printable;
use fric_log::log::Storage;
use indicatif::DecimalBytes;
use jiff::Timestamp;
use serde::Serialize;

use super::pace::{Pace, Times};
use super::{TopicResult, seconds};

/// Times before 1980 count from the beginning of a recording or of a controller, not from 1970.
const EARLIEST_DATE_NANOS: u64 = 315_532_800_000_000_000;

/// Properties of all files together.
#[derive(Debug, Serialize)]
pub struct StorageResult {
    kind: &'static str,
    size_bytes: u64,
    messages: u64,
    /// Time of the first message or row, since 1970.
    #[serde(skip_serializing_if = "Option::is_none")]
    start_s: Option<f64>,
    /// Time from the first message or row to the last.
    #[serde(skip_serializing_if = "Option::is_none")]
    duration_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    chunks: Option<ChunkResult>,
    /// Number and pace of the rows of a log of rows.
    #[serde(skip_serializing_if = "Option::is_none")]
    rows: Option<RowsResult>,
    #[serde(skip)]
    start_nanos: Option<u64>,
}

#[derive(Debug, Serialize)]
struct RowsResult {
    count: u64,
    #[serde(flatten)]
    pace: Pace,
}

#[derive(Debug, Serialize)]
struct ChunkResult {
    count: u64,
    compression: String,
    stored_bytes: u64,
    content_bytes: u64,
}

impl StorageResult {
    /// Creates the result of a log whose topics have been read, starting at its first message.
    pub fn new(storage: &Storage, topics: &[TopicResult], start_nanos: Option<u64>) -> Self {
        let read: Vec<&TopicResult> = topics.iter().filter(|topic| topic.messages > 0).collect();
        let from_s = read.iter().map(|topic| topic.from_s).reduce(f64::min);
        let to_s = read.iter().map(|topic| topic.to_s).reduce(f64::max);
        let chunks = storage.chunks.as_ref().map(|chunks| ChunkResult {
            count: chunks.count,
            compression: chunks.compressions.join(", "),
            stored_bytes: chunks.stored_bytes,
            content_bytes: chunks.content_bytes,
        });
        Self {
            kind: storage.kind,
            size_bytes: storage.size_bytes,
            messages: read.iter().map(|topic| topic.messages).sum(),
            start_s: start_nanos.map(seconds),
            duration_s: from_s.zip(to_s).map(|(from_s, to_s)| to_s - from_s),
            chunks,
            rows: None,
            start_nanos,
        }
    }

    /// Sets the rows of a log of rows.
    pub fn set_rows(&mut self, times: &Times) {
        if let (None, Some([first_nanos, _])) = (self.start_nanos, times.range_nanos()) {
            self.start_nanos = u64::try_from(first_nanos).ok();
            self.start_s = self.start_nanos.map(seconds);
            self.duration_s = Some(times.duration_s());
            self.rows = Some(RowsResult { count: times.count, pace: times.pace() });
        }
    }

    /// Returns lines for people.
    pub fn lines(&self, attachments: &[String]) -> String {
        let mut text = String::new();
        // Writing to a String cannot fail.
        let mut line = |label: &str, value: &str| {
            let _ = writeln!(text, "{label:<12} {value}");
        };
        line("size:", &format!("{} ({})", DecimalBytes(self.size_bytes), self.kind));
        if let Some(ChunkResult { count, compression, stored_bytes, content_bytes }) = &self.chunks {
            let sizes = format!("{} of {}", DecimalBytes(*stored_bytes), DecimalBytes(*content_bytes));
            line("compression:", &format!("{compression}, {sizes} in {count} chunks"));
        }
        // A log that counts from its own beginning has no date.
        if let Some(start_nanos) = self.start_nanos.filter(|nanos| *nanos >= EARLIEST_DATE_NANOS)
            && let Ok(start) = Timestamp::from_nanosecond(start_nanos.into())
        {
            line("start:", &format!("{start:.3}"));
        }
        if let Some(duration_s) = self.duration_s {
            line("duration:", &format!("{duration_s:.3} s"));
        }
        if let Some(RowsResult { count, pace: Pace { rate_hz, longest_interval_s, .. } }) = &self.rows {
            let pace = rate_hz.zip(*longest_interval_s).map_or_else(String::new, |(rate_hz, longest_s)| {
                format!(", {rate_hz:.1} Hz, longest gap {:.3} ms", 1e3 * longest_s)
            });
            line("rows:", &format!("{count}{pace}"));
        }
        if self.messages > 0 {
            line("messages:", &self.messages.to_string());
        }
        if !attachments.is_empty() {
            line("attached:", &printable(&attachments.join(", ")));
        }
        text
    }
}
