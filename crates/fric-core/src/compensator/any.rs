//! A compensator for a robot whose number of cables is known only at run time.
//!
//! For programs that read a robot file at run time. Set-up allocates once; the cycle does not. Non-finite input and state behave as in
//! [`Compensator`]. Needs the feature `alloc`.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use core::any::Any;
use core::fmt;
use core::iter::repeat;

use crate::compensator::cycle::{CableInput, CableOutput, CycleInput, CycleOutput};
use crate::compensator::tunable::TunableCompensator;
use crate::compensator::{Compensator, Snapshot};
use crate::platform::{Pose, Wrench};
use crate::robot::{MAX_PULLEYS, MOST_CABLES, ParamError, RobotParams};
use crate::signals::status::CableStatus;
use crate::words::Words as _;

/// A [`Compensator`] for any number of cables up to [`AnyCompensator::MOST_CABLES`]: it uses the smallest of a few sizes that holds the robot. The
/// size does not change a bit of the result.
#[derive(Debug)]
pub struct AnyCompensator(Box<dyn Cycle>);

/// The state of an [`AnyCompensator`] at one time, for [`AnyCompensator::restore`].
#[derive(Debug)]
pub struct AnySnapshot {
    /// [`Cycle::structure_word`] of each cable.
    structure: Vec<u64>,
    state: Box<dyn Any + Send + Sync>,
}

/// The error for a snapshot of a robot with other cables, or words that are not all of the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SnapshotMismatch {
    /// Number of cables of the robot.
    pub expected: usize,
    /// Number of cables in the snapshot.
    pub found: usize,
    /// Index of the first cable with other pulleys, another attachment, another form of presliding or other effects that remember something; `None` if
    /// something else is wrong.
    pub cable: Option<usize>,
}

impl fmt::Display for SnapshotMismatch {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { expected, found, cable } = self;
        match cable {
            Some(cable) => write!(
                formatter,
                "the snapshot is of another robot: pulleys, attachment, presliding or effects with memory of cable {} differ; restore it with the robot \
                 file that it was made with, or reset",
                cable + 1
            ),
            None if found == expected => {
                formatter.write_str("the snapshot is incomplete, or of another version of the library")
            }
            None => write!(formatter, "the snapshot is of a robot with {found} cables, this one has {expected}"),
        }
    }
}

impl core::error::Error for SnapshotMismatch {}

impl AnyCompensator {
    /// Maximum number of cables.
    pub const MOST_CABLES: usize = MOST_CABLES;

    /// Creates a compensator from checked parameters.
    ///
    /// # Errors
    /// Returns a [`ParamError`] if the robot has more than [`MOST_CABLES`](Self::MOST_CABLES) cables.
    pub fn new(robot: &RobotParams<'_>) -> Result<Self, ParamError> {
        Ok(Self(match robot.cables().len() {
            0..=4 => Fixed::<4>::boxed(robot)?,
            5..=8 => Fixed::<8>::boxed(robot)?,
            9..=16 => Fixed::<16>::boxed(robot)?,
            _ => Fixed::<{ Self::MOST_CABLES }>::boxed(robot)?,
        }))
    }

    /// Returns the number of cables of the robot.
    #[must_use]
    pub fn cable_count(&self) -> usize {
        self.0.outputs().len()
    }

    /// Resets to the state after set-up; see [`Compensator::reset`].
    pub fn reset(&mut self) {
        self.0.reset();
    }

    /// Returns a copy of the full state, including the last output.
    #[must_use]
    pub fn snapshot(&self) -> AnySnapshot {
        AnySnapshot { structure: self.structure().collect(), state: self.0.snapshot() }
    }

    /// Restores the state of a snapshot; the following cycles have the same bits as after the snapshot.
    ///
    /// # Errors
    /// Returns a [`SnapshotMismatch`] if the snapshot belongs to a robot with other cables: another number of them, other pulleys or attachments,
    /// another form of presliding, other effects that remember something. Nothing is changed then.
    pub fn restore(&mut self, snapshot: &AnySnapshot) -> Result<(), SnapshotMismatch> {
        self.check_structure(&snapshot.structure)?;
        let count = self.cable_count();
        let is_restored = self.0.restore(snapshot.state.as_ref());
        if is_restored { Ok(()) } else { Err(SnapshotMismatch { expected: count, found: count, cable: None }) }
    }

    /// Returns what gives the state of each cable its meaning.
    fn structure(&self) -> impl Iterator<Item = u64> {
        (0..self.cable_count()).map(|cable| self.0.structure_word(cable))
    }

    /// Checks that a state belongs to this robot by what [`structure`](Self::structure) was when it was taken.
    fn check_structure(&self, of_state: &[u64]) -> Result<(), SnapshotMismatch> {
        let (expected, found) = (self.cable_count(), of_state.len());
        if expected != found {
            return Err(SnapshotMismatch { expected, found, cable: None });
        }
        match self.structure().zip(of_state).position(|(ours, theirs)| ours != *theirs) {
            None => Ok(()),
            cable => Err(SnapshotMismatch { expected, found, cable }),
        }
    }

    /// Returns the state as words: the full content of a snapshot, bit for bit, for another process. First come the number of cables and what the state
    /// depends on, so that the words of another robot are refused. They are valid only for this version of the crate.
    #[must_use]
    pub fn state_words(&self) -> Vec<u64> {
        let mut words = vec![self.cable_count() as u64];
        words.extend(self.structure());
        self.0.each_state_word(&mut |word| words.push(*word));
        words
    }

    /// Restores the state from the words of [`state_words`](Self::state_words) of the same robot.
    ///
    /// # Errors
    /// Returns a [`SnapshotMismatch`] if the words belong to another version, or to a robot with other cables, as in [`restore`](Self::restore). Nothing
    /// is changed then.
    pub fn restore_words(&mut self, words: &[u64]) -> Result<(), SnapshotMismatch> {
        let expected = self.cable_count();
        // What is no number of cables at all is no state of this version.
        let found = words.first().and_then(|count| usize::try_from(*count).ok()).filter(|count| *count <= MOST_CABLES);
        let found = found.unwrap_or(expected);
        let mut state_count = 0;
        self.0.each_state_word(&mut |_| state_count += 1);
        if found != expected || words.len() != 1 + expected + state_count {
            return Err(SnapshotMismatch { expected, found, cable: None });
        }
        let (structure, state) = words.split_at(1 + expected);
        self.check_structure(structure.split_at(1).1)?;
        let mut words = state.iter();
        self.0.restore_words(&mut |word| *word = words.next().copied().unwrap_or_default());
        Ok(())
    }

    /// Checks whether the parameters of `next` can take over; see [`Compensator::check_exchange`].
    ///
    /// # Errors
    /// Returns the [`ParamError`] of that function.
    pub fn check_exchange(&self, next: &Self) -> Result<(), ParamError> {
        self.0.check_exchange(next.0.as_any())
    }

    /// Blends over to the parameters of `next` during the next `blend_cycles`; see [`TunableCompensator::change`].
    ///
    /// # Errors
    /// Returns the [`ParamError`] of that function.
    pub fn change(&mut self, next: &Self, blend_cycles: u32) -> Result<(), ParamError> {
        self.0.change(next.0.as_any(), blend_cycles)
    }

    /// Whether the output is still being blended from old parameters to new ones.
    #[must_use]
    pub fn is_changing(&self) -> bool {
        self.0.is_changing()
    }

    /// Returns the friction stored at each pulley of a cable, N; see [`Compensator::pulley_friction_n`].
    #[must_use]
    pub fn pulley_friction_n(&self, cable: usize) -> [f64; MAX_PULLEYS] {
        self.0.pulley_friction_n(cable)
    }

    /// Sets the signals of a cycle. Cables missing in `cables` count as not finite. `elapsed_cycles` is as in [`CycleInput`].
    pub fn set_input(&mut self, cables: &[CableInput], pose: Option<Pose>, elapsed_cycles: f64) {
        self.0.set_input(cables, pose, elapsed_cycles);
    }

    /// Runs one cycle on the signals set last and returns the external wrench.
    pub fn step(&mut self) -> Option<Wrench> {
        self.0.step()
    }

    /// Returns the faults of the last cycle's wrench; see [`CycleOutput::wrench_status`].
    #[must_use]
    pub fn wrench_status(&self) -> CableStatus {
        self.0.wrench_status()
    }

    /// Returns the external wrench of the last cycle without gravity; see [`CycleOutput::applied_wrench`].
    #[must_use]
    pub fn applied_wrench(&self) -> Option<Wrench> {
        self.0.applied_wrench()
    }

    /// Returns the output of the last cycle for the robot's cables.
    #[must_use]
    pub fn outputs(&self) -> &[CableOutput] {
        self.0.outputs()
    }

    /// Returns the external wrench that balances given cable forces at the pose of the last cycle; `None` as for [`CycleOutput::outside_wrench`].
    #[must_use]
    pub fn outside_wrench_of(&self, forces_n: impl Iterator<Item = f64>) -> Option<Wrench> {
        self.0.outside_wrench_of(&mut { forces_n })
    }
}

trait Cycle: Send + Sync + fmt::Debug {
    fn reset(&mut self);
    fn snapshot(&self) -> Box<dyn Any + Send + Sync>;
    /// Returns what gives the state of a cable its meaning; see [`Compensator::structure_word`].
    fn structure_word(&self, cable: usize) -> u64;
    /// Visits the words of the state.
    fn each_state_word(&self, show: &mut dyn FnMut(&u64));
    /// Replaces the words of the state.
    fn restore_words(&mut self, replace: &mut dyn FnMut(&mut u64));
    /// Restores a snapshot. Returns whether it has this size.
    fn restore(&mut self, state: &(dyn Any + Send + Sync)) -> bool;
    fn as_any(&self) -> &dyn Any;
    fn check_exchange(&self, next: &dyn Any) -> Result<(), ParamError>;
    fn change(&mut self, next: &dyn Any, blend_cycles: u32) -> Result<(), ParamError>;
    fn is_changing(&self) -> bool;
    fn pulley_friction_n(&self, cable: usize) -> [f64; MAX_PULLEYS];
    fn set_input(&mut self, cables: &[CableInput], pose: Option<Pose>, elapsed_cycles: f64);
    fn step(&mut self) -> Option<Wrench>;
    fn outputs(&self) -> &[CableOutput];
    fn wrench_status(&self) -> CableStatus;
    fn applied_wrench(&self) -> Option<Wrench>;
    fn outside_wrench_of(&self, forces_n: &mut dyn Iterator<Item = f64>) -> Option<Wrench>;
}

#[derive(Debug)]
struct Fixed<const CABLES: usize> {
    compensator: TunableCompensator<CABLES>,
    input: CycleInput<CABLES>,
    output: CycleOutput<CABLES>,
}

const NOTHING: CableInput = CableInput { sensor_force_n: f64::NAN, length_m: f64::NAN, speed_m_per_s: f64::NAN };

impl<const CABLES: usize> Fixed<CABLES> {
    fn boxed(robot: &RobotParams<'_>) -> Result<Box<dyn Cycle>, ParamError> {
        Ok(Self::around(Self::set_up(robot)?))
    }

    /// Creates a compensator of one size. This and the next are functions of their own, so that a robot uses the stack of its own size only, and the
    /// sizes do not add up.
    #[inline(never)]
    fn set_up(robot: &RobotParams<'_>) -> Result<Box<Compensator<CABLES>>, ParamError> {
        Ok(Box::new(Compensator::new(robot)?))
    }

    #[inline(never)]
    #[expect(clippy::boxed_local, reason = "in the box it takes no stack of the caller's")]
    fn around(compensator: Box<Compensator<CABLES>>) -> Box<dyn Cycle> {
        let compensator = TunableCompensator::new(*compensator);
        Box::new(Self { compensator, input: CycleInput::default(), output: CycleOutput::default() })
    }
}

/// Returns the compensator in a [`Fixed`] of the same size; robots of different sizes differ in their number of cables.
fn of_size<const CABLES: usize>(next: &dyn Any) -> Result<&Compensator<CABLES>, ParamError> {
    let fixed = next.downcast_ref::<Fixed<CABLES>>().map(|fixed| fixed.compensator.compensator());
    fixed.ok_or(ParamError::conflict("cable", "differ in number from those of the robot that runs"))
}

impl<const CABLES: usize> Cycle for Fixed<CABLES> {
    fn reset(&mut self) {
        self.compensator.reset();
        self.output = CycleOutput::default();
    }

    fn snapshot(&self) -> Box<dyn Any + Send + Sync> {
        Box::new((self.compensator.compensator().snapshot(), self.output))
    }

    fn structure_word(&self, cable: usize) -> u64 {
        self.compensator.compensator().structure_word(cable)
    }

    fn each_state_word(&self, show: &mut dyn FnMut(&u64)) {
        let (mut snapshot, mut output) = (self.compensator.compensator().snapshot(), self.output);
        snapshot.each_word(&mut |word| show(word));
        output.each_word(&mut |word| show(word));
    }

    fn restore_words(&mut self, replace: &mut dyn FnMut(&mut u64)) {
        let mut snapshot = self.compensator.compensator().snapshot();
        snapshot.each_word(replace);
        self.compensator.restore(&snapshot);
        self.output.each_word(replace);
    }

    fn restore(&mut self, state: &(dyn Any + Send + Sync)) -> bool {
        let Some((snapshot, output)) = state.downcast_ref::<(Snapshot<CABLES>, CycleOutput<CABLES>)>() else {
            return false;
        };
        self.compensator.restore(snapshot);
        self.output = *output;
        true
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn check_exchange(&self, next: &dyn Any) -> Result<(), ParamError> {
        self.compensator.compensator().check_exchange(of_size(next)?)
    }

    fn change(&mut self, next: &dyn Any, blend_cycles: u32) -> Result<(), ParamError> {
        self.compensator.change(of_size(next)?, blend_cycles)
    }

    fn is_changing(&self) -> bool {
        self.compensator.is_changing()
    }

    fn pulley_friction_n(&self, cable: usize) -> [f64; MAX_PULLEYS] {
        self.compensator.compensator().pulley_friction_n(cable)
    }

    fn set_input(&mut self, cables: &[CableInput], pose: Option<Pose>, elapsed_cycles: f64) {
        let count = self.compensator.compensator().cable_count();
        // Entries beyond the robot's cables are at rest.
        let signals = cables.iter().copied().chain(repeat(NOTHING)).take(count).chain(repeat(CableInput::default()));
        for (place, signal) in self.input.cables.iter_mut().zip(signals) {
            *place = signal;
        }
        self.input.pose = pose;
        self.input.elapsed_cycles = elapsed_cycles;
    }

    fn step(&mut self) -> Option<Wrench> {
        self.compensator.step_into(&self.input, &mut self.output);
        self.output.outside_wrench
    }

    fn wrench_status(&self) -> CableStatus {
        self.output.wrench_status
    }

    fn applied_wrench(&self) -> Option<Wrench> {
        self.output.applied_wrench
    }

    fn outputs(&self) -> &[CableOutput] {
        self.output.cables.get(..self.compensator.compensator().cable_count()).unwrap_or_default()
    }

    fn outside_wrench_of(&self, forces_n: &mut dyn Iterator<Item = f64>) -> Option<Wrench> {
        let matrix = self.compensator.compensator().structure_matrix()?;
        let mut wrench = Wrench::default();
        for (column, force_n) in matrix.column_iter().zip(forces_n) {
            wrench.force_n -= column.fixed_rows::<3>(0) * force_n;
            wrench.torque_nm -= column.fixed_rows::<3>(3) * force_n;
        }
        Some(wrench)
    }
}
