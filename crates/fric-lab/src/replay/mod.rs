//! Replay: the samples of a log through the very cycle that runs in the control loop, compared with the reference.
//!
//! [`Replay::step`] runs one cycle and accumulates the errors before (sensor force turned into tension as if nothing
//! rubbed) and after (compensated). It keeps sums only: memory does not grow with the log. Samples without a reference
//! count for nothing in the errors; flagged ones count as all others, since the control loop has to live with them.
//!
//! The wrench is compared with the one in the log; where the log has none, with that of the platform's mass and pose in quiet
//! motion, as `fit` does.

mod error;
mod warnings;

use std::collections::VecDeque;

use fric_core::{AnyCompensator, CableOutput, CableStatus, ParamError, Pose, RobotParams, Sample, Wrench};

use crate::clock::Clock;
use crate::weight::Weight;

pub use error::Deviation;

/// What has been accumulated for a cable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableErrors {
    /// Cycles with any flag of [`fric_core::CableStatus`].
    pub flagged_count: u64,
    /// Each flag that has been raised, as bits.
    pub flags: u32,
    /// How many of the last cycles miss their pose and nothing else: a log ends between two poses.
    pub(crate) poseless_end_count: u64,
    /// The flags before these.
    pub(crate) flags_before_end: u32,
    /// Frictionless force less reference, N.
    pub before_n: Deviation,
    /// Compensated force less reference, N.
    pub after_n: Deviation,
}

/// What has been accumulated for the wrench.
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

    /// Root mean square of the force deviation's length, N, and of the torque's, N m; `None` without any.
    #[must_use]
    pub fn rms(&self) -> Option<(f64, f64)> {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = self.count as f64;
        (self.count > 0).then(|| ((self.force_squares / count).sqrt(), (self.torque_squares / count).sqrt()))
    }
}

/// What the wrench is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrenchReference {
    /// The wrench in the log.
    Measured,
    /// That of the platform's mass and pose, in quiet motion.
    Mass,
}

impl WrenchReference {
    /// In a word, as in the results for machines.
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
    /// `None` without mass or geometry, and from the first measured wrench on.
    by_mass: Option<ByMass>,
    cycle_count: u64,
    cycle_s: f64,
    clock: Clock,
}

/// The comparison with the wrench of the platform's mass.
#[derive(Debug)]
struct ByMass {
    weight: Weight,
    /// Wrenches by frictionless and by compensated forces, of the cycles that wait for theirs.
    waiting: VecDeque<Option<(Wrench, Wrench)>>,
    before: WrenchErrors,
    after: WrenchErrors,
}

impl ByMass {
    fn new(robot: &RobotParams<'_>) -> Option<Self> {
        let has_weight = robot.mass_kg() > 0.0 && robot.cables().iter().all(fric_core::CableParams::has_geometry);
        has_weight.then(|| {
            let weight = Weight::new(robot);
            let waiting = vec![None; weight.delay()].into();
            Self { weight, waiting, before: WrenchErrors::default(), after: WrenchErrors::default() }
        })
    }

    fn add(&mut self, pose: Option<Pose>, wrenches: Option<(Wrench, Wrench)>) {
        self.waiting.push_back(wrenches);
        let compared = self.waiting.pop_front().flatten();
        if let (Some(reference), Some((before, after))) = (self.weight.push(pose), compared) {
            self.before.add(&(before - reference));
            self.after.add(&(after - reference));
        }
    }
}

/// With these a wrench is none: a cable's force or direction is not known.
const NO_WRENCH: CableStatus =
    CableStatus::SENSOR_NOT_FINITE.union(CableStatus::POSE_MISSING).union(CableStatus::POSE_UNREACHABLE);

/// Outcome of one cycle of a replay.
#[derive(Clone, Copy, Debug)]
pub struct ReplayedCycle<'a> {
    /// The cables in the robot's order.
    pub cables: &'a [CableOutput],
    /// Wrench from outside by the compensated forces; `None` also while the pose or a cable's force is not known.
    pub outside_wrench: Option<Wrench>,
    /// The same as if nothing rubbed.
    pub frictionless_wrench: Option<Wrench>,
    /// How long the cycle took, the compensator alone, ns.
    pub cycle_ns: u64,
}

impl Replay {
    /// A replay with a fresh compensator.
    ///
    /// # Errors
    /// As [`AnyCompensator::new`].
    pub fn new(robot: &RobotParams<'_>) -> Result<Self, ParamError> {
        Ok(Self {
            compensator: AnyCompensator::new(robot)?,
            cables: vec![CableErrors::default(); robot.cables().len()],
            wrench_before: WrenchErrors::default(),
            wrench_after: WrenchErrors::default(),
            by_mass: ByMass::new(robot),
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
            by_mass.add(sample.pose.filter(Pose::is_usable), wrenches);
        }
        let outputs = self.compensator.outputs();
        for ((errors, output), reference_n) in self.cables.iter_mut().zip(outputs).zip(sample.reference_force_n) {
            errors.flagged_count += u64::from(!output.status.is_ok());
            errors.flags |= output.status.bits();
            if output.status == CableStatus::POSE_MISSING {
                errors.poseless_end_count += 1;
            } else {
                errors.flags_before_end = errors.flags;
                errors.poseless_end_count = 0;
            }
            errors.before_n.add(output.frictionless_n - reference_n);
            errors.after_n.add(output.force_at_platform_n - reference_n);
        }
        ReplayedCycle { cables: self.compensator.outputs(), outside_wrench, frictionless_wrench, cycle_ns }
    }

    /// Wrench from outside in the last cycle as if nothing rubbed; `None` as [`ReplayedCycle::outside_wrench`].
    #[must_use]
    pub fn frictionless_wrench(&self) -> Option<Wrench> {
        let frictionless_n = self.compensator.outputs().iter().map(|cable| cable.frictionless_n);
        self.compensator.outside_wrench_of(frictionless_n).filter(|_| self.has_wrench())
    }

    fn has_wrench(&self) -> bool {
        !self.compensator.wrench_status().intersects(NO_WRENCH)
    }

    /// Errors of the cables so far, in the robot's order.
    #[must_use]
    pub fn cables(&self) -> &[CableErrors] {
        &self.cables
    }

    /// Errors of the wrench so far: before, after.
    #[must_use]
    pub fn wrench(&self) -> (&WrenchErrors, &WrenchErrors) {
        match &self.by_mass {
            Some(ByMass { before, after, .. }) => (before, after),
            None => (&self.wrench_before, &self.wrench_after),
        }
    }

    /// What the wrench is compared with.
    #[must_use]
    pub fn wrench_reference(&self) -> WrenchReference {
        if self.by_mass.is_some() { WrenchReference::Mass } else { WrenchReference::Measured }
    }

    /// Cycles run so far.
    #[must_use]
    pub fn cycle_count(&self) -> u64 {
        self.cycle_count
    }
}
