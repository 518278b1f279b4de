//! `info`
use crate::arguments::InfoArguments;
use crate::failure::Outcome;
pub fn run(_a: &InfoArguments) -> Outcome {
    Ok(())
}
