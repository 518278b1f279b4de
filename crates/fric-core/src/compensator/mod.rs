//! The compensator: parameters and state of all cables, and one cycle of them.
//!
//! Every cycle it computes the forces at the platform and the wrench from the signals at the winches, in bounded time, without allocation and without
//! panic, for any input. It reads no clock, file or bus. Non-finite input is flagged ([`CableStatus`]) and never affects another cable. Size: about
//! 1 kB per cable, and 1 kB more per cable for the delay lines.

#[cfg(feature = "alloc")]
pub(crate) mod any;
pub(crate) mod columns;
pub(crate) mod cycle;
#[cfg(feature = "alloc")]
pub(crate) mod exchange;
mod takeover;
pub(crate) mod tunable;

use crate::cable::{Cable, Features, Moment};
use crate::cable_cycle::cable_cycle;
use crate::compensator::columns::{BlockOfCables, ParamColumns, StateColumns};
use crate::compensator::cycle::{CableInput, CableOutput, CycleInput, CycleOutput};
use crate::effects::Acting;
use crate::effects::direction_asymmetry::{self, DirectionAsymmetry};
use crate::effects::friction_drift::{self, FrictionDrift};
use crate::effects::load_nonlinearity::{self, LoadNonlinearity};
use crate::effects::presliding_shape::{self, PreslidingShape};
use crate::effects::time_delay::{self, Delay, DelayLine, Shifted};
use crate::effects::viscous_nonlinearity::{self, ViscousNonlinearity};
use crate::friction::places::{NO_SLIP, PLACES, Places};
use crate::numbers::lanes::{Block, CycleLanes, LANES, Lanes};
use crate::parameters::ParameterRow;
use crate::platform::{self, Pose, Wrench};
use crate::pulley::traction_ratio;
use crate::robot::{MAX_PULLEYS, ParamError, ParamProblem, RobotParams, ValidatedRange};
use crate::scalar::{Mask, Scalar};
use crate::signals::doubt::{
    BEYOND_RATIO, LONGEST_LIE_S, Shown, Stored, TOLERATED_N, Trust, review_friction, review_sensor,
};
use crate::signals::status::CableStatus;
use crate::signals::{
    BEFORE_FIRST, CableSignals, Conditioned, GREATEST_MOTION, RawSignals, SignalLimits, bounded_elapsed, condition,
    next_cycle,
};
use crate::swivel;
use crate::words::{Words, words_of};
use nalgebra::{Matrix3, SMatrix, Vector3};

/// Friction compensation of a robot with at most `CABLES` cables.
///
/// ```
/// use fric_core::robot::{
///     CableOptions, CableParams, FrictionOptions, MonitorOptions, PlatformOptions, PulleyOptions, RobotParams,
/// };
/// use fric_core::{CableInput, Compensator, CycleInput};
///
/// # fn main() -> Result<(), fric_core::ParamError> {
/// let pulleys = [PulleyOptions::Fixed { wrap_rad: core::f64::consts::PI, sensor: true }];
/// let friction = FrictionOptions { mu: 0.02, sigma_n_per_m: Some(1000.0), ..FrictionOptions::default() };
/// let cables = [CableParams::new(&CableOptions { friction, ..CableOptions::new(&pulleys) })?];
/// // The signal below has no noise, so the check for a frozen sensor is switched off.
/// let monitor = MonitorOptions { frozen_cycles: 0, ..MonitorOptions::for_cycle(0.001) };
/// let robot = RobotParams::new(0.001, &PlatformOptions::default(), monitor, &cables)?;
/// let mut compensator = Compensator::<1>::new(&robot)?;
///
/// let mut input = CycleInput::default();
/// for cycle in 0..1000 {
///     input.cables[0] = CableInput {
///         sensor_force_n: 20.0,
///         length_m: 1e-4 * f64::from(cycle),
///         speed_m_per_s: 0.1,
///     };
///     let output = compensator.step(&input);
///     assert!(output.cables[0].status.is_ok());
/// }
/// // Paying out over a pulley of 180°: F_1 = F_s (1 + μ)/2 ([P] 14).
/// let force_n = compensator.step(&input).cables[0].force_at_platform_n;
/// assert!((force_n - 20.0 * 1.02 / 2.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Compensator<const CABLES: usize> {
    params: ParamColumns<CABLES>,
    state: State<CABLES>,
    features: Features,
    any_geometry: bool,
    all_geometry: bool,
    any_validated: bool,
    cable_count: usize,
    place_count: usize,
    limits: SignalLimits,
    cycle_s: f64,
    gravity_n: Vector3<f64>,
    center_of_mass_m: Vector3<f64>,
}

/// The state from one cycle to the next, see [`Compensator::snapshot`].
#[derive(Clone, Copy, Debug, PartialEq)]
struct State<const CABLES: usize> {
    columns: StateColumns<CABLES>,
    /// Whether every cable has an attachment and a known direction, so that there is a wrench.
    directions_known: bool,
    /// Wrench of gravity at the last pose; `None` until all directions are known.
    gravity: Option<Wrench>,
    /// Number of this cycle, counted from the first, and of the previous one.
    cycle: f64,
    last_cycle: f64,
    /// Whether the sensor or the stored friction of any cable is doubtful, so that all are reviewed.
    doubtful: bool,
}

words_of!(State<const CABLES> { columns, directions_known, gravity, cycle, last_cycle, doubtful });

/// The state of a [`Compensator`] at one moment, for [`Compensator::restore`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot<const CABLES: usize>(State<CABLES>);

impl<const CABLES: usize> Words for Snapshot<CABLES> {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        self.0.each_word(show);
    }
}

impl<const CABLES: usize> Compensator<CABLES> {
    const START: State<CABLES> = State {
        columns: StateColumns::START,
        directions_known: false,
        gravity: None,
        cycle: BEFORE_FIRST,
        last_cycle: BEFORE_FIRST,
        doubtful: true,
    };

    /// Creates a compensator from checked parameters.
    ///
    /// # Errors
    /// [`ParamError`] if the robot has more than `CABLES` cables.
    pub fn new(robot: &RobotParams<'_>) -> Result<Self, ParamError> {
        let cable_count = robot.cables.len();
        if cable_count > CABLES {
            let problem = ParamProblem::Count { count: cable_count, min: 1, max: CABLES };
            return Err(ParamError { key: "cable", pulley: None, effect: None, problem });
        }
        let mut params = ParamColumns::EMPTY;
        let mut features = Features::default();
        let mut place_count = 1;
        for cable in robot.cables {
            let values = cable.values();
            let is_active = |row: &ParameterRow, place: usize| values[place].to_bits() != row.neutral.to_bits();
            let leads = values[time_delay::DELAY] < 0.0;
            features = features.with(cable).with_lead(leads).and_acting(is_active);
            place_count = place_count.max(Places::needed(cable));
        }
        for (place, cable) in robot.cables.iter().enumerate() {
            let trust = Trust::new(cable, robot.monitor.sensor_jump_n, robot.monitor.length_jump_m, robot.cycle_s);
            params.set(place, cable, &trust, robot.cycle_s, place_count);
        }
        Ok(Self {
            params,
            state: Self::START,
            features,
            any_geometry: robot.cables.iter().any(|cable| cable.geometry.is_some()),
            all_geometry: robot.cables.iter().all(|cable| cable.geometry.is_some()),
            any_validated: robot.cables.iter().any(|cable| cable.validated != ValidatedRange::ANY),
            cable_count,
            place_count,
            limits: robot.monitor.limits(),
            cycle_s: robot.cycle_s,
            gravity_n: robot.gravity_m_per_s2 * robot.mass_kg,
            center_of_mass_m: robot.center_of_mass_m,
        })
    }

    /// Returns the number of cables of the robot.
    #[must_use]
    pub fn cable_count(&self) -> usize {
        self.cable_count
    }

    /// Resets the state to that after set-up: at rest, no stored friction, no pose.
    pub fn reset(&mut self) {
        self.state = Self::START;
    }

    /// Returns a copy of the whole state.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<CABLES> {
        Snapshot(self.state)
    }

    /// Restores the state of a snapshot.
    pub fn restore(&mut self, snapshot: &Snapshot<CABLES>) {
        self.state = snapshot.0;
    }

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

    /// Returns the friction stored at each pulley of a cable, counted from the winch, N.
    ///
    /// This is the Coulomb part, without viscous friction. It is 0 with `lumped` presliding, which has no state per pulley, for entries beyond the
    /// cable's pulleys, and for cables that the robot does not have.
    #[must_use]
    pub fn pulley_friction_n(&self, cable: usize) -> [f64; MAX_PULLEYS] {
        let places = self.params.pulley_place.get(cable).copied().unwrap_or([PLACES; MAX_PULLEYS]);
        let columns = &self.state.columns.pulley_friction_n;
        places.map(|place| columns.get(place).and_then(|column| column.get(cable)).copied().unwrap_or(0.0))
    }

    /// Returns the structure matrix `A^T` of the last cycle with a pose, force rows first; columns beyond the robot's cables are zero. `None` before the
    /// first pose, and for a robot with a cable without attachment.
    #[must_use]
    pub fn structure_matrix(&self) -> Option<SMatrix<f64, 6, CABLES>> {
        self.state.gravity?;
        let columns = &self.state.columns;
        let entry = |row: usize, cable: usize| {
            let column = if row < 3 { columns.direction.get(row) } else { columns.moment_arm_m.get(row - 3) };
            column.and_then(|column| column.get(cable)).copied().unwrap_or(0.0)
        };
        Some(SMatrix::from_fn(entry))
    }

    /// Returns which cables of a block are affected by a cycle without a pose: those whose wrap follows it and, after the first wrench, all cables that
    /// contribute to it.
    #[inline(always)]
    fn misses_pose<T: Block>(&self, block: usize) -> T::Mask {
        let stale_wrench = T::mask(self.state.gravity.is_some());
        self.params.follows_pose::<T>(block).or(stale_wrench.and(self.params.with_geometry::<T>(block)))
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

impl<const CABLES: usize> Compensator<CABLES> {
    /// Computes wrap, direction and moment arm of a block's cables at a pose; a cable whose attachment is out of reach keeps the last ones. Returns the
    /// lanes of such cables.
    #[inline(never)]
    fn follow_pose<T: Block>(&mut self, first: usize, pose: &Pose, rotation: &Matrix3<f64>) -> u32 {
        let block = first / T::COUNT;
        // Says once what each access to a column would have to ask.
        if block >= CABLES.div_ceil(T::COUNT) {
            return 0;
        }
        let (attachment_m, [ax, ay, az]) = platform::attachment::<T>(pose, rotation, self.params.platform_m(block));
        let exit = swivel::exit(&self.params.swivel(block), attachment_m);
        let with_geometry = self.params.with_geometry::<T>(block);
        let moves = exit.reachable.and(with_geometry);
        let [ux, uy, uz] = exit.direction;
        let moment_arm_m = [ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux];
        let columns = &mut self.state.columns;
        let all_move = T::all(moves);
        let keep = |column: &mut [f64; CABLES], value: T| {
            let value = if all_move { value } else { T::select(moves, value, T::load(column, block)) };
            value.store(column, block);
        };
        for (column, value) in columns.direction.iter_mut().zip(exit.direction) {
            keep(column, value);
        }
        for (column, value) in columns.moment_arm_m.iter_mut().zip(moment_arm_m) {
            keep(column, value);
        }
        keep(&mut columns.pose_wrap_factor, exit.wrap_factor);
        if !self.state.directions_known {
            keep(&mut columns.direction_known, T::splat(1.0));
        }
        if self.features.traction {
            let traction_mu = T::load(&self.params.traction_mu, block);
            let [cos, sin] = exit.cos_sin_wrap;
            // Only robots with a slip limit need an angle and an exponential per cable.
            let ratio = T::from_lanes(|lane| {
                traction_ratio(traction_mu.lane(lane), swivel::wrap_rad([cos.lane(lane), sin.lane(lane)]))
            });
            let ratio = T::select(T::splat(0.0).lt(traction_mu), ratio, T::splat(NO_SLIP));
            keep(&mut columns.pose_traction_ratio, ratio);
        }
        T::bits(with_geometry.and(exit.reachable.not()))
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
        let raw: RawSignals<T> = raw_signals(input, first);
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

    /// Returns the jumps of a block's sensors, one bit per cable. It must run before the cycle stores its signals.
    #[cold]
    #[inline(never)]
    fn review_sensor<T: Block>(&mut self, block: usize, input: &CycleInput<CABLES>) -> u32 {
        let mut last = self.state.columns.signals::<T>(block);
        let (last_n, unchanged_cycles) = (last.sensor_force_n, last.frozen_count);
        let signals = condition(&self.limits, &mut last, &raw_signals(input, block * T::COUNT), input.elapsed_cycles);
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
            elapsed_cycles: T::splat(bounded_elapsed(input.elapsed_cycles)),
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
    fn review_friction<T: Block>(
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
        let speed_m_per_s: T = raw_signals(input, first).speed_m_per_s;
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

/// Returns the signals of a block's cables.
#[inline(always)]
fn raw_signals<T: Block, const CABLES: usize>(input: &CycleInput<CABLES>, first: usize) -> RawSignals<T> {
    let signal = |of: fn(&CableInput) -> f64| T::from_lanes(|lane| input.cables.get(first + lane).map_or(0.0, of));
    RawSignals {
        sensor_force_n: signal(|cable| cable.sensor_force_n),
        length_m: signal(|cable| cable.length_m),
        speed_m_per_s: signal(|cable| cable.speed_m_per_s),
    }
}

/// Effects that can make a bearing's friction smaller than its parameters alone say.
const BEARS_OTHERWISE: Acting = friction_drift::ACTS.and(load_nonlinearity::ACTS);

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
