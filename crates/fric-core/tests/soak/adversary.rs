//! An adversary at the force sensors: spikes of all sizes, 0.1 N to 10⁹ N up and down, over 1 to 1000 cycles, also behind drop-outs, beside a twin without
//! spikes. Loads rest now and then, and a third of the sensors has coarse steps, so that values repeat.
//!
//! | invariant | statement |
//! |---|---|
//! | told | while a cable's force is off by more than 5 % + 0.1 N of the twin's, some flag of it is up |
//! | believed | the twin has no `SENSOR_JUMP`, and is `UNSETTLED` only where it has stored more than `Σμk_j·T` |
//!
//! With `cable_elasticity` the play of the stretch may stay off by 3·`play_n`·`compliance_m_per_n`·σ, which is left out.
//! What no signal shows is counted and left out, from its first cycle until, after its last, the force and what each pulley stores have come back to
//! the twin's (both being slack is not coming back: the force is then 0 whatever is stored):
//! - a spike of no more than [`greatest_change_n`], which is what the cable can do, or up to 11 times that after ten cycles without a new value. The twin's
//!   own force changes by at most 0.6 of that in a cycle;
//! - a spike that begins while an earlier jump persists and, to within that limit, cancels it or leads back to the force before it ([`Jumps`]);
//! - what the twin has stored beyond its load during a spike: the twin itself is `UNSETTLED` then.

use fric_core::robot::{MonitorOptions, Presliding};
use fric_core::{CableInput, CableParams, CableStatus, CycleInput, Pose};

use super::bound::{amplitudes, effect, greatest_mu_at, sensor_cos};
use super::motion::Motion;
use super::robot::{Robot, magnitude, once_in};
use crate::random::Random;

/// Longest drop-out, of the twin too: in these cycles its load changes by less than it may after ten.
const MOST_DROPPED: f64 = 18.0;
/// Cycles of an episode.
const CYCLES: u64 = 20_000;

/// What was seen.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Cycles of a cable beside its twin.
    pub cycles: u64,
    /// Spikes, and those among them that no signal shows.
    pub spikes: u64,
    pub hidden: u64,
    /// Cycles of a cable in which its force was off, and in which that was left out.
    pub off: u64,
    pub left_out: u64,
    /// Cycles of a twin that were flagged without a reason.
    pub false_flags: u64,
    /// Cycles of a twin that had stored more than the load bears, flagged.
    pub unsettled: u64,
}

impl Tally {
    pub fn add(&mut self, other: &Self) {
        self.cycles += other.cycles;
        self.spikes += other.spikes;
        self.hidden += other.hidden;
        self.off += other.off;
        self.left_out += other.left_out;
        self.false_flags += other.false_flags;
        self.unsettled += other.unsettled;
    }
}

/// The greatest change of a sensor force (N) in a cycle that is no jump, written from the robot file's description.
fn greatest_change_n(cable: &CableParams, monitor: &MonitorOptions, force_n: f64) -> f64 {
    let [lag_s, smoothing_s] = ["time_constant_s", "smoothing_s"].map(|key| effect(cable, "sensor_lag", key));
    // What 10 m/s cover.
    let cycle_s = monitor.length_jump_m / 10.0;
    let share = (cycle_s / smoothing_s).min(1.0);
    let shown = (cycle_s / lag_s).min(1.0) / (2.0 * share - share * share);
    let shown = if lag_s > 0.0 { shown.min(1.0) } else { 1.0 };
    let is_bent = effect(cable, "sensor_nonlinearity", "curvature_per_n") != 0.0;
    let shown = if is_bent { 0.5 * shown } else { shown };
    let default_n = shown * cable.friction().sigma_n_per_m.unwrap() * monitor.length_jump_m / 20.0;
    let tolerated_n = shown * (0.05 * force_n + 0.1 * (1.0 - sensor_cos(cable)));
    monitor.sensor_jump_n.unwrap_or(default_n).max(tolerated_n)
}

/// One cable's true force and what is done to it.
struct Line {
    motion: Motion,
    base_n: f64,
    force_n: f64,
    target_n: f64,
    /// The sensor's step, N; 0 without one.
    step_n: f64,
    /// Cycles for which the force stays.
    rest_cycles: u64,
    /// Cycles until the next spike begins, or this one ends, and those of a drop-out before the spike.
    cycles_left: u64,
    dropped_cycles: u64,
    /// Cycles in which the sensor has shown nothing new.
    silent_cycles: f64,
    spike: Option<Spike>,
    jumps: Jumps,
    /// A spike that no signal shows stands, or has left something.
    hidden: bool,
}

/// The jumps that a sensor shows, written from the description of `SENSOR_JUMP`.
#[derive(Default)]
struct Jumps {
    from_n: f64,
    sum_n: f64,
    cycles_left: f64,
}

impl Jumps {
    /// Enters the force of a cycle; whether it looks like the end of an earlier jump. The limits are those of a jump that persists, and without one.
    fn enter(&mut self, [last_n, force_n]: [f64; 2], [limit_n, first_n]: [f64; 2], cycle_s: f64) -> bool {
        let persists = self.cycles_left > 0.0;
        self.cycles_left -= 1.0;
        let change_n = force_n - last_n;
        if change_n.is_nan() || change_n.abs() <= if persists { limit_n } else { first_n } {
            return false;
        }
        if !persists {
            (self.from_n, self.sum_n) = (last_n, 0.0);
        }
        let is_back = (self.sum_n + change_n).abs() <= limit_n || (force_n - self.from_n).abs() <= limit_n;
        if persists && is_back {
            self.cycles_left = 0.0;
            return true;
        }
        // A jump that is only partly taken back persists for its whole time.
        let is_part = persists && change_n * self.sum_n < 0.0;
        (self.from_n, self.sum_n) = if is_part { (f64::NAN, f64::NAN) } else { (self.from_n, self.sum_n + change_n) };
        self.cycles_left = 5.0 / cycle_s;
        false
    }
}

#[derive(Clone, Copy)]
enum Spike {
    More(f64),
    Shows(f64),
}

impl Line {
    fn new(random: &mut Random, robot: &Robot, cable: &CableParams) -> Self {
        let monitor = &robot.monitor;
        let motion = Motion::new(random, robot.cycle_s, monitor.length_jump_m, monitor.length_noise_m);
        let base_n = magnitude(random, 2.0, 50.0);
        let cycles_left = 500 + random.below(1000);
        let step_n = (0.2 * greatest_change_n(cable, monitor, 0.0)).min(0.02 * base_n);
        Self {
            motion,
            base_n,
            force_n: base_n,
            target_n: base_n,
            step_n: if once_in(random, 3) { step_n } else { 0.0 },
            rest_cycles: 0,
            cycles_left,
            dropped_cycles: 0,
            silent_cycles: 0.0,
            spike: None,
            jumps: Jumps::default(),
            hidden: false,
        }
    }

    fn step(&mut self, random: &mut Random, cable: &CableParams, monitor: &MonitorOptions) -> CableInput {
        let mut input = self.motion.any(random);
        if once_in(random, 400) {
            self.target_n = match random.below(8) {
                0 => -0.5,
                1 => 0.1 * self.base_n,
                _ => self.base_n * random.range(0.5, 2.0),
            };
        }
        let most_n = 0.4 * greatest_change_n(cable, monitor, self.force_n.max(0.0));
        let wanted_n = 0.01 * (self.target_n - self.force_n) + 0.02 * self.base_n * random.range(-1.0, 1.0);
        if self.rest_cycles == 0 && once_in(random, 1000) {
            self.rest_cycles = cycles(random, 500.0);
        }
        self.rest_cycles = self.rest_cycles.saturating_sub(1);
        let noise_n = if self.step_n > 0.0 { 0.0 } else { (0.1 * most_n).min(0.01) };
        let noise_n = random.range(-noise_n, noise_n);
        if self.rest_cycles == 0 {
            self.force_n += wanted_n.clamp(-most_n, most_n);
        }
        input.sensor_force_n =
            if self.step_n > 0.0 { (self.force_n / self.step_n).round() * self.step_n } else { self.force_n + noise_n };
        input
    }

    /// Spoils the sensor force; whether a spike begins.
    fn spoil(
        &mut self,
        random: &mut Random,
        (last_n, force_n): (f64, &mut f64),
        cable: &CableParams,
        monitor: &MonitorOptions,
    ) -> Option<bool> {
        let mut begins = None;
        if self.cycles_left == 0 {
            if self.spike.take().is_none() {
                let size_n = magnitude(random, 0.1, 1e9) * if once_in(random, 2) { 1.0 } else { -1.0 };
                self.spike = Some(if once_in(random, 3) { Spike::Shows(size_n) } else { Spike::More(size_n) });
                self.cycles_left = cycles(random, 1000.0);
                begins = Some(false);
            } else {
                self.cycles_left = 50 + random.below(3000);
                self.dropped_cycles = if once_in(random, 4) { cycles(random, MOST_DROPPED) } else { 0 };
            }
        }
        self.cycles_left -= 1;
        if let Some(spike) = self.spike {
            let shown_n = match spike {
                Spike::More(more_n) => *force_n + more_n,
                Spike::Shows(value_n) => value_n,
            };
            if let Some(hidden) = &mut begins {
                let most_n = self.silence() * greatest_change_n(cable, monitor, shown_n.min(last_n));
                *hidden = (shown_n - last_n).abs() <= most_n;
            }
            *force_n = shown_n;
        }
        begins
    }

    /// How many times as much a force may change after the cycles without a new value.
    fn silence(&self) -> f64 {
        1.0 + self.silent_cycles.min(10.0)
    }
}

/// A number of cycles, small ones as often as great ones.
fn cycles(random: &mut Random, most: f64) -> u64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundreds")]
    let cycles = magnitude(random, 1.0, most).round() as u64;
    cycles
}

/// One robot and its twin.
pub fn episode(seed: u64) -> Result<Tally, String> {
    let mut random = Random::new(seed);
    let robot = Robot::new(&mut random);
    let monitor = robot.monitor;
    let mut lines: Vec<Line> = robot.cables.iter().map(|cable| Line::new(&mut random, &robot, cable)).collect();
    let (mut twin, mut spoilt) = (robot.compensator(), robot.compensator());
    let cable = |index: usize| &robot.cables[index];
    let mut tally = Tally::default();
    let mut pose: Option<Pose> = None;
    let mut shown_n: Vec<f64> = lines.iter().map(|line| line.force_n).collect();
    for cycle in 0..CYCLES / robot.cables.len() as u64 {
        if once_in(&mut random, 50) {
            pose = Some(random.pose(0.3));
        }
        let mut good = CycleInput { pose, ..CycleInput::default() };
        for ((place, line), cable) in good.cables.iter_mut().zip(&mut lines).zip(&robot.cables) {
            *place = line.step(&mut random, cable, &monitor);
        }
        for (place, line) in good.cables.iter_mut().zip(&lines) {
            // In the cycles before the next spike.
            if line.spike.is_none() && (1..=line.dropped_cycles).contains(&line.cycles_left) {
                place.sensor_force_n = f64::NAN;
            }
        }
        let mut bad = good;
        for (index, line) in lines.iter_mut().enumerate() {
            let force_n = &mut bad.cables[index].sensor_force_n;
            let begins = line.spoil(&mut random, (shown_n[index], force_n), cable(index), &monitor);
            let limit_n = greatest_change_n(cable(index), &monitor, force_n.min(shown_n[index]));
            let looks_like_an_end =
                line.jumps.enter([shown_n[index], *force_n], [limit_n, line.silence() * limit_n], robot.cycle_s);
            if let Some(is_small) = begins {
                let hidden = is_small || looks_like_an_end;
                tally.spikes += 1;
                tally.hidden += u64::from(hidden);
                line.hidden |= hidden;
            }
            let is_new = force_n.is_finite() && (*force_n - shown_n[index]).abs() > 0.0;
            line.silent_cycles = if is_new { 0.0 } else { line.silent_cycles + 1.0 };
            if force_n.is_finite() {
                shown_n[index] = *force_n;
            }
        }
        let (expected, output) = (twin.step(&good), spoilt.step(&bad));
        for (index, line) in lines.iter_mut().enumerate() {
            let (one, other) = (&output.cables[index], &expected.cables[index]);
            tally.cycles += 1;
            let off_n = (one.force_at_platform_n - other.force_at_platform_n).abs();
            let tolerated_n = 0.05 * other.force_at_platform_n.abs() + 0.1 + play_n(cable(index));
            let is_off = off_n > tolerated_n;
            tally.off += u64::from(is_off);
            let has = |flag| other.status.contains(flag);
            let unsettled = has(CableStatus::UNSETTLED);
            let is_silent = is_off && one.status.is_ok();
            // What the twin itself does not vouch for is no measure, until the two have met again.
            let is_held = has(CableStatus::SENSOR_FROZEN) || has(CableStatus::SENSOR_NOT_FINITE);
            line.hidden |= (unsettled && line.spike.is_some()) || is_silent && (unsettled || is_held);
            tally.left_out += u64::from(is_off && line.hidden);
            if is_silent && !line.hidden {
                return Err(format!(
                    "cycle {cycle}, cable {index}: {one:?} beside {other:?}, from {:?}; {:?}",
                    bad.cables[index], robot.cables[index],
                ));
            }
            let is_slack = (one.status | other.status).contains(CableStatus::SLACK);
            let [stored_n, of_twin_n] = [&spoilt, &twin].map(|robot| robot.pulley_friction_n(index));
            let apart_n: f64 = stored_n.iter().zip(of_twin_n).map(|(one_n, other_n)| (one_n - other_n).abs()).sum();
            if off_n + apart_n < 0.01 * tolerated_n && line.spike.is_none() && !is_slack {
                line.hidden = false;
            }
            let stored_n: f64 = match robot.cables[index].presliding() {
                Presliding::PerPulley => of_twin_n.iter().map(|friction_n| friction_n.abs()).sum(),
                Presliding::Lumped => f64::INFINITY,
            };
            let is_false = unsettled && stored_n <= least_borne_n(&robot.cables[index], other.frictionless_n);
            tally.unsettled += u64::from(unsettled && !is_false);
            tally.false_flags += u64::from(has(CableStatus::SENSOR_JUMP) || is_false);
        }
    }
    Ok(tally)
}

/// What the play of a stretched cable may be off by for good, N: its middle by 2·`play_n`, and what waits by one.
fn play_n(cable: &CableParams) -> f64 {
    let value = |key| effect(cable, "cable_elasticity", key);
    3.0 * value("play_n") * value("compliance_m_per_n") * cable.friction().sigma_n_per_m.unwrap()
}

/// `Σμk_j·T` of the pulleys whose wrap is fixed, N; no effect lowers it but those that are left out, the ones that correct the tension among them.
fn least_borne_n(cable: &CableParams, tension_n: f64) -> f64 {
    let neutral = [
        ("load_nonlinearity", "exponent", 1.0),
        ("friction_drift", "rate_per_s", 0.0),
        ("sensor_gain", "gain", 1.0),
        ("sensor_offset", "offset_n", 0.0),
        ("sensor_drift", "rate_n_per_s", 0.0),
        ("sensor_warmup", "final_n", 0.0),
        ("sensor_nonlinearity", "curvature_per_n", 0.0),
        ("sensor_lag", "time_constant_s", 0.0),
    ];
    let has_ripple = amplitudes(cable, "winch_ripple", ["sin_n", "cos_n"]) != [0.0; 2];
    if has_ripple || neutral.iter().any(|(kind, key, neutral)| effect(cable, kind, key) != *neutral) {
        return 0.0;
    }
    let wraps = (1..).zip(cable.fixed_wraps_rad()).filter_map(|(pulley, wrap_rad)| Some((pulley, wrap_rad?)));
    wraps
        .map(|(pulley, wrap_rad)| greatest_mu_at(cable, pulley) * 2.0 * (0.5 * wrap_rad).sin() * tension_n.max(0.0))
        .sum()
}

/// Robots, one after the other, over at least so many cycles of a cable.
pub fn run(cycles: u64, seed: u64, threads: u64) -> Result<Tally, String> {
    let work = |thread: u64| {
        let mut tally = Tally::default();
        let mut episode_count = thread;
        while tally.cycles < cycles / threads {
            let own = seed
                .wrapping_mul(0xd134_2543_de82_ef95)
                .wrapping_add(episode_count.wrapping_mul(0x2545_f491_4f6c_dd1d));
            tally.add(&episode(own).map_err(|problem| format!("seed {seed}, episode {episode_count}: {problem}"))?);
            episode_count += threads;
        }
        Ok::<Tally, String>(tally)
    };
    std::thread::scope(|scope| {
        let started: Vec<_> = (0..threads).map(|thread| scope.spawn(move || work(thread))).collect();
        let mut all = Tally::default();
        for thread in started {
            all.add(&thread.join().unwrap()?);
        }
        Ok(all)
    })
}
