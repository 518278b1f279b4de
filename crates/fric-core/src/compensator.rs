//! The cycle as one object.
//!
//! For: force at the platform and wrench from the winch-side signals, every cycle, in bounded time, without allocation,
//! without panic, for every input there is. It does not read clocks, files or buses. Non-finite input is flagged
//! ([`CableStatus`]) and never reaches another cable. Size: about 1 kB a cable, and 1 kB more a cable for the delay
//! lines.

mod takeover;

use crate::cable::{Features, Moment, cable_cycle};
use crate::columns::{BlockOfCables, ParamColumns, StateColumns};
use crate::cycle::{CableInput, CableOutput, CycleInput, CycleOutput};
use crate::effects::time_delay::{self, Delay, DelayLine};
use crate::lanes::{LANES, Lanes, LanesMask};
use crate::parameters::ParameterRow;
use crate::places::{NO_SLIP, PLACES, Places};
use crate::platform::{self, Pose, Wrench};
use crate::pulley::traction_ratio;
use crate::robot::{MAX_PULLEYS, ParamError, ParamProblem, RobotParams};
use crate::scalar::{Mask, Scalar};
use crate::signals::{BEFORE_FIRST, CableSignals, Conditioned, RawSignals, SignalLimits, condition, next_cycle};
use crate::status::CableStatus;
use crate::swivel;
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
    cable_count: usize,
    place_count: usize,
    limits: SignalLimits,
    cycle_s: f64,
    gravity_n: Vector3<f64>,
    center_of_mass_m: Vector3<f64>,
}

/// What a cycle leaves behind, see [`Compensator::snapshot`].
#[derive(Clone, Copy, Debug, PartialEq)]
struct State<const CABLES: usize> {
    columns: StateColumns<CABLES>,
    /// Every cable has an attachment and has been seen to leave its last pulley, so that there is a wrench.
    directions_known: bool,
    /// Wrench of gravity at the last pose since then.
    gravity: Option<Wrench>,
    /// The cycle, from the first, and the one before.
    cycle: f64,
    last_cycle: f64,
}

/// The state of a [`Compensator`] at one moment, for [`Compensator::restore`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot<const CABLES: usize>(State<CABLES>);

impl<const CABLES: usize> Compensator<CABLES> {
    const START: State<CABLES> = State {
        columns: StateColumns::START,
        directions_known: false,
        gravity: None,
        cycle: BEFORE_FIRST,
        last_cycle: BEFORE_FIRST,
    };

    /// Set-up from checked parameters.
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
            features = features.with(cable).and_acting(is_active);
            place_count = place_count.max(Places::needed(cable));
        }
        for (place, cable) in robot.cables.iter().enumerate() {
            params.set(place, cable, robot.cycle_s, place_count);
        }
        Ok(Self {
            params,
            state: Self::START,
            features,
            any_geometry: robot.cables.iter().any(|cable| cable.geometry.is_some()),
            all_geometry: robot.cables.iter().all(|cable| cable.geometry.is_some()),
            cable_count,
            place_count,
            limits: robot.monitor.limits(),
            cycle_s: robot.cycle_s,
            gravity_n: robot.gravity_m_per_s2 * robot.mass_kg,
            center_of_mass_m: robot.center_of_mass_m,
        })
    }

    /// How many cables the robot has.
    #[must_use]
    pub fn cable_count(&self) -> usize {
        self.cable_count
    }

    /// Back to the state after set-up: at rest, nothing stored, no pose.
    pub fn reset(&mut self) {
        self.state = Self::START;
    }

    /// A copy of everything that a cycle leaves for the next.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot<CABLES> {
        Snapshot(self.state)
    }

    /// Goes on from a snapshot as if nothing had happened since.
    pub fn restore(&mut self, snapshot: &Snapshot<CABLES>) {
        self.state = snapshot.0;
    }

    /// One cycle: total over all inputs, allocation-free, panic-free.
    #[inline]
    pub fn step(&mut self, input: &CycleInput<CABLES>) -> CycleOutput<CABLES> {
        let mut output = CycleOutput::default();
        self.step_into(input, &mut output);
        output
    }

    /// [`step`](Self::step) into an output that the caller keeps.
    pub fn step_into(&mut self, input: &CycleInput<CABLES>, output: &mut CycleOutput<CABLES>) {
        let pose = input.pose.as_ref().filter(|pose| pose.is_usable());
        let rotation = pose.map(|pose| pose.orientation.to_rotation_matrix().into_inner());
        let mut forces_n = [0.0; CABLES];
        let mut wrench_status = CableStatus::OK;
        self.state.last_cycle = self.state.cycle;
        self.state.cycle = next_cycle(self.state.last_cycle, input.elapsed_cycles);
        let blocks = CABLES.div_ceil(LANES).min(self.cable_count.div_ceil(LANES));
        for block in 0..blocks {
            let pose_flags = match (pose, &rotation) {
                (Some(pose), Some(rotation)) if self.any_geometry => self.follow_pose(block, pose, rotation),
                _ => PoseFlags { missing: self.misses_pose(block).bits(), unreachable: 0 },
            };
            let (platform_n, status) = if self.features.has_effects() {
                self.step_block_with_effects(block, input, output, pose_flags)
            } else {
                self.step_block::<false>(block, input, output, pose_flags)
            };
            platform_n.store(&mut forces_n, block);
            wrench_status = wrench_status | status;
        }
        for place in output.cables.iter_mut().skip(self.cable_count) {
            *place = CableOutput::default();
        }
        if pose.is_some() && !self.state.directions_known {
            let known = self.state.columns.direction_known.iter().take(self.cable_count).all(|&known| known > 0.0);
            self.state.directions_known = self.all_geometry && known;
        }
        if let Some(pose) = pose.filter(|_| self.state.directions_known) {
            let torque_nm = (pose.orientation * self.center_of_mass_m).cross(&self.gravity_n);
            self.state.gravity = Some(Wrench { force_n: self.gravity_n, torque_nm });
        }
        let columns = &self.state.columns;
        let along = |row: &[f64; CABLES]| {
            let products = (0..blocks).map(|block| Lanes::load(row, block) * Lanes::load(&forces_n, block));
            -products.fold(Lanes::splat(0.0), |sum, product| sum + product).sum()
        };
        output.outside_wrench = self.state.gravity.map(|_| Wrench {
            force_n: columns.direction.each_ref().map(along).into(),
            torque_nm: columns.moment_arm_m.each_ref().map(along).into(),
        });
        output.applied_wrench =
            output.outside_wrench.zip(self.state.gravity).map(|(outside, gravity)| outside - gravity);
        output.wrench_status = wrench_status;
    }

    /// Friction stored at each pulley of a cable (from the winch), N: the distribution along the cable.
    ///
    /// Coulomb part, without viscous friction; all zero with `lumped` presliding, which knows no pulleys. Entries past
    /// the cable's pulleys, and cables that the robot does not have, are zero.
    #[must_use]
    pub fn pulley_friction_n(&self, cable: usize) -> [f64; MAX_PULLEYS] {
        let places = self.params.pulley_place.get(cable).copied().unwrap_or([PLACES; MAX_PULLEYS]);
        let columns = &self.state.columns.pulley_friction_n;
        places.map(|place| columns.get(place).and_then(|column| column.get(cable)).copied().unwrap_or(0.0))
    }

    /// The structure matrix `A^T` of the last cycle with a pose, force rows first; columns past the robot's cables are zero.
    /// `None` before the first pose, and for a robot with a cable whose attachment is not given.
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

    /// Which cables of a block suffer from a cycle without a pose: those whose wrap follows it, and, once there has
    /// been a wrench, all that it is made of.
    #[inline(always)]
    fn misses_pose(&self, block: usize) -> LanesMask {
        let stale_wrench = LanesMask::splat(self.state.gravity.is_some());
        self.params.follows_pose(block).or(stale_wrench.and(self.params.with_geometry(block)))
    }
}

/// What a pose means for the lanes of a block.
#[derive(Clone, Copy)]
struct PoseFlags {
    missing: u32,
    unreachable: u32,
}

impl<const CABLES: usize> Compensator<CABLES> {
    /// Wrap, direction and moment arm of a block's cables at a pose; kept where the pose leaves a cable no way out.
    #[inline(always)]
    fn follow_pose(&mut self, block: usize, pose: &Pose, rotation: &Matrix3<f64>) -> PoseFlags {
        let (attachment_m, [ax, ay, az]) = platform::attachment(pose, rotation, self.params.platform_m(block));
        let exit = swivel::exit(&self.params.swivel(block), attachment_m);
        let with_geometry = self.params.with_geometry(block);
        let moves = exit.reachable.and(with_geometry);
        let [ux, uy, uz] = exit.direction;
        let moment_arm_m = [ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux];
        let columns = &mut self.state.columns;
        let all_move = moves.all();
        let keep = |column: &mut [f64; CABLES], value: Lanes| {
            let value = if all_move { value } else { Lanes::select(moves, value, Lanes::load(column, block)) };
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
            keep(&mut columns.direction_known, Lanes::splat(1.0));
        }
        if self.features.traction {
            let traction_mu = Lanes::load(&self.params.traction_mu, block).to_array();
            let [cos, sin] = exit.cos_sin_wrap.map(Lanes::to_array);
            // Only robots with a slip limit pay for an angle, an exponential a cable.
            let wraps_rad = cos.into_iter().zip(sin).map(|(cos, sin)| swivel::wrap_rad([cos, sin]));
            let mut ratio = [0.0; LANES];
            for ((ratio, mu), wrap_rad) in ratio.iter_mut().zip(traction_mu).zip(wraps_rad) {
                *ratio = traction_ratio(mu, wrap_rad);
            }
            let limited = Lanes::splat(0.0).lt(Lanes::new(traction_mu));
            let ratio = Lanes::select(limited, Lanes::new(ratio), Lanes::splat(NO_SLIP));
            keep(&mut columns.pose_traction_ratio, ratio);
        }
        PoseFlags { missing: 0, unreachable: with_geometry.and(exit.reachable.not()).bits() }
    }

    /// [`step_block`](Self::step_block) with effects: a function of its own, so that the cycle without does not pay for it.
    #[inline(never)]
    fn step_block_with_effects(
        &mut self,
        block: usize,
        input: &CycleInput<CABLES>,
        output: &mut CycleOutput<CABLES>,
        pose_flags: PoseFlags,
    ) -> (Lanes, CableStatus) {
        self.step_block::<true>(block, input, output, pose_flags)
    }

    /// Signals, friction and status of a block's cables; gives their forces at the platform and every flag of any of them.
    #[inline(always)]
    fn step_block<const EFFECTS: bool>(
        &mut self,
        block: usize,
        input: &CycleInput<CABLES>,
        output: &mut CycleOutput<CABLES>,
        pose_flags: PoseFlags,
    ) -> (Lanes, CableStatus) {
        let first = block * LANES;
        let cables: [CableInput; LANES] =
            core::array::from_fn(|lane| input.cables.get(first + lane).copied().unwrap_or_default());
        let raw = RawSignals {
            sensor_force_n: Lanes::new(cables.map(|cable| cable.sensor_force_n)),
            length_m: Lanes::new(cables.map(|cable| cable.length_m)),
            speed_m_per_s: Lanes::new(cables.map(|cable| cable.speed_m_per_s)),
        };
        let columns = &mut self.state.columns;
        let mut signals = columns.signals(block);
        let mut conditioned = condition(&self.limits, &mut signals, &raw, input.elapsed_cycles);
        columns.set_signals(block, &signals);
        let moment = Moment::new(Lanes::splat(self.state.cycle), Lanes::splat(self.state.last_cycle), self.cycle_s);
        if self.features.acting.has(time_delay::ACTS) {
            let moves = conditioned.moves().bits();
            let in_order = if input.elapsed_cycles > 1.0 { 0 } else { moves };
            let delay: [_; LANES] =
                core::array::from_fn(|lane| self.params.delay.get(first + lane).copied().unwrap_or_default());
            let Conditioned { displacement_m, speed_m_per_s, length_m, .. } = &mut conditioned;
            let known_m = *displacement_m;
            *displacement_m = shift_block(&mut columns.delayed_displacement_m, first, known_m, in_order, delay);
            *speed_m_per_s = shift_block(&mut columns.delayed_speed_m_per_s, first, *speed_m_per_s, in_order, delay);
            let lag_m = Lanes::load(&columns.lag_m, block) + (known_m - *displacement_m);
            let lag_m = lead_block(&columns.delayed_displacement_m, first, lag_m, delay);
            lag_m.store(&mut columns.lag_m, block);
            *length_m = *length_m - lag_m;
        }
        let model = self.params.model(block);
        let mut cable = BlockOfCables::new(&self.params, columns, block, self.place_count);
        let signals = conditioned.signals();
        let forces = cable_cycle(&model, self.features.limited_to::<EFFECTS>(), &signals, &moment, &mut cable);

        let Conditioned { sensor_force_n, speed_m_per_s, sensor_finite, frozen, jump, motion_finite, .. } = conditioned;
        let CableSignals { hold, sensor_fault, .. } = signals;
        let out_of_range = sensor_force_n
            .lt(Lanes::load(&self.params.least_force_n, block))
            .or(Lanes::load(&self.params.greatest_force_n, block).lt(sensor_force_n))
            .or(Lanes::load(&self.params.greatest_speed_m_per_s, block).lt(speed_m_per_s.abs()));
        let any_flag =
            hold.or(forces.slack).or(forces.slip).or(out_of_range).bits() | pose_flags.missing | pose_flags.unreachable;
        let flags = || {
            [
                (CableStatus::SLACK, forces.slack.and(sensor_fault.not()).bits()),
                (CableStatus::SLIP, forces.slip.bits()),
                (CableStatus::SENSOR_NOT_FINITE, sensor_finite.not().bits()),
                (CableStatus::SENSOR_FROZEN, frozen.bits()),
                (CableStatus::LENGTH_JUMP, jump.bits()),
                (CableStatus::MOTION_NOT_FINITE, motion_finite.not().bits()),
                (CableStatus::OUT_OF_RANGE, out_of_range.bits()),
                (CableStatus::POSE_MISSING, pose_flags.missing),
                (CableStatus::POSE_UNREACHABLE, pose_flags.unreachable),
            ]
        };
        let present = self.cable_count.saturating_sub(first);
        let mut status = [CableStatus::OK; LANES];
        let mut of_all = CableStatus::OK;
        if any_flag != 0 {
            for (flag, bits) in flags() {
                for (lane, status) in status.iter_mut().enumerate().take(present) {
                    *status = *status | flag.if_set(bits, lane);
                    of_all = of_all | *status;
                }
            }
        }
        let platform_n = forces.platform_force_n;
        let values =
            platform_n.to_array().into_iter().zip(forces.friction_n.to_array()).zip(forces.frictionless_n.to_array());
        let places = output.cables.iter_mut().skip(first).take(present).zip(values.zip(status));
        for (place, (((force_at_platform_n, friction_n), frictionless_n), status)) in places {
            *place = CableOutput { force_at_platform_n, friction_n, frictionless_n, status };
        }
        (platform_n, of_all)
    }
}

/// How far the delayed motion lags behind, m: summed up, but for a lead, which is what is extrapolated now. Summed up,
/// it would keep what was not extrapolated around a fault.
fn lead_block<const CABLES: usize>(
    lines: &[DelayLine; CABLES],
    first: usize,
    summed_m: Lanes,
    delays: [Delay; LANES],
) -> Lanes {
    let mut lag_m = summed_m.to_array();
    for ((lag_m, line), delay) in lag_m.iter_mut().zip(lines.iter().skip(first)).zip(delays) {
        if delay.leads() {
            *lag_m = line.lag(delay);
        }
    }
    Lanes::new(lag_m)
}

/// One cycle of a block's delay lines.
fn shift_block<const CABLES: usize>(
    lines: &mut [DelayLine; CABLES],
    first: usize,
    values: Lanes,
    in_order: u32,
    delays: [Delay; LANES],
) -> Lanes {
    let mut values = values.to_array();
    let of_lanes = lines.iter_mut().skip(first).zip(&mut values).zip(delays);
    for (lane, ((line, value), delay)) in of_lanes.enumerate() {
        *value = line.shift(*value, in_order >> lane & 1 == 1, delay);
    }
    Lanes::new(values)
}
