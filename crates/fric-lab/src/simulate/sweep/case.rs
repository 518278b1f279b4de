//! Converts the description of a case into its log.

use fric_core::robot::file::{RobotFile, RobotFileError};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use thiserror::Error;

use super::robots::{CABLE_COUNT, Friction, GUESS, bench, small_robot};
use super::values;
use super::{Case, Group};
use crate::effects::Sizing;
use crate::excite::ExcitationError;
use crate::random::uniform;
use crate::simulate::disturbances::Disturbance;
use crate::simulate::error::{HiddenError, SimulationError};
use crate::simulate::hidden::HiddenEffect;
use crate::simulate::options::SimulationOptions;
use crate::simulate::stream::Simulation;

/// Default noise, N.
const SENSOR_NOISE_N: f64 = 0.02;
const REFERENCE_NOISE_N: f64 = 0.01;
/// Relative spread of μ over the pulleys.
const SPREAD_RATIO: f64 = 0.1;
/// Duration of a log from the test bench, s, and resolution of its encoder, m.
const BENCH_S: f64 = 25.0;
const BENCH_RESOLUTION_M: f64 = 2e-6;
/// Approximate duration of the small robot's identification run, s.
const RUN_S: f64 = 52.0;
/// Mean normal force of the three pulleys per tension: 2 at 180°, √2 at 90°, as much at the swivelling one.
pub(super) const NORMAL_PER_TENSION: f64 = 1.6;
/// Apart from the streams of the simulation itself, which has the same seed.
const STREAM: u64 = u64::MAX;

/// A log to search, and its hidden content.
#[derive(Debug)]
pub struct CaseLog {
    /// The robot file of a user: without the effect and with guessed friction. It contains only the log's cable.
    pub robot: RobotFile,
    /// The text of the robot file.
    pub robot_text: String,
    /// The log itself, one sample per cycle.
    pub simulation: Simulation,
    /// The hidden content.
    pub truth: CaseTruth,
}

/// The true content of a log.
#[derive(Clone, Debug)]
pub struct CaseTruth {
    /// The robot of the log with its true friction, without the effects. Its μ is the mean over the pulleys, as the sensor measures it.
    pub robot: RobotFile,
    /// Hidden effects of the catalogue.
    pub effects: Vec<HiddenEffect>,
    /// Hidden disturbances outside the catalogue.
    pub disturbances: Vec<Disturbance>,
    /// White noise of the force at the platform, sensor and reference together, N: no model can have a smaller error.
    pub floor_n: f64,
}

/// The reason why a case has no log.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The case names an unknown effect or disturbance, or its strength is out of range.
    #[error(transparent)]
    Hidden(#[from] HiddenError),
    /// The robot of the case is invalid.
    #[error(transparent)]
    Robot(#[from] RobotFileError),
    /// Its robot finds no way to move.
    #[error(transparent)]
    Excitation(#[from] ExcitationError),
    /// It cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

impl Case {
    /// Draws what the seed decides and sets up the simulation.
    ///
    /// # Errors
    /// Returns a [`SweepError`] for a case with unknown names or numbers out of range.
    pub fn log(&self) -> Result<CaseLog, SweepError> {
        let random = &mut ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(STREAM);
        let friction = Friction {
            mu: uniform(random, 0.011, 0.025),
            sigma_n_per_m: uniform(random, 600.0, 1250.0),
            viscous_n_s_per_m: uniform(random, 0.08, 0.4),
        };
        let mass_kg = uniform(random, 0.41, 0.6);
        let cables = f64::from(u32::try_from(CABLE_COUNT).unwrap_or(1));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 8")]
        let cable = (uniform(random, 0.0, cables) as usize).min(CABLE_COUNT - 1);
        let is_bench = self.group == Group::Bench;
        let robot_text = |friction: &Friction| {
            if is_bench { bench(mass_kg, friction) } else { small_robot([cable].into_iter(), mass_kg, friction) }
        };
        let robot = |friction: &Friction| RobotFile::parse(&robot_text(friction), "sweep");
        // The weight plus the viscous friction at 1 m/s.
        let tension_n = mass_kg * 9.80665 + 3.0 * friction.viscous_n_s_per_m;
        let strength = &mut Sizing {
            strength_ratio: self.strength_ratio,
            mu: friction.mu,
            tension_n,
            normal_n: NORMAL_PER_TENSION * tension_n,
            duration_s: if is_bench { BENCH_S } else { RUN_S },
            random,
        };
        let effects =
            self.effects.iter().map(|effect| values::effect(*effect, strength)).collect::<Result<Vec<_>, _>>()?;
        let disturbances =
            self.disturbance.iter().map(|kind| values::disturbance(kind, strength)).collect::<Result<Vec<_>, _>>()?;
        let options = SimulationOptions {
            seed: self.seed,
            duration_s: is_bench.then_some(BENCH_S),
            sensor_noise_n: self.noise_ratio * SENSOR_NOISE_N,
            reference_noise_n: self.noise_ratio * REFERENCE_NOISE_N,
            mu_spread_ratio: SPREAD_RATIO,
            sensor_wander_n: self.sensor_wander_n,
            reference_wander_n: self.reference_wander_n,
            hand_n: self.hand_n,
            length_resolution_m: if is_bench { BENCH_RESOLUTION_M } else { 0.0 },
            effects: effects.clone(),
            disturbances: disturbances.clone(),
            ..SimulationOptions::default()
        };
        let simulation = if is_bench {
            Simulation::new(&robot(&friction)?, &options)?
        } else {
            let whole = RobotFile::parse(&small_robot(0..CABLE_COUNT, mass_kg, &friction), "sweep")?;
            Simulation::of(&whole, &options, cable..cable + 1, None)?
        };
        // At 180° the sensor measures the cable force twice.
        let floor_n = libm::hypot(0.5 * options.sensor_noise_n, options.reference_noise_n);
        let mean = Friction { mu: simulation.mean_mu(0).unwrap_or(friction.mu), ..friction };
        let truth = CaseTruth { robot: robot(&mean)?, effects, disturbances, floor_n };
        Ok(CaseLog { robot: robot(&GUESS)?, robot_text: robot_text(&GUESS), simulation, truth })
    }
}
