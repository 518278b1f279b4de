//! The given model of a cable, fitted to the log.

use std::sync::atomic::AtomicBool;

use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, OFFSET, SIGMA, VISCOUS, Values};

use crate::certainty::one_load::{is_gain, is_one_load, is_zero};
use crate::certainty::undetermined::vagueness;
use crate::discover::faults::{faulty_stretches, leave_out};
use crate::discover::lack::lack_of;
use crate::discover::workbench::{self, Trial, Workbench};
use crate::fit::cables::{Search, prepared, used};
use crate::fit::{CableRecord, FitOptions, Parameter};
use crate::samples::split::split;
use crate::search::gang::{Gang, Seat};
use crate::search::solve::{Solution, Unknown};

/// Returns which samples count, and the given model with start values from the data.
pub fn given_to(record: &CableRecord<'_>, stop: &AtomicBool) -> Option<(Vec<bool>, workbench::Model)> {
    let gang = Gang::new(1, stop);
    let paper = fitted_to(record, gang.seat(0), stop)?;
    let counts = used(&paper.standings);
    let (start, _) = given_model(record, &paper.solution, &counts, stop);
    Some((counts, start))
}

/// Fits the given model to all samples that count. Returns `None` where the log cannot tell.
pub fn fitted_to<'a>(record: &CableRecord<'a>, seat: Seat<'a>, stop: &'a AtomicBool) -> Option<Search<'a>> {
    if lack_of(record).is_some() {
        return None;
    }
    let mut standings = prepared(record);
    leave_out(record, &faulty_stretches(record), &mut standings);
    Some(Search::run(record, &standings, &FitOptions::default(), stop, seat))
}

/// Returns the given model with start values from the data, and the parameters that the log does not determine, which stay as given.
///
/// Free are the friction that acts, an offset if the file has one (the offset of a sensor that was not tared is to be found, not to be fitted away),
/// and the parameters of the file's effects. The fit that gives the start values has an offset and all friction free. Beside the offset the log may not
/// determine a parameter of an effect, as a gain under one load, that it determines without: the file has no offset, so that this parameter is fitted like the
/// others. So is friction that the log determines beside an offset but not beside other friction that the file has not, as μ beside a viscous friction where
/// each direction has one speed.
pub fn given_model(
    record: &CableRecord<'_>,
    paper: &Solution,
    counts: &[bool],
    stop: &AtomicBool,
) -> (workbench::Model, Vec<Parameter>) {
    let given = record.params.values();
    let undetermined = |parameter: &Parameter| paper.undetermined.iter().any(|unknown| unknown.parameter == *parameter);
    let all = FitOptions::default().shared(record);
    let mut lacking = all.iter().copied().filter(|parameter| parameter.is_friction() && !acts(parameter, &given));
    let has_other_friction = lacking.clone().any(|parameter| parameter.place() != OFFSET);
    let other_zero = lacking.find(|parameter| parameter.place() == OFFSET);
    let acting = all.into_iter().filter(|parameter| acts(parameter, &given));
    let (mut held, free): (Vec<Parameter>, Vec<Parameter>) = acting.partition(undetermined);
    let mut values = given;
    if let Some(found) = paper.values.first() {
        // Viscous friction that the file lacks may have taken the place of its Coulomb friction there.
        let stays = |parameter: &Parameter| parameter.place() == MU && found[MU] <= 0.0;
        for parameter in free.iter().filter(|parameter| !stays(parameter)) {
            values[parameter.place()] = found[parameter.place()];
        }
    }
    let mut model = workbench::Model { values, free };
    let (of_friction, of_effects): (Vec<Parameter>, Vec<Parameter>) = held.iter().partition(|of| of.is_friction());
    let blocks = split(record);
    let bench = Workbench { record: *record, blocks: &blocks, counts, measured: &[], stop };
    let mut fit_too = |beside: Option<Parameter>, candidates: &[Parameter]| {
        let with = workbench::Model { free: model.free.iter().copied().chain(beside).collect(), ..model.clone() };
        let (trial, told) = determined_beside(&bench, &with, candidates);
        held.retain(|parameter| !told.contains(parameter));
        model.free.extend(told);
        for parameter in &model.free {
            model.values[parameter.place()] = trial.values[parameter.place()];
        }
    };
    if has_other_friction && !of_friction.is_empty() {
        fit_too(other_zero, &of_friction);
    }
    if other_zero.is_some() && !of_effects.is_empty() {
        fit_too(None, &of_effects);
    }
    (model, held)
}

/// Fits a model with further parameters free. Returns those that the training samples determine then. A zero beside a gain under one load is none of them.
pub fn determined_beside(
    bench: &Workbench<'_>,
    model: &workbench::Model,
    held: &[Parameter],
) -> (Trial, Vec<Parameter>) {
    let mut with_all = model.clone();
    with_all.free.extend(held);
    if with_all.free.iter().any(is_gain) && is_one_load(&bench.problem(&[], None), &model.values) {
        with_all.free.retain(|parameter| !held.contains(parameter) || !is_zero(parameter));
    }
    let trial = bench.try_one(&with_all);
    let (_, all) = vagueness(&bench.problem(&trial.free, None), &[trial.values]);
    let is_told = |(vagueness, of): &(f64, Unknown)| *vagueness <= 1.0 && held.contains(&of.parameter);
    let told = all.into_iter().filter(is_told).map(|(_, of)| of.parameter).collect();
    (trial, told)
}

/// Whether a friction parameter acts in a model.
pub fn acts(parameter: &Parameter, values: &Values) -> bool {
    match parameter.place() {
        MU | VISCOUS => values[parameter.place()] > 0.0,
        OFFSET => values[OFFSET].abs() > 0.0,
        SIGMA => values[MU] > 0.0 && values[SIGMA] < NO_PRESLIDING_N_PER_M,
        _ => true,
    }
}
