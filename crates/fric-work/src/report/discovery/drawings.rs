//! The drawings of a cable: the gap effect by effect, the table of what has no name, and residuals over a condition.

use fric_lab::discover::result::{DiscoverCableResult, TablePoint, TableResult};
use fric_lab::discover::{Profile, ProfileCell};
use fric_lab::fit::HALF_INTERVAL;
use fric_lab::text::scaled_unit;
use fric_lab::words::{condition, newtons, percent};
use maud::{Markup, PreEscaped, html};

use crate::report::chart::{Chart, Span};
use crate::report::series::Extent;

/// Width of a single chart, and of one of two.
const WIDE: f64 = 960.0;

const HALF: f64 = 470.0;

/// Draws a table over its condition, with the uncertainty of each point.
pub(super) fn of_table(table: &TableResult) -> String {
    let percents = if table.changes == "friction" { 100.0 } else { 1.0 };
    let half = |point: &TablePoint| HALF_INTERVAL * percents * point.standard_error.unwrap_or(0.0);
    let value = |point: &TablePoint| percents * point.value;
    let mut all = Extent { least: 0.0, greatest: 0.0 };
    for point in &table.points {
        all.add(value(point) - half(point));
        all.add(value(point) + half(point));
    }
    let ends = table.points.first().zip(table.points.last()).map_or((0.0, 1.0), |(first, last)| (first.at, last.at));
    let x = Span { least: ends.0, greatest: ends.1, unit: table.unit };
    let mut chart = Chart::new(x, Span::with_margin(all, 0.08, if percents > 1.0 { "%" } else { "N" }), WIDE, 240.0);
    let bar = |point: &TablePoint| {
        (point.at, Extent { least: value(point) - half(point), greatest: value(point) + half(point) })
    };
    chart.bars("after", table.points.iter().map(bar));
    chart.line("trace after", table.points.iter().map(|point| [point.at, value(point)]));
    chart.level("floor", 0.0, "", true);
    chart.into_svg("What the table adds, with its 95 % interval")
}

fn key(color: &str, text: &str) -> Markup {
    html! { span.keys { span.key style=(format!("background: var(--{color})")) {} (text) } " " }
}

/// Draws a step for each effect that entered.
pub(super) fn ladder(cable: &DiscoverCableResult) -> String {
    let rms_n = |error: Option<f64>| error.unwrap_or(f64::NAN);
    let mut steps = vec![("given model".to_owned(), rms_n(cable.before.map(|error| error.rms_n)), None)];
    for effect in &cable.effects {
        steps.push((format!("+ {}", effect.kind), rms_n(effect.evidence.held_out_rms_n), effect.gap_closed));
    }
    let names: Vec<&str> = steps.iter().map(|(name, ..)| name.as_str()).collect();
    let floor_n = cable.noise_floor_n.unwrap_or(0.0);
    let greatest = steps.iter().map(|(_, rms_n, _)| *rms_n).fold(floor_n, f64::max);
    // Space for the text after the longest bar.
    let x = Span { least: 0.0, greatest: 1.35 * greatest.max(1e-9), unit: "N" };
    let mut chart = Chart::in_rows(x, &names, WIDE);
    for (row, (_, rms_n, closed)) in steps.iter().enumerate() {
        let closed = closed.map_or_else(String::new, |share| format!(", {} of the gap closed", percent(share)));
        let words = format!("{}{closed}", newtons(*rms_n));
        chart.bar(if row == 0 { "before" } else { "after" }, row, *rms_n, &words, floor_n);
    }
    chart.upright("floor", floor_n);
    chart.into_svg("The gap by the effects that entered: root mean square of the error held out")
        + &html! { p.soft { "Dotted: the noise, " (newtons(floor_n)) "." } }.into_string()
}

/// Plots the residuals over a condition: magnitude and direction.
pub(super) fn over_condition(cable: &DiscoverCableResult, profile: &Profile) -> Markup {
    let is_extended = !cable.effects.is_empty();
    html! {
        figure {
            h3 { "Residual against the " (condition(profile.signal)) }
            p {
                (key("before", "before: given model"))
                @if is_extended { (key("after", "after: extended model")) }
            }
            p.soft {
                (if profile.are_even { "Each step is as wide." } else { "Each step holds as many samples." })
                " Means are dashed while the cable is reeled in, solid while it is paid out."
            }
            div.views {
                figure {
                    p.soft { "root mean square, dotted the noise" }
                    (PreEscaped(sizes(cable, profile)))
                }
                figure {
                    p.soft { "mean by direction" }
                    (PreEscaped(means(is_extended, profile)))
                }
            }
        }
    }
}

/// Returns the corners of a step function.
fn steps(values: &[f64]) -> impl Iterator<Item = [f64; 2]> {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let edge = |step: usize| step as f64;
    values.iter().enumerate().flat_map(move |(step, value)| [[edge(step), *value], [edge(step + 1), *value]])
}

/// Returns the edges of a profile's bins in a suitable unit, and the unit.
fn edges(profile: &Profile) -> (Vec<f64>, &'static str) {
    let edges = profile.bins.first().map(|bin| bin.from).into_iter().chain(profile.bins.iter().map(|bin| bin.to));
    let greatest = edges.clone().map(f64::abs).fold(0.0, f64::max);
    let middle = profile.bins.get(profile.bins.len() / 2).map_or(greatest, |bin| bin.from);
    let (factor, unit) = scaled_unit(middle, profile.unit);
    // Values that are negligible beside the others are written as 0.
    let shown = |edge: f64| if edge.abs() < 1e-4 * greatest { 0.0 } else { edge * factor };
    (edges.map(shown).collect(), if unit == "1" { "" } else { unit })
}

/// Returns the traces of a profile: the class of each model, with the picked value of its cells.
fn traces(profile: &Profile, is_extended: bool, pick: impl Fn(&ProfileCell) -> f64) -> Vec<(&'static str, Vec<f64>)> {
    let before: Vec<f64> = profile.bins.iter().map(|bin| pick(&bin.before)).collect();
    let after: Vec<f64> = profile.bins.iter().map(|bin| pick(&bin.after)).collect();
    if is_extended { vec![("before", before), ("after", after)] } else { vec![("before", before)] }
}

fn sizes(cable: &DiscoverCableResult, profile: &Profile) -> String {
    let traces = traces(profile, !cable.effects.is_empty(), |cell| cell.rms_n);
    let mut extent = Extent { least: 0.0, greatest: cable.noise_floor_n.unwrap_or(0.0) };
    traces.iter().flat_map(|(_, values)| values).for_each(|value| extent.add(*value));
    extent.greatest *= 1.08;
    let (edges, unit) = edges(profile);
    let mut chart =
        Chart::in_steps(&edges, unit, Span { least: 0.0, greatest: extent.greatest, unit: "N" }, HALF, 240.0);
    for (class, values) in &traces {
        chart.line(&format!("trace {class}"), steps(values));
    }
    chart.level("floor", cable.noise_floor_n.unwrap_or(0.0), "", true);
    chart.into_svg(&format!("Root mean square of the residual in newtons over the {}", condition(profile.signal)))
}

fn means(is_extended: bool, profile: &Profile) -> String {
    let out = traces(profile, is_extended, |cell| cell.paying_out_n);
    let back = traces(profile, is_extended, |cell| cell.reeling_in_n);
    let mut extent = Extent { least: 0.0, greatest: 0.0 };
    out.iter().chain(&back).flat_map(|(_, values)| values).for_each(|value| extent.add(*value));
    let (edges, unit) = edges(profile);
    let mut chart = Chart::in_steps(&edges, unit, Span::with_margin(extent, 0.08, "N"), HALF, 240.0);
    for ((class, out), (_, back)) in out.iter().zip(&back) {
        chart.line(&format!("trace back {class}"), steps(back));
        chart.line(&format!("trace {class}"), steps(out));
    }
    chart.into_svg(&format!("Mean residual in newtons over the {}, by direction", condition(profile.signal)))
}
