//! `replay`: the cycle of the control loop over a log, as the command line and Python run it.

mod result;

use fric_core::Sample;
use fric_core::robot::file::RobotFile;
use fric_lab::discover::{self, Corrections};
use fric_lab::fit::{Reference, SampleStore};
use fric_lab::replay::{Replay, ReplayedCycle};
use fric_log::signals::Role;

pub use result::{CableResult, CycleResult, NoHistogram, PoseResult, ReplayResult};

use crate::source::{SampleSource, read, read_and_warn};
use crate::supervisor::Supervisor;
use result::CycleTimes;

/// Finds the faults of a recording to correct before it is compared with its reference. Warnings and errors of the log are left to the next reading.
///
/// # Errors
/// Returns a [`StoreError`](fric_lab::fit::StoreError) if the samples find no room, and the errors of the supervisor.
pub fn corrections<W: Supervisor>(
    robot: &RobotFile,
    source: &mut impl SampleSource,
    watch: &mut W,
) -> Result<Corrections, W::Error> {
    let mut samples = SampleStore::new(&robot.params(), Reference::Forces);
    let _ = read(source, watch, |sample| Ok(samples.add(sample)?))?;
    Ok(watch.compute("checking", "cables", |progress| discover::corrections(&samples, progress))??)
}

/// A finished replay.
#[derive(Debug)]
pub struct Replayed {
    /// The result.
    pub result: ReplayResult,
    /// Every flag that was raised on each cable, as bits.
    pub flags: Vec<u32>,
}

/// Replays a log; `each` takes every sample, corrected, and its cycle.
///
/// # Errors
/// Returns a [`ParamError`](fric_core::ParamError) of the robot, a [`SignalError`](fric_log::signals::SignalError) of the log, the errors of `each`
/// and of the supervisor.
pub fn run<W: Supervisor>(
    robot: &RobotFile,
    source: &mut impl SampleSource,
    corrections: Option<&Corrections>,
    watch: &mut W,
    mut each: impl FnMut(&Sample<'_>, &ReplayedCycle<'_>) -> Result<(), W::Error> + Send,
) -> Result<Replayed, W::Error> {
    let params = match corrections.and_then(Corrections::length_noise_m) {
        Some(length_noise_m) => robot.params().with_length_noise_m(length_noise_m)?,
        None => robot.params(),
    };
    let mut replay = Replay::new(&params)?;
    let mut times = CycleTimes::new()?;
    let (mut room, mut row) = (Vec::new(), 0);
    let about = read_and_warn(source, robot, watch, |sample| {
        let sample = match corrections {
            Some(corrections) => corrections.corrected(row, sample, &mut room),
            None => *sample,
        };
        row += 1;
        let cycle = replay.step(&sample);
        times.add(cycle.cycle_ns);
        each(&sample, &cycle)
    })?;
    watch.warn(&about.robot)?;
    if about.times_apart(Role::Reference).is_some() {
        // Missing reference forces have already been reported.
        watch.warn(&robot.warnings())?;
        watch.warn(&replay.cable_warnings(robot))?;
    } else {
        watch.warn(&replay.warnings(robot, about.has_columns))?;
    }
    let flags = replay.cables().iter().map(|errors| errors.flags).collect();
    Ok(Replayed { result: ReplayResult::new(robot, &replay, &times, about.poses, corrections), flags })
}
