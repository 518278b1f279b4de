//! Each row of the documentation's table, and the values that pass through.

use fric_log::signals::{CLOCK_STEP_MESSAGES, Role};

use super::support::*;

const STEP: i64 = 8;

#[test]
fn the_first_of_two_with_the_same_stamp_counts() {
    let mut log = Log::default();
    log.cables(every(MS, S, 10));
    log.add("/cables", JOINT_STATES, S + 9 * MS, cable(S + 9 * MS, -1.0, -1.0));
    log.cables(every(MS, S + 10 * MS, 10));
    let joined = log.read_a();
    assert_eq!(joined.counts(Role::Cable), [20, 1, 0, 0, 0, 0]);
    assert_eq!(joined.row(S + 9 * MS).force_n, [1009.0]);
}

#[test]
fn stragglers_are_left_out_up_to_a_clock_step() {
    assert_eq!(STEP, i64::try_from(CLOCK_STEP_MESSAGES).unwrap());
    for count in [1, STEP - 1, STEP] {
        let mut log = Log::default();
        log.cables(every(MS, S, 100));
        for (index, stamp) in (1..).zip(every(MS, S + 50 * MS, count)) {
            log.add("/cables", JOINT_STATES, S + 99 * MS + index, cable(stamp, 0.0, 0.0));
        }
        log.cables(every(MS, S + 100 * MS, 100));
        let joined = log.read_a();
        let late = u64::try_from(count).unwrap();
        if count < STEP {
            assert_eq!(joined.counts(Role::Cable), [200, 0, late, 0, 0, 0]);
            assert!(joined.stamps().is_sorted());
        } else {
            assert_eq!(joined.counts(Role::Cable)[..4], [200 + late, 0, 0, 1]);
        }
    }
}

#[test]
fn nothing_is_bridged_over_a_gap_nor_past_the_ends() {
    let mut log = Log::default();
    log.cables(every(MS, S, 400));
    log.references(every(4 * MS, S + 10 * MS, 20).chain(every(4 * MS, S + 200 * MS, 20)));
    let joined = log.read_a();
    assert_eq!(joined.counts(Role::Reference), [40, 0, 0, 0, 1, 0]);
    for row in &joined.rows {
        let at = (row.stamp_nanos - S) / MS;
        let is_there = (10..=86).contains(&at) || (200..=276).contains(&at);
        let expected = if is_there { ms(row.stamp_nanos) } else { f64::NAN };
        assert_near(&row.reference_n, &[expected], &format!("{at} ms"));
    }
}

#[test]
fn a_bad_start_does_not_spoil_the_usual_interval() {
    // Two messages at once, or one long before the others.
    for first in [S + MS - 1000, S / 2] {
        let mut log = Log::default();
        log.cables(every(MS, S / 2, 1000));
        log.references([first].into_iter().chain(every(10 * MS, S + MS, 49)));
        let joined = log.read_a();
        assert_eq!(joined.counts(Role::Reference)[4], u64::from(first == S / 2), "{first}");
        let known = joined.rows.iter().filter(|row| row.reference_n[0].is_finite()).count();
        assert_eq!(known, if first == S / 2 { 482 } else { 481 });
    }
}

#[test]
fn unusable_messages_are_left_out() {
    let mut cut = cable(S, 1.0, 1.0);
    cut.truncate(30);
    let bad = [
        (cut, "it is damaged or not of its schema"),
        (joints(S, &["a"], &[1.0, 2.0], &[], &[1.0]), "it holds 2 numbers where 1 are expected, one per cable"),
        (joints(S, &["a"], &[], &[], &[1.0]), "it brings no cable lengths (`position`); name the topic or path"),
        (joints(S, &["a"], &[1.0], &[], &[]), "it brings no forces (`effort`); name the topic or path"),
        (joints(S, &["a", "a"], &[1.0, 2.0], &[], &[1.0, 2.0]), "it names `a` twice"),
    ];
    for (data, reason) in bad {
        let mut log = Log::default();
        log.cables(every(MS, S, 20));
        log.add("/cables", JOINT_STATES, S + 5 * MS, data);
        let joined = log.read_a();
        assert_eq!(joined.counts(Role::Cable), [20, 0, 0, 0, 0, 1], "{reason}");
        assert!(joined.problem(Role::Cable).contains(reason), "{}", joined.problem(Role::Cable));
    }
}

#[test]
fn messages_about_other_cables_count_for_nothing() {
    let mut log = Log::default();
    log.cables(every(MS, S, 20));
    for stamp in every(MS, S, 20) {
        log.add("/cables", JOINT_STATES, stamp, joints(stamp, &["arm"], &[1.0], &[], &[1.0]));
    }
    let joined = log.read_a();
    assert_eq!(joined.counts(Role::Cable), [20, 0, 0, 0, 0, 0]);
    assert!(joined.reader.first_problem(Role::Cable).is_none());
}

#[test]
fn cables_are_matched_by_name_in_every_message() {
    let mut log = Log::default();
    let add = |log: &mut Log, at: i64, names: &[&str], numbers: &[f64]| {
        log.add("/cables", JOINT_STATES, S + at * MS, joints(S + at * MS, names, numbers, numbers, numbers));
    };
    add(&mut log, 0, &["a", "b"], &[1.0, 2.0]);
    add(&mut log, 1, &["b", "a"], &[2.0, 1.0]);
    add(&mut log, 2, &["x", "b"], &[9.0, 2.0]);
    add(&mut log, 3, &["b", "y", "a"], &[2.0, 9.0, 1.0]);
    let joined = log.read_a_and_b();
    let forces: Vec<f64> = joined.rows.iter().flat_map(|row| row.force_n.clone()).collect();
    assert_near(&forces, &[1.0, 2.0, 1.0, 2.0, f64::NAN, 2.0, 1.0, 2.0], "forces");
    assert_near(&joined.rows[2].speed_m_per_s, &[f64::NAN, 2.0], "speeds");
}

impl Log {
    fn read_a_and_b(&self) -> Joined {
        self.read(&PATHS, &["a", "b"])
    }
}

#[test]
fn odd_numbers_pass_bit_by_bit() {
    let odd = [f64::from_bits(0x7ff8_0000_dead_beef), f64::NEG_INFINITY, -0.0, 5e-324];
    let names = ["a", "b", "c", "d"];
    let mut log = Log::default();
    for stamp in every(MS, S, 10) {
        log.add("/cables", JOINT_STATES, stamp, joints(stamp, &names, &odd, &odd, &odd));
        log.add("/reference", JOINT_STATES, stamp, joints(stamp, &names, &[], &[], &odd));
        log.add("/wrench", WRENCHES, stamp, wrench(stamp, [odd[0], odd[1], odd[2], odd[3], 1.0, 2.0]));
    }
    let bits = |numbers: &[f64]| numbers.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
    for row in &log.read(&PATHS, &names).rows {
        for numbers in [&row.force_n, &row.length_m, &row.reference_n] {
            assert_eq!(bits(numbers), bits(&odd));
        }
        // A speed of NaN is one that is missing, to be derived; so is this one's length.
        assert!(row.speed_m_per_s[0].is_nan());
        assert_eq!(bits(&row.speed_m_per_s[1..]), bits(&odd[1..]));
        assert_eq!(bits(&row.wrench.as_ref().unwrap()[..4]), bits(&odd));
    }
}

#[test]
fn missing_speed_is_derived_message_by_message() {
    let mut log = Log::default();
    let mut add = |at: i64, length: f64, speed: &[f64]| {
        log.add("/cables", JOINT_STATES, S + at * MS, joints(S + at * MS, &["a"], &[length], speed, &[1.0]));
    };
    add(0, 1.0, &[]);
    add(1, 1.001, &[]);
    add(2, 1.002, &[7.0]);
    add(3, f64::NAN, &[]);
    add(4, 1.006, &[]);
    add(104, 1.106, &[]);
    add(105, 1.109, &[f64::NAN]);
    let speeds: Vec<f64> = log.read_a().rows.iter().map(|row| row.speed_m_per_s[0]).collect();
    // In m per ms; so few lengths tell no noise. By the parabola through three points: (1·1 + 1·1)/2; (2·100 + 1·2)/102; (1·1 + 3·100)/101;
    // at the end of that through the last three: 3 + 2·1/101.
    assert_near(&speeds, &[1.0, 1.0, 7.0, f64::NAN, 202.0 / 102.0, 301.0 / 101.0, 305.0 / 101.0], "speeds");
}

/// Each of two cables has messages of its own, and the length is the square of the time: its derivative is met all the same.
#[test]
fn derived_speed_does_not_lag() {
    let mut log = Log::default();
    for at in 0..20_i64 {
        let (name, t) = (["a", "b"][usize::try_from(at % 2).unwrap()], 1e-3 * f64::from(i32::try_from(at).unwrap()));
        log.add("/cables", JOINT_STATES, S + at * MS, joints(S + at * MS, &[name], &[t * t], &[], &[1.0]));
    }
    let rows = log.read_a_and_b().rows;
    assert_eq!(rows.len(), 20);
    for (at, row) in rows.iter().enumerate().skip(2).take(16) {
        let t = 1e-3 * f64::from(u32::try_from(at).unwrap());
        assert!((row.speed_m_per_s[at % 2] - 2.0 * t).abs() < 1e-9, "{at} {:?}", row.speed_m_per_s);
        assert!(row.speed_m_per_s[1 - at % 2].is_nan());
    }
}

#[test]
fn a_zero_quaternion_gives_no_pose_and_signs_do_not_matter() {
    let mut log = Log::default();
    log.cables(every(MS, S, 40));
    for (index, stamp) in every(4 * MS, S, 10).enumerate() {
        let sign = if index % 2 == 0 { 1.0 } else { -1.0 };
        let turn = if index == 5 { [0.0; 4] } else { [0.0, 0.0, 0.6 * sign, 0.8 * sign] };
        log.add("/pose", POSES, stamp, pose(stamp, [ms(stamp), 0.0, 0.0], turn));
    }
    for row in &log.read_a().rows {
        let at = (row.stamp_nanos - S) / MS;
        assert_eq!(row.pose.is_some(), at <= 16 || (24..=36).contains(&at), "{at}");
        if let Some(pose) = &row.pose {
            let turn = [pose[5] * pose[6].signum(), pose[6].abs()];
            assert_near(&[pose[0], turn[0], turn[1]], &[ms(row.stamp_nanos), 0.6, 0.8], "pose");
        }
    }
}
