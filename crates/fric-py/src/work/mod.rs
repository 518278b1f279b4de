//! The functions that work on whole logs: one file each, and the runs that several of them read.

pub mod discover;
pub mod excite;
pub mod fit;
pub mod hysteresis;
pub mod replay;
pub mod residual_function;
pub mod runs;
pub mod simulate;
