//! The page of a hysteresis: its width along and about each axis, and the underlying loops.

use fric_lab::hysteresis::{HysteresisLoop, HysteresisResult, WidthResult};
use fric_lab::text::plain;
use maud::{Markup, html};

use super::Page;
use super::plot::{Axis, Plot, Plots, Trace, Values};
use super::series::Extent;
use crate::fit_report::value_text;
use crate::provenance::Provenance;
use crate::verdict::{self, left_in_words};

/// Returns the page; `loops` belong to the crossed axes.
#[must_use]
pub fn page(result: &HysteresisResult, loops: &[HysteresisLoop], provenance: &Provenance) -> String {
    let [x, y, z] = result.position_m.map(fric_lab::text::to_millimetre);
    let mut plots = Plots::default();
    let content = html! {
        p.soft { (format!("Width of the wrench's hysteresis where the platform crosses ({x:.3}, {y:.3}, {z:.3}) m. ± is one standard error; left: width compensated as a share of the width without.")) }
        (widths(result))
        @if !loops.is_empty() {
            h2 { "Loops" }
            p.soft { "Means of the wrench along, or about, each axis while the platform goes along it through the position, both ways. The width is taken at 0." }
            div.views { @for (plot, at) in loops_in_one_scale(loops) { (plots.figure(&plot, &at)) } }
        }
    };
    let title = format!("{}: hysteresis of the wrench", result.robot);
    Page {
        title,
        verdict: verdict::of_hysteresis(result),
        content,
        plots,
        cables: Vec::new(),
        source: provenance.logs(),
        provenance,
    }
    .into_html()
}

/// Returns the widths as a table.
#[must_use]
pub fn table(result: &HysteresisResult) -> String {
    widths(result).into_string()
}

fn widths(result: &HysteresisResult) -> Markup {
    html! {
        table {
            thead {
                tr {
                    th scope="col" { "axis" } th scope="col" { "passes" } th scope="col" { "without" } th scope="col" { "compensated" }
                    th scope="col" { "left" }
                }
            }
            tbody {
                @for axis in &result.axes {
                    tr {
                        th scope="row" { (axis.axis) } td { (axis.passes) }
                        td { (width(axis.without.as_ref(), axis.unit)) } td { (width(axis.with.as_ref(), axis.unit)) }
                        td { (axis.lasting_ratio.map_or_else(|| "–".to_owned(), left_in_words)) }
                    }
                }
            }
        }
    }
}

fn width(width: Option<&WidthResult>, unit: &str) -> String {
    let Some(WidthResult { width, standard_error }) = width else { return "–".to_owned() };
    match standard_error.filter(|error| *error > 0.0) {
        Some(error) => format!("{} ± {} {unit}", value_text(*width, Some(error)), plain(error)),
        None => format!("{width:.4} {unit}"),
    }
}

/// Returns the plots, each loop around its own mean, so that widths can be compared among forces and among torques.
fn loops_in_one_scale(loops: &[HysteresisLoop]) -> Vec<(Plot, Vec<f64>)> {
    let mut all: Vec<(Plot, Vec<f64>)> = loops.iter().map(of_axis).collect();
    for unit in ["N", "Nm"] {
        let mut extent = Extent::NOTHING;
        all.iter().filter(|(plot, _)| plot.y.unit == unit).for_each(|(plot, _)| extent.merge(plot.extent()));
        all.iter_mut().filter(|(plot, _)| plot.y.unit == unit).for_each(|(plot, _)| plot.span = Some(extent));
    }
    all
}

fn of_axis(of: &HysteresisLoop) -> (Plot, Vec<f64>) {
    let (unit, way) = (of.axis.wrench_unit(), if of.axis.is_rotation() { "rad" } else { "mm" });
    let (name, factor) = if of.axis.is_rotation() { ("angle", 1.0) } else { ("way", 1e3) };
    let what = if of.axis.is_rotation() { "torque" } else { "force" };
    let mut plot = Plot::new(format!("Axis {}", of.axis.name()), Axis::new(name, way), Axis::new(what, unit)).half();
    let middle = |pick: fn(&[f64; 2]) -> f64| {
        let values: Vec<f64> = of.directions.iter().flatten().map(pick).filter(|value| value.is_finite()).collect();
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let count = values.len().max(1) as f64;
        values.iter().sum::<f64>() / count
    };
    for (model, color, pick) in
        [("without", "before", (|pair| pair[0]) as fn(&[f64; 2]) -> f64), ("compensated", "after", |pair| pair[1])]
    {
        let middle = middle(pick);
        for (direction, values, is_dashed) in
            [("forwards", &of.directions[1], false), ("back", &of.directions[0], true)]
        {
            let values = values.iter().map(|pair| pick(pair) - middle).collect();
            let trace = Trace::new(&format!("{model}, {direction}"), color, Values::Line(values));
            plot.traces.push(Trace { is_dashed, ..trace });
        }
    }
    plot.uprights.push((0.0, String::new()));
    (plot, of.at.iter().map(|at| factor * at).collect())
}
