//! The samples of a log as `fit` and `discover` take them.
//!
//! [`record`] conditions a log once into one row per cycle and cable. [`selection`] counts which rows are used and why others are not,
//! [`interpolated`] finds references on a line between two measurements, [`split`] divides a record into blocks to learn from and blocks held
//! out. [`conditions`] gives the operating conditions of each cycle, [`bins`] divides their range, [`noise`] estimates the white noise.

pub mod bins;
pub mod conditions;
pub mod interpolated;
pub mod noise;
pub mod record;
pub mod selection;
pub mod split;
