//! Pages of `continuum`: calibration, friction at the holes, shapes to scale.

mod drawings;
mod tables;

use fric_lab::discover::result::DiscoverResult;
use fric_lab::words::percent;
use fric_tendon_lab::Run;
use fric_tendon_lab::comparison::{WayShapes, spread};
use fric_tendon_lab::discover::{Manipulator, TendonDiscovery, alternatives, rest_in_words, tried_in_words};
use fric_tendon_lab::identify::TendonFitResult;
use fric_tendon_lab::result::{CalibrationResult, FrictionResult, HoleResult, ShapeResult};
use fric_tendon_lab::shape_errors::Way;
use maud::{Markup, PreEscaped, html};

use self::drawings::{bar_edges, bars, drawn, errors, friction_over_time, frictions, holes, key, keys, map, residuals};
use self::tables::{coefficient, errors_by_way, friction_by_hole, gratings, identified};
use crate::provenance::Provenance;
use crate::report::chart::{Chart, Span};
use crate::report::plot::Plots;
use crate::report::{Page, number};
use crate::verdict::{self, Verdict};

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
        (warnings(&result.grating_warnings()))
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
        (warnings(&result.grating_warnings()))
        p { (keys(result.ways.iter().map(|way| way.way.name()))) @if has_markers { (key("marker", "markers")) } }
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
                            (format!("{}: max {max_mm:.2}, mean {mean_mm:.2} mm. ", way.way.name()))
                        }
                    }
                }
                div.views {
                    figure { (PreEscaped(drawn(shape))) }
                    @if shape.ways.iter().any(|way| way.way != Way::None) {
                        figure { (PreEscaped(frictions(shape))) }
                    }
                }
            }
        }
    };
    let names: Vec<&str> = result.ways.iter().map(|way| way.way.name()).collect();
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
            p { "Verdict: " span class=(format!("verdict {}", tendon.verdict.name())) { (tendon.verdict.name()) } }
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
            @for tried in tried_in_words(&tendon.tried) { p.soft { "Not named: " (tried) } }
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
                    td.words { (tendon.verdict.name()) }
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

/// Returns a page without cables to switch off.
fn plain(title: String, verdict: Verdict, content: Markup, plots: Plots, provenance: &Provenance) -> String {
    Page { title, verdict, content, plots, cables: Vec::new(), source: provenance.logs(), provenance }.into_html()
}

fn warnings(sentences: &[String]) -> Markup {
    html! { @for warning in sentences { p.unexplained { (warning) } } }
}
