//! The friction of one cable: its pulleys, the law of one bearing, the chain over all pulleys, and the cycle of a cable.

pub(crate) mod bearing;
pub mod cable;
pub mod cable_cycle;
pub(crate) mod chain;
pub mod dahl;
pub(crate) mod places;
pub mod pulley;
