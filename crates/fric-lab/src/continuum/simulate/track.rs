//! A path of bends, followed through the inverse of the model on the simulated manipulator: how far the tip is from where it is
//! wanted, by what is known of friction.
//!
//! Each goal is the tip of the arm without friction at a wanted bend. The inverse of [`StaticModel`] gives the tension at the base, the
//! elastica with its sticking holes goes there in small steps, and nothing of where it ends comes back: what is
//! wrong with a tension stays wrong.

use fric_core::continuum::{
    Command, Direction, Drive, DriveOptions, Friction, Goal, GoalStatus, MAX_DISKS, ManipulatorParams, StaticModel,
    Tendon,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::elastica::Elastica;
use super::holes::Rubbing;
use crate::continuum::error::ContinuumError;
use crate::continuum::shape_errors::Way;
use crate::random::uniform;

/// Longest step of the tension that the simulated manipulator takes at once, as a share of the tendon's capacity.
const STEP_RATIO: f64 = 0.006;

/// How to follow a path.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackOptions {
    /// Wanted bends one after the other, rad.
    pub bend_rad: Vec<f64>,
    /// The same seed gives the same bits.
    pub seed: u64,
    /// How far each hole's μ is from the stated one at most, as a share of it: uniform in `±mu_spread_ratio`, 0…1.
    pub mu_spread_ratio: f64,
    /// Links in a segment, 4…200.
    pub link_count: usize,
}

/// One goal of a path by one way of friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedGoal {
    /// Wanted place of the tip, m.
    pub wanted_m: [f64; 2],
    /// Where the simulated manipulator has it, m.
    pub tip_m: [f64; 2],
    /// Tension at the base, N.
    pub tension_base_n: f64,
    /// What the inverse had to say.
    pub status: GoalStatus,
}

impl TrackedGoal {
    /// How far the tip is from where it is wanted, m.
    #[must_use]
    pub fn error_m(&self) -> f64 {
        libm::hypot(self.tip_m[0] - self.wanted_m[0], self.tip_m[1] - self.wanted_m[1])
    }
}

/// A path by one way of friction.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Which way: none, Coulomb with the direction of each change, or history.
    pub way: Way,
    /// Goal by goal.
    pub goals: Vec<TrackedGoal>,
}

impl Track {
    /// Mean distance of the tip from where it is wanted, m.
    #[must_use]
    pub fn mean_error_m(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a number of goals")]
        let count = self.goals.len().max(1) as f64;
        self.goals.iter().map(TrackedGoal::error_m).sum::<f64>() / count
    }
}

/// Follows a path three times: without compensation of friction, with Coulomb's in the direction of each change of the bend, and with the
/// holes' history.
///
/// # Errors
/// [`ContinuumError::OptionOutOfRange`] for an option or a bend that the arm cannot have; [`ContinuumError::NoShape`] where the manipulator finds no equilibrium.
pub fn track(params: &ManipulatorParams, options: &TrackOptions) -> Result<Vec<Track>, ContinuumError> {
    options.check()?;
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let spread = options.mu_spread_ratio;
    let mu: Vec<f64> =
        params.mu(Tendon::Agonist).iter().map(|mu| mu * (1.0 + uniform(&mut random, -spread, spread))).collect();
    [Way::None, Way::Coulomb, Way::History]
        .into_iter()
        .map(|way| Ok(Track { way, goals: follow(params, options, &mu, way)? }))
        .collect()
}

fn follow(
    params: &ManipulatorParams,
    options: &TrackOptions,
    mu: &[f64],
    way: Way,
) -> Result<Vec<TrackedGoal>, ContinuumError> {
    let drive = Drive::new(params, &DriveOptions::first_tendon(params))?;
    let mut model = Box::new(StaticModel::<MAX_DISKS>::new(params)?);
    let mut ideal = model.clone();
    let no_shape = |tension_base_n: f64| ContinuumError::NoShape { time_s: 0.0, tension_base_n };
    let mut arm = Rubbing::new(Elastica::new(params, options.link_count), mu.to_vec()).map_err(|_| no_shape(0.0))?;
    let step_n = STEP_RATIO * params.capacity_n(Tendon::Agonist);
    let (mut before_rad, mut now_n) = (0.0, 0.0);
    let mut goals = Vec::with_capacity(options.bend_rad.len());
    for &bend_rad in &options.bend_rad {
        let Command { tip_m: wanted_m, status, .. } =
            ideal.tension_for(Goal::BendRad(bend_rad), Friction::None, &drive);
        if !status.is_reached() {
            let max = ideal.tension_for(Goal::BendRad(10.0), Friction::None, &drive).bend_rad;
            return Err(ContinuumError::OptionOutOfRange { key: "bend_rad", value: bend_rad, min: 0.0, max });
        }
        let friction = match way {
            Way::Coulomb => Friction::Coulomb(Direction::of_change(bend_rad - before_rad)),
            Way::History => Friction::History,
            _ => Friction::None,
        };
        let command = model.tension_for(Goal::TipM(wanted_m), friction, &drive);
        let [tension_base_n, _] = command.base_tension_n;
        // The shape is where the next search starts; with the history it is the memory too.
        let _ = model.solve(command.base_tension_n, friction);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
        let parts = ((tension_base_n - now_n).abs() / step_n).ceil() as u32;
        for part in 1..=parts {
            let between_n = now_n + (tension_base_n - now_n) * f64::from(part) / f64::from(parts);
            arm.step(between_n).map_err(|_| no_shape(between_n))?;
        }
        (before_rad, now_n) = (bend_rad, tension_base_n);
        let tip_m = arm.elastica().disk_position_m().last().copied().unwrap_or([0.0; 2]);
        goals.push(TrackedGoal { wanted_m, tip_m, tension_base_n, status: command.status });
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
