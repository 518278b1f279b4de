//! Whether the load of a log varies enough to tell a gain of the sensor from a zero.
//!
//! Under one load `F` any gain agrees with a zero that makes up for it, and friction tells nothing more: its share of the load is as unknown as the gain. Of
//! what varies in the forces, the noise is no load. Least squares takes it for one (errors in variables): it finds a wrong gain beside a zero as large as the
//! load, with small standard errors. With an error in both forces, the slope between them lies between that of the regression of one on the other and that of
//! the reverse regression (R. Frisch, *Statistical Confluence Analysis*, 1934): by the correlation `r` of what both have beside the motion, between `r` and `1/r`
//! times their geometric mean. The gain is known to half that range, whatever the standard errors.

use fric_core::effects::sensor_gain::GAIN;
use fric_core::parameters::{MU, OFFSET, SIGMA, VISCOUS, Values};
use nalgebra::{Matrix5, Vector5};

use super::determined::NEGLIGIBLE_RATIO;
use super::one_way::zero_instead;
use crate::samples::cable::CableRecord;
use crate::samples::record::LogZero;
use crate::search::problem::Problem;
use crate::search::solve::{OpenCombination, Solution};
use crate::search::vector::Parameter;

/// Columns of the motion with less than this fraction of the squares of the greatest contain only rounding errors.
const LEAST_OF_MOTION: f64 = 1e-12;

/// Sums of squares and products of two forces beside the motion, N².
#[derive(Clone, Copy, Debug)]
pub struct BesideMotion {
    /// Of the force itself.
    pub force: f64,
    /// Of the reference.
    pub reference: f64,
    /// Of their products.
    pub shared: f64,
    /// Of the part of the difference of the two that goes with the motion: the friction.
    pub of_motion: f64,
    /// Number of samples.
    pub count: f64,
}

impl BesideMotion {
    /// Returns what a force and the reference of the samples have beside that which goes with the direction and the speed of the motion.
    pub fn of(record: &CableRecord<'_>, used: &[bool], force_n: impl Fn(usize) -> f64) -> Option<Self> {
        let mut direction = 0.0;
        let (mut products, mut count) = (Matrix5::<f64>::zeros(), 0.0);
        for (cycle, (row, used)) in record.rows.iter().zip(used).enumerate() {
            let signals = &row.signals;
            if signals.displacement_m.abs() > 0.0 {
                direction = signals.displacement_m.signum();
            }
            let of = Vector5::new(1.0, direction, signals.speed_m_per_s, force_n(cycle), record.reference_n(cycle));
            if *used && of.iter().all(|number| number.is_finite()) {
                products += of * of.transpose();
                count += 1.0;
            }
        }
        // Where a log has one direction or one speed only, its column is like another one.
        let by_motion = products.fixed_view::<3, 3>(0, 0);
        let inverse = by_motion.into_owned().pseudo_inverse(LEAST_OF_MOTION * by_motion.norm()).ok()?;
        let mixed = products.fixed_view::<3, 2>(0, 3);
        let left = products.fixed_view::<2, 2>(3, 3) - mixed.transpose() * inverse * mixed;
        let (force, reference, shared) = (left[(0, 0)], left[(1, 1)], left[(0, 1)]);
        let difference = products.column(3) - products.column(4);
        let of_motion =
            difference[3] - difference[4] - difference[0].powi(2) / count - (force - 2.0 * shared + reference);
        Some(Self { force, reference, shared, of_motion, count })
    }

    /// Returns how far the slopes of both regressions lie from their geometric mean, relative to it; infinite where they have no such slope.
    fn apart_ratio(&self) -> f64 {
        let correlation = self.shared / (self.force * self.reference).sqrt();
        if correlation > 0.0 { 0.5 * (correlation.recip() - correlation) } else { f64::INFINITY }
    }
}

/// Whether the load varies too little to tell a gain of the sensor from a zero, by what a model of a cable makes of the sensor's force. A wrong gain or zero of
/// the model does not matter.
///
/// The bound on the gain is the one by which a ratio counts as undetermined. With equal noise of both forces it is reached where the load varies by 4.4 times that, with
/// half of it by 6.3 times, with double by 3.1 times.
pub fn is_one_load(problem: &Problem<'_>, values: &Values) -> bool {
    apart_ratio(problem, values) > NEGLIGIBLE_RATIO
}

/// Returns how far the gain may be from that of a model because of the errors of both forces, relative to it; infinite where nothing is known of it.
pub fn apart_ratio(problem: &Problem<'_>, values: &Values) -> f64 {
    let Some((member, forces)) = problem.members.first().zip(problem.forces(&[*values])) else { return f64::INFINITY };
    let force_n = |cycle: usize| forces.first().map_or(f64::NAN, |forces| forces.at(cycle).0);
    BesideMotion::of(&member.record, &problem.used, force_n).map_or(f64::INFINITY, |left| left.apart_ratio())
}

/// Returns the combination of zero and gain that such a log leaves open, from a solution with the given zero, in a step as large as takes the whole gain for a
/// zero. Friction that does not go with the force as the sensor shows it changes with the gain.
pub fn combination(problem: &Problem<'_>, zero: Parameter, solution: &Solution) -> Option<OpenCombination> {
    let values = solution.values.first()?;
    let mut other = *values;
    other[GAIN] = 1.0;
    for parameter in solution.unknowns.iter().map(|unknown| unknown.parameter) {
        // With a zero at the platform the ratio of the forces that the sensor shows in both directions tells μ.
        if [VISCOUS, SIGMA].contains(&parameter.place()) || parameter.place() == MU && zero.place() != OFFSET {
            other[parameter.place()] *= values[GAIN];
        }
    }
    zero_instead(problem, zero, values, &other)
}

/// Whether a parameter is the gain of the sensor.
pub fn is_gain(parameter: &Parameter) -> bool {
    parameter.place() == GAIN
}

/// Whether a parameter is a zero, of the sensor or at the platform.
pub fn is_zero(parameter: &Parameter) -> bool {
    LogZero::ALL.iter().any(|zero| parameter.place() == zero.place())
}
