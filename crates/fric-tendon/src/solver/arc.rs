//! One segment: a backbone of constant curvature between two disks, a straight tendon between their holes. The deflection under a transverse load
//! comes on top ([`super::deflection`]).
//!
//! All quantities are functions of the segment's bend θ, through the Stumpff functions `c_k = Σ_m (−θ²)^m/(2m + k)!`: `c_0 = cos θ`, `c_1 = sin θ/θ`,
//! `c_2 = (1 − cos θ)/θ²`, … They have no 0/0 in the straight segment, and `dc_k/dθ = θ(k·c_{k+2} − c_{k+1})`. Up to [`GREATEST_BEND_RAD`] the series
//! below are exact to rounding.

use nalgebra::Vector2;

/// Greatest bend of one segment in either direction, rad.
pub const GREATEST_BEND_RAD: f64 = 3.0;

/// Returns `c_0 … c_7` of an angle.
fn stumpff(angle_rad: f64) -> [f64; 8] {
    const TERMS: u32 = 12;
    let square = angle_rad * angle_rad;
    // c_k = 1/k! · (1 − x/((k+1)(k+2)) · (1 − x/((k+3)(k+4)) · (…))), x = θ².
    let series = |order: f64| {
        (0..TERMS).rev().fold(1.0, |inner, term| {
            let place = order + 2.0 * f64::from(term);
            1.0 - square / ((place + 1.0) * (place + 2.0)) * inner
        })
    };
    let c7 = series(7.0) / 5040.0;
    let c6 = series(6.0) / 720.0;
    let c5 = 1.0 / 120.0 - square * c7;
    let c4 = 1.0 / 24.0 - square * c6;
    let c3 = 1.0 / 6.0 - square * c5;
    let c2 = 0.5 - square * c4;
    [1.0 - square * c2, 1.0 - square * c3, c2, c3, c4, c5, c6, c7]
}

/// The straight tendon between the holes of two neighbouring disks.
///
/// `ℓ = (L − rθ)·sin(θ/2)/(θ/2)` is the chord of the arc of radius `L/θ − r`. Its moment arm `m = −dℓ/dθ` is the shortening of the tendon per bend
/// and therefore, by virtual work, the moment of a unit tension, averaged over the segment.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "the unit")]
pub struct Chord {
    /// ℓ, m.
    pub length_m: f64,
    /// m, m.
    pub arm_m: f64,
    /// dm/dθ, m.
    pub arm_slope_m: f64,
}

impl Chord {
    /// The chord of a segment that does not exist.
    pub const NONE: Self = Self { length_m: 0.0, arm_m: 0.0, arm_slope_m: 0.0 };

    /// Returns the chords of the tendons on both sides of a backbone of length L, with holes at the distance r (towards +y, then −y), for the bend θ.
    pub fn both(length_m: f64, hole_m: f64, bend_rad: f64) -> [Self; 2] {
        let half_rad = 0.5 * bend_rad;
        let [_, c1, c2, c3, c4, c5, ..] = stumpff(half_rad);
        let slope = 0.5 * half_rad * (c3 - c2);
        let curvature = 0.25 * ((c3 - c2) + half_rad * half_rad * (3.0 * (c5 - c4) + c3));
        [hole_m, -hole_m].map(|hole_m| {
            let along_m = length_m - hole_m * bend_rad;
            Self {
                length_m: along_m * c1,
                arm_m: hole_m * c1 - along_m * slope,
                arm_slope_m: 2.0 * hole_m * slope - along_m * curvature,
            }
        })
    }
}

/// The backbone of a segment, relative to the disk at its beginning.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    /// sin θ, cos θ.
    pub turn: (f64, f64),
    /// Its end, m.
    pub end_m: Vector2<f64>,
    /// Its centroid, m. Bending the segment rotates everything beyond it about this point.
    pub centroid_m: Vector2<f64>,
    /// Derivative of the centroid with respect to θ, m.
    pub centroid_slope_m: Vector2<f64>,
    /// Its second derivative, m.
    pub centroid_curvature_m: Vector2<f64>,
}

impl Arc {
    /// Computes the arc of a backbone of length L with the bend θ.
    pub fn new(length_m: f64, bend_rad: f64) -> Self {
        let t = bend_rad;
        let [c0, c1, c2, c3, c4, c5, c6, c7] = stumpff(t);
        let d2 = t * (2.0 * c4 - c3);
        let d3 = t * (3.0 * c5 - c4);
        let d4 = t * (4.0 * c6 - c5);
        let d5 = t * (5.0 * c7 - c6);
        let dd2 = (2.0 * c4 - c3) + t * (2.0 * d4 - d3);
        let dd3 = (3.0 * c5 - c4) + t * (3.0 * d5 - d4);
        Self {
            turn: (t * c1, c0),
            end_m: length_m * Vector2::new(c1, t * c2),
            centroid_m: length_m * Vector2::new(c2, t * c3),
            centroid_slope_m: length_m * Vector2::new(d2, c3 + t * d3),
            centroid_curvature_m: length_m * Vector2::new(dd2, 2.0 * d3 + t * dd3),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_and_differences() {
        for bend in [-2.9, -0.7, -1e-3, 0.0, 1e-9, 0.05, 0.4, 1.3, 2.9_f64] {
            let (sin, cos) = Arc::new(0.04, bend).turn;
            assert!((sin - bend.sin()).abs() < 1e-14 && (cos - bend.cos()).abs() < 1e-14, "{bend}");
            let chord = |at: f64| Chord::both(0.04, 0.015, at)[0];
            assert_eq!(chord(-bend).length_m.to_bits(), Chord::both(0.04, 0.015, bend)[1].length_m.to_bits());
            if bend.abs() > 1e-6 {
                let length_m = 2.0 * (0.04 / bend - 0.015) * (0.5 * bend).sin();
                assert!((chord(bend).length_m - length_m).abs() < 1e-15 * (1.0 + 1.0 / bend.abs()), "{bend}");
            }
            let h = 1e-5;
            let slope = (chord(bend + h).length_m - chord(bend - h).length_m) / (2.0 * h);
            assert!((chord(bend).arm_m + slope).abs() < 1e-11);
            let slope = (chord(bend + h).arm_m - chord(bend - h).arm_m) / (2.0 * h);
            assert!((chord(bend).arm_slope_m - slope).abs() < 1e-11);
            // The centroid comes from a summation along the arc, its derivatives from differences.
            let arc = |at: f64| Arc::new(0.04, at);
            let count = 2000;
            let mut sum = Vector2::zeros();
            for place in 0..count {
                let share = (f64::from(place) + 0.5) / f64::from(count);
                let part = share * bend;
                let radius = if bend == 0.0 { f64::INFINITY } else { 0.04 / bend };
                sum += if bend.abs() < 1e-6 {
                    Vector2::new(0.04 * share, 0.0)
                } else {
                    Vector2::new(radius * part.sin(), radius * (1.0 - part.cos()))
                } / f64::from(count);
            }
            assert!((arc(bend).centroid_m - sum).norm() < 1e-8, "{bend}");
            let slope = (arc(bend + h).centroid_m - arc(bend - h).centroid_m) / (2.0 * h);
            assert!((arc(bend).centroid_slope_m - slope).norm() < 1e-11);
            let slope = (arc(bend + h).centroid_slope_m - arc(bend - h).centroid_slope_m) / (2.0 * h);
            assert!((arc(bend).centroid_curvature_m - slope).norm() < 1e-11);
        }
    }
}
