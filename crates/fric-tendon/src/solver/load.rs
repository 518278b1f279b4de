//! Weight and tip load: the balance of forces and moments from the tip to the base, \[C\] 8–10.

use nalgebra::Vector2;

use super::arc::Arc;
use super::deflection::Deflection;
use crate::params::ManipulatorParams;
use crate::shape::turned;

/// The effect of the external loads on each segment.
///
/// `Q_i` is the moment of everything beyond a cross-section of segment i, averaged over the segment: for dead loads W at points p it is `Q_i = Σ (p −
/// c_i) × W` with the centroid `c_i` of the segment's arc, plus the contribution of the segment's own weight and those of the deflections
/// ([`Deflection`]) of this segment and all beyond. It is the derivative of the work with respect to the bend, so its own derivative is symmetric:
/// `∂Q_i/∂θ_j` depends only on the segment nearer to the tip.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "the unit")]
pub struct Moments<const DISKS: usize> {
    /// `Q_i`, N m.
    pub moment_nm: [f64; DISKS],
    /// `∂Q_i/∂θ_j` for `j < i`, also with i and j exchanged, N m.
    pub slope_nm: [f64; DISKS],
    /// `∂Q_i/∂θ_i`, N m.
    pub own_slope_nm: [f64; DISKS],
}

/// Returns the centres of the disks, base frame.
pub fn positions<const DISKS: usize>(params: &ManipulatorParams, bend_rad: &[f64; DISKS]) -> [[f64; 2]; DISKS] {
    let has_load = params.has_load();
    let mut place_m = Vector2::zeros();
    let mut turn = (0.0, 1.0);
    let mut position_m = [[0.0; 2]; DISKS];
    let segments = params.pitch_m.iter().zip(&params.segment_stiffness_n_m2).zip(&params.middle_force_n).zip(bend_rad);
    for (position_m, (((pitch_m, stiffness_n_m2), force_n), bend_rad)) in position_m.iter_mut().zip(segments) {
        let arc = Arc::new(*pitch_m, *bend_rad);
        let chord_m = turned(turn, arc.end_m);
        place_m += chord_m;
        if has_load {
            place_m += Deflection::new(chord_m, (*pitch_m, *stiffness_n_m2), *bend_rad, *force_n).shift_m();
        }
        turn = turned_further(turn, arc.turn);
        *position_m = place_m.into();
    }
    position_m
}

/// Combines two rotations, given as sine and cosine.
pub fn turned_further((sin, cos): (f64, f64), (other_sin, other_cos): (f64, f64)) -> (f64, f64) {
    (sin * other_cos + cos * other_sin, cos * other_cos - sin * other_sin)
}

/// Returns the moments of weight and tip load, multiplied by `share`.
pub fn moments<const DISKS: usize>(params: &ManipulatorParams, bend_rad: &[f64; DISKS], share: f64) -> Moments<DISKS> {
    #[derive(Clone, Copy)]
    #[expect(clippy::struct_field_names, reason = "the unit")]
    struct Segment {
        chord_m: Vector2<f64>,
        end_m: Vector2<f64>,
        centroid_m: Vector2<f64>,
        slope_m: Vector2<f64>,
        curvature_m: Vector2<f64>,
    }
    let count = params.disk_count.min(DISKS);
    let mut place_m = Vector2::zeros();
    let mut turn = (0.0, 1.0);
    let none_m = Vector2::zeros();
    let none = Segment { chord_m: none_m, end_m: none_m, centroid_m: none_m, slope_m: none_m, curvature_m: none_m };
    let mut segments = [none; DISKS];
    for (segment, (pitch_m, bend_rad)) in segments.iter_mut().zip(params.pitch_m().iter().zip(bend_rad)) {
        let arc = Arc::new(*pitch_m, *bend_rad);
        let chord_m = turned(turn, arc.end_m);
        *segment = Segment {
            chord_m,
            end_m: place_m + chord_m,
            centroid_m: place_m + turned(turn, arc.centroid_m),
            slope_m: turned(turn, arc.centroid_slope_m),
            curvature_m: turned(turn, arc.centroid_curvature_m),
        };
        place_m = segment.end_m;
        turn = turned_further(turn, arc.turn);
    }
    let mut moments = Moments { moment_nm: [0.0; DISKS], slope_nm: [0.0; DISKS], own_slope_nm: [0.0; DISKS] };
    // Sums over the loads beyond: W, p × W and p · W.
    let mut force_n = Vector2::zeros();
    let mut cross_nm = 0.0;
    let mut dot_nm = 0.0;
    let add = |sums: (&mut Vector2<f64>, &mut f64, &mut f64), at_m: Vector2<f64>, load_n: Vector2<f64>| {
        *sums.0 += load_n;
        *sums.1 += at_m.perp(&load_n);
        *sums.2 += at_m.dot(&load_n);
    };
    let mut next_n = share * (params.disk_weight_n + params.tip_force_n);
    // Moment of the deflections beyond, and its slope.
    let (mut deflection_nm, mut deflection_slope_nm) = (0.0, 0.0);
    let rows = moments.moment_nm.iter_mut().zip(&mut moments.slope_nm).zip(&mut moments.own_slope_nm);
    let backbone = params.pitch_m.iter().zip(&params.segment_stiffness_n_m2).zip(&params.middle_force_n).zip(bend_rad);
    let weights = segments.iter().zip(&params.backbone_weight_n).zip(backbone);
    for (((moment, slope), own_slope), ((segment, weight_n), backbone)) in rows.zip(weights).take(count).rev() {
        let (((pitch_m, stiffness_n_m2), force_middle_n), bend_rad) = backbone;
        let deflection =
            Deflection::new(segment.chord_m, (*pitch_m, *stiffness_n_m2), *bend_rad, share * force_middle_n).moments();
        let own_n = share * weight_n;
        add((&mut force_n, &mut cross_nm, &mut dot_nm), segment.end_m, next_n);
        let turning_nm = dot_nm - segment.centroid_m.dot(&force_n);
        *moment = cross_nm - segment.centroid_m.perp(&force_n)
            + segment.slope_m.dot(&own_n)
            + deflection_nm
            + deflection.bend_nm;
        *slope = segment.slope_m.perp(&own_n) - turning_nm + deflection_slope_nm + deflection.both_slope_nm;
        *own_slope = segment.curvature_m.dot(&own_n) - segment.slope_m.perp(&force_n) - turning_nm
            + deflection_slope_nm
            + deflection.bend_slope_nm;
        deflection_nm += deflection.turn_nm;
        deflection_slope_nm += deflection.turn_slope_nm;
        add((&mut force_n, &mut cross_nm, &mut dot_nm), segment.centroid_m, own_n);
        next_n = share * params.disk_weight_n;
    }
    moments
}
