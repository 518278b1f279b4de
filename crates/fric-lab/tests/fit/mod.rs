//! Identification against robots whose friction is known.
#![allow(clippy::print_stdout, reason = "the figures behind each assertion")]
#![allow(clippy::doc_markdown, reason = "symbols of equations are no code items")]

mod coverage;
mod delicate;
mod effects;
mod faulty;
mod jacobian;
pub mod logs;
mod newcomers;
mod oracle;
mod per_log;
mod published;
mod residual_function;
mod store;
mod together;
mod undetermined;
mod winch;
mod wrench;
