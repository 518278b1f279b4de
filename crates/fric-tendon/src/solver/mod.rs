//! The equations of a shape and their solution: arcs, loads, and Newton steps along the chain of segments.

pub mod arc;
pub mod chain;
pub mod deflection;
pub mod load;
pub mod newton;
pub mod tangent;
