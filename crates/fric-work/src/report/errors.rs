//! The page of `replay --report`: the table and the errors over time.

use fric_lab::errors::WrenchResult;
use maud::{Markup, PreEscaped, html};

use super::chart::{Chart, Span};
use super::number;
use super::series::{Extent, Interval, Series};
use crate::replay::ReplayResult;

/// The page; `logs` names what was replayed.
#[must_use]
pub fn page(result: &ReplayResult, series: &Series, logs: &[String]) -> String {
    let title = format!("{}: forces at the platform", result.robot);
    let content = html! {
                p.soft {
                    (logs.join(", ")) ", " (result.cycle.count) " cycles; one takes " (result.cycle.median_ns) " ns (median), "
                    (result.cycle.p999_ns) " ns (99.9 %), " (result.cycle.max_ns) " ns (longest)."
                }
                (cables(result))
                @for cable in result.cables.iter().filter(|cable| !cable.faults.is_empty()) {
                    h3 { "Faults of the recording of " (cable.name) }
                    ul { @for fault in &cable.faults { li { (fault.in_words()) } } }
                }
                @if let Some(wrench) = &result.wrench { (wrench_table(wrench)) }
                p {
                    "Deviation from the reference over time, least and greatest in each interval:"
                    span.keys { span.key style="background: var(--before)" {} "uncompensated" }
                    " "
                    span.keys { span.key style="background: var(--after)" {} "compensated" }
                    " "
                    span.keys { span.key style="background: var(--flag)" {} "flagged" }
                }
                @for (index, cable) in result.cables.iter().enumerate() {
                    section {
                        h2 { (cable.name) }
                        @match deviations(series, index) {
                            Some(chart) => (PreEscaped(chart)),
                            None => p.soft { "The log has no reference for this cable." },
                        }
                    }
                }
    };
    super::shell(&title, &content)
}

/// The errors as a table by themselves.
#[must_use]
pub fn table(result: &ReplayResult) -> String {
    cables(result).into_string()
}

fn cables(result: &ReplayResult) -> Markup {
    html! {
        table {
            tr {
                th { "cable" } th { "samples" } th { "flagged" } th { "rms before [N]" } th { "after [N]" }
                th { "mean |error| before [N]" } th { "after [N]" }
            }
            @for cable in &result.cables {
                tr {
                    td { (cable.name) } td { (cable.samples) } td { (cable.flagged) }
                    td { (number(cable.before.as_ref().map(|error| error.rms_n))) }
                    td { (number(cable.after.as_ref().map(|error| error.rms_n))) }
                    td { (number(cable.before.as_ref().map(|error| error.mae_n))) }
                    td { (number(cable.after.as_ref().map(|error| error.mae_n))) }
                }
            }
        }
    }
}

pub(super) fn wrench_table(wrench: &WrenchResult) -> Markup {
    let WrenchResult { before, after, .. } = wrench;
    html! {
        table {
            tr { th { (wrench.title()) } th { "rms before" } th { "after" } }
            tr {
                td { "force" }
                td { (format!("{:.4} N", before.force_rms_n)) } td { (format!("{:.4} N", after.force_rms_n)) }
            }
            tr {
                td { "torque" }
                td { (format!("{:.4} Nm", before.torque_rms_nm)) } td { (format!("{:.4} Nm", after.torque_rms_nm)) }
            }
        }
    }
}

/// Deviations of a cable before and after compensation; `None` where there are none.
fn deviations(series: &Series, cable: usize) -> Option<String> {
    let mut all = Extent { least: 0.0, greatest: 0.0 };
    let mut any = false;
    for (_, interval) in series.of_cable(cable) {
        for extent in [interval.before_n, interval.after_n] {
            any |= extent.is_something();
            all.merge(extent);
        }
    }
    if !any {
        return None;
    }
    let time = Span { least: 0.0, greatest: series.end_s().max(1e-9), unit: "s" };
    let mut chart = Chart::new(time, Span::with_margin(all, 0.05, "N"), 960.0, 200.0);
    let band = |pick: fn(&Interval) -> Extent| {
        series.of_cable(cable).map(move |(start_s, interval)| (start_s, pick(&interval)))
    };
    chart.bars("before", band(|interval| interval.before_n));
    chart.bars("after", band(|interval| interval.after_n));
    for (start_s, _) in series.of_cable(cable).filter(|(_, interval)| interval.is_flagged) {
        chart.mark("flag", start_s);
    }
    Some(chart.into_svg())
}
