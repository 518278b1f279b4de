//! One file per command.

pub mod completions;
pub mod continuum;
pub mod convert;
pub mod discover;
pub mod excite;
pub mod fit;
pub mod hysteresis;
pub mod info;
pub mod init;
pub mod man;
pub mod replay;
pub mod simulate;
