//! One robot over a few ten thousand cycles, and what is checked of it.

use fric_core::effects::{Effect, Memory};
use fric_core::robot::{MonitorOptions, Presliding};
use fric_core::{CableInput, CableParams, CableStatus, Compensator, CycleInput, CycleOutput, Pose};

use super::Tally;
use super::bound::{chain_growth, effect, greatest_mu, sensor_cos};
use super::fault::{CycleFault, Faults};
use super::motion::{Motion, RECOVERY_CYCLES};
use super::robot::{Robot, once_in};
use super::watch::{FAULTY, Watch};
use crate::bits::bits;
use crate::random::Random;

/// Cables of the largest robot.
pub const MOST_CABLES: usize = 8;
/// Cycles of an episode, at least.
pub const EPISODE_CYCLES: u64 = 20_000;
/// How near to the undisturbed twin a cable has to come, relative to the greater of 1 N and the force.
const RECOVERED: f64 = 1e-6;

/// A compensator and the watches over its cables.
#[derive(Clone)]
struct Watched {
    compensator: Compensator<MOST_CABLES>,
    watches: Vec<Watch>,
    /// Cycles since the first, as the compensator was told.
    cycles: f64,
}

impl Watched {
    fn step(&mut self, input: &CycleInput<MOST_CABLES>, cycle_s: f64) -> Result<CycleOutput<MOST_CABLES>, String> {
        let output = self.compensator.step(input);
        let time_s = self.cycles * cycle_s;
        for (cable, watch) in self.watches.iter_mut().enumerate() {
            let pulleys = watch.wants_pulleys().then(|| self.compensator.pulley_friction_n(cable));
            let signals = (&input.cables[cable], input.elapsed_cycles);
            watch.check(signals, time_s, &output.cables[cable], pulleys).map_err(|problem| {
                format!("cable {cable}: {problem}; {:?} from {:?}", output.cables[cable], input.cables[cable])
            })?;
        }
        for wrench in [output.outside_wrench, output.applied_wrench].into_iter().flatten() {
            if !wrench.to_vector().iter().all(|part| part.is_finite()) {
                return Err(format!("{wrench:?}"));
            }
        }
        Ok(output)
    }
}

/// One robot's run.
pub struct Episode {
    robot: Robot,
    random: Random,
    motions: Vec<Motion>,
    /// The way over which each cable forgets, on the way back that has begun.
    memories_m: Vec<f64>,
    /// Which cables come back straight, see [`comes_straight`].
    straight: Vec<bool>,
    /// Whether a cable's friction or sensor depends on how long the run has lasted.
    drifts: Vec<bool>,
    pose: Option<Pose>,
    base: Watched,
    /// On the way back: how far what each cable stores was from what its twin does, N, contact by contact.
    apart_n: [Option<f64>; MOST_CABLES],
    tally: Tally,
}

impl Episode {
    pub fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let robot = Robot::new(&mut random);
        let monitor = &robot.monitor;
        let motion =
            |_: &CableParams| Motion::new(&mut random, robot.cycle_s, monitor.length_jump_m, monitor.length_noise_m);
        let motions: Vec<Motion> = robot.cables.iter().map(motion).collect();
        let watches = robot.cables.iter().map(|cable| Watch::new(&robot, cable)).collect();
        let straight = robot.cables.iter().map(|cable| comes_straight(cable, monitor)).collect();
        let of_time = |cable: &CableParams| acting(cable).any(|effect| effect.row().goes_by_time);
        let drifts = robot.cables.iter().map(of_time).collect();
        let base = Watched { compensator: robot.compensator(), watches, cycles: 0.0 };
        Self {
            robot,
            random,
            motions,
            memories_m: Vec::new(),
            straight,
            drifts,
            pose: None,
            base,
            apart_n: [None; MOST_CABLES],
            tally: Tally::default(),
        }
    }

    pub fn run(mut self) -> Result<Tally, String> {
        while self.tally.cycles < EPISODE_CYCLES {
            let cycles = 100 + self.random.below(2000);
            for _ in 0..cycles {
                let input = self.any_input();
                let output = self.step_base(&input)?;
                believe(&output)?;
            }
            self.disturb()?;
        }
        Ok(self.tally)
    }

    fn any_input(&mut self) -> CycleInput<MOST_CABLES> {
        let Self { random, motions, .. } = self;
        let mut cables = [CableInput::default(); MOST_CABLES];
        for (place, motion) in cables.iter_mut().zip(motions) {
            *place = motion.any(random);
        }
        if once_in(random, 50) {
            self.pose = Some(random.pose(0.3));
        }
        CycleInput { cables, pose: self.pose, ..CycleInput::default() }
    }

    fn step_base(&mut self, input: &CycleInput<MOST_CABLES>) -> Result<CycleOutput<MOST_CABLES>, String> {
        let output = self.base.step(input, self.robot.cycle_s);
        self.base.cycles += 1.0;
        self.tally.cycles += 1;
        let output = output.map_err(|problem| format!("undisturbed: {problem}"))?;
        self.tally.flags |= output.wrench_status.bits();
        Ok(output)
    }

    /// Faults for a while, then the way back, beside a twin without faults.
    fn disturb(&mut self) -> Result<(), String> {
        let count = self.robot.cables.len();
        let cycles = 1 + u32::try_from(self.random.below(300)).unwrap();
        let mut faults = Faults::new(&mut self.random, count, cycles);
        let mut spoilt = self.base.clone();
        let (mut pending, mut late) = (0.0, None);
        self.tally.faults += faults.cables.len() as u64 + u64::from(faults.cycle.is_some());
        // What a delay line or the smoothing of a sensor's lag has been fed is gone before the way back begins.
        let settle =
            8 + self.robot.cables.iter().map(|cable| settling_cycles(cable, self.robot.cycle_s)).max().unwrap_or(0);
        for cycle in 0..cycles + settle + RECOVERY_CYCLES {
            let stroke = cycle.checked_sub(cycles + settle);
            if stroke == Some(0) {
                self.memories_m = self.memories_m(&spoilt.compensator);
            }
            let input = match stroke {
                None => self.any_input(),
                Some(stroke) => self.stroke_input(stroke),
            };
            let expected = self.step_base(&input)?;
            believe(&expected)?;

            let mut bad = input;
            faults.spoil(cycle, &mut bad);
            let fault = faults.of_cycle(cycle);
            if matches!(fault, Some(CycleFault::Late)) {
                bad = late.unwrap_or(bad);
            }
            late = Some(input);
            if matches!(fault, Some(CycleFault::SkippedTold | CycleFault::Skipped)) {
                pending += f64::from(u8::from(matches!(fault, Some(CycleFault::SkippedTold))));
                continue;
            }
            bad.elapsed_cycles = 1.0 + pending;
            spoilt.cycles += pending;
            pending = 0.0;
            let output = spoilt.step(&bad, self.robot.cycle_s);
            spoilt.cycles += 1.0;
            self.tally.cycles += 1;
            let output = output.map_err(|problem| format!("{:?} {:?}: {problem}", faults.cables, faults.cycle))?;
            self.tally.flags |= output.wrench_status.bits();
            let compared = self.compare(&faults, stroke, &spoilt.compensator, (&output, &expected));
            compared.map_err(|problem| {
                format!("{:?} {:?}, cycle {cycle} of {cycles}: {problem}", faults.cables, faults.cycle)
            })?;
        }
        if once_in(&mut self.random, 2) {
            self.base = spoilt;
        }
        Ok(())
    }

    /// What the contacts store is tension in the chain, and so load: the more a lying sensor has made of it, the longer the way back.
    fn memories_m(&self, spoilt: &Compensator<MOST_CABLES>) -> Vec<f64> {
        let of_cable = |(cable, (params, motion)): (usize, (&CableParams, &Motion))| {
            let stored_n: f64 = spoilt.pulley_friction_n(cable).iter().map(|friction_n| friction_n.abs()).sum();
            memory_m(params, motion.greatest_force_n() + stored_n)
        };
        self.robot.cables.iter().zip(&self.motions).enumerate().map(of_cable).collect()
    }

    fn stroke_input(&mut self, stroke: u32) -> CycleInput<MOST_CABLES> {
        let Self { random, motions, memories_m, .. } = self;
        let mut cables = [CableInput::default(); MOST_CABLES];
        for ((place, motion), memory_m) in cables.iter_mut().zip(motions).zip(memories_m) {
            *place = motion.stroke(random, stroke, *memory_m);
        }
        CycleInput { cables, pose: self.pose, ..CycleInput::default() }
    }

    /// Neighbours have the twin's bits; a cable that was disturbed comes back to it.
    fn compare(
        &mut self,
        faults: &Faults,
        stroke: Option<u32>,
        spoilt: &Compensator<MOST_CABLES>,
        (output, expected): (&CycleOutput<MOST_CABLES>, &CycleOutput<MOST_CABLES>),
    ) -> Result<(), String> {
        for (cable, params) in self.robot.cables.iter().enumerate() {
            let (one, other) = (&output.cables[cable], &expected.cables[cable]);
            if !faults.touch(cable) {
                if bits(one) != bits(other) {
                    return Err(format!("cable {cable} heard of it: {one:?} beside {other:?}"));
                }
                continue;
            }
            let Some(stroke) = stroke else { continue };
            if one.status.intersects(FAULTY) {
                return Err(format!("cable {cable} is still flagged {}", one.status));
            }
            let lost_time = matches!(faults.cycle.map(|spell| spell.fault), Some(CycleFault::Skipped));
            // A wrap that was missed, and cannot be had any more; a clock that is behind.
            let is_elsewhere = (one.status | other.status).intersects(CableStatus::POSE_UNREACHABLE);
            if is_elsewhere || (lost_time && self.drifts[cable]) {
                continue;
            }
            let distance_n = (one.force_at_platform_n - other.force_at_platform_n).abs();
            let scale_n = other.force_at_platform_n.abs().max(1.0);
            if stroke + 1 == RECOVERY_CYCLES && self.reaches(cable) {
                self.tally.recoveries += 1;
                if distance_n > RECOVERED * scale_n {
                    return Err(format!("cable {cable} is {distance_n} N from where it would be: {params:?}"));
                }
            }
            let apart_n = match params.presliding() {
                Presliding::Lumped => distance_n,
                Presliding::PerPulley => {
                    let stored_n = |of: &Compensator<MOST_CABLES>| of.pulley_friction_n(cable);
                    chain_distance_n(stored_n(spoilt), stored_n(&self.base.compensator))
                }
            };
            // And a slack cable does not show what it stores.
            let is_slack = (one.status | other.status).intersects(CableStatus::SLACK);
            let is_told = self.straight[cable] && !is_slack;
            let reference_n = self.apart_n[cable].filter(|_| stroke > 0 && is_told);
            // One contact only comes nearer. In a chain, what a pulley stores is load of those behind it and of itself, and counts
            // more at a sensor pulley, the less it is wrapped.
            let (of_last, most) = match params.presliding() {
                Presliding::Lumped => (true, 1.0 + 1e-9),
                Presliding::PerPulley => (false, chain_growth(params).max(2.0) * sensor_share(params)),
            };
            if reference_n.is_some_and(|reference_n| apart_n > reference_n * most + 1e-9 * scale_n) {
                return Err(format!(
                    "cable {cable} goes away again, cycle {stroke} of the way back: from {reference_n:?} N to {apart_n} N"
                ));
            }
            if of_last || stroke == 0 {
                self.apart_n[cable] = is_told.then_some(apart_n);
            }
        }
        Ok(())
    }

    /// Whether the strokes are long enough for a cable's memory within what counts as motion.
    fn reaches(&self, cable: usize) -> bool {
        self.memories_m[cable] < 10.0 * self.robot.monitor.length_jump_m
    }
}

/// Good signals are believed.
fn believe(output: &CycleOutput<MOST_CABLES>) -> Result<(), String> {
    match output.cables.iter().find(|cable| cable.status.intersects(FAULTY)) {
        Some(cable) => Err(format!("good signals are flagged {}", cable.status)),
        None => Ok(()),
    }
}

/// How far what the contacts of two chains store is apart, N.
fn chain_distance_n(one_n: [f64; 8], other_n: [f64; 8]) -> f64 {
    one_n.into_iter().zip(other_n).map(|(one_n, other_n)| (one_n - other_n).abs()).sum()
}

/// Whether nothing but stored friction tells a cable from its twin, so that it can only come nearer. With play in the length the two
/// do not move alike until both have been pushed to the same edge.
fn comes_straight(cable: &CableParams, monitor: &MonitorOptions) -> bool {
    let is_other = |effect: &Effect| {
        effect.row().memory != Memory::Nothing
            || matches!(effect, Effect::TimeDelay | Effect::PulleyEccentricity | Effect::PulleyEccentricity2)
    };
    monitor.length_noise_m == 0.0 && cable.traction_mu().is_none() && !acting(cable).any(|effect| is_other(&effect))
}

/// The effects of the catalogue that act.
fn acting(cable: &CableParams) -> impl Iterator<Item = Effect> {
    Effect::CATALOGUE.iter().copied().filter(|effect| acts(cable, *effect))
}

fn acts(cable: &CableParams, effect: Effect) -> bool {
    let values = cable.values();
    let mut parameters = effect.places().zip(effect.row().parameters);
    parameters.any(|(place, parameter)| values[place].to_bits() != parameter.neutral.to_bits())
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some cycles")]
fn settling_cycles(cable: &CableParams, cycle_s: f64) -> u32 {
    let delay_s = effect(cable, "time_delay", "delay_s").max(0.0);
    // From 10⁹ N to 10⁻⁶ N, smoothed twice: `(1 + 41)·e^(−41)` is below 10⁻¹⁵.
    let smoothed_s =
        if acts(cable, Effect::SensorLag) { 41.0 * effect(cable, "sensor_lag", "smoothing_s") } else { 0.0 };
    ((delay_s + smoothed_s) / cycle_s).ceil() as u32
}

/// The way over which a cable forgets to 1/e at a force, amply.
fn memory_m(cable: &CableParams, force_n: f64) -> f64 {
    let sigma_n_per_m = cable.friction().sigma_n_per_m.unwrap();
    let gain = effect(cable, "sensor_gain", "gain");
    let corrected_n = (force_n + 5.0) / gain.min(1.0);
    let of_load_m = cable.memory_m_per_n(greatest_mu(cable).min(0.5), sigma_n_per_m) * corrected_n;
    #[expect(clippy::cast_precision_loss, reason = "a handful")]
    let of_drag_m = cable.pulley_count() as f64 * effect(cable, "bearing_drag", "drag_n") / sigma_n_per_m;
    let nonlinear = if acts(cable, Effect::LoadNonlinearity) { 4.0 } else { 1.0 };
    let of_age_m = if acts(cable, Effect::DwellStiction) { effect(cable, "dwell_stiction", "distance_m") } else { 0.0 };
    // What moves the winch through its play moves no cable.
    2.0 * sensor_share(cable) * (nonlinear * of_load_m + of_drag_m)
        + of_age_m
        + effect(cable, "gear_backlash", "play_m")
}

/// How often what rubs at the sensor pulley counts in the tension, at least once: the more, the less it is wrapped.
fn sensor_share(cable: &CableParams) -> f64 {
    let cos = sensor_cos(cable);
    (cos.abs() / (1.0 - cos)).max(1.0)
}
