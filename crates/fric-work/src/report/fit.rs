//! The page of a fit: values with their errors, correlations, and the remaining gap to the reference.

use fric_lab::fit::result::{FitCableResult, FitResult, LogValues};
use fric_lab::text::plain;
use fric_lab::words::Times;
use maud::{Markup, html};

use super::errors::wrench_table;
use super::plot::Plots;
use super::{Page, signed};
use crate::fit_report::{Correlation, correlations, value_text};
use crate::provenance::Provenance;
use crate::verdict::{self, left_in_words};

/// Returns the page; `fits` belong to the result.
#[must_use]
pub fn page(result: &FitResult, fits: &[fric_lab::fit::CableFit], provenance: &Provenance) -> String {
    let content = html! {
        p.soft { "Fitted to " (result.reference.in_words()) ". ± is one standard error." }
        (errors(result))
        @if let Some(wrench) = &result.wrench { (wrench_table(wrench)) }
        (samples(result))
        @for (cable, fit) in result.cables.iter().zip(fits) {
            section {
                h2 { (cable.name) }
                @if !cable.faults.is_empty() {
                    h3 { "Faults of the recording" }
                    ul { @for fault in &cable.faults { li { (fault.in_words(&Times::default())) } } }
                }
                (values(std::slice::from_ref(cable)))
                (log_values(&cable.per_log))
                @for Correlation { first, second, value } in correlations(fit) {
                    p.soft { "Correlation of " (first) " and " (second) ": " (signed(&format!("{value:.3}"))) }
                }
            }
        }
    };
    let title = format!("{}: friction fitted", result.robot);
    let (verdict, plots) = (verdict::of_fit(result), Plots::default());
    Page { title, verdict, content, plots, cables: Vec::new(), source: provenance.logs(), provenance }.into_html()
}

/// Returns the samples that were used and left out, and how the search ended.
fn samples(result: &FitResult) -> Markup {
    let (header, rows) = result.samples();
    html! {
        table {
            tr { @for head in header { th scope="col" { (head) } } }
            @for row in rows { tr { @for cell in row { td { (cell) } } } }
        }
        p.soft { "Samples of the fit, and those that were left out." }
    }
}

/// Returns the values as a table.
#[must_use]
pub fn table(result: &FitResult) -> String {
    values(&result.cables).into_string()
}

fn values(cables: &[FitCableResult]) -> Markup {
    html! {
        table {
            tr { th { "cable" } th.words { "parameter" } th { "value" } th { "±" } th.words { "" } }
            @for cable in cables {
                @for (name, value) in &cable.parameters.0 {
                    tr {
                        td { (cable.name) } td.words { (name) } td { (signed(&value_text(*value, cable.standard_errors.get(name)))) }
                        td { (cable.standard_errors.get(name).map_or_else(|| "–".to_owned(), plain)) }
                        td.words { (remark(cable, name)) }
                    }
                }
            }
        }
    }
}

/// Returns what each log has of its own as a table; empty if the logs share all parameters.
pub(crate) fn log_values(logs: &[LogValues]) -> Markup {
    html! {
        @if !logs.is_empty() {
            h3 { "Of each log its own" }
            p.soft { (LogValues::EXPLANATION) "." }
            table {
                tr { th.words { "log" } th.words { "parameter" } th { "value" } th { "±" } }
                @for log in logs {
                    @for (name, value) in &log.parameters.0 {
                        tr {
                            td.words { (log.log) } td.words { (name) }
                            td { (signed(&value_text(*value, log.standard_errors.get(name)))) }
                            td { (log.standard_errors.get(name).map_or_else(|| "–".to_owned(), plain)) }
                        }
                    }
                }
            }
        }
    }
}

/// Returns the remark on a value.
pub(crate) fn remark(cable: &FitCableResult, name: &str) -> &'static str {
    let is_in = |names: &[String]| names.iter().any(|other| other == name);
    if is_in(&cable.undetermined) {
        "not determined by the samples, kept as given"
    } else if is_in(&cable.at_bound) {
        "at the end of its range"
    } else if cable.standard_errors.get(name).is_none() {
        "kept as given"
    } else {
        ""
    }
}

/// Returns the remaining fraction of the error with the fitted model.
pub(crate) fn left(cable: &FitCableResult) -> Option<f64> {
    let (before, after) = cable.before.zip(cable.after)?;
    Some(after.rms_n / before.rms_n).filter(|left| left.is_finite())
}

fn errors(result: &FitResult) -> Markup {
    html! {
        @if result.cables.iter().any(|cable| cable.before.is_some()) {
            table {
                tr {
                    th scope="col" { "cable" } th scope="col" { "rms before [N]" } th scope="col" { "after [N]" }
                    th scope="col" { "left" }
                }
                @for cable in &result.cables {
                    tr {
                        td { (cable.name) }
                        td { (super::number(cable.before.map(|error| error.rms_n))) }
                        td { (super::number(cable.after.map(|error| error.rms_n))) }
                        td { (left(cable).map_or_else(|| "–".to_owned(), left_in_words)) }
                    }
                }
            }
        }
    }
}
