//! Admittance control: converts the wrench of a hand to a motion of the platform, in six axes.
//!
//! It produces set points in a control loop whose wrench comes from compensated cable forces
//! ([`CycleOutput::applied_wrench`](crate::CycleOutput::applied_wrench)). It moves no winch, and the only workspace limit that it knows is its reach.
//! A non-finite wrench counts as none and is reported. State: two numbers per axis.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3, Vector6};

use crate::platform::{Pose, Wrench};
use crate::robot::{ParamError, check};

/// Wrench components beyond this are invalid, N and N m.
const GREATEST_WRENCH: f64 = 1e9;
/// Greatest `C·T²/I`.
const GREATEST_SPRING: f64 = 10.0;
/// Greatest `D·T/I`.
const GREATEST_DRAG: f64 = 100.0;

/// Options of the virtual body: diagonal in base axes, in x, y, z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdmittanceOptions {
    /// Virtual mass, kg, 10⁻⁶…10⁶.
    pub mass_kg: [f64; 3],
    /// Virtual damping, N s/m, 0…10⁹.
    pub damping_n_s_per_m: [f64; 3],
    /// Virtual spring towards the rest pose, N/m, 0…10⁹; with 0 the platform stays where it is led.
    pub stiffness_n_per_m: [f64; 3],
    /// Greatest displacement from the rest pose on each axis, m, 10⁻⁶…10⁴.
    pub reach_m: f64,
    /// Virtual inertia, kg m², 10⁻⁹…10⁶.
    pub inertia_kg_m2: [f64; 3],
    /// Virtual rotational damping, N m s/rad, 0…10⁹.
    pub damping_nm_s_per_rad: [f64; 3],
    /// Virtual rotational spring, N m/rad, 0…10⁹.
    pub stiffness_nm_per_rad: [f64; 3],
    /// Greatest rotation about each axis, rad, 10⁻⁶…3.
    pub reach_rad: f64,
}

/// Set point of one cycle. All numbers are finite, whatever the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetPoint {
    /// Pose of the platform.
    pub pose: Pose,
    /// Displacement from the rest pose: x, y, z in m, and the rotation vector in rad, base axes.
    pub displacement: Vector6<f64>,
    /// Rate of the displacement, m/s and rad/s.
    pub rate: Vector6<f64>,
    /// Whether a valid wrench was given; without one, the virtual body moves as if nobody pushed it.
    pub wrench_used: bool,
}

/// A virtual body of inertia I, damping D and stiffness C under a wrench, \[P\] 20:
///
/// `I·ẍ + D·ẋ + C·x = w`
///
/// | symbol | identifier | unit | range |
/// |---|---|---|---|
/// | I | `mass_kg`, `inertia_kg_m2` | kg, kg m² | > 0 |
/// | D | `damping_n_s_per_m`, `damping_nm_s_per_rad` | N s/m, N m s/rad | ≥ 0 |
/// | C | `stiffness_n_per_m`, `stiffness_nm_per_rad` | N/m, N m/rad | ≥ 0 |
/// | x | [`SetPoint::displacement`] | m, rad | ± reach |
/// | w | the wrench on the platform, gravity left out, base axes | N, N m | |
///
/// Each axis is advanced by its exact solution over a cycle with a constant wrench: `[x; ẋ] ← Φ·[x; ẋ] + Γ·w`, with Φ and Γ from the matrix
/// exponential at set-up. Every eigenvalue of Φ is therefore `e^{λT}` of an eigenvalue of the equation, which lies left of or on the imaginary axis:
/// no accepted parameters make the virtual body unstable by itself. (In a loop with a real robot, delays can.) Set-up refuses a body that the cycle
/// does not resolve: it requires `C·T²/I ≤ 10`, which is a natural period of at least two cycles, and `D·T/I ≤ 100`. At the end of its reach an axis
/// stands still until it is pushed back.
///
/// Deviation from \[P\]: I, D and C are diagonal; rotations are described by the rotation vector from the rest orientation, whose rate equals the
/// angular velocity for small rotations.
///
/// ```
/// use fric_core::admittance::{Admittance, AdmittanceOptions};
/// use fric_core::{Pose, Wrench};
///
/// # fn main() -> Result<(), fric_core::ParamError> {
/// let options = AdmittanceOptions {
///     mass_kg: [2.0; 3],
///     damping_n_s_per_m: [40.0; 3],
///     stiffness_n_per_m: [100.0; 3],
///     reach_m: 0.2,
///     inertia_kg_m2: [0.01; 3],
///     damping_nm_s_per_rad: [0.2; 3],
///     stiffness_nm_per_rad: [0.5; 3],
///     reach_rad: 0.3,
/// };
/// let mut admittance = Admittance::new(&options, 0.001, &Pose::identity())?;
/// let push = Wrench { force_n: [5.0, 0.0, 0.0].into(), ..Wrench::default() };
/// let set_point = (0..10_000).map(|_| admittance.step(Some(&push))).last();
/// // At rest the spring bears the push: 5 N / 100 N/m.
/// assert!(set_point.is_some_and(|at| (at.pose.position_m.x - 0.05).abs() < 1e-6));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Admittance {
    axes: [Axis; 6],
    rest: Pose,
}

/// One axis: its exact step and its state.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// Φ, row by row.
    transition: [[f64; 2]; 2],
    /// Γ.
    of_wrench: [f64; 2],
    reach: f64,
    displacement: f64,
    rate: f64,
}

impl Axis {
    const STILL: Self =
        Self { transition: [[1.0, 0.0], [0.0, 1.0]], of_wrench: [0.0; 2], reach: 0.0, displacement: 0.0, rate: 0.0 };

    /// Creates an axis; `None` for a body that the cycle does not resolve.
    fn new(inertia: f64, damping: f64, stiffness: f64, reach: f64, cycle_s: f64) -> Option<Self> {
        let spring = stiffness * cycle_s * cycle_s / inertia;
        let drag = damping * cycle_s / inertia;
        if spring > GREATEST_SPRING || drag > GREATEST_DRAG {
            return None;
        }
        // T·d/dt [x, T·ẋ, T²·w/I] with constant w: dimensionless numbers, none of them large. Its exponential contains Φ and Γ.
        #[rustfmt::skip]
        let step = exponential(&Matrix3::new(
            0.0, 1.0, 0.0,
            -spring, -drag, 1.0,
            0.0, 0.0, 0.0,
        ));
        Some(Self {
            transition: [[step.m11, step.m12 * cycle_s], [step.m21 / cycle_s, step.m22]],
            of_wrench: [step.m13 * cycle_s * cycle_s / inertia, step.m23 * cycle_s / inertia],
            reach,
            ..Self::STILL
        })
    }

    fn step(&mut self, wrench: f64) {
        let [[xx, xv], [vx, vv]] = self.transition;
        let [xw, vw] = self.of_wrench;
        let displacement = xx * self.displacement + xv * self.rate + xw * wrench;
        let rate = vx * self.displacement + vv * self.rate + vw * wrench;
        self.displacement = displacement.max(-self.reach).min(self.reach);
        let outward = displacement.abs() > self.reach && rate * displacement > 0.0;
        self.rate = if outward { 0.0 } else { rate };
    }
}

/// Returns `e^M`: Taylor's series of M/2^k, squared k times, with ‖M/2^k‖ ≤ 1/2, where 20 terms leave less than rounding.
fn exponential(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let norm = matrix.row_iter().map(|row| row.abs().sum()).fold(0.0, f64::max);
    let halvings = if norm > 0.5 { libm::ceil(libm::log2(2.0 * norm)) } else { 0.0 };
    let scaled = matrix * libm::exp2(-halvings);
    let (mut term, mut sum) = (Matrix3::identity(), Matrix3::identity());
    for order in 1..=20 {
        term = term * scaled / f64::from(order);
        sum += term;
    }
    let mut left = halvings;
    while left > 0.0 {
        sum *= sum;
        left -= 1.0;
    }
    sum
}

/// Returns the rotation for a rotation vector, rad, using functions of the `libm` crate, so that its bits are the same everywhere.
fn rotation(turn: &Vector3<f64>) -> UnitQuaternion<f64> {
    let angle = libm::sqrt(turn.norm_squared());
    // sin(φ/2)/φ; below 10⁻⁴ the error of the series is less than rounding.
    let share = if angle < 1e-4 { 0.5 - angle * angle / 48.0 } else { libm::sin(0.5 * angle) / angle };
    UnitQuaternion::new_unchecked(Quaternion::from_parts(libm::cos(0.5 * angle), turn * share))
}

impl Admittance {
    /// Creates a virtual body at rest at `rest`, advanced by `cycle_s` (10⁻⁶…10 s) in each step.
    ///
    /// # Errors
    /// Returns a [`ParamError`] for the first value that is not finite, out of its range or inconsistent with the cycle time, and for an invalid rest
    /// pose.
    pub fn new(options: &AdmittanceOptions, cycle_s: f64, rest: &Pose) -> Result<Self, ParamError> {
        check("cycle_s", cycle_s, 1e-6, 10.0)?;
        if !rest.is_usable() {
            return Err(ParamError::conflict("rest", "is no pose: not finite, or a quaternion far from norm 1"));
        }
        check("reach_m", options.reach_m, 1e-6, 1e4)?;
        check("reach_rad", options.reach_rad, 1e-6, 3.0)?;
        let translation = (
            ("mass_kg", options.mass_kg, 1e-6),
            ("damping_n_s_per_m", options.damping_n_s_per_m),
            ("stiffness_n_per_m", options.stiffness_n_per_m),
            options.reach_m,
        );
        let rotation = (
            ("inertia_kg_m2", options.inertia_kg_m2, 1e-9),
            ("damping_nm_s_per_rad", options.damping_nm_s_per_rad),
            ("stiffness_nm_per_rad", options.stiffness_nm_per_rad),
            options.reach_rad,
        );
        let mut axes = [Axis::STILL; 6];
        for (half, (inertia, damping, stiffness, reach)) in axes.chunks_exact_mut(3).zip([translation, rotation]) {
            let of_axes = inertia.1.into_iter().zip(damping.1).zip(stiffness.1);
            for (axis, ((i, d), c)) in half.iter_mut().zip(of_axes) {
                check(inertia.0, i, inertia.2, 1e6)?;
                check(damping.0, d, 0.0, 1e9)?;
                check(stiffness.0, c, 0.0, 1e9)?;
                let reason =
                    "is too small for this damping or stiffness: the cycle does not resolve the motion; raise it";
                *axis = Axis::new(i, d, c, reach, cycle_s).ok_or(ParamError::conflict(inertia.0, reason))?;
            }
        }
        Ok(Self { axes, rest: *rest })
    }

    /// Resets the body to rest at a pose. An invalid pose keeps the present rest pose.
    pub fn reset(&mut self, rest: &Pose) {
        if rest.is_usable() {
            self.rest = *rest;
        }
        for axis in &mut self.axes {
            (axis.displacement, axis.rate) = (0.0, 0.0);
        }
    }

    /// Runs one cycle under a wrench without gravity. Total over all inputs, allocation-free, panic-free.
    pub fn step(&mut self, wrench: Option<&Wrench>) -> SetPoint {
        let usable = |wrench: &Vector6<f64>| wrench.iter().all(|component| component.abs() <= GREATEST_WRENCH);
        let wrench = wrench.map(Wrench::to_vector).filter(usable);
        for (axis, component) in self.axes.iter_mut().zip(wrench.unwrap_or_default().iter()) {
            axis.step(*component);
        }
        self.set_point(wrench.is_some())
    }

    fn set_point(&self, wrench_used: bool) -> SetPoint {
        let of_axes = |of: fn(&Axis) -> f64| Vector6::from(self.axes.each_ref().map(of));
        let (displacement, rate) = (of_axes(|axis| axis.displacement), of_axes(|axis| axis.rate));
        let turn = Vector3::new(displacement.w, displacement.a, displacement.b);
        let pose = Pose {
            position_m: self.rest.position_m + Vector3::new(displacement.x, displacement.y, displacement.z),
            orientation: rotation(&turn) * self.rest.orientation,
        };
        SetPoint { pose, displacement, rate, wrench_used }
    }
}
