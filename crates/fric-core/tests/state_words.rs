//! The state of a compensator of any size: it is restored into the same robot only.

use fric_core::effects::{Effect, EffectParams};
use fric_core::robot::{CableOptions, FrictionOptions, Presliding};
use fric_core::{AnyCompensator, CableOutput, CableStatus, RobotParams, SnapshotMismatch};

use crate::support::{
    FRICTION, GUIDE_90, SENSOR_180, SWIVEL, UNMONITORED, checked, corner_cable, platform, smooth_input,
};

const CABLES: usize = 3;

fn cables() -> [CableOptions<'static>; CABLES] {
    core::array::from_fn(|index| corner_cable(index, Presliding::PerPulley))
}

/// The robot of these cables after some cycles.
fn run(cables: &[CableOptions<'_>]) -> AnyCompensator {
    let cables = checked(cables);
    let robot = RobotParams::new(0.001, &platform(), UNMONITORED, &cables).unwrap();
    let mut compensator = AnyCompensator::new(&robot).unwrap();
    for cycle in 0..200 {
        step(&mut compensator, cycle);
    }
    compensator
}

fn step(compensator: &mut AnyCompensator, cycle: usize) -> Vec<CableOutput> {
    let input = smooth_input::<CABLES>(cycle);
    compensator.set_input(&input.cables, input.pose, 1.0);
    compensator.step();
    compensator.outputs().to_vec()
}

fn with_effect(effect: Effect, key: &str, value: f64) -> EffectParams {
    let mut effects = EffectParams::default();
    effects.set(effect, key, value).unwrap();
    effects
}

#[test]
fn a_state_of_a_robot_of_another_structure_is_refused_and_changes_nothing() {
    let mut compensator = run(&cables());
    let before = compensator.state_words();
    // The second of three cables is another one.
    let others = [
        CableOptions { pulleys: &[SENSOR_180, SWIVEL], ..cables()[1] },
        CableOptions { pulleys: &[SENSOR_180, GUIDE_90, GUIDE_90], ..cables()[1] },
        CableOptions { pulleys: &[GUIDE_90, GUIDE_90, SWIVEL], ..cables()[1] },
        CableOptions { presliding: Presliding::Lumped, ..cables()[1] },
        CableOptions { effects: with_effect(Effect::GearBacklash, "play_m", 1e-4), ..cables()[1] },
        CableOptions { effects: with_effect(Effect::TimeDelay, "delay_s", 0.003), ..cables()[1] },
    ];
    for (index, cable) in others.into_iter().enumerate() {
        let mut robot = cables();
        robot[1] = cable;
        let other = run(&robot);
        let refused = SnapshotMismatch { expected: CABLES, found: CABLES, cable: Some(1) };
        assert_eq!(compensator.restore_words(&other.state_words()), Err(refused), "robot {index}");
        assert_eq!(compensator.restore(&other.snapshot()), Err(refused), "robot {index}");
        assert_eq!(compensator.state_words(), before);
    }
    // Nothing but the attachment differs.
    let fixed = cables().map(|cable| CableOptions { pulleys: &[SENSOR_180, GUIDE_90, GUIDE_90], ..cable });
    let mut bare = fixed;
    bare[2].geometry = None;
    let refused = SnapshotMismatch { expected: CABLES, found: CABLES, cable: Some(2) };
    assert_eq!(run(&fixed).restore(&run(&bare).snapshot()), Err(refused));
    assert_eq!(run(&bare).restore(&run(&fixed).snapshot()), Err(refused));
    let text = SnapshotMismatch { expected: CABLES, found: CABLES, cable: Some(1) }.to_string();
    assert!(text.contains("pulleys, attachment, presliding or effects with memory of cable 2 differ"), "{text}");
}

#[test]
fn words_that_are_no_whole_state_are_refused() {
    let mut compensator = run(&cables());
    let before = compensator.state_words();
    let last = before.len() - 1;
    for words in [&[][..], &before[..1], &before[..last], &[u64::MAX; 9]] {
        let refused = compensator.restore_words(words).unwrap_err();
        assert_eq!(refused.to_string(), "the snapshot is incomplete, or of another version of the library");
    }
    let fewer = run(&cables()[..2]).state_words();
    let text = "the snapshot is of a robot with 2 cables, this one has 3";
    assert_eq!(compensator.restore_words(&fewer).unwrap_err().to_string(), text);
    assert_eq!(compensator.state_words(), before);
}

/// Other values of the same model, as after a fit, keep what the friction stores.
#[test]
fn a_state_goes_on_with_other_values_of_the_same_structure() {
    let fitted = cables().map(|cable| CableOptions {
        friction: FrictionOptions { mu: 0.025, ..FRICTION },
        effects: with_effect(Effect::BearingDrag, "drag_n", 0.05),
        ..cable
    });
    let (before, mut after) = (run(&cables()), run(&fitted));
    let mut twin = run(&fitted);
    after.restore_words(&before.state_words()).unwrap();
    twin.restore(&before.snapshot()).unwrap();
    for cycle in 200..300 {
        assert_eq!(step(&mut after, cycle), step(&mut twin, cycle));
    }
    // The last output belongs to it, flags included.
    let mut silent = smooth_input::<CABLES>(300);
    silent.cables[1].sensor_force_n = f64::NAN;
    after.set_input(&silent.cables, silent.pose, 1.0);
    after.step();
    assert!(after.outputs()[1].status.contains(CableStatus::SENSOR_NOT_FINITE));
    twin.restore_words(&after.state_words()).unwrap();
    assert_eq!(twin.outputs(), after.outputs());
    assert_eq!(twin.wrench_status(), after.wrench_status());
}
