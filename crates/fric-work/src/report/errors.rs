//! The page of `replay --report`: errors as tables and over time, friction over its conditions, forces and wrench.

use fric_lab::errors::{WrenchError, WrenchResult};
use fric_lab::text::duration;
use fric_lab::words::Times;
use maud::{Markup, html};

use super::friction::{CableFriction, Friction};
use super::plot::{Axis, Plot, Plots, Trace, Values};
use super::series::{Channel, Extent, Series};
use super::{Page, number};
use crate::provenance::Provenance;
use crate::replay::ReplayResult;
use crate::verdict::{counted, left_in_words};

/// Colors of cables in a common plot; later ones are dashed.
pub(super) const COLORS: [&str; 8] = ["c0", "c1", "c2", "c3", "c4", "c5", "c6", "c7"];
/// Components of the wrench.
const COMPONENTS: [&str; 6] = ["x", "y", "z", "about x", "about y", "about z"];

/// Returns the page.
#[must_use]
pub fn page(result: &ReplayResult, series: &Series, provenance: &Provenance) -> String {
    let mut plots = Plots::default();
    let names: Vec<&str> = result.cables.iter().map(|cable| cable.name.as_str()).collect();
    let deviations = deviations(series, names.len());
    let content = html! {
        (cables(result))
        p.soft { "rms and mean |error| of the force at the platform against the reference; left: rms after as a share of rms before." }
        @for cable in result.cables.iter().filter(|cable| !cable.faults.is_empty()) {
            h3 { "Faults of the recording of " (cable.name) }
            ul { @for fault in &cable.faults { li { (fault.in_words(&Times::default())) } } }
        }
        @if let Some(wrench) = &result.wrench { (wrench_table(wrench)) }
        p.soft {
            (counted(result.cycle.count, "cycle")) "; one takes " (duration(result.cycle.median_ns)) " (median), "
            (duration(result.cycle.p999_ns)) " (99.9 %), " (duration(result.cycle.max_ns)) " (longest)."
        }
        @for (index, (cable, deviation)) in result.cables.iter().zip(deviations).enumerate() {
            section data-cable=(index) {
                h2 { (cable.name) }
                @match deviation {
                    Some(plot) => (plots.figure(&plot, series.starts_s())),
                    None => p.soft { "The log has no reference for this cable." },
                }
                @if let Some(friction) = series.friction(index) { (frictions(&mut plots, friction)) }
            }
        }
        (forces(&mut plots, series, &names))
        (wrench(&mut plots, series))
    };
    let title = format!("{}: replay, forces at the platform", result.robot);
    Page { title, verdict: result.verdict(), content, plots, cables: names, source: provenance.logs(), provenance }
        .into_html()
}

/// Returns the errors as a table.
#[must_use]
pub fn table(result: &ReplayResult) -> String {
    cables(result).into_string()
}

fn cables(result: &ReplayResult) -> Markup {
    html! {
        table {
            thead {
                tr {
                    th scope="col" { "cable" } th scope="col" { "samples" } th scope="col" { "flagged" }
                    th scope="col" { "rms before [N]" } th scope="col" { "after [N]" } th scope="col" { "left" }
                    th scope="col" { "mean |error| before [N]" } th scope="col" { "after [N]" }
                }
            }
            tbody {
                @for cable in &result.cables {
                    tr {
                        th scope="row" { (cable.name) } td { (cable.samples) } td { (cable.flagged) }
                        td { (number(cable.before.as_ref().map(|error| error.rms_n))) }
                        td { (number(cable.after.as_ref().map(|error| error.rms_n))) }
                        td { (cable.left().map_or_else(|| "–".to_owned(), left_in_words)) }
                        td { (number(cable.before.as_ref().map(|error| error.mae_n))) }
                        td { (number(cable.after.as_ref().map(|error| error.mae_n))) }
                    }
                }
            }
        }
    }
}

pub(super) fn wrench_table(wrench: &WrenchResult) -> Markup {
    let WrenchResult { before, after, held_out, .. } = wrench;
    let rows = [
        ("force", "N", (|error| error.force_rms_n) as fn(&WrenchError) -> f64),
        ("torque", "Nm", |error| error.torque_rms_nm),
    ];
    html! {
        table {
            thead {
                tr {
                    th scope="col" { (wrench.title()) } th scope="col" { "rms before" } th scope="col" { "after" } th scope="col" { "left" }
                    @if held_out.is_some() { th scope="col" { "held out" } }
                }
            }
            tbody {
                @for (name, unit, pick) in rows {
                    tr {
                        th scope="row" { (name) }
                        td { (format!("{:.4} {unit}", pick(before))) } td { (format!("{:.4} {unit}", pick(after))) }
                        td { (left_in_words(pick(after) / pick(before))) }
                        @if let Some(held_out) = held_out { td { (format!("{:.4} {unit}", pick(held_out))) } }
                    }
                }
            }
        }
    }
}

fn band(series: &Series, channel: Channel, name: &str, color: &'static str) -> Option<Trace> {
    series.band(channel).map(|(least, greatest)| Trace::new(name, color, Values::Band(least, greatest)))
}

/// Gives plots for comparison a common scale, around zero.
fn share_scale(plots: &mut [Option<Plot>]) {
    let mut all = Extent { least: 0.0, greatest: 0.0 };
    plots.iter().flatten().for_each(|plot| all.merge(plot.extent()));
    plots.iter_mut().flatten().for_each(|plot| plot.span = Some(all));
}

/// Plots the deviations of the cables before and after compensation; `None` if there are none.
fn deviations(series: &Series, count: usize) -> Vec<Option<Plot>> {
    let of_cable = |cable: usize| {
        let before = band(series, Channel::Before(cable), "before: uncompensated", "before")?;
        let after = band(series, Channel::After(cable), "after: compensated", "after");
        let mut plot = Plot::new("Error of the force at the platform", Axis::TIME, Axis::new("error", "N"));
        plot.traces = std::iter::once(before).chain(after).collect();
        plot.looks = series.flagged_s(cable).to_vec();
        plot.looks_name = "flagged samples";
        Some(plot)
    };
    let mut plots: Vec<Option<Plot>> = (0..count).map(of_cable).collect();
    share_scale(&mut plots);
    plots
}

/// Plots friction over speed, and over the length in both directions, before and after.
fn frictions(plots: &mut Plots, friction: &CableFriction) -> Markup {
    let speeds: Vec<(f64, &Friction)> = friction.over_speed.filled().collect();
    let at: Vec<f64> = speeds.iter().map(|(speed, _)| 1e3 * speed).collect();
    let pick = |pick: fn(&Friction) -> f64| -> Vec<f64> { speeds.iter().map(|(_, bin)| pick(bin)).collect() };
    let mut over_speed =
        Plot::new("Friction over speed, positive paying out", Axis::new("speed", "mm/s"), Axis::new("friction", "N"))
            .half();
    let spread = Values::Spread(pick(|bin| bin.measured.mean()), pick(|bin| bin.measured.deviation()));
    if speeds.iter().any(|(_, bin)| bin.measured.mean().is_finite()) {
        over_speed.traces.push(Trace::new("measured ± standard deviation", "text", spread));
    }
    over_speed
        .traces
        .push(Trace { role: "model", ..Trace::new("model", "after", Values::Line(pick(|bin| bin.model.mean()))) });
    let [back, out] = friction.over_length.each_ref().map(|binned| binned.filled().collect::<Vec<_>>());
    let mut lengths: Vec<f64> = back.iter().chain(&out).map(|(at, _)| *at).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.dedup();
    let mut loops = Plot::new(
        "Hysteresis over the cable length",
        Axis::new("length since start", "mm"),
        Axis::new("friction", "N"),
    )
    .half();
    for (name, color, pick) in [
        ("before", "before", (|bin| bin.measured.mean()) as fn(&Friction) -> f64),
        ("after", "after", |bin| bin.left.mean()),
    ] {
        for (bins, direction, is_dashed) in [(&out, "paying out", false), (&back, "reeling in", true)] {
            let value = |at: &f64| {
                bins.iter().find(|(other, _)| other.total_cmp(at).is_eq()).map_or(f64::NAN, |(_, bin)| pick(bin))
            };
            let values: Vec<f64> = lengths.iter().map(value).collect();
            if values.iter().any(|value| value.is_finite()) {
                let trace = Trace::new(&format!("{name}, {direction}"), color, Values::Line(values));
                loops.traces.push(Trace { is_dashed, ..trace });
            }
        }
    }
    let millimetres: Vec<f64> = lengths.iter().map(|length_m| 1e3 * length_m).collect();
    html! {
        div.views {
            @if at.len() > 1 { (plots.figure(&over_speed, &at)) }
            @if lengths.len() > 1 && !loops.traces.is_empty() { (plots.figure(&loops, &millimetres)) }
        }
        @if at.len() > 1 {
            p.soft {
                "Means over samples without a flag. Measured friction is the reference less the force without friction, negative where the \
                 platform feels less than the sensor; after: what the model leaves of it."
            }
        }
    }
}

/// Plots the compensated force of every cable.
fn forces(plots: &mut Plots, series: &Series, names: &[&str]) -> Markup {
    let mut plot = Plot::new("Compensated force of every cable at the platform", Axis::TIME, Axis::new("force", "N"));
    for (cable, name) in names.iter().enumerate() {
        let color = COLORS[cable % COLORS.len()];
        let trace = band(series, Channel::Force(cable), name, color);
        plot.traces.extend(trace.map(|trace| Trace { cable: Some(cable), is_dashed: cable >= COLORS.len(), ..trace }));
    }
    plot.size[1] = 280.0;
    html! {
        @if !plot.traces.is_empty() {
            section { h2 { "Cable forces" } (plots.figure(&plot, series.starts_s())) }
        }
    }
}

/// Plots the wrench over time, with one scale for forces and another for torques.
fn wrench(plots: &mut Plots, series: &Series) -> Markup {
    let is_compared = series.is_wrench_compared();
    let what = if is_compared { "error" } else { "wrench" };
    let of = |component: usize| {
        let before = band(series, Channel::WrenchBefore(component), "before: uncompensated", "before")?;
        let after = band(series, Channel::WrenchAfter(component), "after: compensated", "after");
        let unit = if component < 3 { "N" } else { "Nm" };
        let title = if component < 3 {
            format!("Force along {}", COMPONENTS[component])
        } else {
            format!("Torque {}", COMPONENTS[component])
        };
        let mut plot = Plot::new(title, Axis::TIME, Axis::new(what, unit)).half();
        plot.size[1] = 200.0;
        plot.traces = std::iter::once(before).chain(after).collect();
        Some(plot)
    };
    let mut all: Vec<Option<Plot>> = (0..6).map(of).collect();
    let (forces, torques) = all.split_at_mut(3);
    if is_compared {
        share_scale(forces);
        share_scale(torques);
    }
    html! {
        @if all.iter().any(Option::is_some) {
            section {
                h2 { "Wrench on the platform" }
                p.soft {
                    @if is_compared { "Wrench by the cable forces less the wrench of the log, in base axes about the platform origin." }
                    @else { "Wrench from outside by the cable forces, gravity included, in base axes about the platform origin." }
                }
                div.views { @for plot in all.iter().flatten() { (plots.figure(plot, series.starts_s())) } }
            }
        }
    }
}
