//! fric-log

pub mod output;
pub mod path;
pub mod recording;
pub mod schema;
pub mod signals;
pub mod write;
