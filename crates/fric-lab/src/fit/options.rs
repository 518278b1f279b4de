//! Options of a fit.

use fric_core::CableParams;
use fric_core::effects::Effect;
use fric_core::parameters::OFFSET;

use crate::candidates::catalogue::is_fitted_once_it_acts;
use crate::samples::cable::CableRecord;
use crate::samples::record::LogZero;
use crate::search::solve::Weighing;
use crate::search::vector::Parameter;

/// How to fit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitOptions {
    /// The parameters to vary, for every cable. By default: μ, σ, F_pv, ε and the parameters of each effect that the cable has, except settings.
    pub parameters: Option<Vec<Parameter>>,
    /// The treatment of large deviations.
    pub weighing: Weighing,
}

impl FitOptions {
    /// Returns the free parameters of a cable that all its logs share: not the zero that each log has of its own, nor by default the other zero, whose
    /// effect on the force is nearly the same. By default a cable that moves one way only under a known load has no zero free either.
    pub(crate) fn shared(&self, record: &CableRecord<'_>) -> Vec<Parameter> {
        let mut free = self.free(record.params);
        if let Some(per_log) = record.per_log {
            let is_wanted = |zero: &LogZero| *zero != per_log.zero && self.parameters.is_some();
            let is_zero = |parameter: &Parameter| {
                LogZero::ALL.iter().any(|zero| parameter.place() == zero.place() && !is_wanted(zero))
            };
            free.retain(|parameter| !is_zero(parameter));
        }
        if self.is_zero_confused(record) {
            free.retain(|parameter| parameter.place() != OFFSET);
        }
        free
    }

    /// Whether nothing tells the zero at the platform from friction. A search would not notice: under a known load, which has no noise, friction as large as
    /// the force beside a zero as large agrees with any log.
    pub(crate) fn is_zero_confused(&self, record: &CableRecord<'_>) -> bool {
        self.parameters.is_none() && record.reference_is_known && record.is_one_way()
    }

    /// Returns the free parameters of a cable.
    pub(crate) fn free(&self, params: &CableParams) -> Vec<Parameter> {
        self.parameters.clone().unwrap_or_else(|| {
            let values = params.values();
            let acts = |effect: Effect| {
                let differs = |of: &Parameter| values[of.place()].to_bits() != of.row().neutral.to_bits();
                Parameter::of(effect).any(|parameter| differs(&parameter))
            };
            let free = |parameter: &Parameter| parameter.effect().is_none_or(acts);
            // A sensor offset and an offset at the platform have the same effect on the force, so only one of them is varied.
            let twice = |parameter: &Parameter| parameter.place() == OFFSET && acts(Effect::SensorOffset);
            let varies = |parameter: &Parameter| parameter.row().fitted || is_fitted_once_it_acts(parameter);
            // A table states itself whether it changes the force or the friction.
            let is_idle = |parameter: &Parameter| {
                parameter.effect() == Some(Effect::Empirical)
                    && values[parameter.place()].to_bits() == parameter.row().neutral.to_bits()
            };
            let of_all = Parameter::all().filter(varies).filter(free);
            of_all.filter(|parameter| !twice(parameter) && !is_idle(parameter)).collect()
        })
    }
}
