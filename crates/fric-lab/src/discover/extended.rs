//! Writes the findings of a discovery into a robot file.

use fric_core::parameters::Values;
use fric_core::robot::file::{RobotFile, RobotFileError};

use super::report::CableDiscovery;
use super::rest::empirical::is_idle;
use crate::fit::Parameter;
use crate::fit::rewritten::{NewValues, with_play, with_values};

/// Returns the text of a robot file with the extended models of its cables, in the robot's order. It contains the fitted values, every parameter of
/// each effect that was found, values that the log contradicts without determining others, and the monitor's `length_noise_m` where the
/// lengths are noisy. A cable without a verdict keeps its values, and everything else stays as written. `origin` names the source of the file in error messages.
///
/// A replay with the new file gives the discovery's `after` errors on the same samples, to the last bit. Of a parameter with a value per log the file
/// has that of the last one, and only on this log the replay gives the same.
///
/// # Errors
/// Returns the [`RobotFileError`] of [`rewrite`](fric_core::robot::edit::rewrite).
pub fn extended(text: &str, origin: &str, discoveries: &[CableDiscovery]) -> Result<String, RobotFileError> {
    let robot = RobotFile::parse(text, origin)?;
    let new: Vec<NewValues<'_>> = discoveries
        .iter()
        .zip(robot.params().cables())
        .map(|(cable, given)| {
            let contradicted = contradicted(cable, &given.values());
            // For a table, only the range of its own condition is written.
            let written = |parameter: &Parameter| {
                cable.after.fitted.contains(parameter)
                    || is_per_log(cable, parameter)
                    || contradicted.contains(parameter)
                    || is_found(cable, parameter) && !is_idle(parameter, &cable.after.values)
            };
            NewValues { values: &cable.after.values, parameters: Parameter::all().filter(written).collect() }
        })
        .collect();
    let text = with_values(text, origin, &new)?;
    with_play(text, origin, discoveries.iter().flat_map(|cable| &cable.faults))
}

/// Returns the parameters that no fit determines, but whose `given` values the log contradicts: their values in the extended model are some of many that
/// agree with the log.
pub fn contradicted(cable: &CableDiscovery, given: &Values) -> Vec<Parameter> {
    let is_contradicted = |parameter: &Parameter| {
        cable.after.values[parameter.place()].to_bits() != given[parameter.place()].to_bits()
            && !cable.after.fitted.contains(parameter)
            && !is_per_log(cable, parameter)
            && !is_found(cable, parameter)
    };
    Parameter::all().filter(is_contradicted).collect()
}

/// Whether a parameter is one of an effect that was found.
fn is_found(cable: &CableDiscovery, parameter: &Parameter) -> bool {
    cable.findings.iter().any(|finding| finding.effect.places().contains(&parameter.place()))
}

/// Whether each log has a value of its own.
fn is_per_log(cable: &CableDiscovery, parameter: &Parameter) -> bool {
    cable.per_log.iter().flatten().any(|log| log.parameter == *parameter)
}
