//! The state of a manipulator's model: kept, restored, and carried elsewhere as words.

use fric_tendon::{
    AnyStaticModel, Drive, DriveOptions, Friction, Goal, ManipulatorOptions, ManipulatorParams, StaticModel, Tendon,
};

/// An arm of so many disks as long as the published one.
fn params(disk_count: usize) -> ManipulatorParams {
    let count = u32::try_from(disk_count).map(f64::from).unwrap();
    let options = ManipulatorOptions { disk_count, pitch_m: &[0.296 / count], ..ManipulatorOptions::published() };
    ManipulatorParams::new(&options).unwrap()
}

/// Pulled and released, with reversals.
fn tension_n(step: u32) -> [f64; 2] {
    let time = f64::from(step);
    [0.6 + 0.4 * (0.21 * time).sin() + 0.1 * (1.3 * time).sin(), 0.1]
}

/// Everything that comes out of some steps, as bits.
fn outcome(model: &mut AnyStaticModel, steps: std::ops::Range<u32>) -> Vec<u64> {
    let drive = Drive::new(model.params(), &DriveOptions::first_tendon(model.params())).unwrap();
    let mut numbers = Vec::new();
    for step in steps {
        assert!(model.solve(tension_n(step), Friction::History).has_shape());
        let command = model.tension_for(Goal::BendRad(0.5), Friction::History, &drive);
        numbers.extend([model.bend_rad(), command.base_tension_n[0]]);
        numbers.extend(model.disk_position_m().as_flattened());
        numbers.extend(Tendon::BOTH.iter().flat_map(|tendon| model.friction_n(*tendon)));
    }
    numbers.iter().map(|number| number.to_bits()).collect()
}

#[test]
fn it_goes_on_with_the_same_bits() {
    for disk_count in [4, 8, 9, 20] {
        let params = params(disk_count);
        let fresh = || AnyStaticModel::new(&params).unwrap();
        let mut model = fresh();
        // Before the first step too.
        let words = fresh().state_words();
        outcome(&mut model, 0..12);
        let kept = model.clone();
        let (mut other, mut third) = (fresh(), fresh());
        outcome(&mut other, 5..9);
        other.copy_state(&kept).unwrap();
        third.restore_words(&model.state_words()).unwrap();
        let expected = outcome(&mut model, 12..24);
        assert_eq!(outcome(&mut other, 12..24), expected);
        assert_eq!(outcome(&mut third, 12..24), expected);
        assert_ne!(outcome(&mut fresh(), 12..24), expected);
        assert_eq!(third.state_words(), model.state_words());
        third.restore_words(&words).unwrap();
        assert_eq!(outcome(&mut third, 0..4), outcome(&mut fresh(), 0..4));
    }
}

#[test]
fn a_state_of_another_arm_is_refused_and_changes_nothing() {
    let mut model = AnyStaticModel::new(&params(8)).unwrap();
    outcome(&mut model, 0..4);
    let before = model.state_words();
    for disk_count in [7, 9] {
        let other = AnyStaticModel::new(&params(disk_count)).unwrap();
        let text = format!("the state is of a manipulator with {disk_count} disks, this one has 8");
        assert_eq!(model.copy_state(&other).unwrap_err().to_string(), text);
        assert_eq!(model.restore_words(&other.state_words()).unwrap_err().to_string(), text);
    }
    assert!(model.restore_words(&before[1..]).is_err() && model.restore_words(&[]).is_err());
    assert_eq!(model.state_words(), before);
    let mut one = StaticModel::<8>::new(&params(8)).unwrap();
    assert!(one.restore(&StaticModel::<8>::new(&params(7)).unwrap().snapshot()).is_err());
    let snapshot = one.snapshot();
    assert!(one.solve([1.0, 0.0], Friction::History).is_ok() && one.snapshot() != snapshot);
    one.restore(&snapshot).unwrap();
    assert_eq!(one.snapshot(), snapshot);
}
