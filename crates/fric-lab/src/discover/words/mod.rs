//! Parts of a discovery in words, for the terminal and for pages, each in a method of its type.

mod cable;
mod effects;
mod wrench;

pub use wrench::FROM_OUTSIDE;
