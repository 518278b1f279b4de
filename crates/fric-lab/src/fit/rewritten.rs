//! The robot file with what was found.

use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, OFFSET, SIGMA, VISCOUS};
use fric_core::robot::edit::{CableEdit, EffectEdit, FrictionEdit, rewrite};
use fric_core::robot::file::{RobotFile, RobotFileError};

use super::report::CableFit;

/// The text of a robot file with the fitted values of its cables, in order; everything else stays as it is written.
/// `origin` says where it is from, for errors.
///
/// # Errors
/// [`RobotFileError`] as [`rewrite`].
pub fn rewritten(text: &str, origin: &str, fits: &[CableFit]) -> Result<String, RobotFileError> {
    let robot = RobotFile::parse(text, origin)?;
    let names = robot.cable_names();
    let effects: Vec<EffectValues> = fits.iter().map(effects_of).collect();
    let effect_edits: Vec<Vec<EffectEdit<'_>>> = effects
        .iter()
        .map(|of_cable| {
            let set = |(kind, parameters)| EffectEdit::Set { kind, parameters };
            of_cable.iter().map(|(kind, parameters)| set((*kind, parameters.as_slice()))).collect()
        })
        .collect();
    let edits: Vec<CableEdit<'_>> = names
        .into_iter()
        .zip(fits)
        .zip(&effect_edits)
        .map(|((name, fit), effects)| {
            let fitted = |place: usize| {
                fit.fitted.iter().any(|parameter| parameter.place() == place).then_some(fit.values[place])
            };
            let friction = FrictionEdit {
                mu: fitted(MU),
                sigma_n_per_m: fitted(SIGMA).filter(|sigma_n_per_m| *sigma_n_per_m < NO_PRESLIDING_N_PER_M),
                viscous_n_s_per_m: fitted(VISCOUS),
                offset_n: fitted(OFFSET),
            };
            CableEdit { name, friction, effects }
        })
        .collect();
    rewrite(text, origin, &edits)
}

/// Parameters of effects, by kind and key.
type EffectValues = Vec<(&'static str, Vec<(&'static str, f64)>)>;

/// Fitted parameters of each effect.
fn effects_of(fit: &CableFit) -> EffectValues {
    let mut effects = EffectValues::new();
    for parameter in &fit.fitted {
        let Some(kind) = parameter.effect() else { continue };
        let number = (parameter.row().key, fit.values[parameter.place()]);
        match effects.iter_mut().find(|(of, _)| *of == kind) {
            Some((_, numbers)) => numbers.push(number),
            None => effects.push((kind, vec![number])),
        }
    }
    effects
}
