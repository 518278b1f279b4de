//! Compares the motion of a log with itself: the speed of each cable with the change of its length, and the length with that of the poses.

use std::f64::consts::PI;

use fric_core::{CableParams, Pose, RobotParams, Sample};

use super::sums::Sums;
use crate::text::{listed, significant};

/// Time over which the length changes between two comparisons, s: the noise of a length is small beside its change then, and so is a delay of the speed of
/// some 10 ms.
const STEP_S: f64 = 0.1;
/// Longest time between two samples that belong together, s.
const LONGEST_GAP_S: f64 = 0.5;
/// Ratio of speed to change of length, or its inverse, beyond which they are not the same. A filter of the speed keeps the ratio; the smallest of a usual
/// cause is 2.
const BEYOND_ERRORS: f64 = 1.3;
/// Least squared correlation of two measures of one motion. Half and twice as much unexplained gives the same of cables that stand still.
const LEAST_CORRELATION: f64 = 0.5;
/// The same of a speed and a change of the length without its sign, which reversals within a step make differ. A column that is always positive and has nothing
/// to do with the speed reaches two thirds.
const NEARLY_PROPORTIONAL: f64 = 0.9;
/// The same of two lengths that differ by a factor alone.
const PROPORTIONAL: f64 = 0.99;
/// Least change of the length in a step, rms, m, and least range and deviation of a length, m: below, noise and stretch may be as large.
const LEAST_CHANGE_M: f64 = 1e-4;
const LEAST_VARIATION_M: f64 = 0.01;
/// Difference from the lengths of the poses as a fraction of their variation, both rms and beside what a delay of the poses makes, beyond which factor,
/// points or poses are wrong. Cables that sag or stretch make some hundredths. Half of it warns of a point that is off by a twentieth of the motion, twice as
/// much not of one that is off by a seventh.
const MOST_OFF: f64 = 0.1;
/// Relative difference of a ratio from that of its cause.
const OF_CAUSE: f64 = 0.05;

/// Difference of the speed from the rate of the length because it is late or early, as a fraction of the rate, both rms, beyond which it matters: behind
/// a low-pass filter an inertia comes out 1 % too small then. With half of it that is a quarter of a percent, with twice as much 4 %.
const MOST_LATE: f64 = 0.1;

/// What to do about a speed that is not that of the length.
const DERIVE: &str = "`speed = \"lengths\"` under `[log]` derives it from the length, as for a log without a speed";

/// Usual ratios of a speed to the change of the length.
const SPEED_CAUSES: [(f64, &str); 7] = [
    (1e3, "a speed in mm/s"),
    (1e-3, "a length in mm"),
    (1e-2, "a length in cm"),
    (60.0, "a speed per minute"),
    (180.0 / PI, "a speed in degrees beside a length in radians"),
    (PI / 180.0, "a length in degrees beside a speed in radians"),
    (-1.0, "the other sign: both are positive while the cable is paid out"),
];
/// Usual ratios of a length to that of the poses.
const LENGTH_CAUSES: [(f64, &str); 7] = [
    (1e3, "a length in mm"),
    (1e2, "a length in cm"),
    (1e-3, "poses and points in mm"),
    (1e-2, "poses and points in cm"),
    (-1.0, "a length of the other sign: it has to grow while the cable is paid out"),
    (2.0, "a block that halves the motion"),
    (0.5, "a block that doubles the motion"),
];

/// Quantities of a step: the way by the speed and by the length, and the latter without its sign, m.
const BY_SPEED: usize = 0;
const BY_LENGTH: usize = 1;
const UNSIGNED: usize = 2;
/// Quantities of a step between two others: the way by the length that the speed lacks, m, the change of the length's rate, and the rate, m/s. A speed
/// that is late by a time lacks that time's part of the change.
const LACKED: usize = 0;
const RATE_CHANGE: usize = 1;
const STEP_RATE: usize = 2;
/// Quantities of a stretch: the length, that of the pose, m, and the rate of the length, m/s.
const SHOWN: usize = 0;
const POSED: usize = 1;
const RATE: usize = 2;

/// Sums over a cable's motion in one log.
#[derive(Clone, Copy, Debug, Default)]
struct CableMotion {
    /// Time, length and speed of the last sample.
    last: Option<(i64, f64, f64)>,
    /// Whether the length jumped to the last sample.
    has_jumped: bool,
    /// Time since the present step began, s, and the ways in it.
    step: (f64, [f64; 2]),
    steps: Sums<3>,
    /// Whether any way by the speed is negative.
    has_negative_speed: bool,
    /// The two steps before it: time, s, and ways, m.
    past: [Option<(f64, [f64; 2])>; 2],
    between: Sums<3>,
    /// Least and greatest length.
    range_m: Option<[f64; 2]>,
    /// Lengths at the ends of the steps since the last gap or jump, from the first on, because the zero of a length is not known.
    start_m: Option<[f64; 2]>,
    stretch: Sums<3>,
    /// The stretches before it, each about its own mean.
    stretches: Sums<3>,
}

/// Sums over the motion of all cables of a robot, log by log.
#[derive(Clone, Debug)]
pub(crate) struct Motions {
    cables: Vec<(CableParams, CableMotion)>,
    cycle_s: f64,
    length_jump_m: f64,
    /// Number of logs that have ended, and what is wrong in them: log, problem and cable.
    log_count: usize,
    problems: Vec<(usize, String, usize)>,
}

impl Motions {
    pub fn new(robot: &RobotParams<'_>) -> Self {
        Self {
            cables: robot.cables().iter().map(|params| (*params, CableMotion::default())).collect(),
            cycle_s: robot.cycle_s(),
            length_jump_m: robot.monitor().length_jump_m,
            log_count: 0,
            problems: Vec::new(),
        }
    }

    /// Begins another log.
    pub fn start(&mut self) {
        if self.cables.iter().any(|(_, motion)| motion.last.is_some()) {
            self.problems = self.all_problems();
            self.log_count += 1;
        }
        self.cables.iter_mut().for_each(|(_, motion)| *motion = CableMotion::default());
    }

    /// Adds a sample.
    pub fn add(&mut self, sample: &Sample<'_>) {
        for ((params, motion), input) in self.cables.iter_mut().zip(sample.cables) {
            let (length_m, speed_m_per_s) = (input.length_m, input.speed_m_per_s);
            if !(length_m.is_finite() && speed_m_per_s.is_finite()) {
                motion.end_stretch();
                continue;
            }
            let per_cycle_m = self.length_jump_m / self.cycle_s;
            let ended = motion.go_on((sample.stamp_nanos, length_m, speed_m_per_s), per_cycle_m, self.cycle_s);
            let Some(rate_m_per_s) = ended else { continue };
            if let Some(posed_m) = sample.pose.filter(Pose::is_usable).and_then(|pose| params.length_m(&pose)) {
                motion.compare([length_m, posed_m], rate_m_per_s);
            }
        }
    }

    fn all_problems(&self) -> Vec<(usize, String, usize)> {
        let mut problems = self.problems.clone();
        for (cable, (_, motion)) in self.cables.iter().enumerate() {
            let of_cable = motion.of_speed().into_iter().chain(motion.of_length());
            problems.extend(of_cable.map(|problem| (self.log_count, problem, cable)));
        }
        problems
    }

    /// Returns warnings about cables whose motion contradicts itself. Cables of one log with the same cause share a line.
    pub fn warnings(&self, names: &[&str]) -> Vec<String> {
        let mut lines: Vec<(usize, String, Vec<&str>)> = Vec::new();
        for (log, problem, cable) in self.all_problems() {
            let Some(name) = names.get(cable) else { continue };
            match lines.iter_mut().find(|(other, what, _)| (*other, &**what) == (log, problem.as_str())) {
                Some((.., names)) => names.push(name),
                None => lines.push((log, problem, vec![name])),
            }
        }
        let line = |(log, problem, names): (usize, String, Vec<&str>)| {
            let log = if self.log_count > 0 { format!("log {}: ", log + 1) } else { String::new() };
            format!("{log}{}: {problem}", listed(&names))
        };
        lines.into_iter().map(line).collect()
    }

    /// Returns the cables whose length is the same in every sample of the present log.
    pub fn still(&self) -> Vec<usize> {
        let is_still = |(_, motion): &(CableParams, CableMotion)| {
            motion.range_m.is_some_and(|[least_m, greatest_m]| least_m >= greatest_m)
        };
        (0..self.cables.len()).filter(|cable| self.cables.get(*cable).is_some_and(is_still)).collect()
    }
}

impl CableMotion {
    fn end_stretch(&mut self) {
        (self.last, self.step, self.past, self.start_m) = (None, Default::default(), [None; 2], None);
        self.stretches.join(&std::mem::take(&mut self.stretch).centred());
    }

    /// Goes on to a sample. Returns the rate of the length if a step has ended with it.
    fn go_on(&mut self, sample: (i64, f64, f64), most_m_per_s: f64, cycle_s: f64) -> Option<f64> {
        let (stamp_nanos, length_m, speed_m_per_s) = sample;
        let [least_m, greatest_m] = self.range_m.unwrap_or([length_m; 2]);
        self.range_m = Some([least_m.min(length_m), greatest_m.max(length_m)]);
        let (before_nanos, before_m, before_m_per_s) = self.last.replace(sample)?;
        #[expect(clippy::cast_precision_loss, reason = "an interval between samples")]
        let passed_s = stamp_nanos.saturating_sub(before_nanos) as f64 * 1e-9;
        if !(passed_s > 0.0 && passed_s <= LONGEST_GAP_S) {
            self.end_stretch();
            self.last = Some(sample);
            return None;
        }
        let change_m = length_m - before_m;
        let jumps = change_m.abs() > most_m_per_s * passed_s.max(cycle_s);
        // One jump is a new zero, several are motion in another unit.
        if std::mem::replace(&mut self.has_jumped, jumps) != jumps && jumps {
            self.end_stretch();
            self.last = Some(sample);
            return None;
        }
        let (lasted_s, ways_m) = &mut self.step;
        *lasted_s += passed_s;
        ways_m[BY_SPEED] += 0.5 * (before_m_per_s + speed_m_per_s) * passed_s;
        ways_m[BY_LENGTH] += change_m;
        if *lasted_s < STEP_S {
            return None;
        }
        let (lasted_s, ways_m) = std::mem::take(&mut self.step);
        let [by_speed_m, by_length_m] = ways_m;
        self.steps.add([by_speed_m, by_length_m, by_length_m.abs()]);
        self.has_negative_speed |= by_speed_m < 0.0;
        if let [Some((first_s, first)), Some((middle_s, middle))] = self.past {
            let [from_m_per_s, to_m_per_s] = [
                (first[BY_LENGTH] + middle[BY_LENGTH]) / (first_s + middle_s),
                (middle[BY_LENGTH] + ways_m[BY_LENGTH]) / (middle_s + lasted_s),
            ];
            let lacked_m = middle[BY_LENGTH] - middle[BY_SPEED];
            self.between.add([lacked_m, to_m_per_s - from_m_per_s, middle[BY_LENGTH] / middle_s]);
        }
        self.past = [self.past[1], Some((lasted_s, ways_m))];
        Some(ways_m[BY_LENGTH] / lasted_s)
    }

    /// Compares the length with that of the pose at the end of a step.
    fn compare(&mut self, lengths_m: [f64; 2], rate_m_per_s: f64) {
        let start_m = *self.start_m.get_or_insert(lengths_m);
        self.stretch.add([lengths_m[SHOWN] - start_m[SHOWN], lengths_m[POSED] - start_m[POSED], rate_m_per_s]);
    }

    /// Returns what is wrong with the speed.
    fn of_speed(&self) -> Option<String> {
        let steps = &self.steps;
        let range_m = self.range_m.map_or(0.0, |[least_m, greatest_m]| greatest_m - least_m);
        if range_m < LEAST_VARIATION_M || !steps.is_beyond(BY_LENGTH, LEAST_CHANGE_M) {
            return None;
        }
        if steps.products[BY_SPEED][BY_SPEED] == 0.0 {
            return Some(format!("the speed is 0 throughout, though the length changes. {DERIVE}"));
        }
        // Of the whole way, what goes back.
        let back_m = 0.5 * (steps.totals[UNSIGNED] - steps.totals[BY_LENGTH].abs());
        let goes_back = back_m > LEAST_VARIATION_M.max(MOST_OFF * steps.totals[UNSIGNED]);
        if !self.has_negative_speed && goes_back && steps.ratio(BY_SPEED, UNSIGNED, NEARLY_PROPORTIONAL).is_some() {
            return Some(format!("the speed has no sign: it is positive both ways. {DERIVE}"));
        }
        let ratio = steps.ratio(BY_SPEED, BY_LENGTH, LEAST_CORRELATION)?;
        // Noise of either makes one of the two slopes too low and the other too high.
        let both = steps.products[BY_SPEED][BY_LENGTH];
        let slopes = [both / steps.products[BY_LENGTH][BY_LENGTH], steps.products[BY_SPEED][BY_SPEED] / both];
        let is_beyond = slopes.iter().all(|slope| *slope > BEYOND_ERRORS)
            || slopes.iter().all(|slope| *slope < BEYOND_ERRORS.recip());
        let likely = cause(&SPEED_CAUSES, ratio)
            .unwrap_or("another unit, or times at another rate; all are in metres and seconds");
        if is_beyond {
            return Some(format!(
                "the speed is {} times the change of the length in a second; the likely cause is {likely}. {DERIVE}",
                significant(ratio)
            ));
        }
        let late_s = self.late_s()?;
        let [by, way] = if late_s > 0.0 { ["late", "as behind a filter"] } else { ["early", "as a set point is"] };
        Some(format!(
            "the speed is {:.0} ms {by}, compared with the change of the length, {way}: viscous friction and inertia come out wrong. {DERIVE}",
            late_s.abs() * 1e3
        ))
    }

    /// Returns by how much the speed is late, s, if that matters and is most of what distinguishes it from the change of the length.
    fn late_s(&self) -> Option<f64> {
        let product = |one: usize, other: usize| self.between.products[one][other];
        self.between.ratio(LACKED, RATE_CHANGE, LEAST_CORRELATION)?;
        let late_s = product(LACKED, RATE_CHANGE) / product(RATE_CHANGE, RATE_CHANGE);
        let by_lateness_m2 = late_s * late_s * product(RATE_CHANGE, RATE_CHANGE);
        let way_m2 = STEP_S * STEP_S * product(STEP_RATE, STEP_RATE);
        (by_lateness_m2 > MOST_LATE * MOST_LATE * way_m2).then_some(late_s)
    }

    /// Returns what is wrong with the length, or with the poses and points.
    fn of_length(&self) -> Option<String> {
        let mut lengths = self.stretches;
        lengths.join(&self.stretch.centred());
        let product = |one: usize, other: usize| lengths.products[one][other];
        let off_m2 = product(SHOWN, SHOWN) + product(POSED, POSED) - 2.0 * product(SHOWN, POSED);
        // Poses that are late are off in proportion to the rate.
        let by_delay = product(SHOWN, RATE) - product(POSED, RATE);
        let delayed_m2 = if product(RATE, RATE) > 0.0 { by_delay * by_delay / product(RATE, RATE) } else { 0.0 };
        let most_m2 = product(SHOWN, SHOWN).max(product(POSED, POSED));
        if !lengths.is_beyond(POSED, LEAST_VARIATION_M) || off_m2 - delayed_m2 <= MOST_OFF * MOST_OFF * most_m2 {
            return None;
        }
        Some(match lengths.ratio(SHOWN, POSED, PROPORTIONAL) {
            Some(ratio) => {
                let likely = cause(&LENGTH_CAUSES, ratio).unwrap_or("a wrong radius of the drum, gear or unit");
                format!(
                    "the length changes {} times as much as the poses have it; the likely cause is {likely}",
                    significant(ratio)
                )
            }
            None => "the changes of the length are not those that the poses make of `base_m` and `platform_m`, by more than a tenth; compare the points, the \
                     order of the cables, and the frame and unit of the poses"
                .to_owned(),
        })
    }
}

fn cause(causes: &[(f64, &'static str)], ratio: f64) -> Option<&'static str> {
    let off = |of: f64| (ratio / of - 1.0).abs();
    let nearest = causes.iter().min_by(|(one, _), (other, _)| off(*one).total_cmp(&off(*other)))?;
    (off(nearest.0) < OF_CAUSE).then_some(nearest.1)
}

#[cfg(test)]
mod tests {
    use fric_core::CableInput;
    use fric_core::robot::file::RobotFile;
    use nalgebra::{UnitQuaternion, Vector3};
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const EXAMPLE: &str = include_str!("../../../../examples/mini-ipanema.toml");

    /// The warnings about a log at 100 Hz of a robot of 1 kHz, with noise of 0.05 mm and 2 mm/s. The platform goes to and fro; the first cable is shown
    /// otherwise than it moves, and the position as it is measured at a time.
    fn warnings(
        spoil: impl Fn(f64, f64) -> (f64, f64),
        measured: impl Fn(&dyn Fn(f64) -> Vector3<f64>, f64) -> Vector3<f64>,
    ) -> Vec<String> {
        let robot = RobotFile::parse(EXAMPLE, "example").unwrap();
        let params = robot.params();
        let mut motions = Motions::new(&params);
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut noise = move || -> f64 { StandardNormal.sample(&mut random) };
        let position_m =
            |time_s: f64| Vector3::new(0.1 * time_s.sin(), 0.08 * (0.7 * time_s).sin(), 0.05 * (1.3 * time_s).sin());
        let pose = |position_m: Vector3<f64>| Pose { position_m, orientation: UnitQuaternion::identity() };
        for row in 0..2000_u32 {
            let time_s = 0.01 * f64::from(row);
            let of_cable = |(place, cable): (usize, &CableParams)| {
                let length_m = |time_s: f64| cable.length_m(&pose(position_m(time_s))).unwrap();
                let speed_m_per_s = (length_m(time_s + 1e-3) - length_m(time_s - 1e-3)) / 2e-3;
                let (length_m, speed_m_per_s) =
                    if place == 0 { spoil(length_m(time_s), speed_m_per_s) } else { (length_m(time_s), speed_m_per_s) };
                let is_shown = speed_m_per_s != 0.0;
                CableInput {
                    sensor_force_n: 10.0,
                    length_m: length_m + 5e-5 * noise(),
                    speed_m_per_s: if is_shown { speed_m_per_s + 2e-3 * noise() } else { 0.0 },
                }
            };
            let cables: Vec<CableInput> = params.cables().iter().enumerate().map(of_cable).collect();
            let sample = Sample {
                stamp_nanos: i64::from(row) * 10_000_000,
                cables: &cables,
                reference_force_n: &[],
                pose: Some(pose(measured(&position_m, time_s))),
                outside_wrench: None,
            };
            motions.add(&sample);
        }
        motions.warnings(&robot.cable_names())
    }

    type Position<'a> = &'a dyn Fn(f64) -> Vector3<f64>;

    fn now(position_m: Position<'_>, time_s: f64) -> Vector3<f64> {
        position_m(time_s)
    }

    #[test]
    fn a_sound_log_gets_no_warning() {
        let same = |length_m: f64, speed: f64| (length_m, speed);
        assert_eq!(warnings(same, now), [""; 0]);
        // A drum of which 5 % more is wound, a zero that is unknown, and a pose that is off by 2 mm.
        let offset = |position_m: Position<'_>, time_s: f64| position_m(time_s) + Vector3::new(0.002, 0.0, 0.0);
        assert_eq!(warnings(|length_m, speed| (1.05 * length_m + 3.0, speed), offset), [""; 0]);
        // Poses that are 0.2 s late, and a platform that rests while the cables change their length.
        assert_eq!(warnings(same, |position_m, time_s| position_m(time_s - 0.2)), [""; 0]);
        assert_eq!(warnings(same, |_, _| Vector3::zeros()), [""; 0]);
    }

    #[test]
    fn speeds_and_lengths_that_contradict_are_reported_with_their_cause() {
        for (warnings, words) in [
            (warnings(|length_m, speed| (length_m, -speed), now), "the speed is -1 times"),
            (warnings(|length_m, speed| (length_m, 1e3 * speed), now), "a speed in mm/s"),
            (warnings(|length_m, _| (length_m, 0.0), now), "the speed is 0 throughout"),
            (warnings(|length_m, speed| (length_m, speed.to_degrees()), now), "a speed in degrees"),
            (warnings(|length_m, speed| (-length_m, -speed), now), "a length of the other sign"),
            (warnings(|length_m, speed| (2.0 * length_m, 2.0 * speed), now), "a block that halves the motion"),
            (warnings(|length_m, speed| (1e3 * length_m, 1e3 * speed), now), "a length in mm"),
            (warnings(|length_m, speed| (1.2 * length_m, 1.2 * speed), now), "a wrong radius of the drum"),
        ] {
            let [warning] = warnings.as_slice() else { panic!("{words}: {warnings:?}") };
            assert!(warning.starts_with("cable1: ") && warning.contains(words), "{words}: {warning}");
        }
    }

    #[test]
    fn a_frame_that_is_turned_is_reported_for_all_cables() {
        let turned = warnings(
            |length_m, speed| (length_m, speed),
            |position_m, time_s| {
                let at_m = position_m(time_s);
                Vector3::new(at_m.y, -at_m.x, at_m.z)
            },
        );
        let [warning] = turned.as_slice() else { panic!("{turned:?}") };
        assert!(warning.contains("cable8: the changes of the length are not those"), "{warning}");
    }

    /// The warnings about a log at 100 Hz in which each length swings once in 2 s; `shown` is the speed, at a time, of a cable with this one.
    fn of_shown_speed(shown: impl Fn(&dyn Fn(f64) -> f64, f64) -> f64) -> Vec<String> {
        let robot = RobotFile::parse(EXAMPLE, "example").unwrap();
        let mut motions = Motions::new(&robot.params());
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut noise = move || -> f64 { StandardNormal.sample(&mut random) };
        let speed_m_per_s = |time_s: f64| 0.1 * PI * (PI * time_s).cos();
        for row in 0..3000_u32 {
            let time_s = 0.01 * f64::from(row);
            let cable = CableInput {
                sensor_force_n: 1.0,
                length_m: 0.1 * (PI * time_s).sin() + 5e-5 * noise(),
                speed_m_per_s: shown(&speed_m_per_s, time_s),
            };
            motions.add(&Sample {
                stamp_nanos: i64::from(row) * 10_000_000,
                cables: &[cable; 8],
                reference_force_n: &[],
                pose: None,
                outside_wrench: None,
            });
        }
        motions.warnings(&robot.cable_names())
    }

    #[test]
    fn a_speed_that_is_late_or_early_is_reported_with_its_time() {
        let of_late_speed = |late_s: f64| of_shown_speed(|speed, time_s| speed(time_s - late_s));
        // Off by π·0.05 = 0.16 of the speed. Rates over steps of a tenth of a second make the time some percent too long.
        for (late_s, word) in [(0.05, "late"), (-0.05, "early")] {
            let [warning] = &*of_late_speed(late_s) else { panic!("no warning for {late_s} s") };
            let told_ms = warning.split_once(&format!(" ms {word}")).and_then(|(start, _)| start.rsplit(' ').next());
            let told_ms: f64 = told_ms.unwrap().parse().unwrap();
            assert!((told_ms - 50.0).abs() < 2.5 && warning.contains("`speed = \"lengths\"`"), "{warning}");
        }
        // The difference of two lengths is late by half a sample.
        assert_eq!([0.0, 0.005, 0.02].map(of_late_speed), [const { Vec::<String>::new() }; 3]);
    }

    #[test]
    fn a_speed_without_a_sign_is_reported() {
        let [warning] = &*of_shown_speed(|speed, time_s| speed(time_s).abs()) else { panic!("no warning") };
        assert!(warning.contains("the speed has no sign"), "{warning}");
        // A current, say.
        assert_eq!(of_shown_speed(|_, time_s| 1.0 + (3.0 * time_s).sin()), [""; 0]);
    }

    /// Two logs, of which the second has the other sign: the first does not make up for it.
    #[test]
    fn each_log_is_judged_by_itself() {
        let robot = RobotFile::parse(EXAMPLE, "example").unwrap();
        let mut motions = Motions::new(&robot.params());
        for sign in [1.0, -1.0] {
            motions.start();
            for row in 0..1000_u32 {
                let angle = 0.01 * f64::from(row);
                let cable = CableInput {
                    sensor_force_n: 1.0,
                    length_m: 0.1 * angle.sin(),
                    speed_m_per_s: 0.1 * sign * angle.cos(),
                };
                let sample = Sample {
                    stamp_nanos: i64::from(row) * 10_000_000,
                    cables: &[cable; 8],
                    reference_force_n: &[],
                    pose: None,
                    outside_wrench: None,
                };
                motions.add(&sample);
            }
        }
        let warnings = motions.warnings(&robot.cable_names());
        assert!(warnings.len() == 1 && warnings[0].starts_with("log 2: cable1, "), "{warnings:?}");
    }
}
