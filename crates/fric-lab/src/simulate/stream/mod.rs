//! The simulated robot as a stream of cycles.

mod cable;
mod encoder;
mod random;
mod wander;

use core::ops::Range;

use fric_core::robot::file::{CableTable, RobotFile};
use fric_core::{CableInput, KnownReference, Sample};
use nalgebra::{Vector3, Vector6};
use rand_distr::{Distribution as _, StandardNormal};

use self::cable::SimulatedCable;
use crate::excite::Excitation;
use crate::simulate::error::SimulationError;
use crate::simulate::mechanics::distribution::Distribution;
use crate::simulate::mechanics::motion::{CableMotion, Motion};
use crate::simulate::mechanics::platform::{Platform, balanced_wrench};
use crate::simulate::mechanics::tension::{TensionLevel, Variation};
use crate::simulate::mechanics::workspace::{SHORT_SHARE, Workspace};
use crate::simulate::options::{Run, SimulationOptions};
use crate::trajectory::{Limits, SetPoint, Trajectory};

pub use cable::chain;
pub use random::{Purpose, random};

/// Stamp of the first cycle: 28 May 2026, 20:26:40 UTC. It is the same in every run, so that equal seeds give equal logs.
pub const START_NANOS: i64 = 1_780_000_000_000_000_000;

/// Number of positions of a run at which the pulleys' contributions to the friction are averaged.
const MU_PLACES: u32 = 1000;

/// A running simulation; its memory does not depend on the duration.
#[derive(Debug)]
pub struct Simulation {
    cycle_s: f64,
    total_cycles: u64,
    done_cycles: u64,
    motion: Motion,
    /// The run, if it states the loads.
    stated: Option<Excitation>,
    platform: Platform,
    tension: Tension,
    /// The variation of each cable's own tension.
    variations: Vec<Variation>,
    /// The pushes of a hand: on the platform along each axis, or on each cable of a test bench.
    pushes: Vec<Variation>,
    hand_n: f64,
    /// Index of the first simulated cable; the forces are those of all cables.
    first_cable: usize,
    cables: Vec<SimulatedCable>,
    sensor_noise_n: f64,
    reference_noise_n: f64,
    columns: Vec<Vector6<f64>>,
    forces_n: Vec<f64>,
    inputs: Vec<CableInput>,
    references_n: Vec<f64>,
    is_among_anchors: bool,
    imbalance: Option<Imbalance>,
}

/// Cycles in which the cables could not hold the platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Imbalance {
    /// Number of cycles.
    pub cycle_count: u64,
    /// Greatest imbalance: the largest component of `A^T f + w`, with torques divided by the mean moment arm, N.
    pub missing_n: f64,
    /// Time of the greatest imbalance, s since the start.
    pub time_s: f64,
    /// Position of the platform's origin at that time, base frame, m.
    pub position_m: Vector3<f64>,
}

/// The source of the tensions.
#[derive(Debug)]
enum Tension {
    /// All cables hold the platform.
    Platform {
        level: TensionLevel,
        distribution: Box<Distribution>,
        common: Variation,
        /// Whether the prestress varies instead of staying at its mean.
        wanders: bool,
        balanced: bool,
    },
    /// Each cable has its own load.
    Bench { level: TensionLevel, load: Option<KnownReference> },
}

impl Simulation {
    /// Sets up the robot: finds a workspace, draws what the seed decides, and hides the effects.
    ///
    /// If all cables are attached to the platform, the robot moves it and its tensions hold it (see [`is_balanced`](Self::is_balanced)). Each cable
    /// without geometry runs the same movements alone, under a varying load or the load that the robot file knows. [`SimulationOptions::run`] selects
    /// the movement. A cable with `presliding = "lumped"` also has a bristle on each pulley, which is the physical model. `traction_mu` and
    /// `validated` of the file have no effect.
    ///
    /// # Errors
    /// Returns a [`SimulationError`] for an option out of range, an effect that cannot be simulated, a robot without a position where all its cables
    /// can run, a known load of cables that hold a platform, and a crossing run without a platform.
    pub fn new(robot: &RobotFile, options: &SimulationOptions) -> Result<Self, SimulationError> {
        Self::of(robot, options, 0..robot.options().cable.len(), None)
    }

    /// Sets up the log of a prepared run with its movements and, if it states them, its loads. [`SimulationOptions::run`] has no effect. The run
    /// repeats if `duration_s` is longer.
    ///
    /// # Errors
    /// Returns the errors of [`new`](Self::new).
    pub fn following(
        robot: &RobotFile,
        options: &SimulationOptions,
        run: &Excitation,
    ) -> Result<Self, SimulationError> {
        Self::of(robot, options, 0..robot.options().cable.len(), Some(run))
    }

    /// Sets up the log of some of the robot's cables. They pull as they do with all the others, but the others' friction is not computed.
    pub(super) fn of(
        robot: &RobotFile,
        options: &SimulationOptions,
        range: Range<usize>,
        stated: Option<&Excitation>,
    ) -> Result<Self, SimulationError> {
        let params = robot.params();
        let cycle_s = params.cycle_s();
        options.check(cycle_s)?;
        let tables = &robot.options().cable;
        let platform = Platform::new(&params);
        let level = TensionLevel::of_platform(&platform, tables);
        let workspace = (platform.cable_count() > 0).then(|| Workspace::find(&platform, &level)).transpose()?;
        let run = match options.run {
            Run::Identification => {
                workspace.as_ref().map(|workspace| Trajectory::identification(&workspace.work_box, &Limits::NONE))
            }
            Run::Crossing => {
                let loose = tables.iter().find(|table| table.base_m.is_none() || table.platform_m.is_none());
                if let Some(CableTable { name, .. }) = loose {
                    return Err(SimulationError::NoPlatform { cable: name.clone() });
                }
                workspace.as_ref().map(|workspace| workspace.crossing(&platform, &level))
            }
        };
        let motion = stated.map_or_else(
            || Motion::new(run, &Limits::of_load(params.known_reference().as_ref())),
            |stated| stated.motion().clone(),
        );
        let held = workspace.filter(|_| platform.cable_count() == tables.len());
        let tension = match held {
            Some(Workspace { balanced, .. }) => Tension::Platform {
                level,
                distribution: Box::new(Distribution::new(platform.arm_m(), level.least_n)),
                common: Variation::common(&mut random(options.seed, Purpose::Prestress, 0)),
                wanders: options.run == Run::Identification,
                balanced,
            },
            None => Tension::Bench {
                level: TensionLevel::of_bench(platform.weight_n(), tables),
                load: params.known_reference(),
            },
        };
        if held.is_some() && params.known_reference().is_some() {
            return Err(SimulationError::KnownLoad);
        }
        let variation = |cable| {
            let load = &mut random(options.seed, Purpose::Load, cable);
            if held.is_some() { Variation::own(load) } else { Variation::load(load) }
        };
        let push_count = if held.is_some() { 3 } else { tables.len() };
        let push = |place| Variation::pushes(&mut random(options.seed, Purpose::Hand, place));
        let cables = tables
            .iter()
            .zip(params.cables())
            .enumerate()
            .skip(range.start)
            .take(range.len())
            .map(|(cable, (table, params))| SimulatedCable::new(cable, table, params, options, cycle_s, &motion))
            .collect::<Result<Vec<_>, SimulationError>>()?;
        let duration_s = options.duration_s.unwrap_or_else(|| motion.trajectory().duration_s());
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked: 1 to 10¹³")]
        let total_cycles = libm::round(duration_s / cycle_s).max(1.0) as u64;
        Ok(Self {
            cycle_s,
            total_cycles,
            done_cycles: 0,
            stated: stated.filter(|stated| stated.states_loads()).cloned(),
            motion,
            platform,
            tension,
            variations: (0..tables.len()).map(variation).collect(),
            pushes: (0..push_count).map(push).collect(),
            hand_n: options.hand_n,
            first_cable: range.start,
            columns: Vec::with_capacity(tables.len()),
            forces_n: vec![0.0; tables.len()],
            inputs: vec![CableInput::default(); cables.len()],
            references_n: vec![0.0; cables.len()],
            is_among_anchors: workspace.is_some_and(|workspace| workspace.among_anchors),
            imbalance: None,
            cables,
            sensor_noise_n: options.sensor_noise_n,
            reference_noise_n: options.reference_noise_n,
        })
    }

    /// The same movements under tensions that wander, also where the run states the loads.
    pub(super) fn with_wandering_tensions(mut self) -> Self {
        self.stated = None;
        self
    }

    /// How many cycles there will be.
    #[must_use]
    pub fn total_cycles(&self) -> u64 {
        self.total_cycles
    }

    /// Returns the run that is repeated.
    #[must_use]
    pub fn trajectory(&self) -> &Trajectory {
        self.motion.trajectory()
    }

    /// Whether the cables alone hold the platform, so that the external wrench is gravity and inertia. If not (for instance with too few cables), the
    /// wrench is still `−A^T f`, and a guide bears the imbalance. False on a test bench.
    #[must_use]
    pub fn is_balanced(&self) -> bool {
        matches!(self.tension, Tension::Platform { balanced: true, .. })
    }

    /// Whether the platform has weight, hangs from base points at one height, and runs at that height or above. Its cables are then nearly
    /// horizontal, which no real robot would use.
    #[must_use]
    pub fn is_among_anchors(&self) -> bool {
        self.is_among_anchors
    }

    /// Returns the cycles so far in which the cables alone could not hold the platform; `None` if there were none, and on a test bench.
    #[must_use]
    pub fn imbalance(&self) -> Option<&Imbalance> {
        self.imbalance.as_ref()
    }

    /// Returns the equivalent μ of a cable: the mean over its pulleys and the run, weighted by their influence on the sensor.
    pub(super) fn mean_mu(&self, cable: usize) -> Option<f64> {
        let SimulatedCable { chain, winch, .. } = self.cables.get(cable)?;
        let step_s = self.motion.trajectory().duration_s() / f64::from(MU_PLACES);
        let at = |place| winch.pose_cos(self.motion.platform(f64::from(place) * step_s).as_ref());
        let sums = (0..MU_PLACES).map(|place| chain.sliding_per_tension(at(place)));
        let [with_mu, with_one] = sums.fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]]);
        Some(with_mu / with_one)
    }

    /// Returns the next cycle; `None` after the last. The following call overwrites the borrowed data.
    ///
    /// Lengths and speeds are without noise. Reference forces are the true ones with offset and noise, for every cable. The pose is present if a
    /// cable is attached to the platform, and the true wrench `−A^T f` if all are.
    ///
    /// ```
    /// use fric_core::robot::file::RobotFile;
    /// use fric_lab::simulate::{Simulation, SimulationOptions};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let text = r#"
    ///     format = "fric-robot/1"
    ///     name = "bench"
    ///     cycle_s = 0.001
    ///     [[cable]]
    ///     name = "winch"
    ///     pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]
    ///     friction = { mu = 0.02, sigma_n_per_m = 1000.0 }
    /// "#;
    /// let options = SimulationOptions { duration_s: Some(0.1), ..SimulationOptions::default() };
    /// let mut simulation = Simulation::new(&RobotFile::parse(text, "example")?, &options)?;
    /// assert_eq!(simulation.total_cycles(), 100);
    /// let mut cycles = 0;
    /// while let Some(cycle) = simulation.next_cycle() {
    ///     // At 180° the sensor feels the cable twice; the rest is friction and noise.
    ///     assert!((cycle.cables[0].sensor_force_n - 2.0 * cycle.reference_force_n[0]).abs() < 0.5);
    ///     cycles += 1;
    /// }
    /// assert_eq!(cycles, 100);
    /// # Ok(())
    /// # }
    /// ```
    pub fn next_cycle(&mut self) -> Option<Sample<'_>> {
        if self.done_cycles >= self.total_cycles {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "checked: at most 10¹³")]
        let time_s = self.done_cycles as f64 * self.cycle_s;
        self.done_cycles += 1;
        let platform = self.motion.platform(time_s);
        self.set_tensions(platform.as_ref(), time_s);
        let signals = self.inputs.iter_mut().zip(&mut self.references_n);
        let forces_n = self.forces_n.iter().skip(self.first_cable);
        for ((cable, force_n), (input, reference_n)) in self.cables.iter_mut().zip(forces_n).zip(signals) {
            let sensor_force_n = cable.advance(&self.motion, platform.as_ref(), time_s, *force_n, self.cycle_s);
            let mut noise = || -> f64 { StandardNormal.sample(&mut cable.noise) };
            let (sensor_noise, reference_noise) = (noise(), noise());
            let sensor_noise_n = self.sensor_noise_n * sensor_noise + cable.sensor_wander.advance();
            let CableMotion { length_m, speed_m_per_s } = cable.logged(&self.motion, time_s, self.cycle_s);
            *input = CableInput {
                sensor_force_n: cable.reading_n(sensor_force_n, sensor_noise_n, time_s, self.cycle_s),
                length_m,
                speed_m_per_s,
            };
            let reference_noise_n = self.reference_noise_n * reference_noise + cable.reference_wander.advance();
            *reference_n = force_n + cable.offset_n + reference_noise_n;
        }
        let is_whole = self.cables.len() == self.forces_n.len();
        let outside_wrench = (is_whole && matches!(self.tension, Tension::Platform { .. }))
            .then(|| balanced_wrench(&self.columns, self.forces_n.iter().copied()));
        #[expect(clippy::cast_possible_truncation, reason = "at most 100 days")]
        let since_start_nanos = libm::round(time_s * 1e9) as i64;
        Some(Sample {
            stamp_nanos: START_NANOS + since_start_nanos,
            cables: &self.inputs,
            reference_force_n: &self.references_n,
            pose: platform.as_ref().map(SetPoint::pose),
            outside_wrench,
        })
    }

    /// Computes the true cable forces at the platform at a time.
    fn set_tensions(&mut self, platform: Option<&SetPoint>, time_s: f64) {
        let (mean_n, common_share, wanders) = match &self.tension {
            Tension::Platform { level, wanders: false, .. } => (level.mean_n, 0.0, false),
            Tension::Platform { level, common, .. } => (level.mean_n, common.share(time_s), true),
            Tension::Bench { level, .. } => (level.mean_n, 0.0, true),
        };
        let stated_n = self.stated.as_ref().and_then(|stated| stated.stated_load_n(time_s));
        for (force_n, variation) in self.forces_n.iter_mut().zip(&self.variations) {
            let own_share = if wanders { variation.share(time_s) } else { 0.0 };
            *force_n = stated_n.unwrap_or(mean_n * (1.0 + common_share + own_share));
        }
        let pushed_n = |push: &Variation| if self.hand_n > 0.0 { self.hand_n * push.share(time_s) } else { 0.0 };
        if let Tension::Bench { level, load } = &self.tension {
            let forces_n = self.forces_n.iter_mut().skip(self.first_cable);
            for (force_n, cable) in forces_n.zip(&self.cables) {
                // The reference is known, and so is the offset between it and the force at the platform.
                let known_n = |load: KnownReference| {
                    load.force_n(cable.winch.acceleration_m_per_s2(&self.motion, time_s)) - cable.offset_n
                };
                *force_n = load.map_or(*force_n, known_n);
            }
            for (force_n, push) in self.forces_n.iter_mut().zip(&self.pushes).filter(|_| self.hand_n > 0.0) {
                *force_n = (*force_n + pushed_n(push)).max(level.least_n);
            }
        }
        if let (Tension::Platform { level, distribution, .. }, Some(set_point)) = (&mut self.tension, platform) {
            let pose = set_point.pose();
            self.platform.structure(&pose, &mut self.columns);
            let mut wrench = self.platform.wrench_at(set_point);
            for (axis_n, push) in wrench.iter_mut().zip(&self.pushes) {
                *axis_n += pushed_n(push);
            }
            let missing_n = distribution.solve(&self.columns, &wrench, &mut self.forces_n).residual_n;
            if missing_n > SHORT_SHARE * level.mean_n {
                let here = Imbalance { cycle_count: 0, missing_n, time_s, position_m: pose.position_m };
                let so_far = self.imbalance.unwrap_or(here);
                let worst = if missing_n > so_far.missing_n { here } else { so_far };
                self.imbalance = Some(Imbalance { cycle_count: so_far.cycle_count + 1, ..worst });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cable alone has the same tension, motion and readings as among all cables.
    #[test]
    fn one_cable_of_a_robot_is_that_of_the_whole() -> Result<(), Box<dyn core::error::Error>> {
        let robot = RobotFile::parse(include_str!("../../../../../examples/mini-ipanema.toml"), "example")?;
        let options = SimulationOptions {
            duration_s: Some(2.0),
            mu_spread_ratio: 0.1,
            hand_n: 2.0,
            sensor_wander_n: 0.01,
            disturbances: vec!["hum:amplitude_n=0.1".parse()?],
            ..SimulationOptions::default()
        };
        let mut whole = Simulation::new(&robot, &options)?;
        let mut one = Simulation::of(&robot, &options, 5..6, None)?;
        while let Some(all) = whole.next_cycle() {
            let alone = one.next_cycle().ok_or("too short")?;
            assert_eq!((alone.cables, alone.reference_force_n), (&all.cables[5..6], &all.reference_force_n[5..6]));
            assert_eq!((alone.stamp_nanos, alone.pose), (all.stamp_nanos, all.pose));
        }
        assert!(one.next_cycle().is_none());
        Ok(())
    }
}
