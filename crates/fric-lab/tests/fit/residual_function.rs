//! The residuals as a function have their least squares where the fit ends.

use fric_lab::fit::{FitOptions, Reference, ResidualFunction};
use nalgebra::{DMatrix, DVector};

use super::logs::{FRICTION, Log, parameter, value};
use super::oracle::{Bench, PULLEYS, strokes, wandering};
use crate::simulate::robots::bench;

/// Gauss and Newton in the parameters themselves: another way than the fit's.
fn optimum(function: &ResidualFunction) -> Vec<f64> {
    let mut values = DVector::from_vec(function.start());
    for _ in 0..30 {
        let jacobian = DMatrix::from_row_slice(function.count(), values.len(), &function.jacobian(values.as_slice()));
        let residuals = DVector::from_vec(function.residuals(values.as_slice()));
        let step = jacobian.svd(true, true).solve(&residuals, 0.0).unwrap();
        values -= step;
    }
    values.as_slice().to_vec()
}

/// Logs whose start is all but worthless for how long it has to be left out: soft cables, short strokes, guesses far off.
#[test]
fn the_optimum_is_the_fits() {
    let logs: [(Bench, f64); 3] = [
        (Bench::default(), 0.05),
        (Bench { sigma_n_per_m: 60.0, seed: 1, ..Bench::default() }, 0.05),
        (Bench { mu: 0.1, sigma_n_per_m: 200.0, seed: 2, ..Bench::default() }, 0.02),
    ];
    for (truth, amplitude_m) in logs {
        let log: Log = truth.run(8.0, strokes(amplitude_m, 1.0), wandering(8.0));
        let robot = bench(PULLEYS, "mu = 0.05, sigma_n_per_m = 300.0");
        let fit = log.fit(&robot, &FitOptions::default()).remove(0);
        let measurements = log.measured(&robot, Reference::Forces);
        let function = ResidualFunction::new(&measurements.cable(0).unwrap(), &FitOptions::default());
        assert_eq!(function.count(), fit.samples.used + fit.samples.outliers);
        assert!(fit.samples.warm_up > 0 && fit.fitted.len() == 4);
        for (name, optimum) in FRICTION.into_iter().zip(optimum(&function)) {
            let apart = (value(&fit, name) - optimum) / fit.standard_error(&parameter(name)).unwrap();
            println!("{name}: {apart:+.1e} standard errors apart");
            assert!(apart.abs() < 0.02, "{name}: {apart}");
        }
    }
}
