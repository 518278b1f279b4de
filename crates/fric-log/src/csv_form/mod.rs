//! The form of CSV text: separator, header, comments and decimals as people and programs write them.

mod blanks;
mod form;
mod number;

pub use blanks::TableText;
pub use form::{Form, text_of};
pub use number::{Decimals, clock_nanos, is_without_value, scaled};
