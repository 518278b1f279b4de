//! The error of estimates because a cable's pulleys differ.
//!
//! The model has one μ for all pulleys of a cable, but no two bearings are equal. The resulting error repeats in every stroke, so the scatter of the
//! residuals does not show it, but the model can predict it. Let `d_k` be the change of the forces if the μ of pulley `k` is greater by a standard
//! deviation. The estimate then moves by `b_k = H⁻¹Jᵀd_k`, `H = JᵀJ`. μ represents the mean of the pulleys, each with a weight `w_k` by how much it
//! changes the force, `Σ w_k = 1`; a common change is no error. So the covariance grows by `Σ c_k c_kᵀ`, `c_k = b_k − w_k Σ_j b_j`.

use fric_core::LANES;
use fric_core::parameters::Values;
use nalgebra::{DMatrix, DVector};

use crate::search::pass::CandidatePass;
use crate::search::problem::{Member, Problem};

/// Standard deviation of a pulley's μ as a fraction of the cable's: uniform within ±10 %, the spread of bearings of one type. Of 200 logs with such
/// pulleys the interval of σ contains the truth in 192; with half of this value in 161, with double in 200.
const SPREAD_RATIO: f64 = 0.057_735;
/// Number of cycles that are evaluated at once.
const CHUNK: usize = 2048;

/// Returns the contribution of unlike pulleys to the covariance of an estimate, from the inverse of `JᵀJ`.
pub fn covariance(problem: &Problem<'_>, values: &[Values], inverse: &DMatrix<f64>) -> DMatrix<f64> {
    let none = DMatrix::zeros(inverse.nrows(), inverse.ncols());
    let Some(forces) = problem.forces(values) else { return none };
    let of_members = problem.members.iter().zip(values).zip(forces).enumerate();
    of_members.fold(none, |mut sum, (place, ((member, of_member), forces))| {
        let count = member.record.params.pulley_count();
        if count < 2 {
            return sum;
        }
        let mut changes_n = by_each_pulley(member, of_member, count);
        let mut weights = vec![0.0; count];
        for (cycle, changes_n) in changes_n.chunks_exact_mut(count).enumerate() {
            let (force_n, _) = forces.at(cycle);
            for (change_n, weight) in changes_n.iter_mut().zip(&mut weights) {
                *change_n -= force_n;
                *weight += change_n.abs();
            }
        }
        let moves = inverse * problem.projected(values, place, &changes_n, count);
        let (together, all): (DVector<f64>, f64) = (moves.column_sum(), weights.iter().sum());
        if all > 0.0 && all.is_finite() {
            for (of_pulley, weight) in moves.column_iter().zip(weights) {
                let alone = of_pulley - &together * (weight / all);
                sum += &alone * alone.transpose();
            }
        }
        sum
    })
}

/// Returns the change of the forces in every cycle if the μ of one pulley after the other is greater, N.
fn by_each_pulley(member: &Member<'_>, values: &Values, count: usize) -> Vec<f64> {
    let ratio = |candidate: usize, pulley: usize| if candidate == pulley { 1.0 + SPREAD_RATIO } else { 1.0 };
    let mut forces_n = Vec::with_capacity(member.record.rows.len() * count);
    let mut in_chunk = Vec::new();
    for (_, log) in member.record.logs() {
        let mut pass = CandidatePass::of_mu_ratios(&member.record, values, count, ratio);
        for rows in log.chunks(CHUNK) {
            pass.advance(rows, &mut in_chunk);
            let width = count.next_multiple_of(LANES);
            forces_n.extend(in_chunk.chunks_exact(width).flat_map(|of_cycle| of_cycle.iter().take(count)));
        }
    }
    forces_n
}
