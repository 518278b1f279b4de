//! The number types of the model: one cable in `f64`, several side by side, and the functions that both share.

pub(crate) mod functions;
pub(crate) mod lanes;
pub mod scalar;
