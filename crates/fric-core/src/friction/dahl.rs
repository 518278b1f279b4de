//! Presliding after Dahl: the friction within the first fractions of a millimetre after a reversal.
//!
//! The state is the friction *force* that a contact stores; one step advances it by a displacement (\[P\] 16–17). The law does not depend on time:
//! two half displacements equal one whole. Non-finite input gives non-finite output; the caller must exclude it. State: one number per contact.

use crate::scalar::Scalar;

/// Returns the friction force after a displacement.
///
/// `f ← s·f_c + (f − s·f_c)·exp(−σ|Δl|/f_c)`, the exact solution of `df/dx = σ(1 − s·f/f_c)` over one step.
///
/// | symbol | identifier | unit | range |
/// |---|---|---|---|
/// | `f` | `friction_n`, stored friction force | N | `−f_c…f_c` |
/// | `f_c` | `sliding_n`, friction in steady sliding, held over the step | N | ≥ 0 |
/// | `σ` | `sigma_n_per_m`, presliding stiffness | N/m | > 0 |
/// | `Δl` | `displacement_m`, positive paying out; `s` is its sign | m | |
///
/// Sign convention: see [`pulley`](crate::pulley). Source: \[P\] 16 with exponent 1. The printed (17) has lost a bracket; this is the solution of
/// (16). Deviation: the force is stored, not the ratio `f/f_c`, so that a load change at rest does not change the stored force.
///
/// - At zero displacement the state is unchanged, bit for bit, even if `f_c` has changed.
/// - Saturates at `±f_c`. If `f_c` has dropped below `|f|`, motion brings `f` back without a jump.
/// - `f_c = 0` (no load): any motion releases the contact, `f = 0`.
///
/// ```
/// use fric_core::dahl::dahl_step;
/// // From rest, one presliding distance f_c/σ reaches 1 − 1/e of the sliding friction.
/// let friction_n = dahl_step(0.0, 0.5, 1000.0, 0.5 / 1000.0);
/// assert!((friction_n - 0.5 * (1.0 - (-1.0_f64).exp())).abs() < 1e-15);
/// ```
#[inline(always)]
pub fn dahl_step<T: Scalar>(friction_n: T, sliding_n: T, sigma_n_per_m: T, displacement_m: T) -> T {
    dahl_step_over(friction_n, sliding_n, sigma_n_per_m, displacement_m, |way, _| way)
}

/// Does the same as [`dahl_step`] for another law. `exponential_way` converts a distance in units of `f_c/σ`, together with the preceding `|1 −
/// s·f/f_c|`, to the distance over which the exponential law has the same effect.
#[inline(always)]
pub(crate) fn dahl_step_over<T: Scalar>(
    friction_n: T,
    sliding_n: T,
    sigma_n_per_m: T,
    displacement_m: T,
    exponential_way: impl FnOnce(T, T) -> T,
) -> T {
    let target_n = sliding_n.scale(displacement_m.sign());
    let softness = T::splat(SMALLEST_SLIDING_N).max(sliding_n);
    let way = sigma_n_per_m * displacement_m.abs() / softness;
    let decay = (-exponential_way(way, (friction_n - target_n).abs() / softness)).exp_negative();
    // At rest the target is 0 and the decay 1, so the state is unchanged without a special case. Once the decay vanishes, the state equals the bound,
    // so that |f| ≤ f_c holds exactly.
    target_n + (friction_n - target_n) * decay.keep(T::splat(VANISHED).lt(decay))
}

/// Replaces `f_c = 0` in the quotient; far below any measurable friction.
const SMALLEST_SLIDING_N: f64 = 1e-30;
/// A decay below this counts as zero; it is above the smallest value of [`exp_negative`](crate::scalar::exp_negative).
const VANISHED: f64 = 1e-300;
