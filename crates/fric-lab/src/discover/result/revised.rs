//! Parameters of the robot file's effects that the log has otherwise.

use fric_core::parameters::Values;
use serde::Serialize;

use crate::discover::report::CableDiscovery;
use crate::fit::{HALF_INTERVAL, Parameter};

/// A parameter of an effect of the robot file whose value in the extended model differs from the given one by more than its 95 % interval.
#[derive(Clone, Debug, Serialize)]
pub struct RevisedResult {
    /// Its name, such as `sensor_gain.gain`.
    pub parameter: String,
    /// The value of the robot file.
    pub given: f64,
    /// The value of the extended model.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Its unit.
    #[serde(skip)]
    pub unit: &'static str,
}

/// Returns the revised parameters of a cable with the `given` values.
pub fn revised(found: &CableDiscovery, given: &Values) -> Vec<RevisedResult> {
    let of = |parameter: &Parameter| {
        let effect = parameter.effect()?;
        let is_found = found.findings.iter().any(|finding| finding.effect == effect);
        let is_per_log = found.per_log.iter().flatten().any(|log| log.parameter == *parameter);
        let (value, given) = (found.after.values[parameter.place()], given[parameter.place()]);
        let standard_error = found.after.standard_error(parameter)?;
        let is_revised = !is_found && !is_per_log && (value - given).abs() > HALF_INTERVAL * standard_error;
        is_revised.then(|| RevisedResult {
            parameter: parameter.to_string(),
            given,
            value,
            standard_error,
            unit: parameter.row().unit,
        })
    };
    found.after.fitted.iter().filter_map(of).collect()
}
