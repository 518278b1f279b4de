//! `sensor_nonlinearity` in the simulated robot: a misaligned load cell, whose lever arm changes with the load.

use super::truth::{Cause, TruthEffect};
use fric_core::effects::sensor_nonlinearity::REFERENCE;
use fric_core::parameters::Values;

use super::{Around, LabEffect, Sizing, Start};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual };

#[derive(Debug)]
struct Askew {
    curvature_per_n: f64,
    reference_n: f64,
    /// Ratio of the sensor signal to the tension, dimensionless.
    tension_ratio: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [curvature_per_n, reference_n] = ["curvature_per_n", "reference_n"].map(cause.value);
    Box::new(Askew { curvature_per_n, reference_n, tension_ratio: cause.sensor_ratio })
}

impl TruthEffect for Askew {
    fn bent_n(&self, force_n: f64) -> f64 {
        let from_reference_n = force_n / self.tension_ratio - self.reference_n;
        force_n + self.tension_ratio * self.curvature_per_n * from_reference_n * from_reference_n
    }
}

/// Whether the slope of the curve changes over the range of tensions, taken as four standard deviations, by more than its error at their mean. If
/// not, the curve is equivalent to a gain and an offset.
fn is_more_than_usual(values: &Values, around: &Around) -> bool {
    let variance = around.tension_n * around.tension_n - around.mean_tension_n * around.mean_tension_n;
    (around.mean_tension_n - values[REFERENCE]).abs() < 4.0 * variance.max(0.0).sqrt()
}

fn starts(around: &Around) -> Vec<Start> {
    // At a curvature of 0 the reference has no influence, and waits until the curvature has reached its minimum. Varied together from the start, the two
    // may lead away from a strong curve.
    vec![vec![("curvature_per_n", 0.0), ("reference_n", around.mean_tension_n)]]
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    // 5 % of the mean tension at 0.5 and at 1.5 times the mean tension.
    let curvature_per_n = scale.either(0.2) / scale.tension_n;
    vec![("curvature_per_n", curvature_per_n), ("reference_n", scale.tension_n)]
}
