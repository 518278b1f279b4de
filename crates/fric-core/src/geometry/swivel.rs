//! The last pulley before the platform: it swivels about the incoming cable, so its wrap follows the pose.
//!
//! It computes the direction in which the cable leaves from the attachment point in the base frame, and the normal-force factor of the wrap, by
//! vector algebra alone (three square roots, a division, no angle); outside the cycle also wrap angle and cable length. No state. Non-finite input
//! gives non-finite output; the caller excludes it.
//!
//! In the plane through the swivel axis and the attachment B, with the tangent point A where the cable enters as origin, `x` the distance from the
//! axis and `z` along it: `M = (r, 0)`, `D = |B − M|`, `φ = atan2(z_B, x_B − r)`, `γ = arccos(r/D)`; wrap `β = π − (φ + γ)`, free length `√(D² −
//! r²)`, tangent point `M + r(cos(φ+γ), sin(φ+γ))`. Source: the standard model of a swivelling pulley, which \[P\] 1 uses for `a_i(r, R)`. The
//! implementation avoids the angles: `cos(φ+γ) = ((x_B − r)·r − z_B·free)/D²`, `sin(φ+γ) = (z_B·r + (x_B − r)·free)/D²`.

use nalgebra::Vector3;

use crate::scalar::{Mask, Scalar};

/// A swivelling pulley as the cycle uses it: entry point, axis, radius, with one lane per cable.
#[derive(Clone, Copy, Debug)]
pub struct Swivel<T> {
    /// Tangent point A where the cable enters, base frame, m.
    pub entry_m: [T; 3],
    /// Unit vector of the entering cable's direction.
    pub axis: [T; 3],
    /// Radius of the cable's centre line, m; 0 is an eyelet.
    pub radius_m: T,
}

/// The exit of the cable from the pulley.
#[derive(Clone, Copy, Debug)]
pub struct Exit<T: Scalar> {
    /// Unit vector from the attachment on the platform to the point where the cable leaves the pulley.
    pub direction: [T; 3],
    /// Distance from that point to the attachment, m.
    pub free_length_m: T,
    /// `2 sin(β/2)` of the wrap β.
    pub wrap_factor: T,
    /// `cos β` and `sin β`, for [`wrap_rad`].
    pub cos_sin_wrap: [T; 2],
    /// False if the attachment lies inside the pulley's circle (`D ≤ r`), or on the axis behind it; the other fields are meaningless then.
    pub reachable: T::Mask,
}

/// Squared lengths below this (1 nm²) count as on the axis, or on the circle.
const NEAR_SQUARED_M2: f64 = 1e-18;

/// Returns the exit of a swivelling pulley to the attachment at `attachment_m` (base frame, m).
///
/// Straight ahead (`x_B = 0`) the wrap is zero and the direction is the axis itself.
#[inline(always)]
pub fn exit<T: Scalar>(swivel: &Swivel<T>, attachment_m: [T; 3]) -> Exit<T> {
    let (one, zero) = (T::splat(1.0), T::splat(0.0));
    let radius = swivel.radius_m;
    let relative = sub(attachment_m, swivel.entry_m);
    let along = dot(relative, swivel.axis);
    let [ax, ay, az] = swivel.axis.map(|part| part * along);
    let radial = sub(relative, [ax, ay, az]);
    let distance_squared = dot(radial, radial);
    let distance = distance_squared.sqrt();
    let from_centre = distance - radius;
    let to_centre_squared = from_centre * from_centre + along * along;
    let free_squared = to_centre_squared - radius * radius;
    let off_axis = T::splat(NEAR_SQUARED_M2).lt(distance_squared);
    // On the axis behind a pulley there is no plane to swivel into.
    let reachable = T::splat(NEAR_SQUARED_M2).lt(free_squared).and(off_axis.or(zero.lt(along)).or(radius.le(zero)));
    let free = T::select(reachable, free_squared, one).sqrt();
    // One division gives both reciprocals, of D² and of the distance from the axis.
    let to_centre_squared = T::select(reachable, to_centre_squared, one);
    let off_axis_distance = T::select(off_axis, distance, one);
    let inverse_both = one / (to_centre_squared * off_axis_distance);
    let inverse_centre = inverse_both * off_axis_distance;
    let cos = (from_centre * radius - along * free) * inverse_centre;
    let sin = (along * radius + from_centre * free) * inverse_centre;
    // The cable is a tangent: (T − B)/free = (−sin, cos) in the plane; e_x is the radial direction, which is undefined on the axis.
    let across = (-(sin * (inverse_both * to_centre_squared))).keep(off_axis);
    let [rx, ry, rz] = radial;
    let [ux, uy, uz] = swivel.axis;
    let direction = [rx * across + ux * cos, ry * across + uy * cos, rz * across + uz * cos];
    let doubled = (one + cos) * T::splat(2.0);
    Exit { direction, free_length_m: free, wrap_factor: doubled.max(zero).sqrt(), cos_sin_wrap: [-cos, sin], reachable }
}

/// Returns the wrap angle β in rad, `0…2π`, from [`Exit::cos_sin_wrap`]. It needs an inverse tangent; the cycle calls it only for robots with a slip
/// limit.
#[must_use]
pub fn wrap_rad([cos, sin]: [f64; 2]) -> f64 {
    let angle_rad = libm::atan2(sin, cos);
    // Rounding may make a vanishing wrap slightly negative; an angle beyond that is a wrap of more than 180°.
    if angle_rad < -1e-6 { angle_rad + core::f64::consts::TAU } else { angle_rad.max(0.0) }
}

/// Returns the cable length from the entry point to the attachment, `r·β + free`, m; `None` if the attachment lies inside the pulley. Not for the
/// cycle, because it needs an inverse tangent.
#[must_use]
pub fn cable_length_m(swivel: &Swivel<f64>, attachment_m: &Vector3<f64>) -> Option<f64> {
    let exit = exit(swivel, [attachment_m.x, attachment_m.y, attachment_m.z]);
    exit.reachable.then(|| swivel.radius_m * wrap_rad(exit.cos_sin_wrap) + exit.free_length_m)
}

#[inline(always)]
fn sub<T: Scalar>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot<T: Scalar>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
