//! Offline work on samples of cable robots with pulley friction.
//!
//! [`simulate`] is a robot with known friction: the samples of a log, as a stream, with effects hidden in them on
//! request. Its friction is computed in another way than the compensator's, so that each is a check of the other.
//!
//! [`fit`] identifies the parameters of the friction model, [`replay`] runs the compensator over samples and sums up the
//! errors.
//!
//! Nothing here reads or writes logs, and nothing here belongs into a control cycle.

#![allow(clippy::doc_markdown, reason = "symbols of equations are no code items")]

mod clock;
pub mod fit;
pub mod replay;
pub mod simulate;
