//! What is wrong with a log, or with how it was recorded, is neither a missing effect nor something unexplained.

use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Pose, Sample};
use fric_lab::discover::{CableDiscovery, DiscoverOptions, Verdict, discover, extended};
use fric_lab::fit::{Measurements, Progress, Reference};
use fric_lab::recording_fault::Fault;
use fric_lab::simulate::sweep::{Case, CaseTruth, Group};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// A sample of the one cable of a log.
#[derive(Clone, Copy)]
struct Point {
    stamp_nanos: i64,
    cable: CableInput,
    reference_n: f64,
    pose: Option<Pose>,
}

/// The samples of a case's log.
fn points_of(case: &Case) -> (Vec<Point>, CaseTruth) {
    let mut log = case.log().unwrap();
    let mut points = Vec::new();
    while let Some(sample) = log.simulation.next_cycle() {
        let (cable, reference_n) = (sample.cables[0], sample.reference_force_n[0]);
        points.push(Point { stamp_nanos: sample.stamp_nanos, cable, reference_n, pose: sample.pose });
    }
    (points, log.truth)
}

/// Looks at logs by the model that they were made with.
fn look(logs: &[&[Point]], truth: &CaseTruth) -> CableDiscovery {
    let params = truth.robot.params();
    let mut measurements = Measurements::new(&params, Reference::Forces);
    for points in logs {
        measurements.start_log();
        for point in *points {
            measurements.add(&Sample {
                stamp_nanos: point.stamp_nanos,
                cables: &[point.cable],
                reference_force_n: &[point.reference_n],
                pose: point.pose,
                outside_wrench: None,
            });
        }
    }
    discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0)
}

fn assert_complete(found: &CableDiscovery, floor_n: f64) {
    assert!(found.unexplained.is_none(), "{:?}", found.unexplained);
    assert_eq!((found.verdict, found.findings.len()), (Verdict::Complete, 0));
    let ratio = found.noise_floor_n / floor_n;
    assert!((ratio - 1.0).abs() < 0.05, "floor {ratio}");
}

#[test]
fn gaps_do_not_hide_the_noise() {
    let (points, truth) = points_of(&Case { seed: 70_011, ..Case::of(Group::Nothing) });
    let gaps: [fn(&mut Point); 3] = [
        |point| point.reference_n = f64::NAN,
        |point| point.cable.sensor_force_n = f64::NAN,
        |point| point.reference_n += 5.0,
    ];
    for gap in gaps {
        let mut points = points.clone();
        points.iter_mut().step_by(150).for_each(gap);
        assert_complete(&look(&[&points], &truth), truth.floor_n);
    }
    // Of each five samples one is missing: nothing tells the noise, and that is said.
    let mut points = points;
    points.iter_mut().step_by(5).for_each(gaps[0]);
    let found = look(&[&points], &truth);
    assert!(found.lack.unwrap().cause.contains("hardly five in a row"), "{:?}", found.verdict);
}

#[test]
fn a_sensor_that_drops_out_is_not_frozen() {
    let (mut points, truth) = points_of(&Case { seed: 70_012, ..Case::of(Group::Nothing) });
    for start in [15_000, 31_000] {
        points[start..start + 30].iter_mut().for_each(|point| point.cable.sensor_force_n = f64::NAN);
    }
    assert_complete(&look(&[&points], &truth), truth.floor_n);
    // One that repeats its last number is.
    let held_n = points[40_000].cable.sensor_force_n;
    points[40_000..40_030].iter_mut().for_each(|point| point.cable.sensor_force_n = held_n);
    let found = look(&[&points], &truth);
    let faults: Vec<Fault> = found.faults.iter().map(|fault| fault.fault).collect();
    assert_eq!((faults, found.verdict), (vec![Fault::Frozen], Verdict::Complete));
    let [from_s, to_s] = found.faults[0].intervals_s[0];
    assert!((from_s - 40.0).abs() < 2e-3 && (to_s - 40.03).abs() < 2e-3, "{from_s} {to_s}");
}

#[test]
fn hum_is_one_line_with_lost_rows_and_in_several_logs() {
    let case = Case { disturbance: Some("hum"), seed: 70_013, ..Case::of(Group::Nothing) };
    let (mut points, truth) = points_of(&case);
    let (_, frequency_hz) = truth.disturbances[0].values()[1];
    points.drain(20_000..20_007);
    // The second log begins anywhere in the hum.
    let (one, other) = points.split_at(26_003);
    for logs in [&[points.as_slice()][..], &[one, other][..]] {
        let found = look(logs, &truth);
        assert_eq!((found.faults.len(), found.findings.len()), (1, 0), "{:?}", found.faults);
        let (key, told_hz) = found.faults[0].parameters[0];
        assert_eq!((found.faults[0].fault, key, found.verdict), (Fault::Hum, "frequency_hz", Verdict::Complete));
        assert!((told_hz - frequency_hz).abs() < 0.05, "{told_hz} {frequency_hz}");
        let (after_n, floor_n) = (found.noise_floor_n, truth.floor_n);
        assert!((after_n / floor_n - 1.0).abs() < 0.05, "{after_n} {floor_n}");
    }
}

/// A mount that rings after each reversal is a fault of the recording beside the effect, which is named by itself.
#[test]
fn a_vibration_is_told_beside_an_effect() {
    let case = Case {
        disturbance: Some("vibration"),
        seed: 70_017,
        ..Case::hiding(Group::Mixed, &[Effect::DirectionAsymmetry])
    };
    let (points, truth) = points_of(&case);
    let value = |key: &str| truth.disturbances[0].value(key).unwrap();
    let found = look(&[&points], &truth);
    let names: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
    assert_eq!((names, found.verdict), (vec![Effect::DirectionAsymmetry], Verdict::Extended), "{:?}", found.tried);
    let fault = &found.faults[0];
    let told = |key: &str| fault.parameters.iter().find(|(of, _)| *of == key).unwrap().1;
    assert_eq!((found.faults.len(), fault.fault), (1, Fault::Vibration), "{:?}", found.faults);
    assert!((told("frequency_hz") / value("frequency_hz") - 1.0).abs() < 0.02, "{fault:?} {:?}", truth.disturbances);
    assert!((told("damping_ratio") / value("damping_ratio") - 1.0).abs() < 0.6, "{fault:?} {:?}", truth.disturbances);
    assert!((found.noise_floor_n / truth.floor_n - 1.0).abs() < 0.05, "{} {}", found.noise_floor_n, truth.floor_n);
}

/// A zero that jumps once, or friction that does, is no drift and no warm-up: it goes with the time, and no effect of the catalogue does so at once.
#[test]
fn one_jump_of_the_zero_is_no_drift() {
    let (mut points, truth) = points_of(&Case { seed: 70_018, ..Case::of(Group::Nothing) });
    points[23_000..].iter_mut().for_each(|point| point.cable.sensor_force_n += 0.15);
    let found = look(&[&points], &truth);
    let names: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
    assert_eq!((names, found.verdict), (vec![], Verdict::Unexplained), "{:?}", found.tried);
}

/// References of every so many cycles, with so much more noise, joined to the cycles as a reader of logs does.
fn with_slow_reference(points: &mut [Point], distance: usize, noise_n: f64, seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    for point in points.iter_mut().step_by(distance) {
        let noise: f64 = StandardNormal.sample(&mut random);
        point.reference_n += noise_n * noise;
    }
    for start in (0..points.len()).step_by(distance) {
        let before = points[start];
        let Some(after) = points.get(start + distance).copied() else {
            points[start + 1..].iter_mut().for_each(|point| point.reference_n = f64::NAN);
            break;
        };
        let since = |stamp_nanos: i64| f64::from(i32::try_from(stamp_nanos - before.stamp_nanos).unwrap());
        for point in &mut points[start + 1..start + distance] {
            let ratio = since(point.stamp_nanos) / since(after.stamp_nanos);
            point.reference_n = before.reference_n + ratio * (after.reference_n - before.reference_n);
        }
    }
}

#[test]
fn a_reference_slower_than_the_cycle_is_judged_where_it_was_measured() {
    for seed in [70_014, 70_015, 70_016] {
        let (mut points, truth) = points_of(&Case { seed, ..Case::of(Group::Nothing) });
        with_slow_reference(&mut points, 10, 0.06, seed);
        let found = look(&[&points], &truth);
        assert_complete(&found, truth.floor_n.hypot(0.06));
        let used = found.samples.used + found.samples.warm_up / 10;
        assert!(used.abs_diff(points.len() / 10) < 50, "{:?}", found.samples);
    }
}

/// White noise of the length rubs in a model that takes it for motion; kept out, it hides no effect, and the extended file keeps it out as well.
#[test]
fn noise_of_the_length_is_told_and_hides_no_effect() {
    let noise_m = 3e-6;
    let (mut points, truth) = points_of(&Case { seed: 70_014, ..Case::hiding(Group::Single, &[Effect::SensorGain]) });
    points.truncate(16_000);
    let random = &mut ChaCha8Rng::seed_from_u64(70_014);
    for point in &mut points {
        let drawn: f64 = StandardNormal.sample(random);
        point.cable.length_m += noise_m * drawn;
    }
    let found = look(&[&points], &truth);
    let kinds: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
    assert_eq!(kinds, [Effect::SensorGain], "{:?}", found.tried);
    let [fault] = found.faults.as_slice() else { panic!("{:?}", found.faults) };
    let (key, told_m) = fault.parameters[0];
    assert_eq!((fault.fault, key), (Fault::NoisyLength, "noise_m"));
    assert!((told_m / noise_m - 1.0).abs() < 0.05, "{told_m}");
    let [before_n, after_n] = [&found.before, &found.after].map(|model| model.held_out_n.rms().unwrap());
    assert!(before_n > 2.0 * truth.floor_n && after_n < 1.3 * truth.floor_n, "{before_n} {after_n}");
    let text = extended(&truth.robot.to_toml().unwrap(), "extended", std::slice::from_ref(&found)).unwrap();
    let told = RobotFile::parse(&text, "extended").unwrap().options().monitor.length_noise_m.unwrap();
    assert!((told / (2.0 * told_m) - 1.0).abs() < 1e-12, "{told}");
}

/// The reference of each sample is that of so much earlier, by the true forces between two cycles.
#[expect(clippy::cast_possible_truncation, reason = "a place in the log")]
fn with_late_reference(points: &mut [Point], late_cycles: impl Fn(usize) -> f64) {
    let before: Vec<f64> = points.iter().map(|point| point.reference_n).collect();
    for (cycle, point) in points.iter_mut().enumerate() {
        let at = f64::from(u32::try_from(cycle).unwrap()) - late_cycles(cycle);
        let whole = at.floor();
        let known = |place: f64| {
            let place = usize::try_from(place as i64).ok();
            place.and_then(|place| before.get(place)).copied().unwrap_or(f64::NAN)
        };
        point.reference_n = known(whole) + (at - whole) * (known(whole + 1.0) - known(whole));
    }
}

#[test]
fn a_late_reference_is_put_where_it_belongs_and_hides_no_effect() {
    for (seed, effects) in [(70_017, &[][..]), (70_018, &[Effect::Stribeck][..])] {
        let group = if effects.is_empty() { Group::Nothing } else { Group::Single };
        let (mut points, truth) = points_of(&Case { seed, ..Case::hiding(group, effects) });
        with_late_reference(&mut points, |_| 6.0);
        let found = look(&[&points], &truth);
        let kinds: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
        assert_eq!(kinds, effects, "{:?}", found.tried);
        let [fault] = found.faults.as_slice() else { panic!("{:?}", found.faults) };
        let (key, told_s) = fault.parameters[0];
        assert_eq!((fault.fault, key), (Fault::ReferenceDelay, "delay_s"));
        assert!((told_s / 6e-3 - 1.0).abs() < 0.05, "{told_s}");
        assert!(found.verdict != Verdict::Unexplained, "{:?}", found.unexplained);
    }
}

#[test]
fn an_early_reference_is_told_and_a_sensor_that_lags_is_none() {
    let (mut points, truth) = points_of(&Case { seed: 70_021, ..Case::of(Group::Nothing) });
    with_late_reference(&mut points, |_| -30.0);
    let found = look(&[&points], &truth);
    let [fault] = found.faults.as_slice() else { panic!("{:?}", found.faults) };
    let (key, told_s) = fault.parameters[0];
    assert_eq!((fault.fault, key, found.findings.len()), (Fault::ReferenceDelay, "delay_s", 0));
    assert!((told_s / -30e-3 - 1.0).abs() < 0.05, "{told_s}");
    assert_eq!(found.verdict, Verdict::Complete, "{:?}", found.unexplained);

    let (points, truth) = points_of(&Case { seed: 70_022, ..Case::hiding(Group::Single, &[Effect::SensorLag]) });
    let found = look(&[&points], &truth);
    let kinds: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
    assert_eq!((kinds, found.faults.len()), (vec![Effect::SensorLag], 0), "{:?}", found.faults);
}

#[test]
fn a_clock_that_runs_otherwise_is_told() {
    let (mut points, truth) = points_of(&Case { seed: 70_019, ..Case::of(Group::Nothing) });
    with_late_reference(&mut points, |cycle| -4e-4 * f64::from(u32::try_from(cycle).unwrap()));
    let found = look(&[&points], &truth);
    let [fault] = found.faults.as_slice() else { panic!("{:?}", found.faults) };
    let (key, told) = fault.parameters[0];
    assert_eq!((fault.fault, key, found.findings.len()), (Fault::ClockSkew, "skew_ratio", 0));
    assert!((told / 4e-4 - 1.0).abs() < 0.05, "{told}");
    assert_eq!(found.verdict, Verdict::Complete, "{:?}", found.unexplained);
}

/// What is missing from the given model hides the time error until it has its name.
#[test]
fn a_clock_that_runs_otherwise_is_told_beside_an_effect() {
    let (mut points, truth) = points_of(&Case { seed: 70_023, ..Case::hiding(Group::Single, &[Effect::PulleyDefect]) });
    with_late_reference(&mut points, |cycle| 4.0 + 4e-4 * f64::from(u32::try_from(cycle).unwrap()));
    let found = look(&[&points], &truth);
    let kinds: Vec<Effect> = found.findings.iter().map(|finding| finding.effect).collect();
    assert_eq!((kinds, found.verdict), (vec![Effect::PulleyDefect], Verdict::Extended), "{:?}", found.tried);
    let [fault] = found.faults.as_slice() else { panic!("{:?}", found.faults) };
    assert_eq!(fault.fault, Fault::ClockSkew);
    let told = |key: &str| fault.parameters.iter().find(|(of, _)| *of == key).unwrap().1;
    assert!((told("skew_ratio") / -4e-4 - 1.0).abs() < 0.05, "{:?}", fault.parameters);
    assert!((told("delay_s") / 4e-3 - 1.0).abs() < 0.05, "{:?}", fault.parameters);
}

#[test]
fn spikes_and_coarse_steps_are_told() {
    let (points, truth) = points_of(&Case { seed: 70_020, ..Case::of(Group::Nothing) });
    let mut spiked = points.clone();
    for place in [12_345, 23_456, 40_001] {
        spiked[place].cable.sensor_force_n += 10.0;
    }
    let found = look(&[&spiked], &truth);
    assert_complete(&found, truth.floor_n);
    let [fault] = found.faults.as_slice() else { panic!("{:?}", found.faults) };
    let starts_s: Vec<f64> = fault.intervals_s.iter().map(|interval_s| interval_s[0]).collect();
    assert!(fault.fault == Fault::Spikes && starts_s.len() == 3, "{fault:?}");
    assert!(starts_s.iter().zip([12.345, 23.456, 40.001]).all(|(told_s, true_s)| (told_s - true_s).abs() < 2e-3));

    // Far less than the friction, but twenty times the noise, in which no other sample shares.
    let mut small = points.clone();
    for place in [12_345, 23_456, 40_001] {
        small[place].cable.sensor_force_n += 0.4;
    }
    let found = look(&[&small], &truth);
    assert_complete(&found, truth.floor_n);
    let [fault] = found.faults.as_slice() else { panic!("{:?}", found.faults) };
    assert!(fault.fault == Fault::Spikes && fault.intervals_s.len() == 3, "{fault:?}");

    let mut coarse = points;
    for point in &mut coarse {
        point.cable.sensor_force_n = (point.cable.sensor_force_n / 0.06).round() * 0.06;
    }
    let found = look(&[&coarse], &truth);
    let [fault] = found.faults.as_slice() else { panic!("{:?}", found.faults) };
    let (key, step_n) = fault.parameters[0];
    assert_eq!((fault.fault, key, found.findings.len()), (Fault::CoarseConverter, "step_n", 0));
    assert!((step_n - 0.06).abs() < 1e-9, "{step_n}");
}

/// A log writes the last value of a slow device until the next one comes. Only the first of them is measured; the steps are no hum and no delay.
#[test]
fn what_a_slow_device_repeats_is_not_counted() {
    let (points, truth) = points_of(&Case { seed: 70_021, ..Case::of(Group::Nothing) });
    // How often reference, force and length are shown.
    for times in [[4, 1, 1], [1, 4, 1], [1, 2, 1], [1, 1, 2], [4, 4, 4]] {
        let mut shown = points.clone();
        for (place, point) in shown.iter_mut().enumerate() {
            let [reference, force, length] = times.map(|times| &points[place - place % times]);
            point.reference_n = reference.reference_n;
            point.cable.sensor_force_n = force.cable.sensor_force_n;
            point.cable.length_m = length.cable.length_m;
        }
        let found = look(&[&shown], &truth);
        assert_eq!(found.faults, [], "{times:?}");
        assert_complete(&found, truth.floor_n);
    }
}

/// A device that stands still for 20 ms shows more identical values than its noise makes.
#[test]
fn short_stretches_that_stand_still_are_told() {
    let (points, truth) = points_of(&Case { seed: 70_022, ..Case::of(Group::Nothing) });
    let starts = [12_345, 23_456, 30_000, 40_001];
    let (mut frozen, mut without) = (points.clone(), points);
    for start in starts {
        for place in start..start + 20 {
            frozen[place].cable.sensor_force_n = frozen[start].cable.sensor_force_n;
            without[place].reference_n = without[start].reference_n;
        }
    }
    let found = look(&[&frozen], &truth);
    assert_complete(&found, truth.floor_n);
    let [fault] = found.faults.as_slice() else { panic!("{:?}", found.faults) };
    assert!(fault.fault == Fault::Frozen && fault.intervals_s.len() == starts.len(), "{fault:?}");
    let found = look(&[&without], &truth);
    assert_complete(&found, truth.floor_n);
    assert!(found.samples.without_reference >= 4 * 20, "{:?}", found.samples);
}

#[test]
fn a_coarse_reference_is_told() {
    let (mut points, truth) = points_of(&Case { seed: 70_023, ..Case::of(Group::Nothing) });
    for point in &mut points {
        point.reference_n = (point.reference_n / 0.04).round() * 0.04;
    }
    let found = look(&[&points], &truth);
    let [fault] = found.faults.as_slice() else { panic!("{:?}", found.faults) };
    let (key, step_n) = fault.parameters[0];
    assert_eq!((fault.fault, key, found.findings.len()), (Fault::CoarseConverter, "reference_step_n", 0));
    assert!((step_n - 0.04).abs() < 1e-9, "{step_n}");
}
