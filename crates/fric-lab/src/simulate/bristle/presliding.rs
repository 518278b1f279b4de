//! Solves one implicit stage of a bristle's deflection for any exponent of Dahl's law.
//!
//! Equation: `z = b + h·v·g(u)`, `u = 1 − s·σ·z/f_c`, `g(u) = sgn(u)·|u|^a`. Symbols: `b` `base_m`, `h·v` `travel_m` with sign s, σ
//! `stiffness_n_per_m`, `f_c` `sliding_n`, a `exponent`. Source: \[P\] 16, which omits the sign of u: beyond `f_c` (after the load has fallen) the
//! bristle relaxes faster than the cable moves.
//!
//! With `k = σ·|h·v|/f_c` and `u_b` belonging to b, the equation is `u + k·g(u) = u_b`, which increases with u: there is one solution, with the sign
//! of `u_b`.

/// Maximum number of Newton steps on an increasing convex function. From the second step on, the iterates approach the solution from above without
/// passing it.
const MOST_STEPS: u32 = 60;
/// Relative change of u that ends the iteration; the next step would be its square.
const SETTLED: f64 = 1e-9;

/// Returns the deflection at the end of the stage, m, starting from a guess. A bearing that holds no friction relaxes its bristle at once.
pub fn stage(base_m: f64, travel_m: f64, stiffness_n_per_m: f64, sliding_n: f64, exponent: f64, guess_m: f64) -> f64 {
    let give_n = travel_m.abs() * stiffness_n_per_m;
    if sliding_n <= 0.0 {
        return 0.0;
    }
    #[expect(clippy::float_cmp, reason = "exactly the paper's law, which has a closed form")]
    if exponent == 1.0 {
        return sliding_n * (base_m + travel_m) / (sliding_n + give_n);
    }
    let stiffness_per_m = travel_m.signum() * stiffness_n_per_m / sliding_n;
    let base = 1.0 - stiffness_per_m * base_m;
    let guess = base.signum() * (1.0 - stiffness_per_m * guess_m);
    let left = base.signum() * remaining(base.abs(), give_n / sliding_n, exponent, guess);
    (1.0 - left) / stiffness_per_m
}

/// Returns the solution `u ≥ 0` of `u + k·u^a = base` for `base ≥ 0`.
///
/// The equation is solved for u or `u^a`, whichever makes it convex: `w^p + …` with `p ≥ 1`.
fn remaining(base: f64, give: f64, exponent: f64, guess: f64) -> f64 {
    let power = exponent.max(1.0 / exponent);
    // (weight of w, weight of w^p)
    let (linear, curved) = if exponent >= 1.0 { (1.0, give) } else { (give, 1.0) };
    let farthest = base / linear;
    let guess = if exponent >= 1.0 { guess } else { libm::pow(guess.max(0.0), exponent) };
    let mut root = if guess > 0.0 { guess.min(farthest) } else { farthest };
    for _ in 0..MOST_STEPS {
        if root <= 0.0 {
            return 0.0;
        }
        let raised = libm::pow(root, power);
        let excess = linear * root + curved * raised - base;
        let step = excess / (linear + curved * power * raised / root);
        root -= step;
        if step.abs() <= SETTLED * root {
            break;
        }
    }
    if exponent >= 1.0 { root } else { libm::pow(root, power) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_equation_is_solved_for_every_exponent() {
        for exponent in [0.3, 0.5, 0.9, 1.0, 1.3, 1.8, 3.0] {
            for travel_m in [1e-9, -1e-6, 3e-5, -1e-3] {
                let bases_m = [-3e-4, -1e-5, 0.0, 1e-5, 1.9e-4, 2e-4, 3e-4];
                for (base_m, guess_m) in bases_m.into_iter().flat_map(|base_m| [(base_m, base_m), (base_m, 1e-4)]) {
                    let (stiffness, sliding_n) = (1000.0, 0.2);
                    let end_m = stage(base_m, travel_m, stiffness, sliding_n, exponent, guess_m);
                    let u = 1.0 - travel_m.signum() * stiffness * end_m / sliding_n;
                    let given_m = travel_m * u.signum() * u.abs().powf(exponent);
                    let miss_m = (end_m - base_m - given_m).abs();
                    assert!(miss_m < 1e-16 + 1e-10 * travel_m.abs(), "{exponent} {travel_m} {base_m}: {miss_m}");
                }
            }
        }
    }

    #[test]
    fn an_exponent_close_to_one_is_the_closed_form() {
        let at = |exponent| stage(1e-5, 2e-5, 1000.0, 0.2, exponent, 0.0);
        assert!((at(1.0 + 1e-9) - at(1.0)).abs() < 1e-13);
        assert!((at(1.0 - 1e-9) - at(1.0)).abs() < 1e-13);
    }

    #[test]
    fn without_load_the_bristle_relaxes() {
        for exponent in [0.5, 1.0, 2.0] {
            assert!(stage(1e-4, 1e-5, 1000.0, 0.0, exponent, 1e-4).abs() < 1e-300);
            assert!(stage(1e-4, 1e-5, 1e9, 0.2, exponent, 1e-4).is_finite());
        }
    }
}
