//! What is in no catalogue: a table where it goes with a condition of the cable, nothing where it does not, and never a name.

use std::f64::consts::TAU;

use fric_core::effects::empirical::{Over, SHARE_PLACES, SIZE};
use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, Pose, Sample};
use fric_lab::discover::{CableDiscovery, DiscoverOptions, Verdict, discover, extended};
use fric_lab::fit::{Measurements, Parameter, Progress, Reference, SampleStore};
use fric_lab::simulate::SimulationOptions;
use fric_lab::simulate::sweep::{Case, Group};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::simulate::robots::{eight_cables, simulate};

/// Of the samples every so many: a discovery takes as much less time.
const THINNED: usize = 4;

/// A log of one cable whose model is known but for what is added to its reference.
struct Log {
    robot: RobotFile,
    text: String,
    points: Vec<(i64, CableInput, f64, Option<Pose>)>,
}

impl Log {
    fn of(case: &Case) -> Self {
        let mut log = case.log().unwrap();
        let mut points = Vec::new();
        while let Some(sample) = log.simulation.next_cycle() {
            points.push((sample.stamp_nanos, sample.cables[0], sample.reference_force_n[0], sample.pose));
        }
        let points = points.into_iter().step_by(THINNED).collect();
        Self { robot: log.robot, text: log.robot_text, points }
    }

    /// With a force at the platform that no model has: of speed, length and half the sensor's force, s since the start.
    fn with(mut self, force_n: impl Fn(f64, f64, f64, f64) -> f64) -> Self {
        let first = self.points[0].0;
        for (stamp_nanos, cable, reference_n, _) in &mut self.points {
            #[expect(clippy::cast_precision_loss, reason = "a run")]
            let time_s = (*stamp_nanos - first) as f64 * 1e-9;
            *reference_n += force_n(cable.speed_m_per_s, cable.length_m, 0.5 * cable.sensor_force_n, time_s);
        }
        self
    }

    fn look(&self, robot: &RobotFile, options: DiscoverOptions) -> CableDiscovery {
        let params = robot.params();
        let mut measurements = Measurements::new(&params, Reference::Forces);
        measurements.start_log();
        for (stamp_nanos, cable, reference_n, pose) in &self.points {
            measurements.add(&Sample {
                stamp_nanos: *stamp_nanos,
                cables: &[*cable],
                reference_force_n: &[*reference_n],
                pose: *pose,
                outside_wrench: None,
            });
        }
        discover(&measurements.into(), &options, &Progress::new()).unwrap().remove(0)
    }

    fn mean(&self, of: impl Fn(&CableInput) -> f64) -> f64 {
        self.points.iter().map(|(_, cable, ..)| of(cable)).sum::<f64>()
            / f64::from(u32::try_from(self.points.len()).unwrap())
    }
}

fn closed(found: &CableDiscovery) -> f64 {
    let [before_n, after_n] = [&found.before, &found.after].map(|model| model.held_out_n.rms().unwrap());
    1.0 - (after_n - found.noise_floor_n) / (before_n - found.noise_floor_n)
}

fn kinds(found: &CableDiscovery) -> Vec<&'static str> {
    found.findings.iter().map(|finding| finding.effect.kind()).collect()
}

/// What a model's table changes at each of its places, by the equation.
fn points(found: &CableDiscovery, over: Over, size: usize) -> Vec<(f64, f64)> {
    let values = &found.after.values;
    let (from, to) = (values[over.from()], values[over.to()]);
    let places = (0_u32..).map(|place| from + (to - from) * f64::from(place) / 11.0);
    places.zip(SHARE_PLACES.map(|place| values[size] * values[place])).collect()
}

#[test]
fn a_force_over_the_length_becomes_a_table_and_no_name() {
    let log = Log::of(&Case { seed: 80_001, ..Case::of(Group::Nothing) });
    let middle_m = log.mean(|cable| cable.length_m);
    let truth_n = |length_m: f64| 0.12 * ((length_m - middle_m) / 0.03).tanh();
    let log = log.with(|_, length_m, _, _| truth_n(length_m));
    let found = log.look(&log.robot, DiscoverOptions::default());
    assert_eq!((kinds(&found), found.verdict), (vec!["empirical"], Verdict::Unexplained));
    assert!(closed(&found) > 0.9, "{}", closed(&found));
    let rest = found.unexplained.as_ref().unwrap();
    assert!(rest.places.iter().any(|place| place.signal == "length"), "{:?}", rest.places);
    assert!(rest.rms_n > 0.05, "{}", rest.rms_n);
    // The force itself, at the middle of the range and at its ends.
    assert_eq!(Over::of(|place| found.after.values[place]), Some(Over::Length));
    for (length_m, force_n) in points(&found, Over::Length, SIZE) {
        assert!((force_n - truth_n(length_m)).abs() < 0.04, "{length_m} m: {force_n} N");
    }
    let of_share = Parameter::named("empirical.share_2").unwrap();
    assert!(found.after.standard_error(&of_share).unwrap() > 0.0);

    // Its own extended file is the same model: nothing is named, and the same is left.
    let text = extended(&log.text, "extended", std::slice::from_ref(&found)).unwrap();
    assert!(!text.contains("speed_from_m_per_s") && text.contains("length_from_m"), "{text}");
    let again = log.look(&RobotFile::parse(&text, "extended").unwrap(), DiscoverOptions::default());
    assert_eq!((kinds(&again), again.verdict), (vec![], Verdict::Unexplained));
    let [once_n, twice_n] = [&found, &again].map(|of| of.after.held_out_n.rms().unwrap());
    assert!((twice_n / once_n - 1.0).abs() < 0.02, "{once_n} {twice_n}");
    let [once_n, twice_n] = [&found, &again].map(|of| of.unexplained.as_ref().unwrap().rms_n);
    assert!((twice_n / once_n - 1.0).abs() < 0.1, "{once_n} {twice_n}");

    // Without tables it stays as it is.
    let without = log.look(&log.robot, DiscoverOptions { empirical: false, ..DiscoverOptions::default() });
    assert_eq!((kinds(&without), without.verdict), (vec![], Verdict::Unexplained));
    assert!(closed(&without) < 0.2, "{}", closed(&without));
}

#[test]
fn a_bump_over_the_load_becomes_a_table() {
    let log = Log::of(&Case { seed: 80_003, ..Case::of(Group::Nothing) });
    let middle_n = log.mean(|cable| 0.5 * cable.sensor_force_n);
    let log = log.with(|_, _, load_n, _| 0.2 * (-((load_n - middle_n) / 0.6).powi(2)).exp());
    let found = log.look(&log.robot, DiscoverOptions::default());
    assert_eq!((kinds(&found), found.verdict), (vec!["empirical"], Verdict::Unexplained));
    assert_eq!(Over::of(|place| found.after.values[place]), Some(Over::Load));
    assert!(closed(&found) > 0.5, "{}", closed(&found));
}

/// A sensor whose zero goes up and down: what goes with the time alone says nothing about the next run.
#[test]
fn what_goes_with_no_condition_becomes_no_table() {
    let log = Log::of(&Case { seed: 80_009, ..Case::of(Group::Nothing) });
    let log = log.with(|_, _, _, time_s| 0.1 * (time_s / 3.0).sin());
    let found = log.look(&log.robot, DiscoverOptions::default());
    assert_eq!((kinds(&found), found.verdict), (vec![], Verdict::Unexplained));
}

/// Two of eight cables, of which one's force couples into the other's reference.
#[test]
fn the_force_of_another_cable_becomes_no_table() {
    let all = eight_cables();
    let mut options = all.options().clone();
    options.cable.truncate(2);
    let robot = RobotFile::check(options).unwrap();
    let params = robot.params();
    let mut simulation = simulate(&all, &SimulationOptions { seed: 80_020, ..SimulationOptions::default() });
    let mut measurements = Measurements::new(&params, Reference::Forces);
    let mut stored = SampleStore::new(&params, Reference::Forces).within(100_000);
    measurements.start_log();
    stored.start_log();
    let mut cycle = 0;
    while let Some(sample) = simulation.next_cycle() {
        cycle += 1;
        if cycle % THINNED == 0 {
            let reference_n =
                [sample.reference_force_n[0] + 0.05 * (sample.reference_force_n[1] - 6.0), sample.reference_force_n[1]];
            let sample = Sample { cables: &sample.cables[..2], reference_force_n: &reference_n, ..sample };
            measurements.add(&sample);
            stored.add(&sample).unwrap();
        }
    }
    let look = |samples: &SampleStore<'_>| discover(samples, &DiscoverOptions::default(), &Progress::new()).unwrap();
    let found = look(&measurements.into());
    // The other cable is loaded from a file as well.
    assert_eq!(format!("{:?}", look(&stored)), format!("{found:?}"));
    let tables = found.iter().filter(|cable| kinds(cable).contains(&"empirical")).count();
    assert_eq!(tables, 0, "{:?}", found.iter().map(|cable| (kinds(cable), cable.verdict)).collect::<Vec<_>>());
}

/// The load of a bench under constant force varies by less than the friction, which approaches its value over 8 mm after each reversal as in no catalogue.
/// How the force depends on the load is unknown there: a table over the load, which the sensor shows with its noise, would only remove that noise.
#[test]
fn a_load_that_hardly_varies_gets_no_table() {
    for seed in 0..6 {
        let log = bench_under_constant_force(seed);
        let found = log.look(&log.robot, DiscoverOptions::default());
        assert!(
            kinds(&found).iter().all(|kind| !["empirical", "sensor_gain"].contains(kind)),
            "{seed}: {:?}",
            kinds(&found)
        );
    }
}

fn bench_under_constant_force(seed: u64) -> Log {
    let text = "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = 0.004\n[[cable]]\nname = \"a\"\npulleys = [{ wrap_deg = 180.0 }]\n\
                friction = { mu = 0.008, sigma_n_per_m = 1e4, viscous_n_s_per_m = 1.0 }\n";
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noise = |deviation_n: f64| -> f64 {
        let number: f64 = StandardNormal.sample(&mut random);
        deviation_n * number
    };
    let at = |cycle: u32| {
        let angle = TAU * 0.001 * f64::from(cycle);
        (1.0 + 0.1 * angle.sin(), 0.1 * TAU / 4.0 * angle.cos())
    };
    // The friction, and where and at which friction the motion turned last.
    let (mut friction_n, mut turned) = (0.0, (1.0, 0.0));
    let mut points = Vec::new();
    for (cycle, stamp_nanos) in (0..8000).zip((0..).step_by(4_000_000)) {
        let (length_m, speed_m_per_s) = at(cycle);
        if cycle > 0 && speed_m_per_s * at(cycle - 1).1 < 0.0 {
            turned = (length_m, friction_n);
        }
        let end_n = 6.0 * speed_m_per_s.signum();
        friction_n = end_n - (end_n - turned.1) * (-(length_m - turned.0).abs() / 0.008).exp();
        let load_n = 250.0 - 0.06 * friction_n + 0.2 * (TAU * 0.004 / 7.0 * f64::from(cycle)).sin();
        let cable = CableInput { sensor_force_n: load_n - friction_n + noise(0.1), length_m, speed_m_per_s };
        points.push((stamp_nanos, cable, load_n + noise(0.05), None));
    }
    Log { robot: RobotFile::parse(text, "bench").unwrap(), text: text.to_owned(), points }
}
