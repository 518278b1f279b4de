//! A step through the C interface does not allocate: counted by an allocator of this binary's own.
#![allow(clippy::unwrap_used, clippy::undocumented_unsafe_blocks, reason = "a test")]

use allocation_counter::measure;
use fric::{
    FRIC_FRICTION_NONE, FRIC_TEXT_SIZE, Outcome, ShapeSignals, fric_reset, fric_static_model_copy_state,
    fric_static_model_reset, fric_status_text,
};

mod support;

#[test]
fn a_step_does_not_allocate() {
    let mut handle = None;
    assert!(measure(|| handle = Some(support::robot())).count_total > 0, "the counter does not count");
    let handle = handle.unwrap();
    let mut flagged = 0;
    let counted = measure(|| {
        for cycle in 0..2000 {
            let mut cables = support::signals(cycle);
            if cycle % 5 == 0 {
                cables[1].sensor_force_n = f64::NAN;
            }
            let pose = (cycle % 3 != 0).then_some(&support::POSE);
            let (results, _) = support::step(&handle, &cables, pose);
            let mut text = [0; FRIC_TEXT_SIZE];
            assert!(unsafe { fric_status_text(results[1].status, text.as_mut_ptr(), text.len()) } > 0);
            flagged += results.iter().filter(|result| result.status != 0).count();
            if cycle == 1000 {
                assert_eq!(unsafe { fric_reset(handle.0) }, Outcome::Ok);
            }
        }
    });
    assert_eq!(counted.count_total, 0);
    assert!(flagged > 500, "{flagged} flagged cycles are too few to mean anything");
}

#[test]
fn a_solution_and_a_command_do_not_allocate() {
    let (model, kept) = (support::model(), support::model());
    let mut flagged = 0;
    let counted = measure(|| {
        for step in 0..200 {
            let phase = f64::from(step % 20);
            let wanted = if step % 9 == 0 { f64::NAN } else { 0.3 + 0.05 * phase };
            let command = support::command_for(&model, &support::goal(wanted));
            let base_n = if step % 7 == 0 { [f64::NAN, 0.0] } else { command.base_tension_n };
            let (_, shape) = support::solve(&model, &support::shape_input(base_n));
            let input = ShapeSignals { friction: FRIC_FRICTION_NONE, ..support::shape_input([0.5, 0.1]) };
            support::solve(&model, &input);
            flagged += u32::from(command.status != 0) + u32::from(shape.status != 0);
            if step % 50 == 0 {
                assert_eq!(unsafe { fric_static_model_copy_state(kept.0, model.0) }, Outcome::Ok);
                assert_eq!(unsafe { fric_static_model_reset(model.0) }, Outcome::Ok);
                assert_eq!(unsafe { fric_static_model_copy_state(model.0, kept.0) }, Outcome::Ok);
            }
        }
    });
    assert_eq!(counted.count_total, 0);
    assert!(flagged > 30, "{flagged} flagged steps are too few to mean anything");
}
