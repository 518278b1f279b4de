//! The interactive plots of a cable: residual over time, friction over speed and length, correlation and spectrum.

use fric_lab::discover::result::DiscoverCableResult;
use fric_lab::discover::{Autocorrelation, CableDiscovery, FrictionPoint, Spectrum, autocorrelation, spectrum};
use maud::{Markup, html};

use super::after_name;
use crate::report::plot::{Axis, Plot, Plots, Trace, Values};
use crate::report::series::Extent;

/// Maximum number of residual intervals on a page, for all cables together, which keeps it below 3 MB.
const MOST_INTERVALS: usize = 130_000;

/// Longest lag of an autocorrelation in a plot, s.
const LONGEST_LAG_S: f64 = 2.0;

/// Number of plotted points of a spectrum per octave.
const PER_OCTAVE: f64 = 24.0;

/// The common properties of the time plots of all cables, for comparison.
pub(super) struct Common {
    /// Common range of the residuals, N.
    scale: Extent,
    /// Number of samples per interval of the page.
    per_interval: usize,
}

impl Common {
    pub(super) fn of(discoveries: &[CableDiscovery]) -> Self {
        let mut scale = Extent { least: 0.0, greatest: 0.0 };
        for found in discoveries {
            found.residual_before_n.iter().chain(&found.residual_after_n).for_each(|value| scale.add(*value));
        }
        let samples: usize = discoveries.iter().map(|found| found.times_s.len()).sum();
        Self { scale, per_interval: samples.div_ceil(MOST_INTERVALS).max(1) }
    }

    pub(super) fn starts_s(&self, times_s: &[f64]) -> Vec<f64> {
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

pub(super) fn over_time(common: &Common, cable: &DiscoverCableResult, found: &CableDiscovery) -> Plot {
    let mut plot = Plot::new("Residual: model less reference", Axis::TIME, Axis::new("residual", "N"));
    let band = |name: &str, color, residual_n: &[f64]| Trace::new(name, color, common.band(residual_n));
    plot.traces.push(band("before: given model, fitted", "before", &found.residual_before_n));
    if let Some(after) = after_name(found) {
        plot.traces.push(band(&format!("after: {after}"), "after", &found.residual_after_n));
    }
    plot.looks = looked_at(cable);
    plot.strips.clone_from(&cable.held_out_s);
    plot.span = Some(common.scale);
    plot
}

/// Plots friction over speed and over length, measured and by both models.
pub(super) fn curves(plots: &mut Plots, cable: &DiscoverCableResult, found: &CableDiscovery) -> Markup {
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
    over_speed.traces.push(Trace::new(
        "before: given model",
        "before",
        Values::Line(pick(speeds, |point| point.before_n)),
    ));
    if is_extended {
        over_speed.traces.push(Trace::new(
            "after: extended model",
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
        add("before", "before", |point| point.before_n);
        if is_extended {
            add("after", "after", |point| point.after_n);
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
pub(super) fn periodic(plots: &mut Plots, cable: &DiscoverCableResult, found: &CableDiscovery) -> Markup {
    let before = ("before: given model".to_owned(), "before", &found.residual_before_n);
    let after = after_name(found).map(|after| (format!("after: {after}"), "after", &found.residual_after_n));
    let shown = std::iter::once(before).chain(after);
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
            density.traces.push(Trace::new(&name, color, Values::Line(values)));
        }
        let Autocorrelation { lag_s, correlation, white } = autocorrelation(&found.times_s, residual_n, LONGEST_LAG_S);
        if lag_s.len() > 1 {
            lags = lag_s;
            memory.traces.push(Trace::new(&name, color, Values::Line(correlation)));
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
