//! Simple laws that effects of the catalogue may wrongly stand in for.
//!
//! Where a force sensor's curve is bent, say, a gain, an offset and a nonlinear load explain nearly all of it together, each
//! with strong evidence, and none of them is there. So a few plain laws are tried as rivals, each as one more column of the
//! least-squares problem beside what the named effects add. If it makes names superfluous, and what is left explains as much as all names did, these names stand in
//! for it, and are set aside. Where the law is that of an effect, this has its turn then. A jump of the sensor or
//! of the friction is that of none.

use fric_core::effects::Effect;
use fric_core::parameters::{VISCOUS, Values};

use super::projection::{Columns, less_projection};
use crate::discover::rest::{CREEP_S, crept};
use crate::discover::workbench::{Trial, Workbench};
use crate::fit::{Parameter, Row};
use crate::search::problem::Problem;

/// Number of cycles on either side over which rates are computed.
const RATE_CYCLES: usize = 5;
/// The same for the rate at which contacts store friction. After a quick reversal they do so within a few cycles.
const STORING_CYCLES: usize = 1;
/// Time constants of warm-up, as fractions of the log's duration.
const TIME_CONSTANT_RATIOS: [f64; 4] = [0.06, 0.12, 0.25, 0.5];

/// A law that bends an effect's own law removes more than this fraction of the excess above the noise,
const MOST_BENT: f64 = 0.25;
/// and the effect beside the law explains less than this fraction of what it explains alone.
const LEAST_BESIDE_RATIO: f64 = 0.5;

/// Damping of the contacts takes the place of a name only if it removes more than this fraction of the excess that the name leaves. A motion that is
/// known late is extrapolated, with an error of which the rate of the friction removes a quarter though nothing is damped; of what a delay leaves of
/// damped contacts it removes three quarters. Half of this fraction refuses true delays, double never applies.
const LEAST_OF_DAMPING: f64 = 0.5;

/// A law that makes some of the effects superfluous.
#[derive(Clone, Debug, PartialEq)]
pub struct Rival {
    /// The signal that the law depends on.
    pub signal: &'static str,
    /// Indices of the effects.
    pub replaces: Vec<usize>,
    /// Decrease of the sum of squares by the law together with the remaining effects, N².
    gain: f64,
}

/// The influence of chance on sums of squares.
#[derive(Clone, Copy, Debug)]
pub struct Chance {
    /// Decrease that counts as evidence, N².
    pub enough: f64,
    /// The same decrease if the residual is white, N².
    pub white: f64,
    /// Standard deviation of the noise, N.
    pub noise_n: f64,
}

/// Returns the rival that explains most. `effects` lists effects with their parameters and the model's values without each. A law that an effect
/// itself states is no rival to that effect.
pub fn best_rival(
    bench: &Workbench<'_>,
    model: &Trial,
    (kinds, effects): (&[Effect], &[(Vec<Parameter>, Values)]),
    noise: &Chance,
) -> Option<Rival> {
    let Chance { enough, white, noise_n } = *noise;
    let is_other = |parameter: &&Parameter| !effects.iter().any(|(of, _)| of.contains(parameter));
    let others: Vec<Parameter> = model.free.iter().filter(is_other).copied().collect();
    let problem = Problem { used: bench.counts.to_vec(), ..bench.problem(&others, None) };
    let residual_n = bench.residuals_n(&model.values);
    let finite = residual_n.iter().filter(|number| number.is_finite());
    let excess: f64 = finite.map(|number| number * number - noise_n * noise_n).sum();
    let without_n: Vec<Vec<f64>> = effects.iter().map(|(_, neutral)| bench.residuals_n(neutral)).collect();
    let added_by =
        |without_n: &Vec<f64>| residual_n.iter().zip(without_n).map(|(with, without)| with - without).collect();
    let mut signals: Vec<Vec<f64>> = without_n.iter().map(added_by).collect();
    // Friction warms up; the inertia on trial, for example, does not.
    let mut without = model.values;
    for (parameters, neutral) in effects {
        for place in parameters.iter().filter(|parameter| !parameter.is_friction()).map(Parameter::place) {
            without[place] = neutral[place];
        }
    }
    let laws = laws(bench, &bench.added_n(&without));
    let mut laws: Vec<Law> = laws.into_iter().filter(|law| law.of.is_none_or(|of| !kinds.contains(&of))).collect();
    // Whatever has a name may be one jump, of the sensor's zero or of the friction, or the damping of the contacts.
    for ((_, neutral), without_n) in effects.iter().zip(&without_n) {
        laws.extend([vec![1.0; residual_n.len()], bench.added_n(neutral)].map(|jumping| jump(without_n, jumping)));
        laws.extend(contact_damping(bench, neutral, without_n));
    }
    let names: Vec<&'static str> = laws.iter().map(|law| law.signal).collect();
    let least: Vec<f64> = laws.iter().map(|law| law.least_of_excess * excess.max(0.0)).collect();
    signals.extend(laws.into_iter().map(|law| law.values));
    let columns = less_projection(&problem, &model.values, &signals)?;
    let columns = Columns::new(&columns, effects.len(), &residual_n);
    let gain = |places: &[usize]| columns.gain(places);
    let all: Vec<usize> = (0..effects.len()).collect();
    let by_name = gain(&all);
    let of_law = |(law, signal): (usize, &&'static str)| {
        let mut places: Vec<usize> = all.iter().copied().chain([effects.len() + law]).collect();
        loop {
            let now = gain(&places);
            let without = |place: usize| {
                let others: Vec<usize> = places.iter().copied().filter(|other| *other != place).collect();
                (now - gain(&others), place)
            };
            let names = places.iter().copied().filter(|place| *place < effects.len());
            let weakest = names.map(without).min_by(|one, other| one.0.total_cmp(&other.0));
            let Some((_, place)) = weakest.filter(|(loss, _)| *loss < enough) else { break };
            places.retain(|other| *other != place);
        }
        let replaces: Vec<usize> = all.iter().copied().filter(|place| !places.contains(place)).collect();
        let (together, gain) = (gain(&[&all[..], &[effects.len() + law]].concat()), gain(&places));
        if replaces.is_empty() && together - by_name > enough.max(MOST_BENT * excess).max(least[law]) {
            // The law wins if it explains much of the rest, more than chance would, and shares what it explains with one of the names.
            let of_name = |name: &usize| {
                let others: Vec<usize> = all.iter().copied().filter(|other| other != name).collect();
                let beside = [&others[..], &[effects.len() + law]].concat();
                (together - columns.gain(&beside)) / (by_name - columns.gain(&others))
            };
            let shares = all.iter().map(|name| (of_name(name), *name)).min_by(|one, other| one.0.total_cmp(&other.0));
            let (_, name) = shares.filter(|(share, _)| *share < LEAST_BESIDE_RATIO)?;
            return Some(Rival { signal, replaces: vec![name], gain: together });
        }
        // Each name that is removed requires one parameter less.
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let is_better = match replaces.len() {
            0 => false,
            1 => gain > by_name + white.max(least[law]),
            count => gain + (count - 1) as f64 * enough > by_name + least[law],
        };
        is_better.then_some(Rival { signal, replaces, gain })
    };
    names.iter().enumerate().filter_map(of_law).max_by(|one, other| one.gain.total_cmp(&other.gain))
}

/// A simple law.
struct Law {
    /// The signal that the law depends on.
    signal: &'static str,
    /// The effect that it is to first order, if it is one.
    of: Option<Effect>,
    /// Fraction of the excess above the noise that the law has to remove in addition to what the names do.
    least_of_excess: f64,
    /// In each cycle, of any unit.
    values: Vec<f64>,
}

/// A signal that sets in at once, where that makes most of a residual; NaN where there is no sample.
fn jump(residual_n: &[f64], signal: Vec<f64>) -> Law {
    let sum_up = |to: &mut [f64; 2], residual_n: f64, signal: f64| {
        if residual_n.is_finite() && signal.is_finite() {
            to[0] += residual_n * signal;
            to[1] += signal * signal;
        }
    };
    let mut all = [0.0; 2];
    residual_n.iter().zip(&signal).for_each(|(residual_n, signal)| sum_up(&mut all, *residual_n, *signal));
    let (mut before, mut best, mut start) = ([0.0; 2], 0.0, residual_n.len());
    for (place, (residual_n, signal)) in residual_n.iter().zip(&signal).enumerate() {
        let after = [all[0] - before[0], all[1] - before[1]];
        let explained = [before, after].map(|[product, square]| product * product / square).iter().sum::<f64>();
        if explained > best {
            (best, start) = (explained, place);
        }
        sum_up(&mut before, *residual_n, *signal);
    }
    let sets_in = |(place, signal): (usize, f64)| if place < start { 0.0 } else { signal };
    Law {
        signal: "time",
        of: None,
        least_of_excess: 0.0,
        values: signal.into_iter().enumerate().map(sets_in).collect(),
    }
}

/// The laws: sensor and reference that follow late, a bent sensor, a drag of turbulence, what warms up, of the sensor and of the friction, and a cable
/// that creeps.
fn laws(bench: &Workbench<'_>, friction_n: &[f64]) -> Vec<Law> {
    let record = &bench.record;
    let of = |value: &dyn Fn(&Row) -> f64| record.rows.iter().map(value).collect::<Vec<f64>>();
    let sensor_n = of(&|row| row.signals.sensor_force_n);
    let sound = || sensor_n.iter().zip(bench.counts).filter(|(_, counts)| **counts).map(|(force_n, _)| *force_n);
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let mean_n = sound().sum::<f64>() / sound().count().max(1) as f64;
    let logs = || record.logs().map(|(start, rows)| start..start + rows.len());
    let law = |signal, of, values| Law { signal, of: Some(of), least_of_excess: 0.0, values };
    let mut laws = vec![
        law("force_rate", Effect::SensorLag, rates(logs(), &sensor_n, RATE_CYCLES)),
        law("reference_rate", Effect::SensorLag, rates(logs(), &of(&|row| row.reference_n), RATE_CYCLES)),
        law(
            "sensor_force",
            Effect::SensorNonlinearity,
            sensor_n.iter().map(|force_n| (force_n - mean_n).powi(2)).collect(),
        ),
        law(
            "speed",
            Effect::ViscousNonlinearity,
            of(&|row| row.signals.speed_m_per_s * row.signals.speed_m_per_s.abs()),
        ),
    ];
    let end_s = record.rows.iter().map(|row| row.cycle).fold(0.0, f64::max) * record.cycle_s;
    for ratio in TIME_CONSTANT_RATIOS {
        let decay = of(&|row| (-row.cycle * record.cycle_s / (ratio * end_s)).exp());
        let of_friction = decay.iter().zip(friction_n).map(|(decay, friction_n)| decay * friction_n).collect();
        laws.push(law("time", Effect::FrictionWarmup, of_friction));
        laws.push(law("time", Effect::SensorWarmup, decay));
    }
    let creep = |lag_s| Law { signal: "past_load", of: None, least_of_excess: 0.0, values: crept(record, lag_s) };
    laws.extend(CREEP_S.map(creep));
    laws
}

/// Damping of the contacts: a force in proportion to the rate at which they store friction, the term `σ₁·dz/dt` of the `LuGre` model (C. Canudas de
/// Wit, H. Olsson, K. J. Åström, P. Lischinsky, *A New Model for Control of Systems with Friction*, IEEE Trans. Autom. Control 40, 1995, eq. 1–3).
/// It makes the stored friction lead, as motion that is known late does, but neither the viscous friction nor the friction at constant sliding. None if
/// the residual without the name (model minus reference) asks for the opposite: no damping makes friction late.
fn contact_damping(bench: &Workbench<'_>, values: &Values, residual_n: &[f64]) -> Option<Law> {
    let mut stored = *values;
    stored[VISCOUS] = 0.0;
    let logs = bench.record.logs().map(|(start, rows)| start..start + rows.len());
    let values = rates(logs, &bench.added_n(&stored), STORING_CYCLES);
    let products = residual_n.iter().zip(&values).map(|(residual_n, rate)| residual_n * rate);
    let leads = products.filter(|product| product.is_finite()).sum::<f64>() < 0.0;
    leads.then_some(Law { signal: "friction_rate", of: None, least_of_excess: LEAST_OF_DAMPING, values })
}

/// Returns the differences of a signal over so many cycles on either side, within each log.
fn rates(logs: impl Iterator<Item = std::ops::Range<usize>>, signal: &[f64], cycles: usize) -> Vec<f64> {
    let mut rates = vec![f64::NAN; signal.len()];
    for log in logs {
        for place in log.clone() {
            let (from, to) = (place.saturating_sub(cycles).max(log.start), (place + cycles).min(log.end - 1));
            rates[place] = signal[to] - signal[from];
        }
    }
    rates
}

#[cfg(test)]
mod tests {
    use super::jump;

    #[test]
    fn a_jump_sets_in_where_it_explains_most() {
        // What is there from the start, and samples that are missing, do not hide it.
        let signal: Vec<f64> = (0..400).map(|place| 1.0 + 0.5 * f64::from(place % 7)).collect();
        let residual = |(place, signal): (usize, &f64)| match place {
            0..90 => 0.2 * signal,
            100..120 => f64::NAN,
            _ => -0.1 * signal,
        };
        let residual_n: Vec<f64> = signal.iter().enumerate().map(residual).collect();
        let law = jump(&residual_n, signal.clone());
        let expected: Vec<f64> =
            signal.iter().enumerate().map(|(place, of)| if place < 90 { 0.0 } else { *of }).collect();
        assert_eq!((law.of, law.values), (None, expected));
    }
}
