//! The robot file with what a discovery found.

use fric_core::robot::file::RobotFileError;

use super::report::CableDiscovery;
use crate::fit::Parameter;
use crate::fit::engine::{NewValues, with_values};

/// The text of a robot file with the extended models of its cables, in order: fitted values, and every parameter of each
/// effect that was found. A cable without a verdict keeps its values; everything else stays as it is written. `origin`
/// says where the file is from, for errors.
///
/// A replay with it gives the `after` of the discovery on the same samples, to the last bit.
///
/// # Errors
/// [`RobotFileError`] as [`rewrite`](fric_core::robot::edit::rewrite).
pub fn extended(text: &str, origin: &str, discoveries: &[CableDiscovery]) -> Result<String, RobotFileError> {
    let new: Vec<NewValues<'_>> = discoveries
        .iter()
        .map(|cable| {
            let found = |parameter: &Parameter| {
                cable.findings.iter().any(|finding| finding.effect.places().contains(&parameter.place()))
            };
            let written = |parameter: &Parameter| cable.after.fitted.contains(parameter) || found(parameter);
            NewValues { values: &cable.after.values, parameters: Parameter::all().filter(written).collect() }
        })
        .collect();
    with_values(text, origin, &new)
}
