//! A table for a rest without a name. It says how large the rest is and where, not what it is.
//!
//! Tables are tried after naming if the rest exceeds the noise: over each condition of the cycle, of a force and of a factor on the friction, over
//! the whole range of the condition and over the part in which the rest is concentrated.
//!
//! 1. *Fit.* The shares of a table and the parameters of the model are fitted together, by penalised least squares on the training samples: `Σr² +
//!    λ·Σ(second differences)²`. Condition, kind and λ are chosen by cross-validation over the blocks.
//! 2. *Keep.* A table must remove [`LEAST_CLOSED`] of the squares above the noise on the held-out samples, with a gain beyond the scatter of their
//!    blocks. It must also hold in other conditions: for each third of every other condition, and of the time, a table learned outside this third
//!    must remove enough inside it, as far as it has covered its own condition.
//! 3. A rest that another cable's signals explain better gets no table.
//!
//! All fits use the cycle's own derivatives, so a table runs in the cycle exactly as it was judged.

use std::ops::Range;

use fric_core::effects::Effect;
use fric_core::effects::empirical::{Over, RATIO, SHARE_PLACES, SHARES, SIZE};
use fric_core::parameters::{MU, Values};
use nalgebra::{DMatrix, DVector};

use super::WORTH;
use super::places::{Place, sum_and_error};
use crate::certainty::undetermined::inverse_of_normal;
use crate::discover::workbench::{Model, Workbench};
use crate::fit::Parameter;
use crate::search::problem::Problem;

/// Minimum fraction of the squares above the noise that a table removes on held-out samples. The remaining rms gap is then at most 0.7 of the
/// original one.
const LEAST_CLOSED: f64 = 0.5;
/// The same minimum in conditions where the table was not learned, if there is an excess.
const LEAST_CLOSED_ELSEWHERE: f64 = 0.25;
/// Minimum gain in standard errors, by the scatter of blocks.
const LEAST_SIGNIFICANCE: f64 = 3.0;
/// Excess squares below this fraction of the noise variance count as small.
const LITTLE: f64 = 0.2;
/// Trial penalties on the second differences of a table, relative to the mean information on a share.
const PENALTIES: [f64; 5] = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1];
/// Penalty on the size of the table, on the same scale. It assigns to friction what both table and friction can explain.
const RIDGE: f64 = 1e-6;
/// Number of folds for cross-validation over the training blocks.
const FOLDS: usize = 4;
/// Fractions of the samples that the range of a table leaves out at either end: all samples except outliers, or the central part with more closely
/// spaced points.
const TAIL_RATIOS: [f64; 2] = [0.002, 0.05];
/// A part of a condition's range gets a table of its own if it is narrower than this fraction of the range. Such a table extends beyond the part by
/// this fraction of its width.
const NARROW_RATIO: f64 = 0.5;
const MARGIN_RATIO: f64 = 1.0;
/// Rounds that alternate between fitting the table and fitting the model.
const ROUNDS: usize = 3;
/// Maximum number of rows used to choose and to check. Longer logs are decimated.
const MOST_ROWS: usize = 60_000;
/// A share is known if its samples weigh at least this much.
const LEAST_WEIGHT: f64 = 20.0;
/// Minimum number of samples in a third of a condition.
const FEWEST_SAMPLES: usize = 200;

/// What a table changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Changes {
    /// The force at the platform.
    Force,
    /// The friction.
    Friction,
}

/// A table that passed the checks.
#[derive(Clone, Debug)]
pub struct Table {
    /// The model with it.
    pub values: Values,
    /// The fitted parameters.
    pub fitted: Vec<Parameter>,
    /// Covariance of the fitted parameters, by the scatter of blocks.
    pub covariance: DMatrix<f64>,
    /// Training sum of squares without and with the table, N².
    pub training: [f64; 2],
    /// Factor by which memory in the residual weakens the evidence, at least 1.
    pub inflation: f64,
    /// Fraction of the held-out sum of squares that the table removes.
    pub gain_ratio: f64,
}

/// Returns the best table for the residual of a model, if one passes the checks. `places` are the conditions in which the rest is concentrated.
pub fn table(bench: &Workbench<'_>, model: &Model, noise_n: f64, places: &[Place]) -> Option<Table> {
    let without = bench.try_one(model);
    let residual_n = bench.residuals_n(&without.values);
    let squares = Squares::of(bench, &residual_n, true);
    if squares.excess(noise_n) <= WORTH * squares.noise(noise_n) {
        return None;
    }
    let base = without.model();
    let mut candidates = candidates(bench, &base, &residual_n, places);
    // A constant load says nothing about how the force depends on it. A table over the load would turn any force into that constant.
    candidates.retain(|candidate| candidate.over != Over::Load || bench.knows_load(noise_n));
    let chosen = candidates.iter().filter_map(|candidate| candidate.tried(bench, &base));
    let chosen = chosen.min_by(|one, other| one.predicted.total_cmp(&other.predicted))?;
    let holds_elsewhere = chosen.holds_elsewhere(bench, noise_n);
    let (values, covariance, inflation, fitted) = chosen.finished(bench, &base)?;
    let with_n = bench.residuals_n(&values);
    let after = Squares::of(bench, &with_n, true);
    let gains: Vec<f64> = squares.of_blocks.iter().zip(&after.of_blocks).map(|(one, other)| one - other).collect();
    let (gain, error) = sum_and_error(&gains);
    let closed = gain / squares.excess(noise_n);
    let holds = holds_elsewhere && closed >= LEAST_CLOSED && gain > LEAST_SIGNIFICANCE * error;
    let training = [&residual_n, &with_n].map(|residual_n| Squares::of(bench, residual_n, false).sum);
    holds.then_some(Table { values, fitted, covariance, training, inflation, gain_ratio: gain / squares.sum })
}

/// Returns a model's values without a table.
pub fn without_table(values: &Values) -> Values {
    let mut neutral = *values;
    for parameter in Parameter::of(Effect::Empirical) {
        neutral[parameter.place()] = parameter.row().neutral;
    }
    neutral
}

/// Whether a model has a table that acts.
pub fn has_table(values: &Values) -> bool {
    [SIZE, RATIO].iter().any(|size| values[*size].abs() > 0.0) && Over::of(|place| values[place]).is_some()
}

/// Squares of a residual over one half of the log.
struct Squares {
    sum: f64,
    count: f64,
    of_blocks: Vec<f64>,
}

impl Squares {
    fn of(bench: &Workbench<'_>, residual_n: &[f64], held_out: bool) -> Self {
        let (mut sum, mut count, mut of_blocks) = (0.0, 0.0, Vec::new());
        for block in bench.blocks.iter().filter(|block| block.held_out == held_out) {
            let mut of_block = 0.0;
            let numbers = residual_n.get(block.cycles.clone()).unwrap_or_default();
            for number in numbers.iter().filter(|number| number.is_finite()) {
                (of_block, count) = (of_block + number * number, count + 1.0);
            }
            sum += of_block;
            of_blocks.push(of_block);
        }
        Self { sum, count, of_blocks }
    }

    fn noise(&self, noise_n: f64) -> f64 {
        self.count * noise_n * noise_n
    }

    fn excess(&self, noise_n: f64) -> f64 {
        self.sum - self.noise(noise_n)
    }
}

/// Returns the value of a table's condition in each cycle.
fn condition(bench: &Workbench<'_>, over: Over) -> Vec<f64> {
    let gain = bench.record.params.frictionless_gain();
    let of = |row: &crate::fit::Row| match over {
        Over::Speed => row.signals.speed_m_per_s,
        Over::Length => row.signals.length_m,
        Over::Load => gain * row.signals.sensor_force_n,
    };
    bench.record.rows.iter().map(of).collect()
}

/// A table to try: its range and what it changes.
#[derive(Clone, Debug)]
struct Layout {
    over: Over,
    range: [f64; 2],
    changes: Changes,
}

/// Returns every table to try.
fn candidates(bench: &Workbench<'_>, base: &Model, residual_n: &[f64], places: &[Place]) -> Vec<Layout> {
    let slides = base.values[MU] > 0.0;
    let mut layouts = Vec::new();
    for over in Over::ALL {
        let values = condition(bench, over);
        let known = values.iter().zip(residual_n).filter(|(value, residual_n)| (*value + *residual_n).is_finite());
        let mut sorted: Vec<f64> = known.map(|(value, _)| *value).collect();
        sorted.sort_by(f64::total_cmp);
        let within = |tail_ratio: f64| {
            #[expect(clippy::cast_precision_loss, reason = "a count")]
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below a count")]
            let tail = (tail_ratio * sorted.len() as f64) as usize;
            let (from, to) = (*sorted.get(tail)?, *sorted.get(sorted.len().checked_sub(tail + 1)?)?);
            (from < to).then_some([from, to])
        };
        let Some([from, to]) = within(TAIL_RATIOS[0]) else { continue };
        let mut ranges: Vec<[f64; 2]> = TAIL_RATIOS.into_iter().filter_map(within).collect();
        let narrow = places.iter().filter(|place| signal_of(over) == place.signal && over == Over::Length);
        for place in narrow.filter(|place| place.to - place.from < NARROW_RATIO * (to - from)) {
            let margin = MARGIN_RATIO * (place.to - place.from);
            ranges.push([(place.from - margin).max(from), (place.to + margin).min(to)]);
        }
        for range in ranges {
            layouts.push(Layout { over, range, changes: Changes::Force });
            if slides {
                layouts.push(Layout { over, range, changes: Changes::Friction });
            }
        }
    }
    layouts
}

/// Returns the name of a table's condition in results.
pub fn signal_of(over: Over) -> &'static str {
    match over {
        Over::Speed => "speed",
        Over::Length => "length",
        Over::Load => "load",
    }
}

/// Whether a parameter of a table has no effect: the range of another condition, or a share of zero.
pub fn is_idle(parameter: &Parameter, values: &Values) -> bool {
    let is_size = [SIZE, RATIO].contains(&parameter.place());
    let own = Over::of(|place| values[place]).map_or(0..0, |over| over.from()..over.to() + 1);
    parameter.effect() == Some(Effect::Empirical)
        && !own.contains(&parameter.place())
        && (is_size || !SHARE_PLACES.contains(&parameter.place()))
        && values[parameter.place()].abs() <= 0.0
}

/// Returns the physical causes that look like such a table.
pub fn looks_like(over: Over, is_force: bool) -> &'static [&'static str] {
    match (over, is_force) {
        (Over::Speed, true) => &[
            "cable or drum that moves air or oil",
            "a drive whose current stands for the force",
            "viscous friction of another law",
        ],
        (Over::Speed, false) => &[
            "a Stribeck curve of another shape",
            "lubrication that builds up with the speed",
            "a bearing that changes its regime",
        ],
        (Over::Length, true) => &[
            "a pulley or a drum out of true that the run turns less than once",
            "weight and sag of the cable",
            "a spring or a cable chain that is taken along",
            "a wrong position of the frame or of the attachment",
        ],
        (Over::Length, false) => &[
            "a worn, kinked or dirty stretch of cable",
            "a drum whose layers differ",
            "a guide that the cable touches over part of its way",
        ],
        (Over::Load, true) => &[
            "a force sensor whose curve is bent at one place",
            "a mount that gives way or meets a stop",
            "a wrong wrap angle at the sensor",
        ],
        (Over::Load, false) => &[
            "friction that depends on the load by another law",
            "a bearing or a frame that is bent by the load",
            "cable that is flattened in its groove",
        ],
    }
}

impl Layout {
    /// Returns a model's values with this table, with the given size and shares.
    fn set(&self, base: &Values, size: f64, shares: &[f64]) -> Values {
        let mut values = without_table(base);
        values[match self.changes {
            Changes::Force => SIZE,
            Changes::Friction => RATIO,
        }] = size;
        [values[self.over.from()], values[self.over.to()]] = self.range;
        for (place, share) in SHARE_PLACES.zip(shares) {
            values[place] = *share;
        }
        values
    }

    /// Returns the same from the changes, in N or as fractions of μ, scaled so that the greatest share is 1.
    fn scaled(&self, base: &Values, changes: &[f64]) -> Values {
        let greatest = changes.iter().fold(0.0, |most: f64, change| most.max(change.abs()));
        let size = if greatest > 0.0 { greatest } else { 1.0 };
        let shares: Vec<f64> = changes.iter().map(|change| (change / size).clamp(-1.0, 1.0)).collect();
        self.set(base, size, &shares)
    }

    /// Returns what a model's table changes at each of its points.
    fn changes_of(&self, values: &Values) -> Vec<f64> {
        let size = values[match self.changes {
            Changes::Force => SIZE,
            Changes::Friction => RATIO,
        }];
        SHARE_PLACES.map(|place| size * values[place]).collect()
    }

    /// Returns the derivatives of a model with this table, at a size of 1, with respect to the free parameters and the shares.
    fn rows(&self, bench: &Workbench<'_>, base: &Model, values: &Values) -> Rows {
        let mut free = base.free.clone();
        free.extend(shares());
        let size = values[if self.changes == Changes::Force { SIZE } else { RATIO }];
        let problem = Problem { used: bench.counts.to_vec(), ..bench.problem(&free, None) };
        let used: Vec<usize> = (0..bench.counts.len()).filter(|cycle| bench.counts[*cycle]).collect();
        let stride = used.len().div_ceil(MOST_ROWS).max(1);
        let blocks = block_of_each(bench);
        let (first_share, width) = (base.free.len(), free.len() + 1);
        let mut rows = Rows {
            width,
            first_share,
            numbers: Vec::new(),
            cycles: Vec::new(),
            blocks: Vec::new(),
            held_out: Vec::new(),
        };
        let mut place = 0;
        problem.rows(&[*values], |row| {
            let cycle = used.get(place).copied();
            place += 1;
            let Some((cycle, block)) = cycle.and_then(|cycle| Some((cycle, blocks.get(cycle).copied().flatten()?)))
            else {
                return;
            };
            if (place - 1) % stride != 0 || row.len() != width || row.iter().any(|number| !number.is_finite()) {
                return;
            }
            rows.numbers.extend(row.iter().enumerate().map(|(column, number)| {
                if column >= first_share && column + 1 < width { number / size } else { *number }
            }));
            rows.cycles.push(cycle);
            rows.blocks.push(block);
            rows.held_out.push(bench.blocks.get(block).is_some_and(|block| block.held_out));
        });
        rows
    }

    /// Fits the table beside the model with the penalty that predicts best.
    fn tried(&self, bench: &Workbench<'_>, base: &Model) -> Option<Tried> {
        let values = self.set(&base.values, 1.0, &[0.0; SHARES]);
        let rows = self.rows(bench, base, &values);
        let learned: Vec<usize> =
            bench.blocks.iter().enumerate().filter(|(_, block)| !block.held_out).map(|(place, _)| place).collect();
        let fold_of = |block: usize| learned.iter().position(|place| *place == block).map(|place| place % FOLDS);
        let folds: Vec<Option<usize>> = (0..bench.blocks.len()).map(fold_of).collect();
        let normals: Vec<Normal> = (0..FOLDS)
            .map(|fold| rows.normal(|row| folds.get(rows.blocks[row]).copied().flatten() == Some(fold)))
            .collect();
        let all = normals.iter().fold(Normal::none(rows.width), |sum, normal| sum.and(normal));
        let predicted = |penalty: f64| -> Option<f64> {
            let of_fold = |normal: &Normal| {
                let step = all.less(normal).solved(rows.first_share, penalty, &[0.0; SHARES])?;
                Some(normal.squares_after(&step))
            };
            normals.iter().map(of_fold).sum::<Option<f64>>()
        };
        let best = PENALTIES.iter().filter_map(|penalty| Some((predicted(*penalty)?, *penalty)));
        let (predicted, penalty) = best.min_by(|one, other| one.0.total_cmp(&other.0))?;
        Some(Tried { layout: self.clone(), penalty, predicted, rows })
    }
}

/// Returns the parameters of the shares.
fn shares() -> impl Iterator<Item = Parameter> {
    Parameter::of(Effect::Empirical).filter(|parameter| SHARE_PLACES.contains(&parameter.place()))
}

/// Returns the block of each cycle.
fn block_of_each(bench: &Workbench<'_>) -> Vec<Option<usize>> {
    let mut blocks = vec![None; bench.counts.len()];
    for (place, block) in bench.blocks.iter().enumerate() {
        if let Some(cycles) = blocks.get_mut(block.cycles.clone()) {
            cycles.fill(Some(place));
        }
    }
    blocks
}

/// Derivatives and residuals of samples, side by side.
struct Rows {
    width: usize,
    /// Column of the first share; the last column is the residual.
    first_share: usize,
    numbers: Vec<f64>,
    cycles: Vec<usize>,
    blocks: Vec<usize>,
    held_out: Vec<bool>,
}

impl Rows {
    fn count(&self) -> usize {
        self.cycles.len()
    }

    fn at(&self, row: usize) -> &[f64] {
        self.numbers.get(row * self.width..(row + 1) * self.width).unwrap_or_default()
    }

    /// Returns the normal equations of the wanted rows.
    fn normal(&self, wanted: impl Fn(usize) -> bool) -> Normal {
        let mut normal = Normal::none(self.width);
        for row in (0..self.count()).filter(|row| wanted(*row)) {
            normal.add(self.at(row));
        }
        normal.mirrored()
    }
}

/// Inner products of the columns; the residual is the last column.
#[derive(Clone, Debug)]
struct Normal(DMatrix<f64>);

impl Normal {
    fn none(width: usize) -> Self {
        Self(DMatrix::zeros(width, width))
    }

    /// Adds the products of a row, above the diagonal only.
    fn add(&mut self, row: &[f64]) {
        for (one, number) in row.iter().enumerate().filter(|(_, number)| **number != 0.0) {
            for (other, factor) in row.iter().enumerate().skip(one) {
                self.0[(one, other)] += number * factor;
            }
        }
    }

    fn mirrored(mut self) -> Self {
        self.0.fill_lower_triangle_with_upper_triangle();
        self
    }

    fn and(&self, other: &Self) -> Self {
        Self(&self.0 + &other.0)
    }

    fn less(&self, other: &Self) -> Self {
        Self(&self.0 - &other.0)
    }

    fn free(&self) -> usize {
        self.0.nrows() - 1
    }

    /// Returns the matrix with the penalties on the second differences of the shares and on their size.
    fn penalised(&self, first_share: usize, penalty: f64) -> DMatrix<f64> {
        let free = self.free();
        let mut matrix = self.0.view((0, 0), (free, free)).into_owned();
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let information = (first_share..free).map(|place| matrix[(place, place)]).sum::<f64>() / SHARES as f64;
        for place in first_share..free {
            matrix[(place, place)] += RIDGE * information;
        }
        for middle in first_share + 1..free.saturating_sub(1) {
            let difference = [(middle - 1, 1.0), (middle, -2.0), (middle + 1, 1.0)];
            for (one, factor) in difference {
                for (other, with) in difference {
                    matrix[(one, other)] += penalty * information * factor * with;
                }
            }
        }
        matrix
    }

    /// Returns the step to the minimum, given the present `changes` of the shares.
    fn solved(&self, first_share: usize, penalty: f64, changes: &[f64]) -> Option<DVector<f64>> {
        let free = self.free();
        let matrix = self.penalised(first_share, penalty);
        let plain = self.0.view((0, 0), (free, free));
        let mut now = DVector::zeros(free);
        for (number, change) in now.iter_mut().skip(first_share).zip(changes) {
            *number = *change;
        }
        let slope = self.0.view((0, free), (free, 1)) + (&matrix - plain) * now;
        Some(-(inverse_of_normal(&matrix)? * slope).column(0).into_owned())
    }

    /// Returns the sum of squares after a step.
    fn squares_after(&self, step: &DVector<f64>) -> f64 {
        let whole = step.clone().push(1.0);
        (&self.0 * &whole).dot(&whole)
    }

    /// Returns the step of the model alone, without a table.
    fn without_shares(&self, first_share: usize) -> Option<DVector<f64>> {
        let free = self.free();
        let mut step = DVector::zeros(free);
        if first_share > 0 {
            let matrix = self.0.view((0, 0), (first_share, first_share)).into_owned();
            let found = inverse_of_normal(&matrix)? * self.0.view((0, free), (first_share, 1));
            for (number, found) in step.iter_mut().zip(found.iter()) {
                *number = -found;
            }
        }
        Some(step)
    }
}

/// A table with its prediction error.
struct Tried {
    layout: Layout,
    penalty: f64,
    /// Sum of squares over the training samples, each predicted from other blocks, N².
    predicted: f64,
    rows: Rows,
}

impl Tried {
    /// Whether a table that was learned without a part of another condition holds in this part.
    fn holds_elsewhere(&self, bench: &Workbench<'_>, noise_n: f64) -> bool {
        let others = Over::ALL.into_iter().filter(|over| *over != self.layout.over);
        let mut all: Vec<Vec<f64>> = others
            .map(|over| {
                let values = condition(bench, over);
                if over == Over::Speed { values.into_iter().map(f64::abs).collect() } else { values }
            })
            .collect();
        all.push((0..bench.record.rows.len()).map(|cycle| bench.record.time_s(cycle)).collect());
        all.iter().all(|values| {
            let of_row = |row: usize| values.get(self.rows.cycles[row]).copied().unwrap_or(f64::NAN);
            thirds(&(0..self.rows.count()).map(of_row).collect::<Vec<_>>())
                .into_iter()
                .all(|range| self.holds_in(|row| range.contains(&of_row(row)), noise_n))
        })
    }

    /// Performs the same check on the rows for which `is_inside` holds.
    fn holds_in(&self, is_inside: impl Fn(usize) -> bool, noise_n: f64) -> bool {
        let rows = &self.rows;
        let outside = rows.normal(|row| !rows.held_out[row] && !is_inside(row));
        let (Some(with), Some(without)) =
            (outside.solved(rows.first_share, self.penalty, &[0.0; SHARES]), outside.without_shares(rows.first_share))
        else {
            return true;
        };
        // Only the part of the condition that the table has learned is checked.
        let mut weights = [0.0; SHARES];
        let mut greatest = [0.0_f64; SHARES];
        let of_shares = |row: usize| rows.at(row).get(rows.first_share..rows.width - 1).unwrap_or_default();
        for row in 0..rows.count() {
            for (greatest, number) in greatest.iter_mut().zip(of_shares(row)) {
                *greatest = greatest.max(number.abs());
            }
        }
        for row in (0..rows.count()).filter(|row| !rows.held_out[*row] && !is_inside(*row)) {
            for ((weight, number), greatest) in weights.iter_mut().zip(of_shares(row)).zip(greatest) {
                *weight += if greatest > 0.0 { number.abs() / greatest } else { 0.0 };
            }
        }
        let is_known = |row: usize| {
            of_shares(row).iter().zip(weights).all(|(number, weight)| *number == 0.0 || weight >= LEAST_WEIGHT)
        };
        let inside = |row: &usize| rows.held_out[*row] && is_inside(*row) && is_known(*row);
        let inside: Vec<usize> = (0..rows.count()).filter(inside).collect();
        if inside.len() < FEWEST_SAMPLES {
            return true;
        }
        let left = |row: usize, step: &DVector<f64>| {
            let (residual_n, derivatives) = rows.at(row).split_last().unwrap_or((&0.0, &[]));
            residual_n + derivatives.iter().zip(step.iter()).map(|(derivative, step)| derivative * step).sum::<f64>()
        };
        let squares = |step: &DVector<f64>| inside.iter().map(|row| left(*row, step).powi(2)).sum::<f64>();
        let (before, after) = (squares(&without), squares(&with));
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let noise = inside.len() as f64 * noise_n * noise_n;
        let excess = before - noise;
        if excess > LITTLE * noise {
            before - after >= LEAST_CLOSED_ELSEWHERE * excess
        } else {
            after - before <= LITTLE * noise
        }
    }

    /// Returns the table and the model beside it at their minimum: values, covariance, inflation, fitted parameters.
    fn finished(&self, bench: &Workbench<'_>, base: &Model) -> Option<(Values, DMatrix<f64>, f64, Vec<Parameter>)> {
        let layout = &self.layout;
        let mut model = base.clone();
        let mut changes = vec![0.0; SHARES];
        let of_shares = |rows: &Rows, changes: &[f64]| -> Option<Vec<f64>> {
            let learned = rows.normal(|row| !rows.held_out[row]);
            let step = learned.solved(rows.first_share, self.penalty, changes)?;
            let steps = step.iter().skip(rows.first_share);
            Some(changes.iter().zip(steps).map(|(change, step)| change + step).collect())
        };
        let mut rows = None;
        for _ in 0..ROUNDS {
            changes = of_shares(rows.as_ref().unwrap_or(&self.rows), &changes)?;
            model.values = layout.scaled(&model.values, &changes);
            changes = layout.changes_of(&model.values);
            let trial = bench.try_one(&model);
            model.values = trial.values;
            rows = Some(layout.rows(bench, &model, &model.values));
        }
        let rows = rows?;
        let learned = rows.normal(|row| !rows.held_out[row]);
        let inverse = inverse_of_normal(&learned.penalised(rows.first_share, self.penalty))?;
        // The covariance follows from the scatter of the blocks' scores.
        let free = learned.free();
        let mut scores = vec![DVector::<f64>::zeros(free); bench.blocks.len()];
        let mut squares = 0.0;
        for row in (0..rows.count()).filter(|row| !rows.held_out[*row]) {
            let Some((residual_n, derivatives)) = rows.at(row).split_last() else { continue };
            squares += residual_n * residual_n;
            if let Some(score) = scores.get_mut(rows.blocks[row]) {
                score.iter_mut().zip(derivatives).for_each(|(sum, derivative)| *sum += derivative * residual_n);
            }
        }
        let scatter = scores.iter().fold(DMatrix::zeros(free, free), |sum, score| sum + score * score.transpose());
        let mut covariance = &inverse * scatter * &inverse;
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let variance = squares / rows.held_out.iter().filter(|held_out| !**held_out).count().max(1) as f64;
        let inflation = (rows.first_share..free)
            .map(|place| covariance[(place, place)] / (variance * inverse[(place, place)]))
            .fold(1.0, f64::max);
        // Converts from newtons, or fractions of μ, to shares of the table.
        let size = model.values[if layout.changes == Changes::Force { SIZE } else { RATIO }];
        for place in rows.first_share..free {
            covariance.row_mut(place).unscale_mut(size);
            covariance.column_mut(place).unscale_mut(size);
        }
        let fitted = model.free.iter().copied().chain(shares()).collect();
        Some((model.values, covariance, inflation, fitted))
    }
}

/// Returns the lower, middle and upper third of some numbers, as non-empty ranges.
fn thirds(numbers: &[f64]) -> Vec<Range<f64>> {
    let mut sorted: Vec<f64> = numbers.iter().copied().filter(|number| number.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let edge = |part: usize| sorted.get(part * sorted.len() / 3).copied();
    let edges = [Some(f64::NEG_INFINITY), edge(1), edge(2), Some(f64::INFINITY)];
    let ranges = edges.windows(2).filter_map(|pair| Some(pair.first().copied()??..pair.get(1).copied()??));
    ranges.filter(|range| range.start < range.end).collect()
}
