//! A reference that comes late, or whose clock runs otherwise than the winch's.
//!
//! What is wrong with its time shows in the residual as the rate of the reference: with a reference that is late by ε it is `ε·dF/dt`. Delay and skew are improved by that,
//! what the parameters of the model make up for taken off, until they stand still, and kept where the model then agrees better on samples held out. A
//! reference that comes early is none: that is a sensor that follows late, and a matter of the machine.

use std::sync::atomic::AtomicBool;

use nalgebra::{DMatrix, DVector};

use super::{Fault, RecordingFault};
use crate::discover::cable::given_to;
use crate::discover::naming::projection::less_projection;
use crate::discover::workbench::{Model, Trial, Workbench};
use crate::fit::{CableRecord, Row};
use crate::samples::interpolated::measured;
use crate::samples::split::{Block, split};

/// The squares held out have to fall by this share: the rms by a quarter of a per cent, as an effect has to.
const LEAST_GAIN: f64 = 0.005;
/// Improvements at most, and the part of an interval between samples below which one is none. Noise of the reference makes its rate larger and each improvement smaller, so that it takes more of
/// them: with 8, 6 ms of a bench whose forces change slowly come out 5 % short.
const ROUNDS: usize = 24;
const SMALL: f64 = 1e-2;
/// Rates are taken over so many samples on either side.
const RATE_SAMPLES: usize = 5;

/// What a fit leaves goes with the rate of the reference by more than this share of its squares before its time is looked at: a twentieth of what it has to gain, for parameters that make
/// up for some of it. At half, more logs are looked at in vain; at double, a delay whose rate the parameters make up for to 90 % is missed.
const SUSPICIOUS_SHARE: f64 = 0.05 * LEAST_GAIN;

/// How the time of a reference is wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Shift {
    /// How late it is at the first sample, s.
    delay_s: f64,
    /// By how much later with each second, 1.
    skew: f64,
}

/// What was made of one kind of shift.
struct Corrected {
    shift: Shift,
    rows: Vec<Row>,
    trial: Trial,
}

/// A cable's cycles with the reference where it belongs, and what to tell; `None` where its time is right, or nothing tells, as with a model without friction.
pub fn retimed(record: &CableRecord<'_>, stop: &AtomicBool) -> Option<(Vec<Row>, RecordingFault)> {
    // A model without friction leaves all of it, which has rates of its own.
    if record.reference_is_known || record.params.friction().mu <= 0.0 {
        return None;
    }
    let (counts, start) = given_to(record, stop)?;
    let (blocks, measured) = (split(record), measured(record));
    let case = Case { record: *record, counts: &counts, blocks: &blocks, measured: &measured, stop };
    let as_it_is = case.bench(record.rows).try_one(&start);
    let (_, gain) = case.improvement(record.rows, &as_it_is, true)?;
    if gain < LEAST_GAIN * as_it_is.training {
        return None;
    }
    let late = case.corrected(&as_it_is, false)?;
    // A line between two samples has less noise than either: held out, a shift by parts of an interval looks better than one by whole ones, and a skew better than none. What is left
    // after the delay has to go with the rate.
    let (_, more) = case.improvement(&late.rows, &late.trial, true)?;
    let may_be_skewed = more >= LEAST_GAIN * late.trial.training;
    let skewed = if may_be_skewed { Some(case.corrected(&as_it_is, true)?) } else { None };
    let gains = |from: &Trial, to: &Trial| to.held_out < (1.0 - LEAST_GAIN) * from.held_out;
    let fault = |fault, parameters| RecordingFault { fault, parameters, intervals_s: Vec::new() };
    let skewed = skewed.filter(|skewed| gains(&late.trial, &skewed.trial) && gains(&as_it_is, &skewed.trial));
    if let Some(skewed) = skewed {
        let Shift { delay_s, skew } = skewed.shift;
        return Some((skewed.rows, fault(Fault::ClockSkew, vec![("skew_ratio", -skew), ("delay_s", delay_s)])));
    }
    let delay_s = late.shift.delay_s;
    let is_late = delay_s > 0.0 && gains(&as_it_is, &late.trial);
    is_late.then(|| (late.rows, fault(Fault::ReferenceDelay, vec![("delay_s", delay_s)])))
}

/// Whether what a fit leaves, N, goes with the rate of the reference at all, at once or by and by; far less work than [`retimed`].
pub fn may_be_off(record: &CableRecord<'_>, left_n: &[f64]) -> bool {
    let rates = rates(record, record.rows);
    let (mut left, mut products, mut squares) = (0.0, [0.0; 2], [0.0; 2]);
    for (place, (left_n, rate)) in left_n.iter().zip(&rates).enumerate() {
        if !(left_n * rate).is_finite() {
            continue;
        }
        left += left_n * left_n;
        for (part, column) in [*rate, rate * seconds(record, place)].into_iter().enumerate() {
            products[part] += column * left_n;
            squares[part] += column * column;
        }
    }
    let explains = |part: usize| products[part] * products[part] > SUSPICIOUS_SHARE * left * squares[part];
    left > 0.0 && (explains(0) || explains(1))
}

/// When a sample was, s since the first of its log.
#[expect(clippy::cast_precision_loss, reason = "a count of samples")]
fn seconds(record: &CableRecord<'_>, place: usize) -> f64 {
    place as f64 * record.interval_s
}

/// How fast the reference changes, N/s; NaN where that is not known.
fn rates(record: &CableRecord<'_>, rows: &[Row]) -> Vec<f64> {
    let mut rates = vec![f64::NAN; rows.len()];
    for (start, log) in record.logs() {
        let of_log = rows.get(start..start + log.len()).unwrap_or_default();
        let middles = rates.iter_mut().skip(start + RATE_SAMPLES);
        for (rate, around) in middles.zip(of_log.windows(2 * RATE_SAMPLES + 1)) {
            let change_n = around[2 * RATE_SAMPLES].reference_n - around[0].reference_n;
            *rate = change_n / seconds(record, 2 * RATE_SAMPLES);
        }
    }
    rates
}

/// A cable with its log.
#[derive(Clone, Copy)]
struct Case<'a> {
    record: CableRecord<'a>,
    counts: &'a [bool],
    blocks: &'a [Block],
    measured: &'a [bool],
    stop: &'a AtomicBool,
}

impl<'a> Case<'a> {
    fn bench<'b>(&self, rows: &'b [Row]) -> Workbench<'b>
    where
        'a: 'b,
    {
        let Self { record, counts, blocks, measured, stop } = *self;
        Workbench { record: record.with_signals(rows), blocks, counts, measured, stop }
    }

    /// The delay, with a skew or without, that leaves least.
    fn corrected(&self, as_it_is: &Trial, with_skew: bool) -> Option<Corrected> {
        let (mut shift, mut rows, mut trial) = (Shift::default(), self.record.rows.to_vec(), as_it_is.clone());
        for _ in 0..ROUNDS {
            let (step, _) = self.improvement(&rows, &trial, with_skew)?;
            shift = Shift { delay_s: shift.delay_s + step.delay_s, skew: shift.skew + step.skew };
            rows = self.shifted(shift);
            let model: Model = trial.model();
            trial = self.bench(&rows).try_one(&model);
            let end_s = seconds(&self.record, self.record.rows.len());
            if step.delay_s.abs() + step.skew.abs() * end_s < SMALL * self.record.interval_s {
                break;
            }
        }
        Some(Corrected { shift, rows, trial })
    }

    /// What shift would leave less, and how much less, N².
    fn improvement(&self, rows: &[Row], trial: &Trial, with_skew: bool) -> Option<(Shift, f64)> {
        let bench = self.bench(rows);
        let rate_n_per_s = rates(&self.record, rows);
        let by_time = |(place, rate)| rate * seconds(&self.record, place);
        let mut signals = vec![bench.residuals_n(&trial.values), rate_n_per_s.clone()];
        signals.extend(with_skew.then(|| rate_n_per_s.iter().copied().enumerate().map(by_time).collect()));
        let problem = bench.problem(&trial.free, None);
        let left = less_projection(&problem, &trial.values, &signals)?;
        let (residual_n, columns) = left.split_first()?;
        let product = |one: &[f64], other: &[f64]| -> f64 {
            let products = one.iter().zip(other).map(|(one, other)| one * other);
            products.filter(|product| product.is_finite()).sum()
        };
        let matrix = DMatrix::from_fn(columns.len(), columns.len(), |row, column| {
            product(&columns[row], &columns[column]) * if row == column { 1.0 + 1e-9 } else { 1.0 }
        });
        let right = DVector::from_fn(columns.len(), |row, _| product(&columns[row], residual_n));
        let found = matrix.cholesky()?.solve(&right);
        let shift = Shift { delay_s: found[0], skew: found.get(1).copied().unwrap_or(0.0) };
        Some((shift, found.dot(&right)))
    }

    /// The cycles with the reference of later samples, on the line between two; NaN past the ends of each log.
    fn shifted(&self, shift: Shift) -> Vec<Row> {
        let mut rows = self.record.rows.to_vec();
        for (start, log) in self.record.logs() {
            for (place, row) in rows.iter_mut().skip(start).take(log.len()).enumerate() {
                let later_s = shift.delay_s + shift.skew * seconds(&self.record, place);
                #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
                let at = place as f64 + later_s / self.record.interval_s;
                let whole = at.floor();
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "not below 0, a place in the log"
                )]
                let reference_n = |place: f64| {
                    let row = if place < 0.0 { None } else { log.get(place as usize) };
                    row.map_or(f64::NAN, |row| row.reference_n)
                };
                let share = at - whole;
                let [before, after] = [whole, whole + 1.0].map(reference_n);
                row.reference_n = if share > 0.0 { before + share * (after - before) } else { before };
            }
        }
        rows
    }
}
