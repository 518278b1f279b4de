//! Logs of cable robots as joined, typed samples, and back.
//!
//! [`log::Log`] opens MCAP files, folders of rosbag2 and CSV tables, detected by their bytes. [`signals::SignalReader`] joins the signals that a robot
//! file names, each at its own rate, into one [`Sample`](fric_core::Sample) per cycle. Damaged and unfinished files are read as far as they go, and
//! what was lost becomes a warning. Memory is bounded whatever a file claims.
//!
//! [`recording`] reads MCAP, [`schema`] the message formats (CDR with ros2msg, JSON, protobuf), [`path`] the paths to fields in messages. [`mod@write`]
//! writes MCAP, [`table`] reads and writes tables of numbers, [`robot`] finds the robot file attached to a log, and [`output`] replaces files only
//! when they are complete.
//!
//! # Example
//!
//! ```
//! use fric_log::log::Log;
//! use fric_log::robot::AttachedRobot;
//! use fric_log::signals::{SignalPaths, SignalReader};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # std::env::set_current_dir("../..")?;
//! let log = Log::open(&["examples/mini-ipanema.mcap"])?;
//! let AttachedRobot { robot, .. } = AttachedRobot::find(&log)?.ok_or("no robot file is attached")?;
//! let mut rows = SignalReader::new(log, SignalPaths::of_robot(&robot)?, &robot.cable_names());
//! if let Some(sample) = rows.next_row()? {
//!     assert_eq!(sample.cables.len(), 8);
//!     assert!(sample.cables.iter().all(|cable| cable.sensor_force_n > 0.0));
//! }
//! # Ok(())
//! # }
//! ```
//!
//! This crate computes no friction.

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
pub mod units;
mod warnings;
pub mod write;

pub use csv_log::{CsvError, GREAT_INTERVAL_S};
pub use error::{in_full, reason, with_advice};
pub use warnings::cycle_warning;
