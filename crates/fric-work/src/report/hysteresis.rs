//! The page of a hysteresis: its width along and about each axis.

use fric_lab::hysteresis::{HysteresisResult, WidthResult};
use maud::{Markup, html};

/// The page.
#[must_use]
pub fn page(result: &HysteresisResult) -> String {
    let [x, y, z] = result.position_m;
    let content = html! {
        p.soft { (format!("Width of the wrench's hysteresis where the platform crosses ({x:.3}, {y:.3}, {z:.3}) m. ± is one standard error.")) }
        (widths(result))
    };
    super::shell(&format!("{}: hysteresis of the wrench", result.robot), &content)
}

/// The widths as a table by themselves.
#[must_use]
pub fn table(result: &HysteresisResult) -> String {
    widths(result).into_string()
}

fn widths(result: &HysteresisResult) -> Markup {
    html! {
        table {
            tr { th { "axis" } th { "passes" } th { "without" } th { "compensated" } th { "left" } }
            @for axis in &result.axes {
                tr {
                    td { (axis.axis) } td { (axis.passes) }
                    td { (width(axis.without.as_ref(), axis.unit)) } td { (width(axis.with.as_ref(), axis.unit)) }
                    td { (axis.lasting_ratio.map_or_else(|| "–".to_owned(), |ratio| format!("{:.1} %", 100.0 * ratio))) }
                }
            }
        }
    }
}

fn width(width: Option<&WidthResult>, unit: &str) -> String {
    let Some(WidthResult { width, standard_error }) = width else { return "–".to_owned() };
    let error = standard_error.map_or_else(String::new, |error| format!(" ± {error:.4}"));
    format!("{width:.4}{error} {unit}")
}
