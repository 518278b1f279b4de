//! How far the inverse leaves the simulated manipulator's tip from its goals, for the table of docs/manipulators.md:
//! `cargo run --release -p fric-tendon-lab --example tendon_track [RUNS] [SEED]`.
#![allow(
    missing_docs,
    clippy::cast_precision_loss,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a measurement that may fail by panicking; all counts are small"
)]

use fric_tendon::{ManipulatorOptions, ManipulatorParams};
use fric_tendon_lab::follow::Goals;
use fric_tendon_lab::simulate::track::{Track, TrackOptions, pulled_tips, track};

/// The path of crates/fric-tendon-lab/tests/track.rs: thirty bends with reversals of all sizes, rad.
const PATH_RAD: [f64; 30] = [
    0.4, 0.9, 0.7, 1.2, 1.1, 1.15, 0.6, 0.65, 0.5, 1.4, 1.3, 1.35, 1.0, 0.3, 0.45, 0.4, 0.8, 0.75, 1.5, 1.2, 1.25, 1.0,
    1.1, 0.9, 0.55, 0.6, 1.3, 1.25, 0.7, 0.85,
];

/// One quantity of a path by each friction model, in mm or mrad.
struct Row {
    name: &'static str,
    of: fn(&Track) -> f64,
    values: Vec<[f64; 3]>,
}

impl Row {
    fn new(name: &'static str, of: fn(&Track) -> f64) -> Self {
        Self { name, of, values: Vec::new() }
    }

    fn add(&mut self, tracks: &[Track]) {
        self.values.push([0, 1, 2].map(|way: usize| 1e3 * (self.of)(&tracks[way])));
    }

    fn print(&self) {
        let spread = |of: &dyn Fn(&[f64; 3]) -> f64| {
            let all: Vec<f64> = self.values.iter().map(of).collect();
            let (least, greatest) = all.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
            format!("{:.3} ({least:.3} to {greatest:.3})", all.iter().sum::<f64>() / all.len() as f64)
        };
        println!("  {}", self.name);
        for (way, name) in ["none", "coulomb", "history"].into_iter().enumerate() {
            println!("    {name:8} {}", spread(&|values| values[way]));
        }
        println!("    history/none    {}", spread(&|values| values[2] / values[0]));
        println!("    history/coulomb {}", spread(&|values| values[2] / values[1]));
    }
}

fn main() {
    let arguments: Vec<u64> = std::env::args().skip(1).filter_map(|one| one.parse().ok()).collect();
    let (count, first) = (arguments.first().copied().unwrap_or(4), arguments.get(1).copied().unwrap_or(0));
    let params = ManipulatorParams::new(&ManipulatorOptions::published()).unwrap();
    for mu_spread_ratio in [0.0, 0.1] {
        let rows = || {
            vec![
                Row::new("distance, mm", Track::mean_error_m),
                Row::new("along the tip's curve, mm", Track::mean_along_m),
            ]
        };
        let (mut by_tip, mut by_bend) = (rows(), rows());
        by_bend.push(Row::new("bend, mrad", |track| track.mean_bend_error_rad().unwrap()));
        for seed in first..first + if mu_spread_ratio > 0.0 { count } else { 1 } {
            let bends = TrackOptions { seed, mu_spread_ratio, ..TrackOptions::new(Goals::BendRad(PATH_RAD.to_vec())) };
            let tips = TrackOptions { goals: Goals::TipM(pulled_tips(&params, &bends).unwrap()), ..bends.clone() };
            for (rows, options) in [(&mut by_tip, &tips), (&mut by_bend, &bends)] {
                let tracks = track(&params, options).unwrap();
                for row in rows.iter_mut() {
                    row.add(&tracks);
                }
            }
        }
        for (what, rows) in [("tip positions of a single pull", by_tip), ("bends", by_bend)] {
            println!("μ ± {:.0} %, goals: {what}; mean (least to greatest of the seeds)", 100.0 * mu_spread_ratio);
            for row in &rows {
                row.print();
            }
        }
    }
}
