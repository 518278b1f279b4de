//! The page of `info`: the content of a log, what can be done with it, and its signals over time.

use maud::{Markup, html};

use super::Page;
use super::errors::COLORS;
use super::plot::{Axis, Plot, Plots, Trace, Values};
use super::series::{Signal, SignalSeries};
use crate::provenance::Provenance;
use crate::verdict::{Tone, Verdict, counted};

/// A table with its headings.
#[derive(Clone, Debug, Default)]
pub struct InfoTable {
    /// What it is of.
    pub title: &'static str,
    /// Column headings, with units in brackets.
    pub heads: Vec<&'static str>,
    /// Cells, row by row; the first cell of a row is its name.
    pub rows: Vec<Vec<String>>,
}

/// A step that the log allows or not.
#[derive(Clone, Debug)]
pub struct InfoStep {
    /// Its name.
    pub name: String,
    /// Whether it is possible.
    pub is_possible: bool,
    /// Missing data, or other remarks.
    pub remarks: Vec<String>,
}

/// The description of a log.
#[derive(Debug, Default)]
pub struct Overview<'a> {
    /// Name of the robot or manipulator; `None` where no model is known.
    pub model: Option<&'a str>,
    /// Tables of topics or columns, and of signals.
    pub tables: Vec<InfoTable>,
    /// Steps that can be done with the log; empty without a model.
    pub steps: Vec<InfoStep>,
    /// The cables with their signals.
    pub cables: Vec<&'a str>,
    /// Their signals over time.
    pub series: Option<SignalSeries>,
}

/// Returns the page.
#[must_use]
pub fn page(overview: &Overview<'_>, provenance: &Provenance) -> String {
    let mut plots = Plots::default();
    let content = html! {
        @for table in overview.tables.iter().filter(|table| !table.rows.is_empty()) { (listed(table)) }
        @if !overview.steps.is_empty() {
            h2 { "What the log allows" }
            table {
                thead { tr { th scope="col" { "step" } th.words scope="col" { "possible" } th.words scope="col" { "remarks" } } }
                tbody {
                    @for step in &overview.steps {
                        tr {
                            th scope="row" { (step.name) }
                            td.words { @if step.is_possible { "yes" } @else { "no" } }
                            td.words { (step.remarks.join("; ")) }
                        }
                    }
                }
            }
        }
        @if let Some(series) = &overview.series { (signals(&mut plots, series, &overview.cables)) }
    };
    let title = format!("{}what is in the log", overview.model.map_or_else(String::new, |model| format!("{model}: ")));
    Page {
        title,
        verdict: verdict(overview),
        content,
        plots,
        cables: overview.cables.clone(),
        source: provenance.logs(),
        provenance,
    }
    .into_html()
}

fn verdict(overview: &Overview<'_>) -> Verdict {
    let impossible: Vec<&InfoStep> = overview.steps.iter().filter(|step| !step.is_possible).collect();
    let (tone, sentence) = if overview.steps.is_empty() {
        (Tone::Mixed, "The log can be read; what it is good for is not known without a robot file.".to_owned())
    } else if impossible.is_empty() {
        (Tone::Well, format!("The log allows everything: {}.", steps(&overview.steps.iter().collect::<Vec<_>>())))
    } else if impossible.len() == overview.steps.len() {
        (Tone::Bad, "The log allows nothing: replay, fit and discovery all miss something.".to_owned())
    } else {
        let (possible, all) = (overview.steps.len() - impossible.len(), counted(overview.steps.len(), "step"));
        (Tone::Mixed, format!("The log allows {possible} of {all}; not {}.", steps(&impossible)))
    };
    let mut todo: Vec<String> =
        impossible.iter().map(|step| format!("For {}: {}.", step.name, step.remarks.join("; "))).collect();
    if overview.steps.is_empty() {
        todo.push("Name the robot file with --model, or draft one with fric-cli init.".to_owned());
    }
    if todo.is_empty() {
        todo.push("Go on: fric-cli replay, fit or discover.".to_owned());
    }
    Verdict { tone, sentence, todo }
}

fn steps(steps: &[&InfoStep]) -> String {
    let names: Vec<&str> = steps.iter().map(|step| step.name.as_str()).collect();
    fric_lab::text::listed(&names)
}

fn listed(table: &InfoTable) -> Markup {
    // A column is of words unless each of its cells is empty or begins with a number.
    let is_number = |cell: &String| {
        cell.is_empty()
            || cell.starts_with('–')
            || cell.starts_with(|letter: char| letter.is_ascii_digit() || letter == '-')
    };
    let words = |column: usize| {
        let is_words = table.rows.iter().filter_map(|row| row.get(column)).any(|cell| !is_number(cell));
        is_words.then_some("words")
    };
    html! {
        h2 { (table.title) }
        table {
            thead { tr { @for (place, head) in table.heads.iter().enumerate() { th scope="col" class=[words(place)] { (head) } } } }
            tbody {
                @for row in &table.rows {
                    tr {
                        @for (place, cell) in row.iter().enumerate() {
                            @if place == 0 { th scope="row" { (cell) } } @else { td class=[words(place)] { (breakable(cell)) } }
                        }
                    }
                }
            }
        }
    }
}

/// Returns a text that may break after the last slash of a path.
fn breakable(text: &str) -> Markup {
    match text.rsplit_once('/') {
        Some((path, name)) if !path.is_empty() => html! { (path) "/" wbr; (name) },
        _ => html! { (text) },
    }
}

/// Plots forces and lengths of every cable.
fn signals(plots: &mut Plots, series: &SignalSeries, cables: &[&str]) -> Markup {
    let of = |title: &str, signal: Signal, axis: Axis| {
        let mut plot = Plot::new(title, Axis::TIME, axis);
        for (cable, name) in cables.iter().enumerate() {
            if let Some((least, greatest)) = series.band(cable, signal) {
                let trace = Trace::new(name, COLORS[cable % COLORS.len()], Values::Band(least, greatest));
                plot.traces.push(Trace { cable: Some(cable), is_dashed: cable >= COLORS.len(), ..trace });
            }
        }
        plot
    };
    let all = [
        of("Force that the sensor shows", Signal::Sensor, Axis::new("force", "N")),
        of("Reference force at the platform", Signal::Reference, Axis::new("force", "N")),
        of("Cable length", Signal::Length, Axis::new("length", "m")),
    ];
    html! {
        h2 { "Signals over time" }
        @for plot in all.iter().filter(|plot| !plot.traces.is_empty()) { (plots.figure(plot, series.starts_s())) }
    }
}
