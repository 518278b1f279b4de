//! Reviews sensors and stored friction of a block's cables that are doubtful; the rules are those of [`doubt`](crate::signals::doubt).

use super::Compensator;
use crate::cable::Cable;
use crate::compensator::columns::BlockOfCables;
use crate::compensator::cycle::CycleInput;
use crate::effects::Acting;
use crate::effects::direction_asymmetry::{self, DirectionAsymmetry};
use crate::effects::friction_drift::{self, FrictionDrift};
use crate::effects::load_nonlinearity::{self, LoadNonlinearity};
use crate::effects::presliding_shape::{self, PreslidingShape};
use crate::effects::viscous_nonlinearity::{self, ViscousNonlinearity};
use crate::numbers::lanes::Block;
use crate::signals::doubt::{BEYOND_RATIO, LONGEST_LIE_S, Shown, Stored, TOLERATED_N, review_friction, review_sensor};
use crate::signals::{GREATEST_MOTION, checked_cycles, condition};

/// Effects that can make a bearing hold less than its parameters say: over time (`friction_drift`) or with the load (`load_nonlinearity`). Other effects that
/// lower μ are not counted: `UNSETTLED` then comes later.
pub(super) const BEARS_OTHERWISE: Acting = friction_drift::ACTS.and(load_nonlinearity::ACTS);

impl<const CABLES: usize> Compensator<CABLES> {
    /// Returns the jumps of a block's sensors, one bit per cable. It must run before the cycle stores its signals.
    #[cold]
    #[inline(never)]
    pub(super) fn review_sensor<T: Block>(&mut self, block: usize, input: &CycleInput<CABLES>) -> u32 {
        let mut last = self.state.columns.signals::<T>(block);
        let (last_n, unchanged_cycles) = (last.sensor_force_n, last.frozen_count);
        let signals =
            condition(&self.limits, &mut last, &input.signals_of_block(block * T::COUNT), input.elapsed_cycles);
        let mut doubts = self.state.columns.doubts::<T>(block);
        let columns = &self.state.columns;
        let stored_n =
            columns.pulley_friction_n.iter().fold(T::splat(0.0), |sum, column| sum + T::load(column, block).abs());
        let is_lumped = self.params.model::<T>(block).lumped;
        let stored_n = T::select(is_lumped, T::load(&columns.lumped_friction_n, block).abs(), stored_n);
        let shown = Shown {
            stored_n,
            sensor_force_n: [signals.sensor_force_n, last_n],
            finite: signals.sensor_finite,
            paused: signals.jump,
            unchanged_cycles,
            elapsed_cycles: T::splat(checked_cycles(input.elapsed_cycles)),
            longest_cycles: T::splat(LONGEST_LIE_S / self.cycle_s),
        };
        let Self { params, .. } = &*self;
        let limits =
            [&params.sensor_jump_n, &params.tolerated_sensor_n, &params.tolerated_ratio, &params.recovery_cycles];
        let limits = limits.map(|column| T::load(column, block));
        let [jump, goes_on] = review_sensor(limits, &shown, &mut doubts);
        self.state.columns.set_doubts(block, &doubts);
        let present = self.present_bits::<T>(block);
        self.state.doubtful |= T::bits(goes_on) & present != 0;
        T::bits(jump) & present
    }

    /// Reviews the friction stored by a block's cables, after [`review_sensor`](Self::review_sensor) has returned `jump`. Returns the bits of
    /// `SENSOR_JUMP` and `UNSETTLED` for this cycle.
    #[cold]
    #[inline(never)]
    pub(super) fn review_friction<T: Block>(
        &mut self,
        first: usize,
        input: &CycleInput<CABLES>,
        jump: u32,
        [way_m, tension_n, stored_n, platform_force_n]: [T; 4],
    ) -> [u32; 2] {
        let (block, acting) = (first / T::COUNT, self.features.acting);
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let mut doubts = self.state.columns.doubts::<T>(block);
        let [bears_ratio, bears_per_wrap, bears_n, platform_share, wrap_factor] = [
            &self.params.bears_ratio,
            &self.params.bears_per_wrap,
            &self.params.bears_n,
            &self.params.platform_share,
            &self.state.columns.pose_wrap_factor,
        ]
        .map(|column| T::load(column, block));
        let cable = BlockOfCables::new(&self.params, &mut self.state.columns, block, self.place_count);
        let value = |place| Cable::<T>::effect(&cable, place);
        let tension_n = tension_n.max(zero);
        // Ratio of the present μ to that of the parameters, the greatest over the pulleys: at the tension, and at most with what the stored
        // friction adds to it.
        let [mut raised, mut most_raised] = [one; 2];
        if acting.has(load_nonlinearity::ACTS) {
            let law = LoadNonlinearity::of(value);
            let raised_at = |tension_n: T| {
                (0..self.place_count).fold(zero, |greatest, place| {
                    let wrap_factor = Cable::<T>::wrap_factor(&cable, place);
                    greatest.max(law.factor(wrap_factor * tension_n).keep(zero.lt(wrap_factor)))
                })
            };
            raised = raised_at(tension_n);
            most_raised = raised.max(raised_at(tension_n + stored_n.max(doubts.stored_from_n)));
        }
        if acting.has(friction_drift::ACTS) {
            let drifted = FrictionDrift::of(value).factor(T::splat(self.state.cycle * self.cycle_s));
            (raised, most_raised) = (raised * drifted, most_raised * drifted);
        }
        let speed_m_per_s: T = input.signals_of_block::<T>(first).speed_m_per_s;
        let speed_m_per_s = speed_m_per_s.keep(speed_m_per_s.within(GREATEST_MOTION)).abs();
        let mut viscous_n =
            (0..self.place_count).fold(zero, |sum, place| sum + Cable::<T>::viscous_n(&cable, place, speed_m_per_s));
        if acting.has(direction_asymmetry::ACTS) {
            viscous_n = viscous_n * (one + DirectionAsymmetry::of(value).viscous_ratio.abs());
        }
        if acting.has(viscous_nonlinearity::ACTS) {
            viscous_n = viscous_n + ViscousNonlinearity::of(value).force_n(speed_m_per_s);
        }
        let tolerated = [BEYOND_RATIO, TOLERATED_N].map(|tolerated| T::splat(tolerated) / platform_share);
        let ratio = bears_ratio - tolerated[0] + bears_per_wrap * wrap_factor;
        // Viscous friction loads the pulleys behind; a slip limit takes it from the stored friction.
        let limited_n = if self.features.traction { viscous_n } else { zero };
        let stored = Stored {
            jump: zero.lt(T::from_lanes(|lane| f64::from(jump >> lane & 1))),
            tension_n,
            sum_n: stored_n,
            platform_force_n,
            bears_n: ratio * raised * (tension_n + viscous_n * platform_share) + (bears_n - tolerated[1]) + limited_n,
            fed_ratio: ratio * most_raised,
            platform_share,
            way_m: way_m.max(zero),
            sigma_n_per_m: self.params.model::<T>(block).sigma_n_per_m,
            shape: acting.has(presliding_shape::ACTS).then(|| PreslidingShape::of(value)),
        };
        let [unsettled, goes_on] = review_friction(&stored, &mut doubts);
        self.state.columns.set_doubts(block, &doubts);
        let present = self.present_bits::<T>(block);
        self.state.doubtful |= T::bits(goes_on) & present != 0;
        [jump, T::bits(unsettled) & present]
    }

    /// Returns which lanes of a block are cables of the robot.
    fn present_bits<T: Block>(&self, block: usize) -> u32 {
        (1 << self.cable_count.saturating_sub(block * T::COUNT).min(T::COUNT)) - 1
    }
}
