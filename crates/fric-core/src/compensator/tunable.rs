//! Changes parameters while the cycle runs, without a step in the output.
//!
//! It serves a control loop that must not stop for a new identification. The new parameters start from the state of the old ones, and both run side
//! by side while the output blends from one to the other. These cycles take twice as long, the first of them up to six times. The module is
//! independent of threads: the caller, or `ParameterSender`, passes the parameters in. Non-finite input is treated as in [`Compensator`]. Size: two
//! compensators.

use crate::compensator::Compensator;
use crate::compensator::cycle::{CableOutput, CycleInput, CycleOutput};
use crate::platform::Wrench;
use crate::robot::ParamError;
use crate::signals::bounded_elapsed;

/// A [`Compensator`] whose parameters can be changed between two cycles.
///
/// In cycle k of the N of a change, each number of the output is `(1 − k/N)·old + (k/N)·new`, and a cable has the flags of both. From cycle N on, the
/// output has the bits of the new parameters. In no cycle does an output change by more than the larger of the changes of old and new plus 1/N of
/// their difference. Skipped cycles count: after `elapsed_cycles` of e, k grows by e, and an output may change by e/N of the difference.
///
/// The stored friction is taken over from the old parameters; what it lacks, the new parameters learn like any compensator, over a few presliding
/// distances f_c/σ of motion. If a cable changes from `per_pulley` to `lumped`, the stored friction is summed by its influence at the platform; in
/// the other direction it is distributed to the pulleys in proportion to their wrap factors `2 sin(α/2)`. Effects that the old parameters do not have
/// start as in the first cycle: a delay with the cable at rest at its position until the delay is over, inertia without acceleration. The time of drifts and
/// warm-ups starts with the first of them; a second one, also of another cable, goes by the same clock.
#[derive(Clone, Debug)]
pub struct TunableCompensator<const CABLES: usize> {
    running: Compensator<CABLES>,
    /// Keeps running during a change.
    leaving: Compensator<CABLES>,
    leaving_output: CycleOutput<CABLES>,
    total_cycles: f64,
    done_cycles: f64,
}

impl<const CABLES: usize> TunableCompensator<CABLES> {
    /// Starts with the parameters and the state of a compensator.
    #[must_use]
    pub fn new(compensator: Compensator<CABLES>) -> Self {
        let leaving = compensator.clone();
        Self {
            running: compensator,
            leaving,
            leaving_output: CycleOutput::default(),
            total_cycles: 0.0,
            done_cycles: 0.0,
        }
    }

    /// Returns the compensator with the parameters set last.
    #[must_use]
    pub fn compensator(&self) -> &Compensator<CABLES> {
        &self.running
    }

    /// Whether the output is still being blended from the old parameters to the new ones.
    #[must_use]
    pub fn is_changing(&self) -> bool {
        self.done_cycles < self.total_cycles
    }

    /// Takes over the parameters of `next`, not its state, during the next `blend_cycles` (at least 1). Allocation-free and panic-free, for use
    /// inside the loop, where it costs a copy of the parameters and of the state.
    ///
    /// # Errors
    /// Returns the errors of [`Compensator::check_exchange`], and an error as long as a change is not over ([`is_changing`](Self::is_changing)), because
    /// the output would jump; nothing is changed then.
    pub fn change(&mut self, next: &Compensator<CABLES>, blend_cycles: u32) -> Result<(), ParamError> {
        if self.is_changing() {
            return Err(ParamError::conflict("change", "comes before the last one is over; step until it is"));
        }
        self.running.check_exchange(next)?;
        self.leaving.copy_from(&self.running);
        self.running.take_parameters(next);
        self.total_cycles = f64::from(blend_cycles.max(1));
        self.done_cycles = 0.0;
        Ok(())
    }

    /// Runs one cycle, like [`Compensator::step_into`].
    pub fn step_into(&mut self, input: &CycleInput<CABLES>, output: &mut CycleOutput<CABLES>) {
        self.running.step_into(input, output);
        if self.is_changing() {
            self.done_cycles += bounded_elapsed(input.elapsed_cycles);
            if self.is_changing() {
                self.leaving.step_into(input, &mut self.leaving_output);
                let new_share = self.done_cycles / self.total_cycles;
                blend(output, &self.leaving_output, new_share);
            }
        }
    }

    /// Resets to the state after set-up; a change in progress ends with the new parameters.
    pub fn reset(&mut self) {
        self.running.reset();
        self.done_cycles = self.total_cycles;
    }

    /// Restores a snapshot like [`Compensator::restore`]; a change in progress ends with the new parameters.
    pub fn restore(&mut self, snapshot: &crate::compensator::Snapshot<CABLES>) {
        self.running.restore(snapshot);
        self.done_cycles = self.total_cycles;
    }
}

/// Blends `new_share` (0…1) of the new output with the rest of the old one.
fn blend<const CABLES: usize>(output: &mut CycleOutput<CABLES>, old: &CycleOutput<CABLES>, new_share: f64) {
    let mix = |new: f64, old: f64| (1.0 - new_share) * old + new_share * new;
    for (new, old) in output.cables.iter_mut().zip(&old.cables) {
        *new = CableOutput {
            force_at_platform_n: mix(new.force_at_platform_n, old.force_at_platform_n),
            friction_n: mix(new.friction_n, old.friction_n),
            frictionless_n: mix(new.frictionless_n, old.frictionless_n),
            status: new.status | old.status,
        };
    }
    let mix_wrench = |new: Option<Wrench>, old: Option<Wrench>| {
        new.zip(old).map(|(new, old)| Wrench {
            force_n: new.force_n.zip_map(&old.force_n, mix),
            torque_nm: new.torque_nm.zip_map(&old.torque_nm, mix),
        })
    };
    output.outside_wrench = mix_wrench(output.outside_wrench, old.outside_wrench);
    output.applied_wrench = mix_wrench(output.applied_wrench, old.applied_wrench);
    output.wrench_status = output.wrench_status | old.wrench_status;
}
