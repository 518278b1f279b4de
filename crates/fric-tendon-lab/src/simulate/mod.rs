//! A simulated manipulator whose true physics differ from the model: runs with gratings, markers and the true state.
//!
//! The backbone is an elastica of many links, found as the minimum of its energy; the tendon sticks and slips in holes whose μ
//! spread, by a rate-independent principle of least energy and dissipation. No curvature is constant, no
//! Dahl state exists, no function of [`fric_tendon`] is called but for its parameters. Gravity and tip load act
//! where the parameters have them. One tendon is pulled; the other is slack.
//!
//! Equal seeds give equal bits.

mod banded;
mod elastica;
mod holes;
pub mod track;

use fric_lab::random::uniform;
use fric_tendon::{ManipulatorParams, Tendon};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use self::elastica::Elastica;
use self::holes::Rubbing;
use super::error::ContinuumError;
use super::fbg::{Calibration, LoadStep};
use super::run::RunSample;

/// Standard gravity, m/s², which converts a mass on a calibration hook to its weight.
pub const STANDARD_GRAVITY_M_PER_S2: f64 = 9.80665;
/// Samples per second of a simulated run.
const SAMPLES_PER_S: f64 = 10.0;

/// The actuation of the tendon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Experiment {
    /// Pulling only: friction has one direction everywhere.
    OneWay,
    /// Alternate pulling and releasing: directions differ along the tendon.
    Mixed,
}

impl Experiment {
    /// All experiments.
    pub const ALL: [Self; 2] = [Self::OneWay, Self::Mixed];

    /// Returns the name in one word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::OneWay => "one_way",
            Self::Mixed => "mixed",
        }
    }

    /// Returns the turning points of the base tension, relative to the greatest one.
    fn turns(self) -> &'static [f64] {
        match self {
            Self::OneWay => &[0.012, 1.0],
            Self::Mixed => &[0.012, 0.62, 0.48, 0.8, 0.6, 0.7, 0.5, 0.58, 0.44, 1.0, 0.86, 0.93],
        }
    }

    /// Returns the base tensions at [`SAMPLES_PER_S`], N.
    fn tensions(self, greatest_n: f64) -> Vec<f64> {
        const STEP_RATIO: f64 = 0.015;
        let turns = self.turns();
        let mut tension_n: Vec<f64> = turns.first().map(|share| share * greatest_n).into_iter().collect();
        for pair in turns.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
            let parts = ((to - from).abs() / STEP_RATIO).ceil() as u32;
            tension_n
                .extend((1..=parts).map(|part| greatest_n * (from + (to - from) * f64::from(part) / f64::from(parts))));
        }
        tension_n
    }
}

/// Options of a simulated run.
#[derive(Clone, Debug, PartialEq)]
pub struct TendonSimulationOptions {
    /// The actuation.
    pub experiment: Experiment,
    /// Greatest tension at the base, N.
    pub greatest_tension_n: f64,
    /// Seed; equal seeds give equal bits.
    pub seed: u64,
    /// Maximum relative difference of each hole's μ from the stated one: uniform in `±mu_spread_ratio`, 0…1.
    pub mu_spread_ratio: f64,
    /// Standard deviation of the white Gaussian noise of each grating, nm.
    pub grating_noise_nm: f64,
    /// Standard deviation of the white Gaussian noise of each coordinate of a marker, m.
    pub marker_noise_m: f64,
    /// Number of links in a segment, 4…200.
    pub link_count: usize,
}

impl Default for TendonSimulationOptions {
    /// Returns a pull to 1.7 N, μ spread by ±10 %, gratings accurate to half a picometre, and markers to a quarter of a millimetre.
    fn default() -> Self {
        Self {
            experiment: Experiment::OneWay,
            greatest_tension_n: 1.7,
            seed: 0,
            mu_spread_ratio: 0.1,
            grating_noise_nm: 0.0005,
            marker_noise_m: 0.00025,
            link_count: 20,
        }
    }
}

/// The true state at one sample, first tendon.
#[derive(Clone, Debug, PartialEq)]
pub struct TendonTruth {
    /// Tension in each segment, N.
    pub tension_n: Vec<f64>,
    /// Friction at each hole, N.
    pub friction_n: Vec<f64>,
    /// Greatest friction that each hole can hold, N.
    pub bound_n: Vec<f64>,
    /// Bend of the whole manipulator, rad.
    pub bend_rad: f64,
}

impl TendonTruth {
    /// Whether friction has both directions, each at some hole beyond a tenth of its bound.
    #[must_use]
    pub fn is_mixed(&self) -> bool {
        let beyond = |sign: f64| self.friction_n.iter().zip(&self.bound_n).any(|(f, c)| sign * f > 0.1 * c);
        beyond(1.0) && beyond(-1.0)
    }
}

/// A simulated run.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedRun {
    /// The measurements.
    pub samples: Vec<RunSample>,
    /// The true state, sample by sample.
    pub truth: Vec<TendonTruth>,
    /// Load steps on the same gratings, 20…200 g in steps of 20 g.
    pub calibration: Vec<LoadStep>,
    /// μ of each hole.
    pub mu: Vec<f64>,
}

/// Simulates a run of a manipulator.
///
/// # Errors
/// Returns [`ContinuumError::OptionOutOfRange`], [`ContinuumError::TooGreatTension`] above the tendon's capacity, or [`ContinuumError::NoShape`] if
/// the manipulator has no equilibrium.
pub fn simulate(params: &ManipulatorParams, options: &TendonSimulationOptions) -> Result<SimulatedRun, ContinuumError> {
    options.check()?;
    let (greatest_tension_n, capacity_n) = (options.greatest_tension_n, params.capacity_n(Tendon::Agonist));
    if greatest_tension_n > capacity_n {
        return Err(ContinuumError::TooGreatTension { greatest_tension_n, capacity_n });
    }
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let spread = options.mu_spread_ratio;
    let mu: Vec<f64> =
        params.mu(Tendon::Agonist).iter().map(|mu| mu * (1.0 + uniform(&mut random, -spread, spread))).collect();
    // Gratings of silica fibre differ by some per cent, and their mounts preload them by some millinewtons.
    let gratings: Vec<Calibration> = mu
        .iter()
        .map(|_| Calibration::known(uniform(&mut random, 10.5, 12.2), uniform(&mut random, -0.03, 0.03), 0.0))
        .collect();
    let mut noise = |size: f64| -> f64 {
        let deviate: f64 = StandardNormal.sample(&mut random);
        size * deviate
    };
    let shifts = |tension_n: &[f64], noise: &mut dyn FnMut(f64) -> f64| -> Vec<f64> {
        let gratings = gratings.iter().zip(tension_n);
        gratings.map(|(grating, tension_n)| grating.shift_nm(*tension_n) + noise(options.grating_noise_nm)).collect()
    };
    let calibration = (1..=10)
        .map(|step| {
            let load_n = 0.02 * f64::from(step) * STANDARD_GRAVITY_M_PER_S2;
            LoadStep { load_n, shift_nm: shifts(&vec![load_n; mu.len()], &mut noise) }
        })
        .collect();

    let no_shape = |time_s: f64, base_n: f64| ContinuumError::NoShape { time_s, tension_base_n: base_n };
    let elastica = Elastica::new(params, options.link_count);
    let mut rubbing = Rubbing::new(elastica, mu.clone()).map_err(|_| no_shape(0.0, 0.0))?;
    let tensions_n = options.experiment.tensions(options.greatest_tension_n);
    let (mut samples, mut truth) = (Vec::with_capacity(tensions_n.len()), Vec::with_capacity(tensions_n.len()));
    for (place, tension_base_n) in (0_u32..).zip(tensions_n) {
        let time_s = f64::from(place) / SAMPLES_PER_S;
        rubbing.step(tension_base_n).map_err(|_| no_shape(time_s, tension_base_n))?;
        let shift_nm = shifts(rubbing.tension_n(), &mut noise);
        let mut marker_m = rubbing.elastica().disk_position_m();
        for coordinate_m in marker_m.iter_mut().flatten() {
            *coordinate_m += noise(options.marker_noise_m);
        }
        samples.push(RunSample { time_s, tension_base_n, shift_nm, marker_m, ..RunSample::default() });
        truth.push(TendonTruth {
            tension_n: rubbing.tension_n().to_vec(),
            friction_n: rubbing.friction_n().to_vec(),
            bound_n: rubbing.bound_n().to_vec(),
            bend_rad: rubbing.elastica().bend_rad(),
        });
    }
    Ok(SimulatedRun { samples, truth, calibration, mu })
}

/// Returns the centres of the disks, m, and the bend, rad, of the elastica under given tensions in the segments of both tendons, N, without holes.
///
/// An empty slice is a slack tendon. It is the truth that [`fric_tendon::StaticModel`] is compared with.
///
/// # Errors
/// Returns [`ContinuumError::NoShape`] if the energy has no minimum nearby.
pub fn elastica(
    params: &ManipulatorParams,
    link_count: usize,
    tension_n: [&[f64]; 2],
) -> Result<(Vec<[f64; 2]>, f64), ContinuumError> {
    const LOAD_STEPS: u32 = 8;
    let mut elastica = Elastica::new(params, link_count);
    for step in 1..=LOAD_STEPS {
        let share = f64::from(step) / f64::from(LOAD_STEPS);
        let part_n = tension_n.map(|tension_n| tension_n.iter().map(|tension_n| share * tension_n).collect::<Vec<_>>());
        let tension_base_n = tension_n[0].first().copied().unwrap_or(0.0);
        elastica
            .settle([&part_n[0], &part_n[1]])
            .map_err(|_| ContinuumError::NoShape { time_s: 0.0, tension_base_n })?;
    }
    Ok((elastica.disk_position_m(), elastica.bend_rad()))
}

/// Returns the centres of the disks, m, of the elastica under tensions of the first tendon that follow one another; `None` where it has no minimum nearby.
pub(crate) fn elastica_along<'a>(
    params: &ManipulatorParams,
    tension_n: impl Iterator<Item = &'a [f64]>,
) -> impl Iterator<Item = Option<Vec<[f64; 2]>>> {
    let mut elastica = Elastica::new(params, TendonSimulationOptions::default().link_count);
    tension_n.map(move |tension_n| {
        let is_settled = tension_n.iter().all(|one| one.is_finite()) && elastica.settle([tension_n, &[]]).is_ok();
        is_settled.then(|| elastica.disk_position_m())
    })
}

impl TendonSimulationOptions {
    fn check(&self) -> Result<(), ContinuumError> {
        #[expect(clippy::cast_precision_loss, reason = "a number of links")]
        let ranges = [
            ("greatest_tension_n", self.greatest_tension_n, 1e-6, 1e6),
            ("mu_spread_ratio", self.mu_spread_ratio, 0.0, 1.0),
            ("grating_noise_nm", self.grating_noise_nm, 0.0, 10.0),
            ("marker_noise_m", self.marker_noise_m, 0.0, 1.0),
            ("link_count", self.link_count as f64, 4.0, 200.0),
        ];
        for (key, value, min, max) in ranges {
            if !(min..=max).contains(&value) {
                return Err(ContinuumError::OptionOutOfRange { key, value, min, max });
            }
        }
        Ok(())
    }
}
