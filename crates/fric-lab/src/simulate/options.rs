//! What a simulation can be told.

use super::disturbances::Disturbance;
use super::error::SimulationError;
use super::hidden::HiddenEffect;

/// Longest run, s: 100 days.
const LONGEST_S: f64 = 8.64e6;
/// Most noise, N.
const LOUDEST_N: f64 = 1e6;
/// Most noise and coarsest step of an encoder, m.
const COARSEST_M: f64 = 1.0;

/// What the platform does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Run {
    /// The identification run, [`Trajectory::identification`](crate::trajectory::Trajectory::identification), under tensions
    /// that wander.
    #[default]
    Identification,
    /// The crossing run, [`Trajectory::crossing`](crate::trajectory::Trajectory::crossing), under a steady prestress, so that
    /// one pass differs from the next by noise and micro motion alone. For robots whose cables are all attached to a
    /// platform.
    Crossing,
}

impl Run {
    /// All there are.
    pub const ALL: [Self; 2] = [Self::Identification, Self::Crossing];

    /// In one word, as the command line has it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Identification => "identification",
            Self::Crossing => "crossing",
        }
    }
}

/// How to simulate a robot. The robot itself, its friction included, is the robot file's.
///
/// ```
/// use fric_lab::simulate::SimulationOptions;
/// let quiet = SimulationOptions { sensor_noise_n: 0.0, reference_noise_n: 0.0, ..SimulationOptions::default() };
/// assert_eq!(quiet.seed, 0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationOptions {
    /// What the platform does.
    pub run: Run,
    /// The same seed gives the same bits.
    pub seed: u64,
    /// How long, s; one run if not given. A shorter time cuts the run, a longer one repeats it.
    pub duration_s: Option<f64>,
    /// Standard deviation of the white Gaussian noise of each cable's force sensor, N.
    pub sensor_noise_n: f64,
    /// Standard deviation of the white Gaussian noise of each reference force at the platform, N.
    pub reference_noise_n: f64,
    /// How far each pulley's μ is from the cable's at most, as a share of it: uniform in `±mu_spread_ratio`, 0…1.
    pub mu_spread_ratio: f64,
    /// Standard deviation by which each sensor's zero wanders to and fro, N.
    pub sensor_wander_n: f64,
    /// Standard deviation by which each reference force wanders, N.
    pub reference_wander_n: f64,
    /// Correlation time of both, s.
    pub wander_s: f64,
    /// How hard a hand pushes, slowly and at random, also while the winches rest: the platform along each base axis, each
    /// cable of a test bench along itself, N at most.
    pub hand_n: f64,
    /// Standard deviation of the white Gaussian noise of each logged length, m. With it or a resolution the logged speed is
    /// the difference of two logged lengths over a cycle, as an encoder alone gives it.
    pub length_noise_m: f64,
    /// Step of the logged length, m; 0: none.
    pub length_resolution_m: f64,
    /// Effects that act on every cable beside those in the robot file.
    pub effects: Vec<HiddenEffect>,
    /// What else spoils the log of every cable, in no catalogue of effects.
    pub disturbances: Vec<Disturbance>,
}

impl Default for SimulationOptions {
    /// One identification run with 0.02 N of noise at the sensor and 0.01 N at the reference, all pulleys of a cable alike,
    /// exact lengths, nobody near, nothing hidden.
    fn default() -> Self {
        Self {
            run: Run::default(),
            seed: 0,
            duration_s: None,
            sensor_noise_n: 0.02,
            reference_noise_n: 0.01,
            mu_spread_ratio: 0.0,
            sensor_wander_n: 0.0,
            reference_wander_n: 0.0,
            wander_s: 2.0,
            hand_n: 0.0,
            length_noise_m: 0.0,
            length_resolution_m: 0.0,
            effects: Vec::new(),
            disturbances: Vec::new(),
        }
    }
}

impl SimulationOptions {
    /// Whether all numbers are in range for a robot with this cycle time.
    pub(super) fn check(&self, cycle_s: f64) -> Result<(), SimulationError> {
        let ranges = [
            ("duration_s", self.duration_s.unwrap_or(cycle_s), cycle_s, LONGEST_S),
            ("sensor_noise_n", self.sensor_noise_n, 0.0, LOUDEST_N),
            ("reference_noise_n", self.reference_noise_n, 0.0, LOUDEST_N),
            ("mu_spread_ratio", self.mu_spread_ratio, 0.0, 1.0),
            ("sensor_wander_n", self.sensor_wander_n, 0.0, LOUDEST_N),
            ("reference_wander_n", self.reference_wander_n, 0.0, LOUDEST_N),
            ("wander_s", self.wander_s, cycle_s, LONGEST_S),
            ("hand_n", self.hand_n, 0.0, LOUDEST_N),
            ("length_noise_m", self.length_noise_m, 0.0, COARSEST_M),
            ("length_resolution_m", self.length_resolution_m, 0.0, COARSEST_M),
        ];
        for (key, value, min, max) in ranges {
            if !(min..=max).contains(&value) {
                return Err(SimulationError::OptionOutOfRange { key, value, min, max });
            }
        }
        for (place, effect) in self.effects.iter().enumerate() {
            if self.effects.iter().take(place).any(|other| other.effect() == effect.effect()) {
                return Err(SimulationError::RepeatedEffect { kind: effect.effect().kind() });
            }
        }
        for (place, disturbance) in self.disturbances.iter().enumerate() {
            if self.disturbances.iter().take(place).any(|other| other.kind() == disturbance.kind()) {
                return Err(SimulationError::RepeatedDisturbance { kind: disturbance.kind() });
            }
        }
        Ok(())
    }
}
