//! `cargo run --release -p fric-core --example soak -- CYCLES SEED [THREADS] [adversary]`: see the module.
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr, reason = "a check, not a library")]
#![allow(clippy::float_cmp, reason = "exact zeros")]

use std::env;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

#[path = "../bits.rs"]
mod bits;
#[path = "../random.rs"]
mod random;
#[path = "mod.rs"]
mod soak;

const REPORTED: u64 = 10_000_000;

fn main() -> ExitCode {
    let is_adversary = env::args().next_back().is_some_and(|last| last == "adversary");
    let words = env::args().skip(1).filter(|word| word != "adversary");
    let numbers: Vec<Option<u64>> = words.map(|text| text.parse().ok()).collect();
    let (cycles, seed, threads) = match numbers[..] {
        [Some(cycles), Some(seed)] => (cycles, seed, 1),
        [Some(cycles), Some(seed), Some(threads)] => (cycles, seed, usize::try_from(threads).unwrap()),
        _ => {
            eprintln!("usage: soak CYCLES SEED [THREADS] [adversary]");
            return ExitCode::from(2);
        }
    };
    let start = Instant::now();
    if is_adversary {
        return match soak::adversary::run(cycles, seed, threads as u64) {
            Ok(tally) => {
                println!(
                    "{tally:?} in {:.0} s, seed {seed}: no force was off without a flag",
                    start.elapsed().as_secs_f64()
                );
                ExitCode::SUCCESS
            }
            Err(problem) => {
                eprintln!("{problem}");
                ExitCode::FAILURE
            }
        };
    }
    let reported = AtomicU64::new(0);
    let progress = |done: u64| {
        if done / REPORTED > reported.fetch_max(done / REPORTED, Ordering::Relaxed) {
            eprintln!("{done} cycles, {:.0} s", start.elapsed().as_secs_f64());
        }
    };
    match soak::soak(cycles, seed, threads, progress) {
        Ok(tally) => {
            println!(
                "{} cycles in {:.0} s, seed {seed}: {} faults, {} recoveries, no broken invariant; flags seen: {}",
                tally.cycles,
                start.elapsed().as_secs_f64(),
                tally.faults,
                tally.recoveries,
                tally.status(),
            );
            ExitCode::SUCCESS
        }
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}
