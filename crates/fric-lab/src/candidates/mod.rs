//! Effects that may be missing, and where a search for each starts.
//!
//! [`catalogue`] pairs each effect with its start values, [`ripple`] finds the periods of a residual, [`newcomers`] starts effects that the
//! robot file does not have.

pub mod catalogue;
pub mod newcomers;
pub mod ripple;
