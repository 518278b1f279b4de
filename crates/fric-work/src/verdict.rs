//! Verdicts: a result in a sentence, with what to do, at the beginning of every page.
//!
//! Numbers in the sentences equal those of the tables, including the rounding.

use fric_lab::discover::result::{DiscoverCableResult, DiscoverResult};
use fric_lab::errors::{ForceError, WrenchError};
use fric_lab::fit::result::FitResult;
use fric_lab::hysteresis::HysteresisResult;
use fric_lab::text::listed;
use fric_tendon_lab::discover::{Manipulator, rest_in_words};
use fric_tendon_lab::identify::TendonFitResult;
use fric_tendon_lab::result::{CalibrationResult, FrictionResult, HoleResult, ShapeResult};

use crate::replay::{CableResult, ReplayResult};

/// Maximum remaining fraction of the error for a model that works. Twice and half this value change only the wording, no number. The measured robots
/// of \[P\] leave 5 to 20 %.
const WORKS: f64 = 0.3;
/// Fraction of flagged samples above which they are mentioned.
const MANY_FLAGGED: f64 = 0.01;

/// The tone of a verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// Nothing to do.
    Well,
    /// Something to look at.
    Mixed,
    /// Something became worse, or no verdict is possible.
    Bad,
}

/// A result in a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Its tone.
    pub tone: Tone,
    /// The sentence.
    pub sentence: String,
    /// What to do, in sentences.
    pub todo: Vec<String>,
}

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
}

impl Compared {
    fn of_cable(cable: &CableResult) -> Option<Self> {
        let (before, after) = cable.before.as_ref().zip(cable.after.as_ref())?;
        Some(Self { name: cable.name.clone(), before: before.rms_n, after: after.rms_n, unit: "N" })
    }

    fn of_wrench(before: &WrenchError, after: &WrenchError) -> [Self; 2] {
        [
            Self {
                name: "the force on the platform".to_owned(),
                before: before.force_rms_n,
                after: after.force_rms_n,
                unit: "N",
            },
            Self {
                name: "the torque on the platform".to_owned(),
                before: before.torque_rms_nm,
                after: after.torque_rms_nm,
                unit: "Nm",
            },
        ]
    }

    fn left(&self) -> f64 {
        self.after / self.before
    }

    /// Whether the error became worse by an amount that the tables show.
    fn is_worse(&self) -> bool {
        self.after > self.before && format!("{:.4}", self.after) != format!("{:.4}", self.before)
    }

    fn in_words(&self) -> String {
        format!("{} (rms {:.4} {} before, {:.4} {} after)", self.name, self.before, self.unit, self.after, self.unit)
    }
}

/// Returns a sentence about errors that became worse; `None` if none did.
fn worse(all: &[Compared]) -> Option<String> {
    let worse: Vec<String> = all.iter().filter(|one| one.is_worse()).map(Compared::in_words).collect();
    (!worse.is_empty()).then(|| format!("Compensation makes {} worse.", listed(&worse)))
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
        let all: Vec<Compared> = cables.into_iter().chain(wrench).collect();
        let greatest = all.iter().map(Compared::left).filter(|left| left.is_finite()).fold(0.0, f64::max);
        let left = of_cables.or(of_wrench);
        let (tone, sentence) = match (worse(&all), left) {
            (Some(worse), left) => {
                (Tone::Bad, left.map_or(worse.clone(), |left| format!("{worse} Elsewhere it leaves {left}.")))
            }
            (None, Some(left)) if greatest <= WORKS => (Tone::Well, format!("Compensation works: it leaves {left}.")),
            (None, Some(left)) => (Tone::Mixed, format!("Compensation helps in part: it leaves {left}.")),
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
        if is_uncompared {
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
                "Look at {}: {} of {} samples are flagged; the warnings of the command say why.",
                cable.name, cable.flagged, cable.samples
            ));
        }
        for cable in self.cables.iter().filter(|cable| !cable.faults.is_empty()) {
            todo.push(format!("Mend the recording of {}; its faults stand below.", cable.name));
        }
        if todo.is_empty() {
            todo.push("Nothing: the values can go to the control loop.".to_owned());
        }
        todo
    }
}

/// Returns the remaining fraction of errors that did not become worse; `None` if there are none.
fn share_left(of: &str, all: &[Compared]) -> Option<String> {
    let better = all.iter().filter(|one| !one.is_worse());
    let shares: Vec<f64> = better.map(Compared::left).filter(|left| left.is_finite()).collect();
    (!shares.is_empty()).then(|| format!("{} of {of} that friction causes", range_in_words(shares.into_iter())))
}

fn wrench_left(wrench: &[Compared]) -> Option<String> {
    share_left("the error of the wrench on the platform", wrench)
}

#[expect(clippy::cast_precision_loss, reason = "counts of samples")]
fn is_many(flagged: u64, samples: u64) -> bool {
    flagged as f64 > MANY_FLAGGED * samples as f64
}

/// Formats a number of things.
pub(crate) fn counted(count: usize, thing: &str) -> String {
    if count == 1 { format!("{count} {thing}") } else { format!("{count} {thing}s") }
}

/// Returns the verdict on a fit: the remaining fraction of the error.
#[must_use]
pub fn of_fit(result: &FitResult) -> Verdict {
    let of_cable = |cable: &fric_lab::fit::result::FitCableResult| {
        let (before, after) = cable.before.zip(cable.after)?;
        Some(Compared { name: cable.name.clone(), before: before.rms_n, after: after.rms_n, unit: "N" })
    };
    let cables: Vec<Compared> = result.cables.iter().filter_map(of_cable).collect();
    let wrench: Vec<Compared> =
        result.wrench.iter().flat_map(|wrench| Compared::of_wrench(&wrench.before, &wrench.after)).collect();
    let left = share_left("the force error", &cables).or_else(|| wrench_left(&wrench));
    let all: Vec<Compared> = cables.into_iter().chain(wrench).collect();
    let greatest = all.iter().map(Compared::left).filter(|left| left.is_finite()).fold(0.0, f64::max);
    let fitted = format!("Friction is fitted on {}", counted(result.cables.len(), "cable"));
    let worse = worse(&all);
    let it = if worse.is_some() { "elsewhere it" } else { "it" };
    let left = left.map_or_else(|| format!("{fitted}."), |left| format!("{fitted}; {it} leaves {left}."));
    let (tone, sentence) = match worse {
        Some(worse) => (Tone::Bad, format!("{worse} {left}")),
        None if greatest <= WORKS => (Tone::Well, left),
        None => (Tone::Mixed, left),
    };
    let mut todo = Vec::new();
    for cable in &result.cables {
        if !cable.undetermined.is_empty() {
            todo.push(format!(
                "{}: the log does not determine {}, kept as given; record a run that does (fric-cli excite).",
                cable.name,
                listed(&cable.undetermined)
            ));
        }
        if !cable.at_bound.is_empty() {
            todo.push(format!(
                "{}: {} is at the end of its range; see what else the model lacks (fric-cli discover).",
                cable.name,
                listed(&cable.at_bound)
            ));
        }
        if !cable.faults.is_empty() {
            todo.push(format!("Mend the recording of {}; its faults stand below.", cable.name));
        }
    }
    if tone != Tone::Well {
        todo.push("See what the model lacks: fric-cli discover with the same log and model.".to_owned());
    }
    todo.push("Replay another log with the fitted file: that judges it, this log taught it.".to_owned());
    Verdict { tone, sentence, todo }
}

/// Returns the verdict on a discovery: the missing effects, the cables, and the remedies.
#[must_use]
pub fn of_discovery(result: &DiscoverResult) -> Verdict {
    let count = result.cables.len();
    let with = |verdict: &str| -> Vec<&DiscoverCableResult> {
        result.cables.iter().filter(|cable| cable.verdict == verdict).collect()
    };
    let on = |cables: &[&str]| {
        if cables.len() == count && count > 1 { format!("all {count} cables") } else { listed(cables) }
    };
    let mut kinds: Vec<(&str, Vec<&str>, &str)> = Vec::new();
    for cable in &result.cables {
        for effect in &cable.effects {
            match kinds.iter_mut().find(|(kind, ..)| *kind == effect.kind) {
                Some((_, names, _)) if names.last() == Some(&cable.name.as_str()) => {}
                Some((_, names, _)) => names.push(&cable.name),
                None => kinds.push((effect.kind, vec![&cable.name], effect.effect.row().remedy)),
            }
        }
    }
    let names =
        |cables: &[&DiscoverCableResult]| on(&cables.iter().map(|cable| cable.name.as_str()).collect::<Vec<_>>());
    let [complete, unexplained, untold] = ["complete", "unexplained", "untold"].map(with);
    let is_worse = |cable: &&DiscoverCableResult| {
        let (before, after) = (cable.before.map(|error| error.rms_n), cable.after.map(|error| error.rms_n));
        before
            .zip(after)
            .is_some_and(|(before, after)| after > before && format!("{after:.4}") != format!("{before:.4}"))
    };
    let worse: Vec<&DiscoverCableResult> = result.cables.iter().filter(is_worse).collect();
    let mut parts = Vec::new();
    if !worse.is_empty() {
        parts.push(format!("The extended model is worse on {}.", names(&worse)));
    }
    let is_whole_complete =
        complete.len() == count && result.wrench.as_ref().is_none_or(|gap| gap.verdict == "complete");
    if is_whole_complete {
        parts.push(format!("The model is complete on {}: what is left is noise.", names(&complete)));
    } else {
        if !kinds.is_empty() {
            let all: Vec<String> = kinds.iter().map(|(kind, cables, _)| format!("{kind} ({})", on(cables))).collect();
            parts.push(format!("The model lacks {}.", listed(&all)));
        }
        if !unexplained.is_empty() {
            parts.push(format!("Something without a name is left on {}.", names(&unexplained)));
        }
        if !untold.is_empty() {
            parts.push(format!("The log does not tell anything of {}.", names(&untold)));
        }
        if result.wrench.as_ref().is_some_and(|gap| gap.verdict == "unexplained") {
            parts.push("Of the wrench on the platform something is left without a name.".to_owned());
        }
        if !complete.is_empty() {
            let rest = if complete.len() == 1 { "agrees" } else { "agree" };
            parts.push(format!("{} {rest} with the model to the noise.", capitalised(&names(&complete))));
        }
    }
    let mut todo: Vec<String> = Vec::new();
    for (kind, cables, remedy) in &kinds {
        todo.push(format!("{kind} on {}: {remedy}.", on(cables)));
    }
    if let Some(wrong) = result.wrench.as_ref().filter(|gap| !gap.geometry.is_empty()) {
        todo.extend(wrong.in_words().into_iter().filter(|sentence| sentence.starts_with("The robot file's")));
    }
    for cable in &unexplained {
        todo.push(format!("Look where the rest of {} lies, below, and record more there.", cable.name));
    }
    for missing in result.cables.iter().filter_map(|cable| cable.missing.as_ref()) {
        if !todo.iter().any(|known| known == missing.advice) {
            todo.push(missing.advice.to_owned());
        }
    }
    for cable in result.cables.iter().filter(|cable| !cable.faults.is_empty()) {
        todo.push(format!("Mend the recording of {}; its faults stand below.", cable.name));
    }
    if !kinds.is_empty() {
        todo.push("Until then compensate with the extended file: fric-cli discover -o writes it.".to_owned());
    }
    if todo.is_empty() {
        todo.push("Nothing: keep the model.".to_owned());
    }
    let tone = if !worse.is_empty() {
        Tone::Bad
    } else if is_whole_complete {
        Tone::Well
    } else {
        Tone::Mixed
    };
    Verdict { tone, sentence: parts.join(" "), todo }
}

fn capitalised(text: &str) -> String {
    // Names of cables keep their case.
    if text.starts_with("all ") { format!("A{}", text.get(1..).unwrap_or_default()) } else { text.to_owned() }
}

/// Returns the verdict on a hysteresis: the remaining fraction of its width.
#[must_use]
pub fn of_hysteresis(result: &HysteresisResult) -> Verdict {
    let of_axis = |axis: &fric_lab::hysteresis::AxisResult| {
        let (before, after) = axis.without.as_ref().zip(axis.with.as_ref())?;
        let name = format!("the hysteresis on axis {}", axis.axis);
        axis.lasting_ratio.map(|_| Compared { name, before: before.width, after: after.width, unit: axis.unit })
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

/// Returns the verdict on a calibration: how well lines describe the gratings.
#[must_use]
pub fn of_calibration(result: &CalibrationResult) -> Verdict {
    let worst =
        result.gratings.iter().max_by(|one, other| one.largest_residual_ratio.total_cmp(&other.largest_residual_ratio));
    let largest = worst.map_or_else(String::new, |worst| {
        format!(
            ": the largest residual is {:.2} % of the greatest load, on grating {}",
            100.0 * worst.largest_residual_ratio,
            worst.grating
        )
    });
    let sentence = format!(
        "{} calibrated by {}{largest}.",
        counted(result.gratings.len(), "grating"),
        counted(result.load_n.len(), "load")
    );
    let todo =
        vec!["Measure the friction at the holes with the calibrated file: fric-cli continuum friction.".to_owned()];
    Verdict { tone: Tone::Well, sentence, todo }
}

/// Returns the verdict on the identification of a manipulator: the remaining error between model and markers, or between model and gratings.
#[must_use]
pub fn of_tendon_fit(result: &TendonFitResult) -> Verdict {
    let (before, after) = (result.before, result.after);
    let markers = before.marker_mean_mm.zip(after.marker_mean_mm);
    let tensions = before.tension_rms_n.zip(after.tension_rms_n);
    let left = match (markers, tensions) {
        (Some((before, after)), _) => {
            format!("the disks are {after:.2} mm from their markers in the mean, {before:.2} mm with the given file")
        }
        (None, Some((before, after))) => {
            format!("the tensions are {after:.4} N off (rms), {before:.4} N with the given file")
        }
        (None, None) => "model and measurement cannot be compared".to_owned(),
    };
    let sentence = format!(
        "{} identified from {}: {left}.",
        counted(result.parameters.0.len(), "number"),
        counted(result.runs.len(), "run")
    );
    let is_worse = markers.or(tensions).is_none_or(|(before, after)| after > before);
    let tone = match (is_worse, result.undetermined.is_empty()) {
        (true, _) => Tone::Bad,
        (false, false) => Tone::Mixed,
        (false, true) => Tone::Well,
    };
    let todo = result.undetermined.iter().map(|open| format!("{}.", open.sentence)).collect();
    Verdict { tone, sentence, todo }
}

/// Returns the verdict on the friction at the holes: the hole with the most.
#[must_use]
pub fn of_hole_frictions(result: &FrictionResult) -> Verdict {
    let largest = |hole: &fric_tendon_lab::result::HoleSummary| hole.least_n.abs().max(hole.greatest_n.abs());
    let finite = result.holes.iter().filter(|hole| largest(hole).is_finite());
    let worst = finite.max_by(|one, other| largest(one).total_cmp(&largest(other)));
    let sentence = worst.map_or_else(
        || "Friction at the holes is not known.".to_owned(),
        |worst| {
            format!(
                "Friction is greatest at hole {}: {:.4} N to {:.4} N over the run, {:.4} N in the mean.",
                worst.hole, worst.least_n, worst.greatest_n, worst.mean_n
            )
        },
    );
    let mut todo: Vec<String> = result.bridged.iter().map(|one| one.warning(result.samples)).collect();
    todo.push("See what this friction does to the shape: fric-cli continuum shape.".to_owned());
    Verdict { tone: Tone::Mixed, sentence, todo }
}

/// Returns the verdict on shapes: the friction model nearest to the markers.
#[must_use]
pub fn of_shapes(result: &ShapeResult) -> Verdict {
    let mean_mm = |way: &fric_tendon_lab::result::WayErrors| way.all.mean_mm;
    let mut known: Vec<(&str, f64)> = result
        .ways
        .iter()
        .filter_map(|way| Some((way.way, mean_mm(way)?)))
        .filter(|(_, mean_mm)| mean_mm.is_finite())
        .collect();
    known.sort_by(|one, other| one.1.total_cmp(&other.1));
    let (tone, sentence) = match known.as_slice() {
        [(best, best_mm), .., (last, last_mm)] => (
            Tone::Mixed,
            format!(
                "The shape is predicted best by the way `{best}`: {best_mm:.2} mm off the markers in the mean; worst by `{last}`, {last_mm:.2} mm."
            ),
        ),
        [(only, mm)] => {
            (Tone::Mixed, format!("The shape by the way `{only}` is {mm:.2} mm off the markers in the mean."))
        }
        [] => (Tone::Mixed, "Shapes are predicted; how well is not known, for the run has no markers.".to_owned()),
    };
    let mut todo: Vec<String> = result.bridged.iter().map(|one| one.warning(result.samples)).collect();
    if known.is_empty() {
        todo.push("Record markers on the disks to judge the shapes.".to_owned());
    }
    Verdict { tone, sentence, todo }
}

/// Returns the verdict on a manipulator's discovery.
#[must_use]
pub fn of_tendon(result: &DiscoverResult<Manipulator>) -> Verdict {
    let (mut parts, mut todo, mut is_well) = (Vec::new(), Vec::new(), true);
    for tendon in &result.cables {
        let kinds: Vec<&str> = tendon.effects.iter().map(|effect| effect.kind).collect();
        is_well &= tendon.verdict == "complete";
        if tendon.verdict == "complete" {
            parts.push("The model is complete: what is left is noise.".to_owned());
        }
        if !kinds.is_empty() {
            parts.push(format!("The model lacks {}.", listed(&kinds)));
        }
        if tendon.verdict == "unexplained" {
            parts.push("Something is left without a name.".to_owned());
        }
        todo.extend(tendon.effects.iter().map(|effect| format!("{}: {}", effect.kind, effect.effect[1])));
        todo.extend(tendon.unexplained.iter().map(rest_in_words));
    }
    if todo.is_empty() {
        todo.push("Nothing: keep the model.".to_owned());
    }
    Verdict { tone: if is_well { Tone::Well } else { Tone::Mixed }, sentence: parts.join(" "), todo }
}

/// Returns the verdict on a single hole.
#[must_use]
pub fn of_hole(result: &HoleResult) -> Verdict {
    let [from, to] = result.interval;
    let sentence =
        format!("The hole's coefficient of friction μ is {:.4}, with 95 % confidence {from:.4} to {to:.4}.", result.mu);
    Verdict { tone: Tone::Well, sentence, todo: Vec::new() }
}
