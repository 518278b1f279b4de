//! The given model of a cable: fitted to the log, and judged on the held-out samples.

use std::sync::atomic::AtomicBool;

use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, OFFSET, SIGMA, VISCOUS, Values};

use crate::discover::faults::{RecordingFault, faulty_stretches, leave_out};
use crate::discover::readiness::lack_of;
use crate::discover::report::{CableDiscovery, Model};
use crate::discover::workbench::{self, Workbench};
use crate::fit::cables::{Search, prepared, used};
use crate::fit::{CableRecord, FitOptions, Parameter, Row};
use crate::replay::Deviation;
use crate::samples::held::repeated_forces;
use crate::samples::split::split;
use crate::search::gang::{Gang, Seat};

/// Returns which samples count, and the given model with start values from the data.
pub fn given_to(record: &CableRecord<'_>, stop: &AtomicBool) -> Option<(Vec<bool>, workbench::Model)> {
    let gang = Gang::new(1, stop);
    let paper = fitted_to(record, gang.seat(0), stop)?;
    let (start, _) = given_model(record, &paper.solution);
    Some((used(&paper.standings), start))
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

/// Adds faults that were corrected for the whole log, the last one first. The given model is the one without the corrections.
pub fn add_corrected_faults(
    found: &mut CableDiscovery,
    given: &CableRecord<'_>,
    faults: &[RecordingFault],
    stop: &AtomicBool,
) {
    found.faults.splice(0..0, faults.iter().rev().cloned());
    let Some((counts, start)) = given_to(given, stop) else { return };
    let (blocks, measured) = (split(given), crate::samples::interpolated::measured(given));
    let bench = Workbench { record: *given, blocks: &blocks, counts: &counts, measured: &measured, stop };
    let base = bench.try_one(&start);
    found.residual_before_n = bench.residuals_n(&base.values);
    found.before = Model {
        held_out_n: judged(&found.residual_before_n, &bench.used(true)),
        covariance: crate::certainty::undetermined::covariance(&bench.problem(&base.free, None), &[base.values]),
        fitted: base.free,
        values: base.values,
    };
}

/// Returns the error over the held-out samples.
pub(super) fn judged(residual_n: &[f64], held_out: &[bool]) -> Deviation {
    let judged = residual_n.iter().zip(held_out).filter(|(_, held_out)| **held_out);
    judged.fold(Deviation::default(), |mut sum, (number, _)| {
        sum.add(*number);
        sum
    })
}

/// Returns the given model with start values from the data, and the parameters that the log does not determine, which stay as given.
///
/// Free are the friction that acts, an offset if the file has one (the offset of a sensor that was not tared is to be found, not to be fitted away),
/// and the parameters of the file's effects.
pub(super) fn given_model(
    record: &CableRecord<'_>,
    paper: &crate::search::solve::Solution,
) -> (workbench::Model, Vec<Parameter>) {
    let given = record.params.values();
    let undetermined = |parameter: &Parameter| paper.undetermined.iter().any(|unknown| unknown.parameter == *parameter);
    let all = FitOptions::default().shared(record);
    let acting = all.into_iter().filter(|parameter| acts(parameter, &given));
    let (held, free): (Vec<Parameter>, Vec<Parameter>) = acting.partition(undetermined);
    let mut values = given;
    if let Some(found) = paper.values.first() {
        for parameter in &free {
            values[parameter.place()] = found[parameter.place()];
        }
    }
    (workbench::Model { values, free }, held)
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

/// Returns which cycles have a reference and a force that the sensor does not only repeat.
pub(super) fn comparable(record: &CableRecord<'_>) -> Vec<bool> {
    let repeated = repeated_forces(record).unwrap_or_default();
    let is_comparable = |(place, row): (usize, &Row)| {
        row.is_sound() && record.reference_n(place).is_finite() && repeated.get(place) != Some(&true)
    };
    record.rows.iter().enumerate().map(is_comparable).collect()
}
