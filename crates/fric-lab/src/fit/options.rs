//! What a fit can be told.

use fric_core::CableParams;
use fric_core::effects::Effect;
use fric_core::parameters::OFFSET;

use crate::candidates::ripple::is_period;
use crate::search::solve::Weighing;
use crate::search::vector::Parameter;

/// How to fit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitOptions {
    /// What to vary, of every cable; if not given, μ, σ, F_pv, ε and the parameters of each effect that the cable has, but for
    /// those that are settings.
    pub parameters: Option<Vec<Parameter>>,
    /// How to weigh deviations that are far out.
    pub weighing: Weighing,
}

impl FitOptions {
    /// What to vary of a cable.
    pub(crate) fn free(&self, params: &CableParams) -> Vec<Parameter> {
        self.parameters.clone().unwrap_or_else(|| {
            let values = params.values();
            let acts = |effect: Effect| {
                let differs = |of: &Parameter| values[of.place()].to_bits() != of.row().neutral.to_bits();
                Parameter::of(effect).any(|parameter| differs(&parameter))
            };
            let free = |parameter: &Parameter| parameter.effect().is_none_or(acts);
            // An offset of the sensor and one at the platform are the same to the force: never both.
            let twice = |parameter: &Parameter| parameter.place() == OFFSET && acts(Effect::SensorOffset);
            // A ripple's period has no neutral value to start from: an effect that acts has one.
            let varies = |parameter: &Parameter| parameter.row().fitted || is_period(parameter);
            // A table changes the force or the friction: which, it says itself.
            let is_idle = |parameter: &Parameter| {
                parameter.effect() == Some(Effect::Empirical)
                    && values[parameter.place()].to_bits() == parameter.row().neutral.to_bits()
            };
            let of_all = Parameter::all().filter(varies).filter(free);
            of_all.filter(|parameter| !twice(parameter) && !is_idle(parameter)).collect()
        })
    }
}
