//! What makes a force differ from the reference by a factor.

/// Ratio, or its inverse, beyond which friction is not the reason. Five pulleys of μ = 0.05 that the model does not have change the force by up to 28 %
/// in one direction, and the other way in the other. The smallest ratio of another cause is 1.5, of a sensor pulley with a wrap of 120°.
pub(super) const BEYOND_FRICTION: f64 = 1.3;
/// Greatest relative difference of a ratio from that of its cause: the friction of a motion that goes more one way than the other, and that of a gain
/// beside which friction is known.
const OF_FORCES: f64 = 0.15;
const OF_GAIN: f64 = 0.02;
/// The same of the changes: as far as friction goes.
const OF_CHANGES: f64 = 0.3;

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

/// Returns the usual cause of a ratio of mean forces, of a sensor with this frictionless gain.
pub(super) fn of_level(frictionless_gain: f64, ratio: f64) -> Option<&'static str> {
    let gain = frictionless_gain;
    let of_pulley = if gain < 1.0 { (0.5, PULLEY_TOO_MANY) } else { (2.0, PULLEY_MISSING) };
    // The sensor's column has the force at the platform, and the reference the force divided by the gain.
    let exchanged = (is_beyond_friction(gain * gain)).then_some((gain * gain, EXCHANGED));
    let own: Vec<(f64, &'static str)> = exchanged.into_iter().chain([of_pulley]).chain(CAUSES).collect();
    nearest(&own, ratio, OF_FORCES).or_else(|| cause(ratio, OF_FORCES))
}

/// Returns the usual cause of a ratio of changes: a unit or a sign.
pub(super) fn of_changes(ratio: f64) -> Option<&'static str> {
    cause(ratio, OF_CHANGES)
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

/// Whether a ratio is more than friction makes.
pub(super) fn is_beyond_friction(ratio: f64) -> bool {
    !(1.0 / BEYOND_FRICTION..=BEYOND_FRICTION).contains(&ratio) && ratio.is_finite()
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
        let without = |ratio| of_level(1.0, ratio);
        let with = |ratio| of_level(0.5, ratio);
        assert_eq!([without(1.9), with(1.9)], [Some(PULLEY_MISSING), None]);
        assert_eq!([without(0.52), with(0.52)], [None, Some(PULLEY_TOO_MANY)]);
        // A quarter is what an exchange makes of a sensor that holds a pulley of 180°, and nearer to that than to pounds.
        assert_eq!(
            [without(0.25), with(0.25)].map(|cause| cause.map(|it| it.contains("pounds"))),
            [Some(true), Some(false)]
        );
        assert_eq!(with(0.25), Some(EXCHANGED));
        assert!(with(0.225).is_some_and(|cause| cause.contains("pounds")));
    }
}
