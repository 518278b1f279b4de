//! Eliminates the zero that each log has of its own from residuals and derivatives.
//!
//! The zero `c` of a log changes the forces of this log alone, each by `u·c`; at the platform `u = 1`, at the sensor it is the derivative of the force.
//! Whatever the other parameters are, the sum of squares is least with `c = −Σ u r / Σ u²`, and with this zero inserted the problem is that of
//!
//! `r̃ = r − u·(Σ u r / Σ u²)`, `J̃ = J − u·(Σ u J / Σ u²)`
//!
//! (variable projection: G. H. Golub, V. Pereyra, *SIAM J. Numer. Anal.* 10, 1973; the derivatives after L. Kaufman, *BIT* 15, 1975). At the platform
//! each log thus loses its means. The other parameters have the estimates and the covariance of the problem that varies all zeros too, but the search
//! varies none, and nothing needs a start value for them. The sums go over the samples that count, and the zeros hold for all: held-out samples are
//! judged with the zero that the training samples of their log determine.
//!
//! Beyond the bound of Huber's loss, samples have no derivative with respect to a zero, so the sums are those of the others, found by Newton's method.

use std::ops::Range;

use super::pass::Forces;
use super::problem::Loss;
use crate::samples::cable::CableRecord;
use crate::samples::record::LogZero;

/// Maximum number of Newton steps with Huber's loss, which is piecewise quadratic: each step but the last moves samples across the bound.
const MOST_STEPS: usize = 32;
/// A step that is shorter than this fraction of the bound is the last one.
const SHORT_RATIO: f64 = 1e-9;

/// The zeros of all logs of a cable.
#[derive(Clone, Debug)]
pub struct Zeros {
    /// The zeros, one log after the other.
    pub logs: Vec<Zero>,
    zero: LogZero,
    free_count: usize,
}

/// The zero of a log.
#[derive(Clone, Debug)]
pub struct Zero {
    /// The cycles of the log.
    pub cycles: Range<usize>,
    /// By how much the zero differs from the common one, N; 0 if no sample counts.
    pub change_n: f64,
    /// `Σ u J / Σ u²` of each free parameter: by how much the zero moves against it.
    pub by_free: Vec<f64>,
    /// Whether a sample counts.
    pub is_known: bool,
}

impl Zeros {
    /// Computes the zeros from the forces with their derivatives with respect to the free parameters, behind which there is that with respect to a
    /// sensor's zero. `samples` says which count, and with which loss.
    pub fn new(
        (record, zero): (&CableRecord<'_>, LogZero),
        forces: &Forces,
        free_count: usize,
        samples: (&[bool], Loss),
    ) -> Self {
        let mut zeros = Self { logs: Vec::new(), zero, free_count };
        zeros.logs = record
            .logs()
            .map(|(start, rows)| zeros.of_log(record, forces, start..start + rows.len(), samples))
            .collect();
        zeros
    }

    /// Returns the derivative of a force with respect to the zero, from its derivatives.
    #[inline]
    pub fn lever(&self, gradient: &[f64]) -> f64 {
        self.zero.lever(gradient.get(self.free_count..).unwrap_or_default())
    }

    fn of_log(
        &self,
        record: &CableRecord<'_>,
        forces: &Forces,
        cycles: Range<usize>,
        (used, loss): (&[bool], Loss),
    ) -> Zero {
        let counted = || {
            let counts = |cycle: &usize| used.get(*cycle).copied().unwrap_or(false);
            cycles.clone().filter(counts).filter_map(|cycle| {
                let (force_n, gradient) = forces.at(cycle);
                Some((force_n - record.references_n.get(cycle)?, self.lever(gradient), gradient))
            })
        };
        let bound_n = match loss {
            Loss::Squares => f64::INFINITY,
            Loss::Huber(bound_n) => bound_n,
        };
        let (mut change_n, mut within_n) = (0.0, f64::INFINITY);
        for _ in 0..MOST_STEPS {
            let (mut slope, mut curvature) = (0.0, 0.0);
            for (residual_n, lever, _) in counted() {
                let left_n: f64 = residual_n + lever * change_n;
                slope += lever * left_n.clamp(-within_n, within_n);
                curvature += if left_n.abs() <= within_n { lever * lever } else { 0.0 };
            }
            let step_n = if curvature > 0.0 { slope / curvature } else { 0.0 };
            change_n -= step_n;
            if bound_n.is_infinite() || within_n.is_finite() && step_n.abs() <= SHORT_RATIO * bound_n {
                break;
            }
            within_n = bound_n;
        }
        let (mut by_free, mut squares) = (vec![0.0; self.free_count], 0.0);
        for (residual_n, lever, gradient) in counted() {
            if (residual_n + lever * change_n).abs() <= bound_n {
                squares += lever * lever;
                by_free.iter_mut().zip(gradient).for_each(|(sum, part)| *sum += lever * part);
            }
        }
        let is_known = squares > 0.0;
        for sum in &mut by_free {
            *sum = if is_known { *sum / squares } else { 0.0 };
        }
        Zero { cycles, change_n, by_free, is_known }
    }
}
