//! The verdict on a discovery: what the model lacks, on which cables, and what to do about it.

use fric_lab::discover::Verdict as Found;
use fric_lab::discover::result::{DiscoverCableResult, DiscoverResult, EffectResult, RunnerUpResult, WrenchGap};
use fric_lab::discover::words::FROM_OUTSIDE;
use fric_lab::text::listed;

use super::{Tone, Verdict};

/// Returns the verdict on a discovery: the missing effects, the cables, and the remedies.
#[must_use]
pub fn of_discovery(result: &DiscoverResult) -> Verdict {
    let count = result.cables.len();
    let with = |verdict| -> Vec<&DiscoverCableResult> {
        result.cables.iter().filter(|cable| cable.verdict == verdict).collect()
    };
    let missing = missing(&result.cables);
    let names = |cables: &[&DiscoverCableResult]| {
        on(&cables.iter().map(|cable| cable.name.as_str()).collect::<Vec<_>>(), count)
    };
    let [complete, unexplained, untold] = [Found::Complete, Found::Unexplained, Found::Untold].map(with);
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
    let is_of_no_cable = result.wrench.as_ref().is_some_and(|gap| gap.is_of_no_cable);
    let has_faults = result.cables.iter().any(|cable| !cable.faults.is_empty());
    let is_whole_complete =
        complete.len() == count && result.wrench.as_ref().is_none_or(|gap| gap.verdict == Found::Complete);
    if is_whole_complete {
        parts.push(format!("The model is complete on {}: what is left is noise.", names(&complete)));
        if has_faults {
            parts.push("The recording has faults.".to_owned());
        }
    } else {
        if !missing.is_empty() {
            let all: Vec<String> =
                missing.iter().map(|of| format!("{} ({})", of.kind, on(&of.cables, count))).collect();
            parts.push(format!("The model lacks {}.", listed(&all)));
        }
        if !unexplained.is_empty() {
            parts.push(format!("Something without a name is left on {}.", names(&unexplained)));
        }
        if !untold.is_empty() {
            parts.push(format!("The log does not tell anything of {}.", names(&untold)));
        }
        if result.wrench.as_ref().is_some_and(|gap| gap.verdict == Found::Unexplained) {
            parts.push("Of the wrench on the platform something is left without a name.".to_owned());
        }
        if !complete.is_empty() {
            let rest = if complete.len() == 1 { "agrees" } else { "agree" };
            if !is_of_no_cable {
                parts.push(format!("{} {rest} with the model to the noise.", capitalised(&names(&complete))));
            }
        }
    }
    let tone = if !worse.is_empty() {
        Tone::Bad
    } else if is_whole_complete && !has_faults {
        Tone::Well
    } else {
        Tone::Mixed
    };
    Verdict { tone, sentence: parts.join(" "), todo: what_to_do(result, &missing, &unexplained) }
}

/// An effect that models lack, and where.
struct Missing<'r> {
    /// Its name, with the one that the log cannot tell from it.
    kind: String,
    cables: Vec<&'r str>,
    remedy: String,
}

/// Returns the effects that the models of cables lack, each once, in the order in which they come.
fn missing(cables: &[DiscoverCableResult]) -> Vec<Missing<'_>> {
    let mut missing: Vec<Missing<'_>> = Vec::new();
    for cable in cables {
        for effect in &cable.effects {
            let as_good = effect.runner_up.as_ref().filter(|other| other.as_good);
            let kind =
                as_good.map_or_else(|| effect.kind.to_owned(), |other| format!("{} or {}", effect.kind, other.kind));
            match missing.iter_mut().find(|known| known.kind == kind) {
                Some(known) if known.cables.last() == Some(&cable.name.as_str()) => {}
                Some(known) => known.cables.push(&cable.name),
                None => missing.push(Missing { kind, cables: vec![&cable.name], remedy: remedy(effect, as_good) }),
            }
        }
    }
    missing
}

/// Names some of so many cables.
fn on(cables: &[&str], count: usize) -> String {
    if cables.len() == count && count > 1 { format!("all {count} cables") } else { listed(cables) }
}

/// Returns the steps that follow from a discovery, the machine's before the file's.
fn what_to_do(result: &DiscoverResult, missing: &[Missing<'_>], unexplained: &[&DiscoverCableResult]) -> Vec<String> {
    let count = result.cables.len();
    let of_effect = |of: &Missing<'_>| format!("{} on {}: {}.", of.kind, on(&of.cables, count), of.remedy);
    let mut todo: Vec<String> = missing.iter().map(of_effect).collect();
    todo.extend(result.wrench.iter().flat_map(WrenchGap::corrections));
    if result.wrench.as_ref().is_some_and(|gap| gap.is_of_no_cable) {
        todo.push(FROM_OUTSIDE.to_owned());
    }
    for cable in unexplained {
        todo.push(format!("Look where the rest of {} lies, below, and record more there.", cable.name));
    }
    for untold in result.cables.iter().filter_map(|cable| cable.missing.as_ref()) {
        if !todo.iter().any(|known| known == untold.advice) {
            todo.push(untold.advice.to_owned());
        }
    }
    for cable in result.cables.iter().filter(|cable| !cable.faults.is_empty()) {
        todo.push(format!("Mend the recording of {}; its faults stand below.", cable.name));
    }
    if !missing.is_empty() {
        todo.push(
            "Until then compensate with the extended file, the one that `fric-cli discover -o` writes.".to_owned(),
        );
    }
    if todo.is_empty() {
        todo.push(
            "Keep the model, with the values fitted to this log, those that `fric-cli discover -o` writes.".to_owned(),
        );
    }
    todo
}

/// Returns what to do about an effect, as a clause: if the log cannot tell it from another one, both remedies, and the run that tells them apart.
fn remedy(effect: &EffectResult, as_good: Option<&RunnerUpResult>) -> String {
    as_good.map_or_else(
        || effect.remedy(),
        |other| {
            format!(
                "if it is {}, {}. If it is {}, {}. `fric-cli excite --separate {},{}` designs a run to tell them apart",
                effect.kind,
                effect.remedy(),
                other.kind,
                other.effect.row().remedy,
                effect.kind,
                other.kind
            )
        },
    )
}

fn capitalised(text: &str) -> String {
    // Names of cables keep their case.
    if text.starts_with("all ") { format!("A{}", text.get(1..).unwrap_or_default()) } else { text.to_owned() }
}
