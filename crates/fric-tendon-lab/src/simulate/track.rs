//! Follows a path of goals with the inverse of the model on the simulated manipulator, and measures the distance of the tip from its goal for each
//! friction model.
//!
//! The follower ([`crate::follow`]) gives the tension at the base for one goal after the other, and the elastica with its sticking holes moves there
//! in small steps. There is no feedback, so the error of a tension remains.
//!
//! A single pull of the simulated manipulator is the reference. It has one tip position at each bend, the goal for a wanted bend, and its tip moves on
//! a curve: the part of the distance along that curve is what another tension would correct. The part across it no tension corrects, because friction
//! of both directions bends the manipulator unevenly.

use fric_lab::random::uniform;
use fric_tendon::{Drive, DriveOptions, Goal, GoalStatus, ManipulatorParams, Tendon};
use nalgebra::Vector2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::elastica::Elastica;
use super::holes::Rubbing;
use crate::columns;
use crate::error::ContinuumError;
use crate::follow::{Follower, Goals};
use crate::shape_errors::Way;

/// Longest step of the tension that the simulated manipulator takes at once, as a fraction of the tendon's capacity.
const STEP_RATIO: f64 = 0.006;
/// Bend at which the reference pull for positions of the tip ends, rad: the tip has come back to the base.
const PULL_END_RAD: f64 = 2.0 * core::f64::consts::PI;

/// The friction models that are compared.
const WAYS: [Way; 3] = [Way::None, Way::Coulomb, Way::History];

/// Options of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackOptions {
    /// Goals in sequence; positions of the tip in the base frame.
    pub goals: Goals,
    /// Seed; equal seeds give equal bits.
    pub seed: u64,
    /// Maximum relative difference of each hole's μ from the stated one: uniform in `±mu_spread_ratio`, 0…1.
    pub mu_spread_ratio: f64,
    /// Number of links in a segment, 4…200.
    pub link_count: usize,
}

impl TrackOptions {
    /// Returns the options for a path with μ spread by ±10 % and ten links in a segment.
    #[must_use]
    pub fn new(goals: Goals) -> Self {
        Self { goals, seed: 0, mu_spread_ratio: 0.1, link_count: 10 }
    }
}

/// One goal of a path with one friction model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedGoal {
    /// Wanted position of the tip, m.
    pub wanted_m: [f64; 2],
    /// Wanted bend, rad, if the goal is a bend.
    pub wanted_rad: Option<f64>,
    /// Position of the simulated manipulator's tip, m.
    pub tip_m: [f64; 2],
    /// Bend of the simulated manipulator, rad.
    pub bend_rad: f64,
    /// Distance of the tip beyond its goal along the curve of a single pull, m; negative if the tip stops short of it.
    pub along_m: f64,
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
        self.mean(TrackedGoal::error_m)
    }

    /// Returns the mean distance along the curve of a single pull, m.
    #[must_use]
    pub fn mean_along_m(&self) -> f64 {
        self.mean(|goal| goal.along_m.abs())
    }

    /// Returns the mean difference from the wanted bends, rad; `None` if the goals are positions.
    #[must_use]
    pub fn mean_bend_error_rad(&self) -> Option<f64> {
        let has_bends = self.goals.iter().any(|goal| goal.wanted_rad.is_some());
        has_bends
            .then(|| self.mean(|goal| goal.wanted_rad.map_or(0.0, |wanted_rad| (goal.bend_rad - wanted_rad).abs())))
    }

    fn mean(&self, of: impl Fn(&TrackedGoal) -> f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a number of goals")]
        let count = self.goals.len().max(1) as f64;
        self.goals.iter().map(of).sum::<f64>() / count
    }
}

/// Follows a path three times with the first tendon: without friction compensation, with Coulomb friction in the direction of each change, and with
/// the holes' history.
///
/// # Errors
/// Returns [`ContinuumError::OptionOutOfRange`] for an option that is out of range, [`ContinuumError::NotFinite`] for a goal that is not finite, [`ContinuumError::NotPulledTo`] for a bend that a single pull does
/// not reach, or [`ContinuumError::NoShape`] if the manipulator has no equilibrium.
pub fn track(params: &ManipulatorParams, options: &TrackOptions) -> Result<Vec<Track>, ContinuumError> {
    options.check()?;
    let start = Arm::new(params, options)?;
    let pull = Pull::record(start.clone(), params, &options.goals);
    let wanted_m = pull.wanted(&options.goals)?;
    WAYS.into_iter()
        .map(|way| Ok(Track { way, goals: follow(start.clone(), params, options, &pull, &wanted_m, way)? }))
        .collect()
}

/// Returns the positions of the simulated manipulator's tip at these bends of a single pull, base frame, m. They are goals that the tip has in its
/// reach.
///
/// # Errors
/// Returns the errors of [`track`].
pub fn pulled_tips(params: &ManipulatorParams, options: &TrackOptions) -> Result<Vec<[f64; 2]>, ContinuumError> {
    options.check()?;
    Pull::record(Arm::new(params, options)?, params, &options.goals).wanted(&options.goals)
}

/// The simulated manipulator and the tension at its base.
#[derive(Clone)]
struct Arm {
    rubbing: Rubbing,
    step_n: f64,
    tension_base_n: f64,
}

impl Arm {
    fn new(params: &ManipulatorParams, options: &TrackOptions) -> Result<Self, ContinuumError> {
        let mut random = ChaCha8Rng::seed_from_u64(options.seed);
        let spread = options.mu_spread_ratio;
        let mu: Vec<f64> =
            params.mu(Tendon::Agonist).iter().map(|mu| mu * (1.0 + uniform(&mut random, -spread, spread))).collect();
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

/// A single pull: bend, rad, and position of the tip, m, after each step of the tension.
struct Pull(Vec<(f64, Vector2<f64>)>);

impl Pull {
    /// Pulls until all wanted bends are behind, the tendon's capacity is reached or there is no equilibrium.
    fn record(mut arm: Arm, params: &ManipulatorParams, goals: &Goals) -> Self {
        let end_rad = match goals {
            Goals::BendRad(bend_rad) => bend_rad.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            Goals::TipM(_) => PULL_END_RAD,
        };
        let mut steps = vec![(arm.bend_rad(), Vector2::from(arm.tip_m()))];
        loop {
            let next_n = arm.tension_base_n + arm.step_n;
            // The last step goes beyond the end, so that there are two steps at least.
            let is_behind = steps.len() > 1 && arm.bend_rad() > end_rad;
            if is_behind || next_n > params.capacity_n(Tendon::Agonist) || arm.pull(next_n).is_err() {
                return Self(steps);
            }
            steps.push((arm.bend_rad(), arm.tip_m().into()));
        }
    }

    /// Returns the wanted position of the tip for each goal, m; for a bend by linear interpolation between two steps.
    fn wanted(&self, goals: &Goals) -> Result<Vec<[f64; 2]>, ContinuumError> {
        let bends_rad = match goals {
            Goals::TipM(tip_m) => return Ok(tip_m.clone()),
            Goals::BendRad(bends_rad) => bends_rad,
        };
        let at = |(place, wanted_rad): (usize, &f64)| {
            let pairs =
                self.0.windows(2).filter_map(|pair| if let [one, other] = pair { Some((one, other)) } else { None });
            let mut found = pairs.filter(|((from_rad, _), (to_rad, _))| (*from_rad..=*to_rad).contains(wanted_rad));
            let Some(((from_rad, from_m), (to_rad, to_m))) = found.next() else {
                let bends = self.0.iter().map(|(bend_rad, _)| *bend_rad);
                return Err(ContinuumError::NotPulledTo {
                    row: place + 1,
                    bend_rad: *wanted_rad,
                    least_rad: bends.clone().fold(f64::INFINITY, f64::min),
                    greatest_rad: bends.fold(f64::NEG_INFINITY, f64::max),
                });
            };
            let share = if to_rad > from_rad { (wanted_rad - from_rad) / (to_rad - from_rad) } else { 0.0 };
            Ok((from_m + share * (to_m - from_m)).into())
        };
        bends_rad.iter().enumerate().map(at).collect()
    }

    /// Returns the direction of the tip's curve where it is nearest to a position.
    fn direction(&self, tip_m: Vector2<f64>) -> Vector2<f64> {
        let middle = |pair: &[(f64, Vector2<f64>)]| match pair {
            [(_, from_m), (_, to_m)] => Some((0.5 * (from_m + to_m), to_m - from_m)),
            _ => None,
        };
        let nearest = self.0.windows(2).filter_map(middle).min_by(|(one_m, _), (other_m, _)| {
            (one_m - tip_m).norm_squared().total_cmp(&(other_m - tip_m).norm_squared())
        });
        nearest.and_then(|(_, step_m)| step_m.try_normalize(0.0)).unwrap_or_else(Vector2::y)
    }
}

fn follow(
    mut arm: Arm,
    params: &ManipulatorParams,
    options: &TrackOptions,
    pull: &Pull,
    wanted_m: &[[f64; 2]],
    way: Way,
) -> Result<Vec<TrackedGoal>, ContinuumError> {
    let drive = Drive::new(params, &DriveOptions::first_tendon(params))?;
    let mut follower = Follower::new(params, &drive, way)?;
    let one = |(goal, &wanted_m): (Goal, &[f64; 2])| {
        let command = follower.next(goal);
        let [tension_base_n, _] = command.base_tension_n;
        arm.pull(tension_base_n)?;
        let (tip_m, wanted) = (arm.tip_m(), Vector2::from(wanted_m));
        Ok(TrackedGoal {
            wanted_m,
            wanted_rad: if let Goal::BendRad(bend_rad) = goal { Some(bend_rad) } else { None },
            tip_m,
            bend_rad: arm.bend_rad(),
            along_m: pull.direction(wanted).dot(&(Vector2::from(tip_m) - wanted)),
            tension_base_n,
            status: command.status,
        })
    };
    options.goals.each().zip(wanted_m).map(one).collect()
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
        let (column, numbers, width) = match &self.goals {
            Goals::BendRad(bend_rad) => (columns::BEND, bend_rad.as_slice(), 1),
            Goals::TipM(tip_m) => ("tip_m", tip_m.as_flattened(), 2),
        };
        match numbers.iter().enumerate().find(|(_, value)| !value.is_finite()) {
            Some((place, value)) => {
                Err(ContinuumError::NotFinite { column: column.to_owned(), row: place / width + 1, value: *value })
            }
            None => Ok(()),
        }
    }
}
