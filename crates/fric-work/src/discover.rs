//! `discover`: the missing effect, as the command line and Python find it.

use fric_lab::discover::result::DiscoverResult;
use fric_lab::discover::{DiscoverOptions, Discoveries, readiness};
use fric_lab::fit::Reference;

use crate::runs::Runs;
use crate::supervisor::Supervisor;

/// Runs the discovery. Returns the result and the findings behind it.
///
/// # Errors
/// Returns a [`FitError`](fric_lab::fit::FitError) if the samples say nothing about any cable, a [`StoreError`](fric_lab::fit::StoreError) if they
/// find no room, a [`TimesApart`](fric_log::signals::TimesApart) if a signal is of other times, and the errors of the supervisor.
pub fn run<W: Supervisor>(
    runs: &Runs<'_>,
    options: &DiscoverOptions,
    watch: &mut W,
) -> Result<(DiscoverResult, Discoveries), W::Error> {
    let Runs { robot, origin, names, samples, holdings, .. } = runs;
    let (readiness, steps) = match samples.reference() {
        Reference::Forces => (readiness::by_forces(robot, holdings), "stages"),
        Reference::Wrench => (readiness::by_wrench(robot, origin, holdings), "searches"),
    };
    // Missing data of some cables are reported only beside their verdicts.
    runs.check::<W>(&readiness)?;
    let found = watch.compute("discovering", steps, |progress| Discoveries::of(samples, options, progress))??;
    let logs: Vec<(String, f64)> = names.iter().cloned().zip(samples.log_starts_s()).collect();
    let result = DiscoverResult::new(robot, &logs, &readiness, found.cables()).with_wrench(found.wrench());
    result.check_told()?;
    watch.warn(&found.warnings(&robot.cable_names()))?;
    Ok((result, found))
}
