//! The model of a manipulator against a truth that is not the model, and what gratings tell.

mod experiments;
mod gratings;
mod runs;
mod shapes;
