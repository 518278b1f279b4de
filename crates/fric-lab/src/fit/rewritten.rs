//! Writes the fitted values into the robot file.

use fric_core::CableParams;
use fric_core::effects::Effect;
use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, OFFSET, SIGMA, VISCOUS, Values};
use fric_core::robot::edit::{CableEdit, EffectEdit, FrictionEdit, rewrite, set_monitor};
use fric_core::robot::file::{RobotFile, RobotFileError};

use super::report::CableFit;
use crate::recording_fault::{Fault, LENGTH_NOISE_M, RecordingFault};
use crate::search::vector::Parameter;

/// Returns the text of a robot file with the fitted values of its cables, in the robot's order, and the monitor's `length_noise_m` where the `faults` of
/// a cable include a noisy length; everything else stays as written. `origin` names the source of the file in error messages.
///
/// # Errors
/// Returns the [`RobotFileError`] of [`rewrite`].
pub fn rewritten(
    text: &str,
    origin: &str,
    fits: &[CableFit],
    faults: &[Vec<RecordingFault>],
) -> Result<String, RobotFileError> {
    let robot = RobotFile::parse(text, origin)?;
    let new = |(fit, cable): (&'_ CableFit, &CableParams)| {
        let given = cable.values();
        // Settings of an effect that the file lacks are new too.
        let is_new = |parameter: &Parameter| {
            fit.fitted.contains(parameter)
                || fit.values[parameter.place()].to_bits() != given[parameter.place()].to_bits()
        };
        Parameter::all().filter(is_new).collect::<Vec<Parameter>>()
    };
    let parameters: Vec<Vec<Parameter>> = fits.iter().zip(robot.params().cables()).map(new).collect();
    let new = fits.iter().zip(parameters).map(|(fit, parameters)| NewValues { values: &fit.values, parameters });
    with_play(with_values(text, origin, &new.collect::<Vec<_>>())?, origin, faults.iter().flatten())
}

/// Writes the play into the text of a robot file where lengths are noisy.
///
/// # Errors
/// Returns the [`RobotFileError`] of [`set_monitor`].
pub fn with_play<'a>(
    text: String,
    origin: &str,
    mut faults: impl Iterator<Item = &'a RecordingFault>,
) -> Result<String, RobotFileError> {
    let play_m = faults
        .find(|fault| fault.fault == Fault::NoisyLength)
        .and_then(|fault| fault.parameters.iter().find(|(key, _)| *key == LENGTH_NOISE_M).map(|(_, value)| *value));
    match play_m {
        Some(play_m) => set_monitor(&text, origin, LENGTH_NOISE_M, play_m),
        None => Ok(text),
    }
}

/// The new values of a cable.
#[derive(Clone, Debug)]
pub struct NewValues<'a> {
    /// All values.
    pub values: &'a Values,
    /// The parameters to write.
    pub parameters: Vec<Parameter>,
}

/// Returns the text of a robot file with new values of its cables, in the robot's order; see [`rewritten`].
pub fn with_values(text: &str, origin: &str, cables: &[NewValues<'_>]) -> Result<String, RobotFileError> {
    let robot = RobotFile::parse(text, origin)?;
    let names = robot.cable_names();
    let effects: Vec<EffectValues> = cables.iter().map(effects_of).collect();
    let effect_edits: Vec<Vec<EffectEdit<'_>>> = effects
        .iter()
        .map(|of_cable| {
            let set = |(effect, parameters)| EffectEdit::Set { effect, parameters };
            of_cable.iter().map(|(effect, parameters)| set((*effect, parameters.as_slice()))).collect()
        })
        .collect();
    let edits: Vec<CableEdit<'_>> = names
        .into_iter()
        .zip(cables)
        .zip(&effect_edits)
        .map(|((name, new), effects)| {
            let written = |place: usize| {
                new.parameters.iter().any(|parameter| parameter.place() == place).then_some(new.values[place])
            };
            let friction = FrictionEdit {
                mu: written(MU),
                sigma_n_per_m: written(SIGMA).filter(|sigma_n_per_m| *sigma_n_per_m < NO_PRESLIDING_N_PER_M),
                viscous_n_s_per_m: written(VISCOUS),
                offset_n: written(OFFSET),
            };
            CableEdit { name, friction, effects, ..CableEdit::default() }
        })
        .collect();
    rewrite(text, origin, &edits)
}

/// Parameters of effects, by effect and key.
type EffectValues = Vec<(Effect, Vec<(&'static str, f64)>)>;

/// Returns the parameters of each effect to write.
fn effects_of(new: &NewValues<'_>) -> EffectValues {
    let mut effects = EffectValues::new();
    for parameter in &new.parameters {
        let Some(effect) = parameter.effect() else { continue };
        let number = (parameter.row().key, new.values[parameter.place()]);
        match effects.iter_mut().find(|(of, _)| *of == effect) {
            Some((_, numbers)) => numbers.push(number),
            None => effects.push((effect, vec![number])),
        }
    }
    effects
}
