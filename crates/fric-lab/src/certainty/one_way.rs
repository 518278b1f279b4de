//! Whether a log tells a zero at the platform from friction.
//!
//! Motion in both directions does: friction changes its sign, a zero does not. In motion one way under a load `S`, as the sensor shows it without friction,
//! the force at the platform is `a·S + e`: `a − 1` is the friction that goes with the load, `e` the zero. A log tells them apart as far as its load varies.
//! Neither force is exact, because of noise and of friction that differs from place to place. The slope `a` then lies between that of the regression of the
//! reference on `S` and that of the reverse regression (R. Frisch, *Statistical Confluence Analysis*, 1934). Least squares takes the first, which goes to 0
//! where most of what varies is an error: friction as large as the force beside a zero as large, with a small standard error. So a zero is told only where
//! both lines have the same friction.

use fric_core::parameters::{MU, Values};

use super::determined::NEGLIGIBLE_MU;
use crate::samples::cable::CableRecord;
use crate::samples::record::Row;
use crate::search::problem::Problem;
use crate::search::solve::{OpenCombination, OpenPart};
use crate::search::vector::Parameter;

/// A cable that goes back for less than this fraction of its way goes one way. With half or double, nothing changes but for logs that hardly go back.
const ONE_WAY_RATIO: f64 = 0.02;
/// Greatest difference of a slope from the mean of both, relative to the friction: as of a parameter, whose interval must be narrower than itself.
pub const MOST_APART_RATIO: f64 = 0.5;
/// A speed that varies by less than this fraction of its mean square is constant but for rounding.
const ROUNDING: f64 = 1e-9;

/// Whether a zero at the platform and the friction of a cable are one: it moves one way only, under a load that varies too little.
pub fn is_zero_open(record: &CableRecord<'_>) -> bool {
    is_one_way(record) && !load_tells_zero(record)
}

fn is_one_way(record: &CableRecord<'_>) -> bool {
    let ways_m = record.rows.iter().map(|row| row.signals.displacement_m);
    let [out_m, back_m] =
        ways_m.fold(
            [0.0, 0.0],
            |[out_m, back_m], way_m| {
                if way_m > 0.0 { [out_m + way_m, back_m] } else { [out_m, back_m - way_m] }
            },
        );
    out_m.min(back_m) < ONE_WAY_RATIO * (out_m + back_m)
}

/// Whether both regressions of the forces, beside a viscous friction, leave the same friction that goes with the load.
fn load_tells_zero(record: &CableRecord<'_>) -> bool {
    let moving = |(cycle, row): (usize, &Row)| {
        let (shown_n, reference_n) = (record.frictionless_n(cycle), record.reference_n(cycle));
        let way_m = row.signals.displacement_m;
        let counts = row.is_sound() && way_m.abs() > 0.0 && shown_n.is_finite() && reference_n.is_finite();
        counts.then_some([shown_n, reference_n, way_m])
    };
    let samples: Vec<[f64; 3]> = record.rows.iter().enumerate().filter_map(moving).collect();
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = samples.len() as f64;
    let mean = |place: usize| samples.iter().map(|sample| sample[place]).sum::<f64>() / count;
    let means = [mean(0), mean(1), mean(2)];
    let centred = |one: usize, other: usize| {
        let product = |sample: &[f64; 3]| (sample[one] - means[one]) * (sample[other] - means[other]);
        samples.iter().map(product).sum::<f64>() / count
    };
    let [of_shown, of_reference, of_way] = [0, 1, 2];
    let speed = centred(of_way, of_way);
    let varies = speed > ROUNDING * means[of_way].powi(2);
    let beside_way = |one: usize, other: usize| {
        let by_way = if varies { centred(one, of_way) * centred(other, of_way) / speed } else { 0.0 };
        centred(one, other) - by_way
    };
    let (shown, both) = (beside_way(of_shown, of_shown), beside_way(of_shown, of_reference));
    let reference = beside_way(of_reference, of_reference);
    let [least, greatest] = [both / shown, reference / both];
    let (friction, apart) = ((0.5 * (least + greatest) - 1.0).abs(), 0.5 * (greatest - least));
    // A pulley takes 2μ of the load at most.
    #[expect(clippy::cast_precision_loss, reason = "at most MAX_PULLEYS")]
    let negligible = 2.0 * NEGLIGIBLE_MU * record.params.pulley_count() as f64;
    both > 0.0 && apart <= (MOST_APART_RATIO * friction).max(negligible)
}

/// Returns the combination of zero and friction that such a log leaves open, from a solution with the given zero, in a step as large as takes all friction
/// for a zero; where no friction was found, the given one.
pub fn combination(problem: &Problem<'_>, zero: Parameter, values: &Values, given: &Values) -> Option<OpenCombination> {
    let mut other = *values;
    other[MU] = if values[MU] > 0.0 { 0.0 } else { given[MU] };
    zero_instead(problem, zero, values, &other)
}

/// Returns the combination of a zero with the parameters that differ between two models, in a step from one to the other that leaves the mean force.
pub fn zero_instead(
    problem: &Problem<'_>,
    zero: Parameter,
    values: &Values,
    other: &Values,
) -> Option<OpenCombination> {
    let mut with_zero = *values;
    with_zero[zero.place()] += 1.0;
    let alone = Problem { seat: None, ..problem.clone() };
    let mean_n = |values: Values| {
        let forces = alone.forces(&[values])?;
        let used = alone.used.iter().enumerate().filter(|(_, used)| **used).map(|(cycle, _)| cycle);
        let forces_n: Vec<f64> = used.filter_map(|cycle| Some(forces.first()?.at(cycle).0)).collect();
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = forces_n.len() as f64;
        Some(forces_n.iter().sum::<f64>() / count)
    };
    let found_n = mean_n(*values)?;
    // The force is linear in a zero while the cable slides.
    let by_zero = mean_n(with_zero)? - found_n;
    let zero_n = (found_n - mean_n(*other)?) / by_zero;
    let part = |parameter: Parameter, step| OpenPart { cable: 0, parameter, step: zero_n.signum() * step };
    let change = |parameter: Parameter| part(parameter, other[parameter.place()] - values[parameter.place()]);
    let others = Parameter::all().map(change).filter(|part| part.step.abs() > 0.0);
    let parts = std::iter::once(part(zero, zero_n)).chain(others).collect();
    (zero_n.is_finite() && zero_n.abs() > 0.0).then_some(OpenCombination { parts })
}
