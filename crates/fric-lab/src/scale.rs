//! Tells a sensor force on another scale than the reference, which no friction causes, and what of the set-up has that ratio.
//!
//! A wrong zero shifts the force, a wrong scale multiplies it. A reference that varies tells the two apart: the slope of the force over the
//! reference is between that of either by least squares, of which one is too low by the noise of the reference and the other too high by that of the
//! force.

use crate::text::significant;

/// Ratio, or its inverse, beyond which friction is not the reason. Five pulleys of μ = 0.05 that the model does not have change the force by up to 28 %
/// in one direction, and the other way in the other. The smallest ratio of another cause is 1.5, of a sensor pulley with a wrap of 120°.
const BEYOND_FRICTION: f64 = 1.3;
/// Least standard deviation of a reference, as a fraction of its mean, that tells a scale from a zero. Half and twice this fraction tell the same
/// for forces that a run changes; a load that hangs still varies by a hundredth.
const LEAST_VARIATION: f64 = 0.05;
/// Greatest relative difference of a ratio from that of its cause: the friction of a motion that goes more one way than the other, and that of a gain
/// beside which friction is known.
const OF_FORCES: f64 = 0.15;
const OF_GAIN: f64 = 0.02;

/// Ratio of the force by the sensor to the reference, with its usual cause.
const CAUSES: [(f64, &str); 8] = [
    (2.0, "a sensor that holds a pulley of 180°; give this pulley with `sensor = true` in the robot file"),
    (0.5, "a sensor in line with the cable, whose robot file has a pulley of 180° with `sensor = true`"),
    (1.0 / 9.80665, "a sensor in kilograms beside a reference in newtons; give both in newtons"),
    (9.80665, "a sensor in newtons beside a reference in kilograms; give both in newtons"),
    (1e3 / 9.80665, "a sensor in grams beside a reference in newtons; give both in newtons"),
    (9.80665e-3, "a sensor in newtons beside a reference in grams; give both in newtons"),
    (1e-3, "a sensor in kilonewtons beside a reference in newtons; give both in newtons"),
    (1e3, "a sensor in newtons beside a reference in kilonewtons; give both in newtons"),
];

/// Returns the usual cause of a gain of the sensor; `None` if there is none.
#[must_use]
pub(crate) fn cause_of_gain(gain: f64) -> Option<&'static str> {
    cause(gain, OF_GAIN)
}

fn cause(ratio: f64, most_off: f64) -> Option<&'static str> {
    if (ratio + 1.0).abs() < most_off {
        return Some("a reference of the other sign; tension is positive");
    }
    CAUSES.iter().find(|(of, _)| (ratio / of - 1.0).abs() < most_off).map(|(_, cause)| *cause)
}

/// Sums over a cable's samples that have a reference and a force by the sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Scale {
    count: f64,
    reference: Sums,
    /// Sums for the force without any correction, and with the model's.
    forces: [Sums; 2],
}

/// Sum and sum of squares of a force, and sum of its products with the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sums {
    sum: f64,
    squares: f64,
    products: f64,
}

impl Sums {
    fn add(&mut self, force_n: f64, reference_n: f64) {
        self.sum += force_n;
        self.squares += force_n * force_n;
        self.products += force_n * reference_n;
    }
}

impl Scale {
    /// Adds a sample: its reference, and the force at the platform by the sensor without any correction and with the model's.
    pub fn add(&mut self, reference_n: f64, forces_n: [f64; 2]) {
        if !(reference_n.is_finite() && forces_n.iter().all(|force_n| force_n.is_finite())) {
            return;
        }
        self.count += 1.0;
        self.reference.add(reference_n, reference_n);
        for (sums, force_n) in self.forces.iter_mut().zip(forces_n) {
            sums.add(force_n, reference_n);
        }
    }

    /// Returns the ratio of the force as it is to the reference, if neither it nor the corrected one has the reference's scale.
    fn ratio(&self) -> Option<f64> {
        let [shown, corrected] = self.forces.map(|force| self.ratio_of(&force));
        shown.filter(|_| corrected.is_some())
    }

    /// Returns the ratio of one of the forces; `None` for what friction may cause or, where the reference varies, a wrong zero.
    fn ratio_of(&self, force: &Sums) -> Option<f64> {
        let centred =
            |squares: f64, sum: f64, other: f64| squares / self.count - (sum / self.count) * (other / self.count);
        let variance = centred(self.reference.squares, self.reference.sum, self.reference.sum);
        let mean_n = self.reference.sum / self.count;
        let is_beyond = |ratio: &f64| !(1.0 / BEYOND_FRICTION..=BEYOND_FRICTION).contains(ratio) && ratio.is_finite();
        let varies = variance > (LEAST_VARIATION * mean_n).powi(2);
        if !varies {
            return Some(force.sum / self.reference.sum).filter(is_beyond);
        }
        let covariance = centred(force.products, force.sum, self.reference.sum);
        let slopes = [covariance / variance, centred(force.squares, force.sum, force.sum) / covariance];
        let is_alike = slopes.map(|slope| slope > 1.0) == [slopes[0] > 1.0; 2];
        (slopes.iter().all(is_beyond) && is_alike).then(|| slopes[0].signum() * (slopes[0] * slopes[1]).sqrt())
    }
}

/// Returns warnings about cables whose sensor is on another scale than the reference. Cables with the same cause share a line.
#[must_use]
pub(crate) fn warnings<'a>(cables: impl Iterator<Item = (&'a str, Scale)>) -> Vec<String> {
    type Group<'a> = (Option<&'static str>, Vec<&'a str>, [f64; 2]);
    let mut groups: Vec<Group<'a>> = Vec::new();
    for (name, ratio) in cables.filter_map(|(name, scale)| Some((name, scale.ratio()?))) {
        let cause = cause(ratio, OF_FORCES);
        match groups.iter_mut().find(|(other, ..)| *other == cause) {
            Some((_, names, [least, greatest])) => {
                names.push(name);
                (*least, *greatest) = (least.min(ratio), greatest.max(ratio));
            }
            None => groups.push((cause, vec![name], [ratio; 2])),
        }
    }
    let warning = |(cause, names, range): Group<'a>| {
        let [least, greatest] = range.map(significant);
        let ratio = if least == greatest { least } else { format!("{least} to {greatest}") };
        let likely = cause.map_or_else(
            || "look at zero, unit and calibration of both, and at the sensor's pulley".to_owned(),
            |cause| format!("the likely cause is {cause}"),
        );
        let names = names.join(", ");
        format!("{names}: the force by the sensor is {ratio} times the reference, more than friction makes: {likely}")
    };
    groups.into_iter().map(warning).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cause_fits_the_ratio() {
        for (ratio, words) in [
            (1.0 - 180.0_f64.to_radians().cos(), "a pulley of 180°; give"),
            (0.5, "in line with the cable, whose robot file has a pulley of 180°"),
            (1.0 / 9.80665, "a sensor in kilograms"),
            (9.80665, "a reference in kilograms"),
            (1000.0 / 9.80665, "a sensor in grams"),
            (1e-3, "a sensor in kilonewtons"),
            (-1.0, "the other sign"),
        ] {
            for near in [0.99, 1.01] {
                assert!(cause_of_gain(near * ratio).is_some_and(|cause| cause.contains(words)), "{ratio}");
            }
            assert!(cause(1.12 * ratio, OF_FORCES).is_some() && cause_of_gain(1.04 * ratio).is_none(), "{ratio}");
        }
        assert_eq!([0.8, 1.0, 1.22, 1.7, 4.0, -5.0].map(cause_of_gain), [None; 6]);
    }

    /// A load of 10 ± 3 N under friction of both directions. The force is what the sensor shows, and what a model makes of it.
    fn scale(shown: impl Fn(f64) -> f64, corrected: impl Fn(f64) -> f64, load: impl Fn(f64) -> f64) -> Scale {
        let mut scale = Scale::default();
        for sample in 0..5000 {
            let time_s = 0.01 * f64::from(sample);
            let rubbed_n = load(time_s) * (1.0 + 0.08 * (2.3 * time_s).sin().signum());
            scale.add(load(time_s), [shown(rubbed_n), corrected(rubbed_n)]);
        }
        scale
    }

    #[test]
    fn a_scale_is_told_from_friction_a_zero_and_what_the_model_has() {
        let (varied, steady) = (|time_s: f64| 10.0 + 3.0 * time_s.sin(), |time_s: f64| 10.0 + 0.05 * time_s.sin());
        let as_it_is = |force_n: f64| force_n;
        let double = |force_n: f64| 2.0 * force_n;
        let shifted = |force_n: f64| force_n + 20.0;
        assert_eq!(scale(as_it_is, as_it_is, varied).ratio(), None);
        assert_eq!(scale(shifted, shifted, varied).ratio(), None, "a zero");
        assert_eq!(scale(double, as_it_is, varied).ratio(), None, "the model has the gain");
        assert_eq!(scale(as_it_is, double, varied).ratio(), None, "the model is wrong by itself");
        assert_eq!(scale(double, as_it_is, steady).ratio(), None, "the model has the gain");
        let found = scale(double, double, steady).ratio().unwrap();
        assert!((found / 2.0 - 1.0).abs() < 0.1, "{found}");
        // The zero of a fitted model changes no slope.
        let found = scale(double, |force_n| 2.0 * force_n - 10.0, varied).ratio().unwrap();
        assert!((found / 2.0 - 1.0).abs() < 0.1, "{found}");
        let kilograms = |force_n: f64| force_n / 9.80665;
        let two = [("a", double), ("b", double)].map(|(name, shown)| (name, scale(shown, shown, varied)));
        let all = two.into_iter().chain([("c", scale(kilograms, kilograms, varied)), ("d", Scale::default())]);
        let told = warnings(all);
        assert!(told.len() == 2 && told[0].starts_with("a, b: ") && told[0].contains("180°"), "{told:?}");
        assert!(told[1].starts_with("c: ") && told[1].contains("a sensor in kilograms"), "{told:?}");
    }

    #[test]
    fn noise_of_a_reference_is_no_scale() {
        // The reference trembles by as much as it varies; the force does not.
        let mut scale = Scale::default();
        for sample in 0..5000_i32 {
            let load_n = 10.0 + (0.01 * f64::from(sample)).sin();
            let tremble_n = if sample % 2 == 0 { 1.0 } else { -1.0 };
            scale.add(load_n + tremble_n, [load_n, load_n]);
        }
        assert_eq!(scale.ratio(), None);
    }
}
