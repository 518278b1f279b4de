//! A real-time loop around the compensator: 1 kHz, or what the robot file says, on Linux.
//!
//! Usage: `cargo run --release -p control-loop -- ROBOT.toml LOG.mcap [SECONDS]`; the log stands for the bus,
//! over and over.
//!
//! Memory is locked, the thread sleeps until absolute times, and it has real-time priority where the system permits. Whole
//! cycles that it comes too late for (an overrun) are skipped and told by `elapsed_cycles`. At the end: overruns, wake-up latency,
//! duration of a step, and page faults since the first cycle. Exits 1 if there was a page fault.

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use fric_core::robot::file::RobotFile;
use fric_core::{AnyCompensator, CableInput, Pose};
use fric_log::recording::Recording;
use fric_log::signals::{SignalPaths, SignalReader};
use hdrhistogram::Histogram;

const SECOND_NANOS: i64 = 1_000_000_000;

/// Signals of one cycle.
struct Row {
    cables: Vec<CableInput>,
    pose: Option<Pose>,
}

fn now_nanos() -> i64 {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `now` may be written to.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut now) };
    now.tv_sec * SECOND_NANOS + now.tv_nsec
}

fn sleep_until(nanos: i64) {
    let until = libc::timespec { tv_sec: nanos / SECOND_NANOS, tv_nsec: nanos % SECOND_NANOS };
    // SAFETY: `until` can be read; what is left of the time is not asked for.
    let sleep = || unsafe {
        libc::clock_nanosleep(libc::CLOCK_MONOTONIC, libc::TIMER_ABSTIME, &raw const until, std::ptr::null_mut())
    };
    while sleep() == libc::EINTR {}
}

/// Says what the system does not permit, and goes on: the figures at the end tell what that costs.
fn become_real_time() {
    // SAFETY: takes numbers only.
    if unsafe { libc::mlockall(libc::MCL_CURRENT | libc::MCL_FUTURE) } != 0 {
        println!("memory is not locked: {}", std::io::Error::last_os_error());
    }
    let priority = libc::sched_param { sched_priority: 80 };
    // SAFETY: `priority` can be read.
    if unsafe { libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const priority) } != 0 {
        println!("no real-time priority: {}", std::io::Error::last_os_error());
    }
}

/// Minor and major page faults of this process.
fn page_faults() -> [i64; 2] {
    let mut usage = std::mem::MaybeUninit::<libc::rusage>::zeroed();
    // SAFETY: `usage` may be written to, and all zero it is a valid one.
    let usage = unsafe {
        libc::getrusage(libc::RUSAGE_SELF, usage.as_mut_ptr());
        usage.assume_init()
    };
    [usage.ru_minflt, usage.ru_majflt]
}

fn read(robot: &RobotFile, log: PathBuf) -> Result<Vec<Row>, Box<dyn Error>> {
    let paths = SignalPaths::of_robot(robot)?;
    let mut reader = SignalReader::new(Recording::open(&[log])?, paths, &robot.cable_names());
    let mut rows = Vec::new();
    while let Some(sample) = reader.next_row()? {
        rows.push(Row { cables: sample.cables.to_vec(), pose: sample.pose });
    }
    Ok(rows)
}

fn show(name: &str, durations: &Histogram<u64>) {
    let us = |nanos: u64| nanos as f64 * 1e-3;
    let [p50, p999, p99999] = [0.5, 0.999, 0.99999].map(|share| us(durations.value_at_quantile(share)));
    println!("{name:8} {p50:9.3} {p999:9.3} {p99999:9.3} {:9.3}", us(durations.max()));
}

fn main() -> ExitCode {
    run().unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::FAILURE
    })
}

fn run() -> Result<ExitCode, Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (robot, log, seconds) = match arguments.as_slice() {
        [robot, log] => (robot, log, 60.0),
        [robot, log, seconds] => (robot, log, seconds.parse::<f64>()?),
        _ => {
            eprintln!("usage: control-loop ROBOT.toml LOG.mcap [SECONDS]");
            return Ok(ExitCode::from(2));
        }
    };
    let robot = RobotFile::read(robot.as_ref())?;
    let rows = read(&robot, log.into())?;
    let cycle_s = robot.params().cycle_s();
    let (cycle_nanos, cycle_count) = ((cycle_s * 1e9).round() as i64, (seconds / cycle_s) as u64);
    if rows.is_empty() || cycle_count == 0 {
        return Err("there is no cycle to run: give SECONDS and a log with rows".into());
    }
    let mut compensator = AnyCompensator::new(&robot.params())?;
    // From 1 ns to 1 s with three digits; both take their memory here.
    let histogram = || Histogram::<u64>::new_with_bounds(1, 1 << 30, 3);
    let (mut wake_up, mut step) = (histogram()?, histogram()?);
    become_real_time();

    let mut faults = [0; 2];
    let (mut flagged_count, mut overrun_count, mut skipped_count) = (0_u64, 0_u64, 0_i64);
    let mut bus = rows.iter().cycle();
    let mut due = now_nanos() + cycle_nanos;
    for cycle in 0..cycle_count {
        sleep_until(due);
        let late_nanos = now_nanos() - due;
        let skipped = late_nanos / cycle_nanos;
        // The bus has not waited.
        let Some(row) = bus.nth(skipped as usize) else { break };
        let start = now_nanos();
        compensator.set_input(&row.cables, row.pose, 1.0 + skipped as f64);
        compensator.step();
        let end = now_nanos();
        wake_up.saturating_record(late_nanos.unsigned_abs());
        step.saturating_record((end - start).unsigned_abs());
        overrun_count += u64::from(skipped > 0);
        skipped_count += skipped;
        flagged_count += u64::from(!compensator.wrench_status().is_ok());
        if cycle == 0 {
            faults = page_faults();
        }
        due += (1 + skipped) * cycle_nanos;
    }
    let after = page_faults();

    println!("{cycle_count} cycles, {flagged_count} flagged");
    println!("{overrun_count} overruns, {skipped_count} cycles skipped");
    println!("{:8} {:>9} {:>9} {:>9} {:>9}", "us", "p50", "p99.9", "p99.999", "max");
    show("wake-up", &wake_up);
    show("step", &step);
    let [minor, major] = [after[0] - faults[0], after[1] - faults[1]];
    println!("since the first cycle: {minor} minor and {major} major page faults");
    Ok(if minor + major == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
