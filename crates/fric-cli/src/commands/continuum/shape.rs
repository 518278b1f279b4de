//! `continuum shape`: shapes by four ways of friction against the markers.

use fric_core::continuum::Tendon;
use fric_lab::continuum::comparison::{compare, spread};
use fric_lab::continuum::gratings::Gratings;
use fric_lab::continuum::result::{FrictionResult, ShapeResult};
use fric_lab::continuum::{ContinuumError, Run};

use super::{Outputs, about, read_gratings, read_run};
use crate::arguments::continuum::ShapeArguments;
use crate::failure::{Failure, Outcome};
use crate::report::continuum;
use crate::warnings::{warn, warn_all};

/// Runs the command.
pub fn run(arguments: &ShapeArguments) -> Outcome {
    let ShapeArguments { run: paths, shapes, at_s, mixed, page } = arguments;
    let outputs = Outputs::prepare(page, &[paths.run.clone(), paths.model.clone()], None)?;
    let (model, run) = read_run(paths)?;
    let params = model.file.params();
    run.check_capacity(params.capacity_n(Tendon::Agonist)).map_err(|error| about(&paths.run, error))?;
    let measured = read_gratings(&paths.run, &model, &run)?;
    match (&measured, run.has_shifts()) {
        (None, true) => warn(&format!("the way `measured` is left out: {}", ContinuumError::NoGratings)),
        (None, false) => warn("the way `measured` is left out: the run has no gratings"),
        (Some(_), _) if !run.has_tension() => {
            warn("the run has no `tension_base_n`: the ways `none`, `coulomb` and `history` are left out");
        }
        _ => {}
    }
    let ways = compare(params, &run, measured.as_deref()).map_err(|error| about(&paths.run, error))?;
    let picked = if let Some(times_s) = at_s {
        at_times(&run, times_s)?
    } else {
        let differ = if *mixed {
            let measured = measured.as_deref().ok_or_else(|| {
                Failure::usage("--mixed: without gratings it is not known where directions differ")
                    .advise("Name times with --at-s.")
            })?;
            FrictionResult::new(model.name(), &run, measured).series.directions_differ
        } else {
            vec![true; run.samples().len()]
        };
        spread(run.samples().len(), usize::from(*shapes), |place| differ.get(place) == Some(&true))
    };
    if picked.is_empty() {
        warn("no sample has friction of both directions beyond doubt: no shape is shown");
    }
    let result = ShapeResult::new(model.name(), &run, measured.as_deref(), &ways, &picked);
    warn_all(&result.warnings(&ways));
    let greatest_rad =
        ways.last().map_or(0.0, |way| way.shapes.iter().fold(0.0, |most, one| one.bend_rad.abs().max(most)));
    if let Some(Err(error)) = Gratings::from_file(&model.file)?.map(|one| one.check_travel(params, greatest_rad)) {
        return Err(about(&paths.run, error));
    }
    outputs.finish(&result, &result.summary(), || continuum::shape(&result, &run, &ways, &paths.run))
}

/// The samples nearest to some times within the run.
fn at_times(run: &Run, times_s: &[f64]) -> Outcome<Vec<usize>> {
    let ends = || Some((run.samples().first()?.time_s, run.samples().last()?.time_s));
    let (from_s, to_s) = ends().unwrap_or_default();
    times_s
        .iter()
        .map(|time_s| {
            if !(from_s..=to_s).contains(time_s) {
                return Err(Failure::usage(format!("--at-s: {time_s} s is not within the run, {from_s} … {to_s} s")));
            }
            let distance_s =
                |place: usize| run.samples().get(place).map_or(f64::NAN, |one| (one.time_s - time_s).abs());
            let nearest = (0..run.samples().len()).min_by(|one, other| distance_s(*one).total_cmp(&distance_s(*other)));
            Ok(nearest.unwrap_or_default())
        })
        .collect()
}
