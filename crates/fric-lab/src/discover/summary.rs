//! The result of a discovery for people: the verdicts of all cables, then the findings on each.

use super::Verdict;
use super::result::{DiscoverCableResult, DiscoverResult, EffectResult, WhereResult, WrenchComponent, WrenchGap};
use crate::fit::summary::log_table;
use crate::text::{listed, table, wrapped};
use crate::words::{Times, percent};

/// Width of the label column, in characters.
const LABEL: usize = 11;
/// Maximum number of places to report.
const MOST_PLACES: usize = 2;
/// Maximum number of insufficient candidates to report.
const MOST_TRIED: usize = 3;

/// Explanation of the columns.
const LEGEND: &str = "Before and after are the rms error on samples that no fit has seen: before, of the given model fitted to the other \
                      samples; after, of the extended one.";

/// Returns the full summary.
pub(crate) fn describe(result: &DiscoverResult) -> String {
    let mut text = format!("{}: what the model lacks\n\n", result.robot);
    text += &overview(result);
    if let Some(gap) = &result.wrench {
        text += &of_wrench(gap);
    }
    if result.cables.iter().any(|cable| cable.before.is_some()) {
        text.push('\n');
        text += &wrapped("", LEGEND);
    }
    text += &log_table(result.cables.iter().map(|cable| (cable.name.as_str(), cable.per_log.as_slice())));
    for effect in &result.common_effects {
        text += "\n";
        text += &wrapped("", &format!("{}.", effect.in_words(result)));
    }
    let is_beside_rest = result.wrench.as_ref().is_some_and(|gap| gap.is_of_no_cable);
    let is_quiet = |cable: &&DiscoverCableResult| {
        cable.verdict == Verdict::Complete
            && cable.wander_n.is_none_or(|wander_n| wander_n <= 0.0)
            && cable.tried.is_empty()
            && cable.faults.is_empty()
            && cable.undetermined.is_empty()
            && cable.revised.is_empty()
            && cable.left_out.outliers == 0
            && !cable.is_constant()
    };
    let quiet: Vec<&str> = result.cables.iter().filter(is_quiet).map(|cable| cable.name.as_str()).collect();
    if let Some(first) = result.cables.iter().find(is_quiet) {
        text += "\n";
        text += &wrapped("", &format!("{}: {}", listed(&quiet), first.verdict_in_words(is_beside_rest)));
    }
    let (mut told, times) = (Vec::new(), result.times());
    for cable in result.cables.iter().filter(|cable| !is_quiet(cable)) {
        text += "\n";
        text += &wrapped("", &format!("{}: {}", cable.name, cable.verdict_in_words(is_beside_rest)));
        text += &details(cable, &times, &mut told);
    }
    text
}

/// Describes the findings for all cables together.
fn of_wrench(gap: &WrenchGap) -> String {
    let rows: Vec<_> = gap.components.iter().map(WrenchComponent::cells).collect();
    let mut text = format!("\n{}", table(&[gap.title(), "noise\nrms", "before\nrms", "after\nrms"], 1, &rows));
    text += "\nrms over samples that no fit has seen. All cables together: ";
    text += gap.verdict.name();
    text += ".\n";
    gap.in_words().iter().for_each(|sentence| text += &wrapped("", sentence));
    text
}

/// Returns a table with one line per cable.
fn overview(result: &DiscoverResult) -> String {
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
    let row = |cable: &DiscoverCableResult| {
        let kinds: Vec<&str> = cable.effects.iter().map(|effect| effect.kind).collect();
        let closed = cable.gap_closed.filter(|_| !cable.effects.is_empty());
        [
            cable.name.clone(),
            cable.verdict.name().to_owned(),
            if kinds.is_empty() { "–".to_owned() } else { kinds.join("\n") },
            number(cable.noise_floor_n),
            number(cable.before.map(|error| error.rms_n)),
            number(cable.after.map(|error| error.rms_n)),
            closed.map_or_else(|| "–".to_owned(), percent),
        ]
    };
    let rows: Vec<_> = result.cables.iter().map(row).collect();
    table(&["cable", "verdict", "found", "noise\n[N]", "before\n[N]", "after\n[N]", "gap\nclosed"], 3, &rows)
}

fn line(label: &str, text: &str) -> String {
    wrapped(&format!("  {label:<LABEL$} "), text)
}

/// Describes the findings on a cable. Cause and remedy of an effect are given once.
fn details(cable: &DiscoverCableResult, times: &Times<'_>, told: &mut Vec<&'static str>) -> String {
    let mut text = String::new();
    if let Some(gap) = cable.gap_in_words().filter(|_| cable.verdict != Verdict::Complete) {
        text += &line("gap", &gap);
    }
    let variation = cable.variation_in_words().filter(|_| cable.verdict != Verdict::Complete || cable.is_constant());
    text += &variation.map_or_else(String::new, |variation| line("reference", &variation));
    // Beside a complete model the gap is what fitting its values has closed.
    let has_gap = |place: &&WhereResult| cable.verdict != Verdict::Complete && place.signal != "frequency";
    for (count, place) in cable.places.iter().filter(has_gap).take(MOST_PLACES).enumerate() {
        text += &line(if count == 0 { "where" } else { "" }, &place.in_words("the gap", times));
    }
    for effect in &cable.effects {
        text += &of_effect(effect, told.contains(&effect.kind));
        told.push(effect.kind);
    }
    text += &cable.bound_in_words().map_or_else(String::new, |bound| line("bound", &bound));
    text += &cable.undetermined_in_words().map_or_else(String::new, |values| line("open", &values));
    for (count, sentence) in cable.revised_in_words().iter().enumerate() {
        text += &line(if count == 0 { "revised" } else { "" }, sentence);
    }
    for (count, tried) in cable.tried.iter().take(MOST_TRIED).enumerate() {
        text += &line(if count == 0 { "tried" } else { "" }, &tried.in_words());
    }
    let of_recording = cable.faults.iter().map(|fault| fault.in_words(times)).chain(cable.outliers_in_words());
    for (count, sentence) in of_recording.enumerate() {
        text += &line(if count == 0 { "recording" } else { "" }, &sentence);
    }
    if let Some(rest) = &cable.unexplained {
        for (count, sentence) in rest.in_words(times).iter().enumerate() {
            text += &line(if count == 0 { "unexplained" } else { "" }, sentence);
        }
    }
    text
}

fn of_effect(effect: &EffectResult, is_told: bool) -> String {
    let mut text = wrapped(&format!("  {}: ", effect.kind), &effect.values_in_words());
    if !is_told {
        text += &line("  cause", effect.effect.row().cause);
        text += &line("  remedy", &effect.remedy());
    }
    if let Some(alternative) = effect.alternative_in_words() {
        text += &line("  else", &alternative);
    }
    text
}
