//! A platform under admittance control that nobody touches: the idle oscillation of \[P\], and how much compensation reduces it.
//!
//! The loop of \[P\] IV C is closed around the simulated robot: sensor forces → (compensation) → wrench → virtual body ([`fric_core::admittance`]) →
//! set point of the pose → servo → motion of platform and cables → bristles on every pulley → sensor forces. Friction in the pulleys appears in the
//! sensors as a wrench that nobody exerts. The virtual body yields to it, which reverses the friction, and so on.
//!
//! The friction is that of [`super::bristle`], never the compensator's, and each pulley's μ differs from the value that the compensator knows. The
//! servo is critically damped and of second order, the same on all axes. The tensions hold the platform's weight and inertia around a constant
//! prestress. Rotations are quasi-static.

use fric_core::admittance::{Admittance, AdmittanceOptions, SetPoint};
use fric_core::robot::file::RobotFile;
use fric_core::{AnyCompensator, CableInput, CableParams, ParamError, Pose, Wrench};
use nalgebra::{Vector3, Vector6};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use thiserror::Error;

use super::bristle::{BristleChain, Moment, SUBSTEPS};
use super::mechanics::distribution::Distribution;
use super::mechanics::platform::Platform;
use super::mechanics::tension::TensionLevel;
use super::stream::{Purpose, chain, random};
use super::truth::TruthEffects;
use super::{SimulationError, SimulationOptions};

/// Options of the idle simulation.
#[derive(Clone, Debug)]
pub struct IdleOptions {
    /// The virtual body.
    pub body: AdmittanceOptions,
    /// Whether the wrench uses compensated cable forces instead of the raw sensor forces.
    pub compensated: bool,
    /// Duration, s.
    pub duration_s: f64,
    /// Natural angular frequency of the servo, rad/s.
    pub servo_rad_per_s: f64,
    /// Force with which a hand pushes along (1, 1, 1) in the first half second, N.
    pub push_n: f64,
    /// Standard deviation of the sensor noise, N.
    pub sensor_noise_n: f64,
    /// Maximum relative difference of each pulley's μ from the file's value.
    pub mu_spread_ratio: f64,
    /// Seed of noise and spread.
    pub seed: u64,
}

/// The motion of the platform.
#[derive(Clone, Debug, PartialEq)]
pub struct IdleMotion {
    /// Displacement of the platform's origin from the rest pose, base axes, m, one row per cycle.
    pub displacement_m: Vec<[f64; 3]>,
}

/// The reason why the loop cannot be closed.
#[derive(Debug, Error)]
pub enum IdleError {
    /// Duration, push, noise or spread is out of range.
    #[error(transparent)]
    Options(#[from] SimulationError),
    /// The virtual body or the servo is invalid, or the library rejects the robot.
    #[error(transparent)]
    Param(#[from] ParamError),
    /// A cable has no attachment, or cannot leave its pulley with the platform at the origin.
    #[error(
        "the platform has to hang at the origin of the base frame by cables that all have `base_m` and `platform_m`"
    )]
    NoPlatform,
}

impl IdleMotion {
    /// Returns the amplitude in the second half of the run: half the peak-to-peak motion on the axis where it is greatest, m.
    #[must_use]
    pub fn amplitude_m(&self) -> f64 {
        let late = self.displacement_m.get(self.displacement_m.len() / 2..).unwrap_or_default();
        let half_way_m = |axis: usize| {
            let places = late.iter().map(|place| place[axis]);
            let (least, greatest) =
                places.fold((f64::MAX, f64::MIN), |(least, greatest), x| (least.min(x), greatest.max(x)));
            0.5 * (greatest - least).max(0.0)
        };
        (0..3).map(half_way_m).fold(0.0, f64::max)
    }
}

/// Runs the loop.
///
/// # Errors
/// Returns an [`IdleError`] if the loop cannot be set up; running cannot fail.
pub fn idle(robot: &RobotFile, options: &IdleOptions) -> Result<IdleMotion, IdleError> {
    let params = robot.params();
    let simulated = SimulationOptions {
        duration_s: Some(options.duration_s),
        hand_n: options.push_n,
        sensor_noise_n: options.sensor_noise_n,
        mu_spread_ratio: options.mu_spread_ratio,
        seed: options.seed,
        ..SimulationOptions::default()
    };
    simulated.check(params.cycle_s())?;
    let mut plant = Plant::new(robot, options, &simulated)?;
    let mut compensator = AnyCompensator::new(&params)?;
    let mut body = Admittance::new(&options.body, params.cycle_s(), &Pose::identity())?;
    let mut noise: Vec<ChaCha8Rng> =
        (0..params.cables().len()).map(|cable| random(options.seed, Purpose::Noise, cable)).collect();
    let mut set_point = body.step(None);
    let mut displacement_m = Vec::new();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of cycles")]
    let cycle_count = (options.duration_s / params.cycle_s()).round() as usize;
    let mut signals = Vec::new();
    while displacement_m.len() < cycle_count {
        let at = plant.follow(&set_point, options);
        displacement_m.push([at.displacement.x, at.displacement.y, at.displacement.z]);
        // Length and speed are set points, as in [P]; so is the pose.
        signals.clear();
        let of_cables = params.cables().iter().zip(&plant.chains).zip(&plant.moments).zip(&mut noise);
        signals.extend(of_cables.map(|(((cable, chain), moment), noise)| {
            let shake: f64 = StandardNormal.sample(noise);
            let sensor_n = moment.as_ref().map_or(0.0, |moment| chain.sensor_force_n(moment));
            let column = cable.structure_column(&set_point.pose).unwrap_or_default();
            CableInput {
                sensor_force_n: sensor_n + options.sensor_noise_n * shake,
                length_m: cable.length_m(&set_point.pose).unwrap_or(f64::NAN),
                speed_m_per_s: -column.dot(&set_point.rate),
            }
        }));
        compensator.set_input(&signals, Some(set_point.pose), 1.0);
        compensator.step();
        let wrench = if options.compensated {
            compensator.applied_wrench()
        } else {
            let sensed_n = compensator.outputs().iter().map(|cable| cable.frictionless_n);
            let gravity = Wrench::of_gravity(&params, &set_point.pose.orientation);
            compensator.outside_wrench_of(sensed_n).map(|outside| outside - gravity)
        };
        set_point = body.step(wrench.as_ref());
    }
    Ok(IdleMotion { displacement_m })
}

/// The plant: servo, platform, cables and pulleys.
struct Plant {
    cycle_s: f64,
    platform: Platform,
    cables: Vec<CableParams>,
    chains: Vec<BristleChain>,
    moments: Vec<Option<Moment>>,
    distribution: Distribution,
    mean_n: f64,
    forces_n: Vec<f64>,
    columns: Vec<Vector6<f64>>,
    servo: Admittance,
    last_rate: Vector6<f64>,
    cycle_count: u32,
}

impl Plant {
    fn new(robot: &RobotFile, options: &IdleOptions, simulated: &SimulationOptions) -> Result<Self, IdleError> {
        let params = robot.params();
        let platform = Platform::new(&params);
        let tables = &robot.options().cable;
        let mut columns = Vec::new();
        if platform.cable_count() < tables.len() || !platform.structure(&Pose::identity(), &mut columns) {
            return Err(IdleError::NoPlatform);
        }
        let level = TensionLevel::of_platform(&platform, tables);
        let chains =
            tables.iter().enumerate().map(|(cable, table)| chain(table, simulated, cable, TruthEffects::default()));
        // A unit mass on a spring of ω² with the critical damping 2ω.
        let (damping, stiffness) = (2.0 * options.servo_rad_per_s, options.servo_rad_per_s * options.servo_rad_per_s);
        let servo = AdmittanceOptions {
            mass_kg: [1.0; 3],
            damping_n_s_per_m: [damping; 3],
            stiffness_n_per_m: [stiffness; 3],
            reach_m: 1e4,
            inertia_kg_m2: [1.0; 3],
            damping_nm_s_per_rad: [damping; 3],
            stiffness_nm_per_rad: [stiffness; 3],
            reach_rad: 3.0,
        };
        Ok(Self {
            cycle_s: params.cycle_s(),
            distribution: Distribution::new(platform.arm_m(), level.least_n),
            mean_n: level.mean_n,
            forces_n: vec![0.0; tables.len()],
            moments: vec![None; tables.len()],
            cables: params.cables().to_vec(),
            chains: chains.collect(),
            columns,
            platform,
            servo: Admittance::new(&servo, params.cycle_s(), &Pose::identity())?,
            last_rate: Vector6::zeros(),
            cycle_count: 0,
        })
    }

    /// Follows a set point for one cycle and returns the state of the platform.
    fn follow(&mut self, set_point: &SetPoint, options: &IdleOptions) -> SetPoint {
        let pull = set_point.displacement * (options.servo_rad_per_s * options.servo_rad_per_s);
        let force = Wrench { force_n: pull.fixed_rows::<3>(0).into(), torque_nm: pull.fixed_rows::<3>(3).into() };
        let at = self.servo.step(Some(&force));
        let time_s = f64::from(self.cycle_count) * self.cycle_s;
        self.cycle_count += 1;
        let acceleration = (at.rate - self.last_rate) / self.cycle_s;
        self.last_rate = at.rate;
        let linear = Vector3::new(acceleration.x, acceleration.y, acceleration.z);
        let mut wrench = self.platform.outside_wrench(&at.pose.orientation, &linear);
        if time_s < 0.5 {
            let push_n = options.push_n / f64::sqrt(3.0);
            wrench += Vector6::new(push_n, push_n, push_n, 0.0, 0.0, 0.0);
        }
        // If a cable has no way out at this pose, the last directions are kept.
        self.platform.structure(&at.pose, &mut self.columns);
        self.forces_n.fill(self.mean_n);
        self.distribution.solve(&self.columns, &wrench, &mut self.forces_n);
        let of_cables = self.cables.iter().zip(&mut self.chains).zip(&mut self.moments);
        for (((cable, chain), last), (column, force_n)) in of_cables.zip(self.columns.iter().zip(&self.forces_n)) {
            let moment = Moment {
                force_n: *force_n,
                length_m: cable.length_m(&at.pose).or(last.map(|last| last.length_m)).unwrap_or(0.0),
                speed_m_per_s: -column.dot(&at.rate),
                acceleration_m_per_s2: 0.0,
                force_n_per_s: 0.0,
                pose_cos: cable.pose_wrap_rad(&at.pose).map_or(1.0, libm::cos),
                time_s,
            };
            if let Some(last) = last {
                chain.advance(last, &moment, self.cycle_s, SUBSTEPS);
            }
            *last = Some(moment);
        }
        at
    }
}
