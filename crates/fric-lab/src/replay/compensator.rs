//! A compensator for a robot whose number of cables is known only at run time.

use fric_core::{
    CableInput, CableOutput, CableStatus, Compensator, CycleInput, CycleOutput, ParamError, Pose, RobotParams, Wrench,
};

/// [`Compensator`] for any number of cables up to [`AnyCompensator::MOST_CABLES`]: the smallest of a few sizes that
/// holds the robot. The size does not change a bit of the result.
#[derive(Debug)]
pub struct AnyCompensator(Box<dyn Cycle>);

impl AnyCompensator {
    /// The largest robot.
    pub const MOST_CABLES: usize = 64;

    /// Set-up from checked parameters.
    ///
    /// # Errors
    /// [`ParamError`] if the robot has more than [`MOST_CABLES`](Self::MOST_CABLES) cables.
    pub fn new(robot: &RobotParams<'_>) -> Result<Self, ParamError> {
        Ok(Self(match robot.cables().len() {
            0..=4 => Fixed::<4>::boxed(robot)?,
            5..=8 => Fixed::<8>::boxed(robot)?,
            9..=16 => Fixed::<16>::boxed(robot)?,
            _ => Fixed::<{ Self::MOST_CABLES }>::boxed(robot)?,
        }))
    }

    /// Takes in the signals of a cycle; cables that `cables` lacks count as not finite. `elapsed_cycles` is that of
    /// [`CycleInput`].
    pub fn set_input(&mut self, cables: &[CableInput], pose: Option<Pose>, elapsed_cycles: f64) {
        self.0.set_input(cables, pose, elapsed_cycles);
    }

    /// One cycle on the signals taken in last; gives the wrench from outside.
    pub fn step(&mut self) -> Option<Wrench> {
        self.0.step()
    }

    /// What is the matter with the wrench of the last cycle, see [`CycleOutput::wrench_status`].
    #[must_use]
    pub fn wrench_status(&self) -> CableStatus {
        self.0.wrench_status()
    }

    /// Outcome of the last cycle for the robot's cables.
    #[must_use]
    pub fn outputs(&self) -> &[CableOutput] {
        self.0.outputs()
    }

    /// The wrench from outside that balances given cable forces at the pose of the last cycle; `None` as
    /// [`CycleOutput::outside_wrench`].
    #[must_use]
    pub fn outside_wrench_of(&self, forces_n: impl Iterator<Item = f64>) -> Option<Wrench> {
        self.0.outside_wrench_of(&mut { forces_n })
    }
}

trait Cycle: Send + std::fmt::Debug {
    fn set_input(&mut self, cables: &[CableInput], pose: Option<Pose>, elapsed_cycles: f64);
    fn step(&mut self) -> Option<Wrench>;
    fn outputs(&self) -> &[CableOutput];
    fn wrench_status(&self) -> CableStatus;
    fn outside_wrench_of(&self, forces_n: &mut dyn Iterator<Item = f64>) -> Option<Wrench>;
}

#[derive(Debug)]
struct Fixed<const CABLES: usize> {
    compensator: Compensator<CABLES>,
    input: CycleInput<CABLES>,
    output: CycleOutput<CABLES>,
}

const NOTHING: CableInput = CableInput { sensor_force_n: f64::NAN, length_m: f64::NAN, speed_m_per_s: f64::NAN };

impl<const CABLES: usize> Fixed<CABLES> {
    fn boxed(robot: &RobotParams<'_>) -> Result<Box<dyn Cycle>, ParamError> {
        let compensator = Compensator::new(robot)?;
        Ok(Box::new(Self { compensator, input: CycleInput::default(), output: CycleOutput::default() }))
    }
}

impl<const CABLES: usize> Cycle for Fixed<CABLES> {
    fn set_input(&mut self, cables: &[CableInput], pose: Option<Pose>, elapsed_cycles: f64) {
        let signals = cables.iter().copied().chain(std::iter::repeat(NOTHING));
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

    fn outputs(&self) -> &[CableOutput] {
        self.output.cables.get(..self.compensator.cable_count()).unwrap_or_default()
    }

    fn outside_wrench_of(&self, forces_n: &mut dyn Iterator<Item = f64>) -> Option<Wrench> {
        let matrix = self.compensator.structure_matrix()?;
        let mut wrench = Wrench::default();
        for (column, force_n) in matrix.column_iter().zip(forces_n) {
            wrench.force_n -= column.fixed_rows::<3>(0) * force_n;
            wrench.torque_nm -= column.fixed_rows::<3>(3) * force_n;
        }
        Some(wrench)
    }
}
