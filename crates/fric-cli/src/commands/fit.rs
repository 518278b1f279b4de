//! `fit`: the parameters of the friction model from the log of an identification run.

use fric_lab::fit::{FitOptions, Parameter, Weighing};
use fric_work::{fit, fit_report, report, verdict};

use super::continuum;
use crate::arguments::FitArguments;
use crate::failure::{Failure, Outcome};
use crate::measurements::{self, check_named_once, find_model};
use crate::output::Outputs;
use crate::supervision::Watch;

/// Runs the command.
pub fn run(arguments: &FitArguments) -> Outcome {
    let FitArguments { logs, model, part, output, reference, report, parameters, per_log, huber, result } = arguments;
    if let Some(model) = model.as_deref().filter(|model| continuum::is_manipulator(Some(model))) {
        return Err(Failure::usage(format!(
            "{} is a manipulator file, and `fit` identifies cable robots",
            model.display()
        ))
        .advise("Use `fric-cli continuum fit RUN --model M.toml -o FITTED.toml`."));
    }
    Outputs::check(result, &[Some(output), report.as_deref()])?;
    check_named_once(logs)?;
    let part = part.part()?;
    let options = FitOptions {
        parameters: parameters.as_deref().map(named).transpose()?,
        weighing: if *huber { Weighing::Huber } else { Weighing::LeastSquares },
    };
    let per_log = per_log.zero(logs.len(), *reference)?;
    let mut inputs = logs.clone();
    inputs.extend(model.clone());
    let model = find_model(model.as_deref(), logs)?;
    let mut outputs = Outputs::create(result, report.as_deref(), inputs)?;
    let fitted_file = outputs.file(output)?;

    let mut watch = Watch::default();
    let runs = measurements::read(logs, part, &model, (*reference).into(), per_log, &mut watch)?;
    let fitted = fit::run(&runs, &options, None, &mut watch)?;
    let (outcome, cables) = (&fitted.result, fitted.fits.cables());
    let text = fitted.rewritten(&model.text, &model.origin)?;
    outputs.add(fitted_file.complete_with(&text)?, "the robot file with these values");
    outputs.write_report(|provenance| report::fit::page(outcome, cables, provenance))?;
    outputs.finish(outcome, &fit_report::summary(outcome), &verdict::of_fit(outcome).steps())
}

/// Returns the parameters named on the command line.
fn named(names: &[String]) -> Outcome<Vec<Parameter>> {
    Parameter::all_named(names.iter().map(|name| name.trim()))
        .map_err(|problem| Failure::usage(format!("--parameters: {problem}")))
}
