//! The design of a run: movements and loads chosen so that a log of them answers a question that another log left open.
//!
//! A question is either which of two effects a cable has, or how large some parameters are. The value of a run is computed from the cycle's own model
//! (`criterion`): the model predicts the log (`predicted`), and its derivatives show how much of that another model could compensate. Runs consist of
//! pieces (`pieces`), each checked against all limits; `choose` selects the pieces with the greatest value. The evidence is then recomputed for the
//! whole run, by fitting the wrong model to the prediction of the right one (`hypothesis`), with each of both models being right in turn. The values
//! that the wrong model takes there enter the selection of the next round.
//!
//! The method is that of optimal experiments: T-optimality to distinguish models (A. C. Atkinson, V. V. Fedorov, *Biometrika* 62 (1975), 57–70), and
//! the information of the wanted parameters with all others unknown to determine them (Fedorov 1972). Noise is assumed to be white.

mod choose;
mod criterion;
mod hypothesis;
mod pieces;
mod predicted;

use std::sync::atomic::{AtomicBool, Ordering};

use fric_core::effects::Effect;
use fric_core::parameters::Values;
use fric_core::robot::file::RobotFile;
use rayon::prelude::*;

use self::criterion::{Measure, Sums, Test, Tests, objective, sums_of_logs};
use self::hypothesis::{Hypothesis, Prediction, with_typical, without};
use super::{Excitation, ExcitationError, ExcitationOptions};
use crate::candidates::catalogue::has;
use crate::discover::naming::STRONG_BIC;
use crate::fit::{CableRecord, Measurements, Parameter, Progress, Reference};
use crate::search::problem::{Comparison, Loss, Member, Problem};
use crate::simulate::motion::Motion;
use crate::trajectory::{LOAD_CHANGE_S, Piece, Trajectory, WorkBox};

/// Default duration of a run, s.
pub const STANDARD_DURATION_S: f64 = 20.0;
/// A run answers a question if its score is at least this.
pub const LEAST_SCORE: f64 = 1.0;
/// Least and greatest duration of a designed run, s.
const DURATIONS_S: [f64; 2] = [3.0, 600.0];
/// Least and greatest noise, N.
const NOISES_N: [f64; 2] = [1e-9, 1e6];
/// Number of rounds of selection and refit, after a first one that determines the size of the second effects.
const ROUNDS: usize = 2;

/// A question about a cable that a run is to answer.
#[derive(Clone, Debug)]
pub struct Question {
    /// Index of the cable in the robot file.
    pub cable: usize,
    /// Standard deviation of the noise of the force at the platform, N: of the reference sensor and the cable's sensor together.
    pub noise_n: f64,
    /// The model; `None` for that of the robot file.
    pub values: Option<Values>,
    /// The subject of the question.
    pub aim: Aim,
}

/// The subject of a question.
#[derive(Clone, Debug, PartialEq)]
pub enum Aim {
    /// Which of two effects the cable has in addition to the rest of its model; `None` asks whether it has the other effect at all. An effect that
    /// the model lacks is assumed half as strong as the maximum in machines, or as strong as it looks most like the other.
    Separate([Option<Effect>; 2]),
    /// How large these parameters are.
    Determine(Vec<Parameter>),
}

/// A run with its expected results.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The run, at its start.
    pub excitation: Excitation,
    /// The expected result of each question.
    pub forecasts: Vec<Forecast>,
}

/// The expected result of one question.
#[derive(Clone, Debug)]
pub struct Forecast {
    /// Index of the cable.
    pub cable: usize,
    /// Standard deviation of the noise, N.
    pub noise_n: f64,
    /// Result with the designed run.
    pub goal: Goal,
    /// Result with the identification run, cut to the same duration; `None` if it cannot be run.
    pub standard: Option<Goal>,
}

/// The knowledge after a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// `ΔBIC` in favour of the effect that the cable has: if it is the first, and if it is the second; `None` for no effect.
    Separated {
        /// The effects.
        effects: [Option<Effect>; 2],
        /// The evidence.
        delta_bic: [Option<f64>; 2],
    },
    /// Standard errors of parameters, as `fit` reports them under white noise.
    Determined(Vec<KnownParameter>),
}

/// A parameter with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownParameter {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value in the model.
    pub value: f64,
    /// Its standard error, in its unit.
    pub standard_error: f64,
    /// Width of its interval as a multiple of the widest one that determines it.
    pub vagueness: f64,
}

impl Goal {
    /// Returns the score of the question; it is answered from [`LEAST_SCORE`] on.
    #[must_use]
    pub fn score(&self) -> f64 {
        match self {
            Self::Separated { delta_bic, .. } => {
                delta_bic.iter().flatten().copied().fold(f64::INFINITY, f64::min) / STRONG_BIC
            }
            Self::Determined(known) => known.iter().map(|known| known.vagueness.powi(-2)).fold(f64::INFINITY, f64::min),
        }
    }

    /// Whether the question is answered.
    #[must_use]
    pub fn tells(&self) -> bool {
        self.score() >= LEAST_SCORE
    }
}

/// Designs the run of `duration_s` that answers all questions as well as possible within the limits. If no run answers any of them, there is no run.
///
/// # Errors
/// Returns the [`ExcitationError`] of [`Excitation::new`], [`ExcitationError::BadQuestion`] for a question that does not apply to this robot, and
/// [`ExcitationError::CannotTell`] if no run answers anything.
pub fn design(
    robot: &RobotFile,
    options: &ExcitationOptions,
    duration_s: f64,
    questions: &[Question],
    progress: &Progress,
) -> Result<Experiment, ExcitationError> {
    let [min, max] = DURATIONS_S;
    if !(min..=max).contains(&duration_s) {
        return Err(ExcitationError::OptionOutOfRange { key: "duration_s", value: duration_s, min, max });
    }
    Studio::new(robot, options, duration_s, questions, progress)?.design()
}

/// The data of a design.
struct Studio<'a> {
    robot: &'a RobotFile,
    options: ExcitationOptions,
    duration_s: f64,
    questions: &'a [Question],
    progress: &'a Progress,
    pieces: Vec<Piece>,
    /// Duration of each piece, including a change of the load before it, s.
    times_s: Vec<f64>,
    lead_in_s: f64,
    library: Measurements<'a>,
    standard: Measurements<'a>,
}

/// A question with its models.
enum Case {
    /// The true models with those to be distinguished from them, in the order of the question's effects. `first` is the index of the model whose
    /// effect size is known or assumed. The other effect gets the size at which it looks most like the first, and takes part as soon as that is
    /// known.
    Separate {
        base: Values,
        first: usize,
        right: Box<[Option<Hypothesis>; 2]>,
        wrong: [Vec<Hypothesis>; 2],
    },
    Determine {
        model: Hypothesis,
        wanted: Vec<Parameter>,
    },
}

impl<'a> Studio<'a> {
    fn new(
        robot: &'a RobotFile,
        options: &'a ExcitationOptions,
        duration_s: f64,
        questions: &'a [Question],
        progress: &'a Progress,
    ) -> Result<Self, ExcitationError> {
        for question in questions {
            let (value, [min, max]) = (question.noise_n, NOISES_N);
            if !(min..=max).contains(&value) {
                return Err(ExcitationError::OptionOutOfRange { key: "noise_n", value, min, max });
            }
        }
        let empty = Excitation::of_pieces(robot, options, &[], 0.0)?;
        let (work_box, limits) = (empty.work_box.unwrap_or(Motion::BENCH), options.limits());
        // The box is determined once.
        let corners_m = |of: WorkBox| [of.center_m - of.half_edges_m, of.center_m + of.half_edges_m].map(Into::into);
        let options = ExcitationOptions { box_m: empty.work_box.map(corners_m), ..*options };
        let lead_in_s = Trajectory::designed(&work_box, &limits, &[], 0.0).duration_s();
        if lead_in_s > duration_s {
            return Err(ExcitationError::TooLong { duration_s: lead_in_s, longest_s: duration_s });
        }
        let all = pieces::pieces(
            &work_box,
            &limits,
            empty.states_loads(),
            empty.work_box.is_some(),
            duration_s - lead_in_s - LOAD_CHANGE_S,
        );
        let params = robot.params();
        let (mut pieces, mut library, mut refusal) = (Vec::new(), Measurements::new(&params, Reference::Forces), None);
        for piece in all {
            let mut run = Excitation::of_pieces(robot, &options, &[piece], 0.0)?;
            // Pieces that the cables cannot hold are dropped. If they can hold none, the first one gives the reason.
            match predicted::samples(&params, &mut run) {
                Ok(samples) => {
                    pieces.push(piece);
                    samples.enter(&mut library);
                }
                Err(error) => refusal = refusal.or(Some(error)),
            }
        }
        if let (true, Some(refusal)) = (pieces.is_empty(), refusal) {
            return Err(refusal);
        }
        let change_s = if empty.states_loads() { LOAD_CHANGE_S } else { 0.0 };
        let duration_of = |piece: &Piece| pieces::duration_s(&work_box, &limits, piece) + change_s;
        let times_s = pieces.iter().map(duration_of).collect();
        let standard = predicted::frictionless(&params, &mut standard_run(robot, &options, duration_s)?)?;
        Ok(Self {
            robot,
            options,
            duration_s,
            questions,
            progress,
            pieces,
            times_s,
            lead_in_s: lead_in_s + change_s,
            library,
            standard,
        })
    }

    fn design(&self) -> Result<Experiment, ExcitationError> {
        self.progress.begin(4 + 2 * ROUNDS);
        let in_all = |work: &(dyn Fn(&Question) -> Result<Case, ExcitationError> + Sync)| {
            self.questions.par_iter().map(work).collect::<Result<Vec<Case>, ExcitationError>>()
        };
        let mut cases = in_all(&|question| self.case(question))?;
        self.step_done()?;
        let mut best: Option<(f64, Excitation, Vec<Option<Goal>>)> = None;
        for round in 0..=ROUNDS {
            let run = self.chosen(&cases)?;
            self.step_done()?;
            let measurements = predicted::frictionless(&self.robot.params(), &mut run.clone())?;
            let goals = self.forecast(&measurements, &mut cases);
            self.step_done()?;
            if round == 0 {
                // The first run determines the size of the second effects.
                self.questions.par_iter().zip(&mut cases).for_each(|(question, case)| {
                    self.establish(question, &measurements, case);
                });
                continue;
            }
            let worth = |goal: &Option<Goal>| goal.as_ref().map_or(0.0, Goal::score).max(1e-6).ln();
            let value: f64 = goals.iter().map(worth).sum();
            if best.as_ref().is_none_or(|(best, ..)| value > *best) {
                best = Some((value, run, goals));
            }
        }
        let of_standard = self.forecast(&self.standard, &mut cases);
        self.step_done()?;
        let Some((_, excitation, goals)) = best else { return Err(self.broken_off()) };
        let forecasts = self.questions.iter().zip(goals).zip(of_standard);
        let forecasts: Vec<Forecast> = forecasts
            .filter_map(|((question, goal), standard)| {
                let (cable, noise_n) = (question.cable, question.noise_n);
                Some(Forecast { cable, noise_n, goal: goal?, standard })
            })
            .collect();
        if !forecasts.iter().any(|forecast| forecast.goal.tells()) {
            return Err(self.cannot_tell(&forecasts));
        }
        Ok(Experiment { excitation, forecasts })
    }

    fn step_done(&self) -> Result<(), ExcitationError> {
        self.progress.finish_one();
        if self.is_stopped() { Err(ExcitationError::Stopped) } else { Ok(()) }
    }

    fn is_stopped(&self) -> bool {
        self.progress.stop_flag().load(Ordering::Relaxed)
    }

    /// Returns the reason why there are no results: stopped, or a model gave none.
    fn broken_off(&self) -> ExcitationError {
        if self.is_stopped() {
            return ExcitationError::Stopped;
        }
        let problem = "a model gives no finite forces on some movement; check the parameters in the robot file";
        ExcitationError::BadQuestion { problem: problem.to_owned() }
    }

    /// Returns the models of a question. The first effect is as in the model, or half as strong as the maximum in machines.
    fn case(&self, question: &Question) -> Result<Case, ExcitationError> {
        let name = self.robot.cable_names().get(question.cable).copied().unwrap_or_default().to_owned();
        let bad = |problem: String| ExcitationError::BadQuestion { problem };
        let record = self.standard.cable(question.cable).ok_or_else(|| bad(format!("there is no cable {name}")))?;
        let model = question.values.unwrap_or_else(|| record.params.values());
        let unlikely = || bad(format!("the model of {name} gives no forces on a run; check its parameters"));
        match &question.aim {
            Aim::Determine(wanted) => {
                if let Some(absent) = wanted.iter().find(|of| of.effect().is_some_and(|effect| !has(effect, &model))) {
                    let kind = absent.effect().map_or("", Effect::kind);
                    return Err(bad(format!(
                        "{name} has no `{kind}` in the robot file, so that nobody knows how large `{absent}` may be; add the effect with \
                         the values to be expected"
                    )));
                }
                let mut model = Hypothesis::new(record.params, None, &model).ok_or_else(unlikely)?;
                let missing: Vec<Parameter> = wanted.iter().filter(|of| !model.free.contains(of)).copied().collect();
                model.free.extend(missing);
                Ok(Case::Determine { model, wanted: wanted.clone() })
            }
            Aim::Separate([one, other]) => {
                if one == other || (one.is_none() && other.is_none()) {
                    return Err(bad("two different effects are needed to be told apart; name two".to_owned()));
                }
                // The effect that the model has comes first, because its size is known.
                let is_known = |effect: &Option<Effect>| effect.is_some_and(|effect| has(effect, &model));
                let swapped = one.is_none() || (!is_known(one) && is_known(other));
                let [known, second] = if swapped { [*other, *one] } else { [*one, *other] };
                let base = without(&without(&model, known), second);
                let with_known = match known {
                    Some(effect) if has(effect, &model) => without(&model, second),
                    Some(effect) => with_typical(&record, &base, effect, self.duration_s).ok_or_else(|| {
                        let kind = effect.kind();
                        bad(format!("{name} has no `{kind}` in the robot file; add it with the values to be expected"))
                    })?,
                    None => base,
                };
                let right = Hypothesis::new(record.params, known, &with_known).ok_or_else(unlikely)?;
                let stop = self.progress.stop_flag();
                let prediction = Prediction::new(&record, &right.values, stop).ok_or_else(unlikely)?;
                let (alike, _) = prediction.fitted(&base, second, question.noise_n, None).ok_or_else(unlikely)?;
                let first = usize::from(swapped);
                let (mut both, mut wrong) = ([None, None], [Vec::new(), Vec::new()]);
                wrong[1 - first].push(right.clone());
                wrong[first].push(alike);
                both[first] = Some(right);
                Ok(Case::Separate { base, first, right: Box::new(both), wrong })
            }
        }
    }

    /// Gives the second effect of a question the size at which it looks most like the first on the run of the last forecast. If it is then too small
    /// to be seen, the question of its presence is dropped.
    fn establish(&self, question: &Question, measurements: &Measurements<'_>, case: &mut Case) -> Option<()> {
        let Case::Separate { base, first, right, wrong } = case else { return Some(()) };
        let Aim::Separate(effects) = question.aim else { return Some(()) };
        let (record, stop) = (measurements.cable(question.cable)?, self.progress.stop_flag());
        let second = effects[1 - *first].and(wrong[*first].last())?.clone();
        let prediction = Prediction::new(&record, &second.values, stop)?;
        let (_, without_it) = prediction.fitted(base, None, question.noise_n, None)?;
        if prediction.evidence(&second, &without_it, question.noise_n) >= STRONG_BIC {
            right[1 - *first] = Some(second);
        }
        Some(())
    }

    /// Returns the run with the greatest value, given the present knowledge of the models.
    fn chosen(&self, cases: &[Case]) -> Result<Excitation, ExcitationError> {
        let tests = self.tests(cases, &self.library)?;
        let time_s = self.duration_s - self.lead_in_s;
        let chosen = choose::choose(&tests, &self.times_s, time_s);
        let pieces: Vec<Piece> = chosen.iter().filter_map(|place| self.pieces.get(*place)).copied().collect();
        let mut by_load = pieces.clone();
        by_load.sort_by(|one, other| one.load_share.total_cmp(&other.load_share));
        let backwards: Vec<Piece> = pieces.iter().rev().copied().collect();
        let mut best: Option<(f64, Excitation)> = None;
        for order in [pieces, backwards, by_load] {
            let run = Excitation::of_pieces(self.robot, &self.options, &order, self.duration_s)?;
            let measurements = predicted::frictionless(&self.robot.params(), &mut run.clone())?;
            let whole = self.tests(cases, &measurements)?;
            let sums: Vec<Vec<Sums>> = whole
                .iter()
                .map(|tests| tests.iter().filter_map(|test| test.pieces.first().cloned()).collect())
                .collect();
            let value = objective(&whole, &sums);
            if best.as_ref().is_none_or(|(best, _)| value > *best) {
                best = Some((value, run));
            }
        }
        best.map(|(_, run)| run).ok_or_else(|| self.broken_off())
    }

    /// Returns the tests of all questions with their sums over each log.
    fn tests(&self, cases: &[Case], measurements: &Measurements<'_>) -> Result<Tests, ExcitationError> {
        let of_case = |(question, case): (&Question, &Case)| {
            let record = measurements.cable(question.cable)?;
            let stop = self.progress.stop_flag();
            let noise_n = question.noise_n;
            match case {
                Case::Separate { right, wrong, .. } => {
                    let pairs = right.iter().zip(wrong).filter_map(|(right, wrong)| Some((right.as_ref()?, wrong)));
                    let pairs = pairs.flat_map(|(right, wrong)| wrong.iter().map(move |wrong| (right, wrong)));
                    let test = |(right, wrong): (&Hypothesis, &Hypothesis)| {
                        let prediction = Prediction::new(&record, &right.values, stop)?;
                        let pieces = sums_of_logs(&problem_of(prediction.record(), &wrong.free, stop), &wrong.values)?;
                        Some(Test { measure: Measure::Evidence, noise_n, pieces })
                    };
                    pairs.map(test).collect()
                }
                Case::Determine { model, wanted } => {
                    let prediction = Prediction::new(&record, &model.values, stop)?;
                    let problem = problem_of(prediction.record(), &model.free, stop);
                    let yardstick =
                        crate::certainty::undetermined::yardsticks(&problem, &[model.values]).first().copied()?;
                    let place = |of: &Parameter| model.free.iter().position(|free| free == of);
                    let wanted = wanted.iter().filter_map(|of| Some((place(of)?, *of, model.values[of.place()])));
                    let measure = Measure::Knowledge { wanted: wanted.collect(), yardstick };
                    Some(vec![Test { measure, noise_n, pieces: sums_of_logs(&problem, &model.values)? }])
                }
            }
        };
        let all: Option<Tests> = self.questions.par_iter().zip(cases).map(of_case).collect();
        all.ok_or_else(|| self.broken_off())
    }

    /// Returns the expected results of a run, and adds the models that come nearest on it to the cases.
    fn forecast(&self, measurements: &Measurements<'_>, cases: &mut [Case]) -> Vec<Option<Goal>> {
        let of_case = |(question, case): (&Question, &mut Case)| {
            let record = measurements.cable(question.cable)?;
            self.forecast_one(question, &record, case)
        };
        self.questions.par_iter().zip(cases).map(of_case).collect()
    }

    fn forecast_one(&self, question: &Question, record: &CableRecord<'_>, case: &mut Case) -> Option<Goal> {
        let (stop, noise_n) = (self.progress.stop_flag(), question.noise_n);
        match case {
            Case::Separate { base, right, wrong, .. } => {
                let mut delta_bic = [None; 2];
                let Aim::Separate(effects) = question.aim else { return None };
                for (place, (right, wrong)) in right.iter().zip(wrong).enumerate() {
                    let Some(right) = right else { continue };
                    let prediction = Prediction::new(record, &right.values, stop)?;
                    let other = effects[1 - place];
                    let (nearest, trial) = prediction.fitted(base, other, noise_n, wrong.last())?;
                    delta_bic[place] = Some(prediction.evidence(right, &trial, noise_n));
                    wrong.push(nearest);
                }
                Some(Goal::Separated { effects, delta_bic })
            }
            Case::Determine { model, wanted } => {
                let prediction = Prediction::new(record, &model.values, stop)?;
                let problem = problem_of(prediction.record(), &model.free, stop);
                let yardstick =
                    crate::certainty::undetermined::yardsticks(&problem, &[model.values]).first().copied()?;
                let (matrix, ..) = problem.gram(&[model.values])?.normal_equations();
                let inverse = crate::certainty::undetermined::inverse_of_normal(&matrix)?;
                let covariance = &inverse * (noise_n * noise_n)
                    + crate::certainty::unlike_pulleys::covariance(&problem, &[model.values], &inverse);
                #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
                let count = record.rows.len() as f64;
                let known = |parameter: &Parameter| {
                    let place = model.free.iter().position(|free| free == parameter)?;
                    let value = model.values[parameter.place()];
                    let standard_error = covariance[(place, place)].sqrt();
                    let leverage = (count * inverse[(place, place)]).sqrt();
                    let vagueness = yardstick.vagueness(parameter, value, standard_error, leverage);
                    Some(KnownParameter { parameter: *parameter, value, standard_error, vagueness })
                };
                Some(Goal::Determined(wanted.iter().filter_map(known).collect()))
            }
        }
    }

    fn cannot_tell(&self, forecasts: &[Forecast]) -> ExcitationError {
        let names = self.robot.cable_names();
        let best = forecasts.iter().max_by(|one, other| one.goal.score().total_cmp(&other.goal.score()));
        let what = best.map_or_else(String::new, |best| {
            let name = names.get(best.cable).copied().unwrap_or_default();
            match &best.goal {
                Goal::Separated { effects, delta_bic } => {
                    let [one, other] = effects.map(|effect| effect.map_or("no effect", Effect::kind));
                    let least = delta_bic.iter().flatten().copied().fold(f64::INFINITY, f64::min);
                    format!(
                        "{one} from {other} on {name}: the best gives a ΔBIC of {least:.1} to expect, and {STRONG_BIC} is needed"
                    )
                }
                Goal::Determined(known) => {
                    let vaguest = known.iter().max_by(|one, other| one.vagueness.total_cmp(&other.vagueness));
                    vaguest.map_or_else(String::new, |known| {
                        let KnownParameter { parameter, value, standard_error, .. } = known;
                        format!("`{parameter}` of {name}: the best leaves {value:.4} ± {standard_error:.2}")
                    })
                }
            }
        });
        ExcitationError::CannotTell { what, duration_s: self.duration_s }
    }
}

/// Returns the least-squares problem of a cable over all its samples.
fn problem_of<'r>(record: CableRecord<'r>, free: &[Parameter], stop: &'r AtomicBool) -> Problem<'r> {
    Problem {
        used: vec![true; record.rows.len()],
        members: vec![Member { record, free: free.to_vec() }],
        comparison: Comparison::Forces,
        loss: Loss::Squares,
        stop,
        seat: None,
    }
}

/// Returns the identification run, cut to a duration.
fn standard_run(
    robot: &RobotFile,
    options: &ExcitationOptions,
    duration_s: f64,
) -> Result<Excitation, ExcitationError> {
    // On a test bench the identification run does not change the load.
    let is_bench = !robot.params().cables().iter().any(fric_core::CableParams::has_geometry);
    let unbound = ExcitationOptions { min_tension_n: None, max_tension_n: None, ..*options };
    let mut run = Excitation::new(robot, if is_bench { &unbound } else { options })?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked: at most 10 minutes")]
    let cycles = libm::round(duration_s / run.cycle_s) as u64;
    run.total_cycles = run.total_cycles.min(cycles);
    Ok(run)
}
