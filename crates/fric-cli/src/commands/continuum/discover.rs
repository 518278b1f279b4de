//! `discover` with a manipulator file.

use fric_lab::fit::Progress;
use fric_tendon::edit::rewrite;
use fric_tendon_lab::discover::discover;
use fric_tendon_lab::{Run, columns};

use super::{Model, about, read_table};
use crate::arguments::{DiscoverArguments, ReferenceName};
use crate::failure::{Failure, Outcome};
use crate::output::Outputs;
use crate::supervision::Watch;
use crate::warnings::warn_all;
use fric_work::provenance::shown_path;
use fric_work::report;
use fric_work::supervisor::Supervisor as _;

/// Runs the command.
pub fn run(arguments: &DiscoverArguments) -> Outcome {
    let DiscoverArguments { logs, model, part, output, reference, per_log, report, no_empirical, result } = arguments;
    part.check_none()?;
    per_log.check_none()?;
    if *reference == ReferenceName::Wrench {
        return Err(Failure::usage("--reference wrench is for robots; a manipulator has no platform")
            .advise("Leave --reference away: the gratings are the reference."));
    }
    if *no_empirical {
        return Err(Failure::usage("`--no-empirical` is for cables: a manipulator's rest never becomes a table")
            .advise("Leave it out."));
    }
    Outputs::check(result, &[output.as_deref(), report.as_deref()])?;
    let ([log], Some(model)) = (logs.as_slice(), model) else {
        return Err(
            Failure::usage("a manipulator's runs are looked at one by one").advise("Name one run and its --model.")
        );
    };
    let inputs = vec![log.clone(), model.clone()];
    let model = Model::read(model)?;
    let mut outputs = Outputs::create(result, report.as_deref(), inputs)?;
    let extended = output.as_ref().map(|path| outputs.file(path)).transpose()?;
    let table = read_table(log, &columns::of_run(model.disk_count()))?;
    let run = Run::from_columns(&table, model.disk_count()).map_err(|error| about(log, error))?;
    let shown = shown_path(log);
    let look = |progress: &Progress| discover(&model.file, &run, &shown, progress);
    let found = Watch::default().compute("searching", "searches", look)?.map_err(|error| about(log, error))?;
    let noise = found.base_noise.map(|noise| noise.warning());
    warn_all(&run.begin_warning().into_iter().chain(noise).collect::<Vec<_>>());
    if let Some(file) = extended {
        let text = rewrite(&model.text, &model.origin, &found.edit)?;
        outputs.add(file.complete_with(&text)?, "the manipulator file with what was found");
    }
    outputs.write_report(|provenance| report::continuum::discovery(&found, provenance))?;
    outputs.finish(&found.result, &found.result.summary(), "")
}
