//! The page of `replay --report`: the table and the errors over time, in one file without network access.

mod chart;
mod series;

use std::path::PathBuf;

use maud::{DOCTYPE, Markup, PreEscaped, html};

pub use series::Series;

use crate::result::{ReplayResult, WrenchResult};

const STYLE: &str = "
:root { color-scheme: light dark; --text: #1b1f24; --soft: #5d6773; --line: #c9d0d8; --page: #ffffff;
  --before: #d9822b; --after: #1664c0; --flag: #e0405e; }
@media (prefers-color-scheme: dark) { :root { --text: #e6e9ed; --soft: #9aa5b1; --line: #3a434d; --page: #14181d;
  --before: #f0a35c; --after: #6db1ff; --flag: #ff7b93; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--text); background: var(--page); max-width: 62rem;
  margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .3rem; }
table { border-collapse: collapse; margin: .5rem 0 1rem; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .9rem .2rem 0; text-align: right; border-bottom: 1px solid var(--line); }
th:first-child, td:first-child { text-align: left; }
th { font-weight: 600; color: var(--soft); }
p.soft { color: var(--soft); margin: .2rem 0; }
.keys { white-space: nowrap; }
.key { display: inline-block; width: .9em; height: .9em; border-radius: .15em; vertical-align: -.1em; margin: 0 .3em 0 .8em; }
svg { width: 100%; height: auto; display: block; }
svg text { fill: var(--soft); font: 12px system-ui, sans-serif; }
svg .axis { stroke: var(--line); stroke-width: 1; fill: none; }
svg .before { fill: var(--before); stroke: var(--before); stroke-width: 1; }
svg .after { fill: var(--after); stroke: var(--after); stroke-width: .7; }
svg .flag { fill: var(--flag); }
@media print { body { max-width: none; margin: 0; } section { break-inside: avoid; } }
";

/// The page.
pub fn page(result: &ReplayResult, series: &Series, logs: &[PathBuf]) -> String {
    let title = format!("{}: forces at the platform", result.robot);
    let logs: Vec<String> = logs.iter().map(|log| log.display().to_string()).collect();
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (title) }
                p.soft {
                    (logs.join(", ")) ", " (result.cycle.count) " cycles; one takes " (result.cycle.median_ns) " ns (median), "
                    (result.cycle.p999_ns) " ns (99.9 %), " (result.cycle.max_ns) " ns (longest)."
                }
                (cables(result))
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
                        @match chart::deviations(series, index) {
                            Some(chart) => (PreEscaped(chart)),
                            None => p.soft { "The log has no reference for this cable." },
                        }
                    }
                }
            }
        }
    }
    .into_string()
}

fn cables(result: &ReplayResult) -> Markup {
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"));
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

fn wrench_table(wrench: &WrenchResult) -> Markup {
    let WrenchResult { before, after } = wrench;
    html! {
        table {
            tr { th { "wrench" } th { "rms before" } th { "after" } }
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
