//! Replay: runs the samples of a log through the cycle of the control loop and compares the result with the reference.
//!
//! [`Replay::step`] runs one cycle and accumulates the errors before compensation (tension computed from the sensor force without friction) and after
//! it. It keeps only sums, so memory does not grow with the log. Samples without a reference do not enter the errors; flagged samples do, because the
//! control loop must use them too.
//!
//! The wrench is compared with the one in the log or, without it, with that of the platform's mass and pose in slow motion, as in `fit`.

mod error;
mod jumps;
mod warnings;

use std::collections::VecDeque;

use fric_core::{AnyCompensator, CableOutput, CableParams, CableStatus, ParamError, Pose, RobotParams, Sample, Wrench};
use serde::Serialize;

use crate::clock::Clock;
use crate::fit::readiness::Tension;
use crate::lateness::Lateness;
use crate::set_up::{SetUp, Signals};
use crate::weight::{self, Body};

pub use error::Deviation;
use jumps::Jumps;

/// The accumulated results of a cable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableErrors {
    /// Number of cycles with any flag of [`fric_core::CableStatus`].
    pub flagged_count: u64,
    /// Every flag that was raised, as bits.
    pub flags: u32,
    /// The sign of the sensor's forces.
    pub(crate) tension: Tension,
    /// Number of final cycles that lack only their pose, because a log ends between two poses.
    pub(crate) poseless_end_count: u64,
    /// The flags before these cycles.
    pub(crate) flags_before_end: u32,
    /// The forces beside the reference.
    pub(crate) set_up: SetUp,
    jumps: Jumps,
    /// Frictionless force minus reference, N.
    pub before_n: Deviation,
    /// Compensated force minus reference, N.
    pub after_n: Deviation,
}

impl CableErrors {
    fn new(cable: &CableParams, jumps: Jumps, is_stated: bool) -> Self {
        Self { set_up: SetUp::new(cable.frictionless_gain(), is_stated), jumps, ..Self::default() }
    }

    /// Whether the sensor has shown any force.
    #[must_use]
    pub fn is_measured(&self) -> bool {
        self.tension.is_known()
    }
}

/// The accumulated errors of the wrench.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WrenchErrors {
    force_squares: f64,
    torque_squares: f64,
    count: u64,
}

impl WrenchErrors {
    pub(crate) fn add(&mut self, deviation: &Wrench) {
        let (force, torque) = (deviation.force_n.norm_squared(), deviation.torque_nm.norm_squared());
        if force.is_finite() && torque.is_finite() {
            self.force_squares += force;
            self.torque_squares += torque;
            self.count += 1;
        }
    }

    /// Returns the root mean square of the force error's magnitude, N, and of the torque error's, N m; `None` if there are none.
    #[must_use]
    pub fn rms(&self) -> Option<(f64, f64)> {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = self.count as f64;
        (self.count > 0).then(|| ((self.force_squares / count).sqrt(), (self.torque_squares / count).sqrt()))
    }
}

/// The reference of the wrench.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WrenchReference {
    /// The wrench in the log.
    #[serde(rename = "wrench")]
    Measured,
    /// The wrench of the platform's mass and pose, in slow motion.
    Mass,
}

impl WrenchReference {
    /// Returns the name used in the machine-readable results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Measured => "wrench",
            Self::Mass => "mass",
        }
    }
}

/// A replay in progress.
#[derive(Debug)]
pub struct Replay {
    compensator: AnyCompensator,
    cables: Vec<CableErrors>,
    wrench_before: WrenchErrors,
    wrench_after: WrenchErrors,
    /// `None` without mass or geometry, and after the first measured wrench.
    by_mass: Option<ByMass>,
    signals: Signals,
    /// Of each cable's reference behind its compensated force.
    lateness: Vec<Lateness>,
    cycle_count: u64,
    cycle_s: f64,
    clock: Clock,
}

/// The comparison with the wrench of the platform's mass.
#[derive(Debug)]
struct ByMass {
    body: Body,
    motions: weight::Motions,
    /// Pose, and wrenches by frictionless and by compensated forces, of the cycles whose motion is still pending.
    waiting: VecDeque<Option<(Pose, Wrench, Wrench)>>,
    /// Whether any cycle had a pose and wrenches.
    has_wrench: bool,
    before: WrenchErrors,
    after: WrenchErrors,
}

impl ByMass {
    fn new(robot: &RobotParams<'_>) -> Option<Self> {
        let has_weight = robot.mass_kg() > 0.0 && robot.cables().iter().all(fric_core::CableParams::has_geometry);
        has_weight.then(|| Self {
            body: Body::of(robot),
            motions: weight::Motions::new(robot),
            waiting: VecDeque::new(),
            has_wrench: false,
            before: WrenchErrors::default(),
            after: WrenchErrors::default(),
        })
    }

    fn add(&mut self, stamp_nanos: i64, pose: Option<Pose>, wrenches: Option<(Wrench, Wrench)>) {
        let Self { body, motions, waiting, has_wrench, before, after } = self;
        let here = pose.zip(wrenches).map(|(pose, (before, after))| (pose, before, after));
        *has_wrench |= here.is_some();
        waiting.push_back(here);
        motions.push(stamp_nanos, pose, |motion| {
            let compared = waiting.pop_front().flatten().zip(motion);
            if let Some(((pose, frictionless, compensated), motion)) = compared {
                let reference = body.wrench(&pose.orientation, &motion);
                before.add(&(frictionless - reference));
                after.add(&(compensated - reference));
            }
        });
    }
}

/// With these flags there is no wrench: a cable's force or direction is unknown.
const NO_WRENCH: CableStatus =
    CableStatus::SENSOR_NOT_FINITE.union(CableStatus::POSE_MISSING).union(CableStatus::POSE_UNREACHABLE);

/// The output of one replayed cycle.
#[derive(Clone, Copy, Debug)]
pub struct ReplayedCycle<'a> {
    /// The cables in the robot's order.
    pub cables: &'a [CableOutput],
    /// External wrench by the compensated forces; `None` also while the pose or a cable's force is unknown.
    pub outside_wrench: Option<Wrench>,
    /// The same by the frictionless forces.
    pub frictionless_wrench: Option<Wrench>,
    /// Computing time of the compensator in this cycle, ns.
    pub cycle_ns: u64,
}

impl Replay {
    /// Creates a replay with a new compensator.
    ///
    /// # Errors
    /// Returns the errors of [`AnyCompensator::new`].
    pub fn new(robot: &RobotParams<'_>) -> Result<Self, ParamError> {
        let jumps = robot.sensor_jumps_n().map(|limit_n| Jumps::new(limit_n, robot.monitor().length_jump_m));
        let is_stated = robot.known_reference().is_some();
        let errors = |(cable, jumps)| CableErrors::new(cable, jumps, is_stated);
        Ok(Self {
            compensator: AnyCompensator::new(robot)?,
            cables: robot.cables().iter().zip(jumps).map(errors).collect(),
            wrench_before: WrenchErrors::default(),
            wrench_after: WrenchErrors::default(),
            by_mass: ByMass::new(robot),
            signals: Signals::new(robot),
            lateness: vec![Lateness::default(); robot.cables().len()],
            cycle_count: 0,
            cycle_s: robot.cycle_s(),
            clock: Clock::new(robot.cycle_s()),
        })
    }

    /// Runs one cycle.
    pub fn step(&mut self, sample: &Sample<'_>) -> ReplayedCycle<'_> {
        let elapsed_cycles = self.clock.elapsed_cycles(sample.stamp_nanos);
        self.compensator.set_input(sample.cables, sample.pose, elapsed_cycles);
        let start = std::time::Instant::now();
        let outside_wrench = self.compensator.step();
        let cycle_ns = u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.cycle_count += 1;
        self.signals.add(sample);
        let outside_wrench = outside_wrench.filter(|_| self.has_wrench());
        if sample.outside_wrench.is_some() {
            self.by_mass = None;
        }
        let frictionless_wrench = self.frictionless_wrench();
        let wrenches = frictionless_wrench.zip(outside_wrench);
        if let (Some(reference), Some((before, after))) = (&sample.outside_wrench, wrenches) {
            self.wrench_before.add(&(before - *reference));
            self.wrench_after.add(&(after - *reference));
        }
        if let Some(by_mass) = &mut self.by_mass {
            by_mass.add(sample.stamp_nanos, sample.pose.filter(Pose::is_usable), wrenches);
        }
        let outputs = self.compensator.outputs();
        let cables = self.cables.iter_mut().zip(&mut self.lateness).zip(sample.cables).zip(outputs);
        for ((((errors, lateness), input), output), reference_n) in cables.zip(sample.reference_force_n) {
            errors.tension.add(input.sensor_force_n);
            errors.jumps.add(input, elapsed_cycles);
            errors.flagged_count += u64::from(!output.status.is_ok());
            errors.flags |= output.status.bits();
            if output.status == CableStatus::POSE_MISSING {
                errors.poseless_end_count += 1;
            } else {
                errors.flags_before_end = errors.flags;
                errors.poseless_end_count = 0;
            }
            let forces_n = [output.frictionless_n, output.force_at_platform_n];
            if output.status.contains(CableStatus::LENGTH_JUMP) {
                errors.set_up.start();
            }
            errors.set_up.add(input.length_m, *reference_n, forces_n);
            lateness.add(sample.stamp_nanos, [output.force_at_platform_n, *reference_n]);
            errors.before_n.add(output.frictionless_n - reference_n);
            errors.after_n.add(output.force_at_platform_n - reference_n);
        }
        ReplayedCycle { cables: self.compensator.outputs(), outside_wrench, frictionless_wrench, cycle_ns }
    }

    /// Returns the external wrench of the last cycle by the frictionless forces; `None` as in [`ReplayedCycle::outside_wrench`].
    #[must_use]
    pub fn frictionless_wrench(&self) -> Option<Wrench> {
        let frictionless_n = self.compensator.outputs().iter().map(|cable| cable.frictionless_n);
        self.compensator.outside_wrench_of(frictionless_n).filter(|_| self.has_wrench())
    }

    fn has_wrench(&self) -> bool {
        !self.compensator.wrench_status().intersects(NO_WRENCH)
    }

    /// Returns the errors of the cables so far, in the robot's order.
    #[must_use]
    pub fn cables(&self) -> &[CableErrors] {
        &self.cables
    }

    /// Returns the errors of the wrench so far: before and after compensation.
    #[must_use]
    pub fn wrench(&self) -> (&WrenchErrors, &WrenchErrors) {
        match &self.by_mass {
            Some(ByMass { before, after, .. }) => (before, after),
            None => (&self.wrench_before, &self.wrench_after),
        }
    }

    /// Returns the reference of the wrench.
    #[must_use]
    pub fn wrench_reference(&self) -> WrenchReference {
        if self.by_mass.is_some() { WrenchReference::Mass } else { WrenchReference::Measured }
    }

    /// Returns the number of cycles so far.
    #[must_use]
    pub fn cycle_count(&self) -> u64 {
        self.cycle_count
    }
}
