//! Pages for people, each one file without network access, for light and dark screens and for paper.

mod chart;
pub mod continuum;
pub mod discovery;
pub mod errors;
pub mod fit;
mod friction;
pub mod hysteresis;
pub mod info;
mod plot;
pub mod preview;
mod run;
mod series;

use fric_core::text_file::harmless;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::provenance::Provenance;
use crate::verdict::{Tone, Verdict};
use plot::Plots;

pub use run::RunSeries;
pub use series::{Series, SignalSeries};

const STYLE: &str = include_str!("style.css");
/// The script that makes the plots interactive.
const SCRIPT: &str = include_str!("page.js");
/// The plotting library: uPlot 1.6.32, as its authors build it.
const UPLOT: &str = include_str!("../../vendor/uplot/uPlot.iife.min.js");
const UPLOT_STYLE: &str = include_str!("../../vendor/uplot/uPlot.min.css");
const UPLOT_LICENCE: &str = include_str!("../../vendor/uplot/LICENSE");

/// Formats a number, if there is one.
fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.4}"))
}

/// Returns a number with the sign of typography for a minus.
fn signed(number: &str) -> String {
    number.replace('-', "−")
}

/// A page: the verdict in a sentence, what to do, then the evidence.
struct Page<'a> {
    /// Title of the page, in a few words.
    title: String,
    verdict: Verdict,
    content: Markup,
    plots: Plots,
    /// Names of the cables that can be hidden.
    cables: Vec<&'a str>,
    /// Names of the files that the page is about.
    source: String,
    provenance: &'a Provenance,
}

impl Page<'_> {
    fn into_html(self) -> String {
        let Self { title, verdict: Verdict { tone, sentence, todo }, content, plots, cables, source, provenance } =
            self;
        let tone = match tone {
            Tone::Well => "well",
            Tone::Mixed => "mixed",
            Tone::Bad => "bad",
        };
        let plots = plots.into_json(&cables);
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (title) }
                    style { (PreEscaped(STYLE)) @if plots.is_some() { (PreEscaped(UPLOT_STYLE)) } }
                }
                body {
                    main {
                        h1 class=(tone) { (sentence) }
                        p.about { (title) " · " (source) }
                        @if !todo.is_empty() {
                            div.todo { h2 { "What to do" } ul { @for sentence in &todo { li { (sentence) } } } }
                        }
                        h2 data-evidence="" { "Evidence" }
                        (content)
                    }
                    (made(provenance))
                    @if let Some(numbers) = plots {
                        script type="application/json" id="fric-plots" { (PreEscaped(numbers)) }
                        script { (PreEscaped(library())) }
                        script { (PreEscaped(SCRIPT)) }
                    }
                }
            }
        };
        harmless(&page.into_string()).into_owned()
    }
}

/// Returns the library with its licence, which every copy must carry, in place of its address.
fn library() -> String {
    let code = UPLOT.split_once("*/\n").map_or(UPLOT, |(_, code)| code);
    format!("/*! uPlot 1.6.32\n{UPLOT_LICENCE}*/\n{code}")
}

/// Returns the provenance of the page.
fn made(provenance: &Provenance) -> Markup {
    let Provenance { program, version, made, command, inputs } = provenance;
    html! {
        footer {
            p { "Made by " (program) " " (version) " on " (made) " with " code { (command) } }
            @if !inputs.is_empty() {
                table {
                    thead { tr { th scope="col" { "file" } th scope="col" { "name" } th scope="col" { "SHA-256" } } }
                    tbody {
                        @for input in inputs {
                            tr { th scope="row" { (input.role) } td { (input.name) } td { code { (input.sha256.as_deref().unwrap_or("–")) } } }
                        }
                    }
                }
            }
        }
    }
}
