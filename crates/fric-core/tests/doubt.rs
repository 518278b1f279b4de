//! How long a doubt about stored friction lasts, cycle by cycle, against the equations in the documentation of the cycle's doubts.

use std::f64::consts::{FRAC_PI_2, PI};

use fric_core::effects::{Effect, EffectParams};
use fric_core::robot::{CableOptions, FrictionOptions, GeometryOptions, MonitorOptions, PulleyOptions};
use fric_core::{CableInput, CableStatus, Compensator, CycleInput, Pose};

use crate::oracle::Geometry;
use crate::support::{SWIVEL, compensator};

const CYCLE_S: f64 = 0.001;
/// Where nothing counts as motion but the displacement, and a change of 1 N as a jump.
const MONITOR: MonitorOptions =
    MonitorOptions { frozen_cycles: 0, length_jump_m: 0.01, length_noise_m: 0.0, sensor_jump_n: Some(1.0) };
/// A false value of the sensor is added in these cycles, N; the second time before the first is forgotten.
const LIES: [core::ops::Range<usize>; 2] = [700..740, 775..790];
const LIE_N: f64 = 60.0;
/// The cable rests in these cycles, in the first hundred of which the load falls.
const REST: core::ops::Range<usize> = 700..820;
const CYCLES: usize = 6000;

/// What makes stored friction doubtful.
#[derive(Clone, Copy, Debug)]
enum Cause {
    /// A false value of the sensor.
    Lie,
    /// A load that falls while the cable rests, slower than a jump.
    Fall,
}

/// A cable and what acts on it.
#[derive(Clone, Copy)]
struct Case {
    mu: f64,
    sigma_n_per_m: f64,
    viscous_n_s_per_m: f64,
    /// Wrap of the first pulley, if that carries the sensor.
    sensor_wrap_rad: Option<f64>,
    /// Whether a swivelling pulley follows the two fixed ones.
    swivel: bool,
    traction_mu: Option<f64>,
    drag_n: f64,
    load_exponent: f64,
    drift_per_s: f64,
    viscous_ratio: f64,
    quadratic_n_s2_per_m2: f64,
}

const PLAIN: Case = Case {
    mu: 0.03,
    sigma_n_per_m: 1000.0,
    viscous_n_s_per_m: 0.0,
    sensor_wrap_rad: None,
    swivel: false,
    traction_mu: None,
    drag_n: 0.0,
    load_exponent: 1.0,
    drift_per_s: 0.0,
    viscous_ratio: 0.0,
    quadratic_n_s2_per_m2: 0.0,
};

const LOAD_REFERENCE_N: f64 = 9.0;
const SECOND_WRAP_RAD: f64 = 2.2;
const BASE_M: [f64; 3] = [0.6, 0.4, 0.5];
const PLATFORM_M: [f64; 3] = [0.06, 0.05, -0.05];

impl Case {
    fn compensator(&self) -> Compensator<1> {
        let mut effects = EffectParams::default();
        let mut set = |effect: Effect, key: &str, value: f64, neutral: f64| {
            if value.to_bits() != neutral.to_bits() {
                effects.set(effect, key, value).unwrap();
            }
        };
        set(Effect::BearingDrag, "drag_n", self.drag_n, 0.0);
        set(Effect::LoadNonlinearity, "exponent", self.load_exponent, 1.0);
        if self.load_exponent.to_bits() != 1.0_f64.to_bits() {
            set(Effect::LoadNonlinearity, "reference_n", LOAD_REFERENCE_N, 0.0);
        }
        set(Effect::FrictionDrift, "rate_per_s", self.drift_per_s, 0.0);
        set(Effect::DirectionAsymmetry, "viscous_ratio", self.viscous_ratio, 0.0);
        set(Effect::ViscousNonlinearity, "quadratic_n_s2_per_m2", self.quadratic_n_s2_per_m2, 0.0);
        let friction = FrictionOptions {
            mu: self.mu,
            sigma_n_per_m: Some(self.sigma_n_per_m),
            viscous_n_s_per_m: self.viscous_n_s_per_m,
            offset_n: 0.0,
        };
        let fixed = |wrap_rad: f64, sensor: bool| PulleyOptions::Fixed { wrap_rad, sensor };
        let first = fixed(self.first_wrap_rad(), self.sensor_wrap_rad.is_some());
        let pulleys = [first, fixed(SECOND_WRAP_RAD, false), SWIVEL];
        let cable = CableOptions {
            friction,
            effects,
            traction_mu: self.traction_mu,
            geometry: self.swivel.then_some(GeometryOptions { base_m: BASE_M, platform_m: PLATFORM_M }),
            ..CableOptions::new(pulleys.get(..if self.swivel { 3 } else { 2 }).unwrap())
        };
        compensator(&[cable], MONITOR)
    }

    fn first_wrap_rad(&self) -> f64 {
        self.sensor_wrap_rad.unwrap_or(FRAC_PI_2)
    }

    /// Tension behind the first pulley per newton of the sensor, as if nothing rubbed.
    fn gain(&self) -> f64 {
        self.sensor_wrap_rad.map_or(1.0, |wrap_rad| (1.0 - wrap_rad.cos()).recip())
    }

    /// Change of the force behind the first pulley per newton of its friction, equation 11 of [P].
    fn share(&self) -> f64 {
        self.sensor_wrap_rad.map_or(1.0, |wrap_rad| self.gain() * wrap_rad.cos().abs())
    }

    /// 2 sin(α/2) of every pulley.
    fn wrap_factors(&self) -> Vec<f64> {
        let geometry = Geometry { base_m: BASE_M, platform_m: PLATFORM_M, axis: [0.0, 0.0, 1.0], radius_m: 0.01 };
        let by_pose = self.swivel.then(|| geometry.exit(PLATFORM_M).wrap_rad);
        [self.first_wrap_rad(), SECOND_WRAP_RAD]
            .into_iter()
            .chain(by_pose)
            .map(|wrap_rad| 2.0 * (0.5 * wrap_rad).sin())
            .collect()
    }

    /// Friction that the pulleys bear at most per newton of tension, and by their drag, N; paid out, where friction is greatest.
    fn bears(&self) -> (f64, f64) {
        let factors = self.wrap_factors();
        // The tensions before and behind the first pulley are `T + (share + 1)·f` and `T + share·f` at most if it carries the sensor, else `T` and `T + f`.
        let both = if self.sensor_wrap_rad.is_some() { 2.0 * self.share() + 1.0 } else { 1.0 };
        let half = 0.5 * self.mu * factors[0];
        let first = 2.0 * half / (1.0 - half * both);
        let tension = 1.0 + self.share() * first;
        let half = 0.5 * self.mu * factors[1];
        let second = 2.0 * half * tension / (1.0 - half);
        let tension = tension + second;
        // Of a swivelling pulley the bound of every wrap.
        let swivelling = factors.get(2).map_or(0.0, |factor| self.mu * factor * tension / (1.0 - self.mu));
        let ratio = first + second + swivelling;
        #[expect(clippy::cast_precision_loss, reason = "a handful")]
        let count = factors.len() as f64;
        (ratio, count * self.drag_n * tension)
    }

    /// μ at a tension over that of the file, the greatest of the pulleys.
    fn raised(&self, tension_n: f64) -> f64 {
        let of_pulley = |factor: &f64| (factor * tension_n / LOAD_REFERENCE_N).powf(self.load_exponent - 1.0);
        self.wrap_factors().iter().map(of_pulley).fold(0.0, f64::max)
    }
}

/// The signals of a cycle; the tension as if nothing rubbed is the same whatever the sensor is at.
#[expect(clippy::cast_precision_loss, reason = "small numbers")]
fn input(cycle: usize, cause: Cause, gain: f64) -> CycleInput<1> {
    let (moved_s, moves) = match cause {
        Cause::Fall if REST.contains(&cycle) => (REST.start as f64 * CYCLE_S, false),
        Cause::Fall if cycle >= REST.end => ((cycle - REST.len()) as f64 * CYCLE_S, true),
        _ => (cycle as f64 * CYCLE_S, true),
    };
    let swing_n = (3.0 * cycle as f64 * CYCLE_S).sin();
    let tension_n = match cause {
        Cause::Lie => 12.0 + 2.0 * swing_n + if LIES.iter().any(|lie| lie.contains(&cycle)) { LIE_N } else { 0.0 },
        Cause::Fall => 49.0 + swing_n - 0.45 * cycle.clamp(REST.start, REST.start + 100).abs_diff(REST.start) as f64,
    };
    let cable = CableInput {
        sensor_force_n: tension_n / gain,
        length_m: 1.0 + 0.004 * (2.3 * moved_s).sin(),
        speed_m_per_s: if moves { 0.004 * 2.3 * (2.3 * moved_s).cos() } else { 0.0 },
    };
    let pose = Pose::from_parts([0.0; 3], [0.0, 0.0, 0.0, 1.0]);
    CycleInput { cables: [cable], pose, ..CycleInput::default() }
}

/// Cycles in which the compensator flags `UNSETTLED`, and those in which the equations do.
fn unsettled(case: &Case, by: Cause) -> [Vec<usize>; 2] {
    let mut compensator = case.compensator();
    let ((ratio, drag_n), share) = (case.bears(), case.share().max(1.0));
    let (mut flagged, mut by_hand) = (Vec::new(), Vec::new());
    // Doubtful force E; friction stored before the jump, or before the cycle; the length before.
    let (mut doubtful_n, mut stored_before_n, mut length_before_m) = (0.0_f64, 0.0_f64, None::<f64>);
    let stored = |compensator: &Compensator<1>| -> f64 {
        compensator.pulley_friction_n(0).iter().map(|friction_n| friction_n.abs()).sum()
    };
    for cycle in 0..CYCLES {
        let input = input(cycle, by, case.gain());
        // The jump lasts until it is taken back, that cycle included.
        let jump = matches!(by, Cause::Lie) && LIES.iter().any(|lie| (lie.start..=lie.end).contains(&cycle));
        let begins = LIES.iter().any(|lie| lie.start == cycle);
        if !jump || begins {
            stored_before_n = stored(&compensator) + if begins && jump { doubtful_n } else { 0.0 };
        }
        let output = compensator.step(&input).cables[0];
        assert_eq!(output.status.contains(CableStatus::SENSOR_JUMP), jump, "cycle {cycle}");
        if output.status.contains(CableStatus::UNSETTLED) {
            flagged.push(cycle);
        }
        let CableInput { sensor_force_n, length_m, speed_m_per_s } = input.cables[0];
        let tension_n = sensor_force_n * case.gain();
        let way_m = (length_m - length_before_m.replace(length_m).unwrap_or(length_m)).abs();
        let stored_n = stored(&compensator);
        #[expect(clippy::cast_precision_loss, reason = "small numbers")]
        let drifted = 1.0 + case.drift_per_s * cycle as f64 * CYCLE_S;
        #[expect(clippy::cast_precision_loss, reason = "a handful")]
        let pulleys = case.wrap_factors().len() as f64;
        let viscous_n = pulleys * case.viscous_n_s_per_m * speed_m_per_s.abs() * (1.0 + case.viscous_ratio.abs())
            + case.quadratic_n_s2_per_m2 * speed_m_per_s.powi(2);
        let limited_n = if case.traction_mu.is_some() { viscous_n } else { 0.0 };
        // B, and what a newton of friction adds to that of sliding.
        let bears_n = ratio * case.raised(tension_n) * drifted * (tension_n + viscous_n * share) + drag_n + limited_n;
        let most_n = stored_n.max(stored_before_n);
        let raised = case.raised(tension_n).max(case.raised(tension_n + most_n)) * drifted;
        let fed = ratio * raised * (share + 0.5);
        let tolerated_n = 0.25 * tension_n + 0.1;
        if jump {
            doubtful_n = ((stored_n + bears_n) * share + tolerated_n).max((stored_n + stored_before_n) * share);
        } else {
            let sliding_n = bears_n + fed * most_n;
            let own_n = doubtful_n * (-case.sigma_n_per_m / pulleys * way_m / sliding_n).exp();
            doubtful_n = own_n + fed.min(0.95) * (doubtful_n - own_n);
        }
        if doubtful_n <= 0.05 {
            doubtful_n = 0.0;
        }
        let left_n = (output.force_at_platform_n.abs() - doubtful_n).max(0.0);
        if (stored_n - bears_n) * share > tolerated_n || doubtful_n > 0.5 * (0.05 * left_n + 0.1) {
            by_hand.push(cycle);
        }
    }
    [flagged, by_hand]
}

#[test]
fn a_doubt_lasts_as_long_as_its_equations_say() {
    let cases = [
        PLAIN,
        Case { mu: 0.02, sigma_n_per_m: 2000.0, ..PLAIN },
        Case { swivel: true, mu: 0.02, sigma_n_per_m: 3000.0, ..PLAIN },
        // Sensor pulleys, of which the force at the platform shows less of the friction stored, and more.
        Case { sensor_wrap_rad: Some(PI), ..PLAIN },
        Case { sensor_wrap_rad: Some(0.8), mu: 0.02, sigma_n_per_m: 3000.0, ..PLAIN },
        Case {
            sensor_wrap_rad: Some(0.8),
            mu: 0.02,
            sigma_n_per_m: 3000.0,
            drag_n: 0.05,
            viscous_n_s_per_m: 9.0,
            ..PLAIN
        },
        Case { drag_n: 0.15, ..PLAIN },
        Case { viscous_n_s_per_m: 25.0, ..PLAIN },
        Case { viscous_n_s_per_m: 25.0, viscous_ratio: -0.6, ..PLAIN },
        Case { quadratic_n_s2_per_m2: 9000.0, ..PLAIN },
        Case { viscous_n_s_per_m: 25.0, traction_mu: Some(2.0), ..PLAIN },
        Case { load_exponent: 0.6, ..PLAIN },
        Case { load_exponent: 1.5, ..PLAIN },
        Case { drift_per_s: 0.2, ..PLAIN },
        Case { swivel: true, viscous_n_s_per_m: 25.0, drift_per_s: -0.1, load_exponent: 0.7, drag_n: 0.1, ..PLAIN },
    ];
    for (index, case) in cases.iter().enumerate() {
        for cause in [Cause::Lie, Cause::Fall] {
            let [flagged, by_hand] = unsettled(case, cause);
            if matches!(cause, Cause::Fall) && case.load_exponent < 1.0 && flagged.is_empty() {
                // Bearings that hold nearly as much with a small load as with a great one.
                assert!(by_hand.is_empty(), "case {index}: {by_hand:?}");
                continue;
            }
            let begins = match cause {
                Cause::Lie => LIES[0].start..LIES[0].start + 1,
                Cause::Fall => REST,
            };
            assert!(flagged.first().is_some_and(|first| begins.contains(first)), "{index}, {cause:?}: {flagged:?}");
            assert!(flagged.last().is_some_and(|last| last + 100 < CYCLES), "{index}, {cause:?}: {:?}", flagged.last());
            let ends = [&flagged, &by_hand].map(|cycles| (cycles.len(), cycles.first(), cycles.last()));
            assert_eq!(ends[0], ends[1], "case {index}, {cause:?}");
            assert_eq!(flagged, by_hand, "case {index}, {cause:?}");
        }
    }
}

/// The stretch of a cable may be against the motion of the winch, so that a contact moves by less, and forgets later.
#[test]
fn a_doubt_lasts_longer_on_a_cable_that_stretches() {
    let [stiff, elastic] = [0.0, 3e-4].map(|compliance_m_per_n| {
        let mut effects = EffectParams::default();
        effects.set(Effect::CableElasticity, "compliance_m_per_n", compliance_m_per_n).unwrap();
        let friction = FrictionOptions {
            mu: PLAIN.mu,
            sigma_n_per_m: Some(PLAIN.sigma_n_per_m),
            viscous_n_s_per_m: 0.0,
            offset_n: 0.0,
        };
        let pulleys = [PulleyOptions::Fixed { wrap_rad: FRAC_PI_2, sensor: false }];
        let options = [CableOptions { friction, effects, ..CableOptions::new(&pulleys) }];
        let mut compensator = compensator::<1>(&options, MONITOR);
        let statuses = (0..CYCLES).map(|cycle| compensator.step(&input(cycle, Cause::Lie, 1.0)).cables[0].status);
        statuses.filter(|status| status.contains(CableStatus::UNSETTLED)).count()
    });
    assert!(elastic > stiff && stiff > 100, "{elastic} cycles, {stiff} on a stiff cable");
}
