//! Combinations of parameters that the samples do not determine.
//!
//! A parameter may be uncertain because the samples hardly depend on it, or because another one has nearly the same effect: with a nearly constant
//! load, for example, a gain and an offset of the sensor. Standard errors show that something is uncertain; the eigenvectors of the information
//! matrix with small eigenvalues show which combination.
//!
//! The eigenvectors of one eigenvalue are an arbitrary basis of their space. [`open_directions`] brings the space of all small eigenvalues to reduced
//! row echelon form by complete pivoting: each direction has one *leading* parameter, which occurs in no other direction. Holding the leading
//! parameters leaves no open direction in the space, so they are the ones to hold, and each direction shows what its leading parameter is confused
//! with.

use nalgebra::DMatrix;

use super::determined::HALF_INTERVAL;

/// Minimum weight of a parameter in a direction, relative to the leading parameter, to take part in it. At 0.1, half a per cent of the direction's
/// square counts as a part; at 0.5, a parameter that compensates for half of the leading one is not reported.
pub(crate) const LEAST_WEIGHT: f64 = 0.25;

/// A direction in parameter space about which the samples say too little.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenDirection {
    /// Index of the leading parameter.
    pub leading: usize,
    /// Weight of every parameter, in the order and scale of the information matrix; 1 for the leading one.
    pub weights: Vec<f64>,
    /// Half the width of the 95 % interval along the direction, in steps of the weights; infinite if the samples say nothing.
    pub half_width: f64,
}

impl OpenDirection {
    /// Returns the indices of the parameters that take part, the leading one first.
    #[must_use]
    pub fn parts(&self) -> Vec<usize> {
        let takes_part = |(index, weight): (usize, &f64)| {
            (index != self.leading && weight.abs() >= LEAST_WEIGHT).then_some((index, weight.abs()))
        };
        let mut others: Vec<(usize, f64)> = self.weights.iter().enumerate().filter_map(takes_part).collect();
        others.sort_by(|(_, one), (_, other)| other.total_cmp(one));
        std::iter::once(self.leading).chain(others.into_iter().map(|(index, _)| index)).collect()
    }
}

/// Returns the directions along which the 95 % interval is wider than ±1, the least known first.
///
/// `information` is the inverse of the covariance (`JᵀJ/s²` for uncorrelated residuals of standard deviation `s`), with each parameter in units of
/// the widest half interval that still determines it. A direction is open if `1.96/√(uᵀ I u) > 1` for the unit vector `u` along it. Eigenvalues
/// within rounding of the largest one count as zero. If the matrix is not finite, no parameter is known.
#[must_use]
pub fn open_directions(information: &DMatrix<f64>) -> Vec<OpenDirection> {
    let count = information.nrows();
    if count == 0 || information.iter().any(|entry| !entry.is_finite()) {
        return (0..count).map(|leading| silent(leading, count)).collect();
    }
    let eigen = information.clone().symmetric_eigen();
    #[expect(clippy::cast_precision_loss, reason = "a few parameters")]
    let rounding = 8.0 * count as f64 * f64::EPSILON * eigen.eigenvalues.amax();
    let least = (HALF_INTERVAL * HALF_INTERVAL).max(rounding);
    let open: Vec<usize> = (0..count).filter(|place| eigen.eigenvalues[*place] < least).collect();
    let mut rows = DMatrix::from_fn(open.len(), count, |row, column| eigen.eigenvectors[(column, open[row])]);
    let leading = reduce(&mut rows);
    let direction = |(row, leading): (usize, usize)| {
        let weights: Vec<f64> = rows.row(row).iter().copied().collect();
        let along = rows.row(row).transpose();
        let (curvature, norm) = (along.dot(&(information * &along)), along.norm());
        // Converts from the unit vector to steps of the weights.
        let half_width =
            if curvature <= rounding * norm * norm { f64::INFINITY } else { HALF_INTERVAL / curvature.sqrt() };
        OpenDirection { leading, weights, half_width }
    };
    let mut directions: Vec<OpenDirection> = leading.into_iter().enumerate().map(direction).collect();
    directions.sort_by(|one, other| other.half_width.total_cmp(&one.half_width));
    directions
}

/// Returns the direction of a parameter about which the samples say nothing.
fn silent(leading: usize, count: usize) -> OpenDirection {
    let weights = (0..count).map(|place| if place == leading { 1.0 } else { 0.0 }).collect();
    OpenDirection { leading, weights, half_width: f64::INFINITY }
}

/// Brings independent rows to reduced row echelon form up to the order of the columns. Returns the leading column of each row.
fn reduce(rows: &mut DMatrix<f64>) -> Vec<usize> {
    // Of weights that differ only by rounding, the first one leads.
    const TIE: f64 = 1.0 + 1e-9;
    let (row_count, column_count) = rows.shape();
    let mut leading: Vec<Option<usize>> = vec![None; row_count];
    for _ in 0..row_count {
        let free = (0..row_count).filter(|row| leading[*row].is_none());
        let entries = free.flat_map(|row| (0..column_count).map(move |column| (row, column)));
        let greatest = entries.fold((0, 0, 0.0), |greatest: (usize, usize, f64), (row, column)| {
            let weight = rows[(row, column)].abs();
            if weight > greatest.2 * TIE { (row, column, weight) } else { greatest }
        });
        let (pivot, column, _) = greatest;
        leading[pivot] = Some(column);
        let scale = rows[(pivot, column)];
        rows.row_mut(pivot).unscale_mut(scale);
        let of_pivot = rows.row(pivot).into_owned();
        for row in (0..row_count).filter(|row| *row != pivot) {
            let factor = rows[(row, column)];
            let mut changed = rows.row_mut(row);
            changed -= &of_pivot * factor;
        }
    }
    leading.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns `JᵀJ/s²` of a straight line `gain·x + offset` through samples at `x`.
    fn line(x: &[f64], deviation: f64) -> DMatrix<f64> {
        let mut information = DMatrix::zeros(2, 2);
        for x in x {
            let row = nalgebra::DVector::from_row_slice(&[*x, 1.0]);
            information += &row * row.transpose() / (deviation * deviation);
        }
        information
    }

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found} {expected}");
    }

    #[test]
    fn gain_and_offset_of_a_load_that_does_not_vary_are_one() {
        // x = 3 throughout: `gain·3 + offset` is known, and changes with `offset = −3·gain` have no effect.
        let [direction] = &open_directions(&line(&[3.0; 50], 0.1))[..] else { panic!("one direction") };
        assert_eq!((direction.leading, direction.parts()), (1, vec![1, 0]));
        near(direction.weights[0], -1.0 / 3.0);
        near(direction.weights[1], 1.0);
        assert_eq!(direction.half_width.to_bits(), f64::INFINITY.to_bits());
    }

    #[test]
    fn the_width_is_that_of_the_line_through_the_samples() {
        // x = ±a around 0: gain and offset are independent, with the textbook errors s/(a√n) and s/√n.
        let x: Vec<f64> = (0..64).map(|place| if place % 2 == 0 { 0.01 } else { -0.01 }).collect();
        let [direction] = &open_directions(&line(&x, 0.4))[..] else { panic!("one direction") };
        assert_eq!(direction.parts(), [0]);
        near(direction.half_width, 1.96 * 0.4 / (0.01 * 8.0));
        // The offset is known to 1.96·0.4/8 = 0.098 < 1. With 200 times the range, the gain is known too.
        let wide: Vec<f64> = x.iter().map(|x| 200.0 * x).collect();
        assert!(open_directions(&line(&wide, 0.4)).is_empty());
    }

    #[test]
    fn several_directions_of_one_eigenvalue_come_apart() {
        // Two sensors, each with a constant load, and a known parameter between them.
        let mut information = DMatrix::zeros(5, 5);
        for (gain, offset, load) in [(0, 1, 0.5), (3, 4, 4.0)] {
            let row = nalgebra::DVector::from_fn(5, |place, _| match place {
                _ if place == gain => load,
                _ if place == offset => 1.0,
                _ => 0.0,
            });
            information += &row * row.transpose() * 1e4;
        }
        information[(2, 2)] = 1e4;
        let directions = open_directions(&information);
        let parts: Vec<Vec<usize>> = directions.iter().map(OpenDirection::parts).collect();
        assert_eq!(parts.len(), 2);
        assert!(parts.contains(&vec![0, 1]) && parts.contains(&vec![4, 3]), "{parts:?}");
        let of = |leading: usize| directions.iter().find(|direction| direction.leading == leading).unwrap();
        near(of(0).weights[1], -0.5);
        near(of(4).weights[3], -0.25);
        near(of(0).weights[3], 0.0);
        // With the leading parameters held, nothing is open.
        let kept = information.select_rows(&[1, 2, 3]).select_columns(&[1, 2, 3]);
        assert!(open_directions(&kept).is_empty());
    }

    #[test]
    fn of_what_is_no_number_and_of_nothing_nothing_is_known() {
        let silent = open_directions(&DMatrix::zeros(3, 3));
        assert_eq!(silent.iter().map(OpenDirection::parts).collect::<Vec<_>>(), [[0], [1], [2]]);
        assert_eq!(open_directions(&DMatrix::from_element(2, 2, f64::NAN)).len(), 2);
        assert!(open_directions(&DMatrix::zeros(0, 0)).is_empty());
    }
}
