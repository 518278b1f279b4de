//! Options of a simulation.

use fric_core::effects::Effect;

use super::disturbances::Disturbance;
use super::error::SimulationError;
use super::hidden::HiddenEffect;

/// Longest run, s: 100 days.
const LONGEST_S: f64 = 8.64e6;
/// Maximum noise, N.
const LOUDEST_N: f64 = 1e6;
/// Maximum noise and step of an encoder, m.
const COARSEST_M: f64 = 1.0;

/// The movement of the platform.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Run {
    /// The identification run, [`Trajectory::identification`](crate::trajectory::Trajectory::identification), under varying tensions.
    #[default]
    Identification,
    /// The crossing run, [`Trajectory::crossing`](crate::trajectory::Trajectory::crossing), under a constant prestress, so that passes differ only by
    /// noise and micro motion. All cables of the robot must be attached to a platform.
    Crossing,
}

impl Run {
    /// All runs.
    pub const ALL: [Self; 2] = [Self::Identification, Self::Crossing];

    /// Returns the name used on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Identification => "identification",
            Self::Crossing => "crossing",
        }
    }
}

/// Options of a simulation. The robot, including its friction, comes from the robot file.
///
/// ```
/// use fric_lab::simulate::SimulationOptions;
/// let quiet = SimulationOptions { sensor_noise_n: 0.0, reference_noise_n: 0.0, ..SimulationOptions::default() };
/// assert_eq!(quiet.seed, 0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationOptions {
    /// The movement of the platform.
    pub run: Run,
    /// Seed; equal seeds give equal bits.
    pub seed: u64,
    /// Duration, s; one run by default. A shorter time cuts the run, a longer one repeats it.
    pub duration_s: Option<f64>,
    /// Standard deviation of the white Gaussian noise of each cable's force sensor, N.
    pub sensor_noise_n: f64,
    /// Standard deviation of the white Gaussian noise of each reference force at the platform, N.
    pub reference_noise_n: f64,
    /// Maximum relative difference of each pulley's μ from the cable's: uniform in `±mu_spread_ratio`, 0…1.
    pub mu_spread_ratio: f64,
    /// Standard deviation of the drift of each sensor's zero, N.
    pub sensor_wander_n: f64,
    /// Standard deviation of the drift of each reference force, N.
    pub reference_wander_n: f64,
    /// Correlation time of both drifts, s.
    pub wander_s: f64,
    /// Greatest force with which a hand pushes slowly and at random, even while the winches rest, N: on the platform along each base axis, or on each
    /// cable of a test bench along the cable.
    pub hand_n: f64,
    /// Standard deviation of the white Gaussian noise of each logged length, m. With noise or a resolution, the logged speed is the difference of two
    /// logged lengths over a cycle, as from a bare encoder.
    pub length_noise_m: f64,
    /// Resolution of the logged length, m; 0 for none.
    pub length_resolution_m: f64,
    /// Effects that act on every cable in addition to those in the robot file.
    pub effects: Vec<HiddenEffect>,
    /// Disturbances outside the catalogue that act on the log of every cable.
    pub disturbances: Vec<Disturbance>,
}

impl Default for SimulationOptions {
    /// Returns one identification run with 0.02 N of noise at the sensor and 0.01 N at the reference, equal pulleys per cable, exact lengths, no
    /// hand, and nothing hidden.
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
    /// Checks whether all numbers are in range for a robot with this cycle time.
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
            let kind = effect.effect().kind();
            let before = self.effects.iter().take(place).filter(|other| other.effect().kind() == kind).count();
            if before >= Effect::all_of_kind(kind).count() {
                return Err(SimulationError::RepeatedEffect { kind });
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
