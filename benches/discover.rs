//! Hides effects in hundreds of simulated logs, lets the discovery find them, and counts what it finds: `discover [OFFSET] [WORDS]`.
//!
//! The cases are those of [`fric_lab::simulate::sweep`]; OFFSET moves their seeds, so that a run is one that nothing was tuned to; WORDS,
//! divided by commas, keeps the cases in whose names one of them is. Each case is printed as it ends; then the tables of
//! `docs/discovery-figures.md`.

#![allow(missing_docs, clippy::print_stdout, clippy::expect_used)]

use std::collections::BTreeMap;

use fric_core::effects::Effect;
use fric_core::parameters::{MU, Values};
use fric_core::robot::file::RobotFile;
use fric_lab::discover::{CableDiscovery, DiscoverOptions, Model, Refusal, Verdict, discover, extended};
use fric_lab::fit::{Measurements, Parameter, Progress, Reference};
use fric_lab::simulate::HiddenEffect;
use fric_lab::simulate::sweep::{self, Case, CaseTruth, Group};
use rayon::prelude::*;

/// What became of a case.
struct Outcome {
    case: Case,
    /// Effects found, in their order.
    found: Vec<Effect>,
    /// The one that entered first.
    first: Option<Effect>,
    /// Whether what has no name became a table.
    has_table: bool,
    verdict: Verdict,
    /// How well the parameters of what was hidden came out.
    errors: Vec<ParameterError>,
    /// Root mean square before and after, as multiples of noise and wander together; the floor found, of the noise.
    before_ratio: f64,
    after_ratio: f64,
    floor_ratio: f64,
    /// Whether the search names nothing more from its own extended file, with the verdict that goes with it.
    is_settled: bool,
}

/// How far a parameter came out from what was hidden.
struct ParameterError {
    /// `kind.key`.
    name: String,
    /// As a share of its size: of the value, less the neutral one if there is one.
    of_size: f64,
    /// In standard errors.
    of_errors: f64,
}

impl Outcome {
    fn new(case: Case, truth: &CaseTruth, cable: &CableDiscovery, is_settled: bool) -> Self {
        // A table is no name.
        let all = cable.findings.iter().map(|finding| finding.effect);
        let mut found: Vec<Effect> = all.clone().filter(|effect| *effect != Effect::Empirical).collect();
        let has_table = all.count() > found.len();
        let first = found.first().copied();
        found.sort_unstable();
        let floor_n = truth.floor_n.hypot(case.sensor_wander_n).hypot(case.reference_wander_n);
        let ratio = |model: &Model| model.held_out_n.rms().unwrap_or(f64::NAN) / floor_n;
        Self {
            errors: errors(truth, cable),
            found,
            first,
            has_table,
            verdict: cable.verdict,
            before_ratio: ratio(&cable.before),
            after_ratio: ratio(&cable.after),
            floor_ratio: cable.noise_floor_n / truth.floor_n,
            is_settled,
            case,
        }
    }

    /// What there is to be found, in the order of effects.
    fn hidden(&self) -> Vec<Effect> {
        let mut hidden = self.case.effects.clone();
        hidden.sort_unstable();
        hidden
    }

    /// Found what is hidden, all of it and nothing else, with the verdict that goes with it.
    fn is_right(&self) -> bool {
        let verdict = match (self.case.disturbance, self.case.effects.is_empty()) {
            // A fault of the recording that has a name is not the model's.
            (Some(disturbance), _)
                if !["hum", "vibration", "frozen", "clipped", "quantised"].contains(&disturbance) =>
            {
                Verdict::Unexplained
            }
            (_, true) => Verdict::Complete,
            (_, false) => Verdict::Extended,
        };
        self.found == self.hidden() && self.verdict == verdict
    }
}

/// Errors of the parameters that were fitted: friction, and of what was hidden.
fn errors(truth: &CaseTruth, cable: &CableDiscovery) -> Vec<ParameterError> {
    let params = truth.robot.params();
    let friction = params.cables().first().map(fric_core::CableParams::values);
    let true_value = |parameter: &Parameter| {
        let Some(effect) = parameter.effect() else {
            let factor = if parameter.place() == MU { mu_factor(truth, &cable.after.values) } else { 1.0 };
            return friction.map(|values| factor * values[parameter.place()]);
        };
        let hidden = truth.effects.iter().find(|hidden| hidden.effect() == effect)?;
        hidden.values().iter().find(|(key, _)| *key == parameter.row().key).map(|(_, value)| *value)
    };
    let error = |parameter: &Parameter| {
        let value = true_value(parameter)?;
        let error = (cable.after.values[parameter.place()] - value).abs();
        let standard_error = cable.after.standard_error(parameter)?;
        // The neutral value of a period says nothing, as it is none that an identification varies by itself; nor does that of σ.
        let is_distance = parameter.row().fitted && !parameter.is_friction();
        let neutral = if is_distance { parameter.row().neutral } else { 0.0 };
        let of_size = error / (value - neutral).abs();
        Some(ParameterError { name: parameter.to_string(), of_size, of_errors: error / standard_error })
    };
    cable.after.fitted.iter().filter_map(error).collect()
}

/// The μ of a friction that is no multiple of the load is that at a reference load, which the discovery chooses by the log: the true one there,
/// of that where it was hidden.
fn mu_factor(truth: &CaseTruth, values: &Values) -> f64 {
    let hidden = truth.effects.iter().find(|effect| effect.effect() == Effect::LoadNonlinearity);
    let value =
        |of: &HiddenEffect, wanted: &str| of.values().iter().find(|(key, _)| *key == wanted).map(|(_, value)| *value);
    let named_n = Parameter::named("load_nonlinearity.reference_n").map(|parameter| values[parameter.place()]);
    let power = hidden.and_then(|of| Some((value(of, "reference_n")?, value(of, "exponent")?)));
    power.zip(named_n).map_or(1.0, |((hidden_n, exponent), named_n)| (named_n / hidden_n).powf(exponent - 1.0))
}

/// What the log of a case tells, beginning with a robot.
fn search(case: &Case, robot: &RobotFile) -> Option<CableDiscovery> {
    let mut log = case.log().expect("a case of the sweep makes a log");
    let params = robot.params();
    let mut measurements = Measurements::new(&params, Reference::Forces);
    measurements.start_log();
    while let Some(sample) = log.simulation.next_cycle() {
        measurements.add(&sample);
    }
    let found = discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new());
    found.expect("a short log fits into memory").into_iter().next()
}

fn run(case: Case) -> Option<Outcome> {
    let log = case.log().expect("a case of the sweep makes a log");
    let cable = search(&case, &log.robot)?;
    let text = extended(&log.robot_text, "sweep", std::slice::from_ref(&cable)).expect("an extended file");
    let again = search(&case, &RobotFile::parse(&text, "sweep").expect("an extended file is a robot file"))?;
    let verdict = if cable.verdict == Verdict::Extended { Verdict::Complete } else { cable.verdict };
    let more: Vec<&str> = again.findings.iter().map(|finding| finding.effect.kind()).collect();
    let is_settled = more.is_empty() && again.verdict == verdict;
    let outcome = Outcome::new(case, &log.truth, &cable, is_settled);
    let mark = if outcome.is_right() { "right" } else { "WRONG" };
    let tried: Vec<(&str, Refusal)> = cable.tried.iter().map(|tried| (tried.effect.kind(), tried.refusal)).collect();
    let tried = if outcome.is_right() { String::new() } else { format!(", tried {tried:?}") };
    let settled = if is_settled { String::new() } else { format!(", then {:?} {more:?}", again.verdict) };
    println!(
        "{mark} {}: {:?} {:?}{}, rms {:.3} to {:.3}, floor {:.3}{settled}{tried}",
        outcome.case.name(),
        outcome.verdict,
        outcome.found,
        if outcome.has_table { " and a table" } else { "" },
        outcome.before_ratio,
        outcome.after_ratio,
        outcome.floor_ratio
    );
    Some(outcome)
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let offset: u64 = arguments.next().map_or(0, |text| text.parse().expect("OFFSET is a whole number"));
    let words = arguments.next().unwrap_or_default();
    let wanted = |case: &Case| words.is_empty() || words.split(',').any(|word| case.name().contains(word));
    let cases: Vec<Case> = sweep::cases()
        .into_iter()
        .filter(wanted)
        .map(|case| Case { seed: case.seed + offset * 10_000, ..case })
        .collect();
    let outcomes: Vec<Outcome> = cases.into_par_iter().filter_map(run).collect();
    print_groups(&outcomes);
    print_strengths(&outcomes);
    print_confusions(&outcomes);
    print_sizes(&outcomes);
    print_promises(&outcomes);
}

fn share(of: &[&Outcome], is: impl Fn(&Outcome) -> bool) -> String {
    format!("{}/{}", of.iter().filter(|outcome| is(outcome)).count(), of.len())
}

fn names(effects: &[Effect]) -> String {
    effects.iter().map(|effect| effect.kind()).collect::<Vec<_>>().join(" + ")
}

/// Each group with how many cases are right.
fn print_groups(outcomes: &[Outcome]) {
    let mut groups: BTreeMap<Group, Vec<&Outcome>> = BTreeMap::new();
    for outcome in outcomes {
        groups.entry(outcome.case.group).or_default().push(outcome);
    }
    println!("\n| group | exactly right | names right | nothing named that is not there |\n|---|---|---|---|");
    for (group, of) in groups {
        let invented = |outcome: &Outcome| outcome.found.iter().any(|kind| !outcome.case.effects.contains(kind));
        println!(
            "| {} | {} | {} | {} |",
            group.name(),
            share(&of, Outcome::is_right),
            share(&of, |outcome| outcome.found == outcome.hidden()),
            share(&of, |outcome| !invented(outcome))
        );
    }
}

/// Single effects by strength.
fn print_strengths(outcomes: &[Outcome]) {
    println!("\n| single effect at strength | named first and alone |\n|---|---|");
    for strength_ratio in [1.0_f64, 0.5, 0.25] {
        let is_it = |outcome: &&Outcome| {
            outcome.case.group == Group::Single && outcome.case.strength_ratio.to_bits() == strength_ratio.to_bits()
        };
        let of: Vec<&Outcome> = outcomes.iter().filter(is_it).collect();
        println!("| {strength_ratio} | {} |", share(&of, |outcome| outcome.found == outcome.hidden()));
    }
}

/// What single effects and disturbances were taken for.
fn print_confusions(outcomes: &[Outcome]) {
    println!("\n| hidden | named |\n|---|---|");
    let mut taken_for: BTreeMap<&str, BTreeMap<String, u32>> = BTreeMap::new();
    for outcome in outcomes {
        let hidden = match (outcome.case.group, outcome.case.disturbance) {
            (Group::Single, _) => outcome.case.effects.first().map_or("", |effect| effect.kind()),
            (Group::Outside, Some(disturbance)) => disturbance,
            (Group::Nothing | Group::Wander | Group::Hand, _) => outcome.case.group.name(),
            _ => continue,
        };
        let named = if outcome.found.is_empty() { "—".to_owned() } else { names(&outcome.found) };
        let named = if outcome.verdict == Verdict::Unexplained { format!("{named}, unexplained") } else { named };
        *taken_for.entry(hidden).or_default().entry(named).or_default() += 1;
    }
    for (hidden, named) in taken_for {
        let listed: Vec<String> = named.into_iter().map(|(named, count)| format!("{named} {count}×")).collect();
        println!("| {hidden} | {} |", listed.join(", "));
    }
}

/// Errors of parameters, of the floor, and what is left.
fn print_sizes(outcomes: &[Outcome]) {
    let right: Vec<&Outcome> =
        outcomes.iter().filter(|outcome| outcome.is_right() && outcome.case.disturbance.is_none()).collect();
    let mut of_parameters: BTreeMap<&str, Vec<&ParameterError>> = BTreeMap::new();
    for error in right.iter().flat_map(|outcome| &outcome.errors) {
        of_parameters.entry(&error.name).or_default().push(error);
    }
    println!(
        "\n| parameter | cases | error / size: median | 95 % | error / standard error: median | 95 % | within 1.96 |\n\
         |---|---|---|---|---|---|---|"
    );
    for (name, errors) in &of_parameters {
        let [of_size, of_errors] = [|error: &&ParameterError| error.of_size, |error: &&ParameterError| error.of_errors]
            .map(|part| quantiles(errors.iter().map(part).collect()));
        println!(
            "| {name} | {} | {:.3} | {:.3} | {:.1} | {:.1} | {} |",
            errors.len(),
            of_size[0],
            of_size[1],
            of_errors[0],
            of_errors[1],
            errors.iter().filter(|error| error.of_errors <= 1.96).count()
        );
    }
    let row = |numbers: Vec<f64>| {
        let [median, most_of_them, most] = quantiles(numbers);
        format!("{median:.3} | {most_of_them:.3} | {most:.3}")
    };
    println!("\n| of the cases that are right | median | 95 % | most |\n|---|---|---|---|");
    let all = || of_parameters.values().flatten().filter(|error| error.of_size.is_finite());
    println!("| error of a parameter / its size | {} |", row(all().map(|error| error.of_size).collect()));
    println!("| error of a parameter / its standard error | {} |", row(all().map(|error| error.of_errors).collect()));
    let is_white = |outcome: &&&Outcome| outcome.case.sensor_wander_n <= 0.0 && outcome.case.reference_wander_n <= 0.0;
    println!(
        "| rms after / true noise | {} |",
        row(right.iter().filter(is_white).map(|outcome| outcome.after_ratio).collect())
    );
    println!(
        "| error of the noise floor / it | {} |",
        row(outcomes.iter().map(|outcome| (outcome.floor_ratio - 1.0).abs()).collect())
    );
    let named_first = outcomes.iter().filter(|outcome| !outcome.case.effects.is_empty());
    let named_first: Vec<&Outcome> = named_first.collect();
    let is_there = |outcome: &Outcome| outcome.first.is_some_and(|kind| outcome.case.effects.contains(&kind));
    println!("\nOf the cases with effects, the first named is one of them in {}.", share(&named_first, is_there));
}

/// What holds of every log.
fn print_promises(outcomes: &[Outcome]) {
    let all: Vec<&Outcome> = outcomes.iter().collect();
    println!("\nFed with its own extended file the search names nothing more in {}.", share(&all, |of| of.is_settled));
    let told: Vec<&Outcome> = outcomes.iter().filter(|of| of.verdict != Verdict::Unexplained).collect();
    println!(
        "Of what is called complete or extended, {} are at 1.05 of noise and wander or below, {} at 1.1.",
        share(&told, |of| of.after_ratio <= 1.05),
        share(&told, |of| of.after_ratio <= 1.1)
    );
    let many = || outcomes.iter().filter(|of| of.case.group == Group::Many);
    let hidden: usize = many().map(|of| of.case.effects.len()).sum();
    let named: usize = many().flat_map(|of| of.found.iter().filter(|kind| of.case.effects.contains(kind))).count();
    println!("Of four or five effects at once, {named} of {hidden} are named.");
}

/// Median, 95 % and most.
fn quantiles(mut numbers: Vec<f64>) -> [f64; 3] {
    numbers.sort_by(f64::total_cmp);
    [50, 95, 100].map(|share| numbers.get(numbers.len().saturating_sub(1) * share / 100).copied().unwrap_or(f64::NAN))
}
