//! A path of goals and the tensions at the base that follow it, one command after the other.

use fric_tendon::file::ManipulatorFile;
use fric_tendon::{
    AnyStaticModel, Command, Direction, Drive, Friction, Goal, GoalStatus, ManipulatorError, ManipulatorParams,
};

use super::columns::{self, Columns};
use super::error::ContinuumError;
use super::shape_errors::Way;

/// A smaller change of the bend has no direction, rad: well above the tolerance with which the inverse finds the bend of a tip.
const LEAST_CHANGE_RAD: f64 = 1e-6;

/// The goals of a path, all of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Goals {
    /// Bends of the whole manipulator, rad.
    BendRad(Vec<f64>),
    /// Positions of the tip, m.
    TipM(Vec<[f64; 2]>),
}

impl Goals {
    /// Returns the number of goals.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::BendRad(bend_rad) => bend_rad.len(),
            Self::TipM(tip_m) => tip_m.len(),
        }
    }

    /// Returns the goals one by one. Positions are then in the base frame.
    pub fn each(&self) -> impl Iterator<Item = Goal> {
        let (bend_rad, tip_m) = match self {
            Self::BendRad(bend_rad) => (bend_rad.as_slice(), &[][..]),
            Self::TipM(tip_m) => (&[][..], tip_m.as_slice()),
        };
        bend_rad.iter().copied().map(Goal::BendRad).chain(tip_m.iter().copied().map(Goal::TipM))
    }

    /// Returns the goals in the base frame, for positions in the frame of the markers that a manipulator file states.
    #[must_use]
    pub fn in_base_frame(&self, file: &ManipulatorFile) -> Self {
        match (self, &file.tables().markers) {
            (Self::TipM(tip_m), Some(markers)) => {
                Self::TipM(tip_m.iter().map(|tip_m| markers.in_base_frame(*tip_m)).collect())
            }
            _ => self.clone(),
        }
    }
}

/// A checked path: the goals are finite, and times, if there are any, increase.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalPath {
    time_s: Option<Vec<f64>>,
    goals: Goals,
}

impl GoalPath {
    /// Creates a path from named columns: `bend_rad`, or `tip_x_m` and `tip_y_m`, and optionally `time_s`.
    ///
    /// # Errors
    /// Returns a [`ContinuumError`] with the first column that is unknown, missing or of another length, if there are goals of both kinds, or with the
    /// first number that is not finite or time that does not increase.
    pub fn from_columns(columns: &[(String, Vec<f64>)]) -> Result<Self, ContinuumError> {
        let all = Columns::new(columns, &columns::of_path())?;
        let tips = all.group(&columns::TIP.map(ToOwned::to_owned))?;
        let goals = match (all.get(columns::BEND), tips) {
            (Some(bend_rad), None) => Goals::BendRad(bend_rad.to_vec()),
            (None, Some(tips)) => {
                let [x_m, y_m] = [0, 1].map(|axis: usize| tips.get(axis).copied().unwrap_or_default());
                Goals::TipM(x_m.iter().zip(y_m).map(|(x_m, y_m)| [*x_m, *y_m]).collect())
            }
            (Some(_), Some(_)) => return Err(ContinuumError::TwoKindsOfGoals),
            (None, None) => return Err(ContinuumError::NoGoals),
        };
        for (name, numbers) in columns {
            if let Some((place, value)) = numbers.iter().enumerate().find(|(_, value)| !value.is_finite()) {
                return Err(ContinuumError::NotFinite { column: name.clone(), row: place + 1, value: *value });
            }
        }
        let time_s = all.get(columns::TIME);
        for (place, pair) in time_s.unwrap_or_default().windows(2).enumerate() {
            if let [before_s, time_s] = *pair
                && time_s <= before_s
            {
                return Err(ContinuumError::TimeNotRising { row: place + 2, time_s, before_s });
            }
        }
        Ok(Self { time_s: time_s.map(<[f64]>::to_vec), goals })
    }

    /// Returns the time of each goal, s, if the path states times.
    #[must_use]
    pub fn time_s(&self) -> Option<&[f64]> {
        self.time_s.as_deref()
    }

    /// Returns the goals as the columns state them.
    #[must_use]
    pub fn goals(&self) -> &Goals {
        &self.goals
    }
}

/// A command in the terms of the measurements: with the sensor at the base and the frame of the markers that the manipulator file states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowedGoal {
    /// Tensions to set at the base, N, as a sensor there shows them: first and second tendon. The sensor of the file is that of the first.
    pub tension_base_n: [f64; 2],
    /// Predicted bend of the whole manipulator, rad.
    pub bend_rad: f64,
    /// Predicted position of the tip, m.
    pub tip_m: [f64; 2],
    /// Status of the command.
    pub status: GoalStatus,
}

impl FollowedGoal {
    /// Converts a command. The lag of the sensor is left out, because the tension is to stay; what it shows is never negative.
    #[must_use]
    pub fn as_measured(command: &Command, file: &ManipulatorFile) -> Self {
        let tables = file.tables();
        let (markers, sensor) = (tables.markers.unwrap_or_default(), tables.base_sensor.unwrap_or_default());
        let Command { base_tension_n: [first_n, second_n], bend_rad, tip_m, status } = *command;
        let shown_n = (sensor.gain * first_n + sensor.offset_n).max(0.0);
        Self { tension_base_n: [shown_n, second_n], bend_rad, tip_m: markers.measured(tip_m), status }
    }
}

/// Commands for one goal after the other by one friction model, as if each command were carried out exactly.
///
/// With [`Way::Coulomb`] all holes slide in the direction of the change from goal to goal. [`Way::Measured`] knows nothing of other tensions: each
/// command has the status `NOT_USABLE`.
#[derive(Clone, Debug)]
pub struct Follower {
    way: Way,
    drive: Drive,
    model: AnyStaticModel,
    /// The bend without friction tells the direction of a change, also for goals of the tip.
    frictionless: AnyStaticModel,
    direction: Direction,
    before_rad: f64,
}

impl Follower {
    /// Starts with the relaxed tendons.
    ///
    /// # Errors
    /// Checked parameters cause no error; the signature is that of the model's constructor.
    pub fn new(params: &ManipulatorParams, drive: &Drive, way: Way) -> Result<Self, ManipulatorError> {
        let model = AnyStaticModel::new(params)?;
        let mut frictionless = model.clone();
        // A failure leaves the straight shape.
        let _ = frictionless.solve([0.0; 2], Friction::None);
        let before_rad = frictionless.bend_rad();
        Ok(Self { way, drive: *drive, model, frictionless, direction: Direction::Pulling, before_rad })
    }

    /// Passes on tensions at the base that were set before the path begins, N, in time order. Returns the number of steps for which the model has no
    /// shape; they leave the state of the step before.
    pub fn advance(&mut self, base_tension_n: impl IntoIterator<Item = [f64; 2]>) -> usize {
        let mut missing = 0;
        for base_tension_n in base_tension_n {
            missing += usize::from(!self.model.solve(base_tension_n, Friction::History).has_shape());
        }
        self.before_rad = self.model.bend_rad();
        missing
    }

    /// Returns the command for the next goal; its `base_tension_n` counts as set.
    pub fn next(&mut self, goal: Goal) -> Command {
        let friction = match self.way {
            Way::None => Friction::None,
            Way::Coulomb => Friction::Coulomb(self.direction_to(goal)),
            Way::Measured => Friction::Measured([&[], &[]]),
            Way::History => Friction::History,
        };
        let command = self.model.tension_for(goal, friction, &self.drive);
        // A failure of the shape is also one of the command.
        let _ = self.model.solve(command.base_tension_n, friction);
        command
    }

    /// Returns the direction of the change to a goal; a goal that equals the last one keeps the direction.
    fn direction_to(&mut self, goal: Goal) -> Direction {
        let wanted_rad = match goal {
            Goal::BendRad(bend_rad) => bend_rad,
            Goal::TipM(_) => {
                let command = self.frictionless.tension_for(goal, Friction::None, &self.drive);
                let _ = self.frictionless.solve(command.base_tension_n, Friction::None);
                command.bend_rad
            }
        };
        let change_rad = wanted_rad - self.before_rad;
        if change_rad.abs() > LEAST_CHANGE_RAD {
            self.direction = Direction::of_change(change_rad);
            self.before_rad = wanted_rad;
        }
        self.direction
    }
}
