//! Reads numbers from bytes in either order.

use crate::schema::types::Primitive;

/// A byte order.
pub(super) trait Order {
    fn u16(bytes: [u8; 2]) -> u16;
    fn u32(bytes: [u8; 4]) -> u32;
    fn u64(bytes: [u8; 8]) -> u64;
}

pub(super) struct LittleEndian;
pub(super) struct BigEndian;

impl Order for LittleEndian {
    fn u16(bytes: [u8; 2]) -> u16 {
        u16::from_le_bytes(bytes)
    }
    fn u32(bytes: [u8; 4]) -> u32 {
        u32::from_le_bytes(bytes)
    }
    fn u64(bytes: [u8; 8]) -> u64 {
        u64::from_le_bytes(bytes)
    }
}

impl Order for BigEndian {
    fn u16(bytes: [u8; 2]) -> u16 {
        u16::from_be_bytes(bytes)
    }
    fn u32(bytes: [u8; 4]) -> u32 {
        u32::from_be_bytes(bytes)
    }
    fn u64(bytes: [u8; 8]) -> u64 {
        u64::from_be_bytes(bytes)
    }
}

/// Appends all numbers of the type in `bytes`; an incomplete last one is left out.
pub(super) fn append<O: Order>(primitive: Primitive, bytes: &[u8], numbers: &mut Vec<f64>) {
    fn each<const N: usize>(bytes: &[u8], out: &mut Vec<f64>, number: impl Fn([u8; N]) -> f64) {
        out.extend(bytes.as_chunks::<N>().0.iter().map(|&bytes| number(bytes)));
    }
    match primitive {
        Primitive::Float64 => each(bytes, numbers, |b| f64::from_bits(O::u64(b))),
        Primitive::Float32 => each(bytes, numbers, |b| f64::from(f32::from_bits(O::u32(b)))),
        Primitive::Bool => each(bytes, numbers, |[b]| f64::from(u8::from(b != 0))),
        Primitive::Int8 => each(bytes, numbers, |[b]| f64::from(b.cast_signed())),
        Primitive::Uint8 => each(bytes, numbers, |[b]| f64::from(b)),
        Primitive::Int16 => each(bytes, numbers, |b| f64::from(O::u16(b).cast_signed())),
        Primitive::Uint16 => each(bytes, numbers, |b| f64::from(O::u16(b))),
        Primitive::Int32 => each(bytes, numbers, |b| f64::from(O::u32(b).cast_signed())),
        Primitive::Uint32 => each(bytes, numbers, |b| f64::from(O::u32(b))),
        Primitive::Int64 => each(bytes, numbers, |b| signed(O::u64(b).cast_signed())),
        Primitive::Uint64 => each(bytes, numbers, |b| unsigned(O::u64(b))),
    }
}

#[expect(clippy::cast_precision_loss, reason = "documented: nearest number beyond 2^53")]
pub(super) fn signed(value: i64) -> f64 {
    value as f64
}

#[expect(clippy::cast_precision_loss, reason = "documented: nearest number beyond 2^53")]
fn unsigned(value: u64) -> f64 {
    value as f64
}
