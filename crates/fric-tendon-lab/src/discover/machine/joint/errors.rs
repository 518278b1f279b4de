//! Standard errors of the free numbers at a minimum of the joint cost.

use fric_lab::statistics::{Scores, inverse_of_normal};
use nalgebra::{DMatrix, DVector};

use super::{Jacobian, Joint, Point, Set, Units, weighted};
use crate::identify::errors::{ALONG_RATIO, MODEL_TENSION_RATIO};

/// Standard errors of a free number: with all contributions, and with white noise alone.
#[derive(Clone, Copy, Debug)]
pub struct StandardError {
    pub place: usize,
    pub whole: f64,
    pub white: f64,
}

impl Joint<'_> {
    /// Returns the standard error of each free number of a set at its minimum, by index. Noise of a grating moves all disks beyond it, and residuals
    /// are correlated, so the scatter of the scores of whole samples and of blocks counts where it exceeds that of white noise. The error of the
    /// model itself is added.
    pub fn errors(&self, point: &Point, set: &Set, jacobian: &Jacobian) -> Option<Vec<StandardError>> {
        let sums = self.sums(point);
        let rms = |square: f64, count: f64, unit: f64| {
            if count > 0.0 && square > 0.0 { (square / count).sqrt() } else { unit }
        };
        let given = self.units(point);
        let units = Units {
            tension_n: rms(sums.tension_n2, sums.tension_count, given.tension_n),
            marker_m: rms(sums.marker_m2, sums.marker_count, given.marker_m),
        };
        let count = set.active.len();
        let weights = self.weights(point, units);
        let columns: Vec<Vec<f64>> = set.active.iter().map(|place| weighted(&jacobian.0[*place], &weights)).collect();
        let left = weighted(&point.left, &weights);
        let (tension_width, marker_width) = self.widths();
        let width = (tension_width + marker_width).max(1);
        let mut matrices = [DMatrix::zeros(count, count), DMatrix::zeros(count, count)];
        let mut scores = Scores::new(count);
        for sample in 0..left.len() / width {
            let mut score = vec![0.0; count];
            for place in sample * width..(sample + 1) * width {
                let numbers = DVector::from_iterator(count, columns.iter().map(|column| column[place]));
                let signal = usize::from(place % width >= tension_width);
                matrices[signal].syger(1.0, &numbers, &numbers, 1.0);
                score.iter_mut().zip(numbers.iter()).for_each(|(score, slope)| *score += slope * left[place]);
            }
            scores.add(&score);
        }
        for matrix in &mut matrices {
            matrix.fill_upper_triangle_with_lower_triangle();
        }
        let known = DMatrix::from_diagonal(&DVector::from_column_slice(&set.precision));
        let inverse = inverse_of_normal(&(&matrices[0] + &matrices[1] + &known))?;
        let off = MODEL_TENSION_RATIO * self.runs.greatest_tension_n / units.tension_n;
        let of_tensions = &matrices[0] * (sums.tension_count * (ALONG_RATIO * off).powi(2));
        let arc_error = weighted(&self.arc_error_m, &weights);
        let pull = columns.iter().map(|column| column.iter().zip(&arc_error).map(|(slope, off)| slope * off).sum());
        let of_shapes = &inverse * DVector::from_iterator(count, pull);
        let systematic = &inverse * of_tensions * &inverse + &of_shapes * of_shapes.transpose();
        let in_blocks = scores.covariance(&inverse) + &inverse * known * &inverse;
        let error = |(at, place): (usize, &usize)| {
            let ratio: f64 = in_blocks[(at, at)] / inverse[(at, at)];
            let factor = if ratio.is_finite() { ratio.max(1.0) } else { 1.0 };
            let whole = (factor * inverse[(at, at)] + systematic[(at, at)]).max(0.0).sqrt();
            StandardError { place: *place, whole, white: inverse[(at, at)].max(0.0).sqrt() }
        };
        Some(set.active.iter().enumerate().map(error).collect())
    }
}
