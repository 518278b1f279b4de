//! Tests whether a model makes shapes or tensions worse than another one.
//!
//! Two models are compared on the same samples, so that their common noise cancels: the squares of their errors are subtracted sample by sample, and
//! the mean difference must exceed two standard errors, estimated from blocks of the run. An increase that the markers' noise would hide in the mean
//! of so many samples does not count either.

use super::case::Fit;
use super::markers::MarkerFit;

/// Number of blocks for the standard error.
const BLOCKS: usize = 10;
const STANDARD_ERRORS: f64 = 2.0;

/// A shape that becomes worse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worse {
    /// Index of the disk, from 0.
    pub disk: usize,
    /// Root mean square distance before and after, m.
    pub before_m: f64,
    pub after_m: f64,
}

/// Returns the disk whose distance from its marker grows most, with the model's own friction or with the measured one; `None` if none does.
pub fn worse_shape(
    [before, after]: [&Fit; 2],
    [markers_before, markers_after]: [Option<&MarkerFit>; 2],
) -> Option<Worse> {
    let noise_m = markers_before?.noise_m;
    let own = grown([&before.marker_m, &after.marker_m], noise_m);
    let measured = markers_before.zip(markers_after);
    let measured = measured.and_then(|(one, other)| grown([&one.residual_m, &other.residual_m], noise_m));
    let growth_m = |worse: &Worse| worse.after_m - worse.before_m;
    own.into_iter().chain(measured).max_by(|one, other| growth_m(one).total_cmp(&growth_m(other)))
}

/// Whether the tensions are further from the gratings than before.
pub fn are_tensions_worse(before: &Fit, after: &Fit) -> bool {
    let squares = |fit: &Fit| -> Vec<f64> {
        let of = |row: &Vec<f64>| row.iter().filter(|value| value.is_finite()).map(|value| value * value).sum();
        fit.residual_n.iter().map(of).collect()
    };
    is_beyond_chance(&squares(before), &squares(after))
}

/// Returns the disk whose distance from its marker grows most, from markers minus disks in each sample before and after, m, and the noise of a distance.
pub fn grown([before, after]: [&[Vec<[f64; 2]>]; 2], noise_m: f64) -> Option<Worse> {
    let disk_count = before.iter().map(Vec::len).max().unwrap_or(0);
    let of_disk = |rows: &[Vec<[f64; 2]>], disk: usize| -> Vec<f64> {
        let square = |row: &Vec<[f64; 2]>| row.get(disk).map_or(f64::NAN, |[x_m, y_m]| x_m * x_m + y_m * y_m);
        rows.iter().map(square).collect()
    };
    let all = (0..disk_count).filter_map(|disk| {
        let (one, other) = (of_disk(before, disk), of_disk(after, disk));
        let (sum, count) = mean_of_both(&one, &other)?;
        let [before_m, after_m] = sum.map(f64::sqrt);
        let is_worse = after_m > before_m + noise_m / count.sqrt() && is_beyond_chance(&one, &other);
        is_worse.then_some(Worse { disk, before_m, after_m })
    });
    all.max_by(|one, other| (one.after_m - one.before_m).total_cmp(&(other.after_m - other.before_m)))
}

/// Returns the means of two lists over the indices where both are finite, and the number of these.
fn mean_of_both(one: &[f64], other: &[f64]) -> Option<([f64; 2], f64)> {
    let pairs: Vec<_> = one.iter().zip(other).filter(|(one, other)| (*one + *other).is_finite()).collect();
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let count = pairs.len() as f64;
    let sums = pairs.iter().fold([0.0; 2], |[sum, other_sum], (one, other)| [sum + *one, other_sum + *other]);
    (count > 0.0).then(|| (sums.map(|sum| sum / count), count))
}

/// Whether the second list is greater on average, by more than the scatter of its blocks.
fn is_beyond_chance(one: &[f64], other: &[f64]) -> bool {
    let changes: Vec<f64> =
        one.iter().zip(other).map(|(one, other)| other - one).filter(|one| one.is_finite()).collect();
    let length = changes.len().div_ceil(BLOCKS).max(1);
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let means: Vec<f64> = changes.chunks(length).map(mean).collect();
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let count = means.len() as f64;
    if count < 2.0 {
        return false;
    }
    let middle = mean(&means);
    let scatter: f64 = means.iter().map(|one| (one - middle).powi(2)).sum();
    middle > STANDARD_ERRORS * (scatter / (count * (count - 1.0))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_not_worse_and_a_step_is() {
        // The same noise, compared with zero and with half as much again.
        let noise: Vec<f64> = (0..100_u32).map(|place| f64::from(place * 7919 % 101) / 101.0).collect();
        let turned: Vec<f64> = noise.iter().rev().copied().collect();
        assert!(!is_beyond_chance(&noise, &turned));
        let greater: Vec<f64> = noise.iter().map(|one| 1.5 * one).collect();
        assert!(is_beyond_chance(&noise, &greater));
        assert!(!is_beyond_chance(&greater, &noise));
        assert!(!is_beyond_chance(&[], &[]));
    }
}
