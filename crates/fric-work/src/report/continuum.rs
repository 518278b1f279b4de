//! Pages of `continuum`: calibration, friction at the holes, shapes to scale.

use fric_lab::discover::result::DiscoverResult;
use fric_lab::discover::words::percent;
use fric_lab::fit::result::Numbers;
use fric_tendon_lab::Run;
use fric_tendon_lab::comparison::{WayShapes, spread};
use fric_tendon_lab::discover::{Manipulator, TendonDiscovery, alternatives, rest_in_words, tried_in_words};
use fric_tendon_lab::identify::TendonFitResult;
use fric_tendon_lab::result::{CalibrationResult, FrictionResult, HoleResult, PickedShape, ShapeResult, WayShape};
use fric_tendon_lab::shape_errors::{ShapeErrors, Way};
use maud::{Markup, PreEscaped, html};

use super::chart::{Chart, Span};
use super::errors::COLORS;
use super::plot::{Axis, Plot, Plots, Trace, Values};
use super::series::Extent;
use super::{Page, number};
use crate::provenance::Provenance;
use crate::verdict::{self, Verdict};

/// Number of columns of a map.
const MAP_COLUMNS: usize = 240;
/// Number of shapes on a friction page.
const SHOWN_TIMES: usize = 6;

/// Returns the page of `continuum calibrate`.
#[must_use]
pub fn calibration(result: &CalibrationResult, provenance: &Provenance) -> String {
    let count = result.gratings.len();
    let most =
        result.gratings.iter().flat_map(|one| &one.residual_ratio).fold(0.01_f64, |most, one| most.max(one.abs()));
    let mut chart = Chart::new(
        holes(count, "grating"),
        Span { least: -110.0 * most, greatest: 110.0 * most, unit: "%" },
        960.0,
        260.0,
    );
    for (place, grating) in result.gratings.iter().enumerate() {
        let steps = grating.residual_ratio.len().max(1);
        for (step, ratio) in grating.residual_ratio.iter().enumerate() {
            let [from, to] = bar_edges(place, step, steps);
            chart.rectangle("bar history", [from, 0.0], [to, 100.0 * ratio]);
        }
    }
    let content = html! {
        p.soft { (result.load_n.len()) " loads" }
        (gratings(result))
        section { h2 { "Residuals in per cent of the greatest load, load by load" } (PreEscaped(chart.into_svg("Residuals of each grating in per cent of the greatest load"))) }
    };
    let title = format!("{}: calibration of the gratings", result.manipulator);
    plain(title, verdict::of_calibration(result), content, Plots::default(), provenance)
}

/// Returns the page of `continuum friction`.
#[must_use]
pub fn friction(result: &FrictionResult, provenance: &Provenance) -> String {
    let (series, mut plots) = (&result.series, Plots::default());
    let places = spread(series.time_s.len(), SHOWN_TIMES, |_| true);
    let shown = places.iter().filter_map(|place| Some((series.time_s.get(*place)?, series.friction_n.get(*place)?)));
    let content = html! {
        p.soft { (result.samples) " samples. Friction is positive where the base side is tighter." }
        (bridged(result.bridged.iter().map(|one| one.warning(result.samples))))
        (friction_by_hole(result))
        p { "Directions differ along the tendon in " (result.directions_differ_samples) " of " (result.samples) " samples." }
        section { h2 { "Friction over holes and time" } (map(result)) }
        section { (plots.figure(&friction_over_time(result), &series.time_s)) }
        h2 { "Friction at some times" }
        div.views {
            @for (time_s, friction_n) in shown {
                section {
                    h2 { (format!("{time_s:.2} s")) }
                    (PreEscaped(bars(&[("measured", friction_n.as_slice(), &[])], 470.0)))
                }
            }
        }
    };
    let title = format!("{}: friction at the holes", result.manipulator);
    plain(title, verdict::of_hole_frictions(result), content, plots, provenance)
}

/// Returns the page of `continuum shape`.
#[must_use]
pub fn shape(result: &ShapeResult, run: &Run, ways: &[WayShapes], provenance: &Provenance) -> String {
    let mut plots = Plots::default();
    let has_markers = result.ways.iter().any(|way| way.all.mean_mm.is_some());
    let content = html! {
        p.soft { (result.samples) " samples." }
        (bridged(result.bridged.iter().map(|one| one.warning(result.samples))))
        p { (keys(result.ways.iter().map(|way| way.way))) @if has_markers { (key("marker", "markers")) } }
        p.soft { "Dashed over the bars: the most that a hole holds by the model's μ; what is measured may be more." }
        (errors_by_way(result))
        @if has_markers {
            section { h2 { "Mean distance between disks and markers over time" } (errors(&mut plots, run, ways)) }
        }
        @for (place, shape) in result.shapes.iter().enumerate() {
            section {
                h2 { (format!("Shape {}: {:.2} s", place + 1, shape.time_s)) }
                p.soft {
                    @if shape.tension_base_n.is_finite() { (format!("{:.3} N at the base. ", shape.tension_base_n)) }
                    @for way in &shape.ways {
                        @if let (Some(max_mm), Some(mean_mm)) = (way.errors.max_mm, way.errors.mean_mm) {
                            (format!("{}: max {max_mm:.2}, mean {mean_mm:.2} mm. ", way.way))
                        }
                    }
                }
                div.views {
                    figure { (PreEscaped(drawn(shape))) }
                    @if shape.ways.iter().any(|way| way.way != Way::None.name()) {
                        figure { (PreEscaped(frictions(shape))) }
                    }
                }
            }
        }
    };
    let names: Vec<&str> = result.ways.iter().map(|way| way.way).collect();
    let by = if names.len() == Way::ALL.len() { "four ways of friction".to_owned() } else { names.join(", ") };
    let title = format!("{}: shapes by {by}", result.manipulator);
    plain(title, verdict::of_shapes(result), content, plots, provenance)
}

/// Returns the page of `discover` for a manipulator.
#[must_use]
pub fn discovery(found: &TendonDiscovery, provenance: &Provenance) -> String {
    let (result, mut plots) = (&found.result, Plots::default());
    let percent = |share: Option<f64>| share.map_or_else(|| "–".to_owned(), percent);
    let content = html! {
        @for tendon in &result.cables {
            p { "Verdict: " span class=(format!("verdict {}", tendon.verdict)) { (tendon.verdict) } }
            dl {
                dt { "samples" } dd { (tendon.samples) }
                dt { "noise" } dd { (number(tendon.noise_floor_n)) " N" }
                @if let (Some(before), Some(after)) = (tendon.before, tendon.after) {
                    dt { "rms before, held out" } dd { (format!("{:.4} N", before.rms_n)) }
                    dt { "rms after" } dd { (format!("{:.4} N", after.rms_n)) }
                }
                dt { "gap closed" } dd { (percent(tendon.gap_closed)) }
                @if let Some(markers) = tendon.markers {
                    dt { "off the markers, rms" } dd { (format!("{:.2} mm", markers.after.rms_mm)) }
                    dt { "noise of that" } dd { (format!("{:.2} mm", markers.noise_mm)) }
                }
            }
            @for effect in &tendon.effects {
                h3 { (effect.kind) }
                p {
                    @for (name, value) in &effect.parameters.0 { (name) " = " (fric_lab::text::significant(*value)) ". " }
                    (effect.effect.join(" "))
                }
                @if !effect.alike.is_empty() { p.soft { "Or " (alternatives(effect)) } }
            }
            @for tried in &tendon.tried { p.soft { "Not named: " (tried_in_words(tried)) } }
            @if let Some(kept) = &tendon.kept { p.soft { "Kept: " (kept) } }
            @if let Some(rest) = &tendon.unexplained { p.unexplained { (rest_in_words(rest)) } }
        }
        h2 { "Gratings less model over time" }
        @for plot in residuals(found) { (plots.figure(&plot, &found.time_s)) }
    };
    let title = format!("{}: what the model lacks", result.robot);
    plain(title, verdict::of_tendon(result), content, plots, provenance)
}

/// Returns the lines of the gratings as a table.
#[must_use]
pub fn calibration_table(result: &CalibrationResult) -> String {
    gratings(result).into_string()
}

/// Returns the friction at the holes as a table.
#[must_use]
pub fn friction_table(result: &FrictionResult) -> String {
    friction_by_hole(result).into_string()
}

/// Returns the errors of the friction models as a table.
#[must_use]
pub fn shape_table(result: &ShapeResult) -> String {
    errors_by_way(result).into_string()
}

/// Returns the findings as a table.
#[must_use]
pub fn discovery_table(result: &DiscoverResult<Manipulator>) -> String {
    html! {
        table {
            tr { th.words { "verdict" } th.words { "found" } th { "noise [N]" } th { "rms before [N]" } th { "after [N]" } }
            @for tendon in &result.cables {
                tr {
                    td.words { (tendon.verdict) }
                    td.words { (tendon.effects.iter().map(|effect| effect.kind).collect::<Vec<_>>().join(", ")) }
                    td { (number(tendon.noise_floor_n)) }
                    td { (number(tendon.before.map(|error| error.rms_n))) } td { (number(tendon.after.map(|error| error.rms_n))) }
                }
            }
        }
    }
    .into_string()
}

/// Returns the page of a single hole.
#[must_use]
pub fn hole(result: &HoleResult, provenance: &Provenance) -> String {
    let verdict = verdict::of_hole(result);
    plain("Friction of a hole".to_owned(), verdict, coefficient(result), Plots::default(), provenance)
}

/// Returns the hole's coefficient as a table.
#[must_use]
pub fn hole_table(result: &HoleResult) -> String {
    coefficient(result).into_string()
}

fn coefficient(result: &HoleResult) -> Markup {
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

/// Returns the page of `continuum fit`.
#[must_use]
pub fn fit(result: &TendonFitResult, provenance: &Provenance) -> String {
    let title = format!("{}: identification", result.manipulator);
    plain(title, verdict::of_tendon_fit(result), identified(result), Plots::default(), provenance)
}

/// Returns the fitted values as a table.
#[must_use]
pub fn fit_table(result: &TendonFitResult) -> String {
    identified(result).into_string()
}

fn identified(result: &TendonFitResult) -> Markup {
    let of = |numbers: &Numbers, key: &str| number(numbers.get(key));
    html! {
        table {
            tr { th { "" } th { "given" } th { "found" } th { "±" } }
            @for (key, value) in &result.parameters.0 {
                tr { td { (key) } td { (of(&result.given, key)) } td { (number(Some(*value))) } td { (of(&result.standard_errors, key)) } }
            }
        }
        @for open in &result.undetermined { p { (open.sentence) "." } }
    }
}

/// Returns the lines of the gratings.
fn gratings(result: &CalibrationResult) -> Markup {
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
fn friction_by_hole(result: &FrictionResult) -> Markup {
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
fn errors_by_way(result: &ShapeResult) -> Markup {
    html! {
        table {
            tr { th { "way" } th { "max, shown [mm]" } th { "mean [mm]" } th { "max, all [mm]" } th { "mean [mm]" } th { "missing" } }
            @for way in &result.ways {
                tr {
                    td { (way.way) }
                    td { (millimetres(way.picked.max_mm)) } td { (millimetres(way.picked.mean_mm)) }
                    td { (millimetres(way.all.max_mm)) } td { (millimetres(way.all.mean_mm)) } td { (way.missing) }
                }
            }
        }
    }
}

/// Returns a page without cables to switch off.
fn plain(title: String, verdict: Verdict, content: Markup, plots: Plots, provenance: &Provenance) -> String {
    Page { title, verdict, content, plots, cables: Vec::new(), provenance }.into_html()
}

/// Returns the residuals of each segment before and after, on one scale.
fn residuals(found: &TendonDiscovery) -> Vec<Plot> {
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
fn friction_over_time(result: &FrictionResult) -> Plot {
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
fn map(result: &FrictionResult) -> Markup {
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

fn newtons(value: f64) -> String {
    if value.is_finite() { format!("{value:.4}") } else { "–".to_owned() }
}

fn millimetres(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

fn bridged(warnings: impl Iterator<Item = String>) -> Markup {
    html! { @for warning in warnings { p.unexplained { (warning) } } }
}

fn key(class: &str, name: &str) -> Markup {
    html! { span.keys { span.key style=(format!("background: var(--{class})")) {} (name) } " " }
}

fn keys<'a>(names: impl Iterator<Item = &'a str>) -> Markup {
    html! { @for name in names { (key(name, name)) } }
}

/// Returns an axis of holes or gratings, 1 to count.
fn holes(count: usize, unit: &'static str) -> Span {
    Span { least: 0.4, greatest: count_as_number(count) + 0.6, unit }
}

fn count_as_number(count: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let number = count as f64;
    number
}

/// Returns the edges of one of `count` adjacent bars at a position of an axis.
fn bar_edges(place: usize, bar: usize, count: usize) -> [f64; 2] {
    let width = 0.8 / count_as_number(count);
    let from = count_as_number(place) + 0.6 + width * count_as_number(bar);
    [from, from + 0.9 * width]
}

/// Draws the friction at each hole as signed adjacent bars, with the greatest friction of the hole as a line on both sides.
fn bars(ways: &[(&'static str, &[f64], &[f64])], width: f64) -> String {
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

fn frictions(shape: &PickedShape) -> String {
    let with_friction = shape.ways.iter().filter(|way| way.way != Way::None.name());
    let ways: Vec<(&'static str, &[f64], &[f64])> = with_friction
        .map(|WayShape { way, friction_n, bound_n, .. }| {
            let bound_n: &[f64] = if *way == Way::History.name() { bound_n } else { &[] };
            (*way, friction_n.as_slice(), bound_n)
        })
        .collect();
    bars(&ways, 470.0)
}

/// Draws a shape to scale, x along the straight manipulator.
fn drawn(shape: &PickedShape) -> String {
    let finite = |places: &[[f64; 2]]| {
        places.iter().filter(|place| place.iter().all(|one| one.is_finite())).copied().collect::<Vec<_>>()
    };
    let mut extents = [Extent::NOTHING; 2];
    let lines: Vec<(&str, Vec<[f64; 2]>)> = shape
        .ways
        .iter()
        .map(|way| (way.way, std::iter::once([0.0; 2]).chain(way.disk_position_m.iter().copied()).collect()))
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
fn errors(plots: &mut Plots, run: &Run, ways: &[WayShapes]) -> Markup {
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
