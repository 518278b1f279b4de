//! fric-log

mod error;
pub mod output;
pub mod path;
pub mod recording;
pub mod robot;
pub mod schema;
pub mod signals;
pub mod table;
mod warnings;
pub mod write;

pub use error::{in_full, reason, with_sources};
