//! A cable on a test bench moved at will: friction from the equations, computed in another way than by the fit's model.
//!
//! The bristle of \[P\] 16 on each pulley with the exact normal force (\[P\] 7), from the platform back to the sensor
//! (\[P\] 5, 6, 11), in small steps of time.

use fric_core::CableInput;
use fric_lab::simulate::START_NANOS;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::logs::{Cycle, Log};

const SUBSTEPS: u32 = 20;

/// Friction as it truly is, and how it is measured.
#[derive(Clone, Debug)]
pub struct Bench {
    pub mu: f64,
    pub sigma_n_per_m: f64,
    pub viscous_n_s_per_m: f64,
    pub offset_n: f64,
    /// From the winch; the first pulley carries the sensor.
    pub wraps_deg: Vec<f64>,
    /// μ of each pulley as a multiple of `mu`; of those that are not there 1.
    pub mu_ratios: Vec<f64>,
    pub cycle_s: f64,
    pub sensor_noise_n: f64,
    pub reference_noise_n: f64,
    pub seed: u64,
}

impl Default for Bench {
    fn default() -> Self {
        Self {
            mu: 0.02,
            sigma_n_per_m: 1000.0,
            viscous_n_s_per_m: 0.3,
            offset_n: 0.2,
            wraps_deg: vec![180.0, 90.0],
            mu_ratios: Vec::new(),
            cycle_s: 0.001,
            sensor_noise_n: 0.02,
            reference_noise_n: 0.01,
            seed: 0,
        }
    }
}

/// The pulleys of the default bench in a robot file.
pub const PULLEYS: &str = "{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }";

impl Bench {
    /// The pulleys' μ.
    fn mus(&self) -> impl Iterator<Item = f64> {
        self.mu_ratios.iter().copied().chain(std::iter::repeat(1.0)).map(|ratio| ratio * self.mu)
    }

    /// True parameters in the order of the file's `friction`; μ is the mean of the pulleys', each by the share of its friction that the sensor
    /// feels per normal force (\[P\] 8, 11).
    pub fn truth(&self) -> [f64; 4] {
        let share = |(place, wrap_deg): (usize, &f64)| {
            let cos = wrap_deg.to_radians().cos();
            let felt = if place == 0 { -cos / (1.0 - cos) } else { 1.0 };
            felt * (2.0 - 2.0 * cos).sqrt()
        };
        let shares: Vec<f64> = self.wraps_deg.iter().enumerate().map(share).collect();
        let mu = self.mus().zip(&shares).map(|(mu, share)| mu * share).sum::<f64>() / shares.iter().sum::<f64>();
        [mu, self.sigma_n_per_m, self.viscous_n_s_per_m, self.offset_n]
    }

    /// Noise of the compensated force against the reference with the true parameters, N.
    pub fn floor_n(&self) -> f64 {
        let gain = 1.0 / (1.0 - self.wraps_deg[0].to_radians().cos());
        (gain * self.sensor_noise_n).hypot(self.reference_noise_n)
    }

    /// A log of `duration_s` with the winch at `length_m(t)` and `force_n(t)` at the platform.
    pub fn run(&self, duration_s: f64, length_m: impl Fn(f64) -> f64, force_n: impl Fn(f64) -> f64) -> Log {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let stiffness_n_per_m = self.sigma_n_per_m / f64::from(u32::try_from(self.wraps_deg.len()).unwrap());
        let cosines: Vec<f64> = self.wraps_deg.iter().map(|wrap_deg| wrap_deg.to_radians().cos()).collect();
        let mus: Vec<f64> = self.mus().take(cosines.len()).collect();
        let mut friction_n = vec![0.0; cosines.len()];
        let mut cycles = Vec::new();
        let mut cycle = 0_u32;
        while f64::from(cycle) * self.cycle_s < duration_s {
            let time_s = f64::from(cycle) * self.cycle_s;
            let step_s = self.cycle_s / f64::from(SUBSTEPS);
            let speed_at = |time_s: f64| (length_m(time_s + 1e-6) - length_m(time_s - 1e-6)) / 2e-6;
            if cycle > 0 {
                for substep in 0..SUBSTEPS {
                    let from_s = time_s - self.cycle_s + f64::from(substep) * step_s;
                    let way_m = length_m(from_s + step_s) - length_m(from_s);
                    let mut downstream_n = force_n(from_s + 0.5 * step_s);
                    for ((stored_n, cos), mu) in friction_n.iter_mut().zip(&cosines).zip(&mus).rev() {
                        let upstream_n = downstream_n - *stored_n - self.viscous_n_s_per_m * way_m / step_s;
                        let normal_n =
                            (upstream_n.powi(2) - 2.0 * upstream_n * downstream_n * cos + downstream_n.powi(2)).sqrt();
                        let bound_n = mu * normal_n;
                        let decay = (-stiffness_n_per_m * way_m.abs() / bound_n).exp();
                        // 0·∞ where nothing rubs: no friction.
                        let pulled_n = if bound_n > 0.0 { bound_n * way_m.signum() } else { 0.0 };
                        if way_m.abs() > 0.0 {
                            *stored_n = pulled_n + (*stored_n - pulled_n) * decay;
                        }
                        downstream_n = upstream_n;
                    }
                }
            }
            let speed_m_per_s = speed_at(time_s);
            let at_platform_n = force_n(time_s);
            let (mut behind_n, mut before_n) = (at_platform_n, at_platform_n);
            for stored_n in friction_n.iter().rev() {
                behind_n = before_n;
                before_n = behind_n - stored_n - self.viscous_n_s_per_m * speed_m_per_s;
            }
            let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
            let sensor_force_n = behind_n - before_n * cosines[0] + self.sensor_noise_n * noise();
            cycles.push(Cycle {
                stamp_nanos: START_NANOS + nanos(time_s),
                cables: vec![CableInput { sensor_force_n, length_m: length_m(time_s), speed_m_per_s }],
                reference_force_n: vec![at_platform_n + self.offset_n + self.reference_noise_n * noise()],
                pose: None,
                outside_wrench: None,
            });
            cycle += 1;
        }
        Log(cycles)
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the length of a log")]
fn nanos(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

/// Tension that wanders about a mean by a third.
pub fn wandering(mean_n: f64) -> impl Fn(f64) -> f64 {
    move |time_s| mean_n * (1.0 + 0.25 * (1.1 * time_s).sin() + 0.1 * (2.9 * time_s + 1.0).cos())
}

/// Strokes of ±`amplitude_m` whose frequency wanders: from slow to fast and back, with reversals.
pub fn strokes(amplitude_m: f64, hertz: f64) -> impl Fn(f64) -> f64 {
    let turns = std::f64::consts::TAU * hertz;
    move |time_s| 1.0 + amplitude_m * (turns * time_s + 2.0 * (0.4 * time_s).sin()).sin()
}
