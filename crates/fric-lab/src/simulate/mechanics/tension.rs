//! Cable tensions and their variation: prestress of a platform, load of a test bench.
//!
//! A run must contain many loads of each cable; otherwise load-dependent friction cannot be distinguished from load-independent friction. The
//! tensions therefore vary over about a factor of three, slowly compared with the movements.

use fric_core::robot::file::CableTable;
use rand_chacha::ChaCha8Rng;

use super::platform::Platform;
use super::waves::Waves;
use crate::trajectory::FASTEST_M_PER_S;

/// Mean tension of a robot without mass, N: that of a small robot with sensors up to 20 N at 180°.
const LIGHT_N: f64 = 4.0;
/// Mean tension divided by the platform's weight.
const PER_WEIGHT: f64 = 1.0;
/// Least tension divided by mean tension, apart from the viscous friction.
const LEAST_SHARE: f64 = 0.1;
/// Prestress common to all cables: amplitudes relative to the mean, and frequencies in Hz.
const COMMON: [(f64, f64); 2] = [(0.27, 0.09), (0.13, 0.31)];
/// Additional prestress of each cable.
const OWN: [(f64, f64); 2] = [(0.06, 0.17), (0.04, 0.53)];
/// Load of a test bench: slow waves, and steps.
const LOAD: [(f64, f64); 2] = [(0.25, 0.07), (0.1, 0.23)];
const LOAD_STEPS: [(f64, f64); 2] = [(0.1, 0.11), (0.07, 0.19)];
/// Pushes of a hand: amplitudes relative to the greatest push, and frequencies in Hz.
const PUSHES: [(f64, f64); 3] = [(0.5, 0.22), (0.3, 0.55), (0.2, 1.2)];

/// Mean and least tension at the platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensionLevel {
    pub mean_n: f64,
    pub least_n: f64,
}

impl TensionLevel {
    /// Returns the level for a platform that its cables hold. It includes the viscous friction at full speed, which therefore does not slacken a
    /// cable at its winch.
    pub fn of_platform(platform: &Platform, tables: &[CableTable]) -> Self {
        let viscous_n_s_per_m = most_viscous_n_s_per_m(tables);
        Self::new((PER_WEIGHT * platform.weight_n()).max(LIGHT_N), viscous_n_s_per_m)
    }

    /// Returns the level for a test bench with the platform's weight on the cables.
    pub fn of_bench(weight_n: f64, tables: &[CableTable]) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a number of cables")]
        let each_n = weight_n / tables.len().max(1) as f64;
        let viscous_n_s_per_m = most_viscous_n_s_per_m(tables);
        Self::new(if each_n > 0.0 { each_n } else { LIGHT_N }, viscous_n_s_per_m)
    }

    fn new(mean_n: f64, viscous_n_s_per_m: f64) -> Self {
        // No cable is faster than the platform.
        let drag_n = viscous_n_s_per_m * FASTEST_M_PER_S;
        Self { mean_n: mean_n + drag_n, least_n: LEAST_SHARE * mean_n + drag_n }
    }

    /// Returns the lowest and the highest possible prestress.
    pub fn extremes_n(&self) -> [f64; 2] {
        let swing: f64 = COMMON.iter().chain(&OWN).map(|(amplitude, _)| amplitude).sum();
        [self.mean_n * (1.0 - swing), self.mean_n * (1.0 + swing)]
    }
}

/// Returns the greatest sum of `F_pv` along a cable.
fn most_viscous_n_s_per_m(tables: &[CableTable]) -> f64 {
    let whole = |table: &CableTable| table.pulleys.iter().map(|_| table.friction.viscous_n_s_per_m).sum();
    tables.iter().map(whole).fold(0.0, f64::max)
}

/// Variation of a tension over time.
#[derive(Clone, Debug)]
pub struct Variation {
    waves: Waves,
    steps: Waves,
}

impl Variation {
    /// Returns the part of a platform's prestress that all cables share.
    pub fn common(random: &mut ChaCha8Rng) -> Self {
        Self { waves: Waves::new(&COMMON, random), steps: Waves::new(&[], random) }
    }

    /// Returns a cable's own part of the prestress.
    pub fn own(random: &mut ChaCha8Rng) -> Self {
        Self { waves: Waves::new(&OWN, random), steps: Waves::new(&[], random) }
    }

    /// Returns the load of a cable on a test bench.
    pub fn load(random: &mut ChaCha8Rng) -> Self {
        Self { waves: Waves::new(&LOAD, random), steps: Waves::new(&LOAD_STEPS, random) }
    }

    /// Returns the pushes of a hand, relative to the greatest push.
    pub fn pushes(random: &mut ChaCha8Rng) -> Self {
        Self { waves: Waves::new(&PUSHES, random), steps: Waves::new(&[], random) }
    }

    /// Returns the relative deviation from the mean tension.
    pub fn share(&self, time_s: f64) -> f64 {
        self.waves.value(time_s) + self.steps.steps(time_s)
    }
}
