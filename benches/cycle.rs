//! One cycle of 8 cables with 3 pulleys each, geometry and wrench included: the mean, the worst beside it, and the mean for each of
//! 4 to 64 cables; and beside it the pose of 8 lengths, which is offline.
//!
//! `cargo bench -p fric-core --bench cycle`

#![allow(missing_docs, clippy::print_stdout, clippy::expect_used, clippy::cast_precision_loss)]

#[path = "support/mod.rs"]
mod support;

use std::hint::black_box;
use std::time::Instant;

use criterion::Criterion;
use fric_core::forward::PoseFollower;
use fric_core::robot::{MonitorOptions, PlatformOptions, Presliding};
use fric_core::{CableParams, RobotParams};
use support::{CABLES, CYCLE_S, CYCLES, best_ns, cable_options, compensator, inputs};

const FORMS: [(&str, Presliding); 2] = [("lumped", Presliding::Lumped), ("per_pulley", Presliding::PerPulley)];

/// The mean, by Criterion; one iteration is one cycle.
fn mean(criterion: &mut Criterion) {
    let inputs = inputs::<CABLES>();
    let mut group = criterion.benchmark_group("cycle");
    for (name, presliding) in FORMS {
        let mut compensator = compensator::<CABLES>(presliding);
        let mut order = inputs.iter().cycle();
        group.bench_function(name, |bencher| {
            bencher.iter(|| compensator.step(black_box(order.next().expect("never ends"))));
        });
    }
    group.finish();
}

/// The pose of the lengths of a sample beside the cycle of that sample.
fn pose_from_lengths(criterion: &mut Criterion) {
    let inputs = inputs::<CABLES>();
    let cables =
        cable_options::<CABLES>(Presliding::PerPulley).map(|options| CableParams::new(&options).expect("good options"));
    let monitor = MonitorOptions::for_cycle(CYCLE_S);
    let robot = RobotParams::new(CYCLE_S, &PlatformOptions::default(), monitor, &cables).expect("good robot");
    let (mut follower, mut order) = (PoseFollower::default(), inputs.iter().cycle());
    criterion.bench_function("pose from lengths", |bencher| {
        bencher.iter(|| {
            let input = order.next().expect("never ends");
            follower.next_pose(&robot, black_box(&input.cables)).expect("lengths of a pose")
        });
    });
}

/// Single cycles with a clock around each: percentiles in nanoseconds, the clock's own cost taken off.
fn worst(rounds: usize) {
    let inputs = inputs::<CABLES>();
    let mut clock_ns: Vec<u128> = (0..10_000).map(|_| Instant::now().elapsed().as_nanos()).collect();
    clock_ns.sort_unstable();
    let clock_ns = clock_ns[clock_ns.len() / 2];
    println!("single cycles, ns (the clock's {clock_ns} ns taken off):");
    for (name, presliding) in FORMS {
        let mut compensator = compensator::<CABLES>(presliding);
        let mut spans_ns: Vec<u128> = Vec::with_capacity(rounds * CYCLES);
        for _ in 0..rounds {
            for input in &inputs {
                let start = Instant::now();
                let output = compensator.step(black_box(input));
                let elapsed_ns = start.elapsed().as_nanos();
                black_box(&output);
                spans_ns.push(elapsed_ns.saturating_sub(clock_ns));
            }
        }
        spans_ns.sort_unstable();
        let last = spans_ns.len() - 1;
        let at = |thousandths: usize| spans_ns[last * thousandths / 100_000];
        println!(
            "  {name}: median {}, 99 % {}, 99.9 % {}, 99.99 % {}, worst {} of {}",
            at(50_000),
            at(99_000),
            at(99_900),
            at(99_990),
            spans_ns[last],
            spans_ns.len(),
        );
    }
}

/// ns per cable of one cycle.
fn per_cable_ns<const COUNT: usize>(presliding: Presliding, rounds: usize) -> f64 {
    best_ns::<COUNT>(presliding, rounds) / COUNT as f64
}

/// What a cable costs among few and among many.
fn counts(rounds: usize) {
    println!("a cable's share of the cycle in the best of {rounds} rounds, ns, of 4, 8, 16, 32, 64 cables:");
    for (name, presliding) in FORMS {
        let [four, eight, sixteen, many, most] = [
            per_cable_ns::<4>(presliding, rounds),
            per_cable_ns::<8>(presliding, rounds),
            per_cable_ns::<16>(presliding, rounds),
            per_cable_ns::<32>(presliding, rounds),
            per_cable_ns::<64>(presliding, rounds),
        ];
        println!("  {name}: {four:.1}, {eight:.1}, {sixteen:.1}, {many:.1}, {most:.1}");
    }
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    mean(&mut criterion);
    pose_from_lengths(&mut criterion);
    criterion.final_summary();
    // `cargo test --benches` runs every bench once to see that it works.
    let rounds = if std::env::args().any(|argument| argument == "--bench") { 50 } else { 1 };
    worst(rounds);
    counts(rounds);
}
