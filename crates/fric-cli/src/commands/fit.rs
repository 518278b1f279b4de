//! `fit`: the parameters of the friction model from the log of an identification run.

use fric_lab::discover::fit_cables_corrected;
use fric_lab::fit::readiness;
use fric_lab::fit::result::{FitResult, Fits};
use fric_lab::fit::{FitOptions, Parameter, Reference, Weighing, fit_wrench, rewritten};
use fric_log::output::OutputFile;
use fric_work::provenance::shown_path;
use fric_work::{fit_report, report, verdict};

use super::continuum;
use crate::arguments::{FitArguments, ReferenceName};
use crate::failure::{Failure, Outcome};
use crate::measurements::{check_named_once, find_model, read, watched};
use crate::output::{self, JsonTarget, Written};
use crate::warnings::warn_all;

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

    let (fits, faults, readiness) = match reference {
        ReferenceName::Forces => {
            let read = read(logs, part, &model, Reference::Forces)?;
            let readiness = readiness::by_forces(&model.robot, &read.holdings);
            warn_all(&read.check(&readiness)?);
            let samples = read.samples.with_zero_per_log(per_log);
            let fit =
                watched("fitting", "cables", |progress| fit_cables_corrected(&samples, &options, progress, drop))??;
            (Fits::Forces(fit.cables), fit.faults, readiness)
        }
        ReferenceName::Wrench => {
            // The robot file alone can make it impossible.
            readiness::geometry(&model.robot, &model.origin).map_or(Ok(()), |lack| Err(lack.error()))?;
            let read = read(logs, part, &model, Reference::Wrench)?;
            let readiness = readiness::by_wrench(&model.robot, &model.origin, &read.holdings);
            warn_all(&read.check(&readiness)?);
            let measurements = read.samples.all()?;
            let fit = watched("fitting", "searches", |progress| fit_wrench(&measurements, &options, progress))??;
            (Fits::Wrench(fit), Vec::new(), readiness)
        }
    };
    let names: Vec<String> = logs.iter().map(|log| shown_path(log)).collect();
    let outcome = FitResult::new(&model.robot, &names, &fits).with_faults(&faults);
    warn_all(&outcome.warnings(&fits, &readiness));
    outcome.check_fitted()?;
    let text = rewritten(&model.text, &model.origin, fits.cables(), &faults)?;
    let mut files = vec![Written::new(fitted_file.complete_with(&text)?, "the robot file with these values")];
    if let Some(report) = report {
        let page = report::fit::page(&outcome, fits.cables(), &json.provenance());
        files.push(Written::new(report.complete_with(&page)?, "the report"));
    }
    json.finish_then(&outcome, &fit_report::summary(&outcome), files, &verdict::of_fit(&outcome).steps())
}

/// Returns the parameters named on the command line.
fn named(names: &[String]) -> Outcome<Vec<Parameter>> {
    Parameter::all_named(names.iter().map(|name| name.trim()))
        .map_err(|problem| Failure::usage(format!("--parameters: {problem}")))
}
