//! The questions of a designed run: from names, or from the open questions of a discovery.

use std::collections::BTreeMap;

use fric_core::CableParams;
use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use fric_core::robot::unknown_name;
use fric_lab::excite::{Aim, Question};
use fric_lab::fit::{HALF_INTERVAL, Parameter};
use serde::Deserialize;
use thiserror::Error;

/// Format of a discovery result.
const FORMAT: &str = "fric-discover/1";
/// Default noise of a sensor and of a reference, N, as in `simulate`.
const SENSOR_NOISE_N: f64 = 0.02;
const REFERENCE_NOISE_N: f64 = 0.01;
/// Maximum number of insufficient candidates per cable to ask about, the best first.
const MOST_TRIED: usize = 3;
/// A parameter is undecided if its 95 % interval exceeds this fraction of its value to either side.
const OPEN_RATIO: f64 = 0.5;

/// A request in the terms of the user.
#[derive(Clone, Copy, Debug)]
pub enum Request<'a> {
    /// Two effects to distinguish, by their names in the catalogue.
    Separate(&'a [String]),
    /// Parameters to determine, as `fit --parameters` names them.
    Determine(&'a [String]),
    /// The text written by `discover --json`.
    Found(&'a str),
}

impl Request<'_> {
    /// Returns the command that answers the question from the log of the run.
    #[must_use]
    pub const fn command(&self) -> &'static str {
        match self {
            Self::Separate(_) | Self::Found(_) => "discover",
            Self::Determine(_) => "fit",
        }
    }
}

/// The reason why there are no questions.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum QuestionError {
    /// Unknown names: a mistake of the caller.
    #[error("{0}")]
    Names(String),
    /// A discovery result for which no run can be designed.
    #[error("{0}")]
    Found(String),
}

#[derive(Deserialize)]
struct Found {
    format: String,
    robot: String,
    cables: Vec<FoundCable>,
    wrench: Option<serde_json::Value>,
}

#[derive(Deserialize)]
struct FoundCable {
    name: String,
    noise_floor_n: Option<f64>,
    effects: Vec<FoundEffect>,
    tried: Vec<FoundTried>,
    parameters: BTreeMap<String, Option<f64>>,
    standard_errors: BTreeMap<String, Option<f64>>,
}

#[derive(Deserialize)]
struct FoundEffect {
    kind: String,
    runner_up: Option<FoundRunnerUp>,
}

#[derive(Deserialize)]
struct FoundRunnerUp {
    kind: String,
    as_good: bool,
}

#[derive(Deserialize)]
struct FoundTried {
    kind: String,
    evidence: FoundEvidence,
}

#[derive(Deserialize)]
struct FoundEvidence {
    delta_bic: Option<f64>,
}

/// Returns the questions of a request about the named cables, or about all. `noise_n` is the noise of the force at the platform, if it is known
/// better than from the request.
///
/// # Errors
/// Returns [`QuestionError::Names`] for unknown effects, parameters and cables, and [`QuestionError::Found`] for a result of another format or robot,
/// found by the wrench, or without open questions.
pub fn questions(
    robot: &RobotFile,
    request: Request<'_>,
    cables: Option<&[String]>,
    noise_n: Option<f64>,
) -> Result<Vec<Question>, QuestionError> {
    let wanted = wanted_cables(robot, cables)?;
    let of_all = |aim: &Aim| {
        let question = |cable: &usize| Question {
            cable: *cable,
            noise_n: noise_n.unwrap_or_else(|| usual_noise_n(robot, *cable)),
            values: None,
            aim: aim.clone(),
        };
        wanted.iter().map(question).collect()
    };
    match request {
        Request::Separate(kinds) => {
            let effects = kinds.iter().map(|kind| effect(kind)).collect::<Result<Vec<Effect>, _>>()?;
            match effects.as_slice() {
                [one, other] if one != other => Ok(of_all(&Aim::Separate([Some(*one), Some(*other)]))),
                _ => Err(QuestionError::Names(
                    "name the two effects that are to be told apart, such as stribeck,dwell_stiction".to_owned(),
                )),
            }
        }
        Request::Determine(names) => {
            let parameters = names.iter().map(|name| parameter(name)).collect::<Result<Vec<Parameter>, _>>()?;
            if parameters.is_empty() {
                return Err(QuestionError::Names("name the parameters to determine, such as sigma_n_per_m".to_owned()));
            }
            Ok(of_all(&Aim::Determine(parameters)))
        }
        Request::Found(text) => of_found(robot, text, &wanted, noise_n),
    }
}

fn wanted_cables(robot: &RobotFile, names: Option<&[String]>) -> Result<Vec<usize>, QuestionError> {
    let known = robot.cable_names();
    let Some(names) = names else { return Ok((0..known.len()).collect()) };
    let place = |name: &String| {
        let place = known.iter().position(|known| known == name);
        place.ok_or_else(|| QuestionError::Names(unknown_name("cable", name, known.iter().copied())))
    };
    let mut places = names.iter().map(place).collect::<Result<Vec<usize>, _>>()?;
    places.sort_unstable();
    places.dedup();
    Ok(places)
}

fn effect(kind: &str) -> Result<Effect, QuestionError> {
    let kind = kind.trim();
    let effect = Effect::of_kind(kind).filter(|effect| *effect != Effect::Empirical);
    effect.ok_or_else(|| {
        let known = Effect::kinds().filter(|effect| *effect != Effect::Empirical).map(Effect::kind);
        QuestionError::Names(unknown_name("effect", kind, known))
    })
}

/// Returns a parameter by its name, or by its name without the unit if that is unique.
fn parameter(name: &str) -> Result<Parameter, QuestionError> {
    let name = name.trim();
    let start = format!("{name}_");
    let mut without_unit = Parameter::all().filter(|parameter| parameter.to_string().starts_with(&start));
    let only = match (without_unit.next(), without_unit.next()) {
        (Some(parameter), None) => Some(parameter),
        _ => None,
    };
    Parameter::named(name).or(only).ok_or_else(|| {
        let known: Vec<String> = Parameter::all().map(|parameter| parameter.to_string()).collect();
        QuestionError::Names(unknown_name("parameter", name, known.iter().map(String::as_str)))
    })
}

fn usual_noise_n(robot: &RobotFile, cable: usize) -> f64 {
    let gain = robot.params().cables().get(cable).map_or(1.0, CableParams::frictionless_gain);
    (gain * SENSOR_NOISE_N).hypot(REFERENCE_NOISE_N)
}

fn of_found(
    robot: &RobotFile,
    text: &str,
    wanted: &[usize],
    noise_n: Option<f64>,
) -> Result<Vec<Question>, QuestionError> {
    let refused = |problem: String| Err(QuestionError::Found(problem));
    let found: Found = match serde_json::from_str(text) {
        Ok(found) => found,
        Err(error) => return refused(format!("it is not what `discover --json` writes ({error})")),
    };
    if found.format != FORMAT {
        return refused(format!("its format is `{}`; `discover --json` writes `{FORMAT}`", found.format));
    }
    if found.robot != robot.options().name {
        return refused(format!(
            "it is of the robot `{}`, and the robot file of `{}`",
            found.robot,
            robot.options().name
        ));
    }
    if found.wrench.is_some() {
        return refused(
            "it was found by the wrench; runs are designed for logs with forces at the platform, so name the question with \
             --separate or --determine"
                .to_owned(),
        );
    }
    let (names, params) = (robot.cable_names(), robot.params());
    let mut questions = Vec::new();
    for (cable, params) in params.cables().iter().enumerate().filter(|(cable, _)| wanted.contains(cable)) {
        let Some(of_cable) = found.cables.iter().find(|found| Some(&found.name.as_str()) == names.get(cable)) else {
            continue;
        };
        let mut values = params.values();
        for (name, value) in &of_cable.parameters {
            if let Some((parameter, value)) = Parameter::named(name).zip(*value) {
                values[parameter.place()] = value.clamp(parameter.row().min, parameter.row().max);
            }
        }
        let known_n = of_cable.noise_floor_n.filter(|noise_n| *noise_n > 0.0);
        let noise_n = noise_n.or(known_n).unwrap_or_else(|| usual_noise_n(robot, cable));
        let question = |aim| Question { cable, noise_n, values: Some(values), aim };
        questions.extend(aims(of_cable).into_iter().map(question));
    }
    if questions.is_empty() {
        return refused(
            "it leaves nothing open: each effect is told from every other, and each parameter is determined".to_owned(),
        );
    }
    Ok(questions)
}

/// Returns the open questions of a cable.
fn aims(found: &FoundCable) -> Vec<Aim> {
    // Of two of a kind, the model has the second only beside the first.
    let of_kind = |kind: &str, is_present: bool| {
        let has = |effect: &Effect| Parameter::of(*effect).any(|of| found.parameters.contains_key(&of.to_string()));
        let effects = Effect::all_of_kind(kind).filter(|effect| *effect != Effect::Empirical);
        effects.filter(move |effect| has(effect) == is_present).collect::<Vec<Effect>>()
    };
    let apart = found.effects.iter().enumerate().filter_map(|(place, effect)| {
        let runner_up = effect.runner_up.as_ref().filter(|runner_up| runner_up.as_good)?;
        let after = found.effects.iter().skip(place + 1).filter(|other| other.kind == effect.kind).count();
        let named = *of_kind(&effect.kind, true).iter().rev().nth(after)?;
        Some(Aim::Separate([Some(named), Some(*of_kind(&runner_up.kind, false).first()?)]))
    });
    let helps = |tried: &&FoundTried| tried.evidence.delta_bic.is_some_and(|delta_bic| delta_bic < 0.0);
    let tried = found.tried.iter().filter(helps).filter_map(|tried| of_kind(&tried.kind, false).first().copied());
    let tried = tried.take(MOST_TRIED).map(|effect| Aim::Separate([Some(effect), None]));
    let open = Parameter::all().filter(|parameter| {
        let name = parameter.to_string();
        let value = found.parameters.get(&name).copied().flatten();
        let Some(value) = value.filter(|value| (value - parameter.row().neutral).abs() > 0.0) else { return false };
        let error = found.standard_errors.get(&name).copied().flatten();
        let is_open = error.is_none_or(|error| HALF_INTERVAL * error > OPEN_RATIO * value.abs());
        parameter.row().fitted && is_open
    });
    let open: Vec<Parameter> = open.collect();
    let determine = (!open.is_empty()).then_some(Aim::Determine(open));
    apart.chain(tried).chain(determine).collect()
}
