//! One file per command.

pub mod fit;
pub mod info;
pub mod replay;
pub mod simulate;
