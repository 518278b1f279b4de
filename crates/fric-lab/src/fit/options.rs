//! Options of a fit.

use fric_core::CableParams;
use fric_core::effects::Effect;
use fric_core::parameters::OFFSET;

use crate::candidates::catalogue::is_fitted_once_it_acts;
use crate::certainty::one_load::{is_gain, is_zero};
use crate::certainty::one_way::is_zero_open;
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
    /// effect on the force is nearly the same. By default a cable whose zero is one with its friction has none free either.
    pub(crate) fn shared(&self, record: &CableRecord<'_>) -> Vec<Parameter> {
        let mut free = self.free(record.params);
        if let Some(per_log) = record.per_log {
            let is_wanted = |zero: &LogZero| *zero != per_log.zero && self.parameters.is_some();
            let is_left_out = |parameter: &Parameter| {
                LogZero::ALL.iter().any(|zero| parameter.place() == zero.place() && !is_wanted(zero))
            };
            free.retain(|parameter| !is_left_out(parameter));
        }
        if let Some(zero) = self.open_zero(record) {
            free.retain(|parameter| *parameter != zero);
        }
        free
    }

    /// Returns the zero that stays as given because nothing tells it from friction; `None` if there is none, or if it was asked for.
    pub(crate) fn open_zero(&self, record: &CableRecord<'_>) -> Option<Parameter> {
        if self.parameters.is_some() || record.per_log.is_some() || !is_zero_open(record) {
            return None;
        }
        self.free(record.params).into_iter().find(is_zero)
    }

    /// Returns the zero among the free parameters that a cable's logs share, which stays as given where one load does not tell it from a gain beside it;
    /// `None` if there are not both, or if they were asked for.
    pub(crate) fn zero_beside_gain(&self, record: &CableRecord<'_>) -> Option<Parameter> {
        let free = if self.parameters.is_none() { self.shared(record) } else { Vec::new() };
        free.iter().copied().find(is_zero).filter(|_| free.iter().any(is_gain))
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
