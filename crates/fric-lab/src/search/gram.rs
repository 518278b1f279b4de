//! Reduces a least-squares problem to as many rows as it has parameters.
//!
//! The residuals `r` and the Jacobian `J` of any number of samples are added row by row and reduced to the upper triangle `R` and the vector `q` with
//! `RᵀR = JᵀJ`, `Rᵀq' = Jᵀr` and `‖q‖ = ‖r‖`, which is all that Levenberg–Marquardt uses. Memory does not grow with the log. The reduction uses
//! normal equations of columns scaled to unit length. This squares the condition number, which costs half the digits of a nearly undetermined
//! parameter and nothing of the others. Sums are computed in blocks, so that rounding errors do not grow with the number of samples.

use nalgebra::{DMatrix, DVector};

/// Number of rows that are summed up before they are added to the total.
const BLOCK: usize = 1024;

/// The upper triangle of `[J r]ᵀ[J r]`, stored column by column.
#[derive(Clone, Debug, PartialEq)]
pub struct Gram {
    columns: usize,
    sums: Vec<f64>,
    block: Vec<f64>,
    in_block: usize,
}

impl Gram {
    /// Of no rows yet, for `parameters` columns beside the residual.
    #[must_use]
    pub fn new(parameters: usize) -> Self {
        let columns = parameters + 1;
        let count = columns * (columns + 1) / 2;
        Self { columns, sums: vec![0.0; count], block: vec![0.0; count], in_block: 0 }
    }

    /// Adds one row: the derivatives of a residual, then the residual.
    #[inline]
    pub fn add(&mut self, row: &[f64]) {
        add_products(&mut self.block, row);
        self.in_block += 1;
        if self.in_block == BLOCK {
            self.close_block();
        }
    }

    fn close_block(&mut self) {
        for (sum, part) in self.sums.iter_mut().zip(&mut self.block) {
            *sum += std::mem::take(part);
        }
        self.in_block = 0;
    }

    /// `JᵀJ`, `Jᵀr` and `rᵀr`.
    #[must_use]
    pub fn normal_equations(&self) -> (DMatrix<f64>, DVector<f64>, f64) {
        let entry = |row: usize, column: usize| {
            let (low, high) = (row.min(column), row.max(column));
            let place = high * (high + 1) / 2 + low;
            self.sums.get(place).zip(self.block.get(place)).map_or(f64::NAN, |(sum, part)| sum + part)
        };
        let count = self.columns - 1;
        let matrix = DMatrix::from_fn(count, count, entry);
        (matrix, DVector::from_fn(count, |row, _| entry(row, count)), entry(count, count))
    }
}

/// Adds the products of all pairs of numbers to a triangle of sums, column by column.
#[inline]
pub fn add_products(sums: &mut [f64], numbers: &[f64]) {
    // Nearly every fit has four parameters, plus the residual.
    match numbers.len() {
        4 => add_products_of::<4>(sums, numbers),
        5 => add_products_of::<5>(sums, numbers),
        _ => add_products_each(sums, numbers),
    }
}

/// Adds the products of a fixed count of numbers, so that the compiler unrolls the loops.
#[inline]
fn add_products_of<const COUNT: usize>(sums: &mut [f64], numbers: &[f64]) {
    if let (Some(sums), Some(numbers)) = (sums.get_mut(..COUNT * (COUNT + 1) / 2), numbers.first_chunk::<COUNT>()) {
        add_products_each(sums, numbers);
    }
}

#[inline(always)]
#[expect(clippy::inline_always, reason = "for the number of numbers to be known")]
fn add_products_each(sums: &mut [f64], numbers: &[f64]) {
    let mut places = sums.iter_mut();
    for (column, right) in numbers.iter().enumerate() {
        for (left, place) in numbers.iter().take(column + 1).zip(&mut places) {
            *place += left * right;
        }
    }
}

/// The reduced problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangle {
    /// `R`, with an additional row of zeros.
    pub jacobian: DMatrix<f64>,
    /// `q`, with the same number of rows.
    pub residuals: DVector<f64>,
}

impl Triangle {
    /// Computes the triangle from normal equations, by Cholesky factorisation of the scaled matrix. A column that is zero, or linearly dependent on
    /// those before it to rounding, has a nearly zero diagonal in `R`.
    pub fn new(matrix: &DMatrix<f64>, gradient: &DVector<f64>, squares: f64) -> Self {
        let count = gradient.len();
        let scale: Vec<f64> = matrix.diagonal().iter().map(|square| square.sqrt()).collect();
        let unit = |place: usize| if scale[place] > 0.0 { 1.0 / scale[place] } else { 0.0 };
        let mut jacobian = DMatrix::zeros(count + 1, count);
        let mut residuals = DVector::zeros(count + 1);
        let mut left = squares;
        for row in 0..count {
            let before = |jacobian: &DMatrix<f64>, column: usize| -> f64 {
                (0..row).map(|k| jacobian[(k, row)] * jacobian[(k, column)]).sum()
            };
            let square = matrix[(row, row)] * unit(row) * unit(row) - before(&jacobian, row);
            // Each addition leaves a rounding error of about 1e-16. Below this limit the column's own direction is unknown.
            let pivot = square.max(1e-14).sqrt();
            for column in row..count {
                let product = matrix[(row, column)] * unit(row) * unit(column) - before(&jacobian, column);
                jacobian[(row, column)] = if column == row { pivot } else { product / pivot };
            }
            let projected: f64 = (0..row).map(|k| jacobian[(k, row)] * residuals[k]).sum();
            residuals[row] = (gradient[row] * unit(row) - projected) / pivot;
            left -= residuals[row] * residuals[row];
        }
        residuals[count] = left.max(0.0).sqrt();
        for (mut column, scale) in jacobian.column_iter_mut().zip(&scale) {
            column *= *scale;
        }
        Self { jacobian, residuals }
    }

    /// Returns the vector to subtract from the parameters to reach the minimum of the linearised problem; `None` if some parameters have no effect.
    pub fn step(&self) -> Option<Vec<f64>> {
        let count = self.jacobian.ncols();
        let step = self.jacobian.rows(0, count).solve_upper_triangular(&self.residuals.rows(0, count))?;
        Some(step.iter().copied().collect())
    }

    /// Returns the greatest relative decrease of the sum of squares that the linearised problem allows.
    pub fn reducible_ratio(&self) -> f64 {
        let left = self.residuals.iter().next_back().map_or(f64::NAN, |left| left * left);
        let squares = self.residuals.norm_squared();
        (squares - left) / squares
    }
}

/// Inverse of a matrix `JᵀJ`, scaled meanwhile; what has no effect at all gets an all but infinite variance of its own. `None` where
/// the matrix is not of numbers.
#[must_use]
pub fn inverse_of_normal(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let count = matrix.nrows();
    let scale: Vec<f64> =
        matrix.diagonal().iter().map(|square| if *square > 0.0 { square.sqrt().recip() } else { 1.0 }).collect();
    let scaled = DMatrix::from_fn(count, count, |row, column| {
        let vanishing = if row == column { 1e-12 } else { 0.0 };
        matrix[(row, column)] * scale[row] * scale[column] + vanishing
    });
    let inverse = scaled.cholesky()?.inverse();
    Some(DMatrix::from_fn(count, count, |row, column| inverse[(row, column)] * scale[row] * scale[column]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<[f64; 4]> {
        (0..5000)
            .map(|k| f64::from(k) * 0.01)
            .map(|t| [t.sin(), 30.0 * (0.3 * t).cos(), 1e-3 * t, t.cos() + 0.1])
            .collect()
    }

    #[test]
    fn has_the_normal_equations_and_the_norm_of_the_long_problem() {
        let mut gram = Gram::new(3);
        for row in rows() {
            gram.add(&row);
        }
        let jacobian = DMatrix::from_fn(5000, 3, |row, column| rows()[row][column]);
        let residuals = DVector::from_fn(5000, |row, _| rows()[row][3]);
        let (matrix, gradient, squares) = gram.normal_equations();
        assert!((jacobian.transpose() * &jacobian - &matrix).amax() < 1e-9 * matrix.amax());
        let Triangle { jacobian: reduced, residuals: q } = Triangle::new(&matrix, &gradient, squares);
        assert!((reduced.transpose() * &reduced - &matrix).amax() < 1e-12 * matrix.amax());
        assert!((reduced.transpose() * &q - jacobian.transpose() * &residuals).amax() < 1e-9 * gradient.amax());
        assert!((q.norm() - residuals.norm()).abs() < 1e-9 * residuals.norm());
        // The least-squares solution equals that of the full problem by QR factorisation.
        let solve = |jacobian: DMatrix<f64>, residuals: &DVector<f64>| {
            let qr = jacobian.qr();
            qr.r().solve_upper_triangular(&(qr.q().transpose() * residuals)).unwrap()
        };
        let (long, short) = (solve(jacobian, &residuals), solve(reduced, &q));
        assert!((&long - &short).amax() < 1e-9 * long.amax(), "{long} {short}");
    }

    #[test]
    fn a_column_without_effect_does_no_harm() {
        let mut gram = Gram::new(2);
        for [a, _, _, r] in rows() {
            gram.add(&[a, 0.0, r]);
        }
        let (matrix, gradient, squares) = gram.normal_equations();
        let Triangle { jacobian, residuals } = Triangle::new(&matrix, &gradient, squares);
        assert!(jacobian.iter().chain(residuals.iter()).all(|number| number.is_finite()));
        assert_eq!(jacobian.column(1).amax().to_bits(), 0.0_f64.to_bits());
        assert!((residuals.norm_squared() - squares).abs() < 1e-9 * squares);
    }
}
