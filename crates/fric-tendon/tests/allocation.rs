//! The model of a manipulator does not allocate: counted by an allocator of this binary's own.
#![allow(clippy::unwrap_used, reason = "a test")]

use allocation_counter::measure;
use fric_tendon::{Direction, Drive, DriveOptions, Friction, Goal, ManipulatorOptions, ManipulatorParams, StaticModel};

#[test]
fn the_static_model_does_not_allocate() {
    let options = ManipulatorOptions { gravity_m_per_s2: [0.0, -9.81], ..ManipulatorOptions::published() };
    let params = ManipulatorParams::new(&options).unwrap();
    let measured = [0.7; 8];
    let counted = measure(|| {
        let mut model = StaticModel::<8>::new(&params).unwrap();
        for step in 0..200 {
            let base_n = [0.8 + 0.5 * (0.1 * f64::from(step)).sin(), 0.2];
            let ways = [
                Friction::None,
                Friction::Coulomb(Direction::Releasing),
                Friction::Measured([&measured, &[]]),
                Friction::History,
            ];
            for friction in ways {
                assert!(model.solve(base_n, friction).is_ok());
            }
            assert!(!model.solve([f64::NAN, 0.0], Friction::History).has_shape());
        }
    });
    assert_eq!(counted.count_total, 0);
    assert!(measure(|| drop(std::hint::black_box(vec![1.0, 2.0]))).count_total > 0, "the counter does not count");
}

#[test]
fn the_inverse_does_not_allocate() {
    let params = ManipulatorParams::new(&ManipulatorOptions::published()).unwrap();
    let drive = Drive::new(&params, &DriveOptions::first_tendon(&params)).unwrap();
    let mut reached = 0;
    let counted = measure(|| {
        let mut model = StaticModel::<8>::new(&params).unwrap();
        for step in 0..200 {
            let bend_rad = 0.8 + 0.5 * (0.1 * f64::from(step)).sin();
            let goal = if step % 20 == 0 { Goal::TipM([0.25, 0.1]) } else { Goal::BendRad(bend_rad) };
            for friction in [Friction::None, Friction::Coulomb(Direction::Releasing), Friction::History] {
                let command = model.tension_for(goal, friction, &drive);
                reached += u32::from(command.status.is_reached());
                assert!(!model.tension_for(Goal::BendRad(f64::NAN), friction, &drive).status.is_reached());
                if friction == Friction::History {
                    assert!(model.solve(command.base_tension_n, Friction::History).is_ok());
                }
            }
        }
    });
    assert_eq!(counted.count_total, 0);
    assert!(reached > 500, "{reached}");
}
