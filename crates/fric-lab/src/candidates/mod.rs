//! Candidate effects, and the start values of the search for each.
//!
//! [`catalogue`] pairs each effect with its start values, [`ripple`] finds the periods of a residual, and [`newcomers`] finds starts for effects that
//! the robot file does not have.

pub mod catalogue;
pub mod newcomers;
pub mod ripple;
