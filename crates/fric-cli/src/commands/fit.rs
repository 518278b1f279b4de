//! `fit`: the parameters of the friction model from the log of an identification run.

use fric_lab::fit::{FitOptions, Parameter, Weighing};
use fric_log::output::OutputFile;
use fric_work::{fit, fit_report, report, verdict};

use super::continuum;
use crate::arguments::FitArguments;
use crate::failure::{Failure, Outcome};
use crate::measurements::{self, check_named_once, find_model};
use crate::output::{self, JsonTarget, Written};
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
    let json_file = result.json.as_deref().filter(|path| !output::is_stdout(path));
    output::check_distinct(&[Some(output), report.as_deref(), json_file])?;
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
    let json = JsonTarget::prepare(result.json.as_deref(), &inputs, result.force)?;
    let fitted_file = OutputFile::create(output, &inputs, result.force)?;
    let report = report.as_ref().map(|path| OutputFile::create(path, &inputs, result.force)).transpose()?;

    let mut watch = Watch::default();
    let runs = measurements::read(logs, part, &model, (*reference).into(), per_log, &mut watch)?;
    let fitted = fit::run(&runs, &options, None, &mut watch)?;
    let (outcome, cables) = (&fitted.result, fitted.fits.cables());
    let text = fitted.rewritten(&model.text, &model.origin)?;
    let mut files = vec![Written::new(fitted_file.complete_with(&text)?, "the robot file with these values")];
    if let Some(report) = report {
        let page = report::fit::page(outcome, cables, &json.provenance());
        files.push(Written::new(report.complete_with(&page)?, "the report"));
    }
    json.finish_then(outcome, &fit_report::summary(outcome), files, &verdict::of_fit(outcome).steps())
}

/// Returns the parameters named on the command line.
fn named(names: &[String]) -> Outcome<Vec<Parameter>> {
    Parameter::all_named(names.iter().map(|name| name.trim()))
        .map_err(|problem| Failure::usage(format!("--parameters: {problem}")))
}
