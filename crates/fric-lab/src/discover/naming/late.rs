//! A lag of the force sensor that no fit finds: one that looks like a motion known too early, and one whose removal makes more noise than it explains.

use fric_core::effects::Effect;
use fric_core::effects::sensor_lag::{SMOOTHING, TIME_CONSTANT};
use fric_core::effects::time_delay::DELAY;
use fric_core::parameters::Values;

use super::evidence::inflation;
use super::{Refusal, STRONG_BIC, Search, Tried, delta_bic, without};
use crate::candidates::catalogue::{fitted, has};
use crate::discover::lag::{behind_lag, is_better_than_behind_lag};
use crate::discover::workbench::{Model, NEAR_ERRORS, Trial};

/// Time constants of the lag, as multiples of the delay. The more a lag is undone, the louder is the noise, so the time constant cannot be fitted.
const OF_DELAY: [f64; 5] = [0.6, 0.8, 1.0, 1.25, 1.6];
/// Time constants of a lag that explains what is left: the least, in sample intervals, and each as a multiple of the one before.
const LEAST_INTERVALS: f64 = 1.5;
const NEXT: f64 = 1.2;
const TIME_CONSTANT_COUNT: i32 = 24;
/// Such a lag is judged behind a low-pass filter that is this many times as slow: undoing it then leaves the noise quieter than it is.
const BEHIND: f64 = 4.0;
/// Smoothing with which the lag is undone, as multiples of its time constant: the one that leaves least.
const SMOOTHING_RATIOS: [f64; 5] = [0.5, 1.0, 1.5, 2.0, 3.0];
/// Number of times that its time constant and the friction are determined one after the other.
const ROUNDS_OF_LAG: usize = 2;

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
        let fits = self.try_all(&times_s.map(with_lag).collect::<Vec<Model>>(), NEAR_ERRORS);
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

    /// Returns a lag of the sensor that explains what a model leaves, but is not named, since undoing it makes the noise louder that enters behind the
    /// sensor's filter. `None` if the evidence is not strong, or if a delay in its place does as well.
    pub(super) fn hidden_lag(&mut self, found: &[Effect]) -> Option<Tried> {
        let model = self.fit(found);
        if has(Effect::SensorLag, &model.values) {
            return None;
        }
        let delay = [Effect::TimeDelay];
        let delayed = if found.contains(&delay[0]) { None } else { self.beside(found, &delay).pop() };
        let rivals: Vec<Vec<f64>> = std::iter::once(&model)
            .chain(delayed.as_ref().map(|(_, trial)| trial))
            .map(|trial| self.bench.residuals_n(&trial.values))
            .collect();
        let interval_s = self.bench.record.interval_s;
        let times_s: Vec<f64> =
            (0..TIME_CONSTANT_COUNT).map(|place| LEAST_INTERVALS * NEXT.powi(place) * interval_s).collect();
        let lagging_n = |values: &Values, time_constant_s: f64| {
            let mut values = *values;
            (values[TIME_CONSTANT], values[SMOOTHING]) = (time_constant_s, 0.0);
            self.bench.residuals_n(&values)
        };
        let evidence = |time_constant_s: f64| {
            let of_lag = self.behind(&lagging_n(&model.values, time_constant_s), BEHIND * time_constant_s);
            // The filter's noise is that of so many independent samples.
            let independent = interval_s / (2.0 * BEHIND * time_constant_s);
            let against = |rival: &Vec<f64>| {
                let of_rival = self.behind(rival, BEHIND * time_constant_s);
                let of_part = |([lag, count], [other, of_other]): (&[f64; 2], &[f64; 2])| {
                    delta_bic(count * independent, (lag / count) / (other / of_other), 1.0)
                };
                of_lag.iter().zip(&of_rival).map(of_part).fold(f64::NEG_INFINITY, f64::max)
            };
            rivals.iter().map(against).fold(f64::NEG_INFINITY, f64::max)
        };
        let of_times = times_s.iter().map(|time_s| (evidence(*time_s), *time_s));
        let (strongest, mut time_constant_s) = of_times.min_by(|(one, _), (other, _)| one.total_cmp(other))?;
        let is_at_end = |time_s: f64| times_s.first() == Some(&time_s) || times_s.last() == Some(&time_s);
        if strongest >= -STRONG_BIC || is_at_end(time_constant_s) {
            return None;
        }
        let mut trial = model.clone();
        for _ in 0..ROUNDS_OF_LAG {
            let left = |time_s: f64| {
                let [[learned, _], _] = self.behind(&lagging_n(&trial.values, time_s), BEHIND * time_constant_s);
                learned
            };
            let of_times = times_s.iter().map(|time_s| (left(*time_s), *time_s));
            (_, time_constant_s) = of_times.min_by(|(one, _), (other, _)| one.total_cmp(other))?;
            let with = |ratio: f64| {
                let mut values = trial.values;
                (values[TIME_CONSTANT], values[SMOOTHING]) = (time_constant_s, ratio * time_constant_s);
                Model { values, free: model.free.clone() }
            };
            let fits = self.try_all(&SMOOTHING_RATIOS.map(with), NEAR_ERRORS);
            trial = fits.into_iter().min_by(|one, other| one.training.total_cmp(&other.training))?;
        }
        let inflation = inflation(self.bench, &trial, &trial.free);
        Some(Tried {
            effect: Effect::SensorLag,
            trial,
            inflation,
            refusal: Refusal::Louder { time_constant_s },
            takes_rest: false,
        })
    }

    /// Returns the sum of squares of residuals behind a low-pass filter, with the number of samples: of the training samples, and of the held-out ones.
    fn behind(&self, residuals_n: &[f64], filter_s: f64) -> [[f64; 2]; 2] {
        let filtered_n = behind_lag(&self.bench.record, residuals_n, |past_s| filter_s / (filter_s + past_s));
        [false, true].map(|held_out| {
            let used = self.bench.used(held_out);
            let known = filtered_n.iter().zip(&used).filter(|(left_n, used)| **used && left_n.is_finite());
            known.fold([0.0, 0.0], |[sum, count], (left_n, _)| [sum + left_n * left_n, count + 1.0])
        })
    }
}
