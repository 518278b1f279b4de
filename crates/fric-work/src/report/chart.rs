//! A chart as SVG text: two axes with ticks, and the marks between them. Text from files is escaped.

use std::fmt::Write as _;

use fric_lab::text::significant;
use maud::{PreEscaped, html};

use super::series::Extent;
use super::signed;

const LEFT: f64 = 52.0;
const RIGHT: f64 = 8.0;
/// Space for the unit of y, which ticks must not overlap.
const TOP: f64 = 20.0;
const BOTTOM: f64 = 24.0;
/// Height of a row.
const ROW: f64 = 30.0;
/// A chart is not scaled below this fraction of its size, because its letters would become illegible.
const LEAST_SCALE: f64 = 0.69;
/// Gap between a bar, or a line, and the text after it.
const GAP: f64 = 6.0;
/// Minimum distance between ticks on the axes.
const TICK_X: f64 = 56.0;
const TICK_Y: f64 = 34.0;

/// The range of an axis.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    pub least: f64,
    pub greatest: f64,
    pub unit: &'static str,
}

impl Span {
    /// Creates a range with a margin at both ends, relative to its length.
    pub fn with_margin(extent: Extent, share: f64, unit: &'static str) -> Self {
        let margin = ((extent.greatest - extent.least) * share).max(1e-9);
        Self { least: extent.least - margin, greatest: extent.greatest + margin, unit }
    }

    fn length(self) -> f64 {
        self.greatest - self.least
    }

    /// Returns the position of a value between the ends, 0 to 1.
    fn share(self, value: f64, is_log: bool) -> f64 {
        if is_log {
            (value / self.least).ln() / (self.greatest / self.least).ln()
        } else {
            (value - self.least) / self.length()
        }
    }

    /// Returns round values, about `most` of them, with their labels.
    fn ticks(self, is_log: bool, most: f64) -> Vec<(f64, String)> {
        if is_log {
            decades(self.least, self.greatest, most).into_iter().map(|tick| (tick, label(tick))).collect()
        } else {
            ticks(self.least, self.greatest, most).map(|tick| (tick, label(tick))).collect()
        }
    }
}

/// Returns a unit in brackets; empty for counts.
fn bracketed(unit: &str) -> String {
    if matches!(unit, "" | "hole" | "grating") { unit.to_owned() } else { format!("[{unit}]") }
}

/// A chart under construction; later marks are drawn on top.
#[derive(Debug)]
pub struct Chart {
    svg: String,
    x: Span,
    y: Span,
    /// Whether x and y are logarithmic.
    is_log: [bool; 2],
    /// Inner edges: left, right, top, bottom.
    frame: [f64; 4],
}

impl Chart {
    /// Creates a chart of a given size in its own pixels, shown at the width of the page.
    pub fn new(x: Span, y: Span, width: f64, height: f64) -> Self {
        Self::with_scales(x, y, [false; 2], width, height)
    }

    /// Creates the same with x, y or both on a logarithmic scale; such a range must be above 0.
    pub fn with_scales(x: Span, y: Span, is_log: [bool; 2], width: f64, height: f64) -> Self {
        let mut chart = Self { is_log, ..Self::empty(x, y, LEFT, width, height) };
        chart.draw_y_axis();
        chart.draw_x_axis();
        chart
    }

    /// Creates a chart with one row per name, one below the other, each of height 1 from y = 0 on.
    pub fn in_rows(x: Span, names: &[&str], width: f64) -> Self {
        let count = count_of(names);
        let rows = Span { least: -count, greatest: 0.0, unit: "" };
        let longest = names.iter().map(|name| width_of(name)).fold(0.0, f64::max);
        let mut chart = Self::empty(x, rows, longest + 14.0, width, count * ROW + TOP + BOTTOM);
        chart.draw_x_axis();
        for (row, name) in names.iter().enumerate() {
            let (x, y) = (chart.frame[0] - 6.0, chart.at_y(middle_of(row)) + 4.0);
            chart.text(x, y, "end", name);
        }
        chart
    }

    /// Creates a chart with steps of width 1 from x = 0 on, whose edges have these values.
    pub fn in_steps(edges: &[f64], unit: &'static str, y: Span, width: f64, height: f64) -> Self {
        let steps = Span { least: 0.0, greatest: count_of(edges) - 1.0, unit };
        let mut chart = Self::empty(steps, y, LEFT, width, height);
        chart.draw_y_axis();
        let most = ((width - LEFT - RIGHT) / TICK_X).max(1.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
        let every = (steps.greatest / most).ceil().max(1.0) as usize;
        let ticks = edges.iter().enumerate().step_by(every);
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let ticks: Vec<(f64, String)> =
            ticks.map(|(place, edge)| (place as f64, signed(&significant(*edge)))).collect();
        let is_repeated = |place: usize| place > 0 && ticks[place].1 == ticks[place - 1].1;
        let distinct = ticks.iter().enumerate().filter(|(place, _)| !is_repeated(*place));
        chart.draw_x_ticks(distinct.map(|(_, tick)| tick.clone()));
        chart
    }

    /// Creates an empty chart.
    fn empty(x: Span, y: Span, left: f64, width: f64, height: f64) -> Self {
        let frame = [left, width - RIGHT, TOP, height - BOTTOM];
        Self { svg: String::new(), x, y, is_log: [false; 2], frame }
    }

    /// Creates a chart with equal scales on both axes and a maximum height; the remaining width shows more of x.
    pub fn to_scale(x: Span, y: Span, width: f64, most_height: f64) -> Self {
        let (inner_width, inner_height) = (width - LEFT - RIGHT, most_height - TOP - BOTTOM);
        let per_unit = (inner_width / x.length()).min(inner_height / y.length());
        let more = 0.5 * (inner_width / per_unit - x.length());
        let x = Span { least: x.least - more, greatest: x.greatest + more, ..x };
        Self::new(x, y, width, y.length() * per_unit + TOP + BOTTOM)
    }

    fn at_x(&self, value: f64) -> f64 {
        let [left, right, ..] = self.frame;
        left + self.x.share(value, self.is_log[0]) * (right - left)
    }

    fn at_y(&self, value: f64) -> f64 {
        let [.., top, bottom] = self.frame;
        bottom - self.y.share(value, self.is_log[1]) * (bottom - top)
    }

    fn draw_y_axis(&mut self) {
        let [left, right, top, bottom] = self.frame;
        // Writing to a String cannot fail, here and below.
        for (tick, text) in self.y.ticks(self.is_log[1], (bottom - top) / TICK_Y) {
            let at = self.at_y(tick);
            let _ = write!(
                self.svg,
                "<path class=\"axis\" d=\"M{left} {at:.1}H{right:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                left - 6.0,
                at + 4.0,
                text
            );
        }
        let _ = write!(self.svg, "<text x=\"4\" y=\"{:.1}\">{}</text>", top - 9.0, bracketed(self.y.unit));
    }

    fn draw_x_axis(&mut self) {
        let [left, right, ..] = self.frame;
        let all = self.x.ticks(self.is_log[0], (right - left) / TICK_X);
        self.draw_x_ticks(all.into_iter());
    }

    fn draw_x_ticks(&mut self, ticks: impl Iterator<Item = (f64, String)>) {
        let [_, right, _, bottom] = self.frame;
        let unit = bracketed(self.x.unit);
        for (tick, text) in ticks {
            let at = self.at_x(tick);
            // The unit is at the end.
            let is_far_right = at + 0.5 * width_of(&text) > right + 2.0 - width_of(&unit);
            let text = if is_far_right { String::new() } else { text };
            let _ = write!(
                self.svg,
                "<path class=\"axis\" d=\"M{at:.1} {bottom:.1}v4\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{text}</text>",
                bottom + 18.0,
            );
        }
        let _ = write!(
            self.svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            right + 6.0,
            bottom + 18.0,
            unit
        );
    }

    /// Draws a vertical bar for each extent; empty extents are left out.
    pub fn bars(&mut self, class: &str, bars: impl Iterator<Item = (f64, Extent)>) {
        let something = bars.filter(|(_, extent)| extent.is_something());
        let path = something.fold(String::new(), |mut path, (x, extent)| {
            let (from, to) = (self.at_y(extent.greatest), self.at_y(extent.least) + 0.5);
            let _ = write!(path, "M{:.1} {from:.1}V{to:.1}", self.at_x(x));
            path
        });
        let _ = write!(self.svg, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    /// Draws a line through points, interrupted at non-finite ones.
    pub fn line(&mut self, class: &str, points: impl Iterator<Item = [f64; 2]>) {
        let mut command = 'M';
        let path = points.fold(String::new(), |mut path, [x, y]| {
            if x.is_finite() && y.is_finite() {
                let _ = write!(path, "{command}{:.1} {:.1}", self.at_x(x), self.at_y(y));
                command = 'L';
            } else {
                command = 'M';
            }
            path
        });
        let _ = write!(self.svg, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    /// Draws a band between the least and the greatest value at each x, interrupted where one of them is not finite.
    pub fn band(&mut self, class: &str, xs: &[f64], least: &[f64], greatest: &[f64]) {
        let is_there = |place: usize| least[place].is_finite() && greatest[place].is_finite();
        let mut path = String::new();
        let mut from = 0;
        while from < xs.len() {
            let Some(start) = (from..xs.len()).find(|place| is_there(*place)) else { break };
            let end = (start..xs.len()).find(|place| !is_there(*place)).unwrap_or(xs.len());
            for (command, place) in std::iter::once('M').chain(std::iter::repeat('L')).zip(start..end) {
                let _ = write!(path, "{command}{:.1} {:.1}", self.at_x(xs[place]), self.at_y(greatest[place]));
            }
            for place in (start..end).rev() {
                let _ = write!(path, "L{:.1} {:.1}", self.at_x(xs[place]), self.at_y(least[place]));
            }
            path.push('Z');
            from = end;
        }
        let _ = write!(self.svg, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    /// Draws a horizontal line over the full width, with a text above or below it.
    pub fn level(&mut self, class: &str, y: f64, text: &str, is_above: bool) {
        let [left, right, ..] = self.frame;
        let at = self.at_y(y);
        let _ = write!(self.svg, "<path class=\"{class}\" d=\"M{left} {at:.1}H{right:.1}\"/>");
        self.text(right - 4.0, if is_above { at - 4.0 } else { at + 14.0 }, "end", text);
    }

    /// Draws a vertical line over the full height.
    pub fn upright(&mut self, class: &str, x: f64) {
        self.upright_with(class, x, "");
    }

    /// Draws the same with a text at its top.
    pub fn upright_with(&mut self, class: &str, x: f64, text: &str) {
        let [left, right, top, bottom] = self.frame;
        let at = self.at_x(x);
        if !(left..=right).contains(&at) {
            return;
        }
        let _ = write!(self.svg, "<path class=\"{class}\" d=\"M{at:.1} {top}V{bottom:.1}\"/>");
        let is_right = at + width_of(text) + 4.0 > right;
        self.text(if is_right { at - 4.0 } else { at + 4.0 }, top + 10.0, if is_right { "end" } else { "start" }, text);
    }

    /// Draws a bar along a row of [`Self::in_rows`] from x = 0 on, followed by a text that a vertical line at `line` does not cross.
    pub fn bar(&mut self, class: &str, row: usize, x: f64, text: &str, line: f64) {
        let (from, to, at) = (self.at_x(0.0), self.at_x(x), self.at_y(middle_of(row)));
        let (top, height) = (at - 0.32 * ROW, 0.64 * ROW);
        let width = (to - from).max(0.0);
        let _ = write!(
            self.svg,
            "<rect class=\"{class}\" x=\"{from:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"/>"
        );
        let (words, line) = (to + GAP, self.at_x(line));
        let is_crossed = (words - GAP..words + width_of(text)).contains(&line);
        self.text(if is_crossed { line + GAP } else { words }, at + 4.0, "start", text);
    }

    /// Draws a cell of a map: a row of [`Self::in_rows`] between two x, with a strength of 0 to 1.
    pub fn cell(&mut self, class: &str, row: usize, [from, to]: [f64; 2], strength: f64) {
        let (start, end) = (self.at_x(from), self.at_x(to));
        let (top, height, width) = (self.at_y(middle_of(row)) - 0.45 * ROW, 0.9 * ROW, (end - start).max(0.5));
        let _ = write!(
            self.svg,
            "<rect class=\"{class}\" x=\"{start:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill-opacity=\"{strength:.2}\"/>"
        );
    }

    /// Draws a range of x as a strip along the bottom.
    pub fn strip(&mut self, class: &str, from: f64, to: f64) {
        let [.., bottom] = self.frame;
        let (start, end) = (self.at_x(from), self.at_x(to));
        let (top, width) = (bottom - 5.0, (end - start).max(0.5));
        let _ = write!(
            self.svg,
            "<rect class=\"{class}\" x=\"{start:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"5\"/>"
        );
    }

    /// Draws a rectangle between two corners.
    pub fn rectangle(&mut self, class: &str, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) {
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]];
        self.line(class, corners.into_iter());
    }

    /// Draws a dot with a text above it, or below if there is no room.
    pub fn dot(&mut self, class: &str, [x, y]: [f64; 2], text: &str) {
        let [.., top, _] = self.frame;
        let (at_x, at_y) = (self.at_x(x), self.at_y(y));
        let _ = write!(self.svg, "<circle class=\"{class}\" cx=\"{at_x:.1}\" cy=\"{at_y:.1}\" r=\"4\"/>");
        let text_y = if at_y - 8.0 < top + 12.0 { at_y + 17.0 } else { at_y - 8.0 };
        self.text(at_x, text_y, "middle", text);
    }

    /// Shades a range of x, with a text at its top if there is room for it.
    pub fn stretch(&mut self, class: &str, from: f64, to: f64, text: &str) {
        let [.., top, bottom] = self.frame;
        let (start, end) = (self.at_x(from), self.at_x(to));
        let _ = write!(
            self.svg,
            "<rect class=\"{class}\" x=\"{start:.1}\" y=\"{top}\" width=\"{:.1}\" height=\"{:.1}\"/>",
            end - start,
            bottom - top
        );
        if width_of(text) < end - start {
            self.text(0.5 * (start + end), top + 12.0, "middle", text);
        }
    }

    fn text(&mut self, x: f64, y: f64, anchor: &str, text: &str) {
        if text.is_empty() {
            return;
        }
        let (x, y) = (format!("{x:.1}"), format!("{y:.1}"));
        self.svg += &html! { text x=(x) y=(y) text-anchor=(anchor) { (text) } }.into_string();
    }

    /// Returns the drawing; the label is for screen readers.
    pub fn into_svg(self, label: &str) -> String {
        let [_, right, _, bottom] = self.frame;
        let (width, height) = (right + RIGHT, bottom + BOTTOM);
        let size = format!("0 0 {width} {height:.0}");
        let style = format!("min-width: {:.0}px", LEAST_SCALE * width);
        let drawn = PreEscaped(self.svg);
        html! { div.chart { svg viewBox=(size) style=(style) role="img" aria-label=(label) { (drawn) } } }.into_string()
    }
}

/// Returns the approximate width of a text.
fn width_of(text: &str) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a word")]
    let letters = text.chars().count() as f64;
    letters * 6.5
}

fn count_of<T>(items: &[T]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let count = items.len() as f64;
    count
}

/// Returns the y of a row's middle.
fn middle_of(row: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let row = row as f64;
    -row - 0.5
}

/// Returns round numbers between two bounds, at most about `most` of them.
fn ticks(least: f64, greatest: f64, most: f64) -> impl Iterator<Item = f64> {
    let raw = (greatest - least) / most.max(1.0);
    let power = 10.0_f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * power).find(|step| *step >= raw).unwrap_or(raw);
    let first = (least / step).ceil();
    (0..1000).map(move |index| (first + f64::from(index)) * step).take_while(move |tick| *tick <= greatest)
}

/// Returns powers of ten between two bounds, with 2 and 5 times these where there is room or the powers alone are fewer than two; round steps in a range
/// that holds fewer than two of all these.
fn decades(least: f64, greatest: f64, most: f64) -> Vec<f64> {
    #[expect(clippy::cast_possible_truncation, reason = "exponents of ten")]
    let (from, to) = (least.log10().floor() as i32, greatest.log10().ceil() as i32);
    let inside = |factors: &[f64]| -> Vec<f64> {
        let all = (from..=to).flat_map(|exponent| factors.iter().map(move |factor| factor * 10.0_f64.powi(exponent)));
        all.filter(|tick| (least..=greatest).contains(tick)).collect()
    };
    let (powers, all) = (inside(&[1.0]), inside(&[1.0, 2.0, 5.0]));
    match all.len() {
        0 | 1 => ticks(least, greatest, most).collect(),
        _ if count_of(&all) <= most || powers.len() < 2 => all,
        _ => powers,
    }
}

/// Formats a tick without the rounding noise of binary fractions.
fn label(tick: f64) -> String {
    let text = format!("{tick:.9}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { signed(text) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(-0.93, 1.07, 5.0).map(label).collect::<Vec<_>>(), ["−0.5", "0", "0.5", "1"]);
        assert_eq!(ticks(0.0, 51.5, 10.0).map(label).collect::<Vec<_>>(), ["0", "10", "20", "30", "40", "50"]);
    }

    #[test]
    fn logarithmic_ticks_are_round_and_at_least_two() {
        let all = |least, greatest, most| decades(least, greatest, most).into_iter().map(label).collect::<Vec<_>>();
        assert_eq!(all(0.00023, 0.0031, 5.0), ["0.0005", "0.001", "0.002"]);
        assert_eq!(all(0.9, 1100.0, 5.0), ["1", "10", "100", "1000"]);
        assert_eq!(all(0.00041, 0.00062, 5.0), ["0.00045", "0.0005", "0.00055", "0.0006"]);
    }

    #[test]
    fn both_axes_have_the_same_scale() {
        let span = |greatest| Span { least: 0.0, greatest, unit: "m" };
        for (x, y) in [(1.0, 0.5), (0.2, 3.0), (4.0, 4.0)] {
            let chart = Chart::to_scale(span(x), span(y), 470.0, 400.0);
            let (along, up) = (chart.at_x(0.1) - chart.at_x(0.0), chart.at_y(0.0) - chart.at_y(0.1));
            assert!((along - up).abs() < 1e-9, "{x} {y}: {along} {up}");
        }
    }
}
