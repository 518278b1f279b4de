//! What was found on one cable in words: the verdict, the gap, and where something lies.

use std::fmt::Write as _;

use fric_core::effects::Effect;

use crate::certainty::one_load::is_gain;
use crate::discover::Verdict;
use crate::discover::naming::Refusal;
use crate::discover::rest::places::{LEAST_CONCENTRATION, WHOLE};
use crate::discover::result::{
    DiscoverCableResult, EffectResult, RevisedResult, TriedResult, UnexplainedResult, WhereResult,
};
use crate::fit::{HALF_INTERVAL, Parameter};
use crate::recording_fault::Fault;
use crate::text::{listed, quantity, significant};
use crate::words::{Times, condition, newtons, percent};

/// The lower end of a range counts as zero below this fraction of the upper end.
const NO_MORE_THAN_ZERO: f64 = 0.01;

impl WhereResult {
    /// Returns the range as the words that follow "it sits".
    #[must_use]
    pub fn range_in_words(&self) -> String {
        let [least, greatest] = self.range;
        let is_last = self.to >= greatest;
        // A magnitude starts at 0, even if noise keeps it from reaching 0.
        let from_zero = least >= 0.0 && self.from < NO_MORE_THAN_ZERO * self.to && !is_last;
        let is_first = self.from <= least || from_zero;
        let value = |number: f64| {
            if matches!(self.unit, "m" | "m/s") {
                quantity(number, None, self.unit)
            } else {
                with_unit(number, self.unit)
            }
        };
        match self.signal {
            "standstill" if self.from >= 0.5 => return "while the cable rests".to_owned(),
            "standstill" if self.to <= 0.5 => return "while the cable moves".to_owned(),
            "standstill" => return "throughout".to_owned(),
            "direction" => {
                // −1, 0 or 1; the upper end of a range is part of it only if it is the last.
                let holds = |sign: f64| sign >= self.from && (sign < self.to || is_last && sign <= self.to);
                return match [-1.0, 0.0, 1.0].map(holds) {
                    [true, false, false] => "while the cable is reeled in",
                    [false, true, false] => "while the cable rests",
                    [false, false, true] => "while the cable is paid out",
                    // Also of a cable that never rests.
                    [false, true, true] => "while the cable is not reeled in",
                    [true, true, false] => "while the cable is not paid out",
                    _ => "throughout",
                }
                .to_owned();
            }
            "frequency" => return format!("at {:.2} Hz", self.from),
            "way_since_reversal" => {
                return match (is_first, is_last) {
                    (true, true) => "throughout".to_owned(),
                    (true, false) => format!("within {} after a reversal", value(self.to)),
                    (false, true) => format!("more than {} after a reversal", value(self.from)),
                    (false, false) => format!("{} to {} after a reversal", value(self.from), value(self.to)),
                };
            }
            _ => {}
        }
        let noun = plural(self.signal);
        match (is_first, is_last) {
            (true, true) => format!("at all {noun}"),
            (true, false) => format!("at {noun} below {}", value(self.to)),
            (false, true) => format!("at {noun} above {}", value(self.from)),
            (false, false) => format!("at {noun} of {} to {}", value(self.from), value(self.to)),
        }
    }

    fn is_whole(&self) -> bool {
        self.share_of_samples.is_some_and(|share| share >= WHOLE)
    }

    /// Returns the fraction of the excess in the range, as a sentence without its full stop. `of` names the quantity.
    #[must_use]
    pub fn in_words(&self, of: &str, times: &Times<'_>) -> String {
        // Writing to a String cannot fail.
        let mut text = match self.share_of_excess {
            // A range that holds all samples tells nothing, but that the condition matters.
            Some(_) if self.is_whole() => format!("{of} changes with the {}", condition(self.signal)),
            Some(share) => format!("{} of {of} sits {}", percent(share), self.range_in_words()),
            None => format!("{of} sits {}", self.range_in_words()),
        };
        if let Some(share) = self.share_of_samples.filter(|_| !self.is_whole()) {
            let _ = write!(text, ", {} of the samples", percent(share));
        }
        if self.significance.is_some_and(|significance| significance < LEAST_CONCENTRATION) {
            text += ", which may be chance";
        }
        if !self.intervals_s.is_empty() {
            let _ = write!(text, "; look at {}", times.in_words(&self.intervals_s));
        }
        text
    }
}

fn plural(signal: &str) -> String {
    match signal {
        "force_rate" => "rates of the sensor force".to_owned(),
        _ => condition(signal) + "s",
    }
}

fn with_unit(number: f64, unit: &str) -> String {
    let text = significant(number);
    if unit == "1" { text } else { format!("{text} {unit}") }
}

/// Lists effects by kind, each kind once, with what the log cannot tell from them.
fn names(effects: &[&EffectResult]) -> String {
    let is_first =
        |(place, effect): &(usize, &&EffectResult)| !effects[..*place].iter().any(|of| of.kind == effect.kind);
    let name = |(_, effect): (usize, &&EffectResult)| {
        let kind = effect.kind;
        let is_twice = effects.iter().filter(|other| other.kind == kind).count() > 1;
        match effect.runner_up.as_ref().filter(|other| other.as_good) {
            _ if is_twice => format!("{kind} (two)"),
            Some(other) => format!("{kind} (or {})", other.kind),
            None => kind.to_owned(),
        }
    };
    listed(&effects.iter().enumerate().filter(is_first).map(name).collect::<Vec<String>>())
}

impl DiscoverCableResult {
    /// Returns which friction parameters are at the end of their range, as a sentence without its full stop; `None` if none is.
    #[must_use]
    pub fn bound_in_words(&self) -> Option<String> {
        let values = self.values_of(&self.at_bound)?;
        Some(format!("{values} is the end of the range; no pulley rubs so much: compare units, zero and pulleys"))
    }

    /// Returns which given values the log contradicts without determining others, as a sentence without its full stop; `None` if it contradicts none.
    #[must_use]
    pub fn undetermined_in_words(&self) -> Option<String> {
        let values = self.values_of(&self.undetermined)?;
        let mut text = if self.undetermined.len() == 1 {
            format!(
                "the log contradicts the given value but does not determine a better one; {values} is one of many that agree"
            )
        } else {
            format!(
                "the log contradicts the given values but does not determine better ones; {values} are one choice of many that agree"
            )
        };
        if self.undetermined.iter().filter_map(|name| Parameter::named(name)).any(|parameter| is_gain(&parameter)) {
            text += ", because the load varies too little to tell a gain from a zero, which stays as given";
        }
        Some(text)
    }

    /// Returns which parameters of the file's effects the log has otherwise, as sentences without their full stops.
    #[must_use]
    pub fn revised_in_words(&self) -> Vec<String> {
        let sentence = |revised: &RevisedResult| {
            let value = quantity(revised.value, Some(HALF_INTERVAL * revised.standard_error), revised.unit);
            let given = quantity(revised.given, None, revised.unit);
            format!("{} of the file is {given}; the log has {value} (95 %)", revised.parameter)
        };
        self.revised.iter().map(sentence).collect()
    }

    fn values_of(&self, names: &[String]) -> Option<String> {
        let value = |name: &String| self.parameters.get(name).map(|value| format!("{name} = {}", significant(value)));
        let values: Vec<String> = names.iter().filter_map(value).collect();
        (!values.is_empty()).then(|| listed(&values))
    }

    /// Returns how many samples were left out because each is off by itself, as a sentence without its full stop; `None` if none was, or if spikes of
    /// the sensor are told.
    #[must_use]
    pub fn outliers_in_words(&self) -> Option<String> {
        let has_spikes = self.faults.iter().any(|fault| fault.fault == Fault::Spikes);
        match self.left_out.outliers {
            _ if has_spikes => None,
            0 => None,
            1 => Some("1 sample is left out because it is off by itself, as a spike is".to_owned()),
            count => Some(format!("{count} samples are left out because each is off by itself, as spikes are")),
        }
    }

    /// Returns the verdict on the cable in sentences. `is_beside_rest` says that something is left of the wrench that is of no cable.
    #[must_use]
    pub fn verdict_in_words(&self, is_beside_rest: bool) -> String {
        if let Some(missing) = &self.missing {
            return format!("Nothing can be told: {}. {}", missing.cause, missing.advice);
        }
        let all: Vec<&EffectResult> = self.effects.iter().collect();
        // Part of a rest that is not explained looks like a wander.
        let is_explained = matches!(self.verdict, Verdict::Complete | Verdict::Extended);
        let wander_n = self.wander_n.filter(|wander_n| is_explained && *wander_n > 0.0).map(newtons);
        let mut text = match self.verdict {
            Verdict::Complete if is_beside_rest => "Nothing of what is left of the wrench is told to be of this cable.".to_owned(),
            Verdict::Extended if is_beside_rest => {
                format!("The model lacks {}. Nothing of what is left of the wrench is told to be of this cable.", names(&all))
            }
            Verdict::Complete if wander_n.is_some() => "No effect of the catalogue is missing.".to_owned(),
            Verdict::Complete if self.tried.iter().any(|tried| tried.refusal == Some(Refusal::WithinNoise)) => {
                "With values fitted to the log, the model agrees with it to the noise, as far as the log shows what its noise is. \
                 A longer log would tell whether something small is missing."
                    .to_owned()
            }
            Verdict::Complete => {
                "Nothing is missing: with values fitted to the log, the model agrees with it to the noise.".to_owned()
            }
            Verdict::Extended => {
                let with = if all.len() > 1 { "them" } else { "it" };
                format!("The model lacks {}; with {with}, what is left is noise.", names(&all))
            }
            Verdict::Unexplained | Verdict::Untold => {
                let named: Vec<&EffectResult> =
                    all.iter().copied().filter(|effect| effect.effect != Effect::Empirical).collect();
                let lacks =
                    if named.is_empty() { String::new() } else { format!("The model lacks {}. ", names(&named)) };
                let rest = lacks + &self.rest_in_words();
                if named.len() == all.len() {
                    rest
                } else {
                    rest + " A table stands in for it, unnamed: how large it is, and where."
                }
            }
        };
        if !self.faults.is_empty() {
            text += " The log has trouble of its own that is no matter of friction.";
        }
        if let Some(wander) = wander_n {
            text += " Beside white noise, ";
            text += &wander;
            text += " are left that go with nothing the cable does, as of an amplifier that smooths its noise or a zero that wanders.";
        }
        text
    }

    /// Returns what remains, in a sentence.
    fn rest_in_words(&self) -> String {
        let mut takers = self.tried.iter().filter(|tried| tried.takes_rest);
        match takers.find(|tried| tried.refusal.is_some_and(Refusal::leaves_open)) {
            None => "Something remains that no effect of the catalogue accounts for.".to_owned(),
            Some(TriedResult { refusal: Some(Refusal::Usual), kind, .. }) => {
                format!("What remains is no more than sound robots have: {kind} of such a size accounts for it.")
            }
            Some(first) => {
                let alike = takers.filter(|tried| tried.refusal == first.refusal).map(|tried| tried.kind);
                let kinds: Vec<&str> = std::iter::once(first.kind).chain(alike).collect();
                format!("What remains may be {}, but {}.", kinds.join(" or "), first.reason)
            }
        }
    }

    /// Returns the gap before and after, as a sentence without its full stop.
    #[must_use]
    pub fn gap_in_words(&self) -> Option<String> {
        let (before, after, floor_n) = (self.before?, self.after?, self.noise_floor_n?);
        let ends = format!(
            "rms {} before, {} after; the noise is {}",
            newtons(before.rms_n),
            newtons(after.rms_n),
            newtons(floor_n)
        );
        Some(match self.gap_closed.filter(|_| !self.effects.is_empty()) {
            Some(share) => format!("{ends}: {} of the gap closed", percent(share)),
            None if self.verdict == Verdict::Complete => {
                format!("rms {} with fitted values; the noise is {}", newtons(after.rms_n), newtons(floor_n))
            }
            None => ends,
        })
    }

    /// Returns the remaining error relative to the reference's own variation, as a sentence without its full stop; `None` if nothing was measured.
    #[must_use]
    pub fn variation_in_words(&self) -> Option<String> {
        let (after, variation_n) = (self.after?, self.reference_variation_n?);
        if self.is_constant() {
            return Some(format!(
                "the reference varies by {} only: a model that predicts a constant agrees with it as well, so that nothing is \
                 known of a gain, or of what goes with the load",
                newtons(variation_n)
            ));
        }
        Some(format!("rms after is {} of what the reference varies by", percent(after.rms_n / variation_n)))
    }

    /// Whether the reference varies by no more than the model's error.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        let left_n = self.after.map_or(f64::INFINITY, |after| after.rms_n);
        self.reference_variation_n.is_some_and(|variation_n| variation_n <= left_n)
    }
}

impl UnexplainedResult {
    /// Returns where the rest is concentrated, as sentences without their full stops.
    #[must_use]
    pub fn in_words(&self, times: &Times<'_>) -> Vec<String> {
        let mut sentences = Vec::new();
        sentences.extend(self.places.iter().take(2).map(|place| place.in_words("the rest", times)));
        let neighbours: Vec<String> = self.goes_with.iter().filter(|signal| signal.contains(' ')).cloned().collect();
        if !neighbours.is_empty() {
            sentences.push(format!("it goes with signals of other cables: {}", listed(&neighbours)));
        }
        if !self.intervals_s.is_empty() {
            sentences.push(format!("it is loud at {}", times.in_words(&self.intervals_s)));
        }
        if sentences.is_empty() {
            sentences.push("it is spread over the whole log and goes with no condition".to_owned());
        }
        sentences
    }
}
