//! `continuum friction`: the friction at every hole, from the gratings.

use fric_tendon_lab::ContinuumError;
use fric_tendon_lab::result::FrictionResult;

use super::{about, read_gratings, read_run};
use crate::arguments::continuum::FrictionArguments;
use crate::failure::Outcome;
use crate::output::Outputs;
use crate::warnings::{warn, warn_all};
use fric_work::report::continuum;

/// Runs the command.
pub fn run(arguments: &FrictionArguments) -> Outcome {
    let FrictionArguments { run: paths, page } = arguments;
    Outputs::check(&page.result, &[page.report.as_deref()])?;
    let inputs = vec![paths.run.clone(), paths.model.clone()];
    let mut outputs = Outputs::create(&page.result, page.report.as_deref(), inputs)?;
    let (model, run) = read_run(paths)?;
    if !run.has_shifts() {
        return Err(about(
            &paths.run,
            ContinuumError::MissingGroup {
                what: "gratings",
                consequence: "friction cannot be measured",
                remedy: "`shift_1_nm` and so on; `continuum shape` predicts friction from the tension at the base",
            },
        ));
    }
    run.check_sizes(model.file.params()).map_err(|error| about(&paths.run, error))?;
    let guarded =
        read_gratings(&paths.run, &model, &run)?.ok_or_else(|| about(&paths.model, ContinuumError::NoGratings))?;
    let result = FrictionResult::new(model.name(), &run, &guarded);
    warn_all(&result.grating_warnings());
    if !run.has_tension() {
        warn("the run has no `tension_base_n`: friction at hole 1 is not known");
    }
    outputs.write_report(|provenance| continuum::friction(&result, provenance))?;
    outputs.finish(&result, &result.summary(), "")
}
