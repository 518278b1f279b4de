//! The inverse of the static model: goals to tensions.

use fric_tendon::{
    Command, Direction, Drive, DriveOptions, Friction, Goal, GoalStatus, ManipulatorOptions, ManipulatorParams,
    StaticModel,
};

/// Bends with reversals of all sizes, rad.
const PATH_RAD: [f64; 12] = [0.3, 0.9, 0.88, 0.89, 0.5, 0.52, 1.4, 1.1, 1.1, 0.2, 0.25, 1.6];

fn params(options: &ManipulatorOptions<'_>) -> ManipulatorParams {
    ManipulatorParams::new(options).unwrap()
}

fn published() -> (StaticModel<8>, Drive) {
    let params = params(&ManipulatorOptions::published());
    let drive = Drive::new(&params, &DriveOptions::first_tendon(&params)).unwrap();
    (StaticModel::new(&params).unwrap(), drive)
}

fn follow(model: &mut StaticModel<8>, drive: &Drive, bend_rad: f64) -> Command {
    let command = model.tension_for(Goal::BendRad(bend_rad), Friction::History, drive);
    assert!(command.status.is_reached(), "{bend_rad} rad: {}", command.status);
    assert!(model.solve(command.base_tension_n, Friction::History).has_shape());
    command
}

#[test]
fn the_arm_goes_where_it_is_wanted() {
    let weight = ManipulatorOptions {
        gravity_m_per_s2: [-2.0, -6.0],
        tip_mass_kg: 0.001,
        disk_mass_kg: 0.001,
        ..ManipulatorOptions::published()
    };
    for options in [ManipulatorOptions::published(), weight] {
        let params = params(&options);
        let drive = Drive::new(&params, &DriveOptions::first_tendon(&params)).unwrap();
        let mut model = StaticModel::<8>::new(&params).unwrap();
        for bend_rad in PATH_RAD {
            let command = follow(&mut model, &drive, bend_rad);
            assert!((model.shape().bend_rad() - bend_rad).abs() < 1e-8, "{bend_rad}");
            assert!((command.bend_rad - model.shape().bend_rad()).abs() < 1e-9);
            let [x, y] = model.shape().disk_position_m()[7];
            assert!((command.tip_m[0] - x).hypot(command.tip_m[1] - y) < 1e-9);
            for friction in [Friction::None, Friction::Coulomb(Direction::Releasing)] {
                let mut other = model.clone();
                let command = other.tension_for(Goal::BendRad(bend_rad), friction, &drive);
                assert!(command.status.is_reached(), "{friction:?}: {}", command.status);
                assert!(other.solve(command.base_tension_n, friction).has_shape());
                assert!((other.shape().bend_rad() - bend_rad).abs() < 1e-8, "{friction:?}");
            }
        }
    }
}

#[test]
fn the_model_is_asked_and_not_moved() {
    let (mut asked, drive) = published();
    let mut alone = asked.clone();
    for tension_n in [0.3, 0.8, 0.7, 0.75] {
        for (goal, friction) in [
            (Goal::BendRad(1.0), Friction::History),
            (Goal::TipM([0.1, 0.2]), Friction::History),
            (Goal::BendRad(0.4), Friction::None),
        ] {
            let _ = asked.tension_for(goal, friction, &drive);
        }
        assert!(asked.solve([tension_n, 0.0], Friction::History).is_ok());
        assert!(alone.solve([tension_n, 0.0], Friction::History).is_ok());
        assert_eq!(asked.shape(), alone.shape());
    }
}

#[test]
fn a_reversal_crosses_the_band_between_coulombs_directions() {
    let (mut model, drive) = published();
    for step in 1..=20 {
        follow(&mut model, &drive, 0.06 * f64::from(step));
    }
    let coulomb = |model: &StaticModel<8>, direction: Direction, bend_rad: f64| {
        let command = model.clone().tension_for(Goal::BendRad(bend_rad), Friction::Coulomb(direction), &drive);
        command.base_tension_n[0]
    };
    let pulled_n = model.shape().base_tension_n(fric_tendon::Tendon::Agonist);
    assert!((pulled_n / coulomb(&model, Direction::Pulling, 1.2) - 1.0).abs() < 3e-3);
    // A hair on, and back: the tendon turns round, and hardly anything moves for much tension.
    let on = model.tension_for(Goal::BendRad(1.201), Friction::History, &drive);
    assert_eq!(on.status, GoalStatus::OK);
    let command = follow(&mut model, &drive, 1.199);
    assert!(command.status.contains(GoalStatus::REVERSAL | GoalStatus::DEAD_BAND), "{}", command.status);
    assert!(pulled_n - command.base_tension_n[0] > 10.0 * (on.base_tension_n[0] - pulled_n), "{command:?} {on:?}");
    // Further: the base has turned, the tip not yet; at last every hole has.
    let command = follow(&mut model, &drive, 1.195);
    assert!(!command.status.contains(GoalStatus::REVERSAL) && command.status.contains(GoalStatus::DEAD_BAND));
    for step in 1..=10 {
        follow(&mut model, &drive, 1.195 - 0.03 * f64::from(step));
    }
    let command = follow(&mut model, &drive, 0.88);
    assert_eq!(command.status, GoalStatus::OK);
    let released_n = coulomb(&model, Direction::Releasing, 0.88);
    assert!((command.base_tension_n[0] / released_n - 1.0).abs() < 3e-3, "{command:?} {released_n}");
}

#[test]
fn both_tendons_bend_both_ways() {
    let params = params(&ManipulatorOptions::published());
    let options = DriveOptions { least_tension_n: [0.1; 2], greatest_tension_n: [4.0; 2], hold_rad: 0.0 };
    let drive = Drive::new(&params, &options).unwrap();
    let (mut one, mut other) = (StaticModel::<8>::new(&params).unwrap(), StaticModel::<8>::new(&params).unwrap());
    for bend_rad in [0.4, -0.3, -0.8, -0.75, 0.1, 1.2] {
        let command = follow(&mut one, &drive, bend_rad);
        let mirrored = follow(&mut other, &drive, -bend_rad);
        let ([first_n, second_n], [mirrored_first_n, mirrored_second_n]) =
            (command.base_tension_n, mirrored.base_tension_n);
        assert!((first_n - mirrored_second_n).abs() < 1e-6 && (second_n - mirrored_first_n).abs() < 1e-6);
        assert!(first_n.min(second_n) == 0.1, "{command:?}");
        assert!((one.shape().bend_rad() - bend_rad).abs() < 1e-8);
    }
}

#[test]
fn the_tip_comes_as_near_as_its_curve() {
    let (mut model, drive) = published();
    assert!(model.solve([0.5, 0.0], Friction::History).is_ok());
    let [x, y] = model.shape().disk_position_m()[7];
    for (goal_m, is_near) in [([x - 0.02, y + 0.05], true), ([x - 0.03, y + 0.02], false)] {
        let command = model.tension_for(Goal::TipM(goal_m), Friction::History, &drive);
        let distance_m = |[x, y]: [f64; 2]| (x - goal_m[0]).hypot(y - goal_m[1]);
        // By trying: no tension brings the tip nearer.
        let tried = (1..400).map(|step| {
            let mut model = model.clone();
            assert!(model.solve([0.5 + 0.002 * f64::from(step), 0.0], Friction::History).has_shape());
            distance_m(model.shape().disk_position_m()[7])
        });
        let nearest_m = tried.fold(f64::INFINITY, f64::min);
        assert!(distance_m(command.tip_m) < nearest_m + 2e-4, "{command:?} {nearest_m}");
        assert!(nearest_m - distance_m(command.tip_m) < 1e-3);
        assert_eq!(command.status.is_reached(), is_near && nearest_m < 0.003, "{} {nearest_m}", command.status);
    }
}

#[test]
fn what_cannot_be_is_a_status() {
    let (mut model, drive) = published();
    follow(&mut model, &drive, 0.8);
    let before = *model.shape();
    let before_n = before.base_tension_n(fric_tendon::Tendon::Agonist);
    let ask = |model: &mut StaticModel<8>, goal: Goal| model.tension_for(goal, Friction::History, &drive);
    for goal in [Goal::BendRad(f64::NAN), Goal::BendRad(f64::INFINITY), Goal::TipM([0.1, f64::NAN])] {
        let command = ask(&mut model, goal);
        assert_eq!(command.status, GoalStatus::NOT_USABLE);
        assert_eq!(command.base_tension_n[0], before_n);
    }
    let measured = model.tension_for(Goal::BendRad(0.5), Friction::Measured([&[0.5; 8], &[]]), &drive);
    assert_eq!(measured.status, GoalStatus::NOT_USABLE);
    // A tip far within the arm's curve: whatever is not found leaves the tensions.
    let command = ask(&mut model, Goal::TipM([0.1, 0.1]));
    assert!(
        !command.status.contains(GoalStatus::NOT_CONVERGED) || command.base_tension_n[0] == before_n,
        "{command:?}"
    );
    // More than the capacity bends, and less than nothing.
    let command = ask(&mut model, Goal::BendRad(20.0));
    assert!(command.status.contains(GoalStatus::OUT_OF_REACH), "{command:?}");
    assert!(command.base_tension_n[0] > before_n);
    let command = ask(&mut model, Goal::BendRad(-0.5));
    assert!(command.status.contains(GoalStatus::OUT_OF_REACH), "{command:?}");
    assert!(command.base_tension_n[0] < 1e-9, "{command:?}");
    let params = *model.params();
    let near = DriveOptions { hold_rad: 1e-3, ..DriveOptions::first_tendon(&params) };
    let held = Drive::new(&params, &near).unwrap();
    let command = model.tension_for(Goal::BendRad(0.8005), Friction::History, &held);
    assert_eq!((command.status, command.base_tension_n[0]), (GoalStatus::HELD, before_n));
    assert_eq!(*model.shape(), before);
    assert_eq!(format!("{}", GoalStatus::REVERSAL | GoalStatus::DEAD_BAND), "REVERSAL|DEAD_BAND");
    assert_eq!(format!("{}", GoalStatus::OK), "ok");
    let refused = |options: &DriveOptions| Drive::new(&params, options).unwrap_err().to_string();
    let good = DriveOptions::first_tendon(&params);
    assert_eq!(
        refused(&DriveOptions { greatest_tension_n: [5.0, 0.0], ..good }),
        "`greatest_tension_n` of the tendon is 5; allowed is 0 to 4"
    );
    assert_eq!(
        refused(&DriveOptions { least_tension_n: [0.0, f64::NAN], ..good }).split_once(' ').unwrap().0,
        "`least_tension_n`"
    );
}
