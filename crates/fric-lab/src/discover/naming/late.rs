//! Whether a motion that is known too early may be a sensor that follows late: to first order both are the same.

use fric_core::effects::Effect;
use fric_core::effects::sensor_lag::TIME_CONSTANT;
use fric_core::effects::time_delay::DELAY;

use super::{Search, without};
use crate::candidates::catalogue::{fitted, has};
use crate::discover::lag::{behind_lag, is_better_than_behind_lag};
use crate::discover::workbench::{Model, NEAR_ERRORS, Trial};

/// Time constants of the lag, as multiples of the delay. The more a lag is undone, the louder is the noise, so the time constant cannot be fitted.
const OF_DELAY: [f64; 5] = [0.6, 0.8, 1.0, 1.25, 1.6];

impl Search<'_, '_> {
    /// Returns the model with a lag of the sensor in the place of a delay, if that explains as much behind the lag; `None` if it does not, if the effect is no
    /// delay, or if the noise cannot be estimated.
    pub(super) fn lag_in_place_of(&mut self, found: &[Effect], effect: Effect) -> Option<Trial> {
        let model = self.fit(found);
        let delay_s = model.values[DELAY];
        if effect != Effect::TimeDelay || delay_s <= 0.0 || has(Effect::SensorLag, &model.values) {
            return None;
        }
        let mut start = Model { values: without(effect, &model.values), free: model.free.clone() };
        start.free.retain(|of| of.effect() != Some(effect));
        // A lag of less than a sample interval is none.
        let times_s =
            OF_DELAY.map(|ratio| ratio * delay_s).into_iter().filter(|time_s| *time_s > self.bench.record.interval_s);
        let with_lag = |time_constant_s: f64| {
            let mut with = start.clone();
            with.values[TIME_CONSTANT] = time_constant_s;
            with
        };
        let fits = self.bench.try_all(&times_s.map(with_lag).collect::<Vec<Model>>(), NEAR_ERRORS);
        self.effort.add(&fits);
        let used = self.bench.used(false);
        let of = |trial: Trial| {
            let left_n = self.bench.residuals_n(&trial.values);
            // The filter that the effect undoes.
            let keeps = |past_s: f64| (1.0 - past_s / trial.values[TIME_CONSTANT]).max(0.0);
            let lagging_n = behind_lag(&self.bench.record, &left_n, keeps);
            let learned = lagging_n.iter().zip(&used).filter(|(left_n, used)| **used && left_n.is_finite());
            (learned.map(|(left_n, _)| left_n * left_n).sum::<f64>(), lagging_n, trial)
        };
        let best = fits.into_iter().map(of).min_by(|(one, ..), (other, ..)| one.total_cmp(other));
        let (_, lagging_n, mut trial) = best?;
        let (left_n, reach) = (self.bench.residuals_n(&model.values), self.bench.record.noise_reach);
        let time_constant_s = trial.values[TIME_CONSTANT];
        let is_delay = is_better_than_behind_lag(self.bench, [reach; 2], &left_n, &lagging_n, time_constant_s)?;
        // It was chosen, and counts as a parameter.
        trial.free.extend(fitted(Effect::SensorLag));
        (!is_delay).then_some(trial)
    }
}
