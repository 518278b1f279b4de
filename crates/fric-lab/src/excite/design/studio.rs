//! The design of a run for several questions: a library of pieces, rounds of selection and forecast, and the best run of all rounds.

use std::sync::atomic::Ordering;

use fric_core::effects::Effect;
use fric_core::robot::file::RobotFile;
use rayon::prelude::*;

use super::criterion::{Sums, objective};
use super::models::QuestionModels;
use super::{Experiment, Forecast, Goal, KnownParameter, Question, choose, pieces, predicted};
use crate::candidates::ripple::least_range_m;
use crate::discover::naming::STRONG_BIC;
use crate::excite::loads::Loads;
use crate::excite::{Excitation, ExcitationError, ExcitationOptions};
use crate::fit::{Measurements, Progress, Reference};
use crate::samples::record::Row;
use crate::simulate::mechanics::motion::Motion;
use crate::trajectory::{LOAD_CHANGE_S, Piece, Trajectory, WorkBox};

/// Least and greatest noise, N.
const NOISES_N: [f64; 2] = [1e-9, 1e6];

/// Number of rounds of selection and refit, after a first one that determines the size of the second effects.
const ROUNDS: usize = 2;

/// A run with the goals that it reaches.
type Designed = (Excitation, Vec<Option<Goal>>);

/// The data of a design.
pub(super) struct Studio<'a> {
    pub(super) robot: &'a RobotFile,
    pub(super) options: ExcitationOptions,
    pub(super) duration_s: f64,
    pub(super) questions: &'a [Question],
    pub(super) progress: &'a Progress,
    pub(super) pieces: Vec<Piece>,
    /// Duration of each piece, including a change of the load before it, s.
    times_s: Vec<f64>,
    lead_in_s: f64,
    loads: Loads,
    library: Measurements<'a>,
    pub(super) standard: Measurements<'a>,
}

impl<'a> Studio<'a> {
    pub(super) fn new(
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
        let known = robot.params().known_reference().filter(|_| empty.work_box.is_none());
        let (work_box, limits) = (empty.work_box.unwrap_or(Motion::BENCH), options.limits(known.as_ref()));
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
            loads: empty.loads,
            library,
            standard,
        })
    }

    pub(super) fn design(&self) -> Result<Experiment, ExcitationError> {
        self.progress.begin(4 + 2 * ROUNDS);
        let in_all = |work: &(dyn Fn(&Question) -> Result<QuestionModels, ExcitationError> + Sync)| {
            self.questions.par_iter().map(work).collect::<Result<Vec<QuestionModels>, ExcitationError>>()
        };
        let mut cases = in_all(&|question| self.case(question))?;
        self.step_done()?;
        // The first run determines the size of the second effects.
        let (_, measurements) = self.next_run(&mut cases)?;
        self.questions.par_iter().zip(&mut cases).for_each(|(question, case)| {
            self.establish(question, &measurements, case);
        });
        let (mut excitation, mut goals) = self.best_run(&mut cases)?;
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = 0.5 * excitation.total_cycles() as f64;
        let asked = cases.iter_mut().zip(goals.iter_mut().flatten());
        if asked.filter_map(|(case, goal)| case.ask_for_first_alone(goal, count)).count() > 0 {
            self.progress.begin(2 * ROUNDS);
            let designed = self.best_run(&mut cases)?;
            if worth(&designed.1) > worth(&goals) {
                (excitation, goals) = designed;
            }
        }
        let of_standard = self.forecast(&self.standard, &mut cases);
        self.step_done()?;
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

    /// Returns the run with the greatest expected worth of some rounds, each with what the one before has shown to come near the truth, and the goals that
    /// it reaches.
    fn best_run(&self, cases: &mut [QuestionModels]) -> Result<Designed, ExcitationError> {
        let mut best: Option<(f64, Designed)> = None;
        for _ in 0..ROUNDS {
            let (designed, _) = self.next_run(cases)?;
            let value = worth(&designed.1);
            if best.as_ref().is_none_or(|(best, _)| value > *best) {
                best = Some((value, designed));
            }
        }
        best.map(|(_, designed)| designed).ok_or_else(|| self.broken_off())
    }

    /// Returns the run chosen with the present knowledge of the models, the goals that it reaches, and its samples; adds the models that come nearest on it.
    fn next_run(&self, cases: &mut [QuestionModels]) -> Result<(Designed, Measurements<'_>), ExcitationError> {
        let run = self.chosen(cases)?;
        self.step_done()?;
        let measurements = predicted::frictionless(&self.robot.params(), &mut run.clone())?;
        let goals = self.forecast(&measurements, cases);
        self.step_done()?;
        Ok(((run, goals), measurements))
    }

    fn step_done(&self) -> Result<(), ExcitationError> {
        self.progress.finish_one();
        if self.is_stopped() { Err(ExcitationError::Stopped) } else { Ok(()) }
    }

    fn is_stopped(&self) -> bool {
        self.progress.stop_flag().load(Ordering::Relaxed)
    }

    /// Returns the reason why there are no results: stopped, or a model gave none.
    pub(super) fn broken_off(&self) -> ExcitationError {
        if self.is_stopped() {
            return ExcitationError::Stopped;
        }
        self.no_forces("a model gives no finite forces on some movement")
    }

    /// Returns the error of a model without forces. Under the small load that a test bench has if nobody states one, its friction may exceed the load.
    pub(super) fn no_forces(&self, what: &str) -> ExcitationError {
        let problem = if self.loads.is_assumed() {
            format!(
                "{what} under {:.1} N, as nothing states the load of the cables; state it by --min-tension-n and --max-tension-n, or by \
                 `reference` under [log] in the robot file",
                self.loads.usual_n()
            )
        } else {
            format!("{what}; check the parameters in the robot file")
        };
        ExcitationError::BadQuestion { problem }
    }

    /// Returns the run with the greatest value, given the present knowledge of the models.
    fn chosen(&self, cases: &[QuestionModels]) -> Result<Excitation, ExcitationError> {
        let tests = self.tests(cases, &self.library)?;
        let time_s = self.duration_s - self.lead_in_s;
        let chosen = choose::choose(&tests, &self.times_s, time_s, &self.needed_pieces(cases));
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

    /// Returns the pieces that the run needs for the discovery to find the period of a ripple, if there may be one: for each cable the shortest piece over
    /// whose range it turns often enough, or else the one with the greatest range.
    fn needed_pieces(&self, cases: &[QuestionModels]) -> Vec<usize> {
        let mut needed: Vec<usize> = Vec::new();
        for (question, case) in self.questions.iter().zip(cases) {
            let Some(least_m) = case.greatest_period_m().map(least_range_m) else { continue };
            let Some(record) = self.library.cable(question.cable) else { continue };
            let covered_m = |(_, rows): (usize, &[Row])| {
                let lengths_m = || rows.iter().map(|row| row.signals.length_m).filter(|length_m| length_m.is_finite());
                lengths_m().fold(f64::NEG_INFINITY, f64::max) - lengths_m().fold(f64::INFINITY, f64::min)
            };
            let ranges_m: Vec<f64> = record.logs().map(covered_m).collect();
            let all = || 0..ranges_m.len().min(self.times_s.len());
            let reaching = all().filter(|piece| ranges_m[*piece] >= least_m);
            let shortest = reaching.min_by(|one, other| self.times_s[*one].total_cmp(&self.times_s[*other]));
            let piece = shortest.or_else(|| all().max_by(|one, other| ranges_m[*one].total_cmp(&ranges_m[*other])));
            needed.extend(piece.filter(|piece| !needed.contains(piece)));
        }
        needed
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

/// Returns the worth of the goals of all questions.
fn worth(goals: &[Option<Goal>]) -> f64 {
    goals.iter().map(|goal| goal.as_ref().map_or(0.0, Goal::score).max(1e-6).ln()).sum()
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
