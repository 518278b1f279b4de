//! Parts of a result in words, for the terminal and for pages.

use std::fmt::Write as _;

use fric_core::effects::Effect;

use super::faults::Fault;
use super::naming::Refusal;
use super::rest::places::LEAST_CONCENTRATION;
use super::result::{
    CommonEffect, CommonParameter, DiscoverCableResult, EffectResult, Evidence, FaultResult, RunnerUpResult,
    TablePoint, TableResult, TriedResult, UnexplainedResult, WhereResult, WrenchComponent, WrenchGap,
};
use crate::fit::HALF_INTERVAL;
use crate::replay::WrenchReference;
use crate::text::{listed, number, quantity, significant, wrapped};

/// Unit suffixes of keys, the longer ones first.
const UNITS: [&str; 13] = [
    "_n_s2_per_m2",
    "_n_s_per_m",
    "_per_n",
    "_m_per_s",
    "_n_per_m",
    "_n_per_s",
    "_m_per_n",
    "_per_s",
    "_kg",
    "_nm",
    "_s",
    "_n",
    "_m",
];

/// The lower end of a range counts as zero below this fraction of the upper end.
const NO_MORE_THAN_ZERO: f64 = 0.01;

/// Returns a parameter's key without its unit.
#[must_use]
pub fn name_of(key: &str) -> String {
    let name = UNITS.iter().find_map(|unit| key.strip_suffix(unit)).unwrap_or(key);
    name.replace('_', " ")
}

/// Formats a fraction in per cent, clamped to 0…100 %.
#[must_use]
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share.clamp(0.0, 1.0);
    // A fraction just below 100 % must not be rounded to 100 %, so values that would round to 99 or 100 get one more digit.
    if (98.5..99.95).contains(&percent) { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// Formats a force.
#[must_use]
pub fn newtons(force_n: f64) -> String {
    format!("{force_n:.4} N")
}

/// Formats a BIC difference.
#[must_use]
pub fn evidence(delta_bic: Option<f64>) -> String {
    delta_bic.map_or_else(|| "–".to_owned(), |of| number(of, 0).replace('-', "−"))
}

/// Formats a significance in standard errors. The number is truncated, not rounded, so that it stays on its side of a limit.
#[must_use]
pub fn significance(errors: f64) -> String {
    if errors < 10.0 {
        format!("{:.1} σ", (10.0 * errors).floor() / 10.0)
    } else {
        format!("{:.0} σ", errors.floor())
    }
}

/// Formats a time interval without its unit.
#[must_use]
pub fn interval([from_s, to_s]: &[f64; 2]) -> String {
    let digits = if to_s - from_s < 0.2 { 2 } else { 1 };
    let (from, to) = (format!("{from_s:.digits$}"), format!("{to_s:.digits$}"));
    if from == to { from } else { format!("{from}…{to}") }
}

/// Formats time intervals.
#[must_use]
pub fn intervals(intervals_s: &[[f64; 2]]) -> String {
    let all: Vec<String> = intervals_s.iter().map(interval).collect();
    format!("{} s", all.join(", "))
}

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
            "direction" if self.to <= 0.0 => return "while the cable is reeled in".to_owned(),
            "direction" if self.from >= 0.0 => return "while the cable is paid out".to_owned(),
            "standstill" | "direction" => return "throughout".to_owned(),
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

    /// Returns the fraction of the excess in the range, as a sentence without its full stop. `of` names the quantity.
    #[must_use]
    pub fn in_words(&self, of: &str) -> String {
        // Writing to a String cannot fail.
        let mut text = match self.share_of_excess {
            Some(share) => format!("{} of {of} sits {}", percent(share), self.range_in_words()),
            None => format!("{of} sits {}", self.range_in_words()),
        };
        if let Some(share) = self.share_of_samples.filter(|share| *share < 0.995) {
            let _ = write!(text, ", {} of the samples", percent(share));
        }
        if self.significance.is_some_and(|significance| significance < LEAST_CONCENTRATION) {
            text += ", which may be chance";
        }
        if !self.intervals_s.is_empty() {
            let _ = write!(text, "; look at {}", intervals(&self.intervals_s));
        }
        text
    }
}

/// Returns a condition's name in words.
#[must_use]
pub fn condition(signal: &str) -> String {
    match signal {
        "length" => "cable length".to_owned(),
        "load" => "cable tension".to_owned(),
        "way_since_reversal" => "way since the last reversal".to_owned(),
        "force_rate" => "rate of the sensor force".to_owned(),
        "reference_rate" => "rate of the reference".to_owned(),
        "wrap" => "wrap angle".to_owned(),
        _ => signal.replace('_', " "),
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

impl DiscoverCableResult {
    /// Returns the verdict on the cable in sentences.
    #[must_use]
    pub fn verdict_in_words(&self) -> String {
        if let Some(missing) = &self.missing {
            return format!("Nothing can be told: {}. {}", missing.cause, missing.advice);
        }
        let kinds: Vec<&str> = self.effects.iter().map(|effect| effect.kind).collect();
        let wander_n = self.wander_n.filter(|wander_n| *wander_n > 0.0).map(newtons);
        let mut text = match (self.verdict, kinds.as_slice()) {
            ("complete", _) if wander_n.is_some() => "No effect of the catalogue is missing.".to_owned(),
            ("complete", _) => {
                "Nothing is missing: with values fitted to the log, the model agrees with it to the noise.".to_owned()
            }
            ("extended", kinds) => format!("The model lacks {}; with it, what is left is noise.", listed(kinds)),
            (_, kinds) => {
                let named: Vec<&str> = kinds.iter().copied().filter(|kind| *kind != Effect::Empirical.kind()).collect();
                let lacks =
                    if named.is_empty() { String::new() } else { format!("The model lacks {}. ", listed(&named)) };
                let rest = lacks + "Something remains that no effect of the catalogue accounts for.";
                if named.len() == kinds.len() {
                    rest
                } else {
                    rest + " A table stands in for it, unnamed: how large it is, and where."
                }
            }
        };
        if kinds.len() > 1 {
            text = text.replace("with it,", "with them,");
        }
        if !self.faults.is_empty() {
            text += " The log has trouble of its own that is no matter of friction.";
        }
        if let Some(wander) = wander_n {
            text += " Beside white noise a slow wander of ";
            text += &wander;
            text += " is left that goes with nothing the cable does.";
        }
        text
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
            None if self.verdict == "complete" => {
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

impl TriedResult {
    /// Returns the evidence and the reason for the refusal, as a sentence without its full stop.
    #[must_use]
    pub fn in_words(&self) -> String {
        let Evidence { delta_bic, held_out_rms_n } = &self.evidence;
        let rms = held_out_rms_n.map_or_else(|| "–".to_owned(), newtons);
        format!("{} helps, to rms {rms} with ΔBIC {}, but {}", self.kind, evidence(*delta_bic), self.reason)
    }
}

impl WrenchGap {
    /// Returns what the forces were compared with.
    #[must_use]
    pub fn title(&self) -> &'static str {
        if self.reference == WrenchReference::Mass.name() { "wrench, by mass" } else { "wrench" }
    }

    /// Returns the findings for all cables together, as sentences.
    #[must_use]
    pub fn in_words(&self) -> Vec<String> {
        let alike = self.alike.iter().map(|kind| format!("All cables have {kind} alike, with one value."));
        let wrong = self.geometry.iter().map(|wrong| {
            let numbers = wrong.parameters.0.iter().map(|(name, number)| format!("{name} = {number:.5}"));
            let of = wrong.cable.as_ref().map_or_else(String::new, |cable| format!(" of {cable}"));
            let numbers: Vec<String> = numbers.collect();
            format!("The robot file's {}{of} is wrong: {}.", wrong.kind, numbers.join(", "))
        });
        let tried =
            self.tried.iter().map(|tried| format!("Tried for all cables together: {}: {}.", tried.kind, tried.reason));
        alike.chain(wrong).chain(tried).collect()
    }
}

impl WrenchComponent {
    /// Returns name, noise, and root mean square before and after.
    #[must_use]
    pub fn cells(&self) -> [String; 4] {
        let unit = if self.name.ends_with("_nm") { "Nm" } else { "N" };
        let cell = |number: f64| format!("{number:.4} {unit}");
        let name = self.name.split('_').next().unwrap_or(self.name).to_owned();
        [name, cell(self.noise), cell(self.before), cell(self.after)]
    }
}

impl EffectResult {
    /// Returns the parameters with their 95 % intervals.
    #[must_use]
    pub fn values_in_words(&self) -> String {
        if let Some(table) = &self.table {
            return table.in_words();
        }
        let one = |parameter: &fric_core::parameters::ParameterRow| {
            let value = self.parameters.get(parameter.key)?;
            let half = self.standard_errors.get(parameter.key).map(|error| HALF_INTERVAL * error);
            Some(format!("{} {}", name_of(parameter.key), quantity(value, half, parameter.unit)))
        };
        let all: Vec<String> = self.effect.row().parameters.iter().filter_map(one).collect();
        all.join(", ")
    }

    /// Returns the alternative explanation, as a sentence without its full stop.
    #[must_use]
    pub fn alternative_in_words(&self) -> Option<String> {
        let RunnerUpResult { kind, delta_bic, held_out_rms_n, as_good, effect } = self.runner_up.as_ref()?;
        let rms = held_out_rms_n.map(newtons)?;
        if *as_good {
            return Some(format!(
                "the log cannot tell it from {kind} (rms {rms}); to tell them apart record {}",
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

impl Refusal {
    /// Returns the reason why a candidate that helps is not named, as a clause.
    #[must_use]
    pub fn in_words(self) -> String {
        match self {
            Self::Weak => "the evidence is weaker than what chance may give".to_owned(),
            Self::AtBound => "its parameter runs to the end of its range".to_owned(),
            Self::Open(other) => format!("the log cannot tell it from {}", name_of(other)),
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
            Self::Usual => "it is no more than what robots without it have".to_owned(),
            Self::UsualInstead(usual) => {
                format!("{} of a size that robots usually have leaves little for it to explain", usual.kind())
            }
            Self::Bent(signal) => {
                format!(
                    "what is left would go away if its size went with the {}: its law is another one",
                    condition(signal)
                )
            }
        }
    }
}

/// Describes the recording faults of each cable, one paragraph per fault; empty if there are none.
pub fn recording_lines<'a>(cables: impl Iterator<Item = (&'a str, &'a [FaultResult])>) -> String {
    let told = cables.flat_map(|(name, faults)| {
        faults.iter().map(move |fault| wrapped(&format!("{name}, recording: "), &fault.in_words()))
    });
    let text: String = told.collect();
    if text.is_empty() { text } else { format!("\n{text}") }
}

impl FaultResult {
    /// Returns the fault and what to do, as a sentence without its full stop.
    #[must_use]
    pub fn in_words(&self) -> String {
        let value = |key: &str| self.parameters.get(key).unwrap_or(f64::NAN);
        let left_out = || format!("at {}: left out of all the rest", intervals(&self.intervals_s));
        match self.fault {
            Fault::Hum => format!(
                "it hums at {:.2} Hz with an amplitude of {}: no friction does; look at wiring and amplifiers",
                value("frequency_hz"),
                newtons(value("amplitude_n"))
            ),
            Fault::Vibration => format!(
                "it vibrates at {:.2} Hz, damped by {} of the critical, {} rms: a mount or a frame that rings; stiffen it, fix the sensor nearer to the \
                 pulley, or drive it with less jerk",
                value("frequency_hz"),
                significant(value("damping_ratio")),
                newtons(value("rms_n"))
            ),
            Fault::NoisyLength => format!(
                "the length trembles by {} m (standard deviation), which the model takes for motion; `length_noise_m` = {} m of the monitor keeps \
                 it out, which an extended file sets; look at the encoder's resolution, supply and shielding",
                significant(value("noise_m")),
                significant(value("length_noise_m"))
            ),
            Fault::Frozen => format!("the force sensor stands still {}", left_out()),
            Fault::Clipped => format!("the force sensor is at the end of its range {}", left_out()),
            Fault::Spikes => {
                format!(
                    "the force sensor spikes {}; look at its cable, its plugs and what switches beside it",
                    left_out()
                )
            }
            Fault::CoarseConverter => format!(
                "the force sensor has steps of {}, which are part of the noise; use more of the converter's range, or one of more bits",
                newtons(value("step_n"))
            ),
            Fault::ReferenceDelay => format!(
                "the reference comes late by {}, and was put where it belongs; stamp it where it is measured, or take the filter of its \
                 amplifier into account",
                quantity(value("delay_s"), None, "s")
            ),
            Fault::ClockSkew => format!(
                "the reference gets ahead by {} s each second, and comes late by {} s at the beginning: its clock is another one; it was put \
                 where it belongs; record both with one clock, or synchronise them",
                significant(value("skew_ratio")),
                significant(value("delay_s"))
            ),
        }
    }
}

impl UnexplainedResult {
    /// Returns where the rest is concentrated, as sentences without their full stops.
    #[must_use]
    pub fn in_words(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        sentences.extend(self.places.iter().take(2).map(|place| place.in_words("the rest")));
        let neighbours: Vec<String> = self.goes_with.iter().filter(|signal| signal.contains(' ')).cloned().collect();
        if !neighbours.is_empty() {
            sentences.push(format!("it goes with signals of other cables: {}", listed(&neighbours)));
        }
        if !self.intervals_s.is_empty() {
            sentences.push(format!("it is loud at {}", intervals(&self.intervals_s)));
        }
        if sentences.is_empty() {
            sentences.push("it is spread over the whole log and goes with no condition".to_owned());
        }
        sentences
    }
}

impl CommonEffect {
    /// Returns on how many of all cables the effect occurs, with its parameters over them.
    #[must_use]
    pub fn in_words(&self, cable_count: usize) -> String {
        let on = if self.cables.len() == cable_count {
            match cable_count {
                2 => "both cables".to_owned(),
                count => format!("all {} cables", counted(count)),
            }
        } else {
            listed(&self.cables)
        };
        let values: Vec<String> = self.parameters.iter().map(CommonParameter::in_words).collect();
        format!("{} on {on}: {}", self.kind, values.join(", "))
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

fn counted(count: usize) -> String {
    const WORDS: [&str; 13] =
        ["no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"];
    WORDS.get(count).map_or_else(|| count.to_string(), |word| (*word).to_owned())
}
