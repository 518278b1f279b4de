//! The search for friction on the residual of the tensions: a model with the numbers that may be missing, fits of it, and which effects are named.

pub mod fitting;
pub mod lines;
pub mod model;
pub mod naming;
pub mod spread;
pub mod trials;
