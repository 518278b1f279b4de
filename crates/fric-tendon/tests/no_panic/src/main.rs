//! Both functions of a manipulator's cycle under `no_panic`: a path to a panic is a link error.

use std::hint::black_box;

use fric_tendon::{
    Command, Direction, Drive, DriveOptions, Friction, Goal, ManipulatorOptions, ManipulatorParams, ShapeStatus,
    StaticModel,
};
use no_panic::no_panic;

/// One solution of a manipulator, by any of the four ways.
#[no_panic]
#[inline(never)]
fn solve(model: &mut StaticModel<8>, base_tension_n: [f64; 2], friction: Friction<'_>) -> ShapeStatus {
    #[cfg(feature = "deliberate-panic")]
    assert!(base_tension_n[0] < 1e12);
    model.solve(base_tension_n, friction)
}

/// The tension for a goal.
#[no_panic]
#[inline(never)]
fn tension_for(model: &mut StaticModel<8>, goal: Goal, friction: Friction<'_>, drive: &Drive) -> Command {
    model.tension_for(goal, friction, drive)
}

fn main() {
    let options = ManipulatorOptions { gravity_m_per_s2: black_box([0.0, -9.81]), ..ManipulatorOptions::published() };
    let params = ManipulatorParams::new(&options).unwrap();
    let mut model = StaticModel::<8>::new(&params).unwrap();
    let drive = Drive::new(&params, &DriveOptions::first_tendon(&params)).unwrap();
    let measured = black_box([1.0; 8]);
    for friction in [
        Friction::None,
        Friction::Coulomb(Direction::Pulling),
        Friction::Measured([&measured, &[]]),
        Friction::History,
    ] {
        black_box(solve(black_box(&mut model), black_box([1.0, 0.2]), black_box(friction)));
        for goal in [Goal::BendRad(0.4), Goal::TipM([0.2, 0.1])] {
            black_box(tension_for(black_box(&mut model), black_box(goal), black_box(friction), black_box(&drive)));
        }
    }
    black_box(model.shape());
}
