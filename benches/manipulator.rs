//! One static solution of the published manipulator by each way of friction, its inverse, and a run of 60 s at 1 kHz by the history.
//!
//! `cargo bench -p fric-tendon --bench manipulator`

#![allow(
    missing_docs,
    clippy::print_stdout,
    clippy::expect_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Instant;

use criterion::Criterion;
use fric_tendon::{Direction, Drive, DriveOptions, Friction, Goal, ManipulatorOptions, ManipulatorParams, StaticModel};

fn model() -> StaticModel<8> {
    let params = ManipulatorParams::new(&ManipulatorOptions::published()).expect("published");
    StaticModel::new(&params).expect("eight disks")
}

/// Pulled and released between 0.2 and 1.6 N, with smaller movements on top, at 1 kHz.
fn tension_n(sample: u32) -> f64 {
    let time_s = 1e-3 * f64::from(sample);
    0.9 + 0.55 * (TAU * 0.11 * time_s).sin() + 0.15 * (TAU * 0.7 * time_s).sin()
}

/// The mean, by Criterion; one iteration is one solution, from sample to sample, and from the unloaded manipulator.
fn mean(criterion: &mut Criterion) {
    let ways = [
        ("none", Friction::None),
        ("coulomb", Friction::Coulomb(Direction::Pulling)),
        ("measured", Friction::Measured([&[1.2, 1.15, 1.1, 1.06, 1.02, 0.98, 0.95, 0.92], &[]])),
        ("history", Friction::History),
    ];
    let mut group = criterion.benchmark_group("manipulator");
    for (name, friction) in ways {
        let (mut model, mut sample) = (model(), 0);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                sample = (sample + 1) % 60_000;
                model.solve(black_box([tension_n(sample), 0.0]), friction)
            });
        });
    }
    let mut inverse = model();
    let drive = Drive::new(inverse.params(), &DriveOptions::first_tendon(inverse.params())).expect("a drive");
    let mut sample = 0;
    group.bench_function("inverse and history", |bencher| {
        bencher.iter(|| {
            sample = (sample + 1) % 60_000;
            let goal = Goal::BendRad(black_box(tension_n(sample)));
            let command = inverse.tension_for(goal, Friction::History, &drive);
            inverse.solve(command.base_tension_n, Friction::History)
        });
    });
    let mut far = model();
    group.bench_function("coulomb from the unloaded manipulator", |bencher| {
        bencher.iter(|| {
            far.reset();
            far.solve(black_box([1.2, 0.0]), Friction::Coulomb(Direction::Pulling))
        });
    });
    group.finish();
}

/// The whole run, and its longest step: each step's fastest of three runs, which leaves out what the machine does beside it.
fn run(samples: u32) {
    let mut steps_s = vec![f64::INFINITY; samples as usize];
    let (mut fastest_s, mut missing) = (f64::INFINITY, 0);
    for _ in 0..3 {
        let mut model = model();
        let start = Instant::now();
        for (sample, step_s) in (0..samples).zip(&mut steps_s) {
            let step = Instant::now();
            let status = model.solve([tension_n(sample), 0.0], Friction::History);
            *step_s = step_s.min(step.elapsed().as_secs_f64());
            missing += u32::from(!status.has_shape());
        }
        fastest_s = fastest_s.min(start.elapsed().as_secs_f64());
    }
    steps_s.sort_by(f64::total_cmp);
    let at = |share: f64| 1e6 * steps_s[(share * f64::from(samples - 1)) as usize];
    println!(
        "history, {samples} samples: {fastest_s:.2} s; a step: median {:.0}, 99.9 % {:.0}, longest {:.0} us; {missing} without a shape",
        at(0.5),
        at(0.999),
        at(1.0)
    );
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    mean(&mut criterion);
    criterion.final_summary();
    // `cargo test --benches` runs every bench once to see that it works.
    run(if std::env::args().any(|argument| argument == "--bench") { 60_000 } else { 100 });
}
