//! Data for the figures of a discovery: residuals over a condition, friction over speed and length, spectrum and autocorrelation.

pub mod curve;
pub mod profile;
pub mod spectrum;
