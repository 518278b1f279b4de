//! A step through the C interface does not allocate: counted by an allocator of this binary's own.
#![allow(clippy::unwrap_used, clippy::undocumented_unsafe_blocks, reason = "a test")]

use allocation_counter::measure;
use fric::{Outcome, fric_reset};

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
            flagged += results.iter().filter(|result| result.status != 0).count();
            if cycle == 1000 {
                assert_eq!(unsafe { fric_reset(handle.0) }, Outcome::Ok);
            }
        }
    });
    assert_eq!(counted.count_total, 0);
    assert!(flagged > 500, "{flagged} flagged cycles are too few to mean anything");
}
