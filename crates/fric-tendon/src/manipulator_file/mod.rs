//! The manipulator file: its tables, their checks, and new values in its text.

pub mod edit;
pub mod file;
pub mod gratings;
pub mod measuring;
