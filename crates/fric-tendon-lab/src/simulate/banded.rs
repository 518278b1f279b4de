//! A symmetric banded matrix and its Cholesky factor.

/// A symmetric banded matrix. The lower half is stored row by row: entry (i, i − d) is at `i·(width + 1) + width − d`.
#[derive(Clone, Debug)]
pub struct Banded {
    width: usize,
    entries: Vec<f64>,
}

impl Banded {
    pub fn new(size: usize, width: usize) -> Self {
        Self { width, entries: vec![0.0; size * (width + 1)] }
    }

    pub fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    /// Adds to the entry (row, column) of the lower half; entries above the diagonal are ignored.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        if column <= row {
            let place = self.place(row, column);
            self.entries[place] += value;
        }
    }

    fn place(&self, row: usize, column: usize) -> usize {
        row * (self.width + 1) + self.width + column - row
    }

    fn size(&self) -> usize {
        self.entries.len() / (self.width + 1)
    }

    /// Returns the factor L of `A + shift·1 = LLᵀ`; `None` if that is not positive definite.
    pub fn factor(&self, shift: f64) -> Option<Factor> {
        let mut lower = self.clone();
        for row in 0..self.size() {
            let first = row.saturating_sub(self.width);
            for column in first..=row {
                let common = first.max(column.saturating_sub(self.width));
                let left = &lower.entries[lower.place(row, common)..lower.place(row, column)];
                let above = &lower.entries[lower.place(column, common)..lower.place(column, column)];
                let products: f64 = left.iter().zip(above).map(|(one, other)| one * other).sum();
                let place = lower.place(row, column);
                let value = lower.entries[place] - products;
                lower.entries[place] = if column < row {
                    value / lower.entries[lower.place(column, column)]
                } else if value + shift > 0.0 {
                    (value + shift).sqrt()
                } else {
                    return None;
                };
            }
        }
        Some(Factor(lower))
    }
}

/// A Cholesky factor.
#[derive(Clone, Debug)]
pub struct Factor(Banded);

impl Factor {
    /// Solves for a right-hand side, in place.
    pub fn solve(&self, right: &mut [f64]) {
        let Self(lower) = self;
        let row_before = |row: usize| {
            let first = row.saturating_sub(lower.width);
            (
                first,
                &lower.entries[lower.place(row, first)..lower.place(row, row)],
                lower.entries[lower.place(row, row)],
            )
        };
        for row in 0..right.len() {
            let (first, before, diagonal) = row_before(row);
            let products: f64 = before.iter().zip(&right[first..]).map(|(entry, value)| entry * value).sum();
            right[row] = (right[row] - products) / diagonal;
        }
        for row in (0..right.len()).rev() {
            let (first, before, diagonal) = row_before(row);
            right[row] /= diagonal;
            let value = right[row];
            for (entry, earlier) in before.iter().zip(&mut right[first..]) {
                *earlier -= entry * value;
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::cast_precision_loss, reason = "small numbers")]
mod tests {
    use super::*;

    #[test]
    fn solves_as_a_dense_factorisation_does() {
        let (size, width) = (9, 3);
        let mut banded = Banded::new(size, width);
        let mut dense = nalgebra::DMatrix::<f64>::zeros(size, size);
        for row in 0..size {
            for column in row.saturating_sub(width)..=row {
                let value = if row == column { 8.0 } else { ((row * 7 + column * 3) % 5) as f64 - 2.0 };
                banded.add(row, column, value);
                dense[(row, column)] = value;
                dense[(column, row)] = value;
            }
        }
        let mut right: Vec<f64> = (0..size).map(|place| place as f64 - 3.0).collect();
        let expected = dense.clone().cholesky().unwrap().solve(&nalgebra::DVector::from_vec(right.clone()));
        banded.factor(0.0).unwrap().solve(&mut right);
        assert!((nalgebra::DVector::from_vec(right) - expected).norm() < 1e-13);
        assert!(banded.factor(-100.0).is_none());
    }
}
