//! The deflection of a segment under a transverse force: its curvature varies linearly along the backbone.
//!
//! Weight and tip load beyond a segment act on its end with a force F of constant direction. Its moment falls from the beginning of the segment to
//! the end, so that the segment is an S about the arc of its mean curvature. With u from 0 to 1 along the segment, its direction is
//!
//! `φ(u) = θ·u + β·(u² − u)`
//!
//! with the skew β. It leaves the directions of both ends, and the lengths of the tendons to first order, as they are, and moves the end by `β·w` with
//! `w = L·d(θ)·n`, `d(θ) = ∫ cos(θx)·(x² − ¼) dx` over `−½ ≤ x ≤ ½`, and n normal to the chord of the arc. Its energy is `½·E·I/(3L)·β²`, so the skew is
//!
//! `β = c·g/√(1 + (c·g/β_max)²)` with `c = 3L/(E·I)` and `g = F·w`.
//!
//! Source: the beam of Euler and Bernoulli with the assumed linear curvature (Ritz). For small loads a straight segment has its closed form, `y =
//! F·L³/(3·E·I)`: the arc gives three quarters of it, the skew one. Deviations: terms of β² other than its energy, such as the pull of F and of the
//! tendons along the segment, are left out (1.7 % of β for 2 N on the published manipulator); half of a segment's own weight acts on its end; the
//! angle of a tendon at a hole is that of the arcs. `β_max`
//! limits the first of these where a load bends a single segment by more than a radian.

use nalgebra::Vector2;

/// Greatest skew of a segment, rad. A cantilever of one segment under a tip load of 3·E·I/L² deflects by 0.601 L with it, an elastica by 0.603 L; with
/// half of it by 0.563 L, with twice by 0.625 L.
const GREATEST_SKEW_RAD: f64 = 1.5;

/// The deflection of one segment.
#[derive(Clone, Copy, Debug)]
pub struct Deflection {
    force_n: Vector2<f64>,
    /// β, rad, and its derivative with respect to g, rad/(N m).
    skew_rad: f64,
    skew_per_nm: f64,
    /// w, m, and its derivatives with respect to the direction of the segment's beginning and to θ.
    way_m: Vector2<f64>,
    way_by_turn_m: Vector2<f64>,
    way_by_bend_m: Vector2<f64>,
    /// Derivatives of `w` twice with respect to θ, and with respect to both.
    way_by_bends_m: Vector2<f64>,
    way_by_both_m: Vector2<f64>,
}

/// The moments of the deflection: the derivatives of its energy, which it takes from the load, with respect to the direction S of a segment's
/// beginning and to its bend θ, N m.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "the unit")]
pub struct DeflectionMoments {
    pub turn_nm: f64,
    pub bend_nm: f64,
    /// Second derivatives: S and S, S and θ, θ and θ.
    pub turn_slope_nm: f64,
    pub both_slope_nm: f64,
    pub bend_slope_nm: f64,
}

impl Deflection {
    /// Computes the deflection of a segment of length L, stiffness E·I and bend θ, whose arc has the chord `chord_m` in the base frame, under the
    /// force F beyond its middle.
    pub fn new(
        chord_m: Vector2<f64>,
        (length_m, stiffness_n_m2): (f64, f64),
        bend_rad: f64,
        force_n: Vector2<f64>,
    ) -> Self {
        let along = chord_m.normalize();
        let across = Vector2::new(-along.y, along.x);
        let [value, slope, curvature] = shape(bend_rad).map(|factor| length_m * factor);
        let way_m = value * across;
        let softness = 3.0 * length_m / stiffness_n_m2;
        let linear_rad = softness * way_m.dot(&force_n);
        let ratio = linear_rad / GREATEST_SKEW_RAD;
        let limit = Vector2::new(1.0, ratio).norm();
        Self {
            force_n,
            skew_rad: linear_rad / limit,
            skew_per_nm: softness / (limit * limit * limit),
            way_m,
            way_by_turn_m: -value * along,
            way_by_bend_m: slope * across - 0.5 * value * along,
            way_by_bends_m: (curvature - 0.25 * value) * across - slope * along,
            way_by_both_m: -0.5 * value * across - slope * along,
        }
    }

    /// Returns the displacement of the end, base frame, m.
    pub fn shift_m(&self) -> Vector2<f64> {
        self.skew_rad * self.way_m
    }

    /// Returns the change of [`shift_m`](Self::shift_m) with a change of the direction of the segment's beginning and of its bend, rad.
    pub fn shift_change_m(&self, turn_rad: f64, bend_rad: f64) -> Vector2<f64> {
        let change_m = turn_rad * self.way_by_turn_m + bend_rad * self.way_by_bend_m;
        self.skew_per_nm * change_m.dot(&self.force_n) * self.way_m + self.skew_rad * change_m
    }

    /// Returns the moments on the bends.
    pub fn moments(&self) -> DeflectionMoments {
        let work_nm = |way_m: Vector2<f64>| way_m.dot(&self.force_n);
        let (turn, bend) = (work_nm(self.way_by_turn_m), work_nm(self.way_by_bend_m));
        let slope = |one: f64, other: f64, both_m: Vector2<f64>| {
            self.skew_per_nm * one * other + self.skew_rad * work_nm(both_m)
        };
        DeflectionMoments {
            turn_nm: self.skew_rad * turn,
            bend_nm: self.skew_rad * bend,
            turn_slope_nm: slope(turn, turn, -self.way_m),
            both_slope_nm: slope(turn, bend, self.way_by_both_m),
            bend_slope_nm: slope(bend, bend, self.way_by_bends_m),
        }
    }
}

/// Returns d(θ) and its first two derivatives, from the series `−Σ (−θ²/4)^m·(m + 1)/(2m + 3)!`, which is exact to 1e-7 up to 3 rad.
fn shape(bend_rad: f64) -> [f64; 3] {
    const TERMS: [f64; 6] = [
        -1.0 / 6.0,
        1.0 / 240.0,
        -1.0 / 26_880.0,
        1.0 / 5_806_080.0,
        -1.0 / 2_043_740_160.0,
        1.0 / 1_062_744_883_200.0,
    ];
    let square = bend_rad * bend_rad;
    // Value and derivatives with respect to the square.
    let mut of_square = [0.0; 3];
    for term in TERMS.into_iter().rev() {
        let [value, slope, curvature] = of_square;
        of_square = [term + square * value, value + square * slope, 2.0 * slope + square * curvature];
    }
    let [value, slope, curvature] = of_square;
    [value, 2.0 * bend_rad * slope, 2.0 * slope + 4.0 * square * curvature]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::turned;

    const LENGTH_M: f64 = 0.05;
    const STIFFNESS_N_M2: f64 = 0.003;

    fn at(turn_rad: f64, bend_rad: f64, force_n: Vector2<f64>) -> Deflection {
        let middle_rad = turn_rad + 0.5 * bend_rad;
        let chord_m = 0.03 * Vector2::new(libm::cos(middle_rad), libm::sin(middle_rad));
        Deflection::new(chord_m, (LENGTH_M, STIFFNESS_N_M2), bend_rad, force_n)
    }

    /// The end of a backbone with the stated direction, by summation along it.
    fn end_m(bend_rad: f64, skew_rad: f64) -> Vector2<f64> {
        const PARTS: u32 = 4000;
        (0..PARTS).fold(Vector2::zeros(), |sum, part| {
            let u = (f64::from(part) + 0.5) / f64::from(PARTS);
            let angle_rad = bend_rad * u + skew_rad * (u * u - u);
            sum + LENGTH_M / f64::from(PARTS) * Vector2::new(libm::cos(angle_rad), libm::sin(angle_rad))
        })
    }

    #[test]
    fn the_end_moves_as_by_summation() {
        for bend_rad in [-2.9, -0.7, 0.0, 0.05, 1.3, 3.0] {
            let summed_m = (end_m(bend_rad, 1e-4) - end_m(bend_rad, -1e-4)) / 2e-4;
            assert!((at(0.0, bend_rad, Vector2::zeros()).way_m - summed_m).norm() < 1e-8, "{bend_rad}");
            let turned_m = turned((libm::sin(0.8), libm::cos(0.8)), summed_m);
            assert!((at(0.8, bend_rad, Vector2::zeros()).way_m - turned_m).norm() < 1e-8, "{bend_rad}");
        }
    }

    #[test]
    fn the_moments_are_the_derivatives_of_the_energy() {
        let h = 1e-5;
        for force_n in [Vector2::new(0.02, -0.03), Vector2::new(-3.0, 9.0)] {
            // The energy whose derivative with respect to g is the skew.
            let energy_nm = |turn_rad: f64, bend_rad: f64| {
                let work_nm = at(turn_rad, bend_rad, force_n).way_m.dot(&force_n);
                let linear_rad = 3.0 * LENGTH_M / STIFFNESS_N_M2 * work_nm;
                let limit = (1.0 + (linear_rad / GREATEST_SKEW_RAD).powi(2)).sqrt();
                work_nm * linear_rad / (1.0 + limit)
            };
            for (turn_rad, bend_rad) in [(0.0, 0.0), (0.4, 0.3), (-1.0, 1.8), (2.0, -2.6)] {
                let moments = |turn_rad: f64, bend_rad: f64| at(turn_rad, bend_rad, force_n).moments();
                let found = moments(turn_rad, bend_rad);
                let slope = |of: &dyn Fn(f64) -> f64| (of(h) - of(-h)) / (2.0 * h);
                let near = |value: f64, expected: f64| (value - expected).abs() < 1e-6 * force_n.norm();
                assert!(near(found.turn_nm, slope(&|h| energy_nm(turn_rad + h, bend_rad))));
                assert!(near(found.bend_nm, slope(&|h| energy_nm(turn_rad, bend_rad + h))));
                assert!(near(found.turn_slope_nm, slope(&|h| moments(turn_rad + h, bend_rad).turn_nm)));
                assert!(near(found.both_slope_nm, slope(&|h| moments(turn_rad, bend_rad + h).turn_nm)));
                assert!(near(found.both_slope_nm, slope(&|h| moments(turn_rad + h, bend_rad).bend_nm)));
                assert!(near(found.bend_slope_nm, slope(&|h| moments(turn_rad, bend_rad + h).bend_nm)));
                for (turn, bend) in [(1.0, 0.0), (0.3, -0.7)] {
                    let shift_m = |h: f64| at(turn_rad + turn * h, bend_rad + bend * h, force_n).shift_m();
                    let expected_m = (shift_m(h) - shift_m(-h)) / (2.0 * h);
                    let change_m = at(turn_rad, bend_rad, force_n).shift_change_m(turn, bend);
                    assert!((change_m - expected_m).norm() < 1e-8, "{change_m} {expected_m}");
                }
            }
        }
    }
}
