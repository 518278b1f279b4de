//! The page of `excite --preview`: path, speed and cable forces of the run, and what it is expected to answer.

use fric_core::robot::file::RobotFile;
use fric_lab::excite::Excitation;
use fric_lab::trajectory::{Phase, WorkBox};
use maud::{Markup, PreEscaped, html};

use super::Page;
use super::chart::{Chart, Span};
use super::plot::Plots;
use super::run::{RunInterval, RunSeries};
use super::series::Extent;
use crate::excite::describe;
use crate::provenance::Provenance;
use crate::verdict::{Tone, Verdict};

fn in_words(phase: Phase) -> String {
    phase.name().replace('_', " ")
}

fn draw_phases(series: &RunSeries, chart: &mut Chart) {
    for (place, phase) in series.phases().iter().enumerate() {
        let class = if place % 2 == 0 { "even" } else { "odd" };
        chart.stretch(class, phase.start_s, phase.end_s, &in_words(phase.phase));
    }
}

fn time(series: &RunSeries) -> Span {
    Span { least: 0.0, greatest: series.end_s().max(1e-9), unit: "s" }
}

/// Returns a quantity over time.
fn over_time(series: &RunSeries, pick: fn(&RunInterval) -> Extent) -> impl Iterator<Item = (f64, Extent)> {
    series.intervals().iter().map(move |interval| (interval.start_s, pick(interval)))
}

/// What a designed run is for.
#[derive(Debug)]
pub struct Purpose {
    /// What it is expected to tell, one line each.
    pub expectations: Vec<String>,
    /// The command that its log is for.
    pub command: &'static str,
}

/// Returns the page; `purpose` is `None` for the identification run.
#[must_use]
pub fn page(
    robot: &RobotFile,
    excitation: &Excitation,
    series: &RunSeries,
    purpose: Option<&Purpose>,
    provenance: &Provenance,
) -> String {
    let kind = if purpose.is_some() { "designed run" } else { "identification run" };
    let title = format!("{}: {kind}", robot.options().name);
    let content = html! {
        @if let Some(purpose) = purpose {
            section {
                h2 { "What the run is expected to tell" }
                ul { @for line in &purpose.expectations { li { (line) } } }
            }
        }
        @if let Some(work_box) = excitation.work_box() { (views(robot, excitation, work_box)) }
        @if excitation.work_box().is_none() {
            section { h2 { "Length of the cables" } (PreEscaped(length(series))) }
        }
        section {
            h2 { @if excitation.work_box().is_some() { "Speed of the platform" } @else { "Speed of the cables, without its sign" } }
            (PreEscaped(speed(series)))
        }
        @if let Some(tension_n) = series.tension_n() {
            section {
                h2 { "Cable forces at the platform" }
                p {
                    "Over all cables:"
                    span.keys { span.key style="background: var(--before)" {} "greatest" }
                    " "
                    span.keys { span.key style="background: var(--after)" {} "least" }
                    " "
                    span.keys { span.key style="background: var(--flag)" {} "bounds" }
                }
                (PreEscaped(tension(excitation, series, tension_n)))
            }
        }
        (phases(series))
    };
    let sentence = format!("{}, one set point every {} s.", describe(excitation, series), robot.options().cycle_s);
    let command = purpose.map_or("fit", |purpose| purpose.command);
    let todo = vec![format!("Look whether the path is free, then run it and record a log for fric-cli {command}.")];
    let verdict = Verdict { tone: Tone::Mixed, sentence, todo };
    Page {
        title,
        verdict,
        content,
        plots: Plots::default(),
        cables: Vec::new(),
        source: provenance.model(),
        provenance,
    }
    .into_html()
}

/// Returns plan view and side view.
fn views(robot: &RobotFile, excitation: &Excitation, work_box: &WorkBox) -> Markup {
    html! {
        p {
            span.keys { span.key style="background: var(--after)" {} "path of the platform" }
            " "
            span.keys { span.key style="background: var(--soft)" {} "box" }
            " "
            span.keys { span.key style="background: var(--before)" {} "where the cables enter their last pulleys" }
        }
        div.views {
            section { h2 { "Plan view: x and y" } (PreEscaped(view(robot, excitation, work_box, 1))) }
            section { h2 { "Side view: x and z" } (PreEscaped(view(robot, excitation, work_box, 2))) }
        }
    }
}

/// Draws a view with x to the right and another base axis upwards, to scale.
fn view(robot: &RobotFile, excitation: &Excitation, work_box: &WorkBox, up: usize) -> String {
    let flat = |place_m: [f64; 3]| [place_m[0], place_m[up]];
    // Base points that coincide in this view share a dot.
    let mut bases: Vec<([f64; 2], Vec<&str>)> = Vec::new();
    for cable in &robot.options().cable {
        let Some(base_m) = cable.base_m else { continue };
        let place = flat(base_m);
        let near = |other: &[f64; 2]| (other[0] - place[0]).hypot(other[1] - place[1]) < 1e-3;
        match bases.iter_mut().find(|(other, _)| near(other)) {
            Some((_, names)) => names.push(&cable.name),
            None => bases.push((place, vec![&cable.name])),
        }
    }
    let [from, to] = [work_box.center_m - work_box.half_edges_m, work_box.center_m + work_box.half_edges_m]
        .map(|corner_m| flat(corner_m.into()));
    let mut extents = [Extent::NOTHING; 2];
    for [x, y] in bases.iter().map(|(place, _)| *place).chain([from, to]) {
        extents[0].add(x);
        extents[1].add(y);
    }
    let [x, y] = extents.map(|extent| Span::with_margin(extent, 0.12, "m"));
    let mut chart = Chart::to_scale(x, y, 470.0, 520.0);
    let legs = excitation.trajectory().legs();
    let start = legs.first().map(|leg| leg.from_m).into_iter();
    chart.line("path", start.chain(legs.iter().map(|leg| leg.to_m)).map(|place_m| flat(place_m.into())));
    chart.rectangle("box", from, to);
    for (place, names) in bases {
        chart.dot("base", place, &names.join(", "));
    }
    chart.into_svg("Path of the platform and where the cables enter their last pulleys, to scale")
}

fn length(series: &RunSeries) -> String {
    let mut shown_m = Extent::NOTHING;
    for (_, length_m) in over_time(series, |interval| interval.length_m) {
        shown_m.merge(length_m);
    }
    let mut chart = Chart::new(time(series), Span::with_margin(shown_m, 0.15, "m"), 960.0, 220.0);
    draw_phases(series, &mut chart);
    chart.bars("least", over_time(series, |interval| interval.length_m));
    chart.into_svg("Length of the cables in metres over time")
}

fn speed(series: &RunSeries) -> String {
    let mut greatest = series.speed();
    // Space for the names of the phases.
    greatest.greatest *= 1.15;
    let mut chart = Chart::new(time(series), Span::with_margin(greatest, 0.02, "m/s"), 960.0, 220.0);
    draw_phases(series, &mut chart);
    chart.bars("least", over_time(series, |interval| interval.speed));
    chart.into_svg("Speed in metres per second over time")
}

fn tension(excitation: &Excitation, series: &RunSeries, mut shown_n: Extent) -> String {
    let (least_n, greatest_n) = excitation.tension_bounds_n().unwrap_or_default();
    shown_n.add(0.0);
    if let Some(greatest_n) = greatest_n {
        shown_n.add(greatest_n);
    }
    shown_n.greatest *= 1.12;
    let mut chart = Chart::new(time(series), Span::with_margin(shown_n, 0.02, "N"), 960.0, 260.0);
    draw_phases(series, &mut chart);
    chart.bars("greatest", over_time(series, |interval| interval.greatest_n));
    chart.bars("least", over_time(series, |interval| interval.least_n));
    chart.level("bound", least_n, &format!("{least_n:.2} N"), false);
    if let Some(greatest_n) = greatest_n {
        chart.level("bound", greatest_n, &format!("{greatest_n:.2} N"), true);
    }
    chart.into_svg("Least and greatest cable force in newtons over time")
}

fn phases(series: &RunSeries) -> Markup {
    html! {
        section {
            h2 { "Phases" }
            table {
                tr {
                    th { "phase" } th { "from [s]" } th { "to [s]" } th { "greatest speed [m/s]" }
                    @if series.tension_n().is_some() { th { "least force [N]" } th { "greatest force [N]" } }
                }
                @for phase in series.phases() {
                    tr {
                        td { (in_words(phase.phase)) }
                        td { (format!("{:.1}", phase.start_s)) } td { (format!("{:.1}", phase.end_s)) }
                        td { (format!("{:.3}", phase.fastest)) }
                        @if phase.tension_n.is_something() {
                            td { (format!("{:.2}", phase.tension_n.least)) }
                            td { (format!("{:.2}", phase.tension_n.greatest)) }
                        }
                    }
                }
            }
        }
    }
}
