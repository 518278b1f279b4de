//! Hides effects in simulated logs of robots with eight cables and no force sensor at the platform, lets the discovery find them by the wrench,
//! and counts what it finds: `discover_wrench [OFFSET] [WORDS]`.
//!
//! The cases are those of [`fric_lab::simulate::sweep::wrench_cases`]; OFFSET moves their seeds, so that a run is one that nothing was tuned to;
//! WORDS, divided by commas, keeps the cases in whose names one of them is. Each case is printed as it ends; then the tables of
//! `docs/discovery-figures.md`.

#![allow(missing_docs, clippy::print_stdout, clippy::expect_used)]

use std::collections::BTreeMap;
use std::time::Instant;

use fric_core::AnyCompensator;
use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_lab::discover::{DiscoverOptions, Discoveries, Geometry, Verdict, WrenchDiscovery};
use fric_lab::fit::Progress;
use fric_lab::replay::WrenchReference;
use fric_lab::simulate::sweep::{self, Misstated, WrenchCase, WrenchCaseLog, WrenchGroup};
use rayon::prelude::*;

/// What the beginning of a log is left out for, s: friction in the model has to find to that of the robot.
const SETTLING_S: f64 = 1.0;

/// What became of a case.
struct Outcome {
    case: WrenchCase,
    hidden: Names,
    found: Names,
    verdict: Verdict,
    /// Root mean square of the deviations held out, each component over its white noise.
    after_ratio: f64,
    /// Estimate of the noise over the noise.
    floor_ratio: f64,
    /// Root mean square of the error of the cable forces over all cables, with the extended file and with the true one, N.
    error_n: [f64; 2],
}

/// What is wrong, in an order of its own: effects with their cables, numbers of the robot file with theirs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Names {
    effects: Vec<(usize, Effect)>,
    geometry: Vec<Geometry>,
}

impl Names {
    fn hidden(log: &WrenchCaseLog) -> Self {
        let of_cable = |(cable, effects): (usize, &Vec<_>)| {
            effects.iter().map(|effect: &fric_lab::simulate::HiddenEffect| (cable, effect.effect())).collect::<Vec<_>>()
        };
        let mut effects: Vec<(usize, Effect)> = log.truth.effects.iter().enumerate().flat_map(of_cable).collect();
        effects.sort_unstable();
        let geometry = log.truth.misstated.map(|of| match of {
            Misstated::Mass => Geometry::Mass,
            Misstated::Base(cable) => Geometry::Base(cable),
        });
        Self { effects, geometry: geometry.into_iter().collect() }
    }

    fn found(found: &WrenchDiscovery) -> Self {
        let of_cables = found.cables.iter().enumerate();
        let mut effects: Vec<(usize, Effect)> =
            of_cables.flat_map(|(cable, of)| of.findings.iter().map(move |finding| (cable, finding.effect))).collect();
        effects.sort_unstable();
        let mut geometry: Vec<Geometry> = found.geometry.iter().map(|of| of.geometry).collect();
        geometry.sort_unstable();
        Self { effects, geometry }
    }

    /// How many of these are not among others.
    fn beyond(&self, others: &Self) -> usize {
        let effects = self.effects.iter().filter(|name| !others.effects.contains(name)).count();
        effects + self.geometry.iter().filter(|name| !others.geometry.contains(name)).count()
    }

    fn is_empty(&self) -> bool {
        self.effects.is_empty() && self.geometry.is_empty()
    }

    /// Effects with the cables that have them, numbers of the robot file.
    fn text(&self) -> String {
        let mut cables: BTreeMap<Effect, Vec<String>> = BTreeMap::new();
        for (cable, effect) in &self.effects {
            cables.entry(*effect).or_default().push((cable + 1).to_string());
        }
        let effects = cables.iter().map(|(effect, cables)| format!("{} {}", effect.kind(), cables.join("+")));
        let geometry = self.geometry.iter().map(|of| {
            format!("{}{}", of.key(), of.cable().map_or_else(String::new, |cable| format!(" {}", cable + 1)))
        });
        let all: Vec<String> = effects.chain(geometry).collect();
        if all.is_empty() { "nothing".to_owned() } else { all.join(", ") }
    }
}

impl Outcome {
    /// Found what is hidden, all of it and nothing else, with the verdict that goes with it: hum is no matter of the model.
    fn is_right(&self) -> bool {
        let verdict = if self.hidden.is_empty() { Verdict::Complete } else { Verdict::Extended };
        self.found == self.hidden && self.verdict == verdict
    }

    fn error_ratio(&self) -> f64 {
        self.error_n[0] / self.error_n[1]
    }
}

fn run(case: WrenchCase) -> Outcome {
    let log = case.log().expect("a case of the sweep makes a log");
    let begin = Instant::now();
    let samples = log.measured(&log.robot).into();
    let all =
        Discoveries::of(&samples, &DiscoverOptions::default(), &Progress::new()).expect("a log that can be searched");
    let text = all.extended(&log.robot_text, "sweep").expect("an extended file");
    let found = all.wrench().expect("a discovery by the wrench");
    let extended = RobotFile::parse(&text, "sweep").expect("an extended file is a robot file");
    let ratio = |components: &[f64; 6]| {
        let squares = components.iter().zip(&log.truth.noise).map(|(rms, noise)| (rms / noise).powi(2));
        (squares.sum::<f64>() / 6.0).sqrt()
    };
    let outcome = Outcome {
        hidden: Names::hidden(&log),
        found: Names::found(found),
        verdict: found.verdict,
        after_ratio: ratio(&found.after.components),
        floor_ratio: ratio(&found.noise),
        error_n: [force_error_n(&log, &extended), force_error_n(&log, &log.truth.robot)],
        case,
    };
    println!(
        "{} {}: hidden {}; {:?} {}; rms {:.3} of the noise, floor {:.3}; force error {:.4} N, true model {:.4} N, {:.2}; {:.0} s{}",
        if outcome.is_right() { "right" } else { "WRONG" },
        outcome.case.name(),
        outcome.hidden.text(),
        outcome.verdict,
        outcome.found.text(),
        outcome.after_ratio,
        outcome.floor_ratio,
        outcome.error_n[0],
        outcome.error_n[1],
        outcome.error_ratio(),
        begin.elapsed().as_secs_f64(),
        if outcome.is_right() { String::new() } else { details(found) },
    );
    outcome
}

/// What was tried and did not suffice.
fn details(found: &WrenchDiscovery) -> String {
    let mut words: Vec<String> = found.tried.iter().map(|(name, _, refusal)| format!("{name} {refusal:?}")).collect();
    for (cable, of) in found.cables.iter().enumerate() {
        words.extend(
            of.tried.iter().map(|tried| {
                format!("{}:{} {:?} {:.0}", cable + 1, tried.effect.kind(), tried.refusal, tried.delta_bic)
            }),
        );
        words.extend(
            of.findings.iter().map(|of| format!("{}:{} named {:.0}", cable + 1, of.effect.kind(), of.delta_bic)),
        );
        if of.verdict == Verdict::Unexplained {
            words.push(format!("{}: unexplained", cable + 1));
        }
    }
    words.extend(found.geometry.iter().map(|of| format!("{:?} {:.0}", of.geometry, of.delta_bic)));
    format!("\n      {}", words.join(", "))
}

/// Error of the forces that a loop computes with a robot file, against those of the simulation.
fn force_error_n(log: &WrenchCaseLog, robot: &RobotFile) -> f64 {
    let params = robot.params();
    let mut compensator = AnyCompensator::new(&params).expect("eight cables");
    let (mut squares, mut count) = (0.0, 0.0);
    for (place, cycle) in log.cycles.iter().enumerate() {
        compensator.set_input(&cycle.cables, Some(cycle.pose), 1.0);
        compensator.step();
        #[expect(clippy::cast_precision_loss, reason = "a count of cycles")]
        let is_settled = place as f64 * params.cycle_s() >= SETTLING_S;
        for (output, true_n) in compensator.outputs().iter().zip(&cycle.true_force_n).filter(|_| is_settled) {
            squares += (output.force_at_platform_n - true_n).powi(2);
            count += 1.0;
        }
    }
    (squares / count).sqrt()
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let offset: u64 = arguments.next().map_or(0, |text| text.parse().expect("OFFSET is a whole number"));
    let words = arguments.next().unwrap_or_default();
    let wanted = |case: &WrenchCase| words.is_empty() || words.split(',').any(|word| case.name().contains(word));
    let cases: Vec<WrenchCase> = sweep::wrench_cases()
        .into_iter()
        .filter(wanted)
        .map(|case| WrenchCase { seed: case.seed + offset * 10_000, ..case })
        .collect();
    let outcomes: Vec<Outcome> = cases.into_par_iter().map(run).collect();
    print_groups(&outcomes);
    print_promises(&outcomes);
}

fn share(of: &[&Outcome], is: impl Fn(&Outcome) -> bool) -> String {
    format!("{}/{}", of.iter().filter(|outcome| is(outcome)).count(), of.len())
}

/// Each group with how many cases are right.
fn print_groups(outcomes: &[Outcome]) {
    let mut groups: BTreeMap<WrenchGroup, Vec<&Outcome>> = BTreeMap::new();
    for outcome in outcomes {
        groups.entry(outcome.case.group).or_default().push(outcome);
    }
    for of in groups.values_mut() {
        of.sort_by_key(|outcome| outcome.case.seed);
    }
    println!(
        "\n| hidden | exactly right | names and cables right | false names | rms after / noise | force error / that of the true model |\n\
         |---|---|---|---|---|---|"
    );
    for (group, of) in groups {
        let false_names: usize = of.iter().map(|outcome| outcome.found.beyond(&outcome.hidden)).sum();
        let most = |number: fn(&Outcome) -> f64| {
            let numbers = || of.iter().map(|outcome| number(outcome));
            let [median, most] = [0.5, 1.0].map(|share| quantile(numbers().collect(), share));
            format!("{median:.2}, {most:.2}")
        };
        println!(
            "| {} | {} | {} | {false_names} | {} | {} |",
            group.name(),
            share(&of, Outcome::is_right),
            share(&of, |outcome| outcome.found == outcome.hidden),
            most(|outcome| outcome.after_ratio),
            most(Outcome::error_ratio),
        );
    }
}

fn print_promises(outcomes: &[Outcome]) {
    let all: Vec<&Outcome> = outcomes.iter().collect();
    let clean: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.hidden.is_empty()).collect();
    let named = |of: &[&Outcome]| -> usize { of.iter().map(|outcome| outcome.found.beyond(&outcome.hidden)).sum() };
    println!(
        "\nExactly right are {}, names and cables are right in {}. False names: {} in the {} logs that hide nothing, {} in all.",
        share(&all, Outcome::is_right),
        share(&all, |outcome| outcome.found == outcome.hidden),
        named(&clean),
        clean.len(),
        named(&all),
    );
    let ratios = || outcomes.iter().map(Outcome::error_ratio).collect::<Vec<f64>>();
    println!(
        "The force error is {:.2} times that of the true model in the median, {:.2} at 95 %, {:.2} at most; at most 1.3 in {}.",
        quantile(ratios(), 0.5),
        quantile(ratios(), 0.95),
        quantile(ratios(), 1.0),
        share(&all, |outcome| outcome.error_ratio() <= 1.3),
    );
    for reference in [WrenchReference::Measured, WrenchReference::Mass] {
        let of: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.case.reference == reference).collect();
        println!("{}: exactly right {}.", reference.name(), share(&of, Outcome::is_right));
    }
}

/// The number that a share of all are below.
fn quantile(mut numbers: Vec<f64>, share: f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let last = numbers.len().saturating_sub(1);
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "some 100"
    )]
    let place = (last as f64 * share).round() as usize;
    numbers.get(place).copied().unwrap_or(f64::NAN)
}
