//! The bytes of one message: plain CDR, little endian.

use super::error::WriteError;

const HEADER: [u8; 4] = [0, 1, 0, 0];
const NANOS_PER_S: u64 = 1_000_000_000;

/// A message under construction, whose buffer is reused.
#[derive(Debug, Default)]
pub(super) struct Payload {
    bytes: Vec<u8>,
}

impl Payload {
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Starts a message with its header's stamp.
    pub(super) fn start(&mut self, topic: &str, stamp_nanos: u64) -> Result<(), WriteError> {
        let sec = i32::try_from(stamp_nanos / NANOS_PER_S)
            .map_err(|_| WriteError::Stamp { topic: topic.to_owned(), stamp_nanos })?;
        // The remainder is below 10⁹, so nothing is lost.
        let nanosec = u32::try_from(stamp_nanos % NANOS_PER_S).unwrap_or(u32::MAX);
        self.bytes.clear();
        self.bytes.extend_from_slice(&HEADER);
        self.bytes.extend_from_slice(&sec.to_le_bytes());
        self.bytes.extend_from_slice(&nanosec.to_le_bytes());
        Ok(())
    }

    /// Appends bytes that were encoded earlier for this position.
    pub(super) fn encoded(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    pub(super) fn f64(&mut self, number: f64) {
        self.align(8);
        self.bytes.extend_from_slice(&number.to_le_bytes());
    }

    /// Appends a sequence whose length is known to fit into 32 bits.
    pub(super) fn f64_sequence(&mut self, numbers: &[f64]) {
        self.count(numbers.len());
        for &number in numbers {
            self.f64(number);
        }
    }

    /// Appends a sequence whose length is known to fit into 32 bits.
    pub(super) fn u32_sequence(&mut self, numbers: &[u32]) {
        self.count(numbers.len());
        for number in numbers {
            self.bytes.extend_from_slice(&number.to_le_bytes());
        }
    }

    fn count(&mut self, count: usize) {
        self.align(4);
        let count = u32::try_from(count).unwrap_or(u32::MAX);
        self.bytes.extend_from_slice(&count.to_le_bytes());
    }

    fn align(&mut self, align: usize) {
        let body = self.bytes.len().saturating_sub(HEADER.len());
        let padding = body.next_multiple_of(align) - body;
        self.bytes.resize(self.bytes.len() + padding, 0);
    }
}

/// Encodes the texts that follow the stamp of a header: its frame and, if a message has them, its names.
pub(super) fn encode_texts(frame_id: &str, names: Option<&[String]>) -> Result<Vec<u8>, WriteError> {
    let mut bytes = Vec::new();
    text(&mut bytes, frame_id)?;
    if let Some(names) = names {
        count(&mut bytes, names.len())?;
        for name in names {
            text(&mut bytes, name)?;
        }
    }
    Ok(bytes)
}

fn text(bytes: &mut Vec<u8>, text: &str) -> Result<(), WriteError> {
    count(bytes, text.len() + 1)?;
    bytes.extend_from_slice(text.as_bytes());
    bytes.push(0);
    Ok(())
}

fn count(bytes: &mut Vec<u8>, length: usize) -> Result<(), WriteError> {
    let count = u32::try_from(length).map_err(|_| WriteError::TooLong { length })?;
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes.extend_from_slice(&count.to_le_bytes());
    Ok(())
}
