//! The part of signals that the parameters of a model cannot compensate.

use std::ops::Range;

use fric_core::parameters::Values;
use nalgebra::{DMatrix, DVector};

use super::evidence::Memory;
use crate::search::gram::inverse_of_normal;
use crate::search::problem::{Problem, ZeroLevers};

/// Several signals, in one cycle after the other: appends the number of each in a cycle, NaN where there is none.
pub type Signals<'a> = Box<dyn FnMut(usize, &mut Vec<f64>) + 'a>;

/// Visits the samples that count with the number of each signal there, minus its projection on small changes of a problem's parameters; NaN where the
/// signal has none. `signals` gives the signals from their first cycle on. They come along with the log again and again, because series of
/// many signals would take up more memory than the log. Returns `None` if the projection is not finite.
pub fn visit_less_projection<'a>(
    problem: &Problem<'_>,
    values: &Values,
    signals: &dyn Fn() -> Signals<'a>,
    mut visit: impl FnMut(usize, &[f64]),
) -> Option<()> {
    let count = problem.parameter_count();
    let mut matrix = DMatrix::<f64>::zeros(count, count);
    let mut right = DMatrix::<f64>::zeros(count, 0);
    let (mut of_cycle, mut numbers) = (signals(), Vec::new());
    problem.visit(&[*values], true, |place, mut rows| {
        let Some(row) = rows.next() else { return };
        numbers.clear();
        of_cycle(place, &mut numbers);
        if right.ncols() != numbers.len() {
            right = DMatrix::zeros(count, numbers.len());
        }
        for (one, derivative) in row.iter().take(count).enumerate() {
            for (other, factor) in row.iter().take(count).enumerate() {
                matrix[(one, other)] += derivative * factor;
            }
            for (column, number) in numbers.iter().enumerate() {
                right[(one, column)] += derivative * if number.is_finite() { *number } else { 0.0 };
            }
        }
    });
    let factors = inverse_of_normal(&matrix)? * right;
    let mut zeros = problem.zero_levers(values).map(|levers| ZeroShares::of(problem, levers, signals));
    of_cycle = signals();
    problem.visit(&[*values], true, |place, mut rows| {
        let Some(row) = rows.next() else { return };
        numbers.clear();
        of_cycle(place, &mut numbers);
        if let Some(zeros) = &mut zeros {
            zeros.take_off(place, &mut numbers);
        }
        for (column, number) in numbers.iter_mut().enumerate() {
            let of_signal = factors.column(column);
            let projected: f64 = row.iter().zip(of_signal.iter()).map(|(derivative, factor)| derivative * factor).sum();
            *number = if number.is_finite() { *number - projected } else { f64::NAN };
        }
        visit(place, &numbers);
    });
    Some(())
}

/// What zeros of the logs could make up for of several signals, over the samples that count.
struct ZeroShares {
    levers: ZeroLevers,
    /// For each log and signal, the sums of the products of lever and number, and of the squares of the lever.
    sums: Vec<Vec<(f64, f64)>>,
    /// The log that was reached.
    log: usize,
}

impl ZeroShares {
    fn of<'a>(problem: &Problem<'_>, levers: ZeroLevers, signals: &dyn Fn() -> Signals<'a>) -> Self {
        let (mut of_cycle, mut numbers) = (signals(), Vec::new());
        let counts = |cycle: &usize| problem.used.get(*cycle).copied().unwrap_or(false);
        let mut of_log = |cycles: Range<usize>| {
            let mut sums: Vec<(f64, f64)> = Vec::new();
            for cycle in cycles.filter(counts) {
                let lever = levers.at(cycle);
                numbers.clear();
                of_cycle(cycle, &mut numbers);
                sums.resize(numbers.len(), (0.0, 0.0));
                for ((products, squares), number) in sums.iter_mut().zip(&numbers) {
                    if number.is_finite() {
                        *products += lever * number;
                        *squares += lever * lever;
                    }
                }
            }
            sums
        };
        let sums = levers.logs().map(&mut of_log).collect();
        Self { levers, sums, log: 0 }
    }

    /// Takes them off the numbers of a cycle.
    fn take_off(&mut self, cycle: usize, numbers: &mut [f64]) {
        while self.levers.logs().nth(self.log).is_some_and(|cycles| cycle >= cycles.end) {
            self.log += 1;
        }
        let lever = self.levers.at(cycle);
        let sums = self.sums.get(self.log).into_iter().flatten();
        for (number, (products, squares)) in numbers.iter_mut().zip(sums).filter(|(_, (_, squares))| *squares > 0.0) {
            *number -= lever * products / squares;
        }
    }
}

/// A linear least-squares problem of a few columns, stored as the inner products of the columns with each other and with the residual.
#[derive(Clone, Debug)]
pub struct Columns {
    /// Below the diagonal and on it.
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    included: usize,
    alone_from: usize,
}

impl Columns {
    /// Creates the problem of `count` columns without samples. The first `included` columns are already part of the residual. Of the columns from
    /// `alone_from` on, no two are ever asked for together.
    pub fn new(count: usize, included: usize, alone_from: usize) -> Self {
        Self { matrix: DMatrix::zeros(count, count), right: DVector::zeros(count), included, alone_from }
    }

    /// Adds a sample: the numbers of the columns, 0 where one is not finite, and the residual. It does not count if its residual is not finite.
    pub fn add(&mut self, numbers: &[f64], residual_n: f64) {
        if !residual_n.is_finite() {
            return;
        }
        let known = |number: f64| if number.is_finite() { number } else { 0.0 };
        let included_n: f64 = numbers.iter().take(self.included).copied().map(known).sum();
        let without_n = residual_n - included_n;
        for (one, number) in numbers.iter().copied().map(known).enumerate() {
            self.right[one] -= number * without_n;
            for (other, factor) in numbers.iter().copied().map(known).enumerate().take(one.min(self.alone_from)) {
                self.matrix[(one, other)] += number * factor;
            }
            self.matrix[(one, one)] += number * number;
        }
    }

    /// Returns the decrease of the sum of squares due to some of the columns.
    pub fn gain(&self, places: &[usize]) -> f64 {
        self.fit(places).map_or(0.0, |(_, gain)| gain)
    }

    /// Returns the factors of some of the columns, as added to the residual, and the decrease of the sum of squares.
    pub fn fit(&self, places: &[usize]) -> Option<(DVector<f64>, f64)> {
        let (part, of) = self.part(places);
        let factors = part.cholesky()?.solve(&of);
        let gain = factors.dot(&of);
        Some((factors, gain))
    }

    /// Returns the empty memory of what some of the columns leave, none of them being part of the residual.
    pub fn memory(&self, places: &[usize]) -> Option<Memory> {
        let (factors, _) = self.fit(places)?;
        Some(Memory::new(places.to_vec(), factors, inverse_of_normal(&self.part(places).0)?))
    }

    /// Returns the normal equations of some of the columns.
    fn part(&self, places: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let matrix = DMatrix::from_fn(places.len(), places.len(), |row, column| {
            let (low, high) = (places[row].min(places[column]), places[row].max(places[column]));
            // The ridge makes nearly identical columns act as one.
            let ridge = if row == column { 1.0 + 1e-9 } else { 1.0 };
            self.matrix[(high, low)] * ridge
        });
        (matrix, DVector::from_fn(places.len(), |row, _| self.right[places[row]]))
    }
}
