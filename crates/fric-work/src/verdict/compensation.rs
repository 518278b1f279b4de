//! Verdicts on a replay, a fit and a hysteresis: how much of an error compensation leaves.

use fric_core::parameters::OFFSET;
use fric_lab::errors::{ForceError, WrenchError};
use fric_lab::fit::result::{FitCableResult, FitResult};
use fric_lab::fit::{HALF_INTERVAL, Parameter};
use fric_lab::hysteresis::HysteresisResult;
use fric_lab::text::{listed, significant};

use super::{Tone, Verdict, counted};
use crate::replay::{CableResult, ReplayResult};

/// Maximum remaining fraction of the error for a model that works. Twice and half this value change only the wording, no number. The measured robots
/// of \[P\] leave 5 to 20 %.
const WORKS: f64 = 0.3;

/// Remaining fraction of the error above which, on every cable, nearly all of it is something else. Like [`WORKS`] it changes only the wording.
const HARDLY_HELPS: f64 = 0.9;

/// Number of samples below which an rms is off by a quarter by chance, `1/√(2n)`, and no verdict follows. Like [`WORKS`] it changes only the wording.
const FEWEST: u64 = 8;

/// Fraction of flagged samples above which they are mentioned.
const MANY_FLAGGED: f64 = 0.01;

/// Formats a remaining fraction of an error, in per cent with one decimal.
#[must_use]
pub fn left_in_words(left: f64) -> String {
    if left.is_finite() { format!("{:.1} %", 100.0 * left) } else { "–".to_owned() }
}

/// Formats the range of remaining fractions.
pub(crate) fn range_in_words(shares: impl Iterator<Item = f64>) -> String {
    let (least, greatest) = shares
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), share| (least.min(share), greatest.max(share)));
    let [least, greatest] = [least, greatest].map(left_in_words);
    if least == greatest { least } else { format!("{least} to {greatest}") }
}

/// Errors before and after, and their name.
struct Compared {
    name: String,
    before: f64,
    after: f64,
    unit: &'static str,
    /// The remaining fraction of the mean error, which few samples far from the others hardly change; NaN for what is no cable's force.
    mean_left: f64,
}

impl Compared {
    fn of_cable(cable: &CableResult) -> Option<Self> {
        Some(Self::of_forces(&cable.name, cable.before.as_ref()?, cable.after.as_ref()?))
    }

    fn of_forces(name: &str, before: &ForceError, after: &ForceError) -> Self {
        let mean_left = after.mae_n / before.mae_n;
        Self { mean_left, ..Self::new(name.to_owned(), [before.rms_n, after.rms_n], "N") }
    }

    fn new(name: String, [before, after]: [f64; 2], unit: &'static str) -> Self {
        Self { name, before, after, unit, mean_left: f64::NAN }
    }

    fn of_wrench(before: &WrenchError, after: &WrenchError) -> [Self; 2] {
        let force_n = [before.force_rms_n, after.force_rms_n];
        let torque_nm = [before.torque_rms_nm, after.torque_rms_nm];
        [
            Self::new("the force on the platform".to_owned(), force_n, "N"),
            Self::new("the torque on the platform".to_owned(), torque_nm, "Nm"),
        ]
    }

    fn left(&self) -> f64 {
        self.after / self.before
    }

    /// Whether the error became worse by an amount that the tables show.
    fn is_worse(&self) -> bool {
        self.after > self.before && format!("{:.4}", self.after) != format!("{:.4}", self.before)
    }

    pub(super) fn in_words(&self) -> String {
        format!("{} (rms {:.4} {} before, {:.4} {} after)", self.name, self.before, self.unit, self.after, self.unit)
    }
}

/// Returns a sentence about errors that became worse; `None` if none did.
fn worse(all: &[Compared]) -> Option<String> {
    let worse: Vec<String> = all.iter().filter(|one| one.is_worse()).map(Compared::in_words).collect();
    (!worse.is_empty()).then(|| format!("Compensation makes {} worse.", listed(&worse)))
}

/// Returns the remaining fraction of errors that did not become worse; `None` if there are none.
fn share_left(of: &str, all: &[Compared]) -> Option<String> {
    let better = all.iter().filter(|one| !one.is_worse());
    let shares: Vec<f64> = better.map(Compared::left).filter(|left| left.is_finite()).collect();
    (!shares.is_empty()).then(|| format!("{} of {of}", range_in_words(shares.into_iter())))
}

/// Returns what is left where compensation works but for few samples that make the rms: spikes, or a short stretch of a faulty sensor.
fn left_by_few(cables: &[Compared]) -> Option<String> {
    let by_few = cables.iter().any(|one| one.left() > WORKS) && cables.iter().all(|one| one.mean_left <= WORKS);
    by_few.then(|| {
        let means = range_in_words(cables.iter().map(|one| one.mean_left));
        let all = range_in_words(cables.iter().map(Compared::left));
        format!("{means} of the mean error, and {all} of the rms error, which few samples make")
    })
}

fn wrench_left(wrench: &[Compared]) -> Option<String> {
    share_left("the error of the wrench on the platform", wrench)
}

impl CableResult {
    /// Returns the remaining fraction of the error with compensation; `None` without a reference.
    #[must_use]
    pub fn left(&self) -> Option<f64> {
        let (before, after): (&ForceError, &ForceError) = self.before.as_ref().zip(self.after.as_ref())?;
        Some(after.rms_n / before.rms_n).filter(|left| left.is_finite())
    }
}

impl ReplayResult {
    /// Returns the effect of compensation on the error of the forces, in a sentence; errors that become worse come first.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let cables: Vec<Compared> = self.cables.iter().filter_map(Compared::of_cable).collect();
        let wrench: Vec<Compared> =
            self.wrench.iter().flat_map(|wrench| Compared::of_wrench(&wrench.before, &wrench.after)).collect();
        let of_cables = share_left("the force error", &cables);
        let of_cables = of_cables.map(|words| {
            let count = cables.iter().filter(|cable| !cable.is_worse()).count();
            format!("{words} ({})", counted(count, "cable"))
        });
        let of_wrench = if cables.is_empty() { wrench_left(&wrench) } else { None };
        let shown = if cables.is_empty() { &wrench } else { &cables };
        let least = shown.iter().map(Compared::left).filter(|left| left.is_finite()).fold(1.0, f64::min);
        // Where the wrench is worse than the forces, the words have to be about it.
        let of_forces = cables.iter().map(Compared::left).filter(|left| left.is_finite()).fold(0.0, f64::max);
        let beside = if of_forces <= WORKS {
            wrench_left(&wrench).filter(|_| wrench.iter().any(|one| one.left() > WORKS))
        } else {
            None
        };
        let by_few = left_by_few(&cables);
        let all: Vec<Compared> = cables.into_iter().chain(wrench).collect();
        let greatest = all.iter().map(Compared::left).filter(|left| left.is_finite()).fold(0.0, f64::max);
        let left = match (of_cables, beside) {
            (Some(forces), Some(wrench)) => Some(format!("{forces}, but {wrench}")),
            (forces, _) => forces.or(of_wrench),
        };
        let flagged = self.cables.iter().filter(|cable| is_many(cable.flagged, cable.samples));
        let flagged = flagged.max_by_key(|cable| cable.flagged).map(|cable| {
            let CableResult { name, flagged, samples, .. } = cable;
            format!(" Flagged samples count in it, {flagged} of {samples} of {name}; see to them first.")
        });
        let (tone, sentence) = match (worse(&all), left) {
            _ if !all.is_empty() && self.cycle.count < FEWEST => {
                let count = counted(self.cycle.count, "usable sample");
                (Tone::Mixed, format!("The log has {count}, too few for a verdict."))
            }
            _ if !all.is_empty() && all.iter().all(|one| one.before == 0.0 && one.after == 0.0) => {
                let same =
                    "Sensor and reference are the same to the last digit: is one column or topic named for both?";
                (Tone::Mixed, same.to_owned())
            }
            (Some(worse), left) => {
                let elsewhere = left.map_or_else(String::new, |left| format!(" Elsewhere it leaves {left}."));
                (Tone::Bad, format!("{worse}{elsewhere}{}", flagged.unwrap_or_default()))
            }
            (None, Some(_)) if by_few.is_some() => {
                let left = by_few.unwrap_or_default();
                (Tone::Mixed, format!("Compensation works but for single samples: it leaves {left}."))
            }
            (None, Some(left)) if greatest <= WORKS => (Tone::Well, format!("Compensation works: it leaves {left}.")),
            (None, Some(left)) if least <= HARDLY_HELPS => {
                (Tone::Mixed, format!("Compensation helps in part: it leaves {left}."))
            }
            (None, Some(left)) => (
                Tone::Bad,
                format!(
                    "Compensation hardly helps: it leaves {left}.{}",
                    flagged.as_deref().unwrap_or(" Friction by these values makes little of it.")
                ),
            ),
            (None, None) if self.cables.iter().all(|cable| !cable.is_measured) => {
                (Tone::Bad, "Nothing is compensated: the log has no force of any sensor.".to_owned())
            }
            (None, None) => (
                Tone::Mixed,
                "The forces are compensated, but how well is not known: the log has nothing to compare them with."
                    .to_owned(),
            ),
        };
        Verdict { tone, sentence, todo: self.todo(tone, all.is_empty()) }
    }

    fn todo(&self, tone: Tone, is_uncompared: bool) -> Vec<String> {
        let mut todo = Vec::new();
        if is_uncompared && self.cables.iter().any(|cable| cable.is_measured) {
            todo.push(
                "Record the force at the platform, or state one that is known as `reference` under `[log]` in the robot file, to learn how \
                 well the model fits."
                    .to_owned(),
            );
        }
        if !is_uncompared && tone == Tone::Bad {
            todo.push(
                "Do not use these values in the control loop: fit them to a log of this machine (fric-cli fit)."
                    .to_owned(),
            );
        }
        if !is_uncompared && tone != Tone::Well {
            todo.push("See what the model lacks: fric-cli discover with the same log and model.".to_owned());
        }
        for cable in self.cables.iter().filter(|cable| is_many(cable.flagged, cable.samples)) {
            todo.push(format!(
                "Look at {}: {} of {} samples are flagged; the warnings say why.",
                cable.name, cable.flagged, cable.samples
            ));
        }
        for cable in self.cables.iter().filter(|cable| !cable.faults.is_empty()) {
            todo.push(format!("Mend the recording of {}; its faults are listed.", cable.name));
        }
        if todo.is_empty() {
            todo.push(
                "Nothing, if this is another log than the one to which the values were fitted: they can go to the control loop."
                    .to_owned(),
            );
        }
        todo
    }
}

#[expect(clippy::cast_precision_loss, reason = "counts of samples")]
fn is_many(flagged: u64, samples: u64) -> bool {
    flagged as f64 > MANY_FLAGGED * samples as f64
}

/// Returns the verdict on a fit: the remaining fraction of the error.
#[must_use]
pub fn of_fit(result: &FitResult) -> Verdict {
    let of_cable =
        |cable: &FitCableResult| Some(Compared::of_forces(&cable.name, cable.before.as_ref()?, cable.after.as_ref()?));
    let cables: Vec<Compared> = result.cables.iter().filter_map(of_cable).collect();
    let wrench: Vec<Compared> =
        result.wrench.iter().flat_map(|wrench| Compared::of_wrench(&wrench.before, &wrench.after)).collect();
    let by_few = left_by_few(&cables);
    let is_by_few = by_few.is_some();
    let left = by_few.or_else(|| share_left("the force error", &cables)).or_else(|| wrench_left(&wrench));
    let all: Vec<Compared> = cables.into_iter().chain(wrench).collect();
    let greatest = all.iter().map(Compared::left).filter(|left| left.is_finite()).fold(0.0, f64::max);
    let (fitted, it) = fitted(result);
    let worse = worse(&all);
    let it = if worse.is_some() { format!("elsewhere {it}") } else { it.to_owned() };
    let least = all.iter().map(Compared::left).filter(|left| left.is_finite()).fold(1.0, f64::min);
    let nothing =
        if !all.is_empty() && least > HARDLY_HELPS && !is_by_few { " It explains next to nothing." } else { "" };
    let left = left.map_or_else(|| format!("{fitted}."), |left| format!("{fitted}; {it} leaves {left}.{nothing}"));
    let left = of_zeros(result).map_or(left.clone(), |zeros| format!("{left} {zeros}"));
    let (tone, sentence) = match worse {
        Some(worse) => (Tone::Bad, format!("{worse} {left}")),
        None if greatest <= WORKS => (Tone::Well, left),
        None if nothing.is_empty() => (Tone::Mixed, left),
        None => (Tone::Bad, left),
    };
    let mut todo = Vec::new();
    for (cables, names) in grouped(result, |cable| &cable.undetermined) {
        todo.push(format!(
            "{cables}: the log does not determine {names}, kept as given; record a run that does (fric-cli excite)."
        ));
    }
    for (cables, names) in grouped(result, |cable| &cable.at_bound) {
        todo.push(format!(
            "{cables}: {names} is at the end of its range; see what else the model lacks (fric-cli discover)."
        ));
    }
    for cable in result.cables.iter().filter(|cable| !cable.faults.is_empty()) {
        todo.push(format!("Mend the recording of {}; its faults are listed.", cable.name));
    }
    if tone != Tone::Well {
        todo.push("See what the model lacks: fric-cli discover with the same log and model.".to_owned());
    }
    todo.push("Replay another log with the fitted file: that judges it, this log taught it.".to_owned());
    Verdict { tone, sentence, todo }
}

/// Returns the cables with the same parameters, and these, as phrases; cables without any are left out.
fn grouped(result: &FitResult, pick: fn(&FitCableResult) -> &Vec<String>) -> Vec<(String, String)> {
    let mut groups: Vec<(&[String], Vec<&str>)> = Vec::new();
    for cable in result.cables.iter().filter(|cable| !pick(cable).is_empty()) {
        match groups.iter_mut().find(|(names, _)| *names == pick(cable).as_slice()) {
            Some((_, cables)) => cables.push(&cable.name),
            None => groups.push((pick(cable), vec![&cable.name])),
        }
    }
    let in_words = |(names, cables): (&[String], Vec<&str>)| {
        let is_all = cables.len() > 1 && cables.len() == result.cables.len();
        (if is_all { "all cables".to_owned() } else { listed(&cables) }, listed(names))
    };
    groups.into_iter().map(in_words).collect()
}

/// Returns a sentence about the cables whose error was a zero more than anything else; `None` without one.
fn of_zeros(result: &FitResult) -> Option<String> {
    let key = Parameter::all().find(|of| of.place() == OFFSET)?.to_string();
    let zeros = result.cables.iter().filter_map(|cable| {
        let offset_n = cable.parameters.get(&key)?;
        // Its interval is narrower than itself.
        let is_fitted = cable.standard_errors.get(&key).is_some_and(|error| HALF_INTERVAL * error < offset_n.abs());
        // Half of the squares before.
        let is_shown = format!("{:.4}", offset_n.abs()) != "0.0000";
        let is_most = is_shown && 2.0 * offset_n * offset_n > cable.before?.rms_n.powi(2);
        // One of many that agree is no finding.
        let is_open = cable.open.iter().any(|open| open.0.iter().any(|part| part.parameter == key));
        let zero = || (format!("{key} of {} is {} N", cable.name, significant(offset_n)), cable.is_scale_told);
        (is_fitted && is_most && !is_open).then(zero)
    });
    let (zeros, are_told): (Vec<String>, Vec<bool>) = zeros.unzip();
    // A load that stays, or a wrong scale, does not tell a zero from a scale.
    let zero = if are_told.contains(&false) { "zero or a scale" } else { "zero" };
    (!zeros.is_empty()).then(|| {
        let checked = zero.replace("or a", "and the");
        format!(
            "Most of the error was a {zero} and no friction, {}: check the {checked} of the sensor and the reference.",
            listed(&zeros)
        )
    })
}

/// Returns what is fitted, as a clause, and the word for it.
fn fitted(result: &FitResult) -> (String, &'static str) {
    let fitted_of = |cable: &FitCableResult| -> Vec<Parameter> {
        let of_logs = cable.per_log.iter().flat_map(|log| &log.standard_errors.0);
        cable.standard_errors.0.iter().chain(of_logs).filter_map(|(name, _)| Parameter::named(name)).collect()
    };
    let is_friction = |of: &Parameter| of.is_friction() && of.place() != OFFSET;
    let with_friction = result.cables.iter().filter(|cable| fitted_of(cable).iter().any(is_friction)).count();
    if with_friction > 0 {
        return (format!("Friction is fitted on {}", counted(with_friction, "cable")), "it");
    }
    let mut names: Vec<String> = result.cables.iter().flat_map(fitted_of).map(|of| of.to_string()).collect();
    names.sort_unstable();
    names.dedup();
    let fitted =
        if names.is_empty() { "Nothing is fitted".to_owned() } else { format!("Only {} is fitted", listed(&names)) };
    (fitted, "the model")
}

/// Returns the verdict on a hysteresis: the remaining fraction of its width.
#[must_use]
pub fn of_hysteresis(result: &HysteresisResult) -> Verdict {
    let of_axis = |axis: &fric_lab::hysteresis::AxisResult| {
        let (before, after) = axis.without.as_ref().zip(axis.with.as_ref())?;
        let name = format!("the hysteresis on axis {}", axis.axis);
        axis.lasting_ratio.map(|_| Compared::new(name, [before.width, after.width], axis.unit))
    };
    let all: Vec<Compared> = result.axes.iter().filter_map(of_axis).collect();
    let axes: Vec<&str> =
        result.axes.iter().filter(|axis| axis.lasting_ratio.is_some()).map(|axis| axis.axis).collect();
    let greatest = all.iter().map(Compared::left).fold(0.0, f64::max);
    let worse: Vec<String> = all
        .iter()
        .filter(|one| one.is_worse())
        .map(|one| format!("{} ({:.4} {} without, {:.4} {} with)", one.name, one.before, one.unit, one.after, one.unit))
        .collect();
    let left = || {
        let left = range_in_words(all.iter().map(Compared::left));
        format!("{left} of the width is left on {} {}", if axes.len() == 1 { "axis" } else { "axes" }, listed(&axes))
    };
    let (tone, sentence) = if all.is_empty() {
        (Tone::Mixed, "The wrench has no hysteresis beyond scatter, with or without compensation.".to_owned())
    } else if !worse.is_empty() {
        (Tone::Bad, format!("Compensation makes {} wider; {}.", listed(&worse), left()))
    } else if greatest <= WORKS {
        (Tone::Well, format!("Compensation takes the hysteresis of the wrench away: {}.", left()))
    } else {
        (Tone::Mixed, format!("Compensation takes part of the hysteresis of the wrench away: {}.", left()))
    };
    let missing: Vec<&str> = result.axes.iter().filter(|axis| axis.passes == 0).map(|axis| axis.axis).collect();
    let mut todo = Vec::new();
    if tone != Tone::Well && !all.is_empty() {
        todo.push("See what the model lacks: fric-cli discover with the same log and model.".to_owned());
    }
    if !missing.is_empty() {
        todo.push(format!(
            "Not crossed: {}. Record the platform going to and fro across this position along (x, y, z) or about (a, b, c) these axes, \
             several times, with nothing else moving.",
            missing.join(", ")
        ));
    }
    if todo.is_empty() {
        todo.push("Nothing: the values can go to the control loop.".to_owned());
    }
    Verdict { tone, sentence, todo }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fric_lab::fit::result::{FitReference, LeftOut, OpenPartResult, OpenResult};
    use fric_lab::numbers::Numbers;

    /// A fit of one cable whose error before was 10 N with this zero.
    fn fit(offset_n: f64, standard_error_n: f64, open: Vec<OpenResult>, is_scale_told: bool) -> FitResult {
        let numbers = |number: f64| Numbers(vec![("offset_n".to_owned(), number)]);
        let cable = FitCableResult {
            name: "w".to_owned(),
            samples: 1000,
            left_out: LeftOut { flagged: 0, without_reference: 0, warm_up: 0, outliers: 0 },
            termination: "converged",
            evaluations: 1,
            parameters: numbers(offset_n),
            standard_errors: numbers(standard_error_n),
            undetermined: Vec::new(),
            contradicted: Vec::new(),
            per_log: Vec::new(),
            open,
            at_bound: Vec::new(),
            before: Some(ForceError { rms_n: 10.0, mae_n: 9.0 }),
            after: Some(ForceError { rms_n: 1.0, mae_n: 0.8 }),
            is_scale_told,
            mean_reference_n: Some(50.0),
            faults: Vec::new(),
        };
        let reference = FitReference::Forces;
        FitResult { format: FitResult::FORMAT, robot: "rig".to_owned(), reference, cables: vec![cable], wrench: None }
    }

    /// Nine spikes of 1000 N in 9000 samples make an rms of `1000·√(9/9000)` = 31.6 N and a mean of 1 N, whatever friction there is.
    #[test]
    fn few_samples_do_not_hide_that_compensation_works() {
        let mut spikes = fit(0.0, 0.1, Vec::new(), true);
        let errors = |rms_n: f64, mae_n: f64| Some(ForceError { rms_n: rms_n.hypot(31.6), mae_n: mae_n + 1.0 });
        (spikes.cables[0].before, spikes.cables[0].after) = (errors(5.0, 4.5), errors(0.1, 0.08));
        let Verdict { tone, sentence, .. } = of_fit(&spikes);
        assert_eq!(tone, Tone::Mixed);
        assert!(sentence.contains("19.6 % of the mean error, and 98.8 % of the rms error, which few"), "{sentence}");
        assert!(!sentence.contains("next to nothing"), "{sentence}");
        // Where the mean is not explained either, nothing is.
        (spikes.cables[0].before, spikes.cables[0].after) = (errors(5.0, 4.5), errors(4.9, 4.4));
        assert!(of_fit(&spikes).sentence.contains("next to nothing"));
    }

    /// `± 1.96 s` holds the zero with 95 %, so that of 9 N with `s` = 5 N may be none; and 7 N are less than half of the squares of 10 N.
    #[test]
    fn a_zero_is_told_if_it_is_most_of_the_error_and_determined() {
        let told = |offset_n, error_n| of_zeros(&fit(offset_n, error_n, Vec::new(), true));
        assert_eq!([told(9.0, 5.0), told(9.0, 4.6), told(7.0, 0.1), told(0.0, 0.1)], [const { None }; 4]);
        for error_n in [0.1, 4.5] {
            let sentence = told(-9.0, error_n).unwrap();
            assert!(
                sentence.contains("was a zero and no friction, offset_n of w is -9 N: check the zero of"),
                "{sentence}"
            );
        }
        let part =
            |parameter: &str| OpenPartResult { cable: "w".to_owned(), parameter: parameter.to_owned(), step: 1.0 };
        let open = vec![OpenResult(vec![part("mu"), part("offset_n")])];
        assert_eq!(of_zeros(&fit(9.0, 0.1, open, true)), None);
        let sentence = of_zeros(&fit(9.0, 0.1, Vec::new(), false)).unwrap();
        assert!(
            sentence.contains("was a zero or a scale and") && sentence.contains("the zero and the scale of"),
            "{sentence}"
        );
    }
}
