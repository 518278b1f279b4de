//! `continuum hole`: μ of a single hole.

use fric_tendon_lab::friction::hole_coefficient;
use fric_tendon_lab::result::HoleResult;
use fric_tendon_lab::{columns, hole_loads};

use super::{about, read_table};
use crate::arguments::continuum::HoleArguments;
use crate::failure::Outcome;
use crate::output::Outputs;
use crate::warnings::warn_all;

/// Runs the command.
pub fn run(arguments: &HoleArguments) -> Outcome {
    let HoleArguments { loads, result } = arguments;
    let outputs = Outputs::create(result, None, vec![loads.clone()])?;
    let table = read_table(loads, &columns::of_hole())?;
    let steps = hole_loads(&table).map_err(|error| about(loads, error))?;
    let found = hole_coefficient(&steps).map_err(|error| about(loads, error))?;
    let outcome = HoleResult::new(&found);
    warn_all(outcome.warning().as_slice());
    outputs.finish(&outcome, &outcome.summary(), "")
}
