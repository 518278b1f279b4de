//! `hysteresis`: the remaining hysteresis of the wrench, as the command line and Python find it.

use fric_core::robot::file::RobotFile;
use fric_lab::hysteresis::{Hysteresis, HysteresisLoop, HysteresisResult, Survey};

use crate::source::{SampleSource, read};
use crate::supervisor::Supervisor;

/// Finds the hysteresis. The first reading of the log finds the crossed position; the second, which `again` opens, runs the compensator. Returns the
/// result and the loops to draw.
///
/// # Errors
/// Returns a [`HysteresisError`](fric_lab::hysteresis::HysteresisError), a [`SignalError`](fric_log::signals::SignalError) of the log, the errors of
/// `again` and of the supervisor.
pub fn run<W: Supervisor, S: SampleSource>(
    robot: &RobotFile,
    source: &mut S,
    watch: &mut W,
    again: impl FnOnce(&mut W) -> Result<S, W::Error>,
) -> Result<(HysteresisResult, Vec<HysteresisLoop>), W::Error> {
    let mut survey = Survey::new(robot)?;
    let end = read(source, watch, |sample| {
        survey.add(sample);
        Ok(())
    })?;
    let about = source.about(robot);
    watch.warn(&about.damage)?;
    watch.warn(&about.signals)?;
    end?;
    let crossed = survey.finish()?;
    let mut hysteresis = Hysteresis::new(robot, &crossed)?;
    let mut source = again(watch)?;
    read(&mut source, watch, |sample| {
        hysteresis.step(sample);
        Ok(())
    })??;
    watch.warn(&source.about(robot).robot)?;
    watch.warn(&robot.warnings())?;
    watch.warn(&hysteresis.replay().cable_warnings(robot))?;
    Ok((HysteresisResult::new(robot, &crossed, &hysteresis.axes()?), hysteresis.loops()))
}
