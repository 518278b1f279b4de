//! Compares the motion of a log with itself: the speed of each cable with the change of its length, and the length with that of the poses.

use fric_core::{CableParams, Pose, RobotParams, Sample};

use crate::text::{listed, significant};

/// Time over which changes are compared, s: the noise of a length is small beside its change then, and a delay of the speed of some 10 ms is as well.
const STEP_S: f64 = 0.1;
/// Longest time between two samples that belong together, s.
const LONGEST_GAP_S: f64 = 0.5;
/// Ratio, or its inverse, beyond which two measures of one motion differ: a drum whose cable winds in layers has up to 1.2. The smallest of a usual
/// cause is 2, of a block.
const BEYOND_ERRORS: f64 = 1.3;
/// Least squared correlation that is one of motions. Of standing cables half and twice of it say the same.
const LEAST_CORRELATION: f64 = 0.5;
/// Least change of the length in a step, rms, m, and least variation of the length, m: below, noise may be as large.
const LEAST_CHANGE_M: f64 = 1e-4;
const LEAST_VARIATION_M: f64 = 0.01;
/// Difference from the lengths of the poses as a fraction of their own variation, both rms, beyond which points or poses are wrong. Cables that sag and
/// poses that are late make some hundredths; half of it tells a point that is off by a twentieth of the motion, twice as much not one by a seventh.
const MOST_OFF: f64 = 0.1;
/// Relative difference of a ratio from that of its cause.
const OF_CAUSE: f64 = 0.05;

/// Usual ratios of a speed to the change of the length.
const SPEED_CAUSES: [(f64, &str); 5] = [
    (1e3, "mm/s beside a length in m, or a length in m that is one in km"),
    (1e-3, "m/s beside a length in mm"),
    (60.0, "a speed per minute"),
    (1e-2, "m/s beside a length in cm"),
    (-1.0, "the other sign: both are positive while the cable is paid out"),
];
/// Usual ratios of a length to that of the poses.
const LENGTH_CAUSES: [(f64, &str); 5] = [
    (1e3, "a length in mm"),
    (1e-3, "poses and points in mm"),
    (-1.0, "a length of the other sign: it has to grow while the cable is paid out"),
    (2.0, "a block that halves the motion"),
    (0.5, "a block that doubles the motion"),
];

/// Products of two measures of one motion.
#[derive(Clone, Copy, Debug, Default)]
struct Products {
    count: f64,
    one: f64,
    other: f64,
    both: f64,
}

/// Two measures of one length over a stretch of a log; the zero of neither is known.
#[derive(Clone, Copy, Debug, Default)]
struct Stretch {
    start: Option<[f64; 2]>,
    sums: [f64; 2],
    products: Products,
}

impl Stretch {
    fn add(&mut self, one: f64, other: f64) {
        let [start, other_start] = *self.start.get_or_insert([one, other]);
        let (one, other) = (one - start, other - other_start);
        self.products.add(one, other);
        self.sums = [self.sums[0] + one, self.sums[1] + other];
    }

    /// Returns the products about the means.
    fn centred(&self) -> Products {
        let Products { count, one, other, both } = self.products;
        let [sum, other_sum] = self.sums;
        let per_sample = if count > 0.0 { count.recip() } else { 0.0 };
        Products {
            count,
            one: one - sum * sum * per_sample,
            other: other - other_sum * other_sum * per_sample,
            both: both - sum * other_sum * per_sample,
        }
    }
}

impl Products {
    fn add(&mut self, one: f64, other: f64) {
        self.count += 1.0;
        self.one += one * one;
        self.other += other * other;
        self.both += one * other;
    }

    fn sum(&self, more: &Self) -> Self {
        Self {
            count: self.count + more.count,
            one: self.one + more.one,
            other: self.other + more.other,
            both: self.both + more.both,
        }
    }

    /// Whether either measure varies by so much, rms.
    fn is_beyond(&self, least_m: f64) -> bool {
        self.one.max(self.other) > self.count * least_m * least_m
    }

    /// Returns the ratio of one measure to the other if they are of one motion and differ by it, whatever the noise of either.
    fn ratio(&self) -> Option<f64> {
        let is_one_motion = self.both * self.both > LEAST_CORRELATION * self.one * self.other;
        let slopes = [self.both / self.other, self.one / self.both];
        let is_more = slopes.iter().all(|slope| *slope > BEYOND_ERRORS);
        let is_less = slopes.iter().all(|slope| *slope < BEYOND_ERRORS.recip());
        (is_one_motion && (is_more || is_less)).then(|| (self.one / self.other).sqrt().copysign(self.both))
    }
}

/// Sums over a cable's motion.
#[derive(Clone, Copy, Debug, Default)]
struct Motion {
    /// Time, length and speed of the last sample.
    last: Option<(i64, f64, f64)>,
    /// Time since the present step began, s, the change of the length and that by the speed, m.
    step: (f64, f64, f64),
    /// Change by the speed and of the length.
    speed: Products,
    /// Length and length by the pose at the end of each step since the last gap or jump, m, and before it.
    stretch: Stretch,
    before: Products,
}

/// Sums over the motion of all cables of a robot.
#[derive(Clone, Debug)]
pub(crate) struct Motions {
    cables: Vec<(CableParams, Motion)>,
    length_jump_m: f64,
}

impl Motions {
    pub fn new(robot: &RobotParams<'_>) -> Self {
        let length_jump_m = robot.monitor().length_jump_m;
        Self { cables: robot.cables().iter().map(|params| (*params, Motion::default())).collect(), length_jump_m }
    }

    /// Begins another log.
    pub fn start(&mut self) {
        self.cables.iter_mut().for_each(|(_, motion)| motion.start());
    }

    /// Adds a sample.
    pub fn add(&mut self, sample: &Sample<'_>) {
        for ((params, motion), input) in self.cables.iter_mut().zip(sample.cables) {
            let (length_m, speed_m_per_s) = (input.length_m, input.speed_m_per_s);
            let ended = motion.go_on(sample.stamp_nanos, length_m, speed_m_per_s, self.length_jump_m);
            let pose = sample.pose.filter(Pose::is_usable).filter(|_| ended);
            if let Some(by_pose_m) = pose.and_then(|pose| params.length_m(&pose)) {
                motion.stretch.add(length_m, by_pose_m);
            }
        }
    }

    /// Returns warnings about cables whose motion contradicts itself. Cables with the same cause share a line.
    pub fn warnings(&self, names: &[&str]) -> Vec<String> {
        let mut told: Vec<(String, Vec<&str>)> = Vec::new();
        for (name, (_, motion)) in names.iter().zip(&self.cables) {
            for what in motion.of_speed().into_iter().chain(motion.of_length()) {
                match told.iter_mut().find(|(other, _)| *other == what) {
                    Some((_, names)) => names.push(name),
                    None => told.push((what, vec![name])),
                }
            }
        }
        told.into_iter().map(|(what, names)| format!("{}: {what}", listed(&names))).collect()
    }
}

impl Motion {
    fn start(&mut self) {
        self.last = None;
        self.end_stretch();
    }

    fn end_stretch(&mut self) {
        self.step = Default::default();
        self.before = self.before.sum(&std::mem::take(&mut self.stretch).centred());
    }

    /// Goes on to a sample. Returns whether a step has ended with it.
    fn go_on(&mut self, stamp_nanos: i64, length_m: f64, speed_m_per_s: f64, length_jump_m: f64) -> bool {
        if !(length_m.is_finite() && speed_m_per_s.is_finite()) {
            self.start();
            return false;
        }
        let Some((before_nanos, before_m, before_m_per_s)) = self.last.replace((stamp_nanos, length_m, speed_m_per_s))
        else {
            return true;
        };
        #[expect(clippy::cast_precision_loss, reason = "an interval between samples")]
        let passed_s = stamp_nanos.saturating_sub(before_nanos) as f64 * 1e-9;
        let change_m = length_m - before_m;
        if !(passed_s > 0.0 && passed_s <= LONGEST_GAP_S && change_m.abs() <= length_jump_m) {
            self.end_stretch();
            return true;
        }
        let (lasted_s, by_length_m, by_speed_m) = &mut self.step;
        *lasted_s += passed_s;
        *by_length_m += change_m;
        *by_speed_m += 0.5 * (before_m_per_s + speed_m_per_s) * passed_s;
        if *lasted_s < STEP_S {
            return false;
        }
        self.speed.add(*by_speed_m, *by_length_m);
        self.step = Default::default();
        true
    }

    /// Returns what is wrong with the speed.
    fn of_speed(&self) -> Option<String> {
        let Self { speed, .. } = self;
        if !speed.is_beyond(LEAST_CHANGE_M) {
            return None;
        }
        if speed.one == 0.0 {
            let what = "the speed is 0 throughout, though the length changes; leave the speed out, and it is derived from the length";
            return Some(what.to_owned());
        }
        let ratio = speed.ratio()?;
        let cause = cause(&SPEED_CAUSES, ratio).unwrap_or("another unit; both are in metres and seconds");
        Some(format!(
            "the speed is {} times the change of the length in a second; the likely cause is {cause}. Without a speed in the log it is derived from the length",
            significant(ratio)
        ))
    }

    /// Returns what is wrong with the length, or with the poses and points.
    fn of_length(&self) -> Option<String> {
        let length = self.before.sum(&self.stretch.centred());
        let off_m2 = length.one + length.other - 2.0 * length.both;
        if !length.is_beyond(LEAST_VARIATION_M) || off_m2 <= MOST_OFF * MOST_OFF * length.one.max(length.other) {
            return None;
        }
        let known = length.ratio().and_then(|ratio| Some((ratio, cause(&LENGTH_CAUSES, ratio)?)));
        Some(match known {
            Some((ratio, cause)) => format!(
                "the length changes {} times as much as the poses have it; the likely cause is {cause}",
                significant(ratio)
            ),
            None => "the changes of the length are not those that the poses make of `base_m` and `platform_m`, by more than a tenth; compare the points, the order \
                     of the cables, and the frame and unit of the poses"
                .to_owned(),
        })
    }
}

fn cause(causes: &[(f64, &'static str)], ratio: f64) -> Option<&'static str> {
    causes.iter().find(|(of, _)| (ratio / of - 1.0).abs() < OF_CAUSE).map(|(_, cause)| *cause)
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

    /// What is told of a log at 100 Hz whose first cable has a spoilt length and speed, in which noise of 0.05 mm and 2 mm/s is; the platform goes to and
    /// fro, in a frame that is shifted and scaled.
    fn told(spoil: impl Fn(f64, f64) -> (f64, f64), seen: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<String> {
        let robot = RobotFile::parse(EXAMPLE, "example").unwrap();
        let params = robot.params();
        let mut motions = Motions::new(&params);
        motions.length_jump_m = f64::INFINITY;
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
                pose: Some(pose(seen(position_m(time_s)))),
                outside_wrench: None,
            };
            motions.add(&sample);
        }
        motions.warnings(&robot.cable_names())
    }

    #[test]
    fn a_sound_log_is_not_warned_of() {
        assert_eq!(told(|length_m, speed| (length_m, speed), |at_m| at_m), [""; 0]);
        // A drum of which 5 % more is wound, a zero that is unknown, and a pose that is off by 2 mm.
        let worn = told(|length_m, speed| (1.05 * length_m + 3.0, speed), |at_m| at_m + Vector3::new(0.002, 0.0, 0.0));
        assert_eq!(worn, [""; 0]);
    }

    #[test]
    fn speeds_and_lengths_that_contradict_are_told_with_their_cause() {
        let same = |at_m: Vector3<f64>| at_m;
        for (warnings, words) in [
            (told(|length_m, speed| (length_m, -speed), same), "the speed is -1 times"),
            (told(|length_m, speed| (length_m, 1e3 * speed), same), "mm/s beside a length in m"),
            (told(|length_m, _| (length_m, 0.0), same), "the speed is 0 throughout"),
            (told(|length_m, speed| (-length_m, -speed), same), "a length of the other sign"),
            (told(|length_m, speed| (2.0 * length_m, 2.0 * speed), same), "a block that halves the motion"),
        ] {
            let [warning] = warnings.as_slice() else { panic!("{words}: {warnings:?}") };
            assert!(warning.starts_with("cable1: ") && warning.contains(words), "{words}: {warning}");
        }
    }

    #[test]
    fn a_frame_that_is_turned_is_told_for_all_cables() {
        let turned = told(|length_m, speed| (length_m, speed), |at_m| Vector3::new(at_m.y, -at_m.x, at_m.z));
        let [warning] = turned.as_slice() else { panic!("{turned:?}") };
        assert!(warning.contains("cable8: the changes of the length are not those"), "{warning}");
    }
}
