//! `continuum shape`: compares shapes by four friction models with the markers.

use fric_tendon_lab::ContinuumError;
use fric_tendon_lab::comparison::{Selection, compare};
use fric_tendon_lab::gratings::Gratings;
use fric_tendon_lab::result::ShapeResult;
use fric_tendon_lab::shape_errors::Way;

use super::{about, read_gratings, read_run};
use crate::arguments::continuum::{ShapeArguments, WayName};
use crate::failure::{Failure, Outcome};
use crate::output::Outputs;
use crate::warnings::{warn, warn_all};
use fric_work::report::continuum;

fn way_of(name: WayName) -> Way {
    match name {
        WayName::None => Way::None,
        WayName::Coulomb => Way::Coulomb,
        WayName::Measured => Way::Measured,
        WayName::History => Way::History,
    }
}

/// Runs the command.
pub fn run(arguments: &ShapeArguments) -> Outcome {
    let ShapeArguments { run: paths, shapes, at_s, mixed, ways, wide, page } = arguments;
    let wanted: Vec<Way> = ways.iter().map(|way| way_of(*way)).collect();
    Outputs::check(&page.result, &[page.report.as_deref()])?;
    let inputs = vec![paths.run.clone(), paths.model.clone()];
    let mut outputs = Outputs::create(&page.result, page.report.as_deref(), inputs)?;
    let (model, run) = read_run(paths)?;
    let params = model.file.params();
    run.check_sizes(params).map_err(|error| about(&paths.run, error))?;
    let guarded = read_gratings(&paths.run, &model, &run)?;
    let measured = guarded.as_ref().map(|guarded| guarded.measured.as_slice());
    let wants_others = wanted.iter().any(|way| *way != Way::Measured);
    match (&measured, run.has_shifts()) {
        (None, _) if !wanted.contains(&Way::Measured) => {}
        (None, true) => warn(&format!("the way `measured` is left out: {}", ContinuumError::NoGratings)),
        (None, false) => warn("the way `measured` is left out: the run has no gratings"),
        (Some(_), _) if !run.has_tension() && wants_others => {
            warn("the run has no `tension_base_n`: the ways `none`, `coulomb` and `history` are left out");
        }
        _ => {}
    }
    let ways = compare(params, &run, measured, &wanted).map_err(|error| about(&paths.run, error))?;
    let selection = match at_s {
        Some(times_s) => Selection::At(times_s.clone()),
        None if *mixed => Selection::Mixed(usize::from(*shapes)),
        None => Selection::Spread(usize::from(*shapes)),
    };
    let picked = selection.places(&run, measured).map_err(|error| match error {
        ContinuumError::NotWithinRun { .. } => Failure::from(error).of_option("--at-s"),
        error => about(&paths.run, error),
    })?;
    if picked.is_empty() {
        warn("at no sample does friction clearly act in both directions: no shape is shown");
    }
    let result = ShapeResult::new(model.name(), params, &run, guarded.as_ref(), &ways, &picked);
    warn_all(&result.warnings(&ways));
    let greatest_rad = result.greatest_bend_rad();
    if let Some(Err(error)) = Gratings::from_file(&model.file)?.map(|one| one.check_travel(params, greatest_rad)) {
        return Err(about(&paths.run, error));
    }
    outputs.write_report(|provenance| continuum::shape(&result, &run, &ways, provenance))?;
    outputs.finish(&result, &result.table(*wide), "")
}
