//! A table for a rest without a name. It says how large the rest is and where, not what it is.
//!
//! Tables are tried after naming if the rest exceeds the noise: over each condition of the cycle, of a force and of a factor on the friction, over
//! the whole range of the condition and over the part in which the rest is concentrated.
//!
//! 1. *Fit.* The shares of a table and the parameters of the model are fitted together, by penalised least squares on the training samples: `Σr² +
//!    λ·Σ(second differences)²`. Condition, kind and λ are chosen by cross-validation over the blocks. There a table over the load reads the load that
//!    the sensor would show if the model were right ([`loads`]).
//! 2. *Keep.* A table must remove [`LEAST_CLOSED`] of the squares above the noise in the cross-validation and on the held-out samples, on the latter with
//!    a gain beyond the scatter of their blocks. It must also hold in other conditions: for each third of every other condition, and of the time, a table
//!    learned outside this third must remove enough inside it, as far as it has covered its own condition.
//! 3. A rest that another cable's signals explain better gets no table.
//!
//! All fits use the cycle's own derivatives, so a table runs in the cycle exactly as it was judged.

mod layout;
mod loads;
mod normal;
mod tried;
mod words;

use fric_core::effects::Effect;
use fric_core::effects::empirical::{Over, RATIO, SHARE_PLACES, SIZE};
use fric_core::parameters::Values;
use nalgebra::DMatrix;

use self::layout::candidates;
use self::tried::Tried;
use super::WORTH;
use super::places::{Place, sum_and_error};
use crate::discover::workbench::{Model, Workbench};
use crate::fit::Parameter;

pub use words::{looks_like, signal_of};

/// Minimum fraction of the squares above the noise that a table removes on held-out samples. The remaining rms gap is then at most 0.7 of the
/// original one.
const LEAST_CLOSED: f64 = 0.5;
/// Minimum gain in standard errors, by the scatter of blocks.
const LEAST_SIGNIFICANCE: f64 = 3.0;

/// A table that passed the checks.
#[derive(Clone, Debug)]
pub struct Table {
    /// The model with it.
    pub values: Values,
    /// The fitted parameters.
    pub fitted: Vec<Parameter>,
    /// Covariance of the fitted parameters, by the scatter of blocks.
    pub covariance: DMatrix<f64>,
    /// Training sum of squares without and with the table, N².
    pub training: [f64; 2],
    /// Factor by which memory in the residual weakens the evidence, at least 1.
    pub inflation: f64,
    /// Fraction of the held-out sum of squares that the table removes.
    pub gain_ratio: f64,
}

/// Returns the best table for the residual of a model, if one passes the checks. `places` are the conditions in which the rest is concentrated.
pub fn table(bench: &Workbench<'_>, model: &Model, noise_n: f64, places: &[Place]) -> Option<Table> {
    let without = bench.try_one(model);
    let residual_n = bench.residuals_n(&without.values);
    let squares = Squares::of(bench, &residual_n, true);
    if squares.excess(noise_n) <= WORTH * squares.noise(noise_n) {
        return None;
    }
    let base = without.model();
    let mut candidates = candidates(bench, &base, &residual_n, places);
    // A constant load says nothing about how the force depends on it. A table over the load would turn any force into that constant.
    candidates.retain(|candidate| candidate.over != Over::Load || bench.knows_load(noise_n));
    let told_n = loads::told(bench, &residual_n);
    let chosen = candidates.iter().filter_map(|candidate| Tried::of(candidate, bench, &base, &told_n, noise_n));
    let chosen =
        chosen.filter(|tried| tried.closed >= LEAST_CLOSED).max_by(|one, other| one.closed.total_cmp(&other.closed))?;
    let holds_elsewhere = chosen.holds_elsewhere(bench, noise_n);
    let (values, covariance, inflation, fitted) = chosen.finished(bench, &base)?;
    // No robot file states a table that raises the friction beyond what a pulley can have.
    bench.record.params.with_values(&values).ok()?;
    let with_n = bench.residuals_n(&values);
    let after = Squares::of(bench, &with_n, true);
    let gains: Vec<f64> = squares.of_blocks.iter().zip(&after.of_blocks).map(|(one, other)| one - other).collect();
    let (gain, error) = sum_and_error(&gains);
    let closed = gain / squares.excess(noise_n);
    let holds = holds_elsewhere && closed >= LEAST_CLOSED && gain > LEAST_SIGNIFICANCE * error;
    let training = [&residual_n, &with_n].map(|residual_n| Squares::of(bench, residual_n, false).sum);
    holds.then_some(Table { values, fitted, covariance, training, inflation, gain_ratio: gain / squares.sum })
}

/// Returns a model's values without a table.
pub fn without_table(values: &Values) -> Values {
    let mut neutral = *values;
    for parameter in Parameter::of(Effect::Empirical) {
        neutral[parameter.place()] = parameter.row().neutral;
    }
    neutral
}

/// Whether a model has a table that acts.
pub fn has_table(values: &Values) -> bool {
    [SIZE, RATIO].iter().any(|size| values[*size].abs() > 0.0) && Over::of(|place| values[place]).is_some()
}

/// Whether a parameter of a table has no effect: the range of another condition, or a share of zero.
pub fn is_idle(parameter: &Parameter, values: &Values) -> bool {
    let is_size = [SIZE, RATIO].contains(&parameter.place());
    let own = Over::of(|place| values[place]).map_or(0..0, |over| over.from()..over.to() + 1);
    parameter.effect() == Some(Effect::Empirical)
        && !own.contains(&parameter.place())
        && (is_size || !SHARE_PLACES.contains(&parameter.place()))
        && values[parameter.place()].abs() <= 0.0
}

/// Squares of a residual over one half of the log.
struct Squares {
    sum: f64,
    count: f64,
    of_blocks: Vec<f64>,
}

impl Squares {
    fn of(bench: &Workbench<'_>, residual_n: &[f64], held_out: bool) -> Self {
        let (mut sum, mut count, mut of_blocks) = (0.0, 0.0, Vec::new());
        for block in bench.blocks.iter().filter(|block| block.held_out == held_out) {
            let mut of_block = 0.0;
            let numbers = residual_n.get(block.cycles.clone()).unwrap_or_default();
            for number in numbers.iter().filter(|number| number.is_finite()) {
                (of_block, count) = (of_block + number * number, count + 1.0);
            }
            sum += of_block;
            of_blocks.push(of_block);
        }
        Self { sum, count, of_blocks }
    }

    fn noise(&self, noise_n: f64) -> f64 {
        self.count * noise_n * noise_n
    }

    fn excess(&self, noise_n: f64) -> f64 {
        self.sum - self.noise(noise_n)
    }
}
