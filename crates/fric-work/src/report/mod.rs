//! Pages for people, each one file without network access, for light and dark screens and for paper.

mod chart;
pub mod continuum;
pub mod discovery;
pub mod errors;
pub mod fit;
pub mod hysteresis;
pub mod preview;
mod run;
mod series;

use maud::{DOCTYPE, Markup, PreEscaped, html};

pub use run::RunSeries;
pub use series::Series;

const STYLE: &str = "
:root { color-scheme: light dark; --text: #1b1f24; --soft: #5d6773; --line: #c9d0d8; --page: #ffffff;
  --before: #d9822b; --after: #1664c0; --flag: #e0405e; --good: #1d7d4f;
  --none: #8a94a0; --coulomb: var(--before); --measured: var(--good); --history: var(--after); --marker: var(--flag); }
@media (prefers-color-scheme: dark) { :root { --text: #e6e9ed; --soft: #9aa5b1; --line: #3a434d; --page: #14181d;
  --before: #f0a35c; --after: #6db1ff; --flag: #ff7b93; --good: #58c793; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--text); background: var(--page); max-width: 62rem;
  margin: 2rem auto; padding: 0 1rem; overflow-wrap: break-word; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin: 2rem 0 .3rem; }
table { border-collapse: collapse; margin: .5rem 0 1rem; font-variant-numeric: tabular-nums; display: block; overflow-x: auto; }
th, td { padding: .2rem .9rem .2rem 0; text-align: right; border-bottom: 1px solid var(--line); }
td { white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
th { font-weight: 600; color: var(--soft); }
p.soft { color: var(--soft); margin: .2rem 0; }
.keys { display: inline-block; }
.key { display: inline-block; width: .9em; height: .9em; border-radius: .15em; vertical-align: -.1em; margin: 0 .3em 0 .8em;
  print-color-adjust: exact; }
svg { width: 100%; height: auto; display: block; } .chart { overflow-x: auto; }
svg text { fill: var(--soft); font: 12px system-ui, sans-serif; }
svg .axis { stroke: var(--line); stroke-width: 1; fill: none; }
svg .before { fill: var(--before); stroke: var(--before); stroke-width: 1; }
svg .after { fill: var(--after); stroke: var(--after); stroke-width: .7; }
svg .flag { fill: var(--flag); }
svg .greatest { stroke: var(--before); stroke-width: 1.2; } svg .least { stroke: var(--after); stroke-width: 1.2; }
svg .path { stroke: var(--after); stroke-width: 1.5; fill: none; stroke-linejoin: round; }
svg .box { stroke: var(--soft); stroke-width: 1.2; stroke-dasharray: 5 4; fill: none; }
svg .base { fill: var(--before); }
svg .bound { stroke: var(--flag); stroke-width: 1.2; stroke-dasharray: 5 4; fill: none; }
svg .even { fill: none; } svg .odd { fill: var(--line); opacity: .35; }
.views { display: flex; gap: 1rem; flex-wrap: wrap; } .views section, .views figure { flex: 1 1 24rem; min-width: 0; }
svg .trace { stroke-width: 1.8; stroke-linejoin: round; } svg .trace.before, svg .trace.after { fill: none; stroke-width: 1.8; }
svg .back { stroke-dasharray: 6 4; } svg .floor { stroke: var(--text); stroke-width: 1.2; stroke-dasharray: 2 3; fill: none; }
svg .look { fill: var(--flag); opacity: .16; } svg .held { fill: var(--soft); opacity: .75; }
svg rect.before, svg rect.after { stroke: none; } svg .solid { stroke-width: 1.15; }
svg .none { stroke: var(--none); } svg .coulomb { stroke: var(--coulomb); } svg .measured { stroke: var(--measured); }
svg .history { stroke: var(--history); } svg .trace { fill: none; } svg .marker { fill: var(--marker); }
svg .bar { stroke: none; print-color-adjust: exact; } svg .bar.coulomb { fill: var(--coulomb); }
svg .bar.measured { fill: var(--measured); } svg .bar.history { fill: var(--history); }
nav { position: sticky; top: 0; background: var(--page); border-bottom: 1px solid var(--line); padding: .45rem 0;
  display: flex; flex-wrap: wrap; gap: .2rem 1.1rem; z-index: 1; }
a { color: var(--after); text-decoration: none; } a:hover { text-decoration: underline; }
section.cable { scroll-margin-top: 3rem; border-top: 2px solid var(--line); margin-top: 2.2rem; }
h3 { font-size: 1rem; margin: 1.4rem 0 .3rem; } figure { margin: 0; break-inside: avoid; }
.verdict { font-weight: 600; } .complete { color: var(--good); } .extended { color: var(--after); }
.unexplained { color: var(--flag); } .untold { color: var(--soft); }
td.words, th.words { text-align: left; } td.words { white-space: normal; min-width: 6rem; } td.verdict { min-width: 0; } tr.found td { font-weight: 600; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; margin: .4rem 0; }
dt { color: var(--soft); } dd { margin: 0; } ul { margin: .4rem 0; padding-left: 1.2rem; }
@media (max-width: 40rem) { table { font-size: .8rem; } th, td { padding-right: .5rem; } }
@media print { nav { display: none; } section.cable { break-inside: auto; } section.cable + section.cable { break-before: page; }
  h3 { break-after: avoid; margin-top: .9rem; } a { color: inherit; } html, body { font-size: 12px; }
  .views section, .views figure { flex: 1 1 16rem; } }
@media print { body { max-width: none; margin: 0; } section { break-inside: avoid; } table { display: table; }
  svg { min-width: 0 !important; } }
";

/// A number where there is one.
fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"))
}

/// A page with this title and content.
fn shell(title: &str, content: &Markup) -> String {
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
                (content)
            }
        }
    }
    .into_string()
}
