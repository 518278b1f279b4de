//! Parameters and state of all cables, stored one column per quantity, so that a block of neighbouring cables loads at once.
//!
//! This is the structure of arrays behind [`Compensator`](crate::Compensator), private to the crate.

use crate::cable::{Cable, CableModel};
use crate::effects::time_delay::{self, Delay, DelayLine};
#[cfg(feature = "alloc")]
use crate::effects::{Acting, Effect};
use crate::effects::{EFFECT_PARAMETER_COUNT, MEMORY, UNKNOWN};
use crate::friction::places::{NO_SLIP, PLACES, Places, START_WRAP_FACTOR};
use crate::numbers::lanes::Block;
use crate::parameters::FRICTION_COUNT;
use crate::robot::{CableParams, MAX_PULLEYS};
use crate::signals::SignalState;
use crate::signals::doubt::{BEYOND_RATIO, Doubts, TOLERATED_N, Trust};
use crate::swivel::Swivel;
use crate::words::words_of;

/// Parameters that do not change while running.
///
/// Aligned to four numbers, so that a load can be part of the instruction that uses it.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct ParamColumns<const CABLES: usize> {
    mu: [f64; CABLES],
    sigma_n_per_m: [f64; CABLES],
    offset_n: [f64; CABLES],
    sensor_cos: [f64; CABLES],
    frictionless_gain: [f64; CABLES],
    pub lumped: [f64; CABLES],
    greatest_mu: [f64; CABLES],
    effects: [[f64; CABLES]; EFFECT_PARAMETER_COUNT],
    wrap_factor: [[f64; CABLES]; PLACES],
    viscous_n_s_per_m: [[f64; CABLES]; PLACES],
    traction_ratio: [[f64; CABLES]; PLACES],
    present: [[f64; CABLES]; PLACES],
    pulley_number: [[f64; CABLES]; PLACES],
    stretch_ratio: [[f64; CABLES]; PLACES],
    /// 1 if the wrap of the pulley at the last position follows the pose, else 0.
    follows_pose: [f64; CABLES],
    pub traction_mu: [f64; CABLES],
    pub least_force_n: [f64; CABLES],
    pub greatest_force_n: [f64; CABLES],
    pub greatest_speed_m_per_s: [f64; CABLES],
    /// See [`Trust`]; the tolerances of the force are added to what the load bears.
    pub sensor_jump_n: [f64; CABLES],
    pub tolerated_sensor_n: [f64; CABLES],
    pub tolerated_ratio: [f64; CABLES],
    pub recovery_cycles: [f64; CABLES],
    /// Greatest change of the sensor force that is no jump at any force, N.
    pub calm_change_n: [f64; CABLES],
    pub bears_ratio: [f64; CABLES],
    pub bears_per_wrap: [f64; CABLES],
    pub bears_n: [f64; CABLES],
    pub platform_share: [f64; CABLES],
    pub delay: [Delay; CABLES],
    entry_m: [[f64; CABLES]; 3],
    axis: [[f64; CABLES]; 3],
    radius_m: [f64; CABLES],
    platform_m: [[f64; CABLES]; 3],
    has_geometry: [f64; CABLES],
    /// Position of each pulley of a cable; [`PLACES`] for pulleys that it does not have.
    pub pulley_place: [[usize; MAX_PULLEYS]; CABLES],
}

impl<const CABLES: usize> ParamColumns<CABLES> {
    /// Columns of cables that do not exist: no friction, no geometry.
    pub const EMPTY: Self = Self {
        mu: [0.0; CABLES],
        sigma_n_per_m: [1.0; CABLES],
        offset_n: [0.0; CABLES],
        sensor_cos: [0.0; CABLES],
        frictionless_gain: [1.0; CABLES],
        lumped: [0.0; CABLES],
        greatest_mu: [0.0; CABLES],
        effects: [[1.0; CABLES]; EFFECT_PARAMETER_COUNT],
        wrap_factor: [[0.0; CABLES]; PLACES],
        viscous_n_s_per_m: [[0.0; CABLES]; PLACES],
        traction_ratio: [[NO_SLIP; CABLES]; PLACES],
        present: [[0.0; CABLES]; PLACES],
        pulley_number: [[0.0; CABLES]; PLACES],
        stretch_ratio: [[0.0; CABLES]; PLACES],
        follows_pose: [0.0; CABLES],
        traction_mu: [0.0; CABLES],
        least_force_n: [-f64::MAX; CABLES],
        greatest_force_n: [f64::MAX; CABLES],
        greatest_speed_m_per_s: [f64::MAX; CABLES],
        sensor_jump_n: [Trust::NONE.sensor_jump_n; CABLES],
        tolerated_sensor_n: [Trust::NONE.tolerated_sensor_n; CABLES],
        tolerated_ratio: [Trust::NONE.tolerated_ratio; CABLES],
        recovery_cycles: [Trust::NONE.recovery_cycles; CABLES],
        calm_change_n: [GREATEST_CALM_N; CABLES],
        bears_ratio: [Trust::NONE.bears_ratio; CABLES],
        bears_per_wrap: [Trust::NONE.bears_per_wrap; CABLES],
        bears_n: [Trust::NONE.bears_n; CABLES],
        platform_share: [Trust::NONE.platform_share; CABLES],
        delay: [Delay::NONE; CABLES],
        entry_m: [[0.0; CABLES]; 3],
        axis: [[0.0; CABLES], [0.0; CABLES], [1.0; CABLES]],
        radius_m: [0.0; CABLES],
        platform_m: [[0.0; CABLES]; 3],
        has_geometry: [0.0; CABLES],
        pulley_place: [[PLACES; MAX_PULLEYS]; CABLES],
    };
}

impl<const CABLES: usize> ParamColumns<CABLES> {
    /// Enters a cable of a robot with `place_count` positions per cable.
    pub fn set(&mut self, cable: usize, params: &CableParams, trust: &Trust, cycle_s: f64, place_count: usize) {
        let values = params.values();
        let model = CableModel::<f64>::new(|_| params, &values);
        put(&mut self.mu, cable, model.mu);
        put(&mut self.sigma_n_per_m, cable, model.sigma_n_per_m);
        put(&mut self.offset_n, cable, model.offset_n);
        put(&mut self.sensor_cos, cable, model.sensor_cos);
        put(&mut self.frictionless_gain, cable, model.frictionless_gain);
        put(&mut self.lumped, cable, f64::from(model.lumped));
        put(&mut self.greatest_mu, cable, params.greatest_mu());
        for (column, value) in self.effects.iter_mut().zip(values.iter().skip(FRICTION_COUNT)) {
            put(column, cable, *value);
        }
        put(&mut self.traction_mu, cable, params.traction_mu.unwrap_or(0.0));
        put(&mut self.least_force_n, cable, params.validated.force_n[0]);
        put(&mut self.greatest_force_n, cable, params.validated.force_n[1]);
        put(&mut self.greatest_speed_m_per_s, cable, params.validated.speed_m_per_s);
        let Trust { sensor_jump_n, tolerated_sensor_n, tolerated_ratio, recovery_cycles, .. } = *trust;
        let Trust { bears_ratio, bears_per_wrap, bears_n, platform_share, .. } = *trust;
        put(&mut self.sensor_jump_n, cable, sensor_jump_n);
        put(&mut self.tolerated_sensor_n, cable, tolerated_sensor_n);
        put(&mut self.tolerated_ratio, cable, tolerated_ratio);
        put(&mut self.recovery_cycles, cable, recovery_cycles);
        put(&mut self.calm_change_n, cable, sensor_jump_n.max(tolerated_sensor_n).min(GREATEST_CALM_N));
        put(&mut self.bears_ratio, cable, bears_ratio + BEYOND_RATIO / platform_share);
        put(&mut self.bears_per_wrap, cable, bears_per_wrap);
        put(&mut self.bears_n, cable, bears_n + TOLERATED_N / platform_share);
        put(&mut self.platform_share, cable, platform_share);
        let delay_cycles = values[time_delay::DELAY] / cycle_s;
        put(&mut self.delay, cable, Delay::from_cycles(delay_cycles));
        let places = Places::new(params, place_count);
        for (place, viscous) in self.viscous_n_s_per_m.iter_mut().enumerate() {
            put(viscous, cable, params.friction.viscous_n_s_per_m * places.has_pulley[place]);
        }
        let columns = [
            (&mut self.wrap_factor, places.wrap_factor),
            (&mut self.traction_ratio, places.traction_ratio),
            (&mut self.present, places.has_pulley),
            (&mut self.pulley_number, places.number),
            (&mut self.stretch_ratio, places.stretch_ratio),
        ];
        for (columns, values) in columns {
            for (column, value) in columns.iter_mut().zip(values) {
                put(column, cable, value);
            }
        }
        put(&mut self.follows_pose, cable, f64::from(params.needs_pose()));
        put(&mut self.pulley_place, cable, places.of_pulley);
        if let Some(geometry) = &params.geometry {
            let points = [
                (&mut self.entry_m, geometry.base_m),
                (&mut self.axis, geometry.axis),
                (&mut self.platform_m, geometry.platform_m),
            ];
            for (columns, point) in points {
                for (column, coordinate) in columns.iter_mut().zip(point.iter()) {
                    put(column, cable, *coordinate);
                }
            }
            put(&mut self.radius_m, cable, geometry.radius_m);
            put(&mut self.has_geometry, cable, 1.0);
        }
    }

    /// Returns the parameters of the cables of a block.
    #[inline(always)]
    pub fn model<T: Block>(&self, block: usize) -> CableModel<T> {
        CableModel {
            mu: T::load(&self.mu, block),
            sigma_n_per_m: T::load(&self.sigma_n_per_m, block),
            offset_n: T::load(&self.offset_n, block),
            sensor_cos: T::load(&self.sensor_cos, block),
            frictionless_gain: T::load(&self.frictionless_gain, block),
            lumped: T::splat(0.0).lt(T::load(&self.lumped, block)),
        }
    }

    /// Returns the last pulleys of a block.
    #[inline(always)]
    pub fn swivel<T: Block>(&self, block: usize) -> Swivel<T> {
        Swivel {
            entry_m: self.entry_m.each_ref().map(|column| T::load(column, block)),
            axis: self.axis.each_ref().map(|column| T::load(column, block)),
            radius_m: T::load(&self.radius_m, block),
        }
    }

    /// Returns the attachment points of a block in the platform frame, m.
    #[inline(always)]
    pub fn platform_m<T: Block>(&self, block: usize) -> [T; 3] {
        self.platform_m.each_ref().map(|column| T::load(column, block))
    }

    /// Returns the change of the force at the platform per newton of friction stored at a position. The sensor pulley differs, because the sensor
    /// measures its friction too (\[P\] 11).
    pub fn platform_share(&self, cable: usize, place: usize) -> f64 {
        let at = |column: &[f64; CABLES]| column.get(cable).copied().unwrap_or(0.0);
        if place == 0 { -at(&self.sensor_cos) * at(&self.frictionless_gain) } else { 1.0 }
    }

    /// Returns `2 sin(α/2)` of the wrap at a position; `by_pose` is the value for a wrap that follows the pose.
    pub fn wrap_factor_of(&self, cable: usize, place: usize, place_count: usize, by_pose: f64) -> f64 {
        let at = |column: &[f64; CABLES]| column.get(cable).copied().unwrap_or(0.0);
        let is_posed = place + 1 == place_count && at(&self.follows_pose) > 0.0;
        if is_posed { by_pose } else { self.wrap_factor.get(place).map_or(0.0, at) }
    }

    /// Whether both have the same pulleys and attachments.
    pub fn same_build(&self, other: &Self) -> bool {
        let bits = |of: &Self| [of.follows_pose, of.has_geometry].map(|column| column.map(f64::to_bits));
        bits(self) == bits(other) && self.pulley_place == other.pulley_place
    }

    /// Returns what gives the state of a cable its meaning, as one word: its number of pulleys, whether the first is at the sensor and the last follows
    /// the pose, whether there is an attachment, the form of presliding, and the effects that remember something.
    #[cfg(feature = "alloc")]
    pub fn structure_word(&self, cable: usize) -> u64 {
        let places = self.pulley_place.get(cable).copied().unwrap_or([PLACES; MAX_PULLEYS]);
        let pulley_count = places.iter().filter(|place| **place < PLACES).count() as u64;
        let at = |column: &[f64; CABLES]| column.get(cable).copied().unwrap_or(0.0);
        let flags = [
            places.first() == Some(&0),
            at(&self.follows_pose) > 0.0,
            at(&self.has_geometry) > 0.0,
            at(&self.lumped) > 0.0,
        ];
        let value = |place: usize| place.checked_sub(FRICTION_COUNT).and_then(|place| self.effects.get(place)).map(at);
        let acting =
            Acting::of(|row, place| value(place).is_some_and(|value| value.to_bits() != row.neutral.to_bits()));
        let remembering = Effect::CATALOGUE.iter().filter(|effect| remembers(**effect)).map(|effect| effect.acts());
        let effects = remembering.fold(0, |word, effect| word << 1 | u64::from(acting.has(effect)));
        flags.iter().fold(effects << 8 | pulley_count, |word, flag| word << 1 | u64::from(*flag))
    }

    /// Returns which cables of a block have an attachment.
    #[inline(always)]
    pub fn with_geometry<T: Block>(&self, block: usize) -> T::Mask {
        T::splat(0.0).lt(T::load(&self.has_geometry, block))
    }

    /// Returns for which cables of a block the wrap of the last pulley follows the pose.
    #[inline(always)]
    pub fn follows_pose<T: Block>(&self, block: usize) -> T::Mask {
        T::splat(0.0).lt(T::load(&self.follows_pose, block))
    }
}

/// Whether the state holds something of an effect.
#[cfg(feature = "alloc")]
const fn remembers(effect: Effect) -> bool {
    let places = effect.memory_places();
    matches!(effect, Effect::TimeDelay) || places.start < places.end
}

// The structure word has a bit for each of them, beside eight for the pulleys and four flags.
#[cfg(feature = "alloc")]
const _: () = {
    let (mut count, mut effect) = (0, 0);
    while effect < Effect::CATALOGUE.len() {
        count += remembers(Effect::CATALOGUE[effect]) as u32;
        effect += 1;
    }
    assert!(count <= u64::BITS - 12);
};

/// The state from one cycle to the next: plain numbers, so that a copy is a snapshot. Aligned like [`ParamColumns`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct StateColumns<const CABLES: usize> {
    /// Last valid sensor force, N.
    pub sensor_force_n: [f64; CABLES],
    /// Cycles since its last change.
    pub frozen_count: [f64; CABLES],
    /// Last finite length, m; [`UNKNOWN`] before the first.
    pub length_m: [f64; CABLES],
    /// Distance of the cable since the last change of the sensor force, m.
    pub frozen_travel_m: [f64; CABLES],
    /// Last valid total friction, N.
    pub friction_n: [f64; CABLES],
    /// State of the jump detection, see [`Doubts`].
    pub unseen_cycles: [f64; CABLES],
    pub jump_cycles: [f64; CABLES],
    pub jump_from_n: [f64; CABLES],
    pub jumped_n: [f64; CABLES],
    pub stored_from_n: [f64; CABLES],
    pub left_n: [f64; CABLES],
    /// Dahl state of the `lumped` form, N.
    pub lumped_friction_n: [f64; CABLES],
    /// Dahl states of the `per_pulley` form, N.
    pub pulley_friction_n: [[f64; CABLES]; PLACES],
    /// State of the effects.
    pub memory: [[f64; CABLES]; MEMORY],
    /// Wrap factor and tension ratio at slip of the pulley that follows the pose.
    pub pose_wrap_factor: [f64; CABLES],
    pub pose_traction_ratio: [f64; CABLES],
    /// 1 after the first pose at which the attachment was reachable, else 0.
    pub direction_known: [f64; CABLES],
    /// Columns of the structure matrix.
    pub direction: [[f64; CABLES]; 3],
    pub moment_arm_m: [[f64; CABLES]; 3],
    pub delayed_displacement_m: [DelayLine; CABLES],
    pub delayed_speed_m_per_s: [DelayLine; CABLES],
    /// Distance by which the delayed motion lags behind, m.
    pub lag_m: [f64; CABLES],
}

impl<const CABLES: usize> StateColumns<CABLES> {
    /// Returns the signal state of a block.
    #[inline(always)]
    pub fn signals<T: Block>(&self, block: usize) -> SignalState<T> {
        SignalState {
            sensor_force_n: T::load(&self.sensor_force_n, block),
            frozen_count: T::load(&self.frozen_count, block),
            frozen_travel_m: T::load(&self.frozen_travel_m, block),
            length_m: T::load(&self.length_m, block),
        }
    }

    /// Keeps it.
    #[inline(always)]
    pub fn set_signals<T: Block>(&mut self, block: usize, signals: &SignalState<T>) {
        signals.sensor_force_n.store(&mut self.sensor_force_n, block);
        signals.frozen_count.store(&mut self.frozen_count, block);
        signals.frozen_travel_m.store(&mut self.frozen_travel_m, block);
        signals.length_m.store(&mut self.length_m, block);
    }

    /// Returns the state of the jump detection of a block.
    #[inline(always)]
    pub fn doubts<T: Block>(&self, block: usize) -> Doubts<T> {
        Doubts {
            unseen_cycles: T::load(&self.unseen_cycles, block),
            jump_cycles: T::load(&self.jump_cycles, block),
            jump_from_n: T::load(&self.jump_from_n, block),
            jumped_n: T::load(&self.jumped_n, block),
            stored_from_n: T::load(&self.stored_from_n, block),
            left_n: T::load(&self.left_n, block),
        }
    }

    /// Keeps it.
    #[inline(always)]
    pub fn set_doubts<T: Block>(&mut self, block: usize, doubts: &Doubts<T>) {
        doubts.unseen_cycles.store(&mut self.unseen_cycles, block);
        doubts.jump_cycles.store(&mut self.jump_cycles, block);
        doubts.jump_from_n.store(&mut self.jump_from_n, block);
        doubts.jumped_n.store(&mut self.jumped_n, block);
        doubts.stored_from_n.store(&mut self.stored_from_n, block);
        doubts.left_n.store(&mut self.left_n, block);
    }

    /// At rest, no stored friction, no pose yet; a wrap that follows the pose is taken as 90°.
    pub const START: Self = Self {
        sensor_force_n: [0.0; CABLES],
        frozen_count: [0.0; CABLES],
        length_m: [UNKNOWN; CABLES],
        frozen_travel_m: [0.0; CABLES],
        friction_n: [0.0; CABLES],
        unseen_cycles: [UNKNOWN; CABLES],
        jump_cycles: [0.0; CABLES],
        jump_from_n: [0.0; CABLES],
        jumped_n: [0.0; CABLES],
        stored_from_n: [0.0; CABLES],
        left_n: [0.0; CABLES],
        lumped_friction_n: [0.0; CABLES],
        pulley_friction_n: [[0.0; CABLES]; PLACES],
        memory: [[UNKNOWN; CABLES]; MEMORY],
        pose_wrap_factor: [START_WRAP_FACTOR; CABLES],
        pose_traction_ratio: [NO_SLIP; CABLES],
        direction_known: [0.0; CABLES],
        direction: [[0.0; CABLES]; 3],
        moment_arm_m: [[0.0; CABLES]; 3],
        delayed_displacement_m: [DelayLine::EMPTY; CABLES],
        delayed_speed_m_per_s: [DelayLine::EMPTY; CABLES],
        lag_m: [0.0; CABLES],
    };
}

/// The cables of a block, with their state.
pub struct BlockOfCables<'a, const CABLES: usize> {
    params: &'a ParamColumns<CABLES>,
    state: &'a mut StateColumns<CABLES>,
    block: usize,
    count: usize,
}

impl<'a, const CABLES: usize> BlockOfCables<'a, CABLES> {
    #[inline(always)]
    pub fn new(
        params: &'a ParamColumns<CABLES>,
        state: &'a mut StateColumns<CABLES>,
        block: usize,
        count: usize,
    ) -> Self {
        // With this bound the compiler omits the check of the position in each access.
        Self { params, state, block, count: count.min(PLACES) }
    }

    #[inline(always)]
    fn column<T: Block>(&self, columns: &[[f64; CABLES]], place: usize) -> T {
        columns.get(place).map_or(T::splat(0.0), |column| T::load(column, self.block))
    }

    /// Returns the value by the pose at the last position of cables that follow it, else the fixed one.
    #[inline(always)]
    fn posed<T: Block>(&self, place: usize, by_pose: &[f64; CABLES], fixed: &[[f64; CABLES]; PLACES]) -> T {
        let fixed: T = self.column(fixed, place);
        if place + 1 < self.count {
            return fixed;
        }
        T::select(self.params.follows_pose::<T>(self.block), T::load(by_pose, self.block), fixed)
    }
}

impl<T: Block, const CABLES: usize> Cable<T> for BlockOfCables<'_, CABLES> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.count
    }
    #[inline(always)]
    fn wrap_factor(&self, place: usize) -> T {
        self.posed(place, &self.state.pose_wrap_factor, &self.params.wrap_factor)
    }
    #[inline(always)]
    fn viscous_n(&self, place: usize, speed_m_per_s: T) -> T {
        self.column::<T>(&self.params.viscous_n_s_per_m, place) * speed_m_per_s
    }
    #[inline(always)]
    fn traction_ratio(&self, place: usize) -> T {
        self.posed(place, &self.state.pose_traction_ratio, &self.params.traction_ratio)
    }
    #[inline(always)]
    fn present(&self, place: usize) -> T {
        self.column(&self.params.present, place)
    }
    #[inline(always)]
    fn pulley_number(&self, place: usize) -> T {
        self.column(&self.params.pulley_number, place)
    }
    #[inline(always)]
    fn stretch_ratio(&self, place: usize) -> T {
        self.column(&self.params.stretch_ratio, place)
    }
    #[inline(always)]
    fn greatest_mu(&self) -> T {
        T::load(&self.params.greatest_mu, self.block)
    }
    #[inline(always)]
    fn effect(&self, place: usize) -> T {
        self.column(&self.params.effects, place - FRICTION_COUNT)
    }
    #[inline(always)]
    fn memory(&self, place: usize) -> T {
        self.column(&self.state.memory, place)
    }
    #[inline(always)]
    fn set_memory(&mut self, place: usize, value: T) {
        if let Some(column) = self.state.memory.get_mut(place) {
            value.store(column, self.block);
        }
    }
    #[inline(always)]
    fn pulley_friction_n(&self, place: usize) -> T {
        self.column(&self.state.pulley_friction_n, place)
    }
    #[inline(always)]
    fn set_pulley_friction_n(&mut self, place: usize, friction_n: T) {
        if let Some(column) = self.state.pulley_friction_n.get_mut(place) {
            friction_n.store(column, self.block);
        }
    }
    #[inline(always)]
    fn lumped_friction_n(&self) -> T {
        T::load(&self.state.lumped_friction_n, self.block)
    }
    #[inline(always)]
    fn set_lumped_friction_n(&mut self, friction_n: T) {
        friction_n.store(&mut self.state.lumped_friction_n, self.block);
    }
    #[inline(always)]
    fn held_friction_n(&self) -> T {
        T::load(&self.state.friction_n, self.block)
    }
    #[inline(always)]
    fn set_held_friction_n(&mut self, friction_n: T) {
        friction_n.store(&mut self.state.friction_n, self.block);
    }
}

/// A change from 0 to an invalid force must not count as calm, N.
const GREATEST_CALM_N: f64 = 1e8;

/// Does `column[place] = value`; nothing if the position does not exist.
fn put<V, const COUNT: usize>(column: &mut [V; COUNT], place: usize, value: V) {
    if let Some(entry) = column.get_mut(place) {
        *entry = value;
    }
}

words_of!(StateColumns<const CABLES> {
    sensor_force_n,
    frozen_count,
    length_m,
    frozen_travel_m,
    friction_n,
    unseen_cycles,
    jump_cycles,
    jump_from_n,
    jumped_n,
    stored_from_n,
    left_n,
    lumped_friction_n,
    pulley_friction_n,
    memory,
    pose_wrap_factor,
    pose_traction_ratio,
    direction_known,
    direction,
    moment_arm_m,
    delayed_displacement_m,
    delayed_speed_m_per_s,
    lag_m,
});
