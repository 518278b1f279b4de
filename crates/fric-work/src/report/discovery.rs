//! The page of `discover --report`: the verdicts, then for each cable the findings with position and uncertainty.

use fric_lab::discover::result::{
    Candidate, DiscoverCableResult, DiscoverResult, EffectResult, TablePoint, TableResult, WhereResult, WrenchGap,
};
use fric_lab::discover::words::{condition, evidence, interval, name_of, newtons, percent, significance};
use fric_lab::discover::{
    Autocorrelation, CableDiscovery, FrictionPoint, Model, Profile, ProfileCell, Spectrum, autocorrelation, spectrum,
};
use fric_lab::fit::{HALF_INTERVAL, Parameter};
use fric_lab::text::{quantity, scaled_unit};
use maud::{Markup, PreEscaped, html};

use super::chart::{Chart, Span};
use super::plot::{Axis, Plot, Plots, Trace, Values};
use super::series::Extent;
use super::{Page, number};
use crate::provenance::Provenance;
use crate::verdict;

/// Maximum number of residual intervals on a page, for all cables together, which keeps it below 3 MB.
const MOST_INTERVALS: usize = 130_000;
/// Longest lag of an autocorrelation in a plot, s.
const LONGEST_LAG_S: f64 = 2.0;
/// Number of plotted points of a spectrum per octave.
const PER_OCTAVE: f64 = 24.0;
/// Width of a single chart, and of one of two.
const WIDE: f64 = 960.0;
const HALF: f64 = 470.0;

/// Returns the page.
#[must_use]
pub fn page(result: &DiscoverResult, discoveries: &[CableDiscovery], provenance: &Provenance) -> String {
    let mut plots = Plots::default();
    let common = Common::of(discoveries);
    let content = html! {
        @if result.cables.len() > 1 {
            nav {
                @for (place, cable) in result.cables.iter().enumerate() {
                    a href=(format!("#cable-{place}")) { span class=(cable.verdict) { "● " } (cable.name) }
                }
            }
        }
        (overview(result, |place, name| html! { a href=(format!("#cable-{place}")) { (name) } }))
        @if let Some(gap) = &result.wrench { (of_wrench(gap)) }
        @for effect in &result.common_effects {
            p { (effect.in_words(result.cables.len())) "." }
        }
        @for (place, (cable, found)) in result.cables.iter().zip(discoveries).enumerate() {
            section.cable id=(format!("cable-{place}")) data-cable=(place) {
                h2 { (cable.name) ": " span class={ "verdict " (cable.verdict) } { (cable.verdict) } }
                p { (cable.verdict_in_words()) }
                @if cable.noise_floor_n.is_some() { (details(&mut plots, &common, cable, found)) }
            }
        }
    };
    let title = format!("{}: what the model lacks", result.robot);
    let names = result.cables.iter().map(|cable| cable.name.as_str()).collect();
    Page { title, verdict: verdict::of_discovery(result), content, plots, cables: names, provenance }.into_html()
}

/// The common properties of the time plots of all cables, for comparison.
struct Common {
    /// Common range of the residuals, N.
    scale: Extent,
    /// Number of samples per interval of the page.
    per_interval: usize,
}

impl Common {
    fn of(discoveries: &[CableDiscovery]) -> Self {
        let mut scale = Extent { least: 0.0, greatest: 0.0 };
        for found in discoveries {
            found.residual_before_n.iter().chain(&found.residual_after_n).for_each(|value| scale.add(*value));
        }
        let samples: usize = discoveries.iter().map(|found| found.times_s.len()).sum();
        Self { scale, per_interval: samples.div_ceil(MOST_INTERVALS).max(1) }
    }

    fn starts_s(&self, times_s: &[f64]) -> Vec<f64> {
        times_s.iter().copied().step_by(self.per_interval).collect()
    }

    /// Returns the least and the greatest residual in each interval.
    fn band(&self, residual_n: &[f64]) -> Values {
        let extent = |values: &[f64]| {
            let mut extent = Extent::NOTHING;
            for value in values {
                extent.add(*value);
            }
            extent.ends()
        };
        let (least, greatest) = residual_n.chunks(self.per_interval).map(extent).unzip();
        Values::Band(least, greatest)
    }
}

/// Returns the verdicts as a table.
#[must_use]
pub fn table(result: &DiscoverResult) -> String {
    overview(result, |_, name| html! { (name) }).into_string()
}

/// Returns the verdicts; `named` formats a cable's name, possibly as a link.
fn overview(result: &DiscoverResult, named: impl Fn(usize, &str) -> Markup) -> Markup {
    html! {
        table {
            tr {
                th scope="col" { "cable" } th.words scope="col" { "verdict" } th.words scope="col" { "found" } th scope="col" { "noise [N]" }
                th scope="col" { "rms before [N]" } th scope="col" { "after [N]" } th scope="col" { "gap closed" }
            }
            @for (place, cable) in result.cables.iter().enumerate() {
                tr {
                    td { (named(place, &cable.name)) }
                    td class={ "words verdict " (cable.verdict) } { (cable.verdict) }
                    td.words {
                        @if cable.effects.is_empty() { "–" }
                        (cable.effects.iter().map(|effect| effect.kind).collect::<Vec<_>>().join(", "))
                    }
                    td { (number(cable.noise_floor_n)) }
                    td { (number(cable.before.map(|error| error.rms_n))) }
                    td { (number(cable.after.map(|error| error.rms_n))) }
                    td {
                        (cable.gap_closed.filter(|_| !cable.effects.is_empty()).map_or_else(|| "–".to_owned(), percent))
                    }
                }
            }
        }
        p.soft {
            "Root mean squares over samples that no fit has seen: before, of the given model fitted to the others; after, of \
             the extended one."
        }
    }
}

/// Returns the findings for all cables together.
fn of_wrench(gap: &WrenchGap) -> Markup {
    html! {
        h2 { "All cables together: " span class={ "verdict " (gap.verdict) } { (gap.verdict) } }
        table {
            tr { th { (gap.title()) } th { "noise" } th { "rms before" } th { "after" } }
            @for component in &gap.components {
                tr { @for cell in component.cells() { td { (cell) } } }
            }
        }
        @for sentence in gap.in_words() { p { (sentence) } }
        p.soft {
            "Of a cable below, a residual is the error of its force alone that comes nearest to the deviation of the wrench: what is seen there \
             may sit in another cable with the same lever."
        }
    }
}

fn details(plots: &mut Plots, common: &Common, cable: &DiscoverCableResult, found: &CableDiscovery) -> Markup {
    // The plot that a time interval links to.
    let over_time_id = plots.next_id();
    html! {
        @for effect in &cable.effects { (effect_in_words(effect)) }
        @if !cable.faults.is_empty() {
            h3 { "Faults of the recording" }
            ul { @for fault in &cable.faults { li { (fault.in_words()) } } }
        }
        @if let Some(rest) = &cable.unexplained {
            h3 { "Unexplained" }
            ul { @for sentence in rest.in_words() { li { (sentence) } } }
        }
        @if cable.verdict != "complete" && cable.before.is_some() {
            figure {
                h3 { "Gap" }
                (PreEscaped(ladder(cable)))
            }
        }
        h3 { "Residual over time" }
        (plots.figure(&over_time(common, cable, found), &common.starts_s(&found.times_s)))
        (curves(plots, cable, found))
        (periodic(plots, cable, found))
        @for profile in &found.profiles { (over_condition(cable, profile)) }
        (places("Where the given model disagrees", &cable.places, &over_time_id))
        // Without an effect the rest equals the whole gap.
        @if let Some(rest) = cable.unexplained.as_ref().filter(|_| !cable.effects.is_empty() || cable.places.is_empty()) {
            (places("Where the rest lies", &rest.places, &over_time_id))
        }
        (candidates(cable))
        (parameters(found))
    }
}

fn effect_in_words(effect: &EffectResult) -> Markup {
    html! {
        h3 { (effect.kind) }
        dl {
            dt { "values" } dd { (effect.values_in_words()) " (95 %)" }
            dt { "cause" } dd { (effect.effect.row().cause) }
            dt { "remedy" } dd { (effect.effect.row().remedy) }
            @if let Some(alternative) = effect.alternative_in_words() { dt { "else" } dd { (alternative) } }
        }
        @if let Some(table) = &effect.table {
            figure {
                h3 { "Unnamed, over the " (condition(table.over)) }
                p.soft { "What the table adds, with its 95 % interval; beyond the ends the first and the last hold." }
                (PreEscaped(of_table(table)))
            }
        }
    }
}

/// Draws a table over its condition, with the uncertainty of each point.
fn of_table(table: &TableResult) -> String {
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
fn ladder(cable: &DiscoverCableResult) -> String {
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

/// Returns the intervals to look at: those of the rest if there is one, else those of the most informative condition.
fn looked_at(cable: &DiscoverCableResult) -> Vec<[f64; 2]> {
    let mut all = Vec::new();
    all.extend(cable.faults.iter().flat_map(|fault| fault.intervals_s.iter().copied()));
    if let Some(rest) = &cable.unexplained {
        all.extend_from_slice(&rest.intervals_s);
        all.extend(rest.places.first().into_iter().flat_map(|place| place.intervals_s.clone()));
    }
    if all.is_empty() {
        all.extend(cable.places.first().into_iter().flat_map(|place| place.intervals_s.clone()));
    }
    all
}

fn over_time(common: &Common, cable: &DiscoverCableResult, found: &CableDiscovery) -> Plot {
    let mut plot = Plot::new("Residual: model less reference", Axis::TIME, Axis::new("residual", "N"));
    let band = |name, color, residual_n: &[f64]| Trace::new(name, color, common.band(residual_n));
    plot.traces.push(band("before: given model, fitted", "before", &found.residual_before_n));
    if !cable.effects.is_empty() {
        plot.traces.push(band("after: extended model", "after", &found.residual_after_n));
    }
    plot.looks = looked_at(cable);
    plot.strips.clone_from(&cable.held_out_s);
    plot.span = Some(common.scale);
    plot
}

/// Plots friction over speed and over length, measured and by both models.
fn curves(plots: &mut Plots, cable: &DiscoverCableResult, found: &CableDiscovery) -> Markup {
    let is_extended = !cable.effects.is_empty();
    let speeds = &found.curves.over_speed;
    let [back, out] = &found.curves.over_length;
    let pick =
        |points: &[FrictionPoint], pick: fn(&FrictionPoint) -> f64| points.iter().map(pick).collect::<Vec<f64>>();
    let friction = Axis::new("friction", "N");
    let mut over_speed =
        Plot::new("Friction over speed, positive paying out", Axis::new("speed", "mm/s"), friction).half();
    let measured = Values::Spread(pick(speeds, |point| point.measured_n), pick(speeds, |point| point.deviation_n));
    over_speed.traces.push(Trace::new("measured ± standard deviation", "text", measured));
    over_speed.traces.push(Trace::new("given model", "before", Values::Line(pick(speeds, |point| point.before_n))));
    if is_extended {
        over_speed.traces.push(Trace::new(
            "extended model",
            "after",
            Values::Line(pick(speeds, |point| point.after_n)),
        ));
    }
    let mut loops = Plot::new("Hysteresis over the cable length", Axis::new("length", "m"), friction).half();
    for (points, direction, is_dashed) in [(out, "paying out", false), (back, "reeling in", true)] {
        let mut add = |name: &str, color, pick: fn(&FrictionPoint) -> f64| {
            let values = points.iter().map(pick).collect();
            let trace = Trace::new(&format!("{name}, {direction}"), color, Values::Line(values));
            loops.traces.push(Trace { is_dashed, ..trace });
        };
        if points.is_empty() {
            continue;
        }
        add("measured", "text", |point| point.measured_n);
        add("given model", "before", |point| point.before_n);
        if is_extended {
            add("extended model", "after", |point| point.after_n);
        }
    }
    let lengths = if out.is_empty() { back } else { out };
    html! {
        @if !speeds.is_empty() {
            div.views {
                (plots.figure(&over_speed, &pick(speeds, |point| 1e3 * point.at)))
                @if !loops.traces.is_empty() { (plots.figure(&loops, &pick(lengths, |point| point.at))) }
            }
            p.soft {
                "Means over the samples that count. Measured friction is the reference less the force without friction, negative where the \
                 platform feels less than the sensor."
            }
        }
    }
}

/// Plots the spectrum of the residual with the lines found, and its autocorrelation.
fn periodic(plots: &mut Plots, cable: &DiscoverCableResult, found: &CableDiscovery) -> Markup {
    let is_extended = !cable.effects.is_empty();
    let residuals = [
        ("before: given model", "before", &found.residual_before_n),
        ("after: extended model", "after", &found.residual_after_n),
    ];
    let shown = &residuals[..if is_extended { 2 } else { 1 }];
    let mut density =
        Plot::new("Spectrum of the residual", Axis::log("frequency", "Hz"), Axis::log("density", "N/√Hz")).half();
    density.digits = 6;
    let mut memory =
        Plot::new("Autocorrelation of the residual", Axis::new("lag", "s"), Axis::new("correlation", "")).half();
    let (mut frequencies, mut lags) = (Vec::new(), Vec::new());
    for (name, color, residual_n) in shown {
        let (frequency_hz, values) = per_octave(&spectrum(&found.times_s, residual_n));
        if !frequency_hz.is_empty() {
            frequencies = frequency_hz;
            density.traces.push(Trace::new(name, color, Values::Line(values)));
        }
        let Autocorrelation { lag_s, correlation, white } = autocorrelation(&found.times_s, residual_n, LONGEST_LAG_S);
        if lag_s.len() > 1 {
            lags = lag_s;
            memory.traces.push(Trace::new(name, color, Values::Line(correlation)));
            memory.levels = vec![(white, "95 % of white noise".to_owned()), (-white, String::new())];
        }
    }
    let lines = cable.faults.iter().filter_map(|fault| fault.parameters.get("frequency_hz"));
    density.uprights = lines.map(|line_hz| (line_hz, format!("{line_hz:.2} Hz"))).collect();
    html! {
        div.views {
            @if !density.traces.is_empty() { (plots.figure(&density, &frequencies)) }
            @if !memory.traces.is_empty() { (plots.figure(&memory, &lags)) }
        }
    }
}

/// Reduces a spectrum to a fixed number of points per octave, each the mean power.
fn per_octave(spectrum: &Spectrum) -> (Vec<f64>, Vec<f64>) {
    let mut points: Vec<(f64, f64, f64, f64)> = Vec::new();
    for (frequency_hz, density) in spectrum.frequency_hz.iter().zip(&spectrum.density) {
        let place = (frequency_hz.log2() * PER_OCTAVE).floor();
        match points.last_mut().filter(|(last, ..)| (*last - place).abs() < 0.5) {
            Some((_, sum_hz, power, count)) => {
                *sum_hz += frequency_hz;
                *power += density * density;
                *count += 1.0;
            }
            None => points.push((place, *frequency_hz, density * density, 1.0)),
        }
    }
    points.into_iter().map(|(_, sum_hz, power, count)| (sum_hz / count, (power / count).sqrt())).unzip()
}

/// Plots the residuals over a condition: magnitude and direction.
fn over_condition(cable: &DiscoverCableResult, profile: &Profile) -> Markup {
    let is_extended = !cable.effects.is_empty();
    html! {
        figure {
            h3 { "Residual against the " (condition(profile.signal)) }
            p {
                (key("before", "given model"))
                @if is_extended { (key("after", "extended model")) }
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

fn places(title: &str, places: &[WhereResult], plot: &str) -> Markup {
    let share = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), percent);
    html! {
        @if !places.is_empty() {
            h3 { (title) }
            table {
                tr {
                    th { "condition" } th.words { "range" } th { "of the gap" } th { "of the samples" } th { "told by it" }
                    th { "significance" } th.words { "look at" }
                }
                @for place in places {
                    tr {
                        td { (condition(place.signal)) }
                        td.words { (place.range_in_words()) }
                        td { (share(place.share_of_excess)) } td { (share(place.share_of_samples)) }
                        td { (share(place.explains)) }
                        td { (place.significance.map_or_else(|| "–".to_owned(), significance)) }
                        td.words {
                            @if place.intervals_s.is_empty() { "–" } @else { (looks(&place.intervals_s, plot)) }
                        }
                    }
                }
            }
            p.soft {
                "Told by it: the share of the gap that is a function of this condition and of the direction of motion. \
                 Significance of either share, in standard errors; below 3 σ it may be chance."
            }
        }
    }
}

/// Returns links from time intervals to a plot.
fn looks(intervals_s: &[[f64; 2]], plot: &str) -> Markup {
    html! {
        @for (place, one) in intervals_s.iter().enumerate() {
            @if place > 0 { ", " }
            a href=(format!("#{plot}")) data-look=(format!("{} {}", one[0], one[1])) { (interval(one)) }
        }
        " s"
    }
}

/// Returns the outcome of a candidate.
fn outcome(cable: &DiscoverCableResult, candidate: &Candidate) -> String {
    if cable.effects.iter().any(|effect| effect.kind == candidate.kind) {
        return "named".to_owned();
    }
    match cable.tried.iter().find(|tried| tried.kind == candidate.kind) {
        Some(tried) => tried.reason.clone(),
        None if candidate.delta_bic.is_none_or(|delta_bic| delta_bic >= 0.0) => "does not help".to_owned(),
        None if cable.effects.is_empty() => "no better than what noise that wanders may give".to_owned(),
        None => "not needed beside what is named".to_owned(),
    }
}

fn candidates(cable: &DiscoverCableResult) -> Markup {
    let is_found = |of: &Candidate| cable.effects.iter().any(|effect| effect.kind == of.kind);
    html! {
        @if !cable.candidates.is_empty() {
            figure {
                h3 { "Candidates" }
                table {
                    tr {
                        th scope="col" { "effect" } th scope="col" { "ΔBIC alone" } th scope="col" { "rms held out [N]" }
                        th.words scope="col" { "outcome" }
                    }
                    @for candidate in &cable.candidates {
                        tr class=[is_found(candidate).then_some("found")] {
                            td { (candidate.kind) } td { (evidence(candidate.delta_bic)) }
                            td { (number(candidate.held_out_rms_n)) }
                            td.words { (outcome(cable, candidate)) }
                        }
                    }
                }
                p.soft {
                    "ΔBIC of each by itself beside the given model, as the search began: below zero it helps. Several may help for one \
                     cause; which is named is decided beside the others, so that a low ΔBIC here is not yet a name."
                }
            }
        }
    }
}

fn parameters(found: &CableDiscovery) -> Markup {
    let of_finding = |parameter: &Parameter| {
        found.findings.iter().any(|finding| finding.effect.places().contains(&parameter.place()))
    };
    let shown = Parameter::all().filter(|parameter| found.after.fitted.contains(parameter) || of_finding(parameter));
    let is_extended = !found.findings.is_empty();
    let value = |model: &Model, parameter: &Parameter| {
        let half = model.standard_error(parameter).map(|error| HALF_INTERVAL * error);
        quantity(model.values[parameter.place()], half, parameter.row().unit)
    };
    html! {
        figure {
            h3 { "Parameters" }
            table {
                tr {
                    th { "parameter" } th { "given model" }
                    @if is_extended { th { "extended model" } }
                }
                @for parameter in shown {
                    tr {
                        td { @if let Some(effect) = parameter.effect() { (effect.kind()) ": " } (name_of(parameter.row().key)) }
                        td { @if of_finding(&parameter) { "–" } @else { (value(&found.before, &parameter)) } }
                        @if is_extended { td { (value(&found.after, &parameter)) } }
                    }
                }
            }
            p.soft { "Fitted, ± 95 %; without ± it is a setting." }
        }
    }
}
