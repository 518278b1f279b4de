//! The samples of a log in the form that `fit` and `discover` use.
//!
//! [`record`] conditions a log once into one row per cycle and cable, and [`store`] holds the rows that do not fit into memory. [`cable`] shows the rows and
//! references of one cable, as they are or changed. [`selection`] decides which rows are used and why others are not.
//! [`held`] finds signals that show each measurement several times, [`still`] those that hang, [`steps`] those in coarse steps, and [`interpolated`] references that lie on a line between two measurements. [`split`] divides a record into training blocks and held-out
//! blocks. [`conditions`] gives the operating conditions of each cycle, [`bins`] divides their range, and [`noise`] estimates the white noise.

pub mod bins;
pub mod cable;
pub mod conditions;
pub mod held;
pub mod interpolated;
pub mod noise;
pub mod record;
pub mod selection;
pub mod split;
pub mod steps;
pub mod still;
pub mod store;
#[cfg(test)]
mod test_signals;
