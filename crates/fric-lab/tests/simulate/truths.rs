//! What hidden effects and disturbances do to a log, each against what physics says of it.

use core::f64::consts::{PI, TAU};

use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_lab::simulate::{DISTURBANCES, Disturbance, HiddenEffect, SimulationOptions};

use super::robots::{bench, eight_cables, noiseless, simulate};

const PULLEYS: &str = "{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }, { wrap_deg = 90.0 }";
const FRICTION: &str = "mu = 0.02, sigma_n_per_m = 1000.0, viscous_n_s_per_m = 0.2";
const CYCLE_S: f64 = 0.001;

/// One cable's signals over a run.
#[derive(Debug, Default, PartialEq)]
struct Signals {
    sensor_n: Vec<f64>,
    length_m: Vec<f64>,
    speed_m_per_s: Vec<f64>,
    reference_n: Vec<f64>,
}

impl Signals {
    fn of(robot: &RobotFile, options: &SimulationOptions) -> Self {
        let mut simulation = simulate(robot, options);
        let mut signals = Self::default();
        while let Some(sample) = simulation.next_cycle() {
            signals.sensor_n.push(sample.cables[0].sensor_force_n);
            signals.length_m.push(sample.cables[0].length_m);
            signals.speed_m_per_s.push(sample.cables[0].speed_m_per_s);
            signals.reference_n.push(sample.reference_force_n[0]);
        }
        signals
    }
}

fn rubbing() -> RobotFile {
    bench(PULLEYS, FRICTION)
}

fn smooth() -> RobotFile {
    bench(PULLEYS, "mu = 0.0, sigma_n_per_m = 1000.0")
}

/// Long enough for steps, strokes and their reversals.
fn short() -> SimulationOptions {
    SimulationOptions { duration_s: Some(20.0), ..noiseless() }
}

fn hiding(text: &str) -> SimulationOptions {
    SimulationOptions { effects: vec![HiddenEffect::parse(text).unwrap()], ..short() }
}

/// The effect as its row's example has it, in the words of the command line.
fn example(effect: Effect) -> String {
    let values = effect.row().parameters.iter().zip(effect.row().example);
    let values: Vec<String> = values.map(|(parameter, value)| format!("{}={value:?}", parameter.key)).collect();
    format!("{}:{}", effect.kind(), values.join(","))
}

fn spoilt(text: &str) -> SimulationOptions {
    SimulationOptions { disturbances: vec![Disturbance::parse(text).unwrap()], ..short() }
}

fn differences(one: &[f64], other: &[f64]) -> Vec<f64> {
    one.iter().zip(other).map(|(one, other)| one - other).collect()
}

fn time_s(cycle: usize) -> f64 {
    CYCLE_S * f64::from(u32::try_from(cycle).unwrap())
}

#[test]
fn neutral_values_change_no_bit() {
    let plain = Signals::of(&rubbing(), &SimulationOptions { seed: 3, duration_s: Some(3.0), ..Default::default() });
    for effect in Effect::kinds() {
        let values: Vec<_> =
            effect.row().parameters.iter().map(|parameter| (parameter.key, parameter.neutral)).collect();
        let effects = vec![HiddenEffect::of(effect, &values).unwrap()];
        let options = SimulationOptions { seed: 3, duration_s: Some(3.0), effects, ..Default::default() };
        assert!(Signals::of(&rubbing(), &options) == plain, "{effect:?}");
    }
}

#[test]
fn effects_change_the_sensor_and_neither_reference_nor_motion() {
    let plain = Signals::of(&rubbing(), &short());
    // A delay is the motion's, and changes that alone.
    for effect in Effect::kinds().filter(|effect| *effect != Effect::TimeDelay) {
        let text = &example(effect);
        let hidden = Signals::of(&rubbing(), &hiding(text));
        assert!(hidden.reference_n == plain.reference_n && hidden.length_m == plain.length_m, "{text}");
        assert!(hidden.speed_m_per_s == plain.speed_m_per_s, "{text}");
        let greatest_n =
            differences(&hidden.sensor_n, &plain.sensor_n).into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        println!("{text}: up to {greatest_n:.3} N");
        assert!(greatest_n > 0.02, "{text}: {greatest_n}");
    }
}

#[test]
fn the_sensor_shows_gain_offset_and_drift() {
    let plain = Signals::of(&rubbing(), &short());
    let all = ["sensor_gain:gain=1.03", "sensor_offset:offset_n=-0.3", "sensor_drift:rate_n_per_s=0.02"];
    let effects = all.map(|text| HiddenEffect::parse(text).unwrap()).to_vec();
    let shown = Signals::of(&rubbing(), &SimulationOptions { effects, ..short() });
    for (cycle, (shown_n, true_n)) in shown.sensor_n.iter().zip(&plain.sensor_n).enumerate() {
        assert!((shown_n - (1.03 * true_n - 0.3 + 0.02 * time_s(cycle))).abs() < 1e-12);
    }
}

/// Behind n pulleys of mass m the tension is lower by `n·m·a` while the cable is sped up towards the platform; the sensor at
/// 180° feels the tensions behind 2 and behind 3 of 3 pulleys. The acceleration is the run's, but for the micro motion.
#[test]
fn pulleys_with_mass_take_force_to_speed_up() {
    let mass_kg = 0.05;
    let options = hiding(&format!("pulley_inertia:mass_kg={mass_kg}"));
    let signals = Signals::of(&smooth(), &options);
    let trajectory = simulate(&smooth(), &options).trajectory().clone();
    let mut greatest_n = 0.0_f64;
    for (cycle, (sensor_n, reference_n)) in signals.sensor_n.iter().zip(&signals.reference_n).enumerate() {
        let inertia_n = 5.0 * mass_kg * trajectory.at(time_s(cycle)).acceleration_m_per_s2.x;
        let missing_n = 2.0 * reference_n - sensor_n;
        assert!((missing_n - inertia_n).abs() < 1e-3, "{cycle}: {missing_n} {inertia_n}");
        greatest_n = greatest_n.max(inertia_n);
    }
    assert!(greatest_n > 2.0, "{greatest_n}");
}

#[test]
fn a_pulley_out_of_true_ripples_with_the_length() {
    let text = "pulley_eccentricity:sin_ratio=0.02,cos_ratio=-0.01,period_m=0.07";
    let signals = Signals::of(&smooth(), &hiding(text));
    for ((sensor_n, length_m), reference_n) in signals.sensor_n.iter().zip(&signals.length_m).zip(&signals.reference_n)
    {
        let phase_rad = TAU * length_m / 0.07;
        let factor = 1.0 + 0.02 * phase_rad.sin() - 0.01 * phase_rad.cos();
        assert!((0.5 * sensor_n * factor - reference_n).abs() < 1e-12);
    }
}

#[test]
fn a_negative_delay_is_motion_known_too_late() {
    let plain = Signals::of(&rubbing(), &short());
    let late = Signals::of(&rubbing(), &hiding("time_delay:delay_s=-0.004"));
    assert!(late.sensor_n == plain.sensor_n && late.reference_n == plain.reference_n);
    for (now_m, later_m) in plain.length_m.iter().zip(late.length_m.iter().skip(4)) {
        assert!((now_m - later_m).abs() < 1e-12);
    }
    for (now, later) in plain.speed_m_per_s.iter().zip(late.speed_m_per_s.iter().skip(4)) {
        assert!((now - later).abs() < 1e-11);
    }
}

/// Amplitude of a line at a frequency over whole periods.
fn line(values: &[f64], frequency_hz: f64) -> f64 {
    let count = f64::from(u32::try_from(values.len()).unwrap());
    let part = |wave: fn(f64) -> f64| -> f64 {
        let waves = values.iter().enumerate().map(|(cycle, value)| value * wave(TAU * frequency_hz * time_s(cycle)));
        2.0 * waves.sum::<f64>() / count
    };
    part(f64::sin).hypot(part(f64::cos))
}

#[test]
fn hum_is_one_line_and_warming_a_slow_one() {
    let plain = Signals::of(&rubbing(), &short());
    for (text, amplitude_n, frequency_hz) in
        [("hum:amplitude_n=0.12,frequency_hz=50", 0.12, 50.0), ("warming:amplitude_n=0.1,period_s=20", 0.1, 0.05)]
    {
        let spoilt = Signals::of(&rubbing(), &spoilt(text));
        let added_n = differences(&spoilt.sensor_n, &plain.sensor_n);
        assert!((line(&added_n, frequency_hz) - amplitude_n).abs() < 1e-9);
        for other_hz in [10.0, 40.0, 60.0, 100.0, 150.0] {
            assert!(line(&added_n, other_hz) < 1e-9, "{other_hz}");
        }
        assert!(spoilt.reference_n == plain.reference_n && spoilt.length_m == plain.length_m);
    }
    // Two cables, two phases; two seeds too.
    let hum = spoilt("hum:amplitude_n=0.12");
    let start_n = |seed| {
        let mut simulation = simulate(&eight_cables(), &SimulationOptions { seed, ..hum.clone() });
        simulation.next_cycle().map(|sample| [0, 1].map(|cable| sample.cables[cable].sensor_force_n)).unwrap()
    };
    let plain_n = |seed| {
        let mut simulation = simulate(&eight_cables(), &SimulationOptions { seed, ..short() });
        simulation.next_cycle().map(|sample| [0, 1].map(|cable| sample.cables[cable].sensor_force_n)).unwrap()
    };
    let hums_n = [1, 2].map(|seed| differences(&start_n(seed), &plain_n(seed))).concat();
    for (place, one_n) in hums_n.iter().enumerate() {
        assert!(hums_n[place + 1..].iter().all(|other_n| (one_n - other_n).abs() > 1e-6), "{hums_n:?}");
    }
}

#[test]
fn a_frozen_sensor_repeats_itself() {
    let options = SimulationOptions { sensor_noise_n: 0.02, ..spoilt("frozen:interval_s=5,length_s=0.25") };
    let frozen = Signals::of(&rubbing(), &options);
    let noisy = Signals::of(&rubbing(), &SimulationOptions { sensor_noise_n: 0.02, ..short() });
    let mut repeated = 0;
    for (cycle, pair) in frozen.sensor_n.windows(2).enumerate() {
        if pair[0].to_bits() == pair[1].to_bits() {
            repeated += 1;
        } else {
            assert_eq!(pair[1].to_bits(), noisy.sensor_n[cycle + 1].to_bits());
        }
    }
    // Four intervals in 20 s, of which the first or last stretch may be cut.
    assert!((3 * 249..=4 * 251).contains(&repeated), "{repeated}");
}

#[test]
fn clipped_and_quantised_readings_have_their_marks() {
    let noisy = SimulationOptions { sensor_noise_n: 0.02, ..short() };
    let plain = Signals::of(&rubbing(), &noisy);
    let with = |text: &str| {
        let disturbances = spoilt(text).disturbances;
        Signals::of(&rubbing(), &SimulationOptions { disturbances, ..noisy.clone() }).sensor_n
    };
    let clipped_n = with("clipped:greatest_n=8");
    assert!(
        clipped_n
            .iter()
            .zip(&plain.sensor_n)
            .all(|(clipped_n, plain_n)| clipped_n.to_bits() == plain_n.min(8.0).to_bits())
    );
    assert!(clipped_n.iter().filter(|force_n| force_n.to_bits() == 8.0_f64.to_bits()).count() > 100);
    for (coarse_n, plain_n) in with("quantised:resolution_n=0.25").iter().zip(&plain.sensor_n) {
        assert!((coarse_n - plain_n).abs() <= 0.125 + 1e-12);
        assert!((coarse_n / 0.25).fract().abs() < 1e-12);
    }
}

#[test]
fn steps_come_and_go() {
    let plain = Signals::of(&rubbing(), &short());
    let shifted = Signals::of(&rubbing(), &spoilt("step:shift_n=0.3,interval_s=5,length_s=2"));
    let shifts_n = differences(&shifted.sensor_n, &plain.sensor_n);
    let count = shifts_n.iter().filter(|shift_n| (**shift_n - 0.3).abs() < 1e-12).count();
    assert!(shifts_n.iter().all(|shift_n| shift_n.abs() < 1e-12 || (shift_n - 0.3).abs() < 1e-12));
    assert!((5000..=8000).contains(&count), "{count}");
}

/// Between two blows what the sensor shows in addition is a damped sine, which answers `x₂ − 2r·cos θ·x₁ + r²·x₀ = 0`; a blow comes with each start and
/// reversal of the winch, and nothing before the first.
#[test]
fn a_mount_rings_after_each_start_and_reversal() {
    const FREQUENCY_HZ: f64 = 12.0;
    const DAMPING_RATIO: f64 = 0.05;
    let plain = Signals::of(&rubbing(), &short());
    let ringing = Signals::of(&rubbing(), &spoilt("vibration:amplitude_n=0.4,frequency_hz=12,damping_ratio=0.05"));
    let shown_n = differences(&ringing.sensor_n, &plain.sensor_n);
    let undamped = std::f64::consts::TAU * FREQUENCY_HZ * 1e-3;
    let (r, turn) = ((-DAMPING_RATIO * undamped).exp(), undamped * (1.0 - DAMPING_RATIO * DAMPING_RATIO).sqrt());
    let answer = |shown_n: &[f64]| shown_n[2] - 2.0 * r * turn.cos() * shown_n[1] + r * r * shown_n[0];
    let struck: Vec<usize> = shown_n
        .windows(3)
        .enumerate()
        .filter(|(_, shown_n)| answer(shown_n).abs() > 1e-9)
        .map(|(cycle, _)| cycle + 2)
        .collect();
    let starts = |cycle: &usize| {
        let before = plain.speed_m_per_s[cycle.saturating_sub(3)];
        let after = plain.speed_m_per_s[(cycle + 2).min(plain.speed_m_per_s.len() - 1)];
        before.abs() < 5e-3 || before.signum() != after.signum()
    };
    assert!(struck.len() > 6 && struck.iter().all(starts), "{struck:?}");
    let greatest_n = shown_n.iter().fold(0.0_f64, |most, shown_n| most.max(shown_n.abs()));
    assert!(greatest_n > 0.3 && greatest_n < 0.8, "{greatest_n}");
    assert!(shown_n[..struck[0] - 1].iter().all(|shown_n| shown_n.abs() < 1e-12));
}

/// Far from the piece nothing changes; where it passes, the last pulley rubs more by the drag, which the sensor at 180°
/// feels twice.
#[test]
fn a_defect_of_the_cable_is_felt_where_it_passes() {
    let robot = bench(PULLEYS, "mu = 0.02");
    let plain = Signals::of(&robot, &short());
    let kinked = Signals::of(&robot, &spoilt("local_defect:drag_n=0.2,from_start_m=0.03,width_m=0.005"));
    let mut passed = 0;
    for (cycle, missing_n) in differences(&plain.sensor_n, &kinked.sensor_n).into_iter().enumerate() {
        let off_m = plain.length_m[cycle] - plain.length_m[0] - 0.03;
        let speed_m_per_s = plain.speed_m_per_s[cycle];
        if off_m.abs() > 0.04 {
            assert!(missing_n.abs() < 1e-3, "{off_m}: {missing_n}");
        } else if off_m.abs() < 0.0005 && speed_m_per_s.abs() > 0.01 {
            // What the kink takes, less of the load on the pulleys before it.
            let expected_n = 2.0 * 0.2 * speed_m_per_s.signum();
            assert!((missing_n - expected_n).abs() < 0.15 * 0.4, "{missing_n} {expected_n}");
            passed += 1;
        }
    }
    assert!(passed > 10, "{passed}");
}

/// A damped bristle has the force `f + lead·df/dt`, if f is that of the same bristle without damping. Its load, of which the friction is a part, changes
/// only to the second order in μ.
#[test]
fn a_damped_contact_leads_the_friction_that_it_stores() {
    const LEAD_S: f64 = 0.006;
    let robot = bench("{ wrap_deg = 180.0, sensor = true }", "mu = 0.02, sigma_n_per_m = 500.0");
    // F_1 less F_0: friction of the one pulley.
    let friction_n = |signals: &Signals| -> Vec<f64> {
        signals
            .reference_n
            .iter()
            .zip(&signals.sensor_n)
            .map(|(reference_n, sensor_n)| 2.0 * reference_n - sensor_n)
            .collect()
    };
    let plain_n = friction_n(&Signals::of(&robot, &short()));
    let damped_n = friction_n(&Signals::of(&robot, &spoilt(&format!("bristle_damping:lead_s={LEAD_S}"))));
    let added_n = differences(&damped_n, &plain_n);
    let lead_n = plain_n.windows(3).map(|of| LEAD_S * (of[2] - of[0]) / (2.0 * CYCLE_S));
    let (mut missed, mut squares) = (0.0, 0.0);
    for (lead_n, added_n) in lead_n.zip(&added_n[1..]) {
        missed += (added_n - lead_n).powi(2);
        squares += lead_n.powi(2);
    }
    let greatest_n = added_n.iter().fold(0.0_f64, |most, added_n| most.max(added_n.abs()));
    assert!(greatest_n > 0.05, "{greatest_n}");
    assert!((missed / squares).sqrt() < 0.05, "{}", (missed / squares).sqrt());
}

/// A cable that creeps as fast as it stretches is an elastic cable.
#[test]
fn quick_creep_is_elasticity() {
    let options = |of: SimulationOptions| SimulationOptions { hand_n: 2.0, ..of };
    let plain = Signals::of(&rubbing(), &options(short()));
    let creeping = Signals::of(&rubbing(), &options(spoilt("creep:compliance_m_per_n=1e-4,time_constant_s=0.01")));
    let elastic = Signals::of(&rubbing(), &options(hiding("cable_elasticity:compliance_m_per_n=1e-4")));
    let rms_n = |one: &Signals, other: &Signals| {
        let squares: f64 = differences(&one.sensor_n, &other.sensor_n).iter().map(|number| number * number).sum();
        (squares / 20e3).sqrt()
    };
    let (effect_n, difference_n) = (rms_n(&elastic, &plain), rms_n(&creeping, &elastic));
    assert!(effect_n > 0.02 && difference_n < 0.2 * effect_n, "{effect_n} {difference_n}");
}

/// Within its play the winch moves and the cable does not: the friction stays. Through it, friction has the sign of the
/// cable's motion once it has come farther than presliding reaches.
#[test]
fn play_delays_the_reversal_of_friction() {
    let play_m = 0.001;
    let robot = bench("{ wrap_deg = 180.0, sensor = true }", "mu = 0.02, sigma_n_per_m = 2000.0");
    let plain = Signals::of(&robot, &short());
    let loose = Signals::of(&robot, &hiding(&format!("gear_backlash:play_m={play_m}")));
    assert!(loose.length_m == plain.length_m);
    // F_1 less half of F_1 + F_0.
    let friction_n = |cycle: usize| 2.0 * loose.reference_n[cycle] - loose.sensor_n[cycle];
    let (mut low_m, mut driven_m) = (loose.length_m[0] - 0.5 * play_m, 0.0_f64);
    let (mut within, mut resting, mut sliding) = (0, 0, 0);
    for cycle in 1..loose.length_m.len() {
        let length_m = loose.length_m[cycle];
        let before_m = low_m;
        low_m = low_m.clamp(length_m - play_m, length_m);
        let moved_m = low_m - before_m;
        if moved_m == 0.0 {
            within += 1;
            if within > 1 {
                assert!((friction_n(cycle) - friction_n(cycle - 1)).abs() < 1e-9);
                resting += 1;
            }
            continue;
        }
        // The load may have changed during a rest.
        driven_m = if within > 0 || moved_m * driven_m < 0.0 { moved_m } else { driven_m + moved_m };
        within = 0;
        if driven_m.abs() > 0.001 && loose.speed_m_per_s[cycle].abs() > 0.02 {
            let sliding_n = 0.02 * loose.sensor_n[cycle] * driven_m.signum();
            assert!((friction_n(cycle) - sliding_n).abs() < 0.02 * sliding_n.abs(), "{cycle}");
            sliding += 1;
        }
    }
    assert!(resting > 1000 && sliding > 1000, "{resting} {sliding}");
}

#[test]
fn what_wanders_has_its_deviation_and_its_time() {
    let duration_s = Some(400.0);
    let options =
        SimulationOptions { sensor_wander_n: 0.03, reference_wander_n: 0.01, wander_s: 0.5, duration_s, ..noiseless() };
    let robot = bench("{ wrap_deg = 180.0, sensor = true }", "mu = 0.0");
    let plain = Signals::of(&robot, &SimulationOptions { duration_s, ..noiseless() });
    let wandering = Signals::of(&robot, &options);
    for (added_n, deviation_n) in [
        (differences(&wandering.sensor_n, &plain.sensor_n), 0.03),
        (differences(&wandering.reference_n, &plain.reference_n), 0.01),
    ] {
        let product = |shift: usize| {
            let pairs: Vec<f64> = added_n.iter().zip(&added_n[shift..]).map(|(one, other)| one * other).collect();
            pairs.iter().sum::<f64>() / f64::from(u32::try_from(pairs.len()).unwrap())
        };
        let variance = product(0);
        // 400 independent times: 4 % for the deviation.
        assert!((variance.sqrt() / deviation_n - 1.0).abs() < 0.15, "{}", variance.sqrt());
        for (shift, expected) in [(1, (-0.002_f64).exp()), (250, (-0.5_f64).exp()), (500, (-1.0_f64).exp())] {
            assert!((product(shift) / variance - expected).abs() < 0.12, "{shift}: {}", product(shift) / variance);
        }
    }
}

#[test]
fn an_encoder_gives_counts_and_their_differences() {
    let plain = Signals::of(&rubbing(), &short());
    let encoder = SimulationOptions { length_resolution_m: 1e-5, ..short() };
    let counted = Signals::of(&rubbing(), &encoder);
    assert!(counted.sensor_n == plain.sensor_n);
    for (length_m, true_m) in counted.length_m.iter().zip(&plain.length_m) {
        assert!((length_m - true_m).abs() <= 0.5e-5 + 1e-12);
        assert!((length_m / 1e-5 - (length_m / 1e-5).round()).abs() < 1e-6);
    }
    let noisy = Signals::of(&rubbing(), &SimulationOptions { length_noise_m: 2e-6, ..short() });
    let noise_m = differences(&noisy.length_m, &plain.length_m);
    let count = f64::from(u32::try_from(noise_m.len()).unwrap());
    let deviation_m = (noise_m.iter().map(|noise_m| noise_m * noise_m).sum::<f64>() / count).sqrt();
    assert!((deviation_m / 2e-6 - 1.0).abs() < 0.02, "{deviation_m}");
    for signals in [&counted, &noisy] {
        assert!(signals.speed_m_per_s[0].abs() < 1e-300);
        for (pair, speed_m_per_s) in signals.length_m.windows(2).zip(&signals.speed_m_per_s[1..]) {
            assert!(((pair[1] - pair[0]) / CYCLE_S - speed_m_per_s).abs() < 1e-9);
        }
    }
}

#[test]
fn a_hand_pulls_cables_also_while_the_winches_rest() {
    let plain = Signals::of(&rubbing(), &short());
    let pushed = Signals::of(&rubbing(), &SimulationOptions { hand_n: 1.5, ..short() });
    let pushes_n = differences(&pushed.reference_n, &plain.reference_n);
    assert!(pushed.length_m == plain.length_m);
    assert!(pushes_n.iter().all(|push_n| push_n.abs() <= 1.5 + 1e-12));
    let square: f64 = pushes_n.iter().map(|push_n| push_n * push_n).sum();
    assert!((square / 20e3).sqrt() > 0.4);
    // Slowly: less than 1.5 N times a few rad/s.
    assert!(pushes_n.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 1.5 * PI * CYCLE_S));
    // A hand far stronger than the load takes no cable below what it needs.
    let strong = Signals::of(&rubbing(), &SimulationOptions { hand_n: 50.0, ..short() });
    assert!(strong.reference_n.iter().all(|force_n| *force_n > 0.3));
}

#[test]
fn a_hand_on_a_platform_is_part_of_the_outside_wrench() {
    let options = SimulationOptions { duration_s: Some(6.0), ..noiseless() };
    let mut plain = simulate(&eight_cables(), &options);
    let mut pushed = simulate(&eight_cables(), &SimulationOptions { hand_n: 2.0, ..options });
    let mut greatest_n = [0.0_f64; 3];
    while let (Some(one), Some(other)) = (plain.next_cycle(), pushed.next_cycle()) {
        let (one, other) = (one.outside_wrench.unwrap(), other.outside_wrench.unwrap());
        let push_n = other.force_n - one.force_n;
        assert!((other.torque_nm - one.torque_nm).amax() < 1e-9);
        for (greatest_n, push_n) in greatest_n.iter_mut().zip(push_n.iter()) {
            assert!(push_n.abs() <= 2.0 + 1e-9);
            *greatest_n = greatest_n.max(push_n.abs());
        }
    }
    assert!(greatest_n.iter().all(|push_n| *push_n > 0.5), "{greatest_n:?}");
    assert!(pushed.imbalance().is_none());
}

#[test]
fn disturbances_are_read_as_they_are_written_and_errors_name_what_is_known() {
    let problem = |text: &str| Disturbance::parse(text).unwrap_err().to_string();
    for row in DISTURBANCES {
        let values: Vec<_> = row.parameters.iter().map(|parameter| (parameter.key, parameter.usual)).collect();
        let disturbance = Disturbance::new(row.kind, &values).unwrap();
        assert_eq!(Disturbance::parse(&disturbance.to_string()), Ok(disturbance.clone()));
        assert!(disturbance.values() == values);
    }
    assert_eq!(
        problem("hmu:amplitude_n=1"),
        "there is no disturbance `hmu`; did you mean `hum`? known are `hum`, `frozen`, `clipped`, `step`, `quantised`, `warming`, \
         `local_defect`, `vibration`, `bristle_damping`, `creep`"
    );
    assert!(problem("hum").starts_with("the disturbance `hum` has no value, which would hide nothing"));
    assert_eq!(
        problem("hum:amplitude=1"),
        "the disturbance `hum` has no parameter `amplitude`; did you mean `amplitude_n`? it has `amplitude_n` (0 to 1000 N), \
         `frequency_hz` (0.01 to 100000 Hz)"
    );
    assert!(problem("hum:amplitude_n=loud").starts_with("`amplitude_n=loud` is not `key=value` with a number"));
    assert_eq!(problem("step:shift_n=nan"), "`shift_n` of the disturbance `step` is NaN; allowed is -1000 to 1000 N");
    let twice = vec![Disturbance::parse("hum:amplitude_n=0.1").unwrap(); 2];
    let error = fric_lab::simulate::Simulation::new(&rubbing(), &SimulationOptions { disturbances: twice, ..short() });
    assert_eq!(error.unwrap_err().to_string(), "the disturbance `hum` is hidden twice");
}
