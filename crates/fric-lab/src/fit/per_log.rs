//! What each of several logs has of its own.

use super::FitError;
use crate::samples::record::{LogZero, Reference};
use crate::search::vector::Parameter;

const ZEROS: &str =
    "A zero can have a value per log: `offset_n` at the platform, or `sensor_offset.offset_n` at the sensor.";

/// Returns the zero that each of several logs has of its own, from the names of the parameters; `None` for no name.
///
/// Zeros are what differs between runs of one robot, because sensors are tared anew. All else belongs to the robot: friction, gains, geometry. A drift is
/// the slope of one run, which a robot file could not hold for the next run, so it too stays common, or is cut off with the start of a log.
///
/// # Errors
/// Returns a [`FitError`] for a name that is unknown, repeated or no zero, for both zeros at once, for a single log, and for the wrench as reference,
/// from which the zero of a cable shows only as far as the poses of a log tell it from the others.
pub fn zero_per_log(
    names: &[impl AsRef<str>],
    log_count: usize,
    reference: Reference,
) -> Result<Option<LogZero>, FitError> {
    let zero_of = |parameter: &Parameter| LogZero::ALL.into_iter().find(|zero| zero.place() == parameter.place());
    let unknown = names.iter().map(|name| name.as_ref().trim()).find(|name| Parameter::named(name).is_none());
    if let Some(name) = unknown {
        return Err(FitError::new(format!("there is no parameter `{name}` that each log may have of its own"), ZEROS));
    }
    let parameters = Parameter::all_named(names.iter().map(|name| name.as_ref().trim()))
        .map_err(|problem| FitError::new(problem, ""))?;
    if let Some(other) = parameters.iter().find(|parameter| zero_of(parameter).is_none()) {
        return Err(FitError::new(format!("`{other}` has one value for all logs"), ZEROS));
    }
    let zero = match parameters.as_slice() {
        [] => return Ok(None),
        [one] => zero_of(one),
        _ => {
            return Err(FitError::new(
                "`offset_n` and `sensor_offset.offset_n` of one log cannot be told apart",
                "Name `sensor_offset.offset_n` where the force sensors at the winches are tared anew, else `offset_n`.",
            ));
        }
    };
    if log_count < 2 {
        return Err(FitError::new(
            "a value per log is for several logs, and there is one",
            "Give the logs of all runs, or leave it out.",
        ));
    }
    if reference == Reference::Wrench {
        return Err(FitError {
            instead: Some(Reference::Forces),
            ..FitError::new(
                "the wrench does not show the zeros of each log",
                "Leave it out, or compare with forces at the platform",
            )
        });
    }
    Ok(zero)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_can_have_a_value_per_log_and_nothing_else() {
        let of = |names: &[&str], count| zero_per_log(names, count, Reference::Forces);
        assert_eq!(of(&["offset_n"], 2).unwrap(), Some(LogZero::Platform));
        assert_eq!(of(&[" sensor_offset.offset_n"], 3).unwrap(), Some(LogZero::Sensor));
        assert_eq!(of(&[], 1).unwrap(), None);
        let cause = |names: &[&str], count| of(names, count).unwrap_err().cause;
        assert_eq!(cause(&["offset"], 2), "there is no parameter `offset` that each log may have of its own");
        assert_eq!(cause(&["offset_n", "offset_n"], 2), "`offset_n` is named twice; name it once");
        assert_eq!(cause(&["mu"], 2), "`mu` has one value for all logs");
        assert!(cause(&["offset_n", "sensor_offset.offset_n"], 2).ends_with("cannot be told apart"));
        assert_eq!(cause(&["offset_n"], 1), "a value per log is for several logs, and there is one");
        assert!(zero_per_log(&["offset_n"], 2, Reference::Wrench).unwrap_err().instead.is_some());
    }
}
