//! Follows a path of bends through the inverse of the model on the simulated manipulator, and measures the distance of the tip from its goal for each
//! friction model.
//!
//! The goals are tip positions that the simulated manipulator itself has had: it is pulled once, and the tip is recorded at each wanted bend. The
//! inverse of the model ([`AnyStaticModel::tension_for`]) then gives the tension at the base for one goal after the other, and the elastica with its
//! sticking holes moves there in small steps. There is no feedback, so the error of a tension remains.

use fric_lab::random::uniform;
use fric_tendon::{
    AnyStaticModel, Direction, Drive, DriveOptions, Friction, Goal, GoalStatus, ManipulatorParams, Tendon,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::elastica::Elastica;
use super::holes::Rubbing;
use crate::error::ContinuumError;
use crate::shape_errors::Way;

/// Longest step of the tension that the simulated manipulator takes at once, as a fraction of the tendon's capacity.
const STEP_RATIO: f64 = 0.006;

/// Options of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackOptions {
    /// Wanted bends in sequence, rad.
    pub bend_rad: Vec<f64>,
    /// Seed; equal seeds give equal bits.
    pub seed: u64,
    /// Maximum relative difference of each hole's μ from the stated one: uniform in `±mu_spread_ratio`, 0…1.
    pub mu_spread_ratio: f64,
    /// Number of links in a segment, 4…200.
    pub link_count: usize,
}

/// One goal of a path with one friction model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedGoal {
    /// Wanted position of the tip, m.
    pub wanted_m: [f64; 2],
    /// Position of the simulated manipulator's tip, m.
    pub tip_m: [f64; 2],
    /// Tension at the base, N.
    pub tension_base_n: f64,
    /// Status of the inverse.
    pub status: GoalStatus,
}

impl TrackedGoal {
    /// Returns the distance of the tip from the goal, m.
    #[must_use]
    pub fn error_m(&self) -> f64 {
        libm::hypot(self.tip_m[0] - self.wanted_m[0], self.tip_m[1] - self.wanted_m[1])
    }
}

/// A path with one friction model.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// The friction model: none, Coulomb with the direction of each change, or history.
    pub way: Way,
    /// The goals in sequence.
    pub goals: Vec<TrackedGoal>,
}

impl Track {
    /// Returns the mean distance of the tip from the goals, m.
    #[must_use]
    pub fn mean_error_m(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a number of goals")]
        let count = self.goals.len().max(1) as f64;
        self.goals.iter().map(TrackedGoal::error_m).sum::<f64>() / count
    }
}

/// Follows a path three times: without friction compensation, with Coulomb friction in the direction of each change of the bend, and with the holes'
/// history.
///
/// # Errors
/// Returns [`ContinuumError::OptionOutOfRange`] for an option or a bend that is out of range, or [`ContinuumError::NoShape`] if the manipulator has
/// no equilibrium.
pub fn track(params: &ManipulatorParams, options: &TrackOptions) -> Result<Vec<Track>, ContinuumError> {
    options.check()?;
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let spread = options.mu_spread_ratio;
    let mu: Vec<f64> =
        params.mu(Tendon::Agonist).iter().map(|mu| mu * (1.0 + uniform(&mut random, -spread, spread))).collect();
    let start = Arm::new(params, options, mu)?;
    let goals_m = recorded(start.clone(), params, &options.bend_rad)?;
    [Way::None, Way::Coulomb, Way::History]
        .into_iter()
        .map(|way| Ok(Track { way, goals: follow(start.clone(), params, options, &goals_m, way)? }))
        .collect()
}

/// The simulated manipulator and the tension at its base.
#[derive(Clone)]
struct Arm {
    rubbing: Rubbing,
    step_n: f64,
    tension_base_n: f64,
}

impl Arm {
    fn new(params: &ManipulatorParams, options: &TrackOptions, mu: Vec<f64>) -> Result<Self, ContinuumError> {
        let rubbing = Rubbing::new(Elastica::new(params, options.link_count), mu).map_err(|_| no_shape(0.0))?;
        Ok(Self { rubbing, step_n: STEP_RATIO * params.capacity_n(Tendon::Agonist), tension_base_n: 0.0 })
    }

    /// Moves to a tension at the base in small steps.
    fn pull(&mut self, tension_base_n: f64) -> Result<(), ContinuumError> {
        let from_n = self.tension_base_n;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
        let parts = ((tension_base_n - from_n).abs() / self.step_n).ceil() as u32;
        for part in 1..=parts {
            let between_n = from_n + (tension_base_n - from_n) * f64::from(part) / f64::from(parts);
            self.rubbing.step(between_n).map_err(|_| no_shape(between_n))?;
        }
        self.tension_base_n = tension_base_n;
        Ok(())
    }

    fn bend_rad(&self) -> f64 {
        self.rubbing.elastica().bend_rad()
    }

    fn tip_m(&self) -> [f64; 2] {
        self.rubbing.elastica().disk_position_m().last().copied().unwrap_or([0.0; 2])
    }
}

fn no_shape(tension_base_n: f64) -> ContinuumError {
    ContinuumError::NoShape { time_s: 0.0, tension_base_n }
}

/// Returns the position of the tip at each of these bends while the arm is pulled once, interpolated linearly between two steps of the tension.
fn recorded(mut arm: Arm, params: &ManipulatorParams, bend_rad: &[f64]) -> Result<Vec<[f64; 2]>, ContinuumError> {
    let min = arm.bend_rad();
    let max_rad = bend_rad.iter().copied().fold(min, f64::max);
    let mut goals_m = vec![None; bend_rad.len()];
    while goals_m.contains(&None) {
        let (from_rad, from_m) = (arm.bend_rad(), arm.tip_m());
        let next_n = arm.tension_base_n + arm.step_n;
        if from_rad > max_rad || next_n > params.capacity_n(Tendon::Agonist) {
            break;
        }
        arm.pull(next_n)?;
        let (to_rad, to_m) = (arm.bend_rad(), arm.tip_m());
        for (goal_m, bend_rad) in goals_m.iter_mut().zip(bend_rad) {
            if (from_rad..=to_rad).contains(bend_rad) {
                let share = (bend_rad - from_rad) / (to_rad - from_rad);
                *goal_m = Some([0, 1].map(|axis: usize| from_m[axis] + share * (to_m[axis] - from_m[axis])));
            }
        }
    }
    let max = arm.bend_rad();
    let each = goals_m.into_iter().zip(bend_rad);
    each.map(|(goal_m, &value)| goal_m.ok_or(ContinuumError::OptionOutOfRange { key: "bend_rad", value, min, max }))
        .collect()
}

fn follow(
    mut arm: Arm,
    params: &ManipulatorParams,
    options: &TrackOptions,
    goals_m: &[[f64; 2]],
    way: Way,
) -> Result<Vec<TrackedGoal>, ContinuumError> {
    let drive = Drive::new(params, &DriveOptions::first_tendon(params))?;
    let mut model = AnyStaticModel::new(params)?;
    let mut before_rad = 0.0;
    let mut goals = Vec::with_capacity(goals_m.len());
    for (&bend_rad, &wanted_m) in options.bend_rad.iter().zip(goals_m) {
        let friction = match way {
            Way::Coulomb => Friction::Coulomb(Direction::of_change(bend_rad - before_rad)),
            Way::History => Friction::History,
            _ => Friction::None,
        };
        let command = model.tension_for(Goal::TipM(wanted_m), friction, &drive);
        let [tension_base_n, _] = command.base_tension_n;
        // The shape is where the next search starts; with the history it is also the memory.
        let _ = model.solve(command.base_tension_n, friction);
        arm.pull(tension_base_n)?;
        before_rad = bend_rad;
        goals.push(TrackedGoal { wanted_m, tip_m: arm.tip_m(), tension_base_n, status: command.status });
    }
    Ok(goals)
}

impl TrackOptions {
    fn check(&self) -> Result<(), ContinuumError> {
        #[expect(clippy::cast_precision_loss, reason = "a number of links")]
        let ranges =
            [("mu_spread_ratio", self.mu_spread_ratio, 0.0, 1.0), ("link_count", self.link_count as f64, 4.0, 200.0)];
        for (key, value, min, max) in ranges {
            if !(min..=max).contains(&value) {
                return Err(ContinuumError::OptionOutOfRange { key, value, min, max });
            }
        }
        Ok(())
    }
}
