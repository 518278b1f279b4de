//! Detects a length of the wrong sign: friction then seems to drive the motion.
//!
//! Where a cable is paid out, friction leaves more force at the platform than the sensor shows, and less where it is reeled in; in proportion to the load,
//! or not. Each stroke is one observation, weighted by its length: the mean of reference minus sensor is regressed on the mean of the reference with the sign
//! of the motion, with a zero and a gain of the sensor beside it.

use crate::text::{listed, significant};

/// A reversal begins a new stroke only beyond this fraction of the range of lengths so far, so that noise of the length begins none. Half and twice of it
/// give the same result on simulated logs with noise of up to a six-hundredth of the range.
const LEAST_WAY_BACK: f64 = 0.01;
/// Least evidence for a slope: a difference of the Bayesian information criterion, with the degrees of freedom in place of the count, as the strokes are few.
/// Very strong on the scale of Kass and Raftery (1995).
const VERY_STRONG_BIC: f64 = 10.0;
/// Variance as a fraction of the squared mean below which a reference is constant but for rounding.
const ROUNDING: f64 = 1e-12;
/// Parameters of the regression: zero, gain and the slope.
const PARAMETERS: f64 = 3.0;

/// Sums over a cable's samples that have a length, a reference and a force by the sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Direction {
    way: Option<Way>,
    /// Sums over the way of the present stroke.
    stroke: [f64; VARIABLES],
    ended: Strokes,
}

/// The reference, the same with the sign of the motion, and the reference minus the sensor.
const VARIABLES: usize = 3;
const REFERENCE: usize = 0;
const DIRECTED: usize = 1;
const GAP: usize = 2;

/// Sums over strokes, each weighted by its length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Strokes {
    way_m: f64,
    squared_lengths_m2: f64,
    sums: [f64; VARIABLES],
    products: [[f64; VARIABLES]; VARIABLES],
}

impl Strokes {
    fn add(&mut self, length_m: f64, sums: &[f64; VARIABLES]) {
        if length_m == 0.0 {
            return;
        }
        self.way_m += length_m;
        self.squared_lengths_m2 += length_m * length_m;
        for (place, sum) in sums.iter().enumerate() {
            self.sums[place] += sum;
            for (other, product) in sums.iter().zip(&mut self.products[place]) {
                *product += sum * other / length_m;
            }
        }
    }

    /// Returns the number of strokes of equal length that tell as much.
    fn effective_count(&self) -> f64 {
        self.way_m * self.way_m / self.squared_lengths_m2
    }

    fn covariance(&self, one: usize, other: usize) -> f64 {
        self.products[one][other] / self.way_m - (self.sums[one] / self.way_m) * (self.sums[other] / self.way_m)
    }

    /// Returns a covariance without what the reference accounts for, which is a gain of the sensor.
    fn covariance_beside_gain(&self, one: usize, other: usize) -> f64 {
        let variance = self.covariance(REFERENCE, REFERENCE);
        let mean_n = self.sums[REFERENCE] / self.way_m;
        let by_gain = if variance > ROUNDING * mean_n * mean_n {
            self.covariance(one, REFERENCE) * self.covariance(REFERENCE, other) / variance
        } else {
            0.0
        };
        self.covariance(one, other) - by_gain
    }
}

/// The stroke that a cable is in.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way {
    /// 1 while the length grows, −1 while it shrinks, 0 before the first stroke.
    sign: f64,
    /// The furthest length of the stroke.
    furthest_m: f64,
    stroke_m: f64,
    /// Least and greatest length so far.
    extremes_m: [f64; 2],
}

impl Way {
    fn new(length_m: f64) -> Self {
        Self { sign: 0.0, furthest_m: length_m, stroke_m: 0.0, extremes_m: [length_m; 2] }
    }

    /// Goes to a length. Returns how far the stroke went on, and how long the last one was if it ended.
    fn go_to(&mut self, length_m: f64) -> (f64, Option<f64>) {
        let [least_m, greatest_m] = self.extremes_m;
        self.extremes_m = [least_m.min(length_m), greatest_m.max(length_m)];
        let onward_m = length_m - self.furthest_m;
        if onward_m * self.sign > 0.0 {
            self.furthest_m = length_m;
            self.stroke_m += onward_m.abs();
            return (onward_m.abs(), None);
        }
        let [least_m, greatest_m] = self.extremes_m;
        if onward_m.abs() <= LEAST_WAY_BACK * (greatest_m - least_m) {
            return (0.0, None);
        }
        let ended_m = std::mem::replace(&mut self.stroke_m, onward_m.abs());
        (self.sign, self.furthest_m) = (onward_m.signum(), length_m);
        (onward_m.abs(), Some(ended_m))
    }
}

impl Direction {
    /// Begins a log, or what follows a jump of the length: the stroke before it has ended.
    pub fn start(&mut self) {
        if let Some(way) = self.way.take() {
            self.ended.add(way.stroke_m, &std::mem::take(&mut self.stroke));
        }
    }

    /// Adds a sample: its length, its reference and the force at the platform by the sensor without friction. Returns the sign of the motion, 0 before the
    /// first and without a length.
    pub fn add(&mut self, length_m: f64, reference_n: f64, shown_n: f64) -> f64 {
        if !(length_m.is_finite() && reference_n.is_finite() && shown_n.is_finite()) {
            return 0.0;
        }
        let way = self.way.get_or_insert(Way::new(length_m));
        let (onward_m, ended_m) = way.go_to(length_m);
        if let Some(ended_m) = ended_m {
            self.ended.add(ended_m, &std::mem::take(&mut self.stroke));
        }
        let values = [reference_n, way.sign * reference_n, reference_n - shown_n];
        for (sum, value) in self.stroke.iter_mut().zip(values) {
            *sum += onward_m * value;
        }
        way.sign
    }

    /// Returns the friction as a fraction of the load, if it drives the motion by all evidence; it is negative then.
    fn driving_ratio(&self) -> Option<f64> {
        let mut strokes = self.ended;
        strokes.add(self.way.map_or(0.0, |way| way.stroke_m), &self.stroke);
        let [directed, gap, both] = [(DIRECTED, DIRECTED), (GAP, GAP), (DIRECTED, GAP)]
            .map(|(one, other)| strokes.covariance_beside_gain(one, other));
        let (count, ratio) = (strokes.effective_count(), both / directed);
        // Strokes of one direction alone do not tell friction from a gain: what of the directed reference is beside it, is rounding.
        let is_told = directed > ROUNDING * strokes.products[DIRECTED][DIRECTED] / strokes.way_m;
        if count < PARAMETERS + 1.0 || !is_told || ratio >= 0.0 {
            return None;
        }
        let unexplained_share = (1.0 - both * both / (directed * gap)).max(f64::EPSILON);
        let degrees = count - PARAMETERS;
        let delta_bic = degrees * unexplained_share.ln() + degrees.ln();
        (delta_bic < -VERY_STRONG_BIC).then_some(ratio)
    }
}

/// Returns a warning about the cables whose friction drives their motion; `None` without one.
pub(super) fn warning<'a>(cables: impl Iterator<Item = (&'a str, Direction)>) -> Option<String> {
    let driven = cables.filter_map(|(name, direction)| Some((name, direction.driving_ratio()?)));
    let (names, ratios): (Vec<&str>, Vec<f64>) = driven.unzip();
    let least = ratios.into_iter().reduce(f64::min)?;
    Some(format!(
        "{}: the sensor shows more than the reference while the length grows, and less while it shrinks, by up to {} % of the load, as if friction drove the \
         motion; the likely cause is a length of the wrong sign, or sensor and reference exchanged, or else a late reference under a load that goes with the length. The length has to grow while the cable is paid out: in a CSV file, the sign of the \
         `factor` of its column, and of its speed's, under `[log.columns]` turns it",
        listed(&names),
        significant(-100.0 * least)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A load that goes with the length, beside one that does not, on a cable that goes to and fro; friction of `mu` by the sign of `turned`.
    fn direction(mu: f64, turned: f64, tremble_m: f64, shown: impl Fn(f64, f64) -> f64) -> Option<f64> {
        let mut direction = Direction::default();
        for sample in 0..20_000_i32 {
            let angle = 0.003 * f64::from(sample);
            let load_n = 10.0 + 2.0 * angle.sin() + (0.31 * angle).sin();
            let rubbed_n = load_n * (1.0 - mu * angle.cos().signum());
            let length_m = turned * 0.3 * angle.sin() + if sample % 2 == 0 { tremble_m } else { -tremble_m };
            direction.add(length_m, load_n, shown(rubbed_n, f64::from(sample)));
        }
        direction.driving_ratio()
    }

    #[test]
    fn friction_drives_only_a_length_of_the_wrong_sign() {
        for tremble_m in [0.0, 3e-5, 1e-3] {
            for mu in [0.02, 0.08] {
                let found = direction(mu, -1.0, tremble_m, |force_n, _| force_n).unwrap();
                assert!((found / mu + 1.0).abs() < 0.1, "{mu}, {tremble_m} m: {found}");
                assert_eq!(direction(mu, 1.0, tremble_m, |force_n, _| force_n), None, "{mu}, {tremble_m} m");
            }
            // Gain, zero and drift of the sensor are no friction.
            for turned in [1.0, -1.0] {
                let found = direction(0.0, turned, tremble_m, |force_n, _| 1.2 * force_n - 3.0);
                assert_eq!(found, None, "{turned}, {tremble_m} m");
                let found = direction(0.0, turned, tremble_m, |force_n, sample| force_n + 1e-4 * sample);
                assert_eq!(found, None, "{turned}, {tremble_m} m");
            }
        }
    }

    #[test]
    fn a_constant_reference_and_what_is_missing() {
        let told = |count: i32| {
            let mut direction = Direction::default();
            for sample in 0..count {
                let angle = 0.01 * f64::from(sample);
                let force_n = 1000.0 / 3.0 * (1.0 - 0.05 * angle.cos().signum() + 1e-3 * (37.0 * angle).sin());
                direction.add(-angle.sin(), 1000.0 / 3.0, force_n);
                direction.add(f64::NAN, 1.0, force_n);
                direction.add(1.0, f64::NAN, force_n);
            }
            warning([("winch", direction)].into_iter())
        };
        assert!(
            told(6000).is_some_and(|told| told.starts_with("winch: ") && told.contains("by up to 5 % of the load"))
        );
        // Two strokes and a half may be chance.
        assert_eq!(told(1000), None);
        assert_eq!(warning([("still", Direction::default())].into_iter()), None);
    }

    /// Six winds of one cable, each paid out and reset: friction and a gain of the sensor are the same there.
    #[test]
    fn motion_in_one_direction_tells_nothing() {
        for (swing_n, friction) in [(2.0, 0.03), (2.0, -0.03), (0.0, 0.03)] {
            let mut direction = Direction::default();
            for wind in 0..6 {
                direction.start();
                for sample in 0..1000 {
                    let angle = 0.01 * f64::from(sample);
                    let load_n = 10.0 + swing_n * (angle + f64::from(wind)).sin();
                    direction.add(
                        1e-3 * f64::from(sample),
                        load_n,
                        load_n * (1.0 - friction) + 0.01 * (37.0 * angle).sin(),
                    );
                }
            }
            assert_eq!(direction.driving_ratio(), None, "{swing_n}, {friction}");
        }
    }

    /// A log that begins elsewhere ends a stroke and begins another; the step between them is no motion.
    #[test]
    fn logs_follow_one_another() {
        let mut direction = Direction::default();
        for (log, from_m) in [0.0, 5.0, -3.0].into_iter().enumerate() {
            direction.start();
            for sample in 0..1500 {
                let angle = 0.01 * f64::from(sample);
                let load_n = 20.0 + f64::from(u8::try_from(log).unwrap());
                let force_n = load_n * (1.0 + 0.03 * angle.cos().signum() + 1e-3 * (37.0 * angle).sin());
                direction.add(from_m + angle.sin(), load_n, force_n);
            }
        }
        let found = direction.driving_ratio().unwrap();
        assert!((found / 0.03 + 1.0).abs() < 0.1, "{found}");
    }
}
