//! Rules for a zero of the sensor beside or in the place of what goes with the load, which one load does not tell apart.
//!
//! Their sums of squares do not decide: what goes with the load goes with the noise of the sensor too. A gain above 1 makes less of it, and so agrees better with a log
//! of a zero than the zero does.

use fric_core::effects::Effect;
use fric_core::effects::sensor_gain::GAIN;
use fric_core::effects::sensor_offset::OFFSET;

use super::evidence::inflation;
use super::justification::is_at_end;
use super::{NEGLIGIBLE, Refusal, STRONG_BIC, Search};
use crate::candidates::catalogue::has;
use crate::certainty::one_load::{apart_ratio, is_gain, is_zero};
use crate::certainty::one_way::MOST_APART_RATIO;
use crate::discover::workbench::Trial;

/// Effects that shift a load the same way in both directions, in proportion to it.
const GO_WITH_LOAD: [Effect; 2] = [Effect::SensorGain, Effect::DirectionAsymmetry];

impl Search<'_, '_> {
    /// Returns the reason why a zero cannot stay beside a gain, or a gain beside a zero: the load does not tell how large it is.
    pub(super) fn open_beside(&self, model: &Trial, effect: Effect) -> Option<Refusal> {
        let (other, ratio) = match effect {
            Effect::SensorOffset => (model.free.iter().find(|of| is_gain(of)), self.zero_ratio(model)),
            Effect::SensorGain => (model.free.iter().find(|of| is_zero(of)), (model.values[GAIN] - 1.0).abs()),
            _ => (None, 0.0),
        };
        other.filter(|_| self.is_open(model, ratio)).map(|other| Refusal::Open(*other))
    }

    /// Whether the log tells a gain from a zero though its load varies little: the gain leaves nothing but noise, where there is strong evidence that a zero
    /// leaves more.
    pub(super) fn tells_gain(&mut self, found: &[Effect]) -> bool {
        let others: Vec<Effect> =
            found.iter().copied().filter(|of| ![Effect::SensorGain, Effect::SensorOffset].contains(of)).collect();
        let model = self.fit(&others);
        if self.bench.has_zero(&model.free)
            || [Effect::SensorGain, Effect::SensorOffset].iter().any(|of| has(*of, &model.values))
        {
            return false;
        }
        let [(_, with_gain), (_, with_zero)] = &self.beside(&others, &[Effect::SensorGain, Effect::SensorOffset])[..]
        else {
            return false;
        };
        let memory = inflation(self.bench, with_zero, &with_zero.free);
        let as_loud = as_loud_as(with_zero, with_gain.clone());
        self.excess(with_gain) <= NEGLIGIBLE
            && as_loud.held_out < with_zero.held_out
            && self.delta_bic(with_zero, &as_loud, memory) < -STRONG_BIC
    }

    /// Returns the best effect that goes with the load in the place of a zero, or a zero in the place of such an effect, if the log does not tell them apart.
    pub(super) fn as_good_under_one_load(&mut self, found: &[Effect], effect: Effect) -> Option<(Effect, Trial)> {
        let in_its_place: &[Effect] = match effect {
            Effect::SensorOffset => &GO_WITH_LOAD,
            Effect::SensorGain | Effect::DirectionAsymmetry => &[Effect::SensorOffset],
            _ => return None,
        };
        let model = self.fit(found);
        let has_zero = model.free.iter().any(is_zero) || self.bench.has_zero(&model.free);
        if has_zero && effect != Effect::SensorOffset {
            return None;
        }
        let others: Vec<Effect> = found.iter().copied().filter(|other| *other != effect).collect();
        let missing: Vec<Effect> = in_its_place.iter().copied().filter(|other| !has(*other, &model.values)).collect();
        self.beside(&others, &missing);
        let mut trials: Vec<(Effect, Trial)> =
            missing.into_iter().map(|other| (other, self.fit(&[&others[..], &[other]].concat()))).collect();
        trials.retain(|(other, trial)| {
            let zero = if effect == Effect::SensorOffset { &model } else { trial };
            let ratio = self.zero_ratio(zero);
            // What the gain makes of the noise.
            let least = (1.0 - ratio.min(1.0)).powi(2) * trial.held_out;
            !is_at_end(*other, &trial.values, self.bench.record.cycle_s)
                && least <= (1.0 + NEGLIGIBLE) * model.held_out
                && self.is_open(&model, ratio)
        });
        trials.into_iter().min_by(|(_, one), (_, other)| one.training.total_cmp(&other.training))
    }

    /// Returns a zero as a fraction of the load.
    fn zero_ratio(&self, model: &Trial) -> f64 {
        (model.values[OFFSET] / (self.around.sensor_ratio * self.around.mean_tension_n)).abs()
    }

    /// Whether the log may have any gain that differs from that of a model by so much, because of the errors of both forces.
    fn is_open(&self, model: &Trial, ratio: f64) -> bool {
        apart_ratio(&self.bench.problem(&[], None), &model.values) > MOST_APART_RATIO * ratio
    }
}

/// Returns a model's sums of squares as they would be if its gain made no less of the sensor's noise than that of another model.
pub(super) fn as_loud_as(other: &Trial, trial: Trial) -> Trial {
    let louder = (trial.values[GAIN] / other.values[GAIN]).powi(2).max(1.0);
    Trial { training: louder * trial.training, held_out: louder * trial.held_out, ..trial }
}
