//! Plots and drawings of the pages: residuals, friction over time and at the holes, shapes to scale.

use fric_tendon_lab::Run;
use fric_tendon_lab::comparison::WayShapes;
use fric_tendon_lab::discover::TendonDiscovery;
use fric_tendon_lab::result::{FrictionResult, PickedShape, WayShape};
use fric_tendon_lab::shape_errors::{ShapeErrors, Way};
use maud::{Markup, PreEscaped, html};

use crate::report::chart::{Chart, Span};
use crate::report::errors::COLORS;
use crate::report::plot::{Axis, Plot, Plots, Trace, Values};
use crate::report::series::Extent;

/// Number of columns of a map.
const MAP_COLUMNS: usize = 240;

/// Returns the residuals of each segment before and after, on one scale.
pub(super) fn residuals(found: &TendonDiscovery) -> Vec<Plot> {
    let of = |rows: &[Vec<f64>], segment: usize| {
        Values::Line(rows.iter().map(|row| row.get(segment).copied().unwrap_or(f64::NAN)).collect())
    };
    let plot = |segment: usize| {
        let mut plot = Plot::new(format!("Grating {}", segment + 1), Axis::TIME, Axis::new("residual", "N"));
        plot.size[1] = 160.0;
        plot.traces = vec![
            Trace::new("before: given model, fitted", "before", of(&found.residual_before_n, segment)),
            Trace::new("after: extended model", "after", of(&found.residual_after_n, segment)),
        ];
        plot
    };
    let mut plots: Vec<Plot> = (0..found.residual_before_n.first().map_or(0, Vec::len)).map(plot).collect();
    let mut all = Extent { least: 0.0, greatest: 0.0 };
    for plot in &plots {
        all.merge(plot.extent());
    }
    for plot in &mut plots {
        plot.span = Some(all);
    }
    plots
}

/// Returns the friction of each hole over time as lines.
pub(super) fn friction_over_time(result: &FrictionResult) -> Plot {
    let mut plot = Plot::new("Friction of each hole", Axis::TIME, Axis::new("friction", "N"));
    let holes = result.series.friction_n.iter().map(Vec::len).max().unwrap_or(0);
    for hole in 0..holes {
        let values = result.series.friction_n.iter().map(|row| row.get(hole).copied().unwrap_or(f64::NAN)).collect();
        let trace = Trace::new(&format!("hole {}", hole + 1), COLORS[hole % COLORS.len()], Values::Line(values));
        plot.traces.push(Trace { is_dashed: hole >= COLORS.len(), ..trace });
    }
    plot.size[1] = 280.0;
    plot
}

/// Returns the friction over holes and time as a map: color by sign, strength by magnitude.
pub(super) fn map(result: &FrictionResult) -> Markup {
    let series = &result.series;
    let holes = series.friction_n.iter().map(Vec::len).max().unwrap_or(0);
    let greatest = series
        .friction_n
        .iter()
        .flatten()
        .filter(|value| value.is_finite())
        .fold(0.0_f64, |most, one| most.max(one.abs()));
    let (Some(first), Some(last)) = (series.time_s.first(), series.time_s.last()) else { return html! {} };
    if holes == 0 || greatest <= 0.0 || last <= first {
        return html! {};
    }
    let names: Vec<String> = (1..=holes).map(|hole| format!("hole {hole}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let time = Span { least: *first, greatest: *last, unit: "s" };
    let mut chart = Chart::in_rows(time, &names, 960.0);
    let per_cell = series.time_s.len().div_ceil(MAP_COLUMNS).max(1);
    for (column, rows) in series.friction_n.chunks(per_cell).enumerate() {
        let start = column * per_cell;
        let from_s = series.time_s[start];
        let to_s = series.time_s.get(start + per_cell).copied().unwrap_or(*last);
        for hole in 0..holes {
            let values: Vec<f64> =
                rows.iter().filter_map(|row| row.get(hole)).copied().filter(|value| value.is_finite()).collect();
            if values.is_empty() {
                continue;
            }
            let mean = values.iter().sum::<f64>() / count_as_number(values.len());
            chart.cell(if mean < 0.0 { "negative" } else { "positive" }, hole, [from_s, to_s], mean.abs() / greatest);
        }
    }
    let label = "Friction of each hole over time; the lines below have the numbers";
    html! {
        p.legend {
            (key("after", "positive: the base side is tighter")) (key("before", "negative"))
            span.keys { (format!("full color: {greatest:.4} N, linear")) }
        }
        (PreEscaped(chart.into_svg(label)))
    }
}

pub(super) fn key(class: &str, name: &str) -> Markup {
    html! { span.keys { span.key style=(format!("background: var(--{class})")) {} (name) } " " }
}

pub(super) fn keys<'a>(names: impl Iterator<Item = &'a str>) -> Markup {
    html! { @for name in names { (key(name, name)) } }
}

/// Returns an axis of holes or gratings, 1 to count.
pub(super) fn holes(count: usize, unit: &'static str) -> Span {
    Span { least: 0.4, greatest: count_as_number(count) + 0.6, unit }
}

fn count_as_number(count: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let number = count as f64;
    number
}

/// Returns the edges of one of `count` adjacent bars at a position of an axis.
pub(super) fn bar_edges(place: usize, bar: usize, count: usize) -> [f64; 2] {
    let width = 0.8 / count_as_number(count);
    let from = count_as_number(place) + 0.6 + width * count_as_number(bar);
    [from, from + 0.9 * width]
}

/// Draws the friction at each hole as signed adjacent bars, with the greatest friction of the hole as a line on both sides.
pub(super) fn bars(ways: &[(&'static str, &[f64], &[f64])], width: f64) -> String {
    let mut extent = Extent::NOTHING;
    extent.add(0.0);
    for (_, friction_n, bound_n) in ways {
        friction_n.iter().for_each(|value| extent.add(*value));
        for bound_n in *bound_n {
            extent.add(*bound_n);
            extent.add(-bound_n);
        }
    }
    let count = ways.iter().map(|(_, friction_n, _)| friction_n.len()).max().unwrap_or(0);
    let mut chart = Chart::new(holes(count, "hole"), Span::with_margin(extent, 0.08, "N"), width, 240.0);
    for (bar, (way, friction_n, bound_n)) in ways.iter().enumerate() {
        for (place, friction_n) in friction_n.iter().enumerate().filter(|(_, value)| value.is_finite()) {
            let [from, to] = bar_edges(place, bar, ways.len());
            chart.rectangle(&format!("bar {way}"), [from, 0.0], [to, *friction_n]);
        }
        for (place, bound_n) in bound_n.iter().enumerate() {
            let [from, to] = [count_as_number(place) + 0.6, count_as_number(place) + 1.4];
            for side_n in [*bound_n, -bound_n] {
                chart.line("bound", [[from, side_n], [to, side_n]].into_iter());
            }
        }
    }
    chart.into_svg("Friction in newtons at each hole, with what the hole can hold")
}

pub(super) fn frictions(shape: &PickedShape) -> String {
    let with_friction = shape.ways.iter().filter(|way| way.way != Way::None);
    let ways: Vec<(&'static str, &[f64], &[f64])> = with_friction
        .map(|WayShape { way, friction_n, bound_n, .. }| {
            let bound_n: &[f64] = if *way == Way::History { bound_n } else { &[] };
            (way.name(), friction_n.as_slice(), bound_n)
        })
        .collect();
    bars(&ways, 470.0)
}

/// Draws a shape to scale, x along the straight manipulator.
pub(super) fn drawn(shape: &PickedShape) -> String {
    let finite = |places: &[[f64; 2]]| {
        places.iter().filter(|place| place.iter().all(|one| one.is_finite())).copied().collect::<Vec<_>>()
    };
    let mut extents = [Extent::NOTHING; 2];
    let lines: Vec<(&str, Vec<[f64; 2]>)> = shape
        .ways
        .iter()
        .map(|way| (way.way.name(), std::iter::once([0.0; 2]).chain(way.disk_position_m.iter().copied()).collect()))
        .collect();
    let markers = finite(&shape.marker_m);
    for [x, y] in lines.iter().flat_map(|(_, places)| places).chain(&markers) {
        extents[0].add(*x);
        extents[1].add(*y);
    }
    let [x, y] = extents.map(|extent| Span::with_margin(extent, 0.08, "m"));
    let mut chart = Chart::to_scale(x, y, 470.0, 420.0);
    for (way, places) in lines {
        chart.line(&format!("trace {way}"), places.into_iter());
    }
    for marker in markers {
        chart.dot("marker", marker, "");
    }
    chart.into_svg("Shape of the manipulator in metres, to scale")
}

/// Plots the mean distance of each friction model over time.
pub(super) fn errors(plots: &mut Plots, run: &Run, ways: &[WayShapes]) -> Markup {
    let samples = run.samples();
    let mut plot = Plot::new("Mean distance", Axis::TIME, Axis::new("distance", "mm"));
    plot.digits = 2;
    for way in ways {
        let mean_mm = |(sample, shape): (&fric_tendon_lab::RunSample, _)| {
            ShapeErrors::of(shape, &sample.marker_m).mean_mm().unwrap_or(f64::NAN)
        };
        let values = samples.iter().zip(&way.shapes).map(mean_mm).collect();
        plot.traces.push(Trace::new(way.way.name(), way.way.name(), Values::Line(values)));
    }
    let times_s: Vec<f64> = samples.iter().map(|sample| sample.time_s).collect();
    plots.figure(&plot, &times_s)
}
