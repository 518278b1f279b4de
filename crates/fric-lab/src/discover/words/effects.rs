//! The effects that were found, refused or found in common, in words.

use fric_core::effects::Effect;

use crate::discover::naming::Refusal;
use crate::discover::result::{
    CommonEffect, CommonParameter, DiscoverResult, EffectResult, Evidence, RunnerUpResult, TablePoint, TableResult,
    TriedResult,
};
use crate::fit::HALF_INTERVAL;
use crate::set_up;
use crate::text::{listed, quantity};
use crate::words::{condition, evidence, name_of, newtons};

impl EffectResult {
    /// Returns the parameters with their 95 % intervals, and says that they are that.
    #[must_use]
    pub fn values_in_words(&self) -> String {
        if let Some(table) = &self.table {
            return stating_intervals(table.in_words());
        }
        let one = |parameter: &fric_core::parameters::ParameterRow| {
            let value = self.parameters.get(parameter.key)?;
            let half = self.standard_errors.get(parameter.key).map(|error| HALF_INTERVAL * error);
            Some(format!("{} {}", name_of(parameter.key), quantity(value, half, parameter.unit)))
        };
        let all: Vec<String> = self.effect.row().parameters.iter().filter_map(one).collect();
        stating_intervals(all.join(", "))
    }

    /// Returns what to do on the machine, as a clause.
    #[must_use]
    pub fn remedy(&self) -> String {
        let remedy = self.effect.row().remedy;
        let gain = self.parameters.get("gain").filter(|_| self.effect == Effect::SensorGain);
        gain.and_then(set_up::cause_of_gain).map_or_else(
            || remedy.to_owned(),
            |cause| format!("the likely cause of such a gain is {cause}; otherwise {remedy}"),
        )
    }

    /// Returns the alternative explanation, as a sentence without its full stop.
    #[must_use]
    pub fn alternative_in_words(&self) -> Option<String> {
        let RunnerUpResult { kind, delta_bic, held_out_rms_n, as_good, effect } = self.runner_up.as_ref()?;
        let rms = held_out_rms_n.map(newtons)?;
        if *as_good {
            let louder =
                if *effect == Effect::SensorLag { ": undoing a lag makes the sensor's noise louder" } else { "" };
            return Some(format!(
                "the log cannot tell it from {kind} (rms {rms}{louder}); to tell them apart record {}",
                excitation([self.effect, *effect])
            ));
        }
        let own = self.evidence.held_out_rms_n.map(newtons)?;
        Some(if delta_bic.is_some_and(|number| number < 0.0) {
            format!(
                "next best would be {kind} in its place, rms {rms} against {own} (ΔBIC within the extended model {} against {})",
                evidence(*delta_bic),
                evidence(self.evidence.delta_bic)
            )
        } else {
            "nothing else in the catalogue helps".to_owned()
        })
    }
}

impl TableResult {
    /// Returns what the table changes, by how much and where, and what it looks like, as a sentence without its full stop.
    #[must_use]
    pub fn in_words(&self) -> String {
        let largest = self.points.iter().max_by(|one, other| one.value.abs().total_cmp(&other.value.abs()));
        let (Some(largest), Some(first), Some(last)) = (largest, self.points.first(), self.points.last()) else {
            return "unnamed".to_owned();
        };
        let value = |point: &TablePoint| {
            let half = point.standard_error.map(|error| HALF_INTERVAL * error);
            if self.changes == "force" {
                format!("a force at the platform of up to {}", quantity(point.value, half, "N"))
            } else {
                let half = half.map(|half| 100.0 * half);
                format!("a change of the friction by up to {}", quantity(100.0 * point.value, half, "%"))
            }
        };
        let at = |number: f64| quantity(number, None, self.unit);
        format!(
            "unnamed: {} over the {} of {} to {}, largest at {}; physics that look like it: {}",
            value(largest),
            condition(self.over),
            at(first.at),
            at(last.at),
            at(largest.at),
            self.looks_like.join("; ")
        )
    }
}

/// Returns what to record to distinguish the effects.
fn excitation(effects: [Effect; 2]) -> String {
    let mut all: Vec<&str> =
        effects.into_iter().filter_map(|effect| Some(effect.row().parameters.first()?.excitation)).collect();
    all.dedup();
    all.join("; and ")
}

impl TriedResult {
    /// Returns the evidence and the reason for the refusal, as a sentence without its full stop.
    #[must_use]
    pub fn in_words(&self) -> String {
        let Evidence { delta_bic, held_out_rms_n } = &self.evidence;
        let rms = held_out_rms_n.map_or_else(|| "–".to_owned(), newtons);
        format!("{} helps, to rms {rms} with ΔBIC {}, but {}", self.kind, evidence(*delta_bic), self.reason)
    }
}

impl Refusal {
    /// Returns the reason why a candidate that helps is not named, as a clause.
    #[must_use]
    pub fn in_words(self) -> String {
        match self {
            Self::Weak => "the evidence is weaker than what chance may give".to_owned(),
            Self::Small => {
                "it removes so little of what is left that another effect's error may look like it".to_owned()
            }
            Self::Unjudged => "the search ended before it was judged".to_owned(),
            Self::AtBound => "its parameter runs to the end of its range".to_owned(),
            Self::WithinNoise => {
                "what is left without it is no more than noise, as far as the log shows what its noise is".to_owned()
            }
            Self::Absent => "its value is within four standard errors of doing nothing".to_owned(),
            Self::Open(other) => {
                let of = other.effect().map_or_else(String::new, |effect| format!(" of {}", effect.kind()));
                format!("the log cannot tell it from {}{of}", name_of(other.row().key))
            }
            Self::Unsteady(signal) => {
                format!(
                    "its size is not one constant, it changes with the {}: something else is taken for it",
                    condition(signal)
                )
            }
            Self::StandsIn(signal) => format!(
                "a law without a name that goes with the {} explains more, and leaves little for it",
                condition(signal)
            ),
            Self::Usual => "it is no larger than on a sound robot".to_owned(),
            Self::Degenerate => {
                "with its values it is no more than a zero, a gain or what the start of the run has stored".to_owned()
            }
            Self::UsualInstead(usual) => {
                format!("{}, which sound robots have too, leaves little for it to explain", usual.kind())
            }
            Self::Straight => "a straight line explains as much as its curve: a gain with an offset, or a drift".to_owned(),
            Self::Bent(signal) => {
                format!(
                    "what is left would go away if its size went with the {}: its law is another one",
                    condition(signal)
                )
            }
            Self::Contradicted => "the lengths of the log contradict it, unless they are computed from the pose with the points of this file".to_owned(),
            Self::Louder { time_constant_s } => format!(
                "that is with a smoothing, without which the noise that enters behind the sensor's filter gets louder than what the lag explains; \
                 behind a low-pass filter it shows a time constant of about {}",
                quantity(time_constant_s, None, "s")
            ),
        }
    }
}

impl CommonEffect {
    /// Returns on which cables of a result the effect occurs, with its parameters over them.
    #[must_use]
    pub fn in_words(&self, result: &DiscoverResult) -> String {
        let others: Vec<&str> = result
            .cables
            .iter()
            .map(|cable| cable.name.as_str())
            .filter(|name| !self.cables.iter().any(|of| of == name))
            .collect();
        let on = match (others.len(), self.cables.len()) {
            (0, 2) => "both cables".to_owned(),
            (0, count) => format!("all {} cables", counted(count)),
            _ => listed(&self.cables),
        };
        let values: Vec<String> = self.parameters.iter().map(CommonParameter::in_words).collect();
        let values = stating_intervals(format!("{} on {on}: {}", self.kind, values.join(", ")));
        // The wrench cannot show a common error of all gains, which changes the inner tension only.
        if result.wrench.is_some() && self.kind == Effect::SensorGain.kind() && !others.is_empty() {
            let sensors = if others.len() == 1 { "sensor" } else { "sensors" };
            return format!(
                "{values}. These gains are relative to the {sensors} of {}, taken to be right",
                listed(&others)
            );
        }
        values
    }
}

impl CommonParameter {
    /// Returns the mean with its 95 % interval, or says that the cables differ.
    #[must_use]
    pub fn in_words(&self) -> String {
        let name = name_of(self.key);
        if self.differs {
            let [least, greatest] = [self.least, self.greatest].map(|value| quantity(value, None, self.unit));
            return format!("{name} {least} to {greatest}, which is more than the errors");
        }
        format!("{name} {}", quantity(self.mean, Some(HALF_INTERVAL * self.standard_error), self.unit))
    }
}

/// Says of values with their intervals what the intervals are: a fit shows standard errors.
fn stating_intervals(values: String) -> String {
    if values.contains('±') { values + " (95 %)" } else { values }
}

fn counted(count: usize) -> String {
    const WORDS: [&str; 13] =
        ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"];
    WORDS.get(count).map_or_else(|| count.to_string(), |word| (*word).to_owned())
}
