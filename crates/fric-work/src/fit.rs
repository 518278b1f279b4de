//! `fit`: the parameters of the friction model, as the command line and Python identify them.

use fric_core::robot::file::RobotFileError;
use fric_lab::discover::{CorrectedFit, fit_cables_corrected};
use fric_lab::fit::result::{FitResult, Fits};
use fric_lab::fit::{self, FitOptions, Reference, fit_wrench, readiness, rewritten};
use fric_lab::recording_fault::RecordingFault;

use crate::runs::Runs;
use crate::supervisor::Supervisor;

/// A finished fit.
#[derive(Debug)]
pub struct Fitted {
    /// The result.
    pub result: FitResult,
    /// The fits.
    pub fits: Fits,
    /// The faults of each cable's recording that were corrected.
    faults: Vec<Vec<RecordingFault>>,
}

impl Fitted {
    /// Returns the text of the robot file with the fitted values.
    ///
    /// # Errors
    /// Returns the errors of [`rewritten`].
    pub fn rewritten(&self, text: &str, origin: &str) -> Result<String, RobotFileError> {
        rewritten(text, origin, self.fits.cables(), &self.faults)
    }
}

/// Fits the samples; `residuals_n`, if it is given, takes those of each cable in turn.
///
/// # Errors
/// Returns a [`FitError`](fric_lab::fit::FitError) if the samples allow no fit, a [`StoreError`](fric_lab::fit::StoreError) if they find no room, a
/// [`TimesApart`](fric_log::signals::TimesApart) if a signal is of other times, and the errors of the supervisor.
pub fn run<W: Supervisor>(
    runs: &Runs<'_>,
    options: &FitOptions,
    mut residuals_n: Option<&mut Vec<Vec<f64>>>,
    watch: &mut W,
) -> Result<Fitted, W::Error> {
    let Runs { robot, origin, names, samples, holdings, .. } = runs;
    let (readiness, steps) = match samples.reference() {
        Reference::Forces => (readiness::by_forces(robot, holdings), "cables"),
        Reference::Wrench => (readiness::by_wrench(robot, origin, holdings), "searches"),
    };
    watch.warn(&runs.check::<W>(&readiness)?)?;
    let fit = watch.compute("fitting", steps, |progress| -> Result<_, W::Error> {
        Ok(match samples.reference() {
            Reference::Forces => {
                let take_n = |of_cable: Vec<f64>| {
                    if let Some(all_n) = &mut residuals_n {
                        all_n.push(of_cable);
                    }
                };
                let CorrectedFit { cables, faults } = fit_cables_corrected(samples, options, progress, take_n)?;
                (Fits::Forces(cables), faults)
            }
            Reference::Wrench => {
                let measurements = samples.all()?;
                let fit = fit_wrench(&measurements, options, progress)?;
                if let Some(all_n) = &mut residuals_n {
                    all_n.extend(fit::residuals_n(&measurements, &fit.cables));
                }
                (Fits::Wrench(fit), Vec::new())
            }
        })
    });
    let (fits, faults) = fit??;
    let result = FitResult::new(robot, names, &fits).with_faults(&faults);
    watch.warn(&result.warnings(&fits, &readiness))?;
    result.check_fitted()?;
    Ok(Fitted { result, fits, faults })
}
