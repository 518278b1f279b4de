//! Start values of a search, computed from the data and not from the robot file.
//!
//! - μ, F_pv and ε: while a cable slides far from its last reversal, friction is nearly linear in them and σ does not matter. One Gauss-Newton step
//!   from zero gives them.
//! - σ: the sum of squares is compared over four orders of magnitude of the presliding distance; each of its local minima is a start.

use std::ops::Range;

use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, OFFSET, SIGMA, VISCOUS, Values};
use nalgebra::DMatrix;

use crate::samples::record::Row;
use crate::search::gram::Gram;
use crate::search::problem::{Comparison, Member, Problem};
use crate::search::solve::search;
use crate::search::vector::{Coordinate, Parameter, with};

/// Value of μ at which friction is linearised.
const TYPICAL_MU: f64 = 0.02;
/// Trial presliding distances, m, half an order of magnitude apart.
const DISTANCES_M: [f64; 8] = [1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2];
/// Trial multiples of the best distance, an eighth of an order of magnitude apart.
const CLOSER: [f64; 4] = [0.56, 0.75, 1.33, 1.78];
/// This percentage of the moving samples is too near to the last reversal to count as sliding.
const NOT_SLIDING_PERCENT: usize = 60;
/// Speed at which a pulley's viscous friction does not exceed the sensor force.
const FAST_M_PER_S: f64 = 1.0;
/// Range of the distance since the last reversal over which a cable may preslide, m.
const PRESLIDING_M: Range<f64> = 1e-5..1e-2;
/// Number of cycles that suffices for a linear step.
const ENOUGH_SLIDING: usize = 1024;
/// Number of cycles over which σ is searched.
const STRETCH: usize = 8192;
/// A refined start that differs from the coarse one by more than this factor is rejected.
const REFINEMENT: f64 = 3.0;
/// A local minimum whose sum of squares exceeds this multiple of the least one is no start.
const SHALLOW: f64 = 1.5;

/// Returns start values for each cable, the most promising first.
pub fn starts(problem: &Problem<'_>, given: &[Values], cycle_s: f64) -> Vec<Vec<Values>> {
    let searched = if is_simple(problem) { most_presliding(problem) } else { longest_log(problem) };
    let stretch = stretch_of(problem, &searched);
    let coarse = valleys(problem, given, cycle_s, &searched, stretch.is_none());
    let Some(stretch) = stretch else { return coarse };
    let refine = |start: Vec<Values>| {
        let (refined, _) = search(&stretch, &start, cycle_s);
        let near = |one: &Values, other: &Values| {
            [MU, SIGMA].into_iter().all(|place| (1.0 / REFINEMENT..=REFINEMENT).contains(&(one[place] / other[place])))
        };
        if refined.iter().zip(&start).all(|(refined, start)| near(refined, start)) { refined } else { start }
    };
    coarse.into_iter().map(refine).collect()
}

/// Returns the problem of μ and σ of a single cable on the stretch with the most presliding. A few evaluations of it improve a start so much that the
/// whole log needs fewer. Returns `None` if there is nothing to gain.
fn stretch_of<'a>(problem: &Problem<'a>, cycles: &Range<usize>) -> Option<Problem<'a>> {
    let (Comparison::Forces, [member]) = (&problem.comparison, problem.members.as_slice()) else { return None };
    let mut used = problem.used.get(cycles.clone())?.to_vec();
    used.iter_mut().take(cycles.len() / 8).for_each(|used| *used = false);
    let short = is_simple(problem) && cycles.len() * 4 < problem.used.len() && used.contains(&true);
    let free: Vec<Parameter> =
        member.free.iter().copied().filter(|parameter| [MU, SIGMA].contains(&parameter.place())).collect();
    short.then(|| Problem {
        members: vec![Member { record: member.record.stretch(cycles), free }],
        used,
        ..problem.clone()
    })
}

/// Returns the local minima of the sum of squares over the presliding distance, the deepest first; on request the best one is refined.
fn valleys(
    problem: &Problem<'_>,
    given: &[Values],
    cycle_s: f64,
    searched: &Range<usize>,
    closer: bool,
) -> Vec<Vec<Values>> {
    let sliding = slide(problem, given, cycle_s);
    if !problem.members.iter().any(|member| varies(member, SIGMA)) {
        return vec![sliding];
    }
    // The friction of each cable that is stored over the distance; none for a cable whose σ is held.
    let stored_n = |(member, values): (&Member<'_>, &Values)| {
        let tension_n = mean(member.record.rows.iter().map(|row| row.signals.sensor_force_n.max(0.0)));
        let stored_n = member.record.params.memory_m_per_n(values[MU].max(1e-4), 1.0) * tension_n;
        varies(member, SIGMA).then_some(stored_n)
    };
    let stored_n: Vec<Option<f64>> = problem.members.iter().zip(&sliding).map(stored_n).collect();
    let of_distance = |distance_m: f64| -> Vec<f64> {
        let sigma_of = |(stored_n, values): (&Option<f64>, &Values)| {
            stored_n.map_or(values[SIGMA], |stored_n| (stored_n / distance_m).clamp(1e-2, 1e11))
        };
        stored_n.iter().zip(&sliding).map(sigma_of).collect()
    };
    let tried = |distances_m: &[f64]| -> Vec<(Vec<f64>, f64)> {
        let sigmas: Vec<Vec<f64>> = distances_m.iter().map(|distance_m| of_distance(*distance_m)).collect();
        let losses = problem.losses_by_sigma(&sliding, &sigmas, searched);
        sigmas.into_iter().zip(losses).collect()
    };
    let candidates = tried(&DISTANCES_M);
    let loss = |place: usize| candidates.get(place).map_or(f64::INFINITY, |(_, loss)| *loss);
    let is_valley = |place: usize| {
        place.checked_sub(1).is_none_or(|left| loss(left) > loss(place)) && loss(place + 1) >= loss(place)
    };
    let mut valleys: Vec<_> = candidates
        .iter()
        .zip(DISTANCES_M)
        .enumerate()
        .filter(|(place, _)| is_valley(*place))
        .map(|(_, ((sigmas, loss), distance_m))| (sigmas.clone(), *loss, distance_m))
        .collect();
    valleys.sort_by(|one, other| one.1.total_cmp(&other.1));
    if let Some((sigmas, loss, distance_m)) = valleys.first_mut().filter(|_| closer) {
        // The length of a cable's memory follows from this distance.
        let closer = tried(&CLOSER.map(|factor| factor * *distance_m)).into_iter().filter(|(_, other)| *other < *loss);
        if let Some(best) = closer.min_by(|(_, one), (_, other)| one.total_cmp(other)) {
            (*sigmas, *loss) = best;
        }
    }
    let least = valleys.first().map_or(f64::NAN, |(_, loss, _)| *loss);
    let of_valley = |(sigmas, ..): (Vec<f64>, f64, f64)| -> Vec<Values> {
        let mut values = sliding.clone();
        for (values, sigma_n_per_m) in values.iter_mut().zip(sigmas) {
            values[SIGMA] = sigma_n_per_m;
        }
        values
    };
    let starts: Vec<_> = valleys.into_iter().filter(|(_, loss, _)| *loss <= SHALLOW * least).map(of_valley).collect();
    if starts.is_empty() { vec![sliding] } else { starts }
}

fn varies(member: &Member<'_>, place: usize) -> bool {
    member.free.iter().any(|parameter| parameter.place() == place)
}

fn mean(numbers: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = numbers.fold((0.0, 0.0), |(sum, count), number| (sum + number, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Computes μ, F_pv and ε by one linear step on the sliding samples, with σ as stiff as possible.
fn slide(problem: &Problem<'_>, given: &[Values], cycle_s: f64) -> Vec<Values> {
    let linear = |parameter: &Parameter| [MU, VISCOUS, OFFSET].contains(&parameter.place());
    let mut reduced = problem.clone();
    let mut nothing = given.to_vec();
    for (member, values) in reduced.members.iter_mut().zip(&mut nothing) {
        if varies(member, SIGMA) {
            values[SIGMA] = NO_PRESLIDING_N_PER_M;
        }
        member.free.retain(linear);
        let start = |parameter: &Parameter| if parameter.place() == MU { TYPICAL_MU } else { 0.0 };
        *values = with(values, &member.free, member.free.iter().map(start));
    }
    for (used, sliding) in reduced.used.iter_mut().zip(sliding_samples(problem)) {
        *used &= sliding;
    }
    let mut slid = linear_step(&reduced, &nothing, cycle_s);
    // If the motion is too slow to show viscous friction, the step gives it an arbitrary size, and the other parameters compensate.
    let mut is_wild = false;
    for (member, values) in reduced.members.iter_mut().zip(slid.iter().flatten()) {
        let tension_n = mean(member.record.rows.iter().map(|row| row.signals.sensor_force_n.max(0.0)));
        if values[VISCOUS] * FAST_M_PER_S > tension_n && varies(member, VISCOUS) {
            member.free.retain(|parameter| parameter.place() != VISCOUS);
            is_wild = true;
        }
    }
    if is_wild {
        slid = linear_step(&reduced, &nothing, cycle_s);
    }
    slid.unwrap_or(nothing)
}

/// Returns residuals and Jacobian of sliding samples. Without presliding a cycle does not depend on earlier ones, so for a single cable some evenly
/// spread cycles suffice.
fn sliding_gram(problem: &Problem<'_>, values: &[Values]) -> Option<Gram> {
    // Cycles without their log have no zero of their own.
    let stiff = problem.per_log().is_none() && values.iter().all(|of| of[SIGMA] >= NO_PRESLIDING_N_PER_M);
    let (Comparison::Forces, [member], true) =
        (&problem.comparison, problem.members.as_slice(), stiff && is_simple(problem))
    else {
        return problem.gram(values);
    };
    let counted = problem.used.iter().filter(|used| **used).count();
    let used = problem.used.iter().enumerate().filter(|(_, used)| **used).map(|(cycle, _)| cycle);
    let few = used.step_by(counted / ENOUGH_SLIDING + 1);
    let of_cycle = |cycle: usize| Some((*member.record.rows.get(cycle)?, *member.record.references_n.get(cycle)?));
    let (rows, references_n): (Vec<Row>, Vec<f64>) = few.filter_map(of_cycle).unzip();
    let reduced = Problem {
        members: vec![Member { record: member.record.as_one_log(&rows, &references_n), free: member.free.clone() }],
        comparison: Comparison::Forces,
        loss: problem.loss,
        used: vec![true; rows.len()],
        stop: problem.stop,
        seat: None,
    };
    reduced.gram(values)
}

/// Takes one Gauss-Newton step from `values`, clamped to the parameters' ranges; `None` if it leads nowhere.
fn linear_step(problem: &Problem<'_>, values: &[Values], cycle_s: f64) -> Option<Vec<Values>> {
    let (matrix, gradient, _) = sliding_gram(problem, values)?.normal_equations();
    // A fraction of the diagonal keeps undetermined parameters near zero.
    let damped = &matrix + DMatrix::from_diagonal(&matrix.diagonal().map(|square| 1e-9 * square + f64::MIN_POSITIVE));
    let step = damped.cholesky().map(|factor| factor.solve(&gradient));
    let step = step.filter(|step| step.iter().all(|part| part.is_finite()))?;
    let mut parts = step.iter();
    let mut stepped = values.to_vec();
    for (member, values) in problem.members.iter().zip(&mut stepped) {
        for parameter in &member.free {
            let coordinate = Coordinate::of(parameter, cycle_s);
            let value = values[parameter.place()] - parts.next().copied().unwrap_or(0.0);
            let value = if parameter.place() == MU { value.max(1e-4) } else { value };
            values[parameter.place()] = coordinate.value_at(coordinate.place_of(value)).0;
        }
    }
    Some(stepped)
}

/// Whether no cable has an effect. With effects, whose values are still unknown, a part of the log may mislead, and a cycle may depend on earlier
/// ones.
fn is_simple(problem: &Problem<'_>) -> bool {
    let has_none = |member: &Member<'_>| {
        let values = member.record.params.values();
        Parameter::all().filter(|parameter| !parameter.is_friction()).all(|parameter| {
            values[parameter.place()].to_bits() == parameter.row().neutral.to_bits()
                && !member.free.contains(&parameter)
        })
    };
    problem.members.iter().all(has_none)
}

/// Returns the cycles of the longest log.
fn longest_log(problem: &Problem<'_>) -> Range<usize> {
    let logs = problem.members.first().into_iter().flat_map(|member| member.record.logs());
    logs.map(|(start, rows)| start..start + rows.len()).max_by_key(Range::len).unwrap_or(0..0)
}

/// Returns the distance that a cable has moved since its last reversal, m per cycle; 0 at rest.
fn ways_since_reversal(rows: &[Row]) -> impl Iterator<Item = f64> {
    let mut way_m = 0.0_f64;
    rows.iter().map(move |row| {
        let step_m = row.signals.displacement_m;
        way_m = if way_m * step_m < 0.0 { step_m } else { way_m + step_m };
        if step_m.abs() > 0.0 { way_m.abs() } else { 0.0 }
    })
}

/// Returns the samples in which most cables are far from their last reversal.
fn sliding_samples(problem: &Problem<'_>) -> Vec<bool> {
    let mut counts = vec![0_usize; problem.used.len()];
    for member in &problem.members {
        let ways_m: Vec<f64> = ways_since_reversal(member.record.rows).collect();
        let mut moving: Vec<f64> = ways_m.iter().copied().filter(|way_m| *way_m > 0.0).collect();
        let least = moving.len() * NOT_SLIDING_PERCENT / 100;
        if least >= moving.len() {
            continue;
        }
        let (_, least_m, _) = moving.select_nth_unstable_by(least, f64::total_cmp);
        for (count, way_m) in counts.iter_mut().zip(&ways_m) {
            *count += usize::from(way_m >= least_m);
        }
    }
    counts.into_iter().map(|count| 4 * count >= 3 * problem.members.len()).collect()
}

/// Returns the stretch of a log with the most presliding, where σ has the greatest influence.
fn most_presliding(problem: &Problem<'_>) -> Range<usize> {
    let mut sums = vec![0_u32; problem.used.len() + 1];
    for member in &problem.members {
        for (sum, way_m) in sums.iter_mut().skip(1).zip(ways_since_reversal(member.record.rows)) {
            *sum += u32::from(PRESLIDING_M.contains(&way_m));
        }
    }
    let mut total = 0_u64;
    let totals: Vec<u64> = sums
        .into_iter()
        .map(|count| {
            total += u64::from(count);
            total
        })
        .collect();
    let logs = problem.members.first().into_iter().flat_map(|member| member.record.logs());
    let stretches = logs.flat_map(|(start, rows)| {
        let (end, length) = (start + rows.len(), rows.len().min(STRETCH));
        (start..=end - length).step_by(STRETCH / 8).map(move |from| from..from + length)
    });
    let presliding = |cycles: &Range<usize>| {
        let at = |place: usize| totals.get(place).copied().unwrap_or(0);
        at(cycles.end) - at(cycles.start)
    };
    let most = stretches.reduce(|most, other| if presliding(&other) > presliding(&most) { other } else { most });
    most.unwrap_or(0..0)
}
