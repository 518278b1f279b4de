//! A drift as a Gauss–Markov process beside white noise (A. Gelb, editor, *Applied Optimal Estimation*, MIT Press 1974, ch. 3.8 and 4.2), and what of a
//! rest is none.
//!
//! A drift goes on slowly, is as large at any time, and does not know the cable. Friction that the model gets wrong jumps where the cable turns, and a gain
//! that changes at a place jumps where the cable passes it. A Kalman filter predicts the drift from what it was, so that mostly the jumps are left.

use std::ops::Range;

use fric_core::parameters::{MU, SIGMA, VISCOUS, Values};
use nalgebra::DMatrix;
use realfft::RealFftPlanner;

use super::contacts::Contacts;
use super::mean;
use super::places::{Excess, LEAST_SIGNIFICANCE, random_sign, significance};
use crate::discover::workbench::{Model, Workbench};
use crate::fit::CableRecord;
use crate::samples::bins::Bins;
use crate::samples::conditions::{Condition, Spacing};
use crate::search::gram::inverse_of_normal;
use crate::search::problem::Problem;

/// Windows that a record is divided into at most: of 2 ms in a minute, of 0.1 s in an hour.
const MOST_WINDOWS: usize = 1 << 15;
/// Least and greatest variance of a drift that is tried, relative to that of the white noise of a window, and the ratio of one correlation time or variance
/// to the one tried before. A coarse process whitens enough, because chance is measured.
const POWERS: [f64; 2] = [1.0 / 1024.0, 1024.0];
const STEP: f64 = 2.0;
/// Number of cells of a condition.
const CELLS: usize = 64;
/// Number of residuals of the same spectrum that give the chance level, and number of those each of which hits must exceed.
const SURROGATES: usize = 40;
const DRAWS: usize = 200;
/// Ratio of a Gaussian's standard deviation to the median of its magnitude.
const DEVIATION_PER_MEDIAN: f64 = 1.4826;

/// A drift of a residual.
pub struct Drift<'e, 'a> {
    excess: &'e Excess<'a>,
    windows: Vec<Window>,
    process: Process,
}

/// Some cycles one after the other of which at least one counts.
struct Window {
    cycles: Range<usize>,
    /// Windows since the last one of its log; `None` for the first.
    steps: Option<i32>,
    /// Number of samples that count.
    count: f64,
    /// Their mean residual, N.
    residual_n: f64,
}

/// A Gauss–Markov process in windows.
#[derive(Clone, Copy)]
struct Process {
    /// Correlation of one window with the next.
    correlation: f64,
    /// Variance relative to that of the white noise of a sample.
    power: f64,
}

/// A Kalman filter of a process, of several signals at once.
struct Filter {
    process: Process,
    /// Variance of the estimates.
    variance: f64,
    estimates: Vec<f64>,
}

impl Filter {
    fn new(process: Process, signal_count: usize) -> Self {
        Self { process, variance: process.power, estimates: vec![0.0; signal_count] }
    }

    /// Replaces the number of each signal in a window by what was not predicted, in standard deviations, and returns the variance of that.
    fn whiten(&mut self, window: &Window, numbers: &mut [f64]) -> f64 {
        let Process { correlation, power } = self.process;
        // A new log begins with an unknown drift.
        let keeps = window.steps.map_or(0.0, |steps| correlation.powi(steps));
        let predicted_variance = keeps * keeps * self.variance + (1.0 - keeps * keeps) * power;
        let total = predicted_variance + 1.0 / window.count;
        let gain = predicted_variance / total;
        for (estimate, number) in self.estimates.iter_mut().zip(numbers) {
            let prediction = keeps * *estimate;
            let surprise = *number - prediction;
            *estimate = prediction + gain * surprise;
            *number = surprise / total.sqrt();
        }
        self.variance = (1.0 - gain) * predicted_variance;
        total
    }
}

impl<'e, 'a> Drift<'e, 'a> {
    /// Returns the most likely drift of an excess.
    pub fn of(excess: &'e Excess<'a>) -> Option<Self> {
        let length = excess.residual_n.len().div_ceil(MOST_WINDOWS);
        let mut windows: Vec<Window> = Vec::new();
        for (start, rows) in excess.record.logs() {
            let (end, mut steps) = (start + rows.len(), None);
            for from in (start..end).step_by(length) {
                let cycles = from..(from + length).min(end);
                let [mut sum_n, mut count] = [0.0, 0.0];
                for residual_n in excess.of_cycles(cycles.clone()) {
                    (sum_n, count) = (sum_n + residual_n, count + 1.0);
                }
                steps = steps.map(|steps| steps + 1);
                if count > 0.0 {
                    windows.push(Window { cycles, steps, count, residual_n: sum_n / count });
                    steps = Some(0);
                }
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "a count of windows")]
        let count = windows.len() as f64;
        let mean_count = windows.iter().map(|window| window.count).sum::<f64>() / count;
        // Of the white noise too, the most likely variance is taken.
        let likelihood = |process: &Process| {
            let (mut filter, mut logarithms, mut squares) = (Filter::new(*process, 1), 0.0, 0.0);
            for window in &windows {
                let mut number = [window.residual_n];
                logarithms += filter.whiten(window, &mut number).ln();
                squares += number[0] * number[0];
            }
            -logarithms - count * squares.ln()
        };
        let tried = |[from, to]: [f64; 2]| {
            std::iter::successors(Some(from), |last| Some(last * STEP)).take_while(move |next| *next <= to)
        };
        let correlations = tried([1.0, count]).map(|windows| (-1.0 / windows).exp());
        let processes = correlations
            .flat_map(|correlation| tried(POWERS).map(move |power| Process { correlation, power: power / mean_count }));
        let likely =
            processes.map(|process| (likelihood(&process), process)).filter(|(likelihood, _)| likelihood.is_finite());
        let (_, process) = likely.max_by(|(one, _), (other, _)| one.total_cmp(other))?;
        Some(Self { excess, windows, process })
    }

    /// Returns the fraction of the drift that is as large at any time of a log. A drift is Gaussian; a few hits of the platform are not, nor is what happens
    /// in a short part of the log.
    pub fn steady_share(&self) -> f64 {
        let (_, mut estimates) = self.filtered();
        let root_mean_square =
            |numbers: &[f64]| mean(&numbers.iter().map(|number| number * number).collect::<Vec<_>>()).sqrt();
        let mut rest = estimates.as_mut_slice();
        for of_log in self.windows.chunk_by(|_, next| next.steps.is_some()) {
            let Some((log, others)) = rest.split_at_mut_checked(of_log.len()) else { break };
            // One day a sensor drifts more than on another.
            let scale_n = root_mean_square(log);
            for estimate in log.iter_mut() {
                *estimate /= scale_n;
            }
            rest = others;
        }
        let fourth_moment = |numbers: &[f64]| numbers.iter().map(|number| number.powi(4)).sum::<f64>();
        let found = fourth_moment(&estimates);
        // Surrogates have the same sum of squares, so that this compares the kurtosis.
        let Some(surrogates) = with_surrogates(&estimates, DRAWS) else { return 1.0 };
        let by_chance = surrogates.as_slice().chunks(estimates.len()).skip(1).map(fourth_moment);
        if by_chance.fold(0.0, f64::max) >= found {
            return 1.0;
        }
        let mut sizes: Vec<f64> = estimates.iter().map(|number| number.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
        (DEVIATION_PER_MEDIAN * median / root_mean_square(&estimates)).powi(2).min(1.0)
    }

    /// Returns, for each window, what the process does not predict of the residual, in standard deviations, and the drift, N.
    fn filtered(&self) -> (Vec<f64>, Vec<f64>) {
        let mut filter = Filter::new(self.process, 1);
        let filtered = self.windows.iter().map(|window| {
            let mut number = [window.residual_n];
            filter.whiten(window, &mut number);
            (number[0], filter.estimates[0])
        });
        filtered.unzip()
    }

    /// Returns the fraction of the excess that is no drift: friction that depends on the place, the speed or the time in a way that the model has not, contacts
    /// of another law, or a sensor whose zero depends on the place. It is the greatest fraction that one of these accounts for and the model's parameters
    /// cannot; zero where this may be chance.
    pub fn share_of_cable(&self, bench: &Workbench<'_>, model: &Model) -> f64 {
        self.share_if_any(bench, model).unwrap_or(0.0)
    }

    fn share_if_any(&self, bench: &Workbench<'_>, model: &Model) -> Option<f64> {
        let record = *self.excess.record;
        let row_of = move |cycle: usize| record.rows.get(cycle);
        let length = Condition::new(&record, ("", "", Spacing::Widths(CELLS)), move |cycle| {
            row_of(cycle).map_or(f64::NAN, |row| row.signals.length_m)
        });
        let time = Condition::new(&record, ("", "", Spacing::Widths(CELLS)), move |cycle| record.time_s(cycle));
        let speeds_m_per_s = remembered_speeds_m_per_s(&record, &model.values);
        let speed = Condition::new(&record, ("", "", Spacing::Crowds(CELLS)), move |cycle| {
            speeds_m_per_s.get(cycle).copied().unwrap_or(f64::NAN)
        });
        // What effects of the sensor add is no friction.
        let mut frictionless = model.values;
        (frictionless[MU], frictionless[VISCOUS]) = (0.0, 0.0);
        let [with, without] = [model.values, frictionless].map(|values| bench.evaluated(&values));
        let friction_n = |cycle: usize| with.added_n(cycle) - without.added_n(cycle);
        let (apart, innovations) = (self.of_parameters(bench, model), with_surrogates(&self.filtered().0, SURROGATES)?);
        let over = |condition: &Condition<'_>, signal_n: &dyn Fn(usize) -> f64| {
            let bins = Bins::new(condition, self.excess.residual_n)?;
            self.share_of(&apart, &innovations, bins.count(), |cycle, numbers| {
                if let Some(number) = bins.of(condition.at(cycle)).and_then(|cell| numbers.get_mut(cell)) {
                    *number = signal_n(cycle);
                }
            })
        };
        let mut contacts = Contacts::of(bench, model);
        let of_contacts =
            self.share_of(&apart, &innovations, Contacts::COUNT, |cycle, numbers| contacts.write(cycle, numbers));
        let of_friction = [&length, &speed, &time].map(|condition| over(condition, &friction_n));
        of_friction.into_iter().chain([over(&length, &|_| 1.0), of_contacts]).flatten().max_by(f64::total_cmp)
    }

    /// Returns a constant and the derivatives of a model by its free parameters: a row for each, a column for each window.
    fn of_parameters(&self, bench: &Workbench<'_>, model: &Model) -> DMatrix<f64> {
        let problem = Problem { used: bench.counts.to_vec(), ..bench.problem(&model.free, None) };
        let count = problem.parameter_count();
        let mut rows = DMatrix::<f64>::zeros(1 + count, self.windows.len());
        rows.row_mut(0).fill(1.0);
        problem.visit(&[model.values], true, |cycle, mut of_cycle| {
            let place = self.windows.partition_point(|window| window.cycles.end <= cycle);
            let (Some(derivatives), Some(window)) = (of_cycle.next(), self.windows.get(place)) else { return };
            for (number, derivative) in rows.column_mut(place).iter_mut().skip(1).zip(derivatives.iter().take(count)) {
                *number += derivative / window.count;
            }
        });
        rows
    }

    /// Returns the fraction of the excess that several signals account for together, apart from what the rows `apart` account for; `None` where this may be
    /// chance. `write` writes the signals of a cycle over zeros.
    fn share_of(
        &self,
        apart: &DMatrix<f64>,
        innovations: &DMatrix<f64>,
        count: usize,
        mut write: impl FnMut(usize, &mut [f64]),
    ) -> Option<f64> {
        let (apart_count, mut numbers) = (apart.nrows(), vec![0.0; count]);
        let mut signals = apart.clone().resize_vertically(apart_count + count, 0.0);
        for (window, mut signals) in self.windows.iter().zip(signals.column_iter_mut()) {
            for cycle in window.cycles.clone().filter(|cycle| self.excess.residual_n[*cycle].is_finite()) {
                numbers.fill(0.0);
                write(cycle, &mut numbers);
                for (mean, number) in signals.iter_mut().skip(apart_count).zip(&numbers) {
                    *mean += number / window.count;
                }
            }
        }
        if signals.iter().any(|number| !number.is_finite()) {
            return None;
        }
        let (mut whitened, mut filter) = (signals.clone(), Filter::new(self.process, signals.nrows()));
        for (window, mut numbers) in self.windows.iter().zip(whitened.column_iter_mut()) {
            filter.whiten(window, numbers.as_mut_slice());
        }
        let (matrix, right) = (&whitened * whitened.transpose(), &whitened * innovations);
        let factors = inverse_of_normal(&matrix)? * &right;
        let of_apart = right.rows(0, apart_count);
        let factors_apart =
            inverse_of_normal(&matrix.view((0, 0), (apart_count, apart_count)).into_owned())? * of_apart;
        let gain = |place: usize| {
            factors.column(place).dot(&right.column(place)) - factors_apart.column(place).dot(&of_apart.column(place))
        };
        let (found, chances) = (gain(0), (1..=SURROGATES).map(gain).collect::<Vec<_>>());
        if significance(found, &chances) < LEAST_SIGNIFICANCE {
            return None;
        }
        let mut added = factors.column(0).into_owned();
        added.rows_mut(0, apart_count).zip_apply(&factors_apart.column(0), |factor, of_apart| *factor -= of_apart);
        let by_chance = mean(&chances) / found;
        let [mut sum, mut squares, mut samples] = [0.0; 3];
        for (window, signals) in self.windows.iter().zip(signals.column_iter()) {
            let added_n = signals.dot(&added);
            sum += window.count * added_n;
            squares += window.count * added_n * added_n;
            samples += window.count;
        }
        Some(((squares - sum * sum / samples) * (1.0 - by_chance) / self.excess.sum()).clamp(0.0, 1.0))
    }
}

/// Returns a series and others of the same spectrum that are otherwise chance, in columns: in these each frequency has a random sign.
fn with_surrogates(series: &[f64], surrogate_count: usize) -> Option<DMatrix<f64>> {
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, backward) = (planner.plan_fft_forward(series.len()), planner.plan_fft_inverse(series.len()));
    let mut spectrum = forward.make_output_vec();
    forward.process(&mut series.to_vec(), &mut spectrum).ok()?;
    #[expect(clippy::cast_precision_loss, reason = "a count of windows")]
    let scale = 1.0 / series.len() as f64;
    let mut all = DMatrix::zeros(series.len(), 1 + surrogate_count);
    all.column_mut(0).copy_from_slice(series);
    for (draw, mut surrogate) in (0..).zip(all.column_iter_mut().skip(1)) {
        let signed = spectrum.iter().enumerate().map(|(place, number)| number * (scale * random_sign(draw, place)));
        backward.process(&mut signed.collect::<Vec<_>>(), surrogate.as_mut_slice()).ok()?;
    }
    Some(all)
}

/// Returns the speed in each cycle as the contacts remember it, m/s: its mean over the way, with a memory of the presliding distance. A cable at rest keeps
/// the friction of the speed that it came with.
fn remembered_speeds_m_per_s(record: &CableRecord<'_>, values: &Values) -> Vec<f64> {
    let presliding_m_per_n = record.params.memory_m_per_n(values[MU], values[SIGMA]);
    let mut all = Vec::with_capacity(record.rows.len());
    for (_, rows) in record.logs() {
        let mut speed_m_per_s = 0.0_f64;
        for row in rows {
            let signals = &row.signals;
            let presliding_m = presliding_m_per_n * signals.sensor_force_n;
            let kept = (-signals.displacement_m.abs() / presliding_m.max(f64::MIN_POSITIVE)).exp();
            if kept.is_finite() && signals.speed_m_per_s.is_finite() {
                speed_m_per_s = kept * speed_m_per_s + (1.0 - kept) * signals.speed_m_per_s.abs();
            }
            all.push(speed_m_per_s);
        }
    }
    all
}
