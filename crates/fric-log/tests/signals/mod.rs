//! Rows joined from topics, against definitions and hand-made logs.

mod apart;
mod clocks;
mod cut;
mod errors;
mod known;
mod layouts;
mod oracle;
mod partial;
mod random;
mod speed;
pub mod support;
mod table;
mod waiting;
