//! Hides one of two effects that look alike in a simulated test bench and lets the discovery tell which, once from the first 20 s of the
//! identification run and once from a run that was designed for the question: `experiments [SEEDS] [WORDS]`.
//!
//! SEEDS is how many seeds each pair is tried with (1); WORDS, divided by commas, keeps the pairs in whose names one of them is. Effects
//! have half of the strength that machines have. A run tells where the discovery names the hidden effect, not the other, and
//! says of no other effect that it would do as well. Each case is printed as it ends; `docs/experiments.md` has the table.

#![allow(missing_docs, clippy::print_stdout, clippy::expect_used)]

use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_lab::discover::{CableDiscovery, DiscoverOptions, discover};
use fric_lab::excite::{Aim, Excitation, ExcitationOptions, Goal, Question, STANDARD_DURATION_S, design};
use fric_lab::fit::{Measurements, Progress, Reference};
use fric_lab::simulate::sweep::{Case, CaseTruth, Group};
use fric_lab::simulate::{Simulation, SimulationOptions};

/// What is hidden, and what it is to be told from.
const PAIRS: [[Effect; 2]; 12] = [
    [Effect::BearingDrag, Effect::LoadNonlinearity],
    [Effect::LoadNonlinearity, Effect::BearingDrag],
    [Effect::Stribeck, Effect::DwellStiction],
    [Effect::DwellStiction, Effect::Stribeck],
    [Effect::SensorNonlinearity, Effect::SensorGain],
    [Effect::FrictionDrift, Effect::FrictionWarmup],
    [Effect::SensorDrift, Effect::SensorWarmup],
    [Effect::SensorLag, Effect::TimeDelay],
    [Effect::PulleyInertia, Effect::TimeDelay],
    [Effect::GearBacklash, Effect::PreslidingShape],
    [Effect::ViscousNonlinearity, Effect::Stribeck],
    [Effect::PulleyEccentricity, Effect::WinchRipple],
];
/// Bounds of the load, as shares of what the bench has for the most part.
const LOADS: [f64; 2] = [0.5, 1.5];

fn main() {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().map_or(1, |text| text.parse().expect("a count of seeds"));
    let words: Vec<String> =
        arguments.next().map_or_else(Vec::new, |text| text.split(',').map(str::to_owned).collect());
    for [hidden, other] in PAIRS {
        let name = format!("{}/{}", hidden.kind(), other.kind());
        if !words.is_empty() && !words.iter().any(|word| name.contains(word.as_str())) {
            continue;
        }
        for seed in 0..seeds {
            println!("{name} #{seed}: {}", tried(hidden, other, 7000 + seed));
        }
    }
}

fn tried(hidden: Effect, other: Effect, seed: u64) -> String {
    let case = Case { strength_ratio: 0.5, seed, ..Case::hiding(Group::Bench, &[hidden]) };
    let log = case.log().expect("the case can be simulated");
    let (truth, user) = (&log.truth, &log.robot);
    let options = SimulationOptions {
        seed,
        duration_s: Some(STANDARD_DURATION_S),
        mu_spread_ratio: 0.1,
        effects: truth.effects.clone(),
        ..SimulationOptions::default()
    };
    let mut standard = Simulation::new(&truth.robot, &options).expect("the bench can be simulated");
    let found = searched(user, &mut standard);
    let first = told(&found, hidden, other);

    // The question as the first log leaves it: its model, and the effect that it found, if it is one of the two.
    let named = |effect: Effect| found.findings.iter().any(|finding| finding.effect == effect);
    let order = if named(other) { [other, hidden] } else { [hidden, other] };
    let question = Question {
        cable: 0,
        noise_n: found.noise_floor_n,
        values: Some(found.after.values),
        aim: Aim::Separate(order.map(Some)),
    };
    let mean_n = mean_load_n(truth);
    let [least_n, greatest_n] = LOADS.map(|share| Some(share * mean_n));
    let limits =
        ExcitationOptions { min_tension_n: least_n, max_tension_n: greatest_n, ..ExcitationOptions::default() };
    let experiment = match design(user, &limits, STANDARD_DURATION_S, &[question], &Progress::new()) {
        Ok(experiment) => experiment,
        Err(error) => return format!("standard {first}; no run: {error}"),
    };
    let forecast = match &experiment.forecasts[0].goal {
        Goal::Separated { effects, delta_bic } => {
            let place = effects.iter().position(|effect| *effect == Some(hidden)).expect("it is one of the two");
            delta_bic[place].unwrap_or(f64::NAN)
        }
        Goal::Determined(_) => f64::NAN,
    };
    let mut designed = following(truth, &options, &experiment.excitation);
    let second = told(&searched(user, &mut designed), hidden, other);
    format!("standard {first}; designed {second}, forecast {forecast:.0}")
}

fn following(truth: &CaseTruth, options: &SimulationOptions, run: &Excitation) -> Simulation {
    Simulation::following(&truth.robot, options, run).expect("the run can be simulated")
}

/// The load of the bench, N: the platform's weight with what viscous friction takes at 1 m/s, as the simulation has it.
fn mean_load_n(truth: &CaseTruth) -> f64 {
    let options = truth.robot.options();
    let viscous: f64 = options
        .cable
        .iter()
        .map(|cable| cable.pulleys.iter().map(|_| cable.friction.viscous_n_s_per_m).sum::<f64>())
        .fold(0.0, f64::max);
    truth.robot.params().mass_kg() * 9.80665 + viscous
}

fn searched(user: &RobotFile, simulation: &mut Simulation) -> CableDiscovery {
    let params = user.params();
    let mut measurements = Measurements::new(&params, Reference::Forces);
    while let Some(sample) = simulation.next_cycle() {
        measurements.add(&sample);
    }
    let found = discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new());
    found.expect("a short log fits into memory").remove(0)
}

/// Whether the discovery tells the hidden effect, what it names, and the evidence for the hidden effect over the other, each beside the
/// given model.
fn told(found: &CableDiscovery, hidden: Effect, other: Effect) -> String {
    let names: Vec<&str> = found.findings.iter().map(|finding| finding.effect.kind()).collect();
    let of = |effect: Effect| found.candidates.iter().find(|candidate| candidate.effect == effect);
    let margin = of(other).zip(of(hidden)).map_or(f64::NAN, |(other, hidden)| other.delta_bic - hidden.delta_bic);
    let finding = found.findings.iter().find(|finding| finding.effect == hidden);
    let is_sure = |runner_up: &Option<fric_lab::discover::RunnerUp>| runner_up.as_ref().is_none_or(|it| !it.is_as_good);
    let is_told = finding.is_some_and(|finding| is_sure(&finding.runner_up)) && !names.contains(&other.kind());
    format!("{} [{}] margin {margin:.0}", if is_told { "tells" } else { "leaves it open" }, names.join(" "))
}
