//! The exponential and the sum of lanes.

use fric_core::Lanes;
use fric_core::scalar::{Scalar, exp_negative};

use crate::random::Random;

/// The same operation on lanes and on one number.
type Both = (fn(Lanes, Lanes) -> Lanes, fn(f64, f64) -> f64);

/// Distance in units in the last place.
fn ulps(one: f64, other: f64) -> u64 {
    one.to_bits().abs_diff(other.to_bits())
}

#[test]
fn exponential_is_within_two_units_of_the_platforms() {
    let mut random = Random::new(31);
    let edges =
        [0.0, -0.0, -f64::MIN_POSITIVE, -1e-300, -1e-17, -1e-9, -0.5, -std::f64::consts::LN_2, -707.999, -708.0];
    let halves = (0..2044).map(|count| -0.5 * std::f64::consts::LN_2 * f64::from(count)).filter(|x| *x >= -708.0);
    let randoms: Vec<f64> = (0..400_000)
        .map(|index| if index % 2 == 0 { random.range(-708.0, 0.0) } else { -(10_f64.powf(random.range(-20.0, 2.85))) })
        .filter(|x| *x >= -708.0)
        .collect();
    let mut worst = 0;
    for x in edges.into_iter().chain(halves).chain(randoms) {
        let distance = ulps(exp_negative(x), x.exp());
        assert!(distance <= 2, "e^{x}: {distance} units");
        worst = worst.max(distance);
    }
    assert!(worst >= 1, "the reference is exact as well?");
}

#[test]
fn exponential_never_exceeds_one_nor_vanishes() {
    assert_eq!(exp_negative(0.0_f64).to_bits(), 1.0_f64.to_bits());
    for x in [-709.0, -745.0, -1e4, -1e300, f64::NEG_INFINITY, f64::NAN] {
        assert_eq!(exp_negative(x).to_bits(), exp_negative(-708.0_f64).to_bits());
    }
    let mut random = Random::new(32);
    for _ in 0..100_000 {
        assert!(exp_negative(-(10_f64.powf(random.range(-30.0, 0.0)))) <= 1.0);
    }
}

#[test]
fn lanes_carry_the_bits_of_plain_numbers() {
    use fric_core::scalar::Scalar;
    let mut random = Random::new(33);
    for _ in 0..20_000 {
        let mut draw = || [(); 4].map(|()| f64::from_bits(random.bits()));
        let (a, b) = (draw(), draw());
        let (lanes_a, lanes_b) = (Lanes::new(a), Lanes::new(b));
        let operations: [Both; 10] = [
            (|a, b| a + b, |a, b| a + b),
            (|a, b| a - b, |a, b| a - b),
            (|a, b| a * b, |a, b| a * b),
            (|a, b| a / b, |a, b| a / b),
            (|a, _| -a, |a, _| -a),
            (|a, _| Scalar::abs(a), |a, _| Scalar::abs(a)),
            (|a, _| Scalar::abs(a).sqrt(), |a, _| Scalar::sqrt(Scalar::abs(a))),
            (|a, _| a.sign(), |a, _| Scalar::sign(a)),
            (Scalar::max, Scalar::max),
            (Scalar::min, Scalar::min),
        ];
        for (index, (wide, plain)) in operations.iter().enumerate() {
            for (lane, (a, b)) in wide(lanes_a, lanes_b).to_array().into_iter().zip(a.into_iter().zip(b)) {
                let expected = plain(a, b);
                assert!(
                    lane.to_bits() == expected.to_bits() || lane.is_nan() && expected.is_nan(),
                    "operation {index} of {a:e}, {b:e}: {lane:e}, {expected:e}"
                );
            }
        }
        let negative = a.map(|value| -value.abs());
        for (lane, value) in Lanes::new(negative).exp_negative().to_array().into_iter().zip(negative) {
            assert_eq!(lane.to_bits(), exp_negative(value).to_bits());
        }
    }
}

/// Each function against the platform's, and the lanes against one number.
#[test]
fn functions_of_effects_are_the_platforms_to_rounding() {
    let mut random = Random::new(77);
    let mut numbers: Vec<f64> = vec![0.0, -0.0, 0.25, -0.25, 0.249, -0.999_999, 1e-300, -1e-300, 1e8, 1e300];
    numbers.extend((0..20_000).map(|_| random.range(-1.0, 3.0)));
    numbers.extend((0..20_000).map(|_| 10_f64.powf(random.range(-20.0, 20.0))));
    for x in numbers {
        let expected = if x == 0.0 { 1.0 } else { x.ln_1p() / x };
        assert!((x.ln_1p_ratio() / expected - 1.0).abs() < 4e-15, "ln(1 + x)/x at {x:e}");
        let lanes = Lanes::new([x, 0.0, 1.0, x]);
        assert_eq!(lanes.ln_1p_ratio().lane(3).to_bits(), x.ln_1p_ratio().to_bits());
        assert_eq!(lanes.sin_cos_turns().map(|part| part.lane(0).to_bits()), x.sin_cos_turns().map(f64::to_bits));
        // Whole turns are exact, so the platform's functions see the rest only.
        let turns = if x.abs() < 1e10 { x } else { continue };
        let angle = std::f64::consts::TAU * (turns - turns.round());
        let [sin, cos] = turns.sin_cos_turns();
        assert!((sin - angle.sin()).abs() < 1e-15 && (cos - angle.cos()).abs() < 1e-15, "{turns}");
    }
    assert_eq!(
        [0.0, 0.25, 0.5, -0.25, 7.75].map(|turns: f64| turns.sin_cos_turns()),
        [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0], [-1.0, 0.0]]
    );
    assert_eq!([1e-6_f64, 0.3, 1.0, 700.0].map(|base| Scalar::pow(base, 0.0)), [1.0; 4]);
    for (base, exponent) in [(1e-6_f64, 0.4), (3.0, -2.0), (700.0, 1.7)] {
        assert!((Scalar::pow(base, exponent) / base.powf(exponent) - 1.0).abs() < 1e-14);
    }
    // Where there is no logarithm.
    assert_eq!([-1.0_f64, -2.0, f64::NEG_INFINITY, f64::NAN].map(Scalar::ln_1p_ratio), [1e3; 4]);
}
