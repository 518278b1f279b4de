//! A chart as SVG text: two axes with ticks, and what is drawn between them. Text of a file is escaped.

use std::fmt::Write as _;

use maud::html;

use super::series::Extent;

const LEFT: f64 = 52.0;
const RIGHT: f64 = 8.0;
const TOP: f64 = 8.0;
const BOTTOM: f64 = 24.0;
/// Least distance between ticks on the axes.
const TICK_X: f64 = 56.0;
const TICK_Y: f64 = 34.0;

/// What an axis shows.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    pub least: f64,
    pub greatest: f64,
    pub unit: &'static str,
}

impl Span {
    /// From one value to another, with a margin of a share of the distance at both ends.
    pub fn with_margin(extent: Extent, share: f64, unit: &'static str) -> Self {
        let margin = ((extent.greatest - extent.least) * share).max(1e-9);
        Self { least: extent.least - margin, greatest: extent.greatest + margin, unit }
    }

    fn length(self) -> f64 {
        self.greatest - self.least
    }
}

/// A chart in the making: what is drawn later lies above.
#[derive(Debug)]
pub struct Chart {
    svg: String,
    x: Span,
    y: Span,
    /// Inner edges: left, right, top, bottom.
    frame: [f64; 4],
}

impl Chart {
    /// Of a given size in pixels of its own, shown as wide as the page.
    pub fn new(x: Span, y: Span, width: f64, height: f64) -> Self {
        let frame = [LEFT, width - RIGHT, TOP, height - BOTTOM];
        let mut chart = Self { svg: format!("<svg viewBox=\"0 0 {width} {height:.0}\" role=\"img\">"), x, y, frame };
        chart.draw_axes();
        chart
    }

    /// With both axes in the same scale, at most so high; what is left of the width shows more of x.
    pub fn to_scale(x: Span, y: Span, width: f64, most_height: f64) -> Self {
        let (inner_width, inner_height) = (width - LEFT - RIGHT, most_height - TOP - BOTTOM);
        let per_unit = (inner_width / x.length()).min(inner_height / y.length());
        let more = 0.5 * (inner_width / per_unit - x.length());
        let x = Span { least: x.least - more, greatest: x.greatest + more, ..x };
        Self::new(x, y, width, y.length() * per_unit + TOP + BOTTOM)
    }

    fn at_x(&self, value: f64) -> f64 {
        let [left, right, ..] = self.frame;
        left + (value - self.x.least) / self.x.length() * (right - left)
    }

    fn at_y(&self, value: f64) -> f64 {
        let [.., top, bottom] = self.frame;
        top + (self.y.greatest - value) / self.y.length() * (bottom - top)
    }

    fn draw_axes(&mut self) {
        let [left, right, top, bottom] = self.frame;
        let mut svg = std::mem::take(&mut self.svg);
        // Writing to a String cannot fail, here and below.
        for tick in ticks(self.y.least, self.y.greatest, (bottom - top) / TICK_Y) {
            let at = self.at_y(tick);
            let _ = write!(
                svg,
                "<path class=\"axis\" d=\"M{left} {at:.1}H{right:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                left - 6.0,
                at + 4.0,
                label(tick)
            );
        }
        for tick in ticks(self.x.least, self.x.greatest, (right - left) / TICK_X) {
            let at = self.at_x(tick);
            // The unit stands at the end.
            let text = if at > right - 16.0 { String::new() } else { label(tick) };
            let _ = write!(
                svg,
                "<path class=\"axis\" d=\"M{at:.1} {bottom:.1}v4\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{text}</text>",
                bottom + 18.0,
            );
        }
        let _ = write!(
            svg,
            "<text x=\"4\" y=\"{:.1}\">{}</text><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            top + 8.0,
            self.y.unit,
            right + 6.0,
            bottom + 18.0,
            self.x.unit
        );
        self.svg = svg;
    }

    /// An upright bar for each extent; those with nothing in them are left out.
    pub fn bars(&mut self, class: &str, bars: impl Iterator<Item = (f64, Extent)>) {
        let something = bars.filter(|(_, extent)| extent.is_something());
        let path = something.fold(String::new(), |mut path, (x, extent)| {
            let (from, to) = (self.at_y(extent.greatest), self.at_y(extent.least) + 0.5);
            let _ = write!(path, "M{:.1} {from:.1}V{to:.1}", self.at_x(x));
            path
        });
        let _ = write!(self.svg, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    /// A line through points.
    pub fn line(&mut self, class: &str, points: impl Iterator<Item = [f64; 2]>) {
        let path = points.fold(String::new(), |mut path, [x, y]| {
            let command = if path.is_empty() { 'M' } else { 'L' };
            let _ = write!(path, "{command}{:.1} {:.1}", self.at_x(x), self.at_y(y));
            path
        });
        let _ = write!(self.svg, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    /// A level line from end to end, with a word above or below it.
    pub fn level(&mut self, class: &str, y: f64, text: &str, is_above: bool) {
        let [left, right, ..] = self.frame;
        let at = self.at_y(y);
        let _ = write!(self.svg, "<path class=\"{class}\" d=\"M{left} {at:.1}H{right:.1}\"/>");
        self.text(right - 4.0, if is_above { at - 4.0 } else { at + 14.0 }, "end", text);
    }

    /// A rectangle from one corner to the other.
    pub fn rectangle(&mut self, class: &str, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) {
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]];
        self.line(class, corners.into_iter());
    }

    /// A dot with a word above it, or below where there is no room.
    pub fn dot(&mut self, class: &str, [x, y]: [f64; 2], text: &str) {
        let [.., top, _] = self.frame;
        let (at_x, at_y) = (self.at_x(x), self.at_y(y));
        let _ = write!(self.svg, "<circle class=\"{class}\" cx=\"{at_x:.1}\" cy=\"{at_y:.1}\" r=\"4\"/>");
        let text_y = if at_y - 8.0 < top + 12.0 { at_y + 17.0 } else { at_y - 8.0 };
        self.text(at_x, text_y, "middle", text);
    }

    /// A stretch of x, shaded, with a word at its top where there is room for it.
    pub fn stretch(&mut self, class: &str, from: f64, to: f64, text: &str) {
        let [.., top, bottom] = self.frame;
        let (start, end) = (self.at_x(from), self.at_x(to));
        let _ = write!(
            self.svg,
            "<rect class=\"{class}\" x=\"{start:.1}\" y=\"{top}\" width=\"{:.1}\" height=\"{:.1}\"/>",
            end - start,
            bottom - top
        );
        #[expect(clippy::cast_precision_loss, reason = "a word")]
        let width = text.chars().count() as f64 * 6.5;
        if width < end - start {
            self.text(0.5 * (start + end), top + 12.0, "middle", text);
        }
    }

    /// A short mark at the top.
    pub fn mark(&mut self, class: &str, x: f64) {
        let _ =
            write!(self.svg, "<rect class=\"{class}\" x=\"{:.1}\" y=\"0\" width=\"1.5\" height=\"5\"/>", self.at_x(x));
    }

    fn text(&mut self, x: f64, y: f64, anchor: &str, text: &str) {
        let (x, y) = (format!("{x:.1}"), format!("{y:.1}"));
        self.svg += &html! { text x=(x) y=(y) text-anchor=(anchor) { (text) } }.into_string();
    }

    pub fn into_svg(self) -> String {
        self.svg + "</svg>"
    }
}

/// Round numbers between two bounds, at most about `most` of them.
fn ticks(least: f64, greatest: f64, most: f64) -> impl Iterator<Item = f64> {
    let raw = (greatest - least) / most.max(1.0);
    let power = 10.0_f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * power).find(|step| *step >= raw).unwrap_or(raw);
    let first = (least / step).ceil();
    (0..1000).map(move |index| (first + f64::from(index)) * step).take_while(move |tick| *tick <= greatest)
}

/// A tick without the noise of binary fractions.
fn label(tick: f64) -> String {
    let text = format!("{tick:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(-0.93, 1.07, 5.0).map(label).collect::<Vec<_>>(), ["-0.5", "0", "0.5", "1"]);
        assert_eq!(ticks(0.0, 51.5, 10.0).map(label).collect::<Vec<_>>(), ["0", "10", "20", "30", "40", "50"]);
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
