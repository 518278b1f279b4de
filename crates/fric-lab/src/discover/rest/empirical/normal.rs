//! Normal equations of a model with a table.

use fric_core::effects::empirical::SHARES;
use nalgebra::{DMatrix, DVector};

use crate::search::gram::inverse_of_normal;

/// Penalty on the size of the table, on the same scale. It assigns to friction what both table and friction can explain.
const RIDGE: f64 = 1e-6;
/// The same on the sum of the changes. A change that is the same everywhere is one of μ, or of the zero. Without it, μ and the table grow against each other. Half and double are not tried.
const OF_SUM: f64 = 0.01;

/// Index of the last share, the distance from the first one to it.
#[expect(clippy::cast_precision_loss, reason = "a small count")]
const LAST_SHARE: f64 = (SHARES - 1) as f64;

/// Derivatives and residuals of samples, side by side.
pub struct Rows {
    pub width: usize,
    /// Column of the first share; the last column is the residual.
    pub first_share: usize,
    pub numbers: Vec<f64>,
    pub cycles: Vec<usize>,
    pub blocks: Vec<usize>,
    pub held_out: Vec<bool>,
}

impl Rows {
    pub fn count(&self) -> usize {
        self.cycles.len()
    }

    pub fn at(&self, row: usize) -> &[f64] {
        self.numbers.get(row * self.width..(row + 1) * self.width).unwrap_or_default()
    }

    /// Returns the rows of a table that reads another condition, given by cycle. `range` is that of the table.
    pub fn with_conditions(&self, [from, to]: [f64; 2], condition: &[f64]) -> Self {
        let mut numbers = self.numbers.clone();
        for (row, cycle) in numbers.chunks_exact_mut(self.width).zip(&self.cycles) {
            let Some(of_shares) = row.get_mut(self.first_share..self.width - 1) else { continue };
            // The weights of the shares sum to 1, so the sum of the derivatives is that of the whole table.
            let of_table: f64 = of_shares.iter().sum();
            let at = condition.get(*cycle).copied().unwrap_or(f64::NAN);
            let place = ((at - from) / (to - from)).clamp(0.0, 1.0) * LAST_SHARE;
            let mut of_share = 0.0;
            for derivative in of_shares {
                *derivative = of_table * (1.0 - (place - of_share).abs()).max(0.0);
                of_share += 1.0;
            }
        }
        Self {
            numbers,
            cycles: self.cycles.clone(),
            blocks: self.blocks.clone(),
            held_out: self.held_out.clone(),
            ..*self
        }
    }

    /// Returns the normal equations of the wanted rows.
    pub fn normal(&self, wanted: impl Fn(usize) -> bool) -> Normal {
        let mut normal = Normal::none(self.width);
        for row in (0..self.count()).filter(|row| wanted(*row)) {
            normal.add(self.at(row));
        }
        normal.mirrored()
    }
}

/// Inner products of the columns; the residual is the last column.
#[derive(Clone, Debug)]
pub struct Normal(DMatrix<f64>);

impl Normal {
    pub fn none(width: usize) -> Self {
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

    pub fn and(&self, other: &Self) -> Self {
        Self(&self.0 + &other.0)
    }

    pub fn less(&self, other: &Self) -> Self {
        Self(&self.0 - &other.0)
    }

    pub fn free(&self) -> usize {
        self.0.nrows() - 1
    }

    /// Returns the matrix with the penalties on the second differences of the shares, on their size and on their sum.
    pub fn penalised(&self, first_share: usize, penalty: f64) -> DMatrix<f64> {
        let free = self.free();
        let mut matrix = self.0.view((0, 0), (free, free)).into_owned();
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let information = (first_share..free).map(|place| matrix[(place, place)]).sum::<f64>() / SHARES as f64;
        for place in first_share..free {
            matrix[(place, place)] += RIDGE * information;
            for other in first_share..free {
                matrix[(place, other)] += OF_SUM * information;
            }
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
    pub fn solved(&self, first_share: usize, penalty: f64, changes: &[f64]) -> Option<DVector<f64>> {
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

    /// Returns the sum of squares without a step.
    pub fn squares(&self) -> f64 {
        self.0[(self.free(), self.free())]
    }

    /// Returns the sum of squares after a step.
    pub fn squares_after(&self, step: &DVector<f64>) -> f64 {
        let whole = step.clone().push(1.0);
        (&self.0 * &whole).dot(&whole)
    }

    /// Returns the step of the model alone, without a table.
    pub fn without_shares(&self, first_share: usize) -> Option<DVector<f64>> {
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
