//! `continuum fit`: identifies a manipulator's numbers from its runs.

use fric_lab::fit::Progress;
use fric_tendon::edit::rewrite;
use fric_tendon_lab::identify::{Quantity, TendonFitOptions, identify};
use fric_tendon_lab::{Run, columns};
use fric_work::provenance::shown_path;
use fric_work::supervisor::Supervisor as _;

use super::{Model, about, read_table};
use crate::arguments::continuum::TendonFitArguments;
use crate::failure::{Failure, Outcome};
use crate::measurements::check_named_once;
use crate::output::Outputs;
use crate::supervision::Watch;
use crate::warnings::warn_all;

/// Runs the command.
pub fn run(arguments: &TendonFitArguments) -> Outcome {
    let TendonFitArguments { runs, model, output, parameters, result } = arguments;
    Outputs::check(result, &[Some(output)])?;
    check_named_once(runs)?;
    let named = |names: &Vec<String>| {
        Quantity::all_named(names.iter().map(|name| name.trim()))
            .map_err(|problem| Failure::usage(format!("--parameters: {problem}")))
    };
    let options = TendonFitOptions { quantities: parameters.as_ref().map(named).transpose()? };
    let mut inputs = runs.clone();
    inputs.push(model.clone());
    let model = Model::read(model)?;
    let mut outputs = Outputs::create(result, None, inputs)?;
    let file = outputs.file(output)?;
    let mut measured = Vec::with_capacity(runs.len());
    for path in runs {
        let table = read_table(path, &columns::of_run(model.disk_count()))?;
        measured.push(Run::from_columns(&table, model.disk_count()).map_err(|error| about(path, error))?);
    }
    let shown: Vec<String> = runs.iter().map(|path| shown_path(path)).collect();
    let fit = |progress: &Progress| identify(&model.file, &measured, &shown, &options, progress);
    let found = Watch::default().compute("fitting", "searches", fit)?.map_err(|error| match runs.as_slice() {
        [only] => about(only, error),
        _ => Failure::from(error),
    })?;
    for (path, run) in runs.iter().zip(&measured) {
        warn_all(
            &run.begin_warning().map(|text| format!("{}: {text}", path.display())).into_iter().collect::<Vec<_>>(),
        );
    }
    let fitted = file.complete_with(&rewrite(&model.text, &model.origin, &found.edit)?)?;
    let is_changed = !found.result.parameters.0.is_empty() || !found.edit.lines.is_empty();
    let what = if is_changed { "the manipulator file with these values" } else { "the manipulator file as it was" };
    outputs.add(fitted, what);
    outputs.finish(&found.result, &found.result.summary(), "")
}
