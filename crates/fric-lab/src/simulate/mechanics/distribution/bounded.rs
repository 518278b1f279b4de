//! Cable forces within bounds, as near as possible to given ones.
//!
//! The problem is `min Σ(f_i − t_i)²/2` subject to `A^T f = −w` and `l ≤ f_i ≤ u`, where t are the wanted forces. If no bound is active, the solution
//! is the closed form of [`Distribution::solve`]. The method fails only if no such forces exist. The dual problem has six unknowns λ: `f_i(λ) =
//! clamp(t_i − u_i·λ, l, u)`, to be chosen so that `g(λ) = A^T f(λ) + w` vanishes. g is the gradient of a concave, piecewise quadratic function. It
//! is maximised by the proximal point method: with the term `−|λ − λ_k|²/(2s)` it has one maximum λ_{k+1}, which Newton's method with a line search
//! finds. With growing s, g vanishes after a few k. If no such forces exist, λ grows without bound and g does not vanish.

use nalgebra::{Cholesky, Matrix6, Vector6};

use super::Distribution;

/// Softness s of the proximal steps.
const SOFTNESS: [f64; 12] = [1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e12];
/// Maximum number of Newton steps within each; a few suffice.
const MOST_STEPS: usize = 60;
/// Maximum number of trial lengths of a step.
const MOST_TRIALS: usize = 100;
/// A line search ends when the slope along the step is below this fraction of its start value.
const SMALL_SLOPE: f64 = 0.1;
/// Residual that counts as zero, as a fraction of the sum of all forces.
const RESIDUAL_SHARE: f64 = 1e-13;

impl Distribution {
    /// Computes forces within bounds (N) for the structure matrix with these columns and the external wrench (N, N m).
    ///
    /// On entry `forces_n` holds the wanted forces, on return the nearest ones that hold the platform. Returns false if there are none; `forces_n` is
    /// then unchanged.
    pub fn solve_within(
        &mut self,
        structure: &[Vector6<f64>],
        wrench: &Vector6<f64>,
        bounds_n: [f64; 2],
        forces_n: &mut [f64],
    ) -> bool {
        let wrench = self.take(structure, wrench);
        let [least_n, greatest_n] = bounds_n;
        let columns = &self.columns;
        let pull = |wanted_n: f64, column: &Vector6<f64>, multiplier: &Vector6<f64>| {
            (wanted_n - column.dot(multiplier)).max(least_n).min(greatest_n)
        };
        let wanted = || forces_n.iter().zip(columns);
        let unbalance = |multiplier: &Vector6<f64>| {
            wanted().fold(wrench, |sum, (wanted_n, column)| sum + column * pull(*wanted_n, column, multiplier))
        };
        let is_none = |rest: &Vector6<f64>, multiplier: &Vector6<f64>| {
            let sum_n: f64 = wanted().map(|(wanted_n, column)| pull(*wanted_n, column, multiplier).abs()).sum();
            rest.amax() <= RESIDUAL_SHARE * (sum_n + wrench.amax())
        };
        let is_free = |wanted_n: f64, column: &Vector6<f64>, multiplier: &Vector6<f64>| {
            let unclamped_n = wanted_n - column.dot(multiplier);
            unclamped_n > least_n && unclamped_n < greatest_n
        };
        let mut multiplier = Vector6::zeros();
        let mut found = false;
        for softness in SOFTNESS {
            let center = multiplier;
            let rest = |multiplier: &Vector6<f64>| unbalance(multiplier) - (multiplier - center) / softness;
            for _ in 0..MOST_STEPS {
                let left = rest(&multiplier);
                if is_none(&left, &multiplier) {
                    break;
                }
                let free = wanted().filter(|(wanted_n, column)| is_free(**wanted_n, column, &multiplier));
                let square: Matrix6<f64> = free.map(|(_, column)| column * column.transpose()).sum();
                let Some(curvature) = Cholesky::new(square + Matrix6::identity() / softness) else { break };
                let step = curvature.solve(&left);
                let Some(length) = step_length(|length| step.dot(&rest(&(multiplier + step * length)))) else { break };
                multiplier += step * length;
            }
            found = is_none(&unbalance(&multiplier), &multiplier);
            if found {
                break;
            }
        }
        if found {
            for (force, column) in forces_n.iter_mut().zip(columns) {
                *force = pull(*force, column, &multiplier);
            }
        }
        found
    }
}

/// Returns the length at which a non-increasing slope has become small, 1 if it is small there; `None` if it never is.
fn step_length(slope: impl Fn(f64) -> f64) -> Option<f64> {
    let small = SMALL_SLOPE * slope(0.0);
    if small <= 0.0 {
        return None;
    }
    let (mut start, mut end, mut length) = (0.0, f64::INFINITY, 1.0);
    for _ in 0..MOST_TRIALS {
        let here = slope(length);
        if here.abs() <= small {
            return Some(length);
        }
        if here > 0.0 {
            start = length;
        } else {
            end = length;
        }
        length = if end.is_finite() { 0.5 * (start + end) } else { 2.0 * length };
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns four cables in a plane.
    fn plane() -> Vec<Vector6<f64>> {
        [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]
            .map(|[x, y]: [f64; 2]| Vector6::new(x, y, 0.0, 0.0, 0.0, 0.0) / 2.0_f64.sqrt())
            .into()
    }

    fn rest(columns: &[Vector6<f64>], wrench: &Vector6<f64>, forces_n: &[f64]) -> f64 {
        columns.iter().zip(forces_n).fold(*wrench, |sum, (column, force_n)| sum + column * *force_n).amax()
    }

    #[test]
    fn finds_forces_wherever_there_are_some() {
        let columns = plane();
        let mut distribution = Distribution::new(0.0, 0.0);
        // The two pairs of opposite cables differ by (p_x ± p_y)/√2, so forces within 1…10 N exist up to a difference of 9 N.
        for (x, y) in (-14..=14).flat_map(|x| (-14..=14).map(move |y| (f64::from(x), f64::from(y)))) {
            let wrench = Vector6::new(x, y, 0.0, 0.0, 0.0, 0.0);
            let most_n = (x + y).abs().max((x - y).abs()) / 2.0_f64.sqrt();
            let mut forces_n = [3.0; 4];
            let found = distribution.solve_within(&columns, &wrench, [1.0, 10.0], &mut forces_n);
            assert_eq!(found, most_n <= 9.0, "{x} {y}");
            if found {
                assert!(rest(&columns, &wrench, &forces_n) < 1e-11, "{x} {y}: {forces_n:?}");
                assert!(forces_n.iter().all(|force_n| (1.0..=10.0).contains(force_n)), "{forces_n:?}");
            } else {
                assert!(forces_n.iter().all(|force_n| (force_n - 3.0).abs() < 1e-300));
            }
        }
    }

    #[test]
    fn is_the_nearest_of_all() {
        // All valid forces differ by multiples of (1, 0, 1, 0) and (0, 1, 0, 1). A grid of these finds none nearer.
        let (columns, wrench) = (plane(), Vector6::new(5.0, 2.0, 0.0, 0.0, 0.0, 0.0));
        let mut forces_n = [3.0; 4];
        assert!(Distribution::new(0.0, 0.0).solve_within(&columns, &wrench, [1.0, 10.0], &mut forces_n));
        let distance = |forces_n: &[f64; 4]| forces_n.iter().map(|force_n| (force_n - 3.0).powi(2)).sum::<f64>();
        for (one, other) in (-90..90).flat_map(|one| (-90..90).map(move |other| (f64::from(one), f64::from(other)))) {
            let [a, b, c, d] = forces_n;
            let moved = [a + 0.1 * one, b + 0.1 * other, c + 0.1 * one, d + 0.1 * other];
            if moved.iter().all(|force_n| (1.0..=10.0).contains(force_n)) {
                assert!(distance(&moved) >= distance(&forces_n) - 1e-9, "{moved:?} is nearer than {forces_n:?}");
            }
        }
    }

    #[test]
    fn what_no_cable_can_balance_is_not_found() {
        let mut forces_n = [3.0; 4];
        let wrench = Vector6::new(0.0, 0.0, 1.0, 0.0, 0.0, 0.0);
        assert!(!Distribution::new(0.0, 0.0).solve_within(&plane(), &wrench, [1.0, f64::INFINITY], &mut forces_n));
    }

    /// Whether forces within bounds exist for eight cables, from the corners of the polygon that the bounds cut out of the null-space plane; `None`
    /// if a corner is almost on a bound.
    fn exists(columns: &[Vector6<f64>], wrench: &Vector6<f64>, [least_n, greatest_n]: [f64; 2]) -> Option<bool> {
        let matrix = nalgebra::SMatrix::<f64, 6, 8>::from_columns(columns);
        let eigen = nalgebra::SymmetricEigen::new(matrix.transpose() * matrix);
        let mut order: Vec<usize> = (0..8).collect();
        order.sort_by(|one, other| eigen.eigenvalues[*one].total_cmp(&eigen.eigenvalues[*other]));
        let null = [order[0], order[1]].map(|index| eigen.eigenvectors.column(index).into_owned());
        let start_n = -matrix.transpose() * ((matrix * matrix.transpose()).try_inverse().unwrap() * wrench);
        // Each bound of each cable is a line n·s = b in the plane.
        let lines: Vec<([f64; 2], f64)> = (0..8)
            .flat_map(|cable| {
                [least_n, greatest_n].map(|bound_n| (null.map(|null| null[cable]), bound_n - start_n[cable]))
            })
            .collect();
        let mut slack_n = f64::NEG_INFINITY;
        for (place, (one, one_n)) in lines.iter().enumerate() {
            for (other, other_n) in &lines[..place] {
                let cross = one[0] * other[1] - one[1] * other[0];
                if cross.abs() < 1e-9 {
                    continue;
                }
                let corner =
                    [(one_n * other[1] - other_n * one[1]) / cross, (one[0] * other_n - other[0] * one_n) / cross];
                let forces_n = start_n + null[0] * corner[0] + null[1] * corner[1];
                let inside = forces_n.iter().map(|force_n| (force_n - least_n).min(greatest_n - force_n));
                slack_n = slack_n.max(inside.fold(f64::INFINITY, f64::min));
            }
        }
        // The corner itself lies on two bounds, so its slack is zero up to rounding.
        if (-1e-3..-1e-9).contains(&slack_n) { None } else { Some(slack_n >= -1e-9) }
    }

    #[test]
    fn eight_cables_find_forces_exactly_where_there_are_some() {
        let mut random = 7_u64;
        let mut uniform = |half: f64| {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            half * (f64::from((random >> 33) as i32) / f64::from(1_u32 << 30) - 1.0)
        };
        let mut counts = [0, 0];
        for _ in 0..2000 {
            let columns = super::super::tests::eight([uniform(0.25), uniform(0.2), uniform(0.2)]);
            let torque = [uniform(0.4), uniform(0.4), uniform(0.1)];
            let wrench = Vector6::new(uniform(20.0), uniform(20.0), uniform(20.0), torque[0], torque[1], torque[2]);
            let bounds_n = [1.0, 30.0 + uniform(20.0)];
            let Some(expected) = exists(&columns, &wrench, bounds_n) else { continue };
            let mut forces_n = [12.0; 8];
            let found = Distribution::new(0.09, 0.0).solve_within(&columns, &wrench, bounds_n, &mut forces_n);
            assert_eq!(found, expected, "{wrench} {bounds_n:?}");
            counts[usize::from(found)] += 1;
            if found {
                assert!(rest(&columns, &wrench, &forces_n) < 1e-9);
                assert!(forces_n.iter().all(|force_n| (bounds_n[0]..=bounds_n[1]).contains(force_n)));
            }
        }
        println!("{counts:?}");
        assert!(counts.iter().all(|count| *count > 200), "{counts:?}");
    }
}
