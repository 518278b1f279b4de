//! The swivelling last pulley against a tangent found by search.

use std::f64::consts::{PI, TAU};

use fric_core::swivel::{Swivel, cable_length_m, exit, wrap_rad};

use crate::random::Random;
use crate::support::{add, assert_near, bisect, cross, dot, norm, scale};

/// In the plane: rolls the cable along the circle from the entry until it points at `b`; gives wrap and exit point.
///
/// The entry is the origin, the cable enters along +z, the circle's centre is (r, 0).
fn roll_off(radius: f64, b: [f64; 2]) -> (f64, [f64; 2]) {
    let point = |wrap: f64| [radius - radius * wrap.cos(), radius * wrap.sin()];
    let heading = |wrap: f64| [wrap.sin(), wrap.cos()];
    // Zero where the cable's heading passes through b; the heading must not point away from it.
    let miss = |wrap: f64| {
        let ([px, pz], [hx, hz]) = (point(wrap), heading(wrap));
        (b[0] - px) * hz - (b[1] - pz) * hx
    };
    let ahead = |wrap: f64| {
        let ([px, pz], [hx, hz]) = (point(wrap), heading(wrap));
        (b[0] - px) * hx + (b[1] - pz) * hz > 0.0
    };
    let steps = 3600;
    for step in 0..steps {
        let (low, high) = (TAU * f64::from(step) / f64::from(steps), TAU * f64::from(step + 1) / f64::from(steps));
        if miss(low) >= 0.0 && miss(high) < 0.0 && ahead(low) {
            let wrap = bisect(low, high, miss);
            return (wrap, point(wrap));
        }
    }
    panic!("no tangent from {b:?} to the circle of {radius}");
}

fn frame(random: &mut Random) -> ([f64; 3], [f64; 3], [f64; 3]) {
    let axis = random.unit_vector();
    let outward = loop {
        let other = random.unit_vector();
        let across = cross(axis, other);
        if norm(across) > 0.3 {
            break scale(across, 1.0 / norm(across));
        }
    };
    (random.vector(2.0), axis, outward)
}

#[test]
fn wrap_direction_and_length_are_those_of_the_tangent() {
    let mut random = Random::new(41);
    let mut beyond_half_turn = 0;
    for _ in 0..3000 {
        let (entry_m, axis, outward) = frame(&mut random);
        let radius_m = random.range(0.002, 0.2);
        // Around the centre, outside the circle, on the side x > 0 (the pulley turns towards the cable).
        let (distance, angle) = (radius_m * (1.05 + 10.0 * random.unit()), random.range(-PI, PI));
        let b = [radius_m + distance * angle.cos(), distance * angle.sin()];
        if b[0] < 1e-3 {
            continue;
        }
        let (wrap, tangent) = roll_off(radius_m, b);
        beyond_half_turn += usize::from(wrap > PI + 0.01);
        let place = |[x, z]: [f64; 2]| add(entry_m, add(scale(outward, x), scale(axis, z)));
        let attachment_m = place(b);
        let free_m = add(place(tangent), scale(attachment_m, -1.0));
        let swivel = Swivel { entry_m, axis, radius_m };
        let ours = exit(&swivel, attachment_m);
        assert!(ours.reachable);
        for (one, other) in ours.direction.into_iter().zip(scale(free_m, 1.0 / norm(free_m))) {
            assert_near(one, other, 1e-11);
        }
        assert_near(wrap_rad(ours.cos_sin_wrap), wrap, 1e-11);
        assert_near(ours.wrap_factor, 2.0 * (0.5 * wrap).sin(), 1e-10);
        assert_near(ours.free_length_m, norm(free_m), 1e-12);
        let length_m = cable_length_m(&swivel, &attachment_m.into()).unwrap();
        assert_near(length_m, radius_m * wrap + norm(free_m), 1e-12);
    }
    assert!(beyond_half_turn > 150, "{beyond_half_turn} wraps beyond 180° are too few to mean anything");
}

#[test]
fn an_eyelet_is_a_point() {
    let mut random = Random::new(42);
    for _ in 0..1000 {
        let (entry_m, axis, _) = frame(&mut random);
        let relative = scale(random.unit_vector(), random.range(0.1, 5.0));
        let ours = exit(&Swivel { entry_m, axis, radius_m: 0.0 }, add(entry_m, relative));
        assert!(ours.reachable);
        for (one, other) in ours.direction.into_iter().zip(scale(relative, -1.0 / norm(relative))) {
            assert_near(one, other, 1e-12);
        }
        let wrap = (dot(relative, axis) / norm(relative)).clamp(-1.0, 1.0).acos();
        assert_near(wrap_rad(ours.cos_sin_wrap), wrap, 1e-7);
        assert_near(ours.free_length_m, norm(relative), 1e-12);
    }
}

#[test]
fn straight_ahead_the_cable_does_not_touch() {
    for radius_m in [0.0, 0.01, 0.1] {
        let swivel = Swivel { entry_m: [0.2, 0.3, 0.4], axis: [0.0, 0.0, 1.0], radius_m };
        let ours = exit(&swivel, [0.2, 0.3, 1.4]);
        assert!(ours.reachable);
        assert_near(ours.wrap_factor, 0.0, 1e-7);
        assert_near(wrap_rad(ours.cos_sin_wrap), 0.0, 1e-12);
        for (one, other) in ours.direction.into_iter().zip([0.0, 0.0, -1.0]) {
            assert_near(one, other, 1e-12);
        }
        assert_near(cable_length_m(&swivel, &[0.2, 0.3, 1.4].into()).unwrap(), 1.0, 1e-12);
        // A nanometre beside the axis nothing jumps.
        for aside in [1e-12, 1e-10, 0.9e-9, 1.1e-9, 1e-8] {
            let near = exit(&swivel, [0.2 + aside, 0.3, 1.4]);
            for (one, other) in near.direction.into_iter().zip(ours.direction) {
                assert_near(one, other, 1e-7);
            }
        }
    }
}

#[test]
fn inside_the_circle_there_is_no_way_out() {
    let mut random = Random::new(43);
    for _ in 0..500 {
        let (entry_m, axis, outward) = frame(&mut random);
        let radius_m = random.range(0.01, 0.2);
        let (distance, angle) = (radius_m * random.range(0.0, 0.999), random.range(-PI, PI));
        let b = add(scale(outward, radius_m + distance * angle.cos()), scale(axis, distance * angle.sin()));
        let swivel = Swivel { entry_m, axis, radius_m };
        assert!(!exit(&swivel, add(entry_m, b)).reachable);
        assert_eq!(cable_length_m(&swivel, &add(entry_m, b).into()), None);
    }
}

#[test]
fn whatever_is_reachable_has_a_unit_direction() {
    let mut random = Random::new(44);
    for case in 0..20_000 {
        let (entry_m, axis, outward) = frame(&mut random);
        let radius_m = if case % 5 == 0 { 0.0 } else { 10_f64.powf(random.range(-4.0, 0.0)) };
        // Close to the axis too, ahead and behind.
        let x = if case % 3 == 0 { 10_f64.powf(random.range(-14.0, -6.0)) } else { random.range(0.0, 1.0) };
        let b = add(scale(outward, x), scale(axis, random.range(-1.0, 1.0)));
        let ours = exit(&Swivel { entry_m, axis, radius_m }, add(entry_m, b));
        if ours.reachable {
            assert_near(norm(ours.direction), 1.0, 1e-5);
        }
    }
}
