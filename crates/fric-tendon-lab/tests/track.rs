//! A path of goals through the inverse, on the independent elastica.

use fric_tendon::file::ManipulatorFile;
use fric_tendon::{
    Drive, DriveOptions, Friction, Goal, GoalStatus, ManipulatorOptions, ManipulatorParams, StaticModel,
};
use fric_tendon_lab::ContinuumError;
use fric_tendon_lab::follow::{FollowedGoal, Follower, GoalPath, Goals};
use fric_tendon_lab::shape_errors::Way;
use fric_tendon_lab::simulate::track::{Track, TrackOptions, pulled_tips, track};

/// Thirty bends with reversals of all sizes, rad.
const PATH_RAD: [f64; 30] = [
    0.4, 0.9, 0.7, 1.2, 1.1, 1.15, 0.6, 0.65, 0.5, 1.4, 1.3, 1.35, 1.0, 0.3, 0.45, 0.4, 0.8, 0.75, 1.5, 1.2, 1.25, 1.0,
    1.1, 0.9, 0.55, 0.6, 1.3, 1.25, 0.7, 0.85,
];

fn params() -> ManipulatorParams {
    ManipulatorParams::new(&ManipulatorOptions::published()).unwrap()
}

fn options(bend_rad: &[f64]) -> TrackOptions {
    TrackOptions { seed: 3, link_count: 6, ..TrackOptions::new(Goals::BendRad(bend_rad.to_vec())) }
}

fn by(tracks: &[Track], of: fn(&Track) -> f64) -> [f64; 3] {
    [Way::None, Way::Coulomb, Way::History].map(|way| of(tracks.iter().find(|track| track.way == way).unwrap()))
}

#[test]
fn the_history_brings_the_tip_where_it_is_wanted() {
    let params = params();
    let bends = options(&PATH_RAD);
    let tips = TrackOptions { goals: Goals::TipM(pulled_tips(&params, &bends).unwrap()), ..bends };
    let tracks = track(&params, &tips).unwrap();
    let [none_m, coulomb_m, history_m] = by(&tracks, Track::mean_error_m);
    // Friction of the published μ costs millimetres on an arm of 0.3 m.
    assert!(none_m > 0.004, "{none_m}");
    assert!(history_m <= 0.15 * none_m, "{history_m} {none_m}");
    // What is left is mostly across the tip's curve, where friction of both directions bends the arm unevenly and no tension helps.
    assert!(history_m <= 0.7 * coulomb_m, "{history_m} {coulomb_m}");
    let [none_m, coulomb_m, history_m] = by(&tracks, Track::mean_along_m);
    assert!(history_m <= 0.05 * none_m && history_m <= 0.3 * coulomb_m, "{none_m} {coulomb_m} {history_m}");
    let history = tracks.iter().find(|track| track.way == Way::History).unwrap();
    let has = |flag: GoalStatus| history.goals.iter().filter(|goal| goal.status.contains(flag)).count();
    // Small steps back stay in the dead band of some hole; a long one turns all holes round.
    assert!(has(GoalStatus::REVERSAL) > 0 && has(GoalStatus::DEAD_BAND) > 0);
}

#[test]
fn the_history_brings_the_bend_to_where_it_is_wanted() {
    let tracks = track(&params(), &options(&PATH_RAD)).unwrap();
    let [none_rad, coulomb_rad, history_rad] = by(&tracks, |track| track.mean_bend_error_rad().unwrap());
    assert!(none_rad > 0.04, "{none_rad}");
    assert!(history_rad <= 0.05 * none_rad && history_rad <= 0.3 * coulomb_rad, "{coulomb_rad} {history_rad}");
    // The parts of a distance do not exceed it.
    for goal in tracks.iter().flat_map(|track| &track.goals) {
        assert!(goal.along_m.abs() <= goal.error_m() + 1e-12);
    }
}

#[test]
fn a_pull_reaches_some_bends_only() {
    let refused = |bend_rad: &[f64]| track(&params(), &options(bend_rad)).unwrap_err();
    assert!(matches!(refused(&[0.3, 7.0]), ContinuumError::NotPulledTo { row: 2, .. }));
    assert!(matches!(refused(&[0.3, f64::NAN]), ContinuumError::NotFinite { row: 2, .. }));
    let sentence = refused(&[-0.2]).to_string();
    assert!(
        sentence.starts_with(
            "the simulated manipulator has no bend of -0.2000 rad (goal 1): a pull takes it from 0.0000 to "
        )
    );
}

#[test]
fn commands_are_those_of_the_model() {
    let params = params();
    let drive = Drive::new(&params, &DriveOptions::first_tendon(&params)).unwrap();
    let goals = [0.4, 0.9, 0.7, 0.72, 0.72, 0.5].map(Goal::BendRad);
    let before_n = [0.1, 0.6, 0.4].map(|tension_n| [tension_n, 0.0]);
    let mut follower = Follower::new(&params, &drive, Way::History).unwrap();
    let mut model = StaticModel::<8>::new(&params).unwrap();
    assert_eq!(follower.advance(before_n), 0);
    for base_tension_n in before_n {
        assert!(model.solve(base_tension_n, Friction::History).is_ok());
    }
    for goal in goals {
        let command = model.tension_for(goal, Friction::History, &drive);
        assert!(model.solve(command.base_tension_n, Friction::History).is_ok());
        assert_eq!(follower.next(goal), command);
    }
    // Coulomb's law: the holes slide in the direction of each change. A repeated goal keeps its tension.
    let mut coulomb = Follower::new(&params, &drive, Way::Coulomb).unwrap();
    let mut tips = coulomb.clone();
    let bound = |bend_rad: f64, is_pulled: bool| {
        let mut model = StaticModel::<8>::new(&params).unwrap();
        let direction = if is_pulled { fric_tendon::Direction::Pulling } else { fric_tendon::Direction::Releasing };
        model.tension_for(Goal::BendRad(bend_rad), Friction::Coulomb(direction), &drive)
    };
    for (bend_rad, is_pulled) in [(0.4, true), (0.9, true), (0.6, false), (0.75, true), (0.75, true), (0.5, false)] {
        let (command, expected) = (coulomb.next(Goal::BendRad(bend_rad)), bound(bend_rad, is_pulled));
        assert!((command.base_tension_n[0] - expected.base_tension_n[0]).abs() < 1e-9, "{bend_rad}");
        // The place of the tip for that bend leads to the same direction and the same tension.
        let command = tips.next(Goal::TipM(expected.tip_m));
        assert!((command.base_tension_n[0] - expected.base_tension_n[0]).abs() < 1e-6, "{bend_rad}");
    }
}

#[test]
fn paths_are_checked() {
    let column = |name: &str, numbers: &[f64]| (name.to_owned(), numbers.to_vec());
    let path = |columns: &[(String, Vec<f64>)]| GoalPath::from_columns(columns);
    let (x, y) = (column("tip_x_m", &[0.2, 0.21]), column("tip_y_m", &[0.1, 0.12]));
    let tips = path(&[column("time_s", &[0.0, 0.5]), x.clone(), y.clone()]).unwrap();
    assert_eq!(tips.goals(), &Goals::TipM(vec![[0.2, 0.1], [0.21, 0.12]]));
    assert_eq!(tips.time_s(), Some(&[0.0, 0.5][..]));
    let said = |columns: &[(String, Vec<f64>)]| path(columns).unwrap_err().to_string();
    assert_eq!(said(&[column("time_s", &[0.0])]), ContinuumError::NoGoals.to_string());
    assert_eq!(
        said(&[x.clone(), y.clone(), column("bend_rad", &[0.1, 0.2])]),
        ContinuumError::TwoKindsOfGoals.to_string()
    );
    assert!(said(std::slice::from_ref(&x)).starts_with("column `tip_y_m` is missing beside `tip_x_m`"));
    assert!(said(&[column("bend_deg", &[1.0])]).contains("bend_rad"));
    assert!(said(&[column("bend_rad", &[0.1, f64::NAN])]).starts_with("`bend_rad` is NaN in row 2"));
    let times = said(&[column("time_s", &[0.0, 0.0]), column("bend_rad", &[0.1, 0.2])]);
    assert!(times.starts_with("time goes from 0 s to 0 s at sample 2"), "{times}");
}

#[test]
fn files_are_in_the_terms_of_the_measurement() {
    let text = include_str!("../../../examples/tendon-prototype.toml").to_owned()
        + "\n[markers]\noffset_m = [0.01, -0.02]\nangle_rad = 0.1\n\n[base_sensor]\ngain = 1.1\noffset_n = 0.02\nlag_s = 0.3\n";
    let file = ManipulatorFile::parse(&text, "arm").unwrap();
    let drive = Drive::new(file.params(), &DriveOptions::first_tendon(file.params())).unwrap();
    let ask = |goal: Goal| Follower::new(file.params(), &drive, Way::History).unwrap().next(goal);
    let command = ask(Goal::BendRad(0.8));
    let shown = FollowedGoal::as_measured(&command, &file);
    assert!((shown.tension_base_n[0] - (1.1 * command.base_tension_n[0] + 0.02)).abs() < 1e-12);
    // A rotation by 0.1 rad and a shift; the marker as a goal leads back to the same tension.
    let ([x, y], (sin, cos)) = (command.tip_m, 0.1_f64.sin_cos());
    assert!((shown.tip_m[0] - (0.01 + cos * x - sin * y)).abs() < 1e-12);
    assert!((shown.tip_m[1] - (-0.02 + sin * x + cos * y)).abs() < 1e-12);
    let goals = Goals::TipM(vec![shown.tip_m]).in_base_frame(&file);
    let again = ask(goals.each().next().unwrap());
    assert!((again.base_tension_n[0] - command.base_tension_n[0]).abs() < 1e-6);
}
