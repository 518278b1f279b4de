//! The design of a run: movements and loads chosen so that a log of them answers a question that another log left open.
//!
//! A question is either which of two effects a cable has, or how large some parameters are. The value of a run is computed from the cycle's own model
//! (`criterion`): the model predicts the log (`predicted`), and its derivatives show how much of that another model could compensate. Runs consist of
//! pieces (`pieces`), each checked against all limits; `choose` selects the pieces with the greatest value. The evidence is then recomputed for the
//! whole run, by fitting the wrong model to the prediction of the right one (`hypothesis`), once for each model being the right one. The values
//! that the wrong model takes there enter the selection of the next round.
//!
//! The method is that of optimal experiments: T-optimality to distinguish models (A. C. Atkinson, V. V. Fedorov, *Biometrika* 62 (1975), 57–70), and
//! the information of the wanted parameters with all others unknown to determine them (Fedorov 1972). Noise is assumed to be white.

mod choose;
mod criterion;
mod hypothesis;
mod models;
mod pieces;
mod predicted;
mod studio;

use fric_core::effects::Effect;
use fric_core::parameters::Values;
use fric_core::robot::file::RobotFile;

use self::studio::Studio;
use super::{Excitation, ExcitationError, ExcitationOptions};
use crate::discover::naming::STRONG_BIC;
use crate::fit::{Parameter, Progress};

/// Default duration of a run, s.
pub const STANDARD_DURATION_S: f64 = 20.0;

/// A run answers a question if its score is at least this.
pub const LEAST_SCORE: f64 = 1.0;

/// Least and greatest duration of a designed run, s.
const DURATIONS_S: [f64; 2] = [3.0, 600.0];

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
    /// the model lacks is given half its greatest usual strength, or the strength at which it is hardest to tell from the other.
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
    /// `ΔBIC` in favour of the effect that the cable has: if it is the first, and if it is the second; `None` for no effect, and for one that is too small
    /// to be seen or that the other imitates.
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
    /// Width of its interval, divided by the widest that still counts as determined.
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
