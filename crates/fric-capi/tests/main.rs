//! The C interface as C calls it: pointers, sizes, texts.
#![allow(clippy::unwrap_used, clippy::undocumented_unsafe_blocks, reason = "a test")]
#![allow(clippy::float_cmp, reason = "bit for bit is what these tests are about")]

mod change;
mod header;
mod load;
mod static_model;
mod step;
mod support;
