//! Tables whose cells stand apart by one or more blanks.

use std::io::{self, Read};

/// Stands for one or more blanks or tabs between cells.
pub const BLANKS: u8 = b' ';
/// Number of bytes that are read at once.
const CHUNK: usize = 1 << 13;

/// Text with one blank where there are several outside of quotes, and none at the beginning and the end of a line.
#[derive(Debug, Default)]
pub struct SingleBlanks {
    text: Vec<u8>,
    has_begun: bool,
    follows_blank: bool,
    is_quoted: bool,
}

impl SingleBlanks {
    /// Returns a line with single blanks.
    pub fn of(line: &[u8]) -> Vec<u8> {
        let mut blanks = Self::default();
        for byte in line {
            blanks.push(*byte);
        }
        blanks.text
    }

    fn push(&mut self, byte: u8) {
        match byte {
            b' ' | b'\t' if !self.is_quoted => {
                self.follows_blank = self.has_begun;
                return;
            }
            b'\n' | b'\r' => (self.has_begun, self.follows_blank, self.is_quoted) = (false, false, false),
            _ => {
                self.is_quoted ^= byte == b'"';
                if std::mem::take(&mut self.follows_blank) {
                    self.text.push(BLANKS);
                }
                self.has_begun = true;
            }
        }
        self.text.push(byte);
    }
}

/// The text of a table, as the reader of rows takes it.
#[derive(Debug)]
pub struct TableText<R> {
    source: R,
    /// What is read and not yet taken, of a table with blanks.
    single: Option<(SingleBlanks, usize)>,
}

impl<R> TableText<R> {
    pub fn new(source: R, separator: u8) -> Self {
        Self { source, single: (separator == BLANKS).then(Default::default) }
    }
}

impl<R: Read> Read for TableText<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let Some((single, taken)) = &mut self.single else { return self.source.read(buffer) };
        while *taken == single.text.len() {
            *taken = 0;
            single.text.clear();
            let mut chunk = [0; CHUNK];
            let count = self.source.read(&mut chunk)?;
            if count == 0 {
                return Ok(0);
            }
            for byte in chunk.iter().take(count) {
                single.push(*byte);
            }
        }
        let count = single.text.get(*taken..).unwrap_or_default().read(buffer)?;
        *taken += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_become_one_wherever_a_read_ends() {
        let text = b"  1   2\t \"a  b\"  \n\n 3 4\r\n".repeat(3000);
        let expected = b"1 2 \"a  b\"\n\n3 4\r\n".repeat(3000);
        for most in [1, 7, CHUNK] {
            struct Slow<'a>(&'a [u8], usize);
            impl Read for Slow<'_> {
                fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                    let most = self.1.min(buffer.len());
                    self.0.read(&mut buffer[..most])
                }
            }
            let mut found = Vec::new();
            TableText::new(Slow(&text, most), BLANKS).read_to_end(&mut found).unwrap();
            assert_eq!(found, expected, "{most}");
        }
        let mut found = Vec::new();
        TableText::new(&b"a  b\n"[..], b';').read_to_end(&mut found).unwrap();
        assert_eq!(found, b"a  b\n");
    }
}
