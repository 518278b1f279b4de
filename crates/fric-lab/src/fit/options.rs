//! What a fit can be told.

use fric_core::CableParams;
use fric_core::effects::{self, pulley_eccentricity, sensor_offset};
use fric_core::parameters::{FRICTION_COUNT, OFFSET};

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
            // An offset of the sensor and one at the platform are the same to the force: never both.
            let twice =
                |parameter: &Parameter| parameter.place() == OFFSET && acting.contains(&sensor_offset::ROW.kind);
            // A ripple's period has no neutral value to start from: an effect that acts has one.
            let varies =
                |parameter: &Parameter| parameter.row().fitted || parameter.place() == pulley_eccentricity::PERIOD;
            Parameter::all().filter(varies).filter(free).filter(|parameter| !twice(parameter)).collect()
        })
    }
}
