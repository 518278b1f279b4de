//! What a fit can be told.

use fric_core::CableParams;
use fric_core::effects;
use fric_core::parameters::FRICTION_COUNT;

use super::solve::Weighing;
use super::vector::Parameter;

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
            let acts = |kind: &str| {
                let mut of_kind = Parameter::all().filter(|parameter| parameter.effect() == Some(kind));
                of_kind.any(|parameter| values[parameter.place()].to_bits() != parameter.row().neutral.to_bits())
            };
            let acting: Vec<&str> = effects::CATALOGUE.iter().map(|row| row.kind).filter(|kind| acts(kind)).collect();
            let free = |parameter: &Parameter| {
                parameter.place() < FRICTION_COUNT || parameter.effect().is_some_and(|kind| acting.contains(&kind))
            };
            Parameter::all().filter(|parameter| parameter.row().fitted).filter(free).collect()
        })
    }
}
