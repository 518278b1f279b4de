//! Times the identification of a robot's cables from a log, and prints what it finds: for `benches/peers/fit/run.sh`.
//!
//! `fit LOG ROBOT` prints `cable NAME mu sigma F_pv offset samples warm-up evaluations` for each cable, then
//! `seconds`, the median, and `processor_seconds`, the mean, of the fit of all cables alone, without reading. Processor time is
//! the kernel's (Linux), of all threads together: what others do on the machine disturbs it less.

#![allow(missing_docs, clippy::print_stdout, clippy::expect_used)]
#![allow(clippy::panic, reason = "a tool for developers: a wrong command line stops it")]

use std::path::Path;
use std::time::Instant;

use fric_core::parameters::{MU, OFFSET, SIGMA, VISCOUS};
use fric_core::robot::file::RobotFile;
use fric_lab::fit::{CableFit, FitOptions, Measurements, Progress, Reference, fit_cables};
use fric_log::recording::Recording;
use fric_log::signals::{SignalPaths, SignalReader};

/// Enough for processor time, which comes in ticks.
const RUNS: usize = 15;
/// What user space is told, whatever the kernel counts in.
const TICKS_PER_SECOND: f64 = 100.0;

/// Time that this process has spent on processors, of threads that have ended too, in the kernel's ticks; NaN where it does
/// not tell.
fn processor_ticks() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name of the process, in brackets, may hold anything; user and system time are the 12th and 13th after it.
    let (_, numbers) = text.rsplit_once(") ").unwrap_or_default();
    let ticks = numbers.split(' ').skip(11).take(2).map(|number| number.parse::<f64>().unwrap_or(f64::NAN));
    if numbers.is_empty() { f64::NAN } else { ticks.sum() }
}

fn median(mut times: [f64; RUNS]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[RUNS / 2]
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [log, robot] = arguments.as_slice() else { panic!("usage: fit LOG ROBOT") };
    let robot = RobotFile::read(Path::new(robot)).expect("a robot file");
    let paths = SignalPaths::of_robot(&robot).expect("topics");
    let recording = Recording::open(&[log]).expect("a log");
    let mut reader = SignalReader::new(recording, paths, &robot.cable_names());
    let params = robot.params();
    let mut measurements = Measurements::new(&params, Reference::Forces);
    while let Some(sample) = reader.next_row().expect("a readable log") {
        measurements.add(&sample);
    }

    let mut fits: Vec<CableFit> = Vec::new();
    let processor = processor_ticks();
    let times = [(); RUNS].map(|()| {
        let start = Instant::now();
        fits = fit_cables(&measurements, &FitOptions::default(), &Progress::new());
        start.elapsed().as_secs_f64()
    });
    #[expect(clippy::cast_precision_loss, reason = "a small constant")]
    let processor_seconds = (processor_ticks() - processor) / TICKS_PER_SECOND / RUNS as f64;
    for (name, CableFit { values, samples, evaluation_count, .. }) in robot.cable_names().iter().zip(&fits) {
        let [mu, sigma, viscous, offset] = [MU, SIGMA, VISCOUS, OFFSET].map(|place| values[place]);
        println!(
            "cable {name} {mu} {sigma} {viscous} {offset} {} {} {evaluation_count}",
            samples.used, samples.warm_up
        );
    }
    println!("seconds {:.6}", median(times));
    println!("processor_seconds {processor_seconds:.6}");
}
