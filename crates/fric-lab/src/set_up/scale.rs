//! Tells a sensor force on another scale than the reference, which no friction causes, and what of the set-up has that ratio.
//!
//! A wrong scale multiplies the force: its mean and its slope over the reference. A wrong zero changes only the mean. Friction changes only the slope, if
//! the load goes with the direction of the motion. The slope is between that of either by least squares, of which one is too low by the noise of the
//! reference and the other too high by that of the force.

use crate::text::significant;

/// Ratio, or its inverse, beyond which friction is not the reason. Five pulleys of μ = 0.05 that the model does not have change the force by up to 28 %
/// in one direction, and the other way in the other. The smallest ratio of another cause is 1.5, of a sensor pulley with a wrap of 120°.
const BEYOND_FRICTION: f64 = 1.3;
/// Least standard deviation of a reference, as a fraction of its mean, that tells a scale from a zero. Half and twice this fraction tell the same
/// for forces that a run changes; a load that hangs still varies by a hundredth.
const LEAST_VARIATION: f64 = 0.05;
/// Greatest ratio of the changes' scale to that of the means that are of one scale. A zero of half the force makes 1.5; half and twice the difference
/// tell the same of 150 logs of sound and of wrong sensors.
const MOST_APART: f64 = 1.5;
/// Greatest relative difference of a ratio from that of its cause: the friction of a motion that goes more one way than the other, and that of a gain
/// beside which friction is known.
const OF_FORCES: f64 = 0.15;
const OF_GAIN: f64 = 0.02;

/// Ratio of the force by the sensor to the reference, with its usual cause.
const CAUSES: [(f64, &str); 8] = [
    (1.0 / 9.80665, "a sensor in kilograms beside a reference in newtons; give both in newtons"),
    (9.80665, "a sensor in newtons beside a reference in kilograms; give both in newtons"),
    (1e3 / 9.80665, "a sensor in grams beside a reference in newtons; give both in newtons"),
    (9.80665e-3, "a sensor in newtons beside a reference in grams; give both in newtons"),
    (1.0 / 4.448_221_6, "a sensor in pounds beside a reference in newtons; give both in newtons"),
    (4.448_221_6, "a sensor in newtons beside a reference in pounds; give both in newtons"),
    (1e-3, "a sensor in kilonewtons beside a reference in newtons; give both in newtons"),
    (1e3, "a sensor in newtons beside a reference in kilonewtons; give both in newtons"),
];
const PULLEY_MISSING: &str =
    "a sensor that holds a pulley of 180°; give this pulley with `sensor = true` in the robot file";
const PULLEY_TOO_MANY: &str =
    "a sensor in line with the cable, whose robot file has a pulley of 180° with `sensor = true`";

const EXCHANGED: &str = "sensor and reference exchanged, of which one holds a pulley and the other is in line";

/// Returns the usual cause of a gain of the sensor; `None` if there is none.
#[must_use]
pub(crate) fn cause_of_gain(gain: f64) -> Option<&'static str> {
    let of_pulley = [(2.0, PULLEY_MISSING), (0.5, PULLEY_TOO_MANY)];
    nearest(&of_pulley, gain, OF_GAIN).or_else(|| cause(gain, OF_GAIN))
}

fn cause(ratio: f64, most_off: f64) -> Option<&'static str> {
    if (ratio + 1.0).abs() < most_off {
        return Some("a sensor or reference of the other sign; tension is positive");
    }
    nearest(&CAUSES, ratio, most_off)
}

fn nearest(causes: &[(f64, &'static str)], ratio: f64, most_off: f64) -> Option<&'static str> {
    let off = |(of, _): &&(f64, &str)| (ratio / of - 1.0).abs();
    let nearest = causes.iter().min_by(|one, other| off(one).total_cmp(&off(other)))?;
    (off(&nearest) < most_off).then_some(nearest.1)
}

/// Sums over a cable's samples that have a reference and a force by the sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Scale {
    /// Force at the platform per force of the sensor without friction: below 1 if the sensor holds a pulley.
    frictionless_gain: f64,
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
    /// Creates empty sums for a cable whose sensor has this frictionless gain.
    pub fn new(frictionless_gain: f64) -> Self {
        Self { frictionless_gain, ..Self::default() }
    }

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

    /// Returns the ratio of the mean force to the mean reference, if, where the reference varies, that of the changes is alike, and if the model's correction
    /// does not make up for it.
    pub fn ratio(&self) -> Option<f64> {
        let [shown, corrected] = &self.forces;
        let of_means = Some(shown.sum / self.reference.sum).filter(|ratio| is_beyond_friction(*ratio))?;
        if !self.varies() {
            return is_beyond_friction(corrected.sum / self.reference.sum).then_some(of_means);
        }
        // A fit may bend the force of a wrong scale in any way, but only the right scale brings both slopes near 1.
        if !self.slopes(corrected).into_iter().any(is_beyond_friction) {
            return None;
        }
        let slope = self.slope(shown)?;
        (MOST_APART.recip()..MOST_APART).contains(&(slope / of_means)).then_some(of_means)
    }

    fn varies(&self) -> bool {
        let mean_n = self.reference.sum / self.count;
        self.variance() > (LEAST_VARIATION * mean_n).powi(2)
    }

    fn variance(&self) -> f64 {
        self.centred(self.reference.squares, self.reference.sum, self.reference.sum)
    }

    /// Returns the mean product of two numbers about their means.
    fn centred(&self, products: f64, one: f64, other: f64) -> f64 {
        products / self.count - (one / self.count) * (other / self.count)
    }

    /// Returns the slope of a force over the reference, by least squares of either.
    fn slopes(&self, force: &Sums) -> [f64; 2] {
        let covariance = self.centred(force.products, force.sum, self.reference.sum);
        [covariance / self.variance(), self.centred(force.squares, force.sum, force.sum) / covariance]
    }

    /// Returns the slope of a force over the reference; `None` if it may be that of the same scale.
    fn slope(&self, force: &Sums) -> Option<f64> {
        let slopes = self.slopes(force);
        let is_alike = slopes.map(|slope| slope > 1.0) == [slopes[0] > 1.0; 2];
        let are_beyond = slopes.iter().all(|slope| is_beyond_friction(*slope)) && is_alike;
        are_beyond.then(|| slopes[0].signum() * (slopes[0] * slopes[1]).sqrt())
    }

    fn cause(&self, ratio: f64) -> Option<&'static str> {
        let gain = self.frictionless_gain;
        let of_pulley = if gain < 1.0 { (0.5, PULLEY_TOO_MANY) } else { (2.0, PULLEY_MISSING) };
        // The sensor's column has the force at the platform, and the reference the force divided by the gain.
        let exchanged = (is_beyond_friction(gain * gain)).then_some((gain * gain, EXCHANGED));
        let own: Vec<(f64, &'static str)> = exchanged.into_iter().chain([of_pulley]).chain(CAUSES).collect();
        nearest(&own, ratio, OF_FORCES).or_else(|| cause(ratio, OF_FORCES))
    }
}

fn is_beyond_friction(ratio: f64) -> bool {
    !(1.0 / BEYOND_FRICTION..=BEYOND_FRICTION).contains(&ratio) && ratio.is_finite()
}

/// Returns warnings about cables whose sensor is on another scale than the reference. Cables with the same cause share a line.
#[must_use]
pub(crate) fn warnings<'a>(cables: impl Iterator<Item = (&'a str, Scale)>) -> Vec<String> {
    type Group<'a> = ((Option<&'static str>, bool), Vec<&'a str>, [f64; 2]);
    let mut groups: Vec<Group<'a>> = Vec::new();
    for (name, scale) in cables {
        let Some(ratio) = scale.ratio() else { continue };
        let cause = (scale.cause(ratio), scale.varies());
        match groups.iter_mut().find(|(other, ..)| *other == cause) {
            Some((_, names, [least, greatest])) => {
                names.push(name);
                (*least, *greatest) = (least.min(ratio), greatest.max(ratio));
            }
            None => groups.push((cause, vec![name], [ratio; 2])),
        }
    }
    let warning = |((cause, varies), names, range): Group<'a>| {
        let [least, greatest] = range.map(significant);
        let ratio = if least == greatest { least } else { format!("{least} to {greatest}") };
        let likely = cause.map_or_else(
            || "look at zero, unit and calibration of both, and at the sensor's pulley".to_owned(),
            |cause| format!("the likely cause is {cause}"),
        );
        let zero =
            if varies { "" } else { "; it may be its zero as well, from which a load that stays does not tell it" };
        let names = names.join(", ");
        format!(
            "{names}: the force by the sensor is {ratio} times the reference, more than friction makes: {likely}{zero}"
        )
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
            (1.0 / 4.448_221_6, "a sensor in pounds beside a reference in newtons; give both in newtons"),
            (4.448_221_6, "a sensor in newtons beside a reference in pounds; give both in newtons"),
            (1e-3, "a sensor in kilonewtons"),
            (-1.0, "the other sign"),
        ] {
            for near in [0.99, 1.01] {
                assert!(cause_of_gain(near * ratio).is_some_and(|cause| cause.contains(words)), "{ratio}");
            }
            assert!(cause_of_gain(1.04 * ratio).is_none(), "{ratio}");
        }
        assert_eq!([0.8, 1.0, 1.22, 1.7, 4.0, -5.0].map(cause_of_gain), [None; 6]);
        // Only what the robot file has can be too much, and what it lacks missing.
        let [without, with] = [1.0, 0.5].map(Scale::new);
        assert_eq!([without.cause(1.9), with.cause(1.9)], [Some(PULLEY_MISSING), None]);
        assert_eq!([without.cause(0.52), with.cause(0.52)], [None, Some(PULLEY_TOO_MANY)]);
        // A quarter is what an exchange makes of a sensor that holds a pulley of 180°, and nearer to that than to pounds.
        assert_eq!(
            [without.cause(0.25), with.cause(0.25)].map(|cause| cause.map(|it| it.contains("pounds"))),
            [Some(true), Some(false)]
        );
        assert_eq!(with.cause(0.25), Some(EXCHANGED));
        assert!(with.cause(0.225).is_some_and(|cause| cause.contains("pounds")));
    }

    /// A load of 10 N that varies with the motion, under friction of `mu` in both directions. `shown` is what the sensor makes of the force, and
    /// `corrected` the model.
    fn scale(
        shown: impl Fn(f64) -> f64,
        corrected: impl Fn(f64) -> f64,
        (swing_n, phase): (f64, f64),
        mu: f64,
    ) -> Scale {
        let mut scale = Scale::new(1.0);
        for sample in 0..5000 {
            let angle = 0.01 * f64::from(sample);
            let load_n = 10.0 + swing_n * (angle + phase).sin();
            let rubbed_n = load_n * (1.0 + mu * angle.sin().signum());
            scale.add(load_n, [shown(rubbed_n), corrected(rubbed_n)]);
        }
        scale
    }

    const VARIED: (f64, f64) = (3.0, 1.0);
    const STEADY: (f64, f64) = (0.05, 1.0);

    fn as_it_is(force_n: f64) -> f64 {
        force_n
    }

    fn double(force_n: f64) -> f64 {
        2.0 * force_n
    }

    fn shifted(force_n: f64) -> f64 {
        force_n + 20.0
    }

    #[test]
    fn a_scale_is_told_from_friction_a_zero_and_what_the_model_has() {
        assert_eq!(scale(as_it_is, as_it_is, VARIED, 0.08).ratio(), None);
        assert_eq!(scale(shifted, shifted, VARIED, 0.08).ratio(), None, "a zero");
        assert_eq!(scale(double, as_it_is, VARIED, 0.08).ratio(), None, "the model has the gain");
        assert_eq!(scale(as_it_is, double, VARIED, 0.08).ratio(), None, "the model is wrong by itself");
        assert_eq!(scale(double, as_it_is, STEADY, 0.08).ratio(), None, "the model has the gain");
        // Friction of 2 % in phase with a load of ± 30 % changes the slope by up to 8 %.
        for found in [scale(double, double, VARIED, 0.02).ratio(), scale(double, double, STEADY, 0.02).ratio()] {
            assert!(found.is_some_and(|found| (found / 2.0 - 1.0).abs() < 0.1), "{found:?}");
        }
        // The zero of a fitted model changes no slope.
        let found = scale(double, |force_n| 2.0 * force_n - 10.0, VARIED, 0.02).ratio().unwrap();
        assert!((found / 2.0 - 1.0).abs() < 0.1, "{found}");
        // A fit to kilonewtons may have friction that makes up for a part of it.
        let bent = |force_n: f64| 1e-3 * force_n + 0.5 + 0.4 * (7.0 * force_n).sin();
        let found = scale(|force_n| 1e-3 * force_n, bent, VARIED, 0.02).ratio().unwrap();
        assert!((found / 1e-3 - 1.0).abs() < 0.1, "{found}");
        let kilograms = |force_n: f64| force_n / 9.80665;
        let two = ["a", "b"].map(|name| (name, scale(double, double, VARIED, 0.08)));
        let told = warnings(
            two.into_iter().chain([("c", scale(kilograms, kilograms, VARIED, 0.08)), ("d", Scale::default())]),
        );
        assert!(told.len() == 2 && told[0].starts_with("a, b: ") && told[0].contains("180°"), "{told:?}");
        assert!(told[1].starts_with("c: ") && told[1].contains("a sensor in kilograms"), "{told:?}");
    }

    /// Where the load goes with the direction of the motion, friction changes the slope as a scale does.
    #[test]
    fn friction_in_phase_with_the_load_is_no_scale() {
        for phase in [0.0, 0.5, 1.6, 3.1, 4.7] {
            for swing_n in [0.6, 1.0, 3.0] {
                let found = scale(as_it_is, |force_n| 1.1 * force_n - 1.0, (swing_n, phase), 0.2).ratio();
                assert_eq!(found, None, "{swing_n} N, {phase} rad");
            }
        }
    }

    #[test]
    fn noise_of_a_reference_is_no_scale() {
        // The reference trembles by as much as it varies; the force does not.
        let mut scale = Scale::new(1.0);
        for sample in 0..5000_i32 {
            let load_n = 10.0 + (0.01 * f64::from(sample)).sin();
            let tremble_n = if sample % 2 == 0 { 1.0 } else { -1.0 };
            scale.add(load_n + tremble_n, [load_n, load_n]);
        }
        assert_eq!(scale.ratio(), None);
    }
}
