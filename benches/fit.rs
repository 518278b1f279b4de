//! Times the identification of a robot's cables from a log, and prints what it finds: for `benches/peers/fit/run.sh`.
//!
//! `fit LOG ROBOT` prints `cable NAME mu sigma F_pv offset samples evaluations` for each cable, then
//! `seconds` and `processor_seconds`: the fit of all cables alone, without reading, median of three. `RAYON_NUM_THREADS`
//! says on how many threads. Processor time is the kernel's (Linux), of all threads together: what others do on the
//! machine disturbs it less.

#![allow(missing_docs, clippy::print_stdout, clippy::expect_used)]
#![allow(clippy::panic, reason = "a tool for developers: a wrong command line stops it")]

use std::path::{Path, PathBuf};
use std::time::Instant;

use fric_core::parameters::{MU, OFFSET, SIGMA, VISCOUS};
use fric_core::robot::file::RobotFile;
use fric_lab::fit::{CableFit, FitOptions, Measurements, Progress, Reference, fit_cables};
use fric_log::recording::Recording;
use fric_log::signals::{Role, SignalPaths, SignalReader};

const RUNS: usize = 3;

/// Time that all threads have spent on processors, s; NaN where the kernel does not tell.
fn processor_seconds() -> f64 {
    let nanos = |thread: PathBuf| {
        let text = std::fs::read_to_string(thread.join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    let Ok(threads) = std::fs::read_dir("/proc/self/task") else { return f64::NAN };
    threads.flatten().map(|thread| nanos(thread.path()).unwrap_or(f64::NAN)).sum::<f64>() * 1e-9
}

fn median(mut times: [f64; RUNS]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [log, robot] = arguments.as_slice() else { panic!("usage: fit LOG ROBOT") };
    let robot = RobotFile::read(Path::new(robot)).expect("a robot file");
    let topics = &robot.options().log;
    let path = |topic: &str| Some(topic.parse().expect("a topic"));
    let paths = SignalPaths::default()
        .with(Role::Cable, path(&topics.cable))
        .with(Role::Reference, path(&topics.reference))
        .with(Role::Pose, path(&topics.pose));
    let recording = Recording::open(&[log]).expect("a log");
    let mut reader = SignalReader::new(recording, paths, &robot.cable_names());
    let params = robot.params();
    let mut measurements = Measurements::new(&params, Reference::Forces);
    while let Some(sample) = reader.next_row().expect("a readable log") {
        measurements.add(&sample);
    }

    let mut fits: Vec<CableFit> = Vec::new();
    let times = [(); RUNS].map(|()| {
        let (start, processor) = (Instant::now(), processor_seconds());
        fits = fit_cables(&measurements, &FitOptions::default(), &Progress::new());
        (start.elapsed().as_secs_f64(), processor_seconds() - processor)
    });
    for (name, CableFit { values, samples, evaluation_count, .. }) in robot.cable_names().iter().zip(&fits) {
        let [mu, sigma, viscous, offset] = [MU, SIGMA, VISCOUS, OFFSET].map(|place| values[place]);
        println!("cable {name} {mu} {sigma} {viscous} {offset} {} {evaluation_count}", samples.used);
    }
    println!("seconds {:.6}", median(times.map(|(seconds, _)| seconds)));
    println!("processor_seconds {:.6}", median(times.map(|(_, processor)| processor)));
}
