//! Small dense systems of linear equations, in place.
//!
//! `stride.max(1)` tells the compiler at every place that rows are not empty, without which it keeps a panic.

/// Solves by elimination with row pivoting. `rows` holds `count` rows of `count` coefficients and the right side, which becomes the
/// solution, row by row in its last place. `false` where the matrix is singular or not finite.
pub fn solve(rows: &mut [f64], count: usize) -> bool {
    let stride = count + 1;
    for column in 0..count {
        let mut pivot = (column, 0.0_f64);
        for (place, row) in rows.chunks_exact(stride.max(1)).enumerate().take(count).skip(column) {
            let size = row.get(column).map_or(0.0, |value| value.abs());
            if size > pivot.1 {
                pivot = (place, size);
            }
        }
        if !(pivot.1 > 1e-280 && pivot.1 < f64::INFINITY) {
            return false;
        }
        let Some((done, below)) = rows.split_at_mut_checked((column + 1) * stride) else { return false };
        let Some(pivot_row) = done.get_mut(column * stride..) else { return false };
        if pivot.0 > column {
            let Some(other) = below.chunks_exact_mut(stride.max(1)).nth(pivot.0 - column - 1) else { return false };
            pivot_row.swap_with_slice_checked(other);
        }
        let Some((&mut lead, pivot_tail)) = pivot_row.get_mut(column..).and_then(<[f64]>::split_first_mut) else {
            return false;
        };
        for row in below.chunks_exact_mut(stride.max(1)) {
            let Some((first, tail)) = row.get_mut(column..).and_then(<[f64]>::split_first_mut) else { return false };
            if *first != 0.0 {
                let factor = *first / lead;
                *first = 0.0;
                for (value, above) in tail.iter_mut().zip(&*pivot_tail) {
                    *value -= factor * above;
                }
            }
        }
    }
    back_substitute(rows, count)
}

fn back_substitute(rows: &mut [f64], count: usize) -> bool {
    let stride = count + 1;
    for column in (0..count).rev() {
        let Some((above, below)) = rows.split_at_mut_checked(column * stride) else { return false };
        let Some(own) = below.get_mut(..stride) else { return false };
        let Some(&lead) = own.get(column) else { return false };
        let Some(right) = own.last_mut() else { return false };
        *right /= lead;
        if !right.is_finite() {
            return false;
        }
        let solution = *right;
        for row in above.chunks_exact_mut(stride.max(1)) {
            let factor = row.get(column).copied().unwrap_or(0.0);
            if let Some(right) = row.last_mut() {
                *right -= factor * solution;
            }
        }
    }
    true
}

/// Whether a symmetric matrix (the upper left of `rows`, as above) is positive definite; destroys it.
pub fn is_positive_definite(rows: &mut [f64], count: usize) -> bool {
    let stride = count + 1;
    for column in 0..count {
        let Some((done, below)) = rows.split_at_mut_checked((column + 1) * stride) else { return false };
        let Some((&lead, pivot_tail)) = done.get(column * stride + column..).and_then(<[f64]>::split_first) else {
            return false;
        };
        if !(lead > 0.0 && lead < f64::INFINITY) {
            return false;
        }
        for row in below.chunks_exact_mut(stride.max(1)) {
            let Some((first, tail)) = row.get_mut(column..).and_then(<[f64]>::split_first_mut) else { return false };
            let factor = *first / lead;
            for (value, above) in tail.iter_mut().zip(pivot_tail) {
                *value -= factor * above;
            }
        }
    }
    true
}

trait SwapRows {
    /// Exchanges the contents, as far as both reach.
    fn swap_with_slice_checked(&mut self, other: &mut [f64]);
}

impl SwapRows for [f64] {
    fn swap_with_slice_checked(&mut self, other: &mut [f64]) {
        for (one, other) in self.iter_mut().zip(other) {
            core::mem::swap(one, other);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_with_pivoting() {
        // x = (1, -2, 3); the first pivot is zero.
        let mut rows = [0.0, 2.0, 1.0, -1.0, 4.0, 1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 2.0];
        assert!(solve(&mut rows, 3));
        for (place, expected) in [(3, 1.0), (7, -2.0), (11, 3.0)] {
            assert!((rows[place] - expected).abs() < 1e-14, "{rows:?}");
        }
        assert!(!solve(&mut [1.0, 1.0, 0.0, 1.0, 1.0, 0.0], 2));
        assert!(!solve(&mut [f64::NAN, 1.0], 1));
    }

    #[test]
    fn knows_definiteness() {
        assert!(is_positive_definite(&mut [2.0, 1.0, 0.0, 1.0, 2.0, 0.0], 2));
        assert!(!is_positive_definite(&mut [1.0, 2.0, 0.0, 2.0, 1.0, 0.0], 2));
    }
}
