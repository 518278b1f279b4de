//! Messages of encoding `cdr`, read by a program compiled from schema and wanted fields.
//!
//! Plain CDR and plain CDR2 are supported in both byte orders; parameter lists and delimited CDR2, which ROS 2 does not use for its messages, are
//! refused. Every length is checked against the remaining bytes before anything is stored, so that allocations never exceed a small multiple of the
//! message. A message is read to the end of its schema; anything after it (padding, members of a newer definition) is ignored. A text may lack its
//! final NUL. NaN and infinities are passed on.

mod compile;
mod emit;
mod order;
mod program;
mod run;

use super::error::{DecodeError, SchemaError};
use super::field::Wanted;
use super::types::TypeTable;
use super::values::Values;
use emit::Generation;
use order::{BigEndian, LittleEndian};
use program::Program;

/// Reads the wanted fields from messages of one type.
#[derive(Debug, Clone)]
pub(super) struct CdrReader {
    cdr1: Program,
    cdr2: Program,
    /// The representation identifier of the last message.
    last_representation: Option<[u8; 2]>,
}

/// Number of bytes before the actual message, from whose end alignment is counted.
const HEADER_BYTES: usize = 4;

impl CdrReader {
    /// Returns the reader, and the number of slots of [`Values`] that it needs.
    pub(super) fn new(types: &TypeTable, wanted: &[Wanted]) -> Result<(Self, usize), SchemaError> {
        let (cdr1, slots) = compile::compile(types, wanted, Generation::Cdr1)?;
        let (cdr2, _) = compile::compile(types, wanted, Generation::Cdr2)?;
        let reader = Self { cdr1, cdr2, last_representation: None };
        Ok((reader, slots))
    }

    pub(super) fn read(&mut self, data: &[u8], values: &mut Values) -> Result<(), DecodeError> {
        let Some((&[first, second, _, _], body)) = data.split_first_chunk::<HEADER_BYTES>() else {
            return Err(DecodeError::Representation { found: format!("header cut short ({} bytes)", data.len()) });
        };
        let representation = [first, second];
        if self.last_representation != Some(representation) {
            // The same bytes may have another meaning now.
            values.forget_raw_texts();
            self.last_representation = Some(representation);
        }
        let slots = values.begin();
        // The second pair of CDR2 identifiers is that of RTPS 2.5, the first that of XTypes 1.3.
        let result = match representation {
            [0, 0x00] => run::run::<BigEndian>(&self.cdr1, body, slots),
            [0, 0x01] => run::run::<LittleEndian>(&self.cdr1, body, slots),
            [0, 0x06 | 0x10] => run::run::<BigEndian>(&self.cdr2, body, slots),
            [0, 0x07 | 0x11] => run::run::<LittleEndian>(&self.cdr2, body, slots),
            _ => Err(DecodeError::Representation { found: representation_name(representation) }),
        };
        match result {
            Ok(()) => values.finish(),
            Err(_) => values.forget_raw_texts(),
        }
        result
    }
}

fn representation_name([first, second]: [u8; 2]) -> String {
    let name = match [first, second] {
        [0, 0x02 | 0x03] => "PL_CDR, a parameter list, ",
        [0, 0x08 | 0x09 | 0x14 | 0x15] => "D_CDR2, delimited CDR2, ",
        [0, 0x0a | 0x0b | 0x12 | 0x13] => "PL_CDR2, a parameter list, ",
        _ => "",
    };
    format!("{name}0x{first:02x}{second:02x}")
}
