//! Friction from measured tensions: along the tendon, and in a single hole.

use super::error::ContinuumError;
use super::fbg::Tension;
use super::gratings::GratingSample;
use super::run::Run;

/// Friction at one hole with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredFriction {
    /// `T_{i−1} − T_i`, N, positive if the base side is tighter.
    pub friction_n: f64,
    /// Its standard error, N.
    pub standard_error_n: f64,
}

impl MeasuredFriction {
    /// Returns −1, +1, or 0 if the friction is within two standard errors.
    #[must_use]
    pub fn direction(&self) -> i8 {
        let bound_n = 2.0 * self.standard_error_n;
        i8::from(self.friction_n > bound_n) - i8::from(self.friction_n < -bound_n)
    }
}

/// Friction at every hole at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionDistribution {
    /// Friction at the holes, starting at the base plate.
    pub holes: Vec<MeasuredFriction>,
    /// Whether both directions occur with certainty, so that no model with one direction can be right.
    pub directions_differ: bool,
}

impl FrictionDistribution {
    /// Computes the friction from the tension at the base and in the segments: differences of neighbours (\[C\] 11), with errors assumed independent.
    #[must_use]
    pub fn new(base: Tension, segments: &[Tension]) -> Self {
        let before = std::iter::once(&base).chain(segments);
        let holes: Vec<MeasuredFriction> = before
            .zip(segments)
            .map(|(before, behind)| MeasuredFriction {
                friction_n: before.value_n - behind.value_n,
                standard_error_n: libm::hypot(before.standard_error_n, behind.standard_error_n),
            })
            .collect();
        let has = |direction: i8| holes.iter().any(|hole| hole.direction() == direction);
        let directions_differ = has(1) && has(-1);
        Self { holes, directions_differ }
    }
}

/// Returns the friction at every hole over a run, from the gratings. The tension at the base counts as exact.
pub fn distributions<'a>(
    run: &'a Run,
    measured: &'a [GratingSample],
) -> impl Iterator<Item = FrictionDistribution> + 'a {
    run.samples().iter().zip(measured).map(|(sample, gratings)| {
        let base = Tension { value_n: sample.tension_base_n, standard_error_n: 0.0 };
        FrictionDistribution::new(base, &gratings.tension)
    })
}

/// One load on a single hole: the tensions on both sides and the angles between them and the normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoleLoad {
    /// F_1, on the side of the load, N.
    pub first_n: f64,
    /// F_2, on the other side, N.
    pub second_n: f64,
    /// θ_1, rad.
    pub first_rad: f64,
    /// θ_2, rad.
    pub second_rad: f64,
}

/// A friction coefficient with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoleCoefficient {
    /// μ.
    pub mu: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// The 95 % confidence interval.
    pub interval: [f64; 2],
    /// Number of loads.
    pub count: usize,
}

/// Fits μ of a single hole to a load run: `f = F_1 − F_2` against `F_N = F_1 cos θ_1 + F_2 cos θ_2` (\[C\] 16, 17).
///
/// The fit is a line through the origin by least squares; the interval is Student's.
///
/// # Errors
/// Returns [`ContinuumError::NoCoefficient`] for fewer than three loads, non-finite numbers, or no normal force.
pub fn hole_coefficient(loads: &[HoleLoad]) -> Result<HoleCoefficient, ContinuumError> {
    let points: Vec<(f64, f64)> = loads
        .iter()
        .map(|load| {
            let normal_n = load.first_n * libm::cos(load.first_rad) + load.second_n * libm::cos(load.second_rad);
            (normal_n, load.first_n - load.second_n)
        })
        .collect();
    let refuse = |reason: &'static str| Err(ContinuumError::NoCoefficient(reason));
    if points.len() < 3 {
        return refuse("fewer than three loads");
    }
    if points.iter().any(|(normal, friction)| !normal.is_finite() || !friction.is_finite()) {
        return refuse("a load is not a finite number");
    }
    let squares: f64 = points.iter().map(|(normal, _)| normal * normal).sum();
    if squares <= 0.0 {
        return refuse("nothing presses on the hole");
    }
    let mu = points.iter().map(|(normal, friction)| normal * friction).sum::<f64>() / squares;
    let residual: f64 = points.iter().map(|(normal, friction)| (friction - mu * normal).powi(2)).sum();
    #[expect(clippy::cast_precision_loss, reason = "a number of loads")]
    let freedom = (points.len() - 1) as f64;
    let standard_error = libm::sqrt(residual / freedom / squares);
    let half = student_975(freedom) * standard_error;
    Ok(HoleCoefficient { mu, standard_error, interval: [mu - half, mu + half], count: points.len() })
}

/// Returns the 0.975 quantile of Student's t: exact for 2 degrees of freedom, beyond that by the expansion in their inverse (Abramowitz and Stegun
/// 26.7.5), accurate to 0.2 %.
fn student_975(freedom: f64) -> f64 {
    const Z: f64 = 1.959_963_984_540_054;
    if freedom <= 2.0 {
        return 4.302_652_729_911_275;
    }
    let (z, n) = (Z, freedom);
    let g1 = (z.powi(3) + z) / 4.0;
    let g2 = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    let g3 = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
    let g4 = (79.0 * z.powi(9) + 776.0 * z.powi(7) + 1482.0 * z.powi(5) - 1920.0 * z.powi(3) - 945.0 * z) / 92160.0;
    z + g1 / n + g2 / n.powi(2) + g3 / n.powi(3) + g4 / n.powi(4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_as_in_the_tables() {
        for (freedom, quantile) in [(2.0, 4.3027), (3.0, 3.1824), (4.0, 2.7764), (9.0, 2.2622), (30.0, 2.0423)] {
            assert!((student_975(freedom) / quantile - 1.0).abs() < 2e-3, "{freedom}");
        }
    }
}
