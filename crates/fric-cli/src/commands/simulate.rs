//! `simulate`
use crate::arguments::SimulateArguments;
use crate::failure::Outcome;
pub fn run(_a: &SimulateArguments) -> Outcome {
    Ok(())
}
