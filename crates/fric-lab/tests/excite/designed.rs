//! Runs designed for a question: limits hold, forecasts come true on the simulated robot, and what cannot be told is said.

use fric_core::effects::Effect;
use fric_core::parameters::{MU, SIGMA};
use fric_core::robot::file::RobotFile;
use fric_lab::excite::{
    Aim, Excitation, ExcitationError, ExcitationOptions, Experiment, Goal, KnownParameter, Question, design,
};
use fric_lab::fit::{FitOptions, Measurements, Parameter, Progress, Reference, fit_cables};
use fric_lab::simulate::{HiddenEffect, Simulation, SimulationOptions};

use crate::simulate::robots::slow_eight;

const NOISE_N: f64 = 0.0141;
const DURATION_S: f64 = 8.0;

/// A drive whose cycle takes 4 ms.
fn drive(line: &str) -> RobotFile {
    let text = format!(
        "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = 0.004\n[platform]\nmass_kg = 0.5\n[[cable]]\nname = \"drive\"\n\
         pulleys = [{{ wrap_deg = 180.0, sensor = true }}, {{ wrap_deg = 90.0 }}, {{ wrap_deg = 90.0 }}]\n\
         friction = {{ mu = 0.019, sigma_n_per_m = 950.0, viscous_n_s_per_m = 0.2 }}\n{line}"
    );
    RobotFile::parse(&text, "bench").unwrap()
}

fn question(aim: Aim) -> Question {
    Question { cable: 0, noise_n: NOISE_N, values: None, aim }
}

fn determine(names: &[&str]) -> Question {
    question(Aim::Determine(Parameter::all_named(names.iter().copied()).unwrap()))
}

fn designed(robot: &RobotFile, options: &ExcitationOptions, question: Question) -> Result<Experiment, ExcitationError> {
    design(robot, options, DURATION_S, &[question], &Progress::new())
}

fn loads(least_n: f64, greatest_n: f64) -> ExcitationOptions {
    ExcitationOptions { min_tension_n: Some(least_n), max_tension_n: Some(greatest_n), ..ExcitationOptions::default() }
}

fn measured<'a>(robot: &'a RobotFile, run: &Excitation, options: &SimulationOptions) -> Measurements<'a> {
    let mut simulation = Simulation::following(robot, options, run).unwrap();
    let mut measurements = Measurements::new(&robot.params(), Reference::Forces);
    while let Some(sample) = simulation.next_cycle() {
        measurements.add(&sample);
    }
    measurements
}

/// The simulated bench shares no code with the forecast but the kinematics.
#[test]
fn standard_errors_are_those_that_a_fit_then_finds_and_less_than_those_of_the_identification_run() {
    let robot = drive("");
    let experiment = designed(&robot, &loads(3.0, 9.0), determine(&["mu", "sigma_n_per_m"])).unwrap();
    let forecast = &experiment.forecasts[0];
    let known = |goal: &Goal| match goal {
        Goal::Determined(known) => known.clone(),
        Goal::Separated { .. } => panic!("{goal:?}"),
    };
    let (expected, standard) = (known(&forecast.goal), known(forecast.standard.as_ref().unwrap()));
    assert!(forecast.goal.tells() && forecast.goal.score() > forecast.standard.as_ref().unwrap().score());
    let mu_and_sigma: Vec<usize> = expected.iter().map(|known| known.parameter.place()).collect();
    assert_eq!(mu_and_sigma, [MU, SIGMA]);
    let fit = &fit_cables(
        &measured(
            &robot,
            &experiment.excitation,
            &SimulationOptions { duration_s: Some(DURATION_S), ..Default::default() },
        ),
        &FitOptions::default(),
        &Progress::new(),
    )[0];
    for (known, standard) in expected.iter().zip(standard) {
        let KnownParameter { parameter, standard_error, .. } = *known;
        let found = fit.standard_error(&parameter).unwrap();
        assert!(
            (0.5..2.0).contains(&(found / standard_error)),
            "{parameter}: {standard_error} expected, {found} found"
        );
        assert!(standard_error < standard.standard_error, "{parameter}");
    }
}

/// Of two effects that look alike, the evidence between them is what the fits of both models to a simulated log come to.
#[test]
fn evidence_is_what_fits_of_both_models_then_come_to() {
    let hidden = "effects = [{ kind = \"bearing_drag\", drag_n = 0.02 }]\n";
    let robot = drive(hidden);
    let aim = Aim::Separate([Some(Effect::BearingDrag), Some(Effect::LoadNonlinearity)]);
    let experiment = designed(&robot, &loads(2.0, 10.0), question(aim)).unwrap();
    let Goal::Separated { delta_bic: [Some(expected), Some(_)], .. } = experiment.forecasts[0].goal else {
        panic!("{:?}", experiment.forecasts)
    };
    // Both models from the robot without either.
    let bare = drive("");
    let options = SimulationOptions { duration_s: Some(DURATION_S), seed: 3, ..SimulationOptions::default() };
    let mut simulation = Simulation::following(&robot, &options, &experiment.excitation).unwrap();
    let mut measurements = Measurements::new(&bare.params(), Reference::Forces);
    while let Some(sample) = simulation.next_cycle() {
        measurements.add(&sample);
    }
    let square = |kind: &str| {
        let names = ["mu", "sigma_n_per_m", "viscous_n_s_per_m", "offset_n", kind];
        let options = FitOptions { parameters: Some(Parameter::all_named(names).unwrap()), ..FitOptions::default() };
        fit_cables(&measurements, &options, &Progress::new())[0].errors.after_n.rms().unwrap().powi(2)
    };
    let [right, wrong] = ["bearing_drag.drag_n", "load_nonlinearity.exponent"].map(square);
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let found = 0.5 * measurements.len() as f64 * (wrong / right).ln();
    assert!((0.5..2.0).contains(&(found / expected)), "{expected} expected, {found} found");
}

#[test]
fn a_platform_stays_in_its_box_within_its_limits_and_takes_its_time() {
    let robot = slow_eight();
    let options = ExcitationOptions {
        box_m: Some([[-0.1, -0.08, -0.12], [0.12, 0.06, 0.08]]),
        max_speed_m_per_s: Some(0.4),
        max_acceleration_m_per_s2: Some(5.0),
        min_tension_n: Some(2.0),
        max_tension_n: Some(30.0),
    };
    let Experiment { mut excitation, forecasts } =
        design(&robot, &options, 4.0, &[determine(&["mu"])], &Progress::new()).unwrap();
    assert!(forecasts[0].goal.tells(), "{forecasts:?}");
    let mut last: Option<Vec<f64>> = None;
    let mut count = 0;
    while let Some(cycle) = excitation.next_cycle().unwrap() {
        let set_point = cycle.platform.unwrap();
        for (axis, [least_m, greatest_m]) in [[-0.1, 0.12], [-0.08, 0.06], [-0.12, 0.08]].into_iter().enumerate() {
            assert!((least_m - 1e-9..=greatest_m + 1e-9).contains(&set_point.position_m[axis]));
        }
        assert!(set_point.velocity_m_per_s.norm() <= 0.4 + 1e-9);
        assert!(set_point.acceleration_m_per_s2.norm() <= 5.0 + 1e-9);
        let forces_n = cycle.tensions_n.unwrap();
        assert!(forces_n.iter().all(|force_n| (2.0..=30.0).contains(force_n)), "{forces_n:?}");
        for (force_n, last_n) in forces_n.iter().zip(last.iter().flatten()) {
            assert!((force_n - last_n).abs() < 1.0, "{}: {last_n} N, then {force_n} N", cycle.time_s);
        }
        last = Some(forces_n.to_vec());
        count += 1;
    }
    assert_eq!(count, 1000);
}

#[test]
fn a_bench_states_its_load_only_where_it_can_change_it() {
    let robot = drive("");
    let mut run = designed(&robot, &loads(3.0, 9.0), determine(&["mu"])).unwrap().excitation;
    assert_eq!(run.tension_bounds_n(), Some((3.0, Some(9.0))));
    while let Some(cycle) = run.next_cycle().unwrap() {
        assert!((3.0..=9.0).contains(&cycle.tensions_n.unwrap()[0]));
        assert!((0.8..=1.2).contains(&cycle.cables[0].length_m));
    }
    let mut run = designed(&robot, &ExcitationOptions::default(), determine(&["mu"])).unwrap().excitation;
    assert!(run.next_cycle().unwrap().unwrap().tensions_n.is_none() && run.tension_bounds_n().is_none());

    let known = "[log]\nreference = { constant_n = 5.0 }\n";
    let error = designed(&drive(known), &loads(3.0, 9.0), determine(&["mu"])).unwrap_err();
    assert!(matches!(error, ExcitationError::LoadIsKnown { .. }), "{error}");
    let only_least = ExcitationOptions { min_tension_n: Some(3.0), ..ExcitationOptions::default() };
    let error = designed(&robot, &only_least, determine(&["mu"])).unwrap_err();
    assert!(matches!(error, ExcitationError::NoGreatestLoad { .. }), "{error}");
}

#[test]
fn what_no_run_can_tell_and_what_cannot_be_asked_is_said() {
    let robot = drive("");
    // Under one load a drag and another law of the load are the same.
    let apart = Aim::Separate([Some(Effect::BearingDrag), Some(Effect::LoadNonlinearity)]);
    let error = designed(&robot, &ExcitationOptions::default(), question(apart)).unwrap_err();
    let ExcitationError::CannotTell { what, .. } = &error else { panic!("{error}") };
    assert!(what.contains("bearing_drag from load_nonlinearity on drive"), "{error}");
    assert!(error.to_string().contains("no run of 8 s"), "{error}");

    let bad = |question| designed(&robot, &ExcitationOptions::default(), question).unwrap_err().to_string();
    assert!(bad(determine(&["stribeck.ratio"])).contains("no `stribeck`"));
    assert!(bad(question(Aim::Separate([Some(Effect::Stribeck); 2]))).contains("two different effects"));
    assert!(bad(Question { noise_n: f64::NAN, ..determine(&["mu"]) }).contains("`noise_n` is NaN"));
    let short = design(&robot, &ExcitationOptions::default(), 0.5, &[determine(&["mu"])], &Progress::new());
    assert!(matches!(short, Err(ExcitationError::OptionOutOfRange { key: "duration_s", .. })));
}

/// A run with hidden effects is simulated with the loads that it states.
#[test]
fn a_simulation_follows_the_loads_of_the_run() {
    let robot = drive("");
    let run = designed(&robot, &loads(3.0, 9.0), determine(&["mu"])).unwrap().excitation;
    let quiet = SimulationOptions {
        duration_s: Some(DURATION_S),
        sensor_noise_n: 0.0,
        reference_noise_n: 0.0,
        effects: vec![HiddenEffect::new("stribeck", &[("ratio", 0.3)]).unwrap()],
        ..SimulationOptions::default()
    };
    let (mut simulation, mut set_points) = (Simulation::following(&robot, &quiet, &run).unwrap(), run);
    while let Some(sample) = simulation.next_cycle() {
        let cycle = set_points.next_cycle().unwrap().unwrap();
        assert!((sample.reference_force_n[0] - cycle.tensions_n.unwrap()[0]).abs() < 1e-12);
    }
}
