//! How often the 95 % intervals of a fit hold the truth, by effect and parameter: `coverage [LOGS] [OFFSET] [KINDS]`.
//!
//! Each effect of the catalogue is hidden by itself in LOGS logs of [`fric_lab::simulate::sweep`], whose pulleys differ by ±10 %, and its parameters
//! are fitted together with friction. OFFSET moves the seeds; KINDS, divided by commas, keeps these effects.

#![allow(missing_docs, clippy::print_stdout, clippy::expect_used)]

use std::collections::BTreeMap;

use fric_core::CableParams;
use fric_core::effects::Effect;
use fric_lab::fit::{FitOptions, HALF_INTERVAL, Measurements, Parameter, Progress, Reference, fit_cables};
use fric_lab::simulate::sweep::{Case, Group};
use rayon::prelude::*;

/// The error of a parameter.
struct ParameterError {
    /// Hidden effect and parameter.
    name: String,
    of_value: f64,
    of_errors: f64,
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let mut number = |usual: u64| arguments.next().map_or(usual, |text| text.parse().expect("a whole number"));
    let (count, offset) = (number(20), number(0));
    let kinds = arguments.next().unwrap_or_default();
    // A table has no true values.
    let is_wanted = |effect: &Effect| {
        *effect != Effect::Empirical && (kinds.is_empty() || kinds.split(',').any(|kind| kind == effect.kind()))
    };
    let wanted: Vec<Effect> = Effect::kinds().filter(is_wanted).collect();
    let cases = wanted.into_iter().flat_map(|effect| (0..count).map(move |seed| case(effect, offset * 10_000 + seed)));
    let cases: Vec<Case> = cases.collect();
    let errors: Vec<ParameterError> = cases.into_par_iter().flat_map_iter(|case| errors(&case)).collect();
    print(&errors);
}

fn case(effect: Effect, seed: u64) -> Case {
    Case {
        group: Group::Single,
        effects: vec![effect],
        disturbance: None,
        strength_ratio: 1.0,
        noise_ratio: 1.0,
        sensor_wander_n: 0.0,
        reference_wander_n: 0.0,
        hand_n: 0.0,
        seed,
    }
}

/// Fits the log of a case and compares each parameter that has a true value.
fn errors(case: &Case) -> Vec<ParameterError> {
    let mut log = case.log().expect("a case of the sweep makes a log");
    let params = log.robot.params();
    let mut measurements = Measurements::new(&params, Reference::Forces);
    measurements.start_log();
    while let Some(sample) = log.simulation.next_cycle() {
        measurements.add(&sample);
    }
    let hidden = log.truth.effects.first().expect("one effect is hidden");
    let effect = hidden.effect();
    // A sensor offset and an offset at the platform are one direction; a period and the time of dwell stiction are fitted on request.
    let is_twice = |of: &Parameter| effect == Effect::SensorOffset && of.to_string() == "offset_n";
    let friction = Parameter::all().filter(|of| of.is_friction() && !is_twice(of));
    let of_effect =
        Parameter::of(effect).filter(|of| of.row().fitted || ["period_m", "time_s"].contains(&of.row().key));
    let parameters: Vec<Parameter> = friction.chain(of_effect).collect();
    let options = FitOptions { parameters: Some(parameters.clone()), ..FitOptions::default() };
    let fit = fit_cables(&measurements, &options, &Progress::new()).remove(0);
    let truth = log.truth.robot.params();
    let friction = truth.cables().first().map(CableParams::values).expect("one cable");
    let true_value = |parameter: &Parameter| match parameter.effect() {
        // Its reference load is the fit's own choice, and μ is that at this load.
        None if effect == Effect::LoadNonlinearity && parameter.row().key == "mu" => None,
        None => Some(friction[parameter.place()]),
        Some(_) => hidden.values().iter().find(|(key, _)| *key == parameter.row().key).map(|(_, value)| *value),
    };
    let error = |parameter: &Parameter| {
        let value = true_value(parameter)?;
        let error = fit.values[parameter.place()] - value;
        Some(ParameterError {
            name: format!("{}: {parameter}", effect.kind()),
            of_value: error / value,
            of_errors: error / fit.standard_error(parameter)?,
        })
    };
    parameters.iter().filter_map(error).collect()
}

fn print(errors: &[ParameterError]) {
    let mut of_names: BTreeMap<&str, Vec<&ParameterError>> = BTreeMap::new();
    for error in errors {
        of_names.entry(&error.name).or_default().push(error);
    }
    println!(
        "| hidden: parameter | fitted in | held | error / value, rms | error / standard error: mean | rms |\n|---|---|---|---|---|---|"
    );
    for (name, errors) in of_names {
        #[expect(clippy::cast_precision_loss, reason = "a count of logs")]
        let count = errors.len() as f64;
        let mean = |part: &dyn Fn(&ParameterError) -> f64| errors.iter().map(|error| part(error)).sum::<f64>() / count;
        let held = mean(&|error| f64::from(u8::from(error.of_errors.abs() <= HALF_INTERVAL)));
        let of_value = mean(&|error| error.of_value * error.of_value).sqrt();
        let (average, rms) = (mean(&|error| error.of_errors), mean(&|error| error.of_errors * error.of_errors).sqrt());
        println!("| {name} | {count} | {:.0} % | {of_value:.4} | {average:+.2} | {rms:.2} |", 100.0 * held);
    }
}
