//! The C interface as C calls it: pointers, sizes, texts.
#![allow(clippy::unwrap_used, clippy::undocumented_unsafe_blocks, reason = "a test")]

mod change;
mod header;
mod load;
mod step;
mod support;
