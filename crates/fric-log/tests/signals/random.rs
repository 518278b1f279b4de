//! Random logs against the oracle.

use fric_log::signals::Role;
use nalgebra::{DMatrix, DVector};

use super::oracle::{Measured, Topic};
use super::support::*;

struct Random(u64);

impl Random {
    fn below(&mut self, bound: i64) -> i64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        i64::try_from(self.0 >> 1).unwrap() % bound
    }

    #[expect(clippy::cast_precision_loss, reason = "a number of 0…1")]
    fn unit(&mut self) -> f64 {
        self.below(1 << 40) as f64 / (1_i64 << 40) as f64
    }
}

/// Stamps and log times of a topic: rate, phase, jitter, latency, and now and then a duplicate, a straggler, a pause.
fn times(random: &mut Random, interval: i64, is_plain: bool) -> Vec<(i64, i64)> {
    let start = S + random.below(S / 2);
    let end = 8 * S - random.below(S / 2);
    let latency = random.below(20 * MS);
    let jitter = random.below(interval / 3) + 1;
    let mut times = Vec::new();
    let mut time = start;
    while time < end {
        let stamp = time + random.below(jitter);
        // Never overtaken by the next one, so that the order of the log is known.
        times.push((stamp, time + latency + random.below(interval / 2)));
        if !is_plain {
            match random.below(60) {
                0 => times.push((stamp, times.last().unwrap().1)),
                1 => times.push((stamp - random.below(5 * interval) - 1, times.last().unwrap().1)),
                2 if random.below(4) == 0 => time += interval * (5 + random.below(30)),
                _ => {}
            }
        }
        time += interval;
    }
    times
}

fn measure(random: &mut Random, times: &[(i64, i64)], count: usize) -> Vec<Measured> {
    times.iter().map(|(stamp, _)| (*stamp, (0..count).map(|_| random.unit() * 50.0).collect())).collect()
}

fn slowly_turning(random: &mut Random, times: &[(i64, i64)]) -> Vec<Measured> {
    let turn = |(stamp, _): &(i64, i64)| {
        let angle = ms(*stamp) * 1e-4;
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        let quaternion = [0.6 * angle.sin(), 0.0, 0.8 * angle.sin(), angle.cos()].map(|part| sign * part);
        let position = [random.unit(), random.unit(), random.unit()];
        (*stamp, position.into_iter().chain(quaternion).collect())
    };
    times.iter().map(turn).collect()
}

#[test]
fn rows_are_as_the_oracle_has_them() {
    let intervals = [MS, 4 * MS, 10 * MS, 2 * MS + 1, 33 * MS, 100 * MS];
    for seed in 1..=24 {
        let mut random = Random(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(seed));
        for _ in 0..8 {
            random.below(2);
        }
        let is_plain = seed % 3 == 0;
        let mut interval = || intervals[usize::try_from(random.below(6)).unwrap()];
        let chosen = [interval(), interval(), interval(), interval(), interval(), interval()];
        let all: Vec<Vec<(i64, i64)>> = chosen.iter().map(|it| times(&mut random, *it, is_plain)).collect();
        let own = [random.below(2) == 0, random.below(2) == 0];
        let cables = measure(&mut random, &all[0], 6);
        let lengths = measure(&mut random, &all[1], 2);
        let speeds = measure(&mut random, &all[2], 2);
        let references = measure(&mut random, &all[3], 2);
        let poses = slowly_turning(&mut random, &all[4]);
        let wrenches = measure(&mut random, &all[5], 6);
        let mut log = Log::default();
        let logged = |topic: usize, index: usize| all[topic][index].1;
        for (index, (stamp, it)) in cables.iter().enumerate() {
            let data = joints(*stamp, &["b", "x", "a"], &it[..3], &[], &[it[3], 0.0, it[5]]);
            log.add("/cables", JOINT_STATES, logged(0, index), data);
        }
        for (index, (stamp, it)) in lengths.iter().enumerate() {
            log.add("/lengths", JOINT_STATES, logged(1, index), joints(*stamp, &["a", "b"], it, &[], &[]));
        }
        for (index, (stamp, it)) in speeds.iter().enumerate() {
            log.add("/speeds", JOINT_STATES, logged(2, index), joints(*stamp, &["a", "b"], &[], it, &[]));
        }
        for (index, (stamp, it)) in references.iter().enumerate() {
            log.add("/reference", JOINT_STATES, logged(3, index), joints(*stamp, &["b", "a"], &[], &[], it));
        }
        for (index, (stamp, it)) in poses.iter().enumerate() {
            let (position, turn) = it.split_at(3);
            let data = pose(*stamp, position.try_into().unwrap(), turn.try_into().unwrap());
            log.add("/pose", POSES, logged(4, index), data);
        }
        for (index, (stamp, it)) in wrenches.iter().enumerate() {
            log.add("/wrench", WRENCHES, logged(5, index), wrench(*stamp, it.as_slice().try_into().unwrap()));
        }
        let mut paths = PATHS.to_vec();
        if own[0] {
            paths.push((Role::Length, "/lengths"));
        }
        if own[1] {
            paths.push((Role::Speed, "/speeds.velocity[:]"));
        }
        let joined = log.read(&paths, &["a", "b"]);
        let topics = [&cables, &lengths, &speeds, &references, &poses, &wrenches].map(|messages| Topic::new(messages));
        for ((role, topic), is_read) in Role::ALL.into_iter().zip(&topics).zip([true, own[0], own[1], true, true, true])
        {
            if is_read {
                let kept = topic.kept().len() as u64;
                let expected = [kept, topic.duplicate_count, topic.late_count, 0, topic.gap_count(), 0];
                assert_eq!(joined.counts(role), expected, "seed {seed}, {role:?}");
            }
        }
        check(&joined, &topics, own, &format!("seed {seed}"));
    }
}

fn check(joined: &Joined, topics: &[Topic; 6], own: [bool; 2], what: &str) {
    let [cables, lengths, speeds, references, poses, wrenches] = topics;
    assert_eq!(joined.rows.len(), cables.kept().len(), "{what}");
    let kept = cables.kept();
    let lengths_at = |place: usize| {
        let (stamp, it) = kept.get(place)?;
        Some((*stamp, if own[0] { lengths.at(*stamp, 2) } else { vec![it[2], it[0]] }))
    };
    let derived: Vec<Vec<f64>> =
        (0..if own[1] { 0 } else { 2 }).map(|cable| derive(&lengths_at, kept.len(), cable)).collect();
    for (place, (row, (stamp, it))) in joined.rows.iter().zip(kept).enumerate() {
        let what = format!("{what} at {stamp}");
        assert_eq!(row.stamp_nanos, *stamp, "{what}");
        assert_eq!(row.force_n, [it[5], it[3]], "{what}");
        let length = lengths_at(place).unwrap().1;
        assert_near(&row.length_m, &length, &what);
        let speed = if own[1] { speeds.at(*stamp, 2) } else { derived.iter().map(|of| of[place]).collect() };
        assert_near(&row.speed_m_per_s, &speed, &what);
        let reference = references.at(*stamp, 2);
        assert_near(&row.reference_n, &[reference[1], reference[0]], &what);
        assert_eq!(row.wrench.is_some(), wrenches.around(*stamp).is_some(), "{what}");
        if let Some(wrench) = &row.wrench {
            assert_near(wrench, &wrenches.at(*stamp, 6), &what);
        }
        let pose = poses.pose_at(*stamp);
        assert_eq!(row.pose.is_some(), pose.is_some(), "{what}");
        if let (Some(found), Some(pose)) = (&row.pose, pose) {
            let sign = found[3..].iter().zip(&pose[3..]).map(|(found, pose)| found * pose).sum::<f64>().signum();
            let turned: Vec<f64> = found.iter().take(3).copied().chain(found[3..].iter().map(|it| sign * it)).collect();
            let away = turned.iter().zip(&pose).map(|(found, pose)| (found - pose).abs()).fold(0.0, f64::max);
            assert!(away < 1e-4, "{what}: {turned:?} instead of {pose:?}");
        }
    }
}

type Lengths<'a> = &'a dyn Fn(usize) -> Option<(i64, Vec<f64>)>;

/// In each row the mean slope over the windows of the row and its two neighbours on each side, of which each has the narrowest that itself and its own
/// two neighbours bear.
fn derive(lengths_at: Lengths<'_>, count: usize, cable: usize) -> Vec<f64> {
    let is_known = |place: &usize| lengths_at(*place).is_some_and(|(_, lengths)| lengths[cable].is_finite());
    let known: Vec<usize> = (0..count).filter(is_known).collect();
    // A row waits for 24 rows of each cable.
    let seen_by = |at: usize| known.partition_point(|place| *place <= known[at] + 48);
    let of_known = |at: usize| {
        // Its slopes are asked for by the fourth before it, if that has seen it.
        let first = (at.saturating_sub(4)..at).find(|first| seen_by(*first) > at).unwrap_or(at);
        let around = &known[at.saturating_sub(20)..(at + 21).min(seen_by(first))];
        slopes(lengths_at, around, known[at], cable)
    };
    let all: Vec<Vec<f64>> = (0..known.len()).map(of_known).collect();
    let mut speeds = vec![f64::NAN; count];
    for (now, place) in known.iter().enumerate() {
        let near = |at: usize| at.saturating_sub(2)..(at + 3).min(seen_by(now));
        let narrowest = |at: usize| all[near(at)].iter().map(Vec::len).min().unwrap();
        let of_neighbours = DVector::from_iterator(near(now).len(), near(now).map(|at| all[now][narrowest(at) - 1]));
        speeds[*place] = of_neighbours.mean();
    }
    speeds
}

/// Slopes in a row of the polynomials that fit the lengths around it best, window for window, as far as each agrees with all narrower ones: by singular
/// values.
fn slopes(lengths_at: Lengths<'_>, around: &[usize], place: usize, cable: usize) -> Vec<f64> {
    let now = lengths_at(place).unwrap().0;
    let points: Vec<(f64, f64)> = around
        .iter()
        .map(|place| lengths_at(*place).unwrap())
        .map(|(stamp, lengths)| (ms(stamp - now) / 1e3, lengths[cable]))
        .collect();
    let at = around.iter().position(|it| *it == place).unwrap();
    let window = |reach: usize| &points[at.saturating_sub(reach)..(at + reach + 1).min(points.len())];
    // The squared residual of a cubic through each five, which share no length with the five of the greatest.
    let rests: Vec<f64> = window(20).windows(5).map(|five| polynomial(five, 3).1).collect();
    let greatest = (0..rests.len()).max_by(|one, other| rests[*one].total_cmp(&rests[*other]));
    let others: Vec<f64> =
        (0..rests.len()).filter(|it| it.abs_diff(greatest.unwrap()) > 4).map(|it| rests[it]).collect();
    let greatest_length = around.iter().map(|place| lengths_at(*place).unwrap().1[cable].abs()).fold(0.0, f64::max);
    let noise = DVector::from_vec(others.clone()).mean().sqrt().max(64.0 * f64::EPSILON * greatest_length);
    let (mut slopes, mut count, mut within) = (Vec::new(), 0, 0);
    for (place, reach) in [1, 2, 3, 4, 6, 8, 11, 15, 20].into_iter().enumerate() {
        let points = window(reach);
        if points.len() == within {
            break;
        }
        if points.len() < 3 {
            continue;
        }
        let ([slope, error], _) = polynomial(points, 3.min(points.len() - 1));
        let apart = |(other, its_error): &(f64, f64)| (slope - other).abs() > 4.0 * noise * (error + its_error);
        if slopes.iter().any(apart) || (others.is_empty() && !slopes.is_empty()) {
            break;
        }
        // Windows with too few lengths count as the next.
        slopes.resize(place + 1, (slope, error));
        (count, within) = (place + 1, points.len());
    }
    slopes.into_iter().take(count).map(|(slope, _)| slope).collect()
}

/// Slope at time 0 with its standard error for unit noise, and the squared residual.
fn polynomial(points: &[(f64, f64)], degree: usize) -> ([f64; 2], f64) {
    let used = degree.min(points.len() - 1) + 1;
    let scale = points.iter().fold(1e-12, |most: f64, point| most.max(point.0.abs()));
    let powers =
        DMatrix::from_fn(points.len(), used, |row, power| (points[row].0 / scale).powi(i32::try_from(power).unwrap()));
    let lengths = DVector::from_iterator(points.len(), points.iter().map(|point| point.1));
    let inverse = powers.clone().pseudo_inverse(1e-15).unwrap();
    let values = &inverse * &lengths;
    let rest = (lengths - powers * &values).norm_squared();
    if used < 2 { ([0.0; 2], rest) } else { ([values[1] / scale, inverse.row(1).norm() / scale], rest) }
}
