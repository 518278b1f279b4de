//! The model of a manipulator against a truth that is not the model, and what gratings tell.

mod discover;
mod experiments;
mod gratings;
mod identify;
mod runs;
mod shapes;
mod track;
