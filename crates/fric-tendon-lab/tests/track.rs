//! A path of bends through the inverse, on the independent elastica.

use fric_tendon::{GoalStatus, ManipulatorOptions, ManipulatorParams};
use fric_tendon_lab::shape_errors::Way;
use fric_tendon_lab::simulate::track::{Track, TrackOptions, track};

/// Thirty bends with reversals of all sizes, rad.
const PATH_RAD: [f64; 30] = [
    0.4, 0.9, 0.7, 1.2, 1.1, 1.15, 0.6, 0.65, 0.5, 1.4, 1.3, 1.35, 1.0, 0.3, 0.45, 0.4, 0.8, 0.75, 1.5, 1.2, 1.25, 1.0,
    1.1, 0.9, 0.55, 0.6, 1.3, 1.25, 0.7, 0.85,
];

fn tracks(seed: u64) -> Vec<Track> {
    let params = ManipulatorParams::new(&ManipulatorOptions::published()).unwrap();
    let options = TrackOptions { bend_rad: PATH_RAD.to_vec(), seed, mu_spread_ratio: 0.1, link_count: 6 };
    track(&params, &options).unwrap()
}

#[test]
fn the_history_brings_the_tip_where_it_is_wanted() {
    let tracks = tracks(3);
    let mean_m = |way: Way| tracks.iter().find(|track| track.way == way).unwrap().mean_error_m();
    let [none_m, coulomb_m, history_m] = [Way::None, Way::Coulomb, Way::History].map(mean_m);
    // Friction of the published μ costs millimetres on an arm of 0.3 m.
    assert!(none_m > 0.004, "{none_m}");
    assert!(history_m <= 0.15 * none_m, "{history_m} {none_m}");
    // What is left is mostly across the tip's curve, where friction of both directions bends the arm unevenly and no tension helps.
    assert!(history_m <= 0.7 * coulomb_m, "{history_m} {coulomb_m}");
    let history = tracks.iter().find(|track| track.way == Way::History).unwrap();
    let has = |flag: GoalStatus| history.goals.iter().filter(|goal| goal.status.contains(flag)).count();
    // Small steps back stay in the dead band of some hole; a long one turns all holes round.
    assert!(has(GoalStatus::REVERSAL) > 0 && has(GoalStatus::DEAD_BAND) > 0);
}
