//! Admittance against the closed-form solutions of its equation.

use fric_core::admittance::{Admittance, AdmittanceOptions, SetPoint};
use fric_core::{Pose, Wrench};

use nalgebra::Vector3;

use crate::support::assert_near;

const OPTIONS: AdmittanceOptions = AdmittanceOptions {
    mass_kg: [2.0, 1.0, 0.5],
    damping_n_s_per_m: [4.0, 20.0, 0.0],
    stiffness_n_per_m: [800.0, 100.0, 0.0],
    reach_m: 10.0,
    inertia_kg_m2: [0.02, 0.01, 0.01],
    damping_nm_s_per_rad: [0.05, 1.0, 0.3],
    stiffness_nm_per_rad: [2.0, 0.5, 0.0],
    reach_rad: 2.0,
};

fn wrench(components: [f64; 6]) -> Wrench {
    let (force_n, torque_nm) = components.split_at(3);
    Wrench { force_n: Vector3::from_column_slice(force_n), torque_nm: Vector3::from_column_slice(torque_nm) }
}

/// Displacement after `t` under a constant push from rest: the textbook's solution, with complex numbers where it oscillates.
fn closed_form(inertia: f64, damping: f64, stiffness: f64, push: f64, t: f64) -> f64 {
    let decay = damping / (2.0 * inertia);
    if stiffness == 0.0 {
        if damping == 0.0 {
            return push * t * t / (2.0 * inertia);
        }
        let rate = damping / inertia;
        return push / damping * (t - (1.0 - (-rate * t).exp()) / rate);
    }
    let end = push / stiffness;
    let square = decay * decay - stiffness / inertia;
    if square.abs() < 1e-9 {
        return end * (1.0 - (-decay * t).exp() * (1.0 + decay * t));
    }
    let rate = square.abs().sqrt();
    let (cos, sin) =
        if square < 0.0 { ((rate * t).cos(), (rate * t).sin()) } else { ((rate * t).cosh(), (rate * t).sinh()) };
    end * (1.0 - (-decay * t).exp() * (cos + decay / rate * sin))
}

#[test]
fn a_push_gives_the_closed_form_at_any_cycle_time() {
    let push = [3.0, -2.0, 0.4, 0.05, 0.1, -0.02];
    let body = |axis: usize| {
        let o = OPTIONS;
        if axis < 3 {
            [o.mass_kg[axis], o.damping_n_s_per_m[axis], o.stiffness_n_per_m[axis]]
        } else {
            [o.inertia_kg_m2, o.damping_nm_s_per_rad, o.stiffness_nm_per_rad].map(|values| values[axis - 3])
        }
    };
    for cycle_s in [1e-4, 1e-3, 0.02, 0.1] {
        let mut admittance = Admittance::new(&OPTIONS, cycle_s, &Pose::identity()).unwrap();
        for cycle in 1..=200_u32 {
            let set_point = admittance.step(Some(&wrench(push)));
            let t = f64::from(cycle) * cycle_s;
            for (axis, push) in push.into_iter().enumerate() {
                let [inertia, damping, stiffness] = body(axis);
                let expected = closed_form(inertia, damping, stiffness, push, t);
                let reach = if axis < 3 { OPTIONS.reach_m } else { OPTIONS.reach_rad };
                if expected.abs() < reach {
                    assert_near(set_point.displacement[axis], expected, 1e-11 * (1.0 + t));
                }
            }
        }
    }
}

#[test]
fn it_is_stable_up_to_what_the_cycle_resolves() {
    // Spring and drag in a cycle, up to their bounds; each at a fast, a usual and a slow cycle.
    for (spring, drag) in [(10.0, 0.0), (10.0, 100.0), (1e-12, 100.0), (1e-9, 0.0), (0.0, 1e-9), (1.0, 2.0)] {
        for (cycle_s, mass) in [(1e-6, 1e-4), (1e-3, 1.0), (10.0, 1e6)] {
            let below: f64 = 1.0 - 1e-12;
            let (stiffness, damping) = (below * spring * mass / cycle_s / cycle_s, below * drag * mass / cycle_s);
            let options = AdmittanceOptions {
                mass_kg: [mass; 3],
                damping_n_s_per_m: [damping; 3],
                stiffness_n_per_m: [stiffness; 3],
                reach_m: 1e4,
                inertia_kg_m2: [1.0; 3],
                damping_nm_s_per_rad: [0.0; 3],
                stiffness_nm_per_rad: [0.0; 3],
                reach_rad: 1.0,
            };
            let mut admittance = Admittance::new(&options, cycle_s, &Pose::identity()).unwrap();
            let energy = |at: &SetPoint| {
                0.5 * (mass * at.rate.x * at.rate.x + stiffness * at.displacement.x * at.displacement.x)
            };
            let mut last = energy(&admittance.step(Some(&wrench([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]))));
            for _ in 0..5000 {
                let at = admittance.step(None);
                assert!(!at.wrench_used && energy(&at) <= last * (1.0 + 1e-12), "{spring} {drag} {cycle_s}");
                last = energy(&at);
            }
        }
    }
}

#[test]
fn what_is_no_wrench_is_told_and_moves_nothing() {
    let mut admittance = Admittance::new(&OPTIONS, 1e-3, &Pose::identity()).unwrap();
    for value in [f64::NAN, f64::INFINITY, -1.1e9] {
        let set_point = admittance.step(Some(&wrench([0.0, 0.0, 0.0, 0.0, value, 1.0])));
        assert!(!set_point.wrench_used && set_point.displacement.norm() == 0.0);
    }
    assert!(admittance.step(Some(&Wrench::default())).wrench_used);
}

#[test]
fn an_axis_stops_at_its_reach_and_comes_back() {
    let options = AdmittanceOptions { reach_m: 0.01, reach_rad: 0.1, ..OPTIONS };
    let rest = Pose::from_parts([0.1, 0.2, 0.3], [0.0, 0.0, 0.0, 1.0]).unwrap();
    let mut admittance = Admittance::new(&options, 1e-3, &rest).unwrap();
    for _ in 0..5000 {
        let at = admittance.step(Some(&wrench([0.0, 0.0, 5.0, 0.0, 0.0, -1.0])));
        assert!(at.displacement.z <= 0.01 && at.displacement.b >= -0.1);
    }
    let at = admittance.step(Some(&wrench([0.0, 0.0, -5.0, 0.0, 0.0, 0.0])));
    assert!(at.rate.z < 0.0 && at.displacement.z < 0.01);
    let turned = (at.pose.orientation * rest.orientation.inverse()).scaled_axis();
    assert_near(turned.z, at.displacement.b, 1e-12);
    assert_near(at.pose.position_m.z, 0.3 + at.displacement.z, 1e-15);
    admittance.reset(&Pose::identity());
    assert_eq!(admittance.step(None).pose, Pose::identity());
}

const UNRESOLVED: &str =
    "`mass_kg` is too small for this damping or stiffness: the cycle does not resolve the motion; raise it";

#[test]
fn what_makes_no_body_is_refused() {
    type Change = fn(&mut AdmittanceOptions);
    let changes: [(Change, &str); 7] = [
        (|options| options.mass_kg[1] = 0.0, "`mass_kg` is 0; allowed is 1e-6 to 1000000"),
        (|options| options.damping_nm_s_per_rad[2] = -1.0, "`damping_nm_s_per_rad` is -1; allowed is 0 to 1e9"),
        (
            |options| options.stiffness_n_per_m[0] = f64::NAN,
            "`stiffness_n_per_m` is NaN, which is not a finite number; allowed is 0 to 1e9",
        ),
        (|options| options.stiffness_n_per_m[0] = 3e7, UNRESOLVED),
        (|options| options.damping_n_s_per_m[2] = 1e5, UNRESOLVED),
        (|options| options.reach_m = 0.0, "`reach_m` is 0; allowed is 1e-6 to 10000"),
        (|options| options.reach_rad = 4.0, "`reach_rad` is 4; allowed is 1e-6 to 3"),
    ];
    for (change, sentence) in changes {
        let mut options = OPTIONS;
        change(&mut options);
        assert_eq!(Admittance::new(&options, 1e-3, &Pose::identity()).unwrap_err().to_string(), sentence);
    }
    let nowhere = Pose { position_m: [f64::NAN; 3].into(), ..Pose::identity() };
    assert!(Admittance::new(&OPTIONS, 1e-3, &nowhere).unwrap_err().to_string().starts_with("`rest`"));
    assert!(Admittance::new(&OPTIONS, 0.0, &Pose::identity()).unwrap_err().to_string().starts_with("`cycle_s`"));
}
