//! References at other times, interpolated between the samples of their log.

use crate::fit::CableRecord;

/// A gap is longer than this many usual intervals, as where the signals of a log are joined.
const GAP_RATIO: f64 = 10.0;

/// The time error of a reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    /// Delay at the first sample, s.
    pub delay_s: f64,
    /// Growth of the delay per second, dimensionless.
    pub skew: f64,
}

/// Returns the references interpolated from later samples; NaN past the ends of each log. Each value gets the same part of the samples' noise: a line
/// does this for a delay, which falls at one place between two regular samples, and a quadratic B-spline nearly does for a skew, which wanders from one
/// sample to the next. With a line what is left would be loud wherever the skew falls on a sample.
pub fn shifted(record: &CableRecord<'_>, shift: Shift) -> Vec<f64> {
    let mut references_n = record.references_n.to_vec();
    for (start, log) in record.logs() {
        let given_n = record.references_n.get(start..start + log.len()).unwrap_or_default();
        let times_s: Vec<f64> = (start..start + log.len()).map(|place| record.time_s(place)).collect();
        let first_s = times_s.first().copied().unwrap_or(0.0);
        let mut of_log = references_n.iter_mut().skip(start);
        let mut given_n = given_n.iter().as_slice();
        // Where a clock was set back the times begin anew.
        for times_s in times_s.chunk_by(|one, next| one <= next) {
            let (of_stretch, rest) = given_n.split_at(times_s.len());
            given_n = rest;
            let mut knots = Knots { times_s, given_n: of_stretch, longest_s: GAP_RATIO * record.interval_s, before: 0 };
            for (time_s, reference_n) in times_s.iter().zip(&mut of_log) {
                let later_s = time_s + shift.delay_s + shift.skew * (time_s - first_s);
                *reference_n = if shift.skew == 0.0 { knots.on_line(later_s) } else { knots.on_spline(later_s) };
            }
        }
    }
    references_n
}

/// The references of a stretch of a log and their times, which do not decrease.
struct Knots<'a> {
    times_s: &'a [f64],
    given_n: &'a [f64],
    /// Nothing is interpolated between samples that are further apart, s.
    longest_s: f64,
    /// The place that was found last, from which the next one is sought.
    before: usize,
}

impl Knots<'_> {
    /// Returns the last sample that is not later than a time, and how far that is on the way to the next one, 0 to 1; `None` before the first sample, after
    /// the last, and in gaps.
    fn place(&mut self, time_s: f64) -> Option<(usize, f64)> {
        let is_past = |place: usize| self.times_s.get(place).is_some_and(|knot_s| *knot_s <= time_s);
        while self.before > 0 && !is_past(self.before) {
            self.before -= 1;
        }
        while is_past(self.before + 1) {
            self.before += 1;
        }
        let (before, at_s) = (self.before, *self.times_s.get(self.before).filter(|at_s| **at_s <= time_s)?);
        match self.times_s.get(before + 1) {
            Some(next_s) if next_s - at_s <= self.longest_s => Some((before, (time_s - at_s) / (next_s - at_s))),
            _ => (time_s - at_s <= 0.0).then_some((before, 0.0)),
        }
    }

    /// Interpolates linearly.
    fn on_line(&mut self, time_s: f64) -> f64 {
        let Some((before, share)) = self.place(time_s) else { return f64::NAN };
        let given_n = |place: usize| self.given_n.get(place).copied().unwrap_or(f64::NAN);
        let before_n = given_n(before);
        if share > 0.0 { before_n + share * (given_n(before + 1) - before_n) } else { before_n }
    }

    /// Weighs three samples by a quadratic B-spline. It leaves 0.50 to 0.59 of the variance of white noise. If the samples are not regular, their mean time
    /// is another, and the slope between them makes up for it.
    fn on_spline(&mut self, time_s: f64) -> f64 {
        let Some((before, share)) = self.place(time_s) else { return f64::NAN };
        let (nearest, off) = if share < 0.5 { (before, share) } else { (before + 1, share - 1.0) };
        let around = nearest.checked_sub(1).map(|first| first..first + 3);
        let [Some([first_n, middle_n, last_n]), Some([first_s, middle_s, last_s])] = [self.given_n, self.times_s]
            .map(|all| around.clone().and_then(|around| all.get(around)?.first_chunk::<3>().copied()))
        else {
            return f64::NAN;
        };
        let weights = [0.5 * (0.5 - off).powi(2), 0.75 - off * off, 0.5 * (0.5 + off).powi(2)];
        let mean = |values: [f64; 3]| weights.iter().zip(values).map(|(weight, value)| weight * value).sum::<f64>();
        if last_s - first_s > 2.0 * self.longest_s {
            return f64::NAN;
        }
        let slope = (last_n - first_n) / (last_s - first_s);
        mean([first_n, middle_n, last_n]) + slope * (time_s - mean([first_s, middle_s, last_s]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The times of regular samples, and of others.
    fn times_s() -> [Vec<f64>; 2] {
        let off = |place: u32| 0.35 * (f64::from(place) * 2.4).sin();
        [(0..24).map(f64::from).collect(), (0..24).map(|place| f64::from(place) + off(place)).collect()]
    }

    #[test]
    fn a_spline_keeps_lines_and_leaves_alike_much_noise_everywhere() {
        for (times_s, is_regular) in times_s().into_iter().zip([true, false]) {
            let given_n: Vec<f64> = times_s.iter().map(|time_s| 3.0 - 0.7 * time_s).collect();
            for percent in 0..200_i32 {
                let at_s = 10.0 + f64::from(percent) / 100.0;
                let mut knots = Knots { times_s: &times_s, given_n: &given_n, longest_s: 10.0, before: 0 };
                assert!((knots.on_spline(at_s) - (3.0 - 0.7 * at_s)).abs() < 1e-12);
                assert!((knots.on_line(at_s) - (3.0 - 0.7 * at_s)).abs() < 1e-12);
                // The response to a single sample is its weight.
                let weight = |of: usize| {
                    let given_n: Vec<f64> = (0..24).map(|place| if place == of { 1.0 } else { 0.0 }).collect();
                    Knots { times_s: &times_s, given_n: &given_n, longest_s: 10.0, before: 3 }.on_spline(at_s)
                };
                let variance: f64 = (7..15).map(|place| weight(place).powi(2)).sum();
                assert!(!is_regular || (0.5..0.595).contains(&variance), "{variance} at {at_s}");
            }
        }
    }

    #[test]
    fn past_the_ends_nothing_is_known() {
        for times_s in times_s() {
            let mut knots = Knots { times_s: &times_s, given_n: &times_s, longest_s: 10.0, before: 20 };
            let [first_s, last_s] = [times_s[0], times_s[23]];
            assert!([first_s, last_s].into_iter().all(|end_s| (knots.on_line(end_s) - end_s).abs() < 1e-12));
            for beyond_s in [first_s - 0.01, last_s + 0.01] {
                assert!(knots.on_line(beyond_s).is_nan() && knots.on_spline(beyond_s).is_nan());
            }
        }
    }

    #[test]
    fn nothing_is_known_in_a_pause() {
        let times_s = [0.0, 1.0, 2.0, 60.0, 61.0, 62.0];
        let mut knots = Knots { times_s: &times_s, given_n: &times_s, longest_s: 10.0, before: 0 };
        let known = [1.5, 2.0, 2.5, 59.0, 60.0, 60.5].map(|time_s| knots.on_line(time_s).is_finite());
        assert_eq!(known, [true, true, false, false, true, true]);
        assert!(knots.on_spline(2.2).is_nan() && knots.on_spline(1.2).is_finite());
    }
}
