//! Whether a motion that is known too early may be a sensor that follows late: to first order both are the same.

use fric_core::effects::Effect;
use fric_core::effects::sensor_lag::TIME_CONSTANT;
use fric_core::effects::time_delay::DELAY;

use super::{Search, without};
use crate::candidates::catalogue::has;
use crate::discover::lag::{behind_lag, is_better_than_behind_lag};
use crate::discover::workbench::{Model, NEAR_ERRORS, Trial};

/// Time constants of the lag, as multiples of the delay. Their noise is part of the residual, so the time constant cannot be fitted to it.
const OF_DELAY: [f64; 5] = [0.6, 0.8, 1.0, 1.25, 1.6];

impl Search<'_, '_> {
    /// Returns the model with a lag of the sensor in the place of a delay, if that explains as much; `None` if it does not, or if the effect is no delay.
    pub(super) fn lag_in_place_of(&mut self, found: &[Effect], effect: Effect) -> Option<Trial> {
        let model = self.fit(found);
        let delay_s = model.values[DELAY];
        if effect != Effect::TimeDelay || delay_s <= 0.0 || has(Effect::SensorLag, &model.values) {
            return None;
        }
        let mut start = Model { values: without(effect, &model.values), free: model.free.clone() };
        start.free.retain(|of| of.effect() != Some(effect));
        let with_lag = |ratio: f64| {
            let mut with = start.clone();
            with.values[TIME_CONSTANT] = ratio * delay_s;
            with
        };
        let fits = self.bench.try_all(&OF_DELAY.map(with_lag), NEAR_ERRORS);
        self.effort.add(&fits);
        let used = self.bench.used(false);
        let of = |trial: Trial| {
            let left_n = self.bench.residuals_n(&trial.values);
            let lagging_n = behind_lag(&self.bench.record, &left_n, trial.values[TIME_CONSTANT]);
            let learned = lagging_n.iter().zip(&used).filter(|(left_n, used)| **used && left_n.is_finite());
            (learned.map(|(left_n, _)| left_n * left_n).sum::<f64>(), lagging_n, trial)
        };
        let best = fits.into_iter().map(of).min_by(|(one, ..), (other, ..)| one.total_cmp(other));
        let (_, lagging_n, trial) = best?;
        let (left_n, reach) = (self.bench.residuals_n(&model.values), self.bench.record.noise_reach);
        let time_constant_s = trial.values[TIME_CONSTANT];
        let is_delay = is_better_than_behind_lag(self.bench, reach, &left_n, &lagging_n, time_constant_s)?;
        (!is_delay).then_some(trial)
    }
}
