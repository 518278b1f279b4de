//! The page of `discover --report`: the verdicts, then for each cable the findings with position and uncertainty.

mod drawings;
mod plots;

use fric_lab::discover::result::{
    Candidate, DiscoverCableResult, DiscoverResult, EffectResult, WhereResult, WrenchGap,
};
use fric_lab::discover::{CableDiscovery, Model, Verdict};
use fric_lab::fit::{HALF_INTERVAL, Parameter};
use fric_lab::text::quantity;
use fric_lab::words::{Stretch, Times, condition, evidence, interval, name_of, percent, significance};
use maud::{Markup, PreEscaped, html};

use self::drawings::{ladder, of_table, over_condition};
use self::plots::{Common, curves, over_time, periodic};
use crate::provenance::Provenance;
use crate::report::fit::log_values;
use crate::report::plot::Plots;
use crate::report::{Page, number};
use crate::verdict;

/// Returns the page.
#[must_use]
pub fn page(result: &DiscoverResult, discoveries: &[CableDiscovery], provenance: &Provenance) -> String {
    let mut plots = Plots::default();
    let (common, times) = (Common::of(discoveries), result.times());
    let content = html! {
        @if result.cables.len() > 1 {
            nav {
                @for (place, cable) in result.cables.iter().enumerate() {
                    a href=(format!("#cable-{place}")) { span class=(cable.verdict.name()) { "● " } (cable.name) }
                }
            }
        }
        (overview(result, |place, name| html! { a href=(format!("#cable-{place}")) { (name) } }))
        @if let Some(gap) = &result.wrench { (of_wrench(gap)) }
        @for effect in &result.common_effects {
            p { (effect.in_words(result)) "." }
        }
        @for (place, (cable, found)) in result.cables.iter().zip(discoveries).enumerate() {
            section.cable id=(format!("cable-{place}")) data-cable=(place) {
                h2 { (cable.name) ": " span class={ "verdict " (cable.verdict.name()) } { (cable.verdict.name()) } }
                p { (cable.verdict_in_words(result.wrench.as_ref().is_some_and(|gap| gap.is_of_no_cable))) }
                @if cable.noise_floor_n.is_some() { (details(&mut plots, &common, &times, cable, found)) }
            }
        }
    };
    let title = format!("{}: what the model lacks", result.robot);
    let names = result.cables.iter().map(|cable| cable.name.as_str()).collect();
    Page {
        title,
        verdict: verdict::of_discovery(result),
        content,
        plots,
        cables: names,
        source: provenance.logs(),
        provenance,
    }
    .into_html()
}

/// Returns the verdicts as a table.
#[must_use]
pub fn table(result: &DiscoverResult) -> String {
    overview(result, |_, name| html! { (name) }).into_string()
}

/// Returns what the model after is, for legends and headings; `None` where it is the one before.
fn after_name(found: &CableDiscovery) -> Option<&'static str> {
    // Samples that do not count are NaN.
    let differ = |(before, after): (&f64, &f64)| before.to_bits() != after.to_bits();
    if !found.findings.is_empty() {
        Some("extended model")
    } else if !found.residual_before_n.iter().zip(&found.residual_after_n).any(differ) {
        None
    } else if found.faults.is_empty() {
        // By the wrench, other cables have been extended.
        Some("extended model")
    } else {
        Some("recording corrected")
    }
}

/// Returns the verdicts; `named` formats a cable's name, possibly as a link.
fn overview(result: &DiscoverResult, named: impl Fn(usize, &str) -> Markup) -> Markup {
    let with_errors = result.cables.iter().any(|cable| cable.before.is_some());
    let with_shares = result.cables.iter().any(|cable| share_closed(cable).is_some());
    html! {
        table {
            tr {
                th scope="col" { "cable" } th.words scope="col" { "verdict" } th.words scope="col" { "found" } th scope="col" { "noise [N]" }
                @if with_errors { th scope="col" { "rms before [N]" } th scope="col" { "after [N]" } }
                @if with_shares { th scope="col" { "gap closed" } }
            }
            @for (place, cable) in result.cables.iter().enumerate() {
                tr {
                    td { (named(place, &cable.name)) }
                    td class={ "words verdict " (cable.verdict.name()) } { (cable.verdict.name()) }
                    td.words {
                        @if cable.effects.is_empty() { "–" }
                        (cable.effects.iter().map(|effect| effect.kind).collect::<Vec<_>>().join(", "))
                    }
                    td { (number(cable.noise_floor_n)) }
                    @if with_errors {
                        td { (number(cable.before.map(|error| error.rms_n))) }
                        td { (number(cable.after.map(|error| error.rms_n))) }
                    }
                    @if with_shares { td { (share_closed(cable).map_or_else(|| "–".to_owned(), percent)) } }
                }
            }
        }
        @if with_errors {
            p.soft {
                "Root mean squares over samples that no fit has seen: before, of the given model fitted to the others; after, of \
                 the extended one."
                @if result.cables.iter().any(|cable| !cable.faults.is_empty()) { " A correction of the recording is part of after." }
            }
        }
    }
}

/// Returns the share of the gap that the effects close; `None` without an effect.
fn share_closed(cable: &DiscoverCableResult) -> Option<f64> {
    cable.gap_closed.filter(|_| !cable.effects.is_empty())
}

/// Returns the findings for all cables together.
fn of_wrench(gap: &WrenchGap) -> Markup {
    html! {
        h2 { "All cables together: " span class={ "verdict " (gap.verdict.name()) } { (gap.verdict.name()) } }
        table {
            tr { th { (gap.title()) } th { "noise" } th { "rms before" } th { "after" } }
            @for component in &gap.components {
                tr { @for cell in component.cells() { td { (cell) } } }
            }
        }
        @for sentence in gap.in_words() { p { (sentence) } }
        p.soft {
            "Of a cable below, a residual is the error of its force alone that comes nearest to the deviation of the wrench: what is seen there \
             may sit in another cable with the same lever."
        }
    }
}

fn details(
    plots: &mut Plots,
    common: &Common,
    times: &Times<'_>,
    cable: &DiscoverCableResult,
    found: &CableDiscovery,
) -> Markup {
    // The plot that a time interval links to.
    let over_time_id = plots.next_id();
    html! {
        @for effect in &cable.effects { (effect_in_words(effect)) }
        @if !cable.faults.is_empty() {
            h3 { "Faults of the recording" }
            ul { @for fault in &cable.faults { li { (fault.in_words(times)) } } }
        }
        @if let Some(bound) = cable.bound_in_words() { p.soft { (bound) "." } }
        @if let Some(values) = cable.undetermined_in_words() { p.soft { (values) "." } }
        @for revised in cable.revised_in_words() { p.soft { (revised) "." } }
        @if let Some(outliers) = cable.outliers_in_words() { p.soft { (outliers) "." } }
        @if let Some(rest) = &cable.unexplained {
            h3 { "Unexplained" }
            ul { @for sentence in rest.in_words(times) { li { (sentence) } } }
        }
        @if cable.verdict != Verdict::Complete && cable.before.is_some() {
            figure {
                h3 { "Gap" }
                (PreEscaped(ladder(cable)))
            }
        }
        h3 { "Residual over time" }
        (plots.figure(&over_time(common, cable, found), &common.starts_s(&found.times_s)))
        (curves(plots, cable, found))
        (periodic(plots, cable, found))
        @for profile in &found.profiles { (over_condition(cable, profile)) }
        (places("Where the given model disagrees", &cable.places, times, &over_time_id))
        // Without an effect the rest equals the whole gap.
        @if let Some(rest) = cable.unexplained.as_ref().filter(|_| !cable.effects.is_empty() || cable.places.is_empty()) {
            (places("Where the rest lies", &rest.places, times, &over_time_id))
        }
        (candidates(cable))
        (parameters(found))
        (log_values(&cable.per_log))
    }
}

fn effect_in_words(effect: &EffectResult) -> Markup {
    html! {
        h3 { (effect.kind) }
        dl {
            dt { "values" } dd { (effect.values_in_words()) }
            dt { "cause" } dd { (effect.effect.row().cause) }
            dt { "remedy" } dd { (effect.remedy()) }
            @if let Some(alternative) = effect.alternative_in_words() { dt { "else" } dd { (alternative) } }
        }
        @if let Some(table) = &effect.table {
            figure {
                h3 { "Unnamed, over the " (condition(table.over)) }
                p.soft { "What the table adds, with its 95 % interval; beyond the ends the first and the last hold." }
                (PreEscaped(of_table(table)))
            }
        }
    }
}

fn places(title: &str, places: &[WhereResult], times: &Times<'_>, plot: &str) -> Markup {
    let share = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), percent);
    html! {
        @if !places.is_empty() {
            h3 { (title) }
            table {
                tr {
                    th { "condition" } th.words { "range" } th { "of the gap" } th { "of the samples" } th { "told by it" }
                    th { "significance" } th.words { "look at" }
                }
                @for place in places {
                    tr {
                        td { (condition(place.signal)) }
                        td.words { (place.range_in_words()) }
                        td { (share(place.share_of_excess)) } td { (share(place.share_of_samples)) }
                        td { (share(place.explains)) }
                        td { (place.significance.map_or_else(|| "–".to_owned(), significance)) }
                        td.words {
                            @if place.intervals_s.is_empty() { "–" } @else { (looks(&place.intervals_s, times, plot)) }
                        }
                    }
                }
            }
            p.soft {
                "Told by it: the share of the gap that is a function of this condition and of the direction of motion. \
                 Significance of either share, in standard errors; below 3 σ it may be chance."
            }
        }
    }
}

/// Returns links from time intervals to a plot.
fn looks(intervals_s: &[[f64; 2]], times: &Times<'_>, plot: &str) -> Markup {
    let stretches = || intervals_s.iter().flat_map(|interval_s| times.stretches(interval_s));
    html! {
        @for (place, Stretch { log, own_s, joined_s: [from_s, to_s] }) in stretches().enumerate() {
            @if place > 0 { ", " }
            a href=(format!("#{plot}")) data-look=(format!("{from_s} {to_s}")) { (interval(&own_s)) }
            @if let Some(name) = log { " s of " (name) }
        }
        @if stretches().all(|stretch| stretch.log.is_none()) { " s" }
    }
}

/// Returns the outcome of a candidate.
fn outcome(cable: &DiscoverCableResult, candidate: &Candidate) -> String {
    if cable.effects.iter().any(|effect| effect.kind == candidate.kind) {
        return "named".to_owned();
    }
    match cable.tried.iter().find(|tried| tried.kind == candidate.kind) {
        Some(tried) => tried.reason.clone(),
        None if candidate.delta_bic.is_none_or(|delta_bic| delta_bic >= 0.0) => "does not help".to_owned(),
        None if cable.effects.is_empty() => "no better than what noise that wanders may give".to_owned(),
        None => "not needed beside what is named".to_owned(),
    }
}

fn candidates(cable: &DiscoverCableResult) -> Markup {
    let is_found = |of: &Candidate| cable.effects.iter().any(|effect| effect.kind == of.kind);
    html! {
        @if !cable.candidates.is_empty() {
            figure {
                h3 { "Candidates" }
                table {
                    tr {
                        th scope="col" { "effect" } th scope="col" { "ΔBIC alone" } th scope="col" { "rms held out [N]" }
                        th.words scope="col" { "outcome" }
                    }
                    @for candidate in &cable.candidates {
                        tr class=[is_found(candidate).then_some("found")] {
                            td { (candidate.kind) } td { (evidence(candidate.delta_bic)) }
                            td { (number(candidate.held_out_rms_n)) }
                            td.words { (outcome(cable, candidate)) }
                        }
                    }
                }
                p.soft {
                    "ΔBIC of each by itself beside the given model, as the search began: below zero it helps. Several may help for one \
                     cause; which is named is decided beside the others, so that a low ΔBIC here is not yet a name."
                }
            }
        }
    }
}

fn parameters(found: &CableDiscovery) -> Markup {
    let of_finding = |parameter: &Parameter| {
        found.findings.iter().any(|finding| finding.effect.places().contains(&parameter.place()))
    };
    let shown = Parameter::all().filter(|parameter| found.after.fitted.contains(parameter) || of_finding(parameter));
    let shown: Vec<Parameter> = shown.collect();
    let after = after_name(found);
    let value = |model: &Model, parameter: &Parameter| {
        let half = model.standard_error(parameter).map(|error| HALF_INTERVAL * error);
        quantity(model.values[parameter.place()], half, parameter.row().unit)
    };
    // By the wrench, only the covariance of the last model is computed. Where nothing was found, that is the given one.
    let has_error = |parameter: &Parameter| found.before.standard_error(parameter).is_none_or(f64::is_finite);
    let given = if after.is_some() { &found.before } else { &found.after };
    html! {
        figure {
            h3 { "Parameters" }
            table {
                tr {
                    th { "parameter" } th { "given model, fitted" }
                    @if let Some(after) = after { th { (after) } }
                }
                @for parameter in &shown {
                    tr {
                        td { @if let Some(effect) = parameter.effect() { (effect.to_string()) ": " } (name_of(parameter.row().key)) }
                        td { @if of_finding(parameter) { "–" } @else { (value(given, parameter)) } }
                        @if after.is_some() { td { (value(&found.after, parameter)) } }
                    }
                }
            }
            p.soft {
                @if after.is_some() && !shown.iter().all(has_error) {
                    "Fitted, ± 95 %, which is not computed for the given model; without ± in the other column it is a setting."
                } @else {
                    "Fitted, ± 95 %; without ± it is a setting."
                }
            }
        }
    }
}
