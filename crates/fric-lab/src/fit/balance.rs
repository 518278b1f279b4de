//! Checks whether the wrench on the platform determines the forces of the cables.
//!
//! A fit to `A^T f + w = 0` (\[P\] 3) uses the directions in which cables pull. Two cases make it impossible:
//!
//! - **One line.** If all cables pull along one line in every pose, the six equations reduce to one. A reference force serves as well, and something
//!   outside the model bears five components of the wrench.
//! - **Out of balance.** If most of the wrench acts in directions in which no cable pulls, no cable forces balance it. Something else holds the
//!   platform (a guide), or geometry, pose and wrench are inconsistent.
//!
//! A suspended robot with fewer than six cables that hangs in balance is neither of these.

use nalgebra::{DMatrix, Matrix6, Vector6};

use super::error::FitError;

/// Number of samples to examine, evenly spread over the log.
const LOOKED_AT: usize = 2000;
/// Singular values below this fraction of the largest count as zero: geometry is known to 1 mm in 1 m at best.
const RANK_RATIO: f64 = 1e-3;
/// Maximum fraction of the wrench, by root mean square, that no cable bears. A suspended robot has a few per cent, from errors of geometry and pose;
/// a robot that something else holds has nearly all. At half or double this value neither changes sides.
const MOST_UNBORNE_RATIO: f64 = 0.5;

/// Checks the balance. `structure` holds the columns of the structure matrix, `cable_count` for each wrench.
pub fn check(structure: &[Vector6<f64>], outside: &[Vector6<f64>], cable_count: usize) -> Result<(), FitError> {
    let turn = by_moment_arm(structure);
    let stride = outside.len().div_ceil(LOOKED_AT).max(1);
    let (mut rank, mut squares, mut unborne) = (0, 0.0, 0.0);
    let samples = structure.chunks_exact(cable_count.max(1)).zip(outside).step_by(stride);
    for (columns, wrench) in samples.filter(|(columns, wrench)| is_finite(columns) && is_finite(&[**wrench])) {
        let wrench = turn * wrench;
        let scaled: Vec<Vector6<f64>> = columns.iter().map(|column| turn * column).collect();
        let svd = DMatrix::from_fn(6, cable_count, |row, column| scaled[column][row]).svd(true, false);
        let least = RANK_RATIO * svd.singular_values.max();
        let directions = svd.u.iter().flat_map(|u| u.column_iter()).zip(&svd.singular_values);
        let borne: Vec<f64> = directions.filter(|(_, value)| **value > least).map(|(u, _)| u.dot(&wrench)).collect();
        rank = rank.max(borne.len());
        squares += wrench.norm_squared();
        unborne += wrench.norm_squared() - borne.iter().map(|part| part * part).sum::<f64>();
    }
    if rank == 1 {
        return Err(FitError::new(ONE_LINE, ONE_LINE_ADVICE));
    }
    let ratio = (unborne / squares).max(0.0).sqrt();
    if rank > 1 && ratio > MOST_UNBORNE_RATIO {
        let cause = format!(
            "no forces of the cables balance the wrench: {:.0} % of it is in directions in which no cable pulls",
            100.0 * ratio
        );
        return Err(FitError::new(cause, UNBORNE_ADVICE));
    }
    Ok(())
}

/// The reason why a robot of one cable cannot be fitted to the wrench.
pub const ONE_LINE: &str = "the wrench cannot identify the cables: all pull along one line in every pose, and bear one of its six \
                            components";
/// The advice for a robot of one cable.
pub const ONE_LINE_ADVICE: &str = "Fit to the force at the platform: name its topic as `reference` under `[log]` in the robot file, or \
                                   give the load there, `reference = { hanging_mass_kg = … }`.";
const UNBORNE_ADVICE: &str = "Compare `base_m`, `platform_m`, the mass and the poses with the robot; a platform that something else \
                              holds cannot be fitted to the wrench.";

fn is_finite(columns: &[Vector6<f64>]) -> bool {
    columns.iter().flat_map(|column| column.iter()).all(|number| number.is_finite())
}

/// Returns the matrix that scales torques to forces by the mean moment arm.
pub fn by_moment_arm(structure: &[Vector6<f64>]) -> Matrix6<f64> {
    let all_m = structure.iter().map(|column| column.fixed_rows::<3>(3).norm()).filter(|arm_m| arm_m.is_finite());
    let (sum_m, count) = all_m.fold((0.0, 0.0), |(sum, count), arm_m| (sum + arm_m, count + 1.0));
    // Cables that all meet in the platform's origin exert no torque, so there is nothing to scale.
    let arm_m = if sum_m > 0.0 { sum_m / count } else { 1.0 };
    Matrix6::from_diagonal(&Vector6::new(1.0, 1.0, 1.0, 1.0 / arm_m, 1.0 / arm_m, 1.0 / arm_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a sample of cables with directions and moment arms.
    fn columns(cables: &[([f64; 3], [f64; 3])]) -> Vec<Vector6<f64>> {
        let column = |(direction, arm): &([f64; 3], [f64; 3])| {
            let (u, b) = (nalgebra::Vector3::from(*direction).normalize(), nalgebra::Vector3::from(*arm));
            let torque = b.cross(&u);
            Vector6::new(u.x, u.y, u.z, torque.x, torque.y, torque.z)
        };
        cables.iter().map(column).collect()
    }

    const WEIGHT: Vector6<f64> = Vector6::new(0.0, 0.0, -10.0, 0.0, 0.0, 0.0);

    #[test]
    fn cables_on_one_line_are_refused_and_others_that_bear_the_wrench_are_not() {
        let up = ([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]);
        let one = columns(&[up]);
        assert!(check(&one, &[WEIGHT], 1).is_err_and(|error| error.cause.contains("one line")));
        let again = columns(&[up, ([0.0, 0.0, 1.0], [0.0, 0.0, 0.2])]);
        assert!(check(&again, &[WEIGHT], 2).is_err_and(|error| error.cause.contains("one line")));
        // Two ropes of a swing bear its weight, and so do three on a ring.
        let swing = columns(&[([0.0, 0.0, 1.0], [0.3, 0.0, 0.0]), ([0.0, 0.0, 1.0], [-0.3, 0.0, 0.0])]);
        assert_eq!(check(&swing, &[WEIGHT], 2), Ok(()));
        let ring = columns(&[
            ([0.5, 0.0, 1.0], [0.3, 0.0, 0.0]),
            ([-0.25, 0.433_012_7, 1.0], [-0.15, 0.259_807_6, 0.0]),
            ([-0.25, -0.433_012_7, 1.0], [-0.15, -0.259_807_6, 0.0]),
        ]);
        assert_eq!(check(&ring, &[WEIGHT], 3), Ok(()));
        // A slope of 45° between two cables in a plane: a guide bears half of the weight's square.
        let level = columns(&[([1.0, 0.0, 0.2], [0.0, 0.0, 0.0]), ([0.0, 1.0, 0.0], [0.0, 0.0, 0.0])]);
        assert!(check(&level, &[WEIGHT], 2).is_err_and(|error| error.cause.contains("98 %")));
        // Without samples there is no verdict.
        assert_eq!(check(&one, &[Vector6::repeat(f64::NAN)], 1), Ok(()));
    }
}
