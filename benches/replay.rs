//! Replay of the example log, without output, beside the plain `mcap` crate iterating over the same file.
//!
//! Both are given in messages of the file per second, so their ratio is the price of joining, decoding and the cycle.

#![allow(clippy::unwrap_used, reason = "a benchmark that cannot start has nothing else to do")]

use std::hint::black_box;
use std::path::PathBuf;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fric_core::robot::file::RobotFile;
use fric_lab::replay::Replay;
use fric_log::recording::Recording;
use fric_log::signals::{SignalPaths, SignalReader};

fn example(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name)
}

fn replay(robot: &RobotFile) -> f64 {
    let paths = SignalPaths::of_robot(robot).unwrap();
    let recording = Recording::open(&[example("mini-ipanema.mcap")]).unwrap();
    let mut reader = SignalReader::new(recording, paths, &robot.cable_names());
    let mut replay = Replay::new(&robot.params()).unwrap();
    while let Some(row) = reader.next_row().unwrap() {
        replay.step(&row);
    }
    replay.cables().iter().filter_map(|cable| cable.after_n.rms()).sum()
}

/// Iterates with the `mcap` crate as its documentation shows, over the whole file in memory.
fn iterate() -> usize {
    let bytes = std::fs::read(example("mini-ipanema.mcap")).unwrap();
    mcap::MessageStream::new(&bytes).unwrap().map(|message| message.unwrap().data.len()).sum()
}

fn messages() -> u64 {
    let bytes = std::fs::read(example("mini-ipanema.mcap")).unwrap();
    mcap::MessageStream::new(&bytes).unwrap().count() as u64
}

fn benches(criterion: &mut Criterion) {
    let robot = RobotFile::read(&example("mini-ipanema.toml")).unwrap();
    let mut group = criterion.benchmark_group("replay");
    group.throughput(Throughput::Elements(messages())).sample_size(20);
    group.bench_function("mcap crate iterating", |bencher| bencher.iter(|| black_box(iterate())));
    group.bench_function("fric replaying", |bencher| bencher.iter(|| black_box(replay(&robot))));
    group.finish();
}

criterion_group!(all, benches);
criterion_main!(all);
