//! Tension distribution: positive cable forces that hold the platform.
//!
//! The forces satisfy `A^T f = −w` for the external wrench w on the platform, with `f` near given mean tensions `f_m`: `f = f_m − A·(A^T A)⁺·(w + A^T
//! f_m)` (Pott's closed form; `A^T` is 6×m and `(·)⁺` the pseudo-inverse, so a robot with fewer than six cables gets the least-squares solution). If
//! a cable is then below the least tension, the forces are raised along the projection of (1, …, 1) onto the null space of `A^T`, which does not
//! change the wrench. Cables that the null space cannot raise are held at the least tension; the cables alone then do not balance the platform.
//!
//! Torque rows are divided by the mean moment arm, so that N and N m have equal weight.

mod bounded;

use nalgebra::{Matrix6, SymmetricEigen, Vector6};

/// Eigenvalues of `A^T A` below this fraction of the greatest count as zero.
const RANK_SHARE: f64 = 1e-9;

/// How well a solution holds the platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Largest component of `A^T f + w`, with torques divided by the moment arm, N.
    pub residual_n: f64,
    /// Whether a cable had to be held at the least tension outside the null space.
    pub clamped: bool,
}

/// The solver, with buffers for intermediate results.
#[derive(Clone, Debug)]
pub struct Distribution {
    arm_m: f64,
    least_n: f64,
    columns: Vec<Vector6<f64>>,
    rise: Vec<f64>,
}

impl Distribution {
    /// Creates a solver for moment arms of about `arm_m` (0 if all cables meet in the platform origin) and a least tension of `least_n`.
    pub fn new(arm_m: f64, least_n: f64) -> Self {
        let arm_m = if arm_m > 0.0 { arm_m } else { 1.0 };
        Self { arm_m, least_n, columns: Vec::new(), rise: Vec::new() }
    }

    /// Computes forces for the structure matrix with these columns (force, torque) and the external wrench (N, N m).
    ///
    /// On entry `forces_n` holds the mean tensions, on return the forces.
    pub fn solve(&mut self, structure: &[Vector6<f64>], wrench: &Vector6<f64>, forces_n: &mut [f64]) -> Balance {
        let wrench = self.take(structure, wrench);
        let square = self.columns.iter().map(|column| column * column.transpose()).sum();
        let pseudo_inverse = Self::pseudo_inverse(&square);
        // The second pass removes the rounding errors of the first.
        for _ in 0..2 {
            let multiplier = pseudo_inverse * self.unbalance(&wrench, forces_n);
            for (force_n, column) in forces_n.iter_mut().zip(&self.columns) {
                *force_n -= column.dot(&multiplier);
            }
        }
        self.raise(&pseudo_inverse, forces_n);
        let mut clamped = false;
        for force_n in forces_n.iter_mut().filter(|force_n| **force_n < self.least_n * (1.0 - 1e-9)) {
            *force_n = self.least_n;
            clamped = true;
        }
        Balance { residual_n: self.unbalance(&wrench, forces_n).amax(), clamped }
    }

    /// Stores a structure matrix with torques divided by the moment arm, and returns the wrench scaled the same way.
    fn take(&mut self, structure: &[Vector6<f64>], wrench: &Vector6<f64>) -> Vector6<f64> {
        let arm_m = self.arm_m;
        let scaled = |vector: &Vector6<f64>| {
            Vector6::new(vector.x, vector.y, vector.z, vector.w / arm_m, vector.a / arm_m, vector.b / arm_m)
        };
        self.columns.clear();
        self.columns.extend(structure.iter().map(scaled));
        scaled(wrench)
    }

    /// Returns `A^T f + w`.
    fn unbalance(&self, wrench: &Vector6<f64>, forces_n: &[f64]) -> Vector6<f64> {
        self.columns.iter().zip(forces_n).fold(*wrench, |sum, (column, force_n)| sum + column * *force_n)
    }

    /// Returns the pseudo-inverse of a symmetric matrix, `(A^T A)⁺`, from its eigenvectors.
    fn pseudo_inverse(square: &Matrix6<f64>) -> Matrix6<f64> {
        let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(*square);
        let least = eigenvalues.amax() * RANK_SHARE;
        let inverse = eigenvalues.map(|value| if value > least { 1.0 / value } else { 0.0 });
        eigenvectors * Matrix6::from_diagonal(&inverse) * eigenvectors.transpose()
    }

    /// Adds the least multiple of the projection of (1, …, 1) onto the null space that raises every force it can to `least_n`.
    fn raise(&mut self, pseudo_inverse: &Matrix6<f64>, forces_n: &mut [f64]) {
        let sum: Vector6<f64> = self.columns.iter().sum();
        let multiplier = pseudo_inverse * sum;
        self.rise.clear();
        self.rise.extend(self.columns.iter().map(|column| 1.0 - column.dot(&multiplier)));
        // A tiny component of the projection is rounding.
        let needed = self.rise.iter().zip(forces_n.iter()).filter(|(rise, _)| **rise > 1e-2);
        let multiple = needed.map(|(rise, force_n)| (self.least_n - force_n) / rise).fold(0.0, f64::max);
        for (force_n, rise) in forces_n.iter_mut().zip(&self.rise) {
            *force_n += multiple * rise;
        }
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// Returns eight cables from the corners of a box to those of a smaller one, crossed in height.
    pub fn eight(place: [f64; 3]) -> Vec<Vector6<f64>> {
        let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
        let columns = [1.0, -1.0].into_iter().flat_map(|height| {
            corners.map(|[x, y]| {
                let arm = nalgebra::Vector3::new(0.06 * x, 0.05 * y, -0.05 * height);
                let base = nalgebra::Vector3::new(0.55 * x, 0.4 * y, 0.5 * height);
                let direction = (base - arm - nalgebra::Vector3::from(place)).normalize();
                let torque = arm.cross(&direction);
                Vector6::new(direction.x, direction.y, direction.z, torque.x, torque.y, torque.z)
            })
        });
        columns.collect()
    }

    #[test]
    fn balances_to_rounding_and_stays_positive() {
        for (x, y, z) in [(0.0, 0.0, 0.0), (0.15, -0.1, 0.1), (-0.15, 0.1, -0.15)] {
            let columns = eight([x, y, z]);
            for pull_n in [0.0, 3.0, 12.0] {
                let wrench = Vector6::new(pull_n, -0.5 * pull_n, -4.0, 0.02, -0.01, 0.03);
                let mut forces_n = [5.0; 8];
                let balance = Distribution::new(0.09, 0.6).solve(&columns, &wrench, &mut forces_n);
                let direct = columns.iter().zip(forces_n).fold(wrench, |sum, (column, force_n)| sum + column * force_n);
                assert!(direct.amax() < 1e-9, "{direct}");
                assert!(!balance.clamped && balance.residual_n < 1e-9);
                assert!(forces_n.iter().all(|force_n| *force_n >= 0.6 * (1.0 - 1e-9)), "{forces_n:?}");
            }
        }
    }

    #[test]
    fn is_the_nearest_solution_to_the_mean() {
        // The difference is orthogonal to the null space: a step along any null vector only increases the distance from the mean.
        let columns = eight([0.1, 0.05, 0.02]);
        let wrench = Vector6::new(0.0, 0.0, -4.0, 0.0, 0.0, 0.0);
        let mut forces_n = [20.0; 8];
        Distribution::new(0.09, 0.1).solve(&columns, &wrench, &mut forces_n);
        let mut null = [1.0, -2.0, 0.5, 0.3, -0.7, 1.1, 0.2, -0.4];
        Distribution::new(0.09, f64::MIN).solve(&columns, &Vector6::zeros(), &mut null);
        let product: f64 = null.iter().zip(forces_n).map(|(null, force_n)| null * (force_n - 20.0)).sum();
        assert!(null.iter().any(|part| part.abs() > 0.1));
        assert!(product.abs() < 1e-9, "{product}");
    }

    #[test]
    fn three_cables_hold_a_point_and_two_do_what_they_can() {
        let hung = [[1.0, 0.0], [-0.5, 0.8], [-0.5, -0.8]].map(|[x, y]: [f64; 2]| {
            let direction = nalgebra::Vector3::new(x, y, 1.0).normalize();
            Vector6::new(direction.x, direction.y, direction.z, 0.0, 0.0, 0.0)
        });
        let weight = Vector6::new(0.0, 0.0, -4.0, 0.0, 0.0, 0.0);
        let mut forces_n = [9.0; 3];
        let balance = Distribution::new(0.0, 0.1).solve(&hung, &weight, &mut forces_n);
        assert!(balance.residual_n < 1e-12 && !balance.clamped);

        let mut two_n = [9.0; 2];
        let balance = Distribution::new(0.0, 0.1).solve(&hung[..2], &weight, &mut two_n);
        assert!(balance.residual_n > 0.1);
        assert!(two_n.iter().all(|force_n| *force_n >= 0.1));
    }
}
