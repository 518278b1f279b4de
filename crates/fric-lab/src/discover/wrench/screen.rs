//! Ranks candidates by how much one linear step from a model explains with each.
//!
//! A candidate adds columns `C` beside the model's derivatives `J` and deviations `r`: the derivatives of the deviations by the candidate's
//! parameters at the start of its search, and, if the start is not the model itself, the change of the deviations from the model to the start. The sum
//! of squares falls by `bᵀS⁻¹b` with `S = CᵀC − CᵀJ(JᵀJ)⁻¹JᵀC` and `b = Cᵀr − CᵀJ(JᵀJ)⁻¹Jᵀr` (score test; C. R. Rao, *Large sample tests of
//! statistical hypotheses*, Proc. Cambridge Phil. Soc. 44, 1948). All candidates share one pass over the training samples.

use std::ops::Range;
use std::sync::Arc;

use fric_core::effects::Effect;
use fric_core::parameters::Values;
use nalgebra::{DMatrix, DVector, Vector6};

use super::bench::{Bench, Model};
use super::candidate::Candidate;
use super::geometry::Geometry;
use crate::candidates::catalogue::{fitted, starts};
use crate::effects::Around;
use crate::fit::Parameter;
use crate::search::gram::Gram;
use crate::search::gram::inverse_of_normal;
use crate::search::pass::{Forces, Part};
use crate::search::stream::Stream;

/// A direction of a candidate counts as one that the model already has if less than this fraction of its squares is independent of the model.
const OWN_RATIO: f64 = 1e-6;

/// A candidate with what a linear step promises.
#[derive(Clone, Debug)]
pub struct Promise {
    pub candidate: Candidate,
    /// The model with the candidate at the best start of its search.
    pub model: Model,
    /// Decrease of the whitened sum of squares over the training samples.
    pub gain: f64,
}

/// One start of the search for an effect on a cable.
struct Start {
    cable: usize,
    effect: Effect,
    values: Values,
    /// Whether it is not the model itself. It has one more column then: the change from the model to the start.
    is_elsewhere: bool,
    /// Its columns among those of the cable: changes of the cable's force.
    columns: Range<usize>,
}

/// The columns of all starts. They come along with the log, because series of them would take up far more memory than the log.
struct Columns<'a> {
    starts: &'a [Start],
    /// The forces of the starts.
    stream: Stream<'a>,
    /// The forces of the model, by cable.
    current: &'a [Arc<Forces>],
    /// The columns of each cable in the cycle reached.
    of_cables: Vec<Vec<f64>>,
}

impl<'a> Columns<'a> {
    fn new(bench: &Bench<'a>, starts: &'a [Start], current: &'a [Arc<Forces>]) -> Self {
        let part = |start: &Start| {
            let record = *bench.records.get(start.cable)?;
            Some(Part { record, values: start.values, free: fitted(start.effect) })
        };
        let stream = Stream::new(starts.iter().filter_map(part).collect());
        Self { starts, stream, current, of_cables: vec![Vec::new(); bench.records.len()] }
    }

    /// Returns the number of columns of a cable.
    fn count(&self, cable: usize) -> usize {
        let of_cable = self.starts.iter().filter(|start| start.cable == cable);
        of_cable.map(|start| start.columns.end).max().unwrap_or(0)
    }

    /// Goes on to a cycle, which must not be before the last one.
    fn advance_to(&mut self, cycle: usize) {
        self.stream.advance_to(cycle);
        self.of_cables.iter_mut().for_each(Vec::clear);
        for (place, start) in self.starts.iter().enumerate() {
            let (force_n, derivatives) = self.stream.at(place, cycle);
            let now_n = self.current.get(start.cable).map_or(f64::NAN, |forces| forces.at(cycle).0);
            let Some(columns) = self.of_cables.get_mut(start.cable) else { continue };
            columns.extend_from_slice(derivatives);
            columns.extend(start.is_elsewhere.then_some(force_n - now_n));
        }
    }

    /// Returns the columns of a cable.
    fn of_cable(&self, cable: usize) -> &[f64] {
        self.of_cables.get(cable).map_or(&[], Vec::as_slice)
    }

    /// Returns the columns of a start.
    fn of_start(&self, start: &Start) -> &[f64] {
        self.of_cable(start.cable).get(start.columns.clone()).unwrap_or_default()
    }
}

/// Returns what every wanted candidate promises beside a model from its best start.
pub fn promises(
    bench: &Bench<'_>,
    model: &Model,
    around: &[Around],
    is_wanted: impl Fn(Candidate) -> bool,
) -> Vec<Promise> {
    let cables: Vec<usize> = (0..bench.records.len()).collect();
    let catalogue = |cable: usize| {
        let wanted =
            |effect: &Effect| is_wanted(Candidate::Own(cable, *effect)) || is_wanted(Candidate::Alike(*effect));
        Effect::ALL.iter().copied().filter(wanted).collect::<Vec<Effect>>()
    };
    let mut all_starts: Vec<Start> = Vec::new();
    let current = bench.with_problem(model, Vec::new(), |problem| problem.forces(&model.values)).unwrap_or_default();
    for cable in cables {
        let (Some(record), Some(around)) = (bench.records.get(cable), around.get(cable)) else { continue };
        let Some(values) = model.values.get(cable).filter(|_| cable < current.len()) else { continue };
        let mut first = 0;
        for effect in catalogue(cable) {
            for start in starts(effect, values, around, record) {
                let is_elsewhere = is_elsewhere(&start, values);
                let count = fitted(effect).len() + usize::from(is_elsewhere);
                all_starts.push(Start { cable, effect, values: start, is_elsewhere, columns: first..first + count });
                first += count;
            }
        }
    }
    let mut columns = Columns::new(bench, &all_starts, &current);
    let wanted = bench.description.candidates().into_iter().filter(|of| is_wanted(Candidate::Geometry(*of)));
    let force_n = |place: usize, cable: usize| current.get(cable).map_or(f64::NAN, |forces| forces.at(place).0);
    let geometries = wanted.map(|of| {
        let mut tangents = bench.description.tangents(of, &model.changes, force_n);
        tangents.iter_mut().flatten().for_each(|change| *change = bench.whitening * *change);
        GeometrySums::new(of, tangents, model.unknowns().len())
    });
    let mut geometries: Vec<GeometrySums> = geometries.collect();
    let sums = Sums::of(bench, model, &mut columns, &mut geometries);
    let mut promises: Vec<Promise> = Vec::new();
    let mut offer = |promise: Promise| {
        if !is_wanted(promise.candidate) || !promise.gain.is_finite() {
            return;
        }
        match promises.iter_mut().find(|of| of.candidate == promise.candidate) {
            Some(of) if of.gain < promise.gain => *of = promise,
            Some(_) => {}
            None => promises.push(promise),
        }
    };
    for (place, start) in all_starts.iter().enumerate() {
        let candidate = Candidate::Own(start.cable, start.effect);
        let gain = sums.gain(&[place], &all_starts);
        offer(Promise { candidate, model: beside(model, candidate, &[start]), gain });
    }
    for effect in Effect::ALL.iter().copied().filter(|effect| is_wanted(Candidate::Alike(*effect))) {
        let of_cable = |cable: usize| {
            let places = all_starts.iter().enumerate().filter(move |(_, of)| of.cable == cable && of.effect == effect);
            places.map(|(place, _)| place).collect::<Vec<usize>>()
        };
        let of_cables: Vec<Vec<usize>> = (0..bench.records.len()).map(of_cable).collect();
        let count = of_cables.iter().map(Vec::len).min().unwrap_or(0);
        for start in 0..count {
            let places: Vec<usize> = of_cables.iter().filter_map(|of| of.get(start).copied()).collect();
            let from: Vec<&Start> = places.iter().filter_map(|place| all_starts.get(*place)).collect();
            let candidate = Candidate::Alike(effect);
            let gain = sums.gain(&places, &all_starts);
            offer(Promise { candidate, model: beside(model, candidate, &from), gain });
        }
    }
    for of in &geometries {
        let candidate = Candidate::Geometry(of.geometry);
        let gain = schur_gain(&of.own, &of.mixed, &sums.normal, &of.score, &sums.gradient);
        offer(Promise { candidate, model: beside(model, candidate, &[]), gain });
    }
    promises.sort_by(|one, other| other.gain.total_cmp(&one.gain));
    promises
}

fn is_elsewhere(start: &Values, values: &Values) -> bool {
    start.iter().zip(values).any(|(one, other)| one.to_bits() != other.to_bits())
}

/// Returns a model with one more candidate at its start; an effect of all cables alike starts from the mean of their starts.
fn beside(model: &Model, candidate: Candidate, from: &[&Start]) -> Model {
    let mut model = model.clone();
    match candidate {
        Candidate::Own(cable, effect) => {
            if let (Some(values), Some(free), [start]) = (model.values.get_mut(cable), model.free.get_mut(cable), from)
            {
                *values = start.values;
                free.extend(fitted(effect).into_iter().filter(|of| !free.contains(of)).collect::<Vec<Parameter>>());
            }
        }
        Candidate::Alike(effect) => {
            #[expect(clippy::cast_precision_loss, reason = "a count of cables")]
            let count = from.len() as f64;
            for parameter in Parameter::of(effect) {
                let place = parameter.place();
                let mean = from.iter().map(|start| start.values[place]).sum::<f64>() / count;
                model.values.iter_mut().for_each(|values| values[place] = mean);
            }
            let own = fitted(effect);
            model.free.iter_mut().for_each(|free| free.retain(|of| !own.contains(of)));
            model.alike.extend(own);
        }
        Candidate::Geometry(of) => {
            model.changes.insert(of, vec![0.0; of.count()]);
        }
    }
    model
}

/// Returns `bᵀS⁻¹b` without directions that the model already has; NaN if the sums are.
fn schur_gain(
    own: &DMatrix<f64>,
    mixed: &DMatrix<f64>,
    normal: &DMatrix<f64>,
    own_gradient: &DVector<f64>,
    gradient: &DVector<f64>,
) -> f64 {
    let Some(inverse) = inverse_of_normal(normal) else { return f64::NAN };
    let by_others = mixed.transpose() * inverse;
    let schur = own - &by_others * mixed;
    let score = own_gradient - &by_others * gradient;
    let scale: Vec<f64> = own.diagonal().iter().map(|square| square.sqrt()).collect();
    let unit = |place: usize| if scale[place] > 0.0 { scale[place].recip() } else { 0.0 };
    let scaled =
        DMatrix::from_fn(own.nrows(), own.ncols(), |row, column| schur[(row, column)] * unit(row) * unit(column));
    if scaled.iter().any(|entry| !entry.is_finite()) {
        return f64::NAN;
    }
    let eigen = scaled.symmetric_eigen();
    let scaled_score = DVector::from_fn(score.len(), |row, _| score[row] * unit(row));
    let parts = eigen.eigenvectors.column_iter().zip(eigen.eigenvalues.iter());
    parts
        .filter(|(_, size)| **size > OWN_RATIO)
        .map(|(direction, size)| direction.dot(&scaled_score).powi(2) / size)
        .sum()
}

/// The sums of an entry of the robot file, and the whitened derivatives of the deviations by its numbers in every sample.
struct GeometrySums {
    geometry: Geometry,
    tangents: Vec<Vec<Vector6<f64>>>,
    own: DMatrix<f64>,
    mixed: DMatrix<f64>,
    score: DVector<f64>,
}

impl GeometrySums {
    fn new(geometry: Geometry, tangents: Vec<Vec<Vector6<f64>>>, unknowns: usize) -> Self {
        let count = tangents.len();
        let (own, mixed) = (DMatrix::zeros(count, count), DMatrix::zeros(unknowns, count));
        Self { geometry, tangents, own, mixed, score: DVector::zeros(count) }
    }

    fn add(&mut self, place: usize, rows: &[Vec<f64>]) {
        let changes: Vec<Vector6<f64>> =
            self.tangents.iter().filter_map(|tangent| tangent.get(place)).copied().collect();
        for (column, change) in changes.iter().enumerate() {
            for (row, part) in rows.iter().zip(change.iter()) {
                let Some((deviation, derivatives)) = row.split_last() else { continue };
                self.score[column] += part * deviation;
                let mut mixed = self.mixed.column_mut(column);
                mixed.iter_mut().zip(derivatives).for_each(|(sum, derivative)| *sum += part * derivative);
            }
            for (row, other) in changes.iter().enumerate() {
                self.own[(row, column)] += other.dot(change);
            }
        }
    }
}

/// Returns the pairs of starts whose products are needed, with sums of 0: each start with itself, and with the start of the same effect on each other
/// cable that has the same index among its starts.
fn squares_of(starts: &[Start]) -> Vec<(usize, usize, DMatrix<f64>)> {
    let order = |place: usize, of: &Start| {
        starts.iter().take(place).filter(|other| other.cable == of.cable && other.effect == of.effect).count()
    };
    let mut squares = Vec::new();
    for (one, from) in starts.iter().enumerate() {
        for (other, to) in starts.iter().enumerate().skip(one) {
            let is_pair = other == one
                || from.effect == to.effect
                    && from.cable != to.cable
                    && from.columns.len() == to.columns.len()
                    && order(one, from) == order(other, to);
            if is_pair {
                squares.push((one, other, DMatrix::zeros(from.columns.len(), to.columns.len())));
            }
        }
    }
    squares
}

/// Sums over the training samples.
struct Sums {
    /// `JᵀJ`.
    normal: DMatrix<f64>,
    /// `Jᵀr`.
    gradient: DVector<f64>,
    /// `CᵀJ` of each cable.
    mixed: Vec<DMatrix<f64>>,
    /// `Cᵀr` of each cable.
    scores: Vec<DVector<f64>>,
    /// `CᵀC` of the pairs of [`squares_of`].
    squares: Vec<(usize, usize, DMatrix<f64>)>,
}

impl Sums {
    fn of(bench: &Bench<'_>, model: &Model, columns: &mut Columns<'_>, geometries: &mut [GeometrySums]) -> Self {
        let count = model.unknowns().len();
        let (structure, _) = bench.description.changed(&model.changes);
        let cables = bench.records.len();
        let mut gram = Gram::new(count);
        let counts: Vec<usize> = (0..cables).map(|cable| columns.count(cable)).collect();
        let mut mixed: Vec<Vec<f64>> = counts.iter().map(|of_cable| vec![0.0; of_cable * count]).collect();
        let mut scores: Vec<DVector<f64>> = counts.iter().map(|of_cable| DVector::zeros(*of_cable)).collect();
        let starts = columns.starts;
        let mut squares = squares_of(starts);
        let mut levers: Vec<Vector6<f64>> = Vec::with_capacity(cables);
        // The product of a cable's whitened column of the structure matrix with the rows: derivatives, then deviation.
        let mut seen = vec![0.0; count + 1];
        bench.rows(model, |place, rows| {
            for row in rows {
                gram.add(row);
            }
            columns.advance_to(place);
            levers.clear();
            for (cable, (mixed, scores)) in mixed.iter_mut().zip(&mut scores).enumerate() {
                let lever =
                    structure.get(place * cables + cable).map_or_else(Vector6::zeros, |of| bench.whitening * of);
                levers.push(lever);
                seen.fill(0.0);
                for (row, part) in rows.iter().zip(lever.iter()) {
                    seen.iter_mut().zip(row).for_each(|(sum, entry)| *sum += part * entry);
                }
                let Some((deviation, derivatives)) = seen.split_last() else { continue };
                let changes = columns.of_cable(cable);
                for (change, of_change) in changes.iter().zip(mixed.chunks_exact_mut(count.max(1))) {
                    of_change.iter_mut().zip(derivatives).for_each(|(sum, derivative)| *sum += change * derivative);
                }
                scores.iter_mut().zip(changes).for_each(|(sum, change)| *sum += change * deviation);
            }
            for (one, other, sum) in &mut squares {
                let (Some(one), Some(other)) = (starts.get(*one), starts.get(*other)) else { continue };
                let (Some(left), Some(right)) = (levers.get(one.cable), levers.get(other.cable)) else { continue };
                let lever = left.dot(right);
                for (row, left) in columns.of_start(one).iter().enumerate() {
                    for (column, right) in columns.of_start(other).iter().enumerate() {
                        sum[(row, column)] += lever * left * right;
                    }
                }
            }
            for of in geometries.iter_mut() {
                of.add(place, rows);
            }
        });
        let (normal, gradient, _) = gram.normal_equations();
        let of_cable = |(mixed, of_cable): (&Vec<f64>, &usize)| DMatrix::from_row_slice(*of_cable, count, mixed);
        let mixed = mixed.iter().zip(&counts).map(of_cable).collect();
        Self { normal, gradient, mixed, scores, squares }
    }

    /// Returns the decrease of the sum of squares by the same step from these starts of different cables.
    fn gain(&self, places: &[usize], starts: &[Start]) -> f64 {
        let of: Vec<&Start> = places.iter().filter_map(|place| starts.get(*place)).collect();
        let Some(width) = of.first().map(|start| start.columns.len()) else { return f64::NAN };
        if of.iter().any(|start| start.columns.len() != width) {
            return f64::NAN;
        }
        let mut own = DMatrix::zeros(width, width);
        for (one, other, sum) in
            self.squares.iter().filter(|(one, other, _)| [one, other].iter().all(|of| places.contains(of)))
        {
            own += sum;
            if one != other {
                own += sum.transpose();
            }
        }
        let mut mixed = DMatrix::zeros(self.normal.nrows(), width);
        let mut score = DVector::zeros(width);
        for start in of {
            let (Some(of_cable), Some(scores)) = (self.mixed.get(start.cable), self.scores.get(start.cable)) else {
                return f64::NAN;
            };
            mixed += of_cable.rows(start.columns.start, width).transpose();
            score += scores.rows(start.columns.start, width);
        }
        schur_gain(&own, &mixed, &self.normal, &score, &self.gradient)
    }
}
