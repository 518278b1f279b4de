//! fric-log

mod bag;
mod csv_form;
mod csv_log;
mod error;
pub mod log;
pub mod output;
pub mod path;
pub mod recording;
pub mod robot;
pub mod schema;
pub mod signals;
pub mod table;
mod warnings;
pub mod write;

pub use csv_log::{CsvError, GREAT_INTERVAL_S};
pub use error::{in_full, reason, with_sources};
