//! The error of estimates because the sensor's noise enters the derivatives of the model.
//!
//! The correction of a `sensor_lag` contains the change of the sensor signal from cycle to cycle, and so the sensor's noise. The same noise is in the
//! residuals, so least squares attributes part of it to the lag and finds too small a time constant (errors in variables: W. A. Fuller, *Measurement
//! Error Models*, 1987). Instruments show by how much: the derivatives of [`DELAY`] cycles earlier depend on the motion as well, but not on the
//! noise of the present cycle. With Z, the derivatives with these columns replaced, the estimate differs by `b = (ZᵀJ)⁻¹Zᵀr` from one without this
//! error. The values remain those of least squares, because they compensate best with the noise that there is; the covariance grows by `b bᵀ`.

use std::collections::VecDeque;

use fric_core::effects::Effect;
use fric_core::parameters::Values;
use nalgebra::{DMatrix, DVector};

use crate::search::problem::Problem;
use crate::search::solve::unknowns;

/// Age of the instruments in cycles. The corrected noise has a correlation of one cycle. With 2 and 8 cycles instead, `b` changes by 3 %.
const DELAY: usize = 4;

/// Returns the error of each estimate, `None` if no free parameter has derivatives with noise.
pub fn error(problem: &Problem<'_>, values: &[Values]) -> Option<DVector<f64>> {
    let of_lag = |effect: Option<Effect>| effect == Some(Effect::SensorLag);
    let is_noisy: Vec<bool> = unknowns(problem).iter().map(|unknown| of_lag(unknown.parameter.effect())).collect();
    if !is_noisy.contains(&true) {
        return None;
    }
    let count = is_noisy.len();
    let (mut slopes, mut sums) = (DMatrix::zeros(count, count), DVector::zeros(count));
    // Derivatives of the last cycles, each with its index: one residual in each cycle, or six of a wrench.
    let mut earlier: VecDeque<(usize, DVector<f64>)> = VecDeque::new();
    let mut instruments = DVector::zeros(count);
    problem.visit(values, true, |place, rows| {
        let of_cycle = rows.len();
        for (component, (residual, derivatives)) in rows.filter_map(<[f64]>::split_last).enumerate() {
            let index = place * of_cycle + component;
            while earlier.front().is_some_and(|(before, _)| before + DELAY * of_cycle < index) {
                earlier.pop_front();
            }
            let derivatives = DVector::from_column_slice(derivatives);
            if let Some((_, delayed)) = earlier.front().filter(|(before, _)| before + DELAY * of_cycle == index) {
                let of_both = derivatives.iter().zip(delayed).zip(&is_noisy);
                for (instrument, ((present, delayed), is_noisy)) in instruments.iter_mut().zip(of_both) {
                    *instrument = if *is_noisy { *delayed } else { *present };
                }
                sums.axpy(*residual, &instruments, 1.0);
                slopes.ger(1.0, &instruments, &derivatives, 1.0);
            }
            earlier.push_back((index, derivatives));
        }
    });
    slopes.lu().solve(&sums)
}
