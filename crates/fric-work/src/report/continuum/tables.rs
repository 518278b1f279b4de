//! The tables of the pages, which notebooks show too.

use fric_lab::numbers::Numbers;
use fric_tendon_lab::identify::TendonFitResult;
use fric_tendon_lab::result::{CalibrationResult, FrictionResult, HoleResult, ShapeResult};
use maud::{Markup, html};

use crate::report::number;

pub(super) fn coefficient(result: &HoleResult) -> Markup {
    let [from, to] = result.interval;
    html! {
        table {
            tr { th { "loads" } th { "μ" } th { "±" } th { "95 %" } }
            tr {
                td { (result.loads) } td { (format!("{:.4}", result.mu)) } td { (format!("{:.4}", result.standard_error)) }
                td { (format!("{from:.4} to {to:.4}")) }
            }
        }
    }
}

pub(super) fn identified(result: &TendonFitResult) -> Markup {
    let of = |numbers: &Numbers, key: &str| number(numbers.get(key));
    html! {
        table {
            tr { th { "" } th { "given" } th { "found" } th { "±" } }
            @for (key, value) in &result.parameters.0 {
                tr { td { (key) } td { (of(&result.given, key)) } td { (number(Some(*value))) } td { (of(&result.standard_errors, key)) } }
            }
        }
        @for warning in result.warnings() { p { (warning) "." } }
    }
}

/// Returns the lines of the gratings.
pub(super) fn gratings(result: &CalibrationResult) -> Markup {
    html! {
        table {
            tr {
                th { "grating" } th { "a [N/nm]" } th { "b [N]" } th { "± T [N]" } th { "largest residual [%]" } th { "left out [%]" }
            }
            @for one in &result.gratings {
                tr {
                    td { (one.grating) } td { (format!("{:.4}", one.newton_per_nm)) } td { (format!("{:.4}", one.offset_n)) }
                    td { (format!("{:.4}", one.standard_error_n)) }
                    td { (format!("{:.2}", 100.0 * one.largest_residual_ratio)) }
                    td { (format!("{:.2}", 100.0 * one.largest_left_out_ratio)) }
                }
            }
        }
    }
}

/// Returns the friction at each hole over the run.
pub(super) fn friction_by_hole(result: &FrictionResult) -> Markup {
    html! {
        table {
            tr {
                th { "hole" } th { "mean [N]" } th { "least [N]" } th { "greatest [N]" } th { "± [N]" } th { "positive" } th { "negative" }
            }
            @for hole in &result.holes {
                tr {
                    td { (hole.hole) } td { (newtons(hole.mean_n)) } td { (newtons(hole.least_n)) } td { (newtons(hole.greatest_n)) }
                    td { (newtons(hole.standard_error_n)) }
                    td { (format!("{:.0} %", 100.0 * hole.positive_ratio)) } td { (format!("{:.0} %", 100.0 * hole.negative_ratio)) }
                }
            }
        }
    }
}

/// Returns the distances from the markers.
pub(super) fn errors_by_way(result: &ShapeResult) -> Markup {
    html! {
        table {
            tr { th { "way" } th { "max, shown [mm]" } th { "mean [mm]" } th { "max, all [mm]" } th { "mean [mm]" } th { "missing" } }
            @for way in &result.ways {
                tr {
                    td { (way.way.name()) }
                    td { (millimetres(way.picked.max_mm)) } td { (millimetres(way.picked.mean_mm)) }
                    td { (millimetres(way.all.max_mm)) } td { (millimetres(way.all.mean_mm)) } td { (way.missing) }
                }
            }
        }
    }
}

fn newtons(value: f64) -> String {
    if value.is_finite() { format!("{value:.4}") } else { "–".to_owned() }
}

fn millimetres(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}
