//! Replaces the parameters of a running compensator by those of another, for [`TunableCompensator`](crate::TunableCompensator).

use super::Compensator;
use crate::effects::time_delay::DelayLine;
use crate::effects::{Acting, Effect, Memory, UNKNOWN};
use crate::friction::places::NO_SLIP;
use crate::robot::{ParamError, ParamProblem};
use crate::signals::BEFORE_FIRST;

/// If the shares of the pulleys cancel to less than this fraction of their magnitudes, friction is not distributed by them.
const LEAST_OF_SIZE: f64 = 1e-3;

impl<const CABLES: usize> Compensator<CABLES> {
    /// Checks whether the parameters of another compensator can take over while this one runs.
    ///
    /// # Errors
    /// [`ParamError`] if the cycle time, the number of cables, their pulleys, or which of them have an attachment differ. That is another robot, and
    /// friction stored at a pulley of one has no place in the other.
    pub fn check_exchange(&self, next: &Self) -> Result<(), ParamError> {
        if self.cycle_s.to_bits() != next.cycle_s.to_bits() {
            let problem = ParamProblem::Fixed { value: next.cycle_s, running: self.cycle_s };
            return Err(ParamError { key: "cycle_s", pulley: None, effect: None, problem });
        }
        if self.cable_count != next.cable_count {
            let problem = ParamProblem::Count { count: next.cable_count, min: self.cable_count, max: self.cable_count };
            return Err(ParamError { key: "cable", pulley: None, effect: None, problem });
        }
        if !self.params.same_build(&next.params) {
            let reason =
                "and attachments have to be those of the robot that runs; friction, effects and geometry can change";
            return Err(ParamError::conflict("pulleys", reason));
        }
        Ok(())
    }

    /// Takes everything of `next` except its state; converts the own state to the new parameters.
    pub(crate) fn take_parameters(&mut self, next: &Self) {
        self.hand_over(next);
        self.assign_parameters(next);
    }

    /// Converts the state so that the parameters of `next` can start from it. State of an effect, form or limit that does not act before and after
    /// the change becomes unknown, as at the start. Friction stored in one form of presliding is converted to the other.
    fn hand_over(&mut self, next: &Self) {
        let goes_on =
            |effect: Effect| self.features.acting.has(effect.acts()) && next.features.acting.has(effect.acts());
        let delay = goes_on(Effect::TimeDelay);
        if !self.drifts() && next.drifts() {
            self.state.cycle = BEFORE_FIRST;
        }
        let columns = &mut self.state.columns;
        for effect in Effect::CATALOGUE.iter().filter(|effect| !goes_on(**effect)) {
            columns.memory.get_mut(effect.memory_places()).unwrap_or_default().as_flattened_mut().fill(UNKNOWN);
        }
        if !delay {
            columns.delayed_displacement_m.fill(DelayLine::EMPTY);
            // The speed is passed on undelayed until the delay line is filled.
            columns.delayed_speed_m_per_s.fill(DelayLine::UNFILLED);
        }
        let delays = self.params.delay.iter().zip(&next.params.delay);
        let lines = columns.lag_m.iter_mut().zip(&columns.delayed_displacement_m);
        for (cable, ((before, delay), (lag_m, line))) in delays.zip(lines).enumerate() {
            if before != delay {
                *lag_m = line.lag(*delay);
                // With another delay the speed jumps; that is no acceleration, so effects of motion start anew.
                let of_motion = |effect: &&Effect| matches!(effect.row().memory, Memory::OfMotion(_));
                for effect in Effect::CATALOGUE.iter().filter(of_motion) {
                    for column in columns.memory.get_mut(effect.memory_places()).unwrap_or_default() {
                        column.iter_mut().skip(cable).take(1).for_each(|memory| *memory = UNKNOWN);
                    }
                }
            }
        }
        for (ratio, traction_mu) in columns.pose_traction_ratio.iter_mut().zip(&next.params.traction_mu) {
            if *traction_mu <= 0.0 {
                *ratio = NO_SLIP;
            }
        }
        for cable in 0..self.cable_count {
            self.hand_friction_over(next, cable);
        }
    }

    /// Whether any effect depends on the time of the run.
    fn drifts(&self) -> bool {
        self.features.acting.has(Acting::going_by_time())
    }

    /// Converts the friction stored in a cable to the form of presliding of `next`, with the same force at the platform. From `per_pulley` to
    /// `lumped` it is the sum over the pulleys; from `lumped` to `per_pulley` it is distributed in proportion to the wrap factors.
    fn hand_friction_over(&mut self, next: &Self, cable: usize) {
        let is_lumped = |of: &Self| of.params.lumped.get(cable).is_some_and(|lumped| *lumped > 0.0);
        let (was_lumped, is_lumped) = (is_lumped(self), is_lumped(next));
        let columns = &mut self.state.columns;
        let by_pose = columns.pose_wrap_factor.get(cable).copied().unwrap_or(0.0);
        let share = |place| next.params.platform_share(cable, place);
        let wrap_factor = |place| next.params.wrap_factor_of(cable, place, next.place_count, by_pose);
        let Some(lumped_n) = columns.lumped_friction_n.get_mut(cable) else { return };
        let of_cable = columns.pulley_friction_n.iter_mut().filter_map(|column| column.get_mut(cable));
        match (was_lumped, is_lumped) {
            (false, true) => {
                *lumped_n =
                    of_cable.enumerate().map(|(place, stored_n)| share(place) * core::mem::take(stored_n)).sum();
            }
            (true, false) => {
                let (sum, size) = (0..next.place_count).fold((0.0, 0.0), |(sum, size), place| {
                    let part = share(place) * wrap_factor(place);
                    (sum + part, size + part.abs())
                });
                // If the sensor pulley nearly cancels the others, no distribution makes sense, and the stored friction is released.
                let unit_n = if sum.abs() > LEAST_OF_SIZE * size { *lumped_n / sum } else { 0.0 };
                *lumped_n = 0.0;
                of_cable.enumerate().for_each(|(place, stored_n)| *stored_n = unit_n * wrap_factor(place));
            }
            (true, true) => of_cable.for_each(|stored_n| *stored_n = 0.0),
            (false, false) => *lumped_n = 0.0,
        }
    }

    fn assign_parameters(&mut self, next: &Self) {
        // Named one by one, so that a new field cannot be forgotten; assigned one by one, so that none is copied over the stack.
        let Self {
            params,
            state: _,
            features,
            any_geometry,
            all_geometry,
            any_validated,
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
        self.any_validated = *any_validated;
        self.cable_count = *cable_count;
        self.place_count = *place_count;
        self.limits = *limits;
        self.cycle_s = *cycle_s;
        self.gravity_n = *gravity_n;
        self.center_of_mass_m = *center_of_mass_m;
    }

    /// Takes parameters and state of `other`.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.assign_parameters(other);
        self.state = other.state;
    }
}
