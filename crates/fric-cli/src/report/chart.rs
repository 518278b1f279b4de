//! A chart of extents over time as SVG text. Only numbers made here are in it, nothing of a file.

use std::fmt::Write as _;

use super::series::{Extent, Series};

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 200.0;
const LEFT: f64 = 52.0;
const RIGHT: f64 = 8.0;
const TOP: f64 = 8.0;
const BOTTOM: f64 = 24.0;

/// Deviations of a cable before and after compensation; `None` where there are none.
pub fn deviations(series: &Series, cable: usize) -> Option<String> {
    let mut all = Extent { least: 0.0, greatest: 0.0 };
    let mut any = false;
    for (_, interval) in series.of_cable(cable) {
        for extent in [interval.before_n, interval.after_n] {
            if extent.is_something() {
                any = true;
                all.least = all.least.min(extent.least);
                all.greatest = all.greatest.max(extent.greatest);
            }
        }
    }
    if !any {
        return None;
    }
    let margin = ((all.greatest - all.least) * 0.05).max(1e-9);
    let (least, greatest) = (all.least - margin, all.greatest + margin);
    let end_s = series.end_s().max(1e-9);
    let x = |time_s: f64| LEFT + time_s / end_s * (WIDTH - LEFT - RIGHT);
    let y = |force_n: f64| TOP + (greatest - force_n) / (greatest - least) * (HEIGHT - TOP - BOTTOM);

    let mut svg = format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\">");
    for tick in ticks(least, greatest, 5) {
        let at = y(tick);
        // Writing to a String cannot fail, here and below.
        let _ = write!(
            svg,
            "<path class=\"axis\" d=\"M{LEFT} {at:.1}H{:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            WIDTH - RIGHT,
            LEFT - 6.0,
            at + 4.0,
            label(tick)
        );
    }
    for tick in ticks(0.0, end_s, 10) {
        let _ = write!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            x(tick),
            HEIGHT - 6.0,
            label(tick)
        );
    }
    let _ = write!(
        svg,
        "<text x=\"4\" y=\"{:.1}\">N</text><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">s</text>",
        TOP + 8.0,
        WIDTH - 2.0,
        HEIGHT - 6.0
    );
    let band = |pick: fn(&super::series::Interval) -> Extent| {
        let intervals = series.of_cable(cable);
        let bars =
            intervals.map(|(start_s, interval)| (start_s, pick(&interval))).filter(|(_, extent)| extent.is_something());
        bars.fold(String::new(), |mut path, (start_s, extent)| {
            let _ = write!(path, "M{:.1} {:.1}V{:.1}", x(start_s), y(extent.greatest), y(extent.least) + 0.5);
            path
        })
    };
    let _ = write!(svg, "<path class=\"before\" d=\"{}\"/>", band(|interval| interval.before_n));
    let _ = write!(svg, "<path class=\"after\" d=\"{}\"/>", band(|interval| interval.after_n));
    for (start_s, _) in series.of_cable(cable).filter(|(_, interval)| interval.is_flagged) {
        let _ = write!(svg, "<rect class=\"flag\" x=\"{:.1}\" y=\"0\" width=\"1.5\" height=\"5\"/>", x(start_s));
    }
    svg += "</svg>";
    Some(svg)
}

/// Round numbers between two bounds, about `count` of them.
fn ticks(least: f64, greatest: f64, count: u32) -> impl Iterator<Item = f64> {
    let raw = (greatest - least) / f64::from(count);
    let power = 10.0_f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * power).find(|step| *step >= raw).unwrap_or(raw);
    let first = (least / step).ceil();
    (0..=4 * count).map(move |index| (first + f64::from(index)) * step).take_while(move |tick| *tick <= greatest)
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
        assert_eq!(ticks(-0.93, 1.07, 5).map(label).collect::<Vec<_>>(), ["-0.5", "0", "0.5", "1"]);
        assert_eq!(ticks(0.0, 51.5, 10).map(label).collect::<Vec<_>>(), ["0", "10", "20", "30", "40", "50"]);
    }
}
