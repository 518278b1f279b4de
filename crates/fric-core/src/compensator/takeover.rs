//! One compensator's parameters in the place of another's, for [`TunableCompensator`](crate::TunableCompensator).

use super::Compensator;
use crate::lanes::{LANES, LanesMask};
use crate::places::NO_SLIP;
use crate::robot::{ParamError, ParamProblem};

impl<const CABLES: usize> Compensator<CABLES> {
    /// Whether the parameters of another compensator can take over while this one runs.
    ///
    /// # Errors
    /// [`ParamError`] if cycle time, number of cables, their pulleys or whether they have an attachment differ: that is another
    /// robot, and what is stored at a pulley of one has no place in the other.
    pub fn check_exchange(&self, next: &Self) -> Result<(), ParamError> {
        if self.cycle_s.to_bits() != next.cycle_s.to_bits() {
            return Err(ParamError::conflict("cycle_s", "cannot change while running"));
        }
        if self.cable_count != next.cable_count {
            let problem = ParamProblem::Count { count: next.cable_count, min: self.cable_count, max: self.cable_count };
            return Err(ParamError { key: "cable", pulley: None, effect: None, problem });
        }
        let masks =
            |of: &Self, block| [of.params.follows_pose(block), of.params.with_geometry(block)].map(LanesMask::bits);
        let same_masks = (0..CABLES.div_ceil(LANES)).all(|block| masks(self, block) == masks(next, block));
        if !same_masks || self.params.pulley_place != next.params.pulley_place {
            let reason =
                "and attachments have to be those of the robot that runs; friction, effects and geometry can change";
            return Err(ParamError::conflict("pulleys", reason));
        }
        Ok(())
    }

    /// Everything of `next` but its state, which is made to go with them.
    pub(crate) fn take_parameters(&mut self, next: &Self) {
        self.hand_over(next);
        self.assign_parameters(next);
    }

    /// The state as the parameters of `next` can start from it.
    fn hand_over(&mut self, next: &Self) {
        let columns = &mut self.state.columns;
        for (ratio, traction_mu) in columns.pose_traction_ratio.iter_mut().zip(&next.params.traction_mu) {
            if *traction_mu <= 0.0 {
                *ratio = NO_SLIP;
            }
        }
    }

    fn assign_parameters(&mut self, next: &Self) {
        // Named one by one, so that none that is added can be forgotten; assigned one by one, so that none passes the stack.
        let Self {
            params,
            state: _,
            features,
            any_geometry,
            all_geometry,
            cable_count,
            place_count,
            limits,
            cycle_s,
            gravity_n,
            center_of_mass_m,
        } = next;
        self.params = *params;
        self.features = *features;
        self.any_geometry = *any_geometry;
        self.all_geometry = *all_geometry;
        self.cable_count = *cable_count;
        self.place_count = *place_count;
        self.limits = *limits;
        self.cycle_s = *cycle_s;
        self.gravity_n = *gravity_n;
        self.center_of_mass_m = *center_of_mass_m;
    }

    /// Parameters and state of `other`.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.assign_parameters(other);
        self.state = other.state;
    }
}
