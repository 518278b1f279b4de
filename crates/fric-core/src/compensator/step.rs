//! One cycle of a [`Compensator`]: signals, friction, status and wrench of all cables, block by block.

use super::Compensator;
use crate::cable::Moment;
use crate::cable_cycle::cable_cycle;
use crate::compensator::columns::BlockOfCables;
use crate::compensator::cycle::{CableOutput, CycleInput, CycleOutput};
use crate::compensator::review::BEARS_OTHERWISE;
use crate::effects::time_delay::{self, Delay, DelayLine, Shifted};
use crate::numbers::lanes::{Block, CycleLanes, LANES, Lanes};
use crate::platform::Wrench;
use crate::scalar::{Mask, Scalar};
use crate::signals::status::CableStatus;
use crate::signals::{CableSignals, Conditioned, RawSignals, condition, next_cycle};

impl<const CABLES: usize> Compensator<CABLES> {
    /// Computes one cycle, for any input, without allocation and without panic.
    #[inline]
    pub fn step(&mut self, input: &CycleInput<CABLES>) -> CycleOutput<CABLES> {
        let mut output = CycleOutput::default();
        self.step_into(input, &mut output);
        output
    }

    /// Does the same as [`step`](Self::step), into an output of the caller.
    pub fn step_into(&mut self, input: &CycleInput<CABLES>, output: &mut CycleOutput<CABLES>) {
        let pose = input.pose.as_ref().filter(|pose| pose.is_usable());
        let rotation = pose.map(|pose| pose.orientation.to_rotation_matrix().into_inner());
        let mut forces_n = [0.0; CABLES];
        let mut wrench_status = CableStatus::OK;
        self.state.last_cycle = self.state.cycle;
        self.state.cycle = next_cycle(self.state.last_cycle, input.elapsed_cycles);
        let cables = CABLES.min(self.cable_count);
        let followed = pose.zip(rotation.as_ref()).filter(|_| self.any_geometry);
        // One bit per lane, in the entry of each block's first cable. The geometry of all blocks is computed first. It depends on the pose alone, so
        // the processor can work on several blocks at once; the friction of all blocks follows in the same way.
        let mut unreachable = [0; CABLES];
        if let Some((pose, rotation)) = followed {
            let mut first = 0;
            while let Some(unreachable) = unreachable.get_mut(first).filter(|_| first < cables) {
                (*unreachable, first) = if cables - first > LANES {
                    (self.follow_pose::<CycleLanes>(first, pose, rotation), first + CycleLanes::COUNT)
                } else {
                    (self.follow_pose::<Lanes>(first, pose, rotation), first + LANES)
                };
            }
        }
        let all_reviewed = self.state.doubtful || self.features.acting.has(BEARS_OTHERWISE);
        self.state.doubtful = false;
        let mut first = 0;
        while let Some(&unreachable) = unreachable.get(first).filter(|_| first < cables) {
            let has_pose = followed.is_some();
            let mut block = Stepped { first, has_pose, unreachable, all_reviewed, forces_n: &mut forces_n };
            let (status, count) = if cables - first > LANES {
                (self.step_cables::<CycleLanes>(&mut block, input, output), CycleLanes::COUNT)
            } else {
                (self.step_cables::<Lanes>(&mut block, input, output), LANES)
            };
            wrench_status = wrench_status | status;
            first += count;
        }
        for place in output.cables.iter_mut().skip(self.cable_count) {
            *place = CableOutput::default();
        }
        if pose.is_some() && !self.state.directions_known {
            let known = self.state.columns.direction_known.iter().take(self.cable_count).all(|&known| known > 0.0);
            self.state.directions_known = self.all_geometry && known;
        }
        if let Some(rotation) = rotation.filter(|_| self.state.directions_known) {
            let torque_nm = (rotation * self.center_of_mass_m).cross(&self.gravity_n);
            self.state.gravity = Some(Wrench { force_n: self.gravity_n, torque_nm });
        }
        let columns = &self.state.columns;
        let along = |row: &[f64; CABLES]| {
            // In the same order whatever the number of lanes in the cycle.
            let blocks = 0..CABLES.div_ceil(LANES).min(self.cable_count.div_ceil(LANES));
            let products = blocks.map(|block| Lanes::load(row, block) * Lanes::load(&forces_n, block));
            -products.fold(Lanes::splat(0.0), |sum, product| sum + product).sum()
        };
        // Both at once; computed one after the other, the first is copied twice.
        let wrenches = self.state.gravity.as_ref().map(|gravity| {
            let outside = Wrench {
                force_n: columns.direction.each_ref().map(along).into(),
                torque_nm: columns.moment_arm_m.each_ref().map(along).into(),
            };
            (outside, outside - *gravity)
        });
        (output.outside_wrench, output.applied_wrench) = wrenches.unzip();
        output.wrench_status = wrench_status;
    }

    /// Computes signals, friction and status of a block's cables. Returns all flags of any of them.
    fn step_cables<T: Block>(
        &mut self,
        block: &mut Stepped<'_, CABLES>,
        input: &CycleInput<CABLES>,
        output: &mut CycleOutput<CABLES>,
    ) -> CableStatus {
        if self.features.has_effects() {
            self.step_block::<T, true>(block, input, output)
        } else {
            self.step_block::<T, false>(block, input, output)
        }
    }

    /// Does [`step_cables`](Self::step_cables). With and without effects it is a separate function, so that the cycle without effects does not become
    /// slower.
    #[inline(never)]
    fn step_block<T: Block, const EFFECTS: bool>(
        &mut self,
        stepped: &mut Stepped<'_, CABLES>,
        input: &CycleInput<CABLES>,
        output: &mut CycleOutput<CABLES>,
    ) -> CableStatus {
        let block = stepped.first / T::COUNT;
        // Says once what each access to a column would have to ask.
        if block >= CABLES.div_ceil(T::COUNT) {
            return CableStatus::OK;
        }
        let first = block * T::COUNT;
        let missing = if stepped.has_pose { 0 } else { T::bits(self.misses_pose::<T>(block)) };
        let raw: RawSignals<T> = input.signals_of_block(first);
        // A sensor force that is not a number is not calm either.
        let before_n = T::load(&self.state.columns.sensor_force_n, block);
        let calm = (raw.sensor_force_n - before_n).abs().le(T::load(&self.params.calm_change_n, block));
        let reviewed = (stepped.all_reviewed || T::bits(calm) != (1 << T::COUNT) - 1)
            .then(|| self.review_sensor::<T>(block, input));
        let mut remembered = self.state.columns.signals::<T>(block);
        let conditioned = condition(&self.limits, &mut remembered, &raw, input.elapsed_cycles);
        let columns = &mut self.state.columns;
        columns.set_signals(block, &remembered);
        let mut signals = conditioned.signals();
        let moment = Moment::new(T::splat(self.state.cycle), T::splat(self.state.last_cycle), self.cycle_s);
        if self.features.acting.has(time_delay::ACTS) {
            let moves = T::bits(signals.moves);
            let in_order = if input.elapsed_cycles > 1.0 { 0 } else { moves };
            let delay = self.params.delay.get(first..).unwrap_or_default();
            let known = [signals.displacement_m, signals.speed_m_per_s];
            let by_lines = [
                shift_block(&mut columns.delayed_displacement_m, first, known[0], in_order, delay),
                shift_block(&mut columns.delayed_speed_m_per_s, first, known[1], in_order, delay),
            ];
            let lead = lead_block(&columns.delayed_displacement_m, first, delay);
            let shifted = Shifted::new(known, by_lines, T::load(&columns.lag_m, block), lead);
            shifted.lag_m.store(&mut columns.lag_m, block);
            shifted.enter(&mut signals);
        }
        let model = self.params.model::<T>(block);
        let mut cable = BlockOfCables::new(&self.params, columns, block, self.place_count);
        let forces = cable_cycle(&model, self.features.limited_to::<EFFECTS>(), &signals, &moment, &mut cable);

        let Conditioned { sensor_force_n, speed_m_per_s, sensor_finite, frozen, jump, motion_finite, .. } = conditioned;
        let CableSignals { hold, sensor_fault, .. } = signals;
        let out_of_range = if self.any_validated {
            let [least_n, greatest_n] =
                [&self.params.least_force_n, &self.params.greatest_force_n].map(|column| T::load(column, block));
            let greatest_m_per_s = T::load(&self.params.greatest_speed_m_per_s, block);
            let beyond = sensor_force_n.lt(least_n).or(greatest_n.lt(sensor_force_n));
            beyond.or(greatest_m_per_s.lt(speed_m_per_s.abs()))
        } else {
            T::Mask::NONE
        };
        let [bears_ratio, bears_per_wrap, bears_n] =
            [&self.params.bears_ratio, &self.params.bears_per_wrap, &self.params.bears_n]
                .map(|column| T::load(column, block));
        let wrap_factor = T::load(&self.state.columns.pose_wrap_factor, block);
        let settled_n = (bears_per_wrap * wrap_factor + bears_ratio) * forces.tension_n + bears_n;
        let [sensor_jump, unsettled] = if reviewed.is_some() || T::bits(settled_n.lt(forces.stored_n)) != 0 {
            let numbers = [forces.way_m, forces.tension_n, forces.stored_n, forces.platform_force_n];
            self.review_friction(stepped.first, input, reviewed.unwrap_or(0), numbers)
        } else {
            [0; 2]
        };
        let any_flag = T::bits(hold.or(forces.slack).or(forces.slip).or(out_of_range))
            | missing
            | stepped.unreachable
            | sensor_jump
            | unsettled;
        let flags = || {
            [
                (CableStatus::SLACK, T::bits(forces.slack.and(sensor_fault.not()))),
                (CableStatus::SLIP, T::bits(forces.slip)),
                (CableStatus::SENSOR_NOT_FINITE, T::bits(sensor_finite.not())),
                (CableStatus::SENSOR_FROZEN, T::bits(frozen)),
                (CableStatus::LENGTH_JUMP, T::bits(jump)),
                (CableStatus::MOTION_NOT_FINITE, T::bits(motion_finite.not())),
                (CableStatus::OUT_OF_RANGE, T::bits(out_of_range)),
                (CableStatus::POSE_MISSING, missing),
                (CableStatus::POSE_UNREACHABLE, stepped.unreachable),
                (CableStatus::SENSOR_JUMP, sensor_jump),
                (CableStatus::UNSETTLED, unsettled),
            ]
        };
        let present = self.cable_count.saturating_sub(first).min(T::COUNT);
        let mut of_all = CableStatus::OK;
        let places = output.cables.get_mut(first..).unwrap_or_default();
        for (lane, place) in places.iter_mut().enumerate().take(present) {
            *place = CableOutput {
                force_at_platform_n: forces.platform_force_n.lane(lane),
                friction_n: forces.friction_n.lane(lane),
                frictionless_n: forces.frictionless_n.lane(lane),
                status: CableStatus::OK,
            };
        }
        if any_flag != 0 {
            let flags = flags();
            for (lane, place) in places.iter_mut().enumerate().take(present) {
                for (flag, bits) in flags {
                    place.status = place.status | flag.if_set(bits, lane);
                }
                of_all = of_all | place.status;
            }
        }
        forces.platform_force_n.store(stepped.forces_n, block);
        of_all
    }
}

/// A block of cables in a cycle.
struct Stepped<'a, const CABLES: usize> {
    /// Its first cable, a multiple of the lanes.
    first: usize,
    /// Whether the stored friction is reviewed even without suspicion.
    all_reviewed: bool,
    /// Whether there is a usable pose.
    has_pose: bool,
    /// Lanes whose attachment is out of reach at the pose.
    unreachable: u32,
    /// Output: forces at the platform, N.
    forces_n: &'a mut [f64; CABLES],
}

/// Returns which cables of a block have a lead, and the displacement that it extrapolates, m.
fn lead_block<T: Block, const CABLES: usize>(
    lines: &[DelayLine; CABLES],
    first: usize,
    delays: &[Delay],
) -> (T::Mask, T) {
    if !delays.iter().take(T::COUNT).any(|delay| delay.leads()) {
        return (T::Mask::NONE, T::splat(0.0));
    }
    let leads = T::from_lanes(|lane| f64::from(delays.get(lane).is_some_and(|delay| delay.leads())));
    let lead_m =
        |lane: usize| lines.get(first + lane).zip(delays.get(lane)).map_or(0.0, |(line, delay)| line.lead(*delay));
    (T::splat(0.0).lt(leads), T::from_lanes(lead_m))
}

/// Advances a block's delay lines by one cycle.
fn shift_block<T: Block, const CABLES: usize>(
    lines: &mut [DelayLine; CABLES],
    first: usize,
    values: T,
    in_order: u32,
    delays: &[Delay],
) -> T {
    let mut of_lanes = lines.iter_mut().skip(first).zip(delays);
    T::from_lanes(|lane| {
        let value = values.lane(lane);
        let shifted = |(line, delay): (&mut DelayLine, &Delay)| line.shift(value, in_order >> lane & 1 == 1, *delay);
        of_lanes.next().map_or(value, shifted)
    })
}
