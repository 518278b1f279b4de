//! A plot of a page: drawn as SVG, listed as a table behind it, and passed as numbers to the script that makes it interactive.
//!
//! All three show the same numbers: values are rounded once, to the digits of the plot. Time series are too long to be listed or written as text;
//! they are passed to the script in 16 bits between the least and the greatest value, as minimum and maximum of intervals.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use fric_lab::text::{number, significant};
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

use super::chart::{Chart, Span};
use super::series::Extent;
use super::signed;

/// Maximum number of points of a line in SVG.
const MOST_POINTS: usize = 480;
/// Maximum number of rows of a table.
const MOST_ROWS: usize = 40;
/// Number of steps between the least and the greatest value in 16 bits; the remaining code means no value.
const STEPS: u16 = u16::MAX - 1;

/// The description of an axis.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    pub name: &'static str,
    /// `""` for a number without unit.
    pub unit: &'static str,
    pub is_log: bool,
}

impl Axis {
    pub const TIME: Self = Self::new("time", "s");

    pub const fn new(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, is_log: false }
    }

    pub const fn log(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, is_log: true }
    }

    fn in_words(self) -> String {
        if self.unit.is_empty() { self.name.to_owned() } else { format!("{} [{}]", self.name, self.unit) }
    }
}

/// The numbers of a trace, one per x; NaN if there is none.
#[derive(Clone, Debug)]
pub enum Values {
    Line(Vec<f64>),
    /// Least and greatest value.
    Band(Vec<f64>, Vec<f64>),
    /// Mean, and its uncertainty to either side.
    Spread(Vec<f64>, Vec<f64>),
}

/// One line of a plot.
#[derive(Clone, Debug)]
pub struct Trace {
    pub name: String,
    /// Its color: a variable of the style sheet.
    pub color: &'static str,
    /// Its role, such as `before`, which can be hidden on the whole page.
    pub role: &'static str,
    /// Its cable, if a plot has several.
    pub cable: Option<usize>,
    pub is_dashed: bool,
    pub values: Values,
}

impl Trace {
    pub fn new(name: &str, color: &'static str, values: Values) -> Self {
        Self { name: name.to_owned(), color, role: color, cable: None, is_dashed: false, values }
    }
}

/// A plot under construction.
#[derive(Clone, Debug)]
pub struct Plot {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    /// Number of decimals of y.
    pub digits: usize,
    pub traces: Vec<Trace>,
    /// Ranges of x to look at.
    pub looks: Vec<[f64; 2]>,
    /// What these ranges are, for the legend.
    pub looks_name: &'static str,
    /// Ranges of x marked along the bottom.
    pub strips: Vec<[f64; 2]>,
    /// Vertical lines with a text.
    pub uprights: Vec<(f64, String)>,
    /// Horizontal lines with a text.
    pub levels: Vec<(f64, String)>,
    /// Common range of y for several plots; otherwise its own.
    pub span: Option<Extent>,
    pub size: [f64; 2],
}

impl Plot {
    /// Creates a plot of the full page width.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            digits: 4,
            traces: Vec::new(),
            looks: Vec::new(),
            looks_name: "where to look",
            strips: Vec::new(),
            uprights: Vec::new(),
            levels: Vec::new(),
            span: None,
            size: [960.0, 230.0],
        }
    }

    /// Makes it one of two side by side.
    pub fn half(self) -> Self {
        Self { size: [470.0, 240.0], ..self }
    }

    /// Returns the range of the traces, without a margin.
    pub fn extent(&self) -> Extent {
        let mut extent = Extent::NOTHING;
        let mut add = |value: f64| {
            if !self.y.is_log || value > 0.0 {
                extent.add(value);
            }
        };
        for trace in &self.traces {
            match &trace.values {
                Values::Line(values) => values.iter().for_each(|value| add(*value)),
                Values::Band(least, greatest) => least.iter().chain(greatest).for_each(|value| add(*value)),
                Values::Spread(mean, half) => mean.iter().zip(half).for_each(|(mean, half)| {
                    add(mean - half);
                    add(mean + half);
                }),
            }
        }
        for (value, _) in &self.levels {
            add(*value);
        }
        extent
    }

    fn y_span(&self) -> Span {
        let extent = self.span.unwrap_or_else(|| self.extent());
        let extent = if extent.is_something() { extent } else { Extent { least: 0.0, greatest: 1.0 } };
        if self.y.is_log {
            return Span { least: extent.least / 1.3, greatest: extent.greatest * 1.3, unit: self.y.unit };
        }
        Span::with_margin(extent, 0.06, self.y.unit)
    }

    /// Returns title and axes as a sentence.
    fn caption(&self) -> String {
        format!("{}: {}", self.title, self.axes())
    }

    /// Returns the names of both axes and their scales.
    fn axes(&self) -> String {
        let scale = |axis: Axis| if axis.is_log { "logarithmic" } else { "linear" };
        let scales = if self.x.is_log == self.y.is_log {
            format!("both axes {}", scale(self.x))
        } else {
            format!("{} axis {}, {} axis {}", self.x.name, scale(self.x), self.y.name, scale(self.y))
        };
        format!("{} over {}, {scales}", self.y.in_words(), self.x.in_words())
    }
}

/// The plots of a page, with the numbers for its script.
#[derive(Debug, Default)]
pub struct Plots {
    xs: Vec<Vec<f64>>,
    coded_xs: Vec<Value>,
    drawn: Vec<Value>,
}

impl Plots {
    /// Returns the name of the next plot, for links to it.
    pub fn next_id(&self) -> String {
        format!("plot-{}", self.drawn.len())
    }

    /// Returns the figure; all traces have their values at `xs`.
    pub fn figure(&mut self, plot: &Plot, xs: &[f64]) -> Markup {
        let id = self.next_id();
        let is_time = plot.x.name == Axis::TIME.name;
        let place = self.place_of(xs, is_time);
        let y = plot.y_span();
        let code = |values: &[f64]| if is_time { coded(values) } else { rounded(values, plot.digits) };
        let traces = plot.traces.iter().map(|trace| {
            let parts = match &trace.values {
                Values::Line(values) => json!({"y": code(values)}),
                Values::Band(least, greatest) => json!({"least": code(least), "greatest": code(greatest)}),
                Values::Spread(mean, half) => json!({"y": code(mean), "half": code(half)}),
            };
            json!({"name": trace.name, "color": trace.color, "role": trace.role, "cable": trace.cable,
                   "dashed": trace.is_dashed, "values": parts})
        });
        self.drawn.push(json!({
            "id": id, "caption": plot.caption(), "xs": place, "height": plot.size[1], "digits": plot.digits,
            "x": {"name": plot.x.name, "unit": plot.x.unit, "log": plot.x.is_log, "time": is_time},
            "y": {"name": plot.y.name, "unit": plot.y.unit, "log": plot.y.is_log, "span": [y.least, y.greatest]},
            "traces": traces.collect::<Vec<_>>(), "looks": plot.looks, "strips": plot.strips,
            "uprights": plot.uprights, "levels": plot.levels,
        }));
        html! {
            figure.plot id=(id) {
                figcaption { (plot.title) span.soft { " " (plot.axes()) } }
                p.legend {
                    @for trace in &plot.traces {
                        // The script has switches in place of these.
                        span.keys.switched {
                            span.key.dashed[trace.is_dashed] style=(format!("background: var(--{})", trace.color)) {}
                            (trace.name)
                        }
                        " "
                    }
                    @if !plot.looks.is_empty() { span.keys { span.key style="background: var(--flag)" {} (plot.looks_name) } " " }
                    @if !plot.strips.is_empty() { span.keys { span.key style="background: var(--soft)" {} "along the foot: samples held out" } }
                }
                (PreEscaped(drawn(plot, xs, y)))
                details { summary { "Numbers of this chart" } (listed(plot, xs)) }
            }
        }
    }

    fn place_of(&mut self, xs: &[f64], is_time: bool) -> usize {
        let is_same = |known: &Vec<f64>| known.as_slice() == xs;
        if let Some(place) = self.xs.iter().position(is_same) {
            return place;
        }
        self.xs.push(xs.to_vec());
        self.coded_xs.push(if is_time { coded_finely(xs) } else { xs.iter().map(|x| shortest(*x)).collect() });
        self.xs.len() - 1
    }

    /// Returns the numbers for the script, as JSON that no character can terminate; `None` without a plot.
    pub fn into_json(self, cables: &[&str]) -> Option<String> {
        if self.drawn.is_empty() {
            return None;
        }
        let all = json!({"cables": cables, "xs": self.coded_xs, "plots": self.drawn});
        let escaped = |letter: char| matches!(letter, '<' | '>' | '&' | '\u{2028}' | '\u{2029}');
        let mut text = String::new();
        for letter in all.to_string().chars() {
            if escaped(letter) {
                // Writing to a String cannot fail.
                let _ = write!(text, "\\u{:04x}", u32::from(letter));
            } else {
                text.push(letter);
            }
        }
        Some(text)
    }
}

/// Returns a number with the digits that a chart needs.
fn shortest(value: f64) -> Value {
    significant_number(value, 7)
}

fn significant_number(value: f64, digits: usize) -> Value {
    if !value.is_finite() {
        return Value::Null;
    }
    format!("{value:.*e}", digits - 1).parse::<f64>().map_or(Value::Null, |number| json!(number))
}

/// Returns the values, rounded as shown.
fn rounded(values: &[f64], digits: usize) -> Value {
    let one = |value: &f64| number(*value, digits).parse::<f64>().ok().filter(|value| value.is_finite());
    values.iter().map(|value| one(value).map_or(Value::Null, |value| json!(value))).collect()
}

/// Encodes values in 16 bits between the least and the greatest.
fn coded(values: &[f64]) -> Value {
    let mut extent = Extent::NOTHING;
    for value in values {
        extent.add(*value);
    }
    if !extent.is_something() {
        extent = Extent { least: 0.0, greatest: 0.0 };
    }
    let step = ((extent.greatest - extent.least) / f64::from(STEPS)).max(f64::MIN_POSITIVE);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to STEPS")]
    let one = |value: &f64| if value.is_finite() { ((value - extent.least) / step).round() as u16 } else { u16::MAX };
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| one(value).min(if value.is_finite() { STEPS } else { u16::MAX }).to_le_bytes())
        .collect();
    json!({"u16": BASE64_STANDARD.encode(bytes), "least": extent.least, "step": step})
}

/// Encodes times as single-precision floats.
fn coded_finely(values: &[f64]) -> Value {
    #[expect(clippy::cast_possible_truncation, reason = "7 digits suffice to draw")]
    let bytes: Vec<u8> = values.iter().flat_map(|value| (*value as f32).to_le_bytes()).collect();
    json!({"f32": BASE64_STANDARD.encode(bytes)})
}

/// Draws the plot as SVG.
fn drawn(plot: &Plot, xs: &[f64], y: Span) -> String {
    let mut extent = Extent::NOTHING;
    xs.iter().filter(|x| !plot.x.is_log || **x > 0.0).for_each(|x| extent.add(*x));
    if !extent.is_something() {
        extent = Extent { least: 0.0, greatest: 1.0 };
    }
    if extent.greatest <= extent.least {
        extent.greatest = extent.least + 1e-9;
    }
    let [width, height] = plot.size;
    let x = Span { least: extent.least, greatest: extent.greatest, unit: plot.x.unit };
    let mut chart = Chart::with_scales(x, y, [plot.x.is_log, plot.y.is_log], width, height);
    for [from, to] in &plot.looks {
        // At least wide enough to be visible.
        let more = (0.5 * (2e-3 * (x.greatest - x.least) - (to - from))).max(0.0);
        chart.stretch("look", (from - more).max(x.least), (to + more).min(x.greatest), "");
    }
    for trace in &plot.traces {
        let class = format!("trace t-{}{}", trace.color, if trace.is_dashed { " back" } else { "" });
        let points = |values: &[f64]| -> Vec<[f64; 2]> {
            let is_drawable = |value: f64| !plot.y.is_log || value > 0.0;
            xs.iter().zip(values).map(|(x, value)| [*x, if is_drawable(*value) { *value } else { f64::NAN }]).collect()
        };
        match &trace.values {
            Values::Line(values) => chart.line(&class, thinned(points(values)).into_iter()),
            Values::Spread(mean, half) => {
                let [least, greatest]: [Vec<f64>; 2] =
                    [-1.0, 1.0].map(|side| mean.iter().zip(half).map(|(mean, half)| mean + side * half).collect());
                chart.band(&format!("spread t-{}", trace.color), xs, &least, &greatest);
                chart.line(&class, points(mean).into_iter());
            }
            Values::Band(least, greatest) => {
                let (xs, least, greatest) = merged(xs, least, greatest);
                chart.band(&format!("band t-{}", trace.color), &xs, &least, &greatest);
            }
        }
    }
    for [from, to] in &plot.strips {
        chart.strip("held", *from, *to);
    }
    for (at, word) in &plot.uprights {
        chart.upright_with("floor", *at, word);
    }
    for (at, word) in &plot.levels {
        chart.level("floor", *at, word, true);
    }
    chart.into_svg(&plot.caption())
}

/// Merges intervals until few enough are left to draw.
fn merged(xs: &[f64], least: &[f64], greatest: &[f64]) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let count = xs.len().div_ceil(MOST_POINTS).max(1);
    let fold = |values: &[f64], pick: fn(f64, f64) -> f64| {
        values.chunks(count).map(|chunk| chunk.iter().copied().fold(f64::NAN, pick)).collect()
    };
    (xs.iter().copied().step_by(count).collect(), fold(least, f64::min), fold(greatest, f64::max))
}

fn thinned(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let count = points.len().div_ceil(2 * MOST_POINTS).max(1);
    points.into_iter().step_by(count).collect()
}

/// Lists the plot as a table.
fn listed(plot: &Plot, xs: &[f64]) -> Markup {
    let is_time = plot.x.name == Axis::TIME.name;
    let per_row = xs.len().div_ceil(if is_time { 12 } else { MOST_ROWS }).max(1);
    let shown = |value: f64| if value.is_finite() { signed(&number(value, plot.digits)) } else { "–".to_owned() };
    let cells = |trace: &Trace, rows: std::ops::Range<usize>| -> Vec<String> {
        let of = |values: &[f64], pick: fn(f64, f64) -> f64| {
            shown(values.get(rows.clone()).unwrap_or_default().iter().copied().fold(f64::NAN, pick))
        };
        match &trace.values {
            Values::Line(values) if per_row == 1 => vec![of(values, f64::max)],
            Values::Line(values) => vec![of(values, f64::min), of(values, f64::max)],
            Values::Band(least, greatest) => vec![of(least, f64::min), of(greatest, f64::max)],
            Values::Spread(mean, half) => vec![of(mean, f64::max), of(half, f64::max)],
        }
    };
    let heads = |trace: &Trace| -> Vec<String> {
        let name = &trace.name;
        match &trace.values {
            Values::Line(_) if per_row == 1 => vec![name.clone()],
            Values::Spread(..) => vec![name.clone(), "±".to_owned()],
            _ => vec![format!("{name}, least"), "greatest".to_owned()],
        }
    };
    html! {
        table {
            thead {
                tr {
                    th scope="col" { (plot.x.in_words()) @if per_row > 1 { ", from" } }
                    @for head in plot.traces.iter().flat_map(heads) { th scope="col" { (head) @if !plot.y.unit.is_empty() { " [" (plot.y.unit) "]" } } }
                }
            }
            tbody {
                @for start in (0..xs.len()).step_by(per_row) {
                    tr {
                        th scope="row" { (signed(&significant(xs[start]))) }
                        @for cell in plot.traces.iter().flat_map(|trace| cells(trace, start..(start + per_row).min(xs.len()))) { td { (cell) } }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_bits_keep_a_value_to_its_step() {
        let values = [-1.25, f64::NAN, 3.5, 0.1];
        let code = coded(&values);
        let (least, step) = (code["least"].as_f64().unwrap(), code["step"].as_f64().unwrap());
        let bytes = BASE64_STANDARD.decode(code["u16"].as_str().unwrap()).unwrap();
        let codes: Vec<u16> = bytes.chunks(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
        assert_eq!(codes[1], u16::MAX);
        for place in [0, 2, 3] {
            assert!((least + step * f64::from(codes[place]) - values[place]).abs() <= step, "{place}");
        }
    }

    #[test]
    fn merging_keeps_every_extreme() {
        let xs: Vec<f64> = (0..10_000).map(f64::from).collect();
        let (starts, least, greatest) = merged(&xs, &xs, &xs);
        assert!(starts.len() <= MOST_POINTS && starts[0].abs() < 1e-12);
        for (place, start) in starts.iter().enumerate() {
            let end = starts.get(place + 1).copied().unwrap_or(10_000.0) - 1.0;
            assert!((least[place] - start).abs() < 1e-12 && (greatest[place] - end).abs() < 1e-12);
        }
    }

    #[test]
    fn no_name_ends_the_script() {
        let mut plots = Plots::default();
        let mut plot = Plot::new("</script><b>", Axis::TIME, Axis::new("force", "N"));
        plot.traces.push(Trace::new("</script>", "before", Values::Line(vec![0.0, 1.0])));
        let page = plots.figure(&plot, &[0.0, 1.0]).into_string();
        let json = plots.into_json(&["<!--"]).unwrap();
        assert!(!json.contains('<') && !page.contains("<b>"), "{json}");
        assert_eq!(serde_json::from_str::<Value>(&json).unwrap()["cables"][0], "<!--");
    }
}
