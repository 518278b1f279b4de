//! Simple laws that effects of the catalogue may wrongly stand in for.
//!
//! Where a force sensor's curve is bent, say, a gain, an offset and a nonlinear load explain nearly all of it together, each
//! with strong evidence, and none of them is there. So a few plain laws are tried as rivals, each as one more column of the
//! least-squares problem beside what the named effects add. If it makes names superfluous, and what is left explains as much as all names did, these names stand in
//! for it, and are set aside. Where the law is that of an effect, this has its turn then. One jump or two of the sensor or
//! of the friction are that of none.

use std::ops::Range;
use std::rc::Rc;

use fric_core::effects::Effect;
use fric_core::parameters::{VISCOUS, Values};

use super::projection::{Columns, Signals, visit_less_projection};
use crate::discover::rest::{CREEP_S, crept};
use crate::discover::workbench::{Evaluated, Trial, Workbench};
use crate::fit::{CableRecord, Parameter, Row};
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
    let whole = bench.evaluated(&model.values);
    let excess: f64 =
        whole.residuals_n().filter(|number| number.is_finite()).map(|number| number * number - noise_n * noise_n).sum();
    let without: Vec<Evaluated<'_, '_>> = effects.iter().map(|(_, neutral)| bench.evaluated(neutral)).collect();
    // Friction warms up; the inertia on trial, for example, does not.
    let mut of_friction = model.values;
    for (parameters, neutral) in effects {
        for place in parameters.iter().filter(|parameter| !parameter.is_friction()).map(Parameter::place) {
            of_friction[place] = neutral[place];
        }
    }
    let mut laws = laws(bench, bench.evaluated(&of_friction));
    laws.retain(|law| law.of.is_none_or(|of| !kinds.contains(&of)));
    // Whatever has a name may be a jump or two, of the sensor's zero or of the friction, or the damping of the contacts.
    for ((_, neutral), without) in effects.iter().zip(&without) {
        laws.extend(jumps(without.residuals_n(), |_| 1.0));
        laws.extend(jumps(without.residuals_n(), |cycle| without.added_n(cycle)));
        laws.extend(contact_damping(bench, neutral, without));
    }
    let names: Vec<&'static str> = laws.iter().map(|law| law.signal).collect();
    let least: Vec<f64> = laws.iter().map(|law| law.least_of_excess * excess.max(0.0)).collect();
    let signals = || -> Signals<'_> {
        let mut of_laws: Vec<(usize, Numbers<'_>)> = laws.iter().map(|law| (0, (law.numbers)())).collect();
        let (whole, without) = (&whole, &without);
        Box::new(move |cycle, numbers| {
            numbers.extend(without.iter().map(|without| whole.residual_n(cycle) - without.residual_n(cycle)));
            numbers.extend(of_laws.iter_mut().map(|(next, of_law)| {
                let skipped = cycle - std::mem::replace(next, cycle + 1);
                of_law.nth(skipped).unwrap_or(f64::NAN)
            }));
        })
    };
    let mut columns = Columns::new(effects.len() + laws.len(), effects.len(), effects.len());
    visit_less_projection(&problem, &model.values, &signals, |cycle, numbers| {
        columns.add(numbers, whole.residual_n(cycle));
    })?;
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

/// The numbers of a signal, one per cycle.
type Numbers<'a> = Box<dyn Iterator<Item = f64> + 'a>;

/// A simple law.
struct Law<'a> {
    /// The signal that the law depends on.
    signal: &'static str,
    /// The effect that it is to first order, if it is one.
    of: Option<Effect>,
    /// Fraction of the excess above the noise that the law has to remove in addition to what the names do.
    least_of_excess: f64,
    /// Gives its numbers from the first cycle on, of any unit. Series of all laws would take up more memory than the log.
    numbers: Box<dyn Fn() -> Numbers<'a> + 'a>,
}

impl<'a> Law<'a> {
    /// Creates the law that is the effect `of` to first order from its number in each of so many cycles.
    fn by_cycle(
        (signal, of): (&'static str, Option<Effect>),
        cycle_count: usize,
        number: impl Fn(usize) -> f64 + 'a,
    ) -> Self {
        let number = Rc::new(number);
        let numbers = move || -> Numbers<'a> {
            let number = Rc::clone(&number);
            Box::new((0..cycle_count).map(move |cycle| number(cycle)))
        };
        Self { signal, of, least_of_excess: 0.0, numbers: Box::new(numbers) }
    }
}

/// Sums of the products of a residual and a signal, and of the signal's squares, up to each cycle, over the samples that have both.
struct Sums(Vec<[f64; 2]>);

impl Sums {
    fn new(residuals_n: impl Iterator<Item = f64>, signal: impl Fn(usize) -> f64) -> Self {
        let (mut sums, mut sum) = (vec![[0.0; 2]], [0.0; 2]);
        for (cycle, residual_n) in residuals_n.enumerate() {
            let signal = signal(cycle);
            if residual_n.is_finite() && signal.is_finite() {
                sum = [sum[0] + residual_n * signal, sum[1] + signal * signal];
            }
            sums.push(sum);
        }
        Self(sums)
    }

    /// Returns the factor of the signal that explains most of the residual in these cycles, and how much it explains.
    fn level(&self, cycles: &Range<usize>) -> (f64, f64) {
        let ([product_to, square_to], [product_from, square_from]) = (self.0[cycles.end], self.0[cycles.start]);
        let (product, square) = (product_to - product_from, square_to - square_from);
        if square > 0.0 { (product / square, product * product / square) } else { (0.0, 0.0) }
    }

    /// Returns the cycle at which a step between two levels explains most, and how much more than one level.
    fn step(&self, cycles: &Range<usize>) -> (usize, f64) {
        let whole = self.level(cycles).1;
        let explained = |at: usize| self.level(&(cycles.start..at)).1 + self.level(&(at..cycles.end)).1 - whole;
        let steps = (cycles.start + 1..cycles.end).map(|at| (at, explained(at)));
        steps.max_by(|(_, one), (_, other)| one.total_cmp(other)).unwrap_or((cycles.end, 0.0))
    }
}

/// A signal that jumps from one level to the next once, and one that does so twice, where that explains most of a residual; NaN where there is no
/// sample. A drift is no jump: of a residual that grows evenly two jumps leave a ninth.
fn jumps<'a>(residuals_n: impl Iterator<Item = f64>, signal: impl Fn(usize) -> f64 + Clone + 'a) -> [Law<'a>; 2] {
    let sums = Sums::new(residuals_n, &signal);
    let cycle_count = sums.0.len() - 1;
    let (first, _) = sums.step(&(0..cycle_count));
    let (second, _) = [0..first, first..cycle_count]
        .iter()
        .map(|part| sums.step(part))
        .max_by(|(_, one), (_, other)| one.total_cmp(other))
        .unwrap_or((cycle_count, 0.0));
    [vec![first], vec![first.min(second), first.max(second)]].map(|starts| {
        let ends = starts.iter().copied().chain([cycle_count]);
        let parts: Vec<Range<usize>> =
            [0].into_iter().chain(starts.clone()).zip(ends).map(|(from, to)| from..to).collect();
        let levels: Vec<(usize, f64)> = parts.iter().map(|part| (part.end, sums.level(part).0)).collect();
        let signal = signal.clone();
        Law::by_cycle(("time", None), cycle_count, move |cycle| {
            let level = levels.iter().find(|(end, _)| cycle < *end).map_or(0.0, |(_, level)| *level);
            level * signal(cycle)
        })
    })
}

/// The laws: sensor and reference that follow late, a bent sensor, a drag of turbulence, what warms up, of the sensor and of the friction, and a cable
/// that creeps.
fn laws<'b>(bench: &Workbench<'b>, friction: Evaluated<'b, 'b>) -> Vec<Law<'b>> {
    let record = bench.record;
    let count = record.rows.len();
    let of = move |cycle: usize, value: fn(&Row) -> f64| record.rows.get(cycle).map_or(f64::NAN, value);
    let sensor_n = move |cycle: usize| of(cycle, |row| row.signals.sensor_force_n);
    let counted = || bench.counts.iter().enumerate().filter(|(_, counts)| **counts).map(|(cycle, _)| cycle);
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let mean_n = counted().map(sensor_n).sum::<f64>() / counted().count().max(1) as f64;
    let law = |signal, of, number: Box<dyn Fn(usize) -> f64 + 'b>| Law::by_cycle((signal, Some(of)), count, number);
    let mut laws = vec![
        law("force_rate", Effect::SensorLag, Box::new(move |cycle| rate(&record, sensor_n, RATE_CYCLES, cycle))),
        law(
            "reference_rate",
            Effect::SensorLag,
            Box::new(move |cycle| rate(&record, |cycle| record.reference_n(cycle), RATE_CYCLES, cycle)),
        ),
        law("sensor_force", Effect::SensorNonlinearity, Box::new(move |cycle| (sensor_n(cycle) - mean_n).powi(2))),
        law(
            "speed",
            Effect::ViscousNonlinearity,
            Box::new(move |cycle| of(cycle, |row| row.signals.speed_m_per_s * row.signals.speed_m_per_s.abs())),
        ),
    ];
    let end_s = record.rows.iter().map(|row| row.cycle).fold(0.0, f64::max) * record.cycle_s;
    let friction = Rc::new(friction);
    for ratio in TIME_CONSTANT_RATIOS {
        let decay = move |cycle: usize| (-of(cycle, |row| row.cycle) * record.cycle_s / (ratio * end_s)).exp();
        let friction = Rc::clone(&friction);
        let of_friction = move |cycle: usize| decay(cycle) * friction.added_n(cycle);
        laws.push(law("time", Effect::FrictionWarmup, Box::new(of_friction)));
        laws.push(law("time", Effect::SensorWarmup, Box::new(decay)));
    }
    let creep = |lag_s| Law {
        signal: "past_load",
        of: None,
        least_of_excess: 0.0,
        numbers: Box::new(move || Box::new(crept(&record, lag_s))),
    };
    laws.extend(CREEP_S.map(creep));
    laws
}

/// Damping of the contacts: a force in proportion to the rate at which they store friction, the term `σ₁·dz/dt` of the `LuGre` model (C. Canudas de
/// Wit, H. Olsson, K. J. Åström, P. Lischinsky, *A New Model for Control of Systems with Friction*, IEEE Trans. Autom. Control 40, 1995, eq. 1–3).
/// It makes the stored friction lead, as motion that is known late does, but neither the viscous friction nor the friction at constant sliding. None if
/// the residual without the name (model minus reference) asks for the opposite: no damping makes friction late.
fn contact_damping<'b>(bench: &'b Workbench<'b>, values: &Values, without: &Evaluated<'_, '_>) -> Option<Law<'b>> {
    let mut stored = *values;
    stored[VISCOUS] = 0.0;
    let (stored, record) = (bench.evaluated(&stored), bench.record);
    let stored_rate = move |cycle: usize| rate(&record, |cycle| stored.added_n(cycle), STORING_CYCLES, cycle);
    let products = without.residuals_n().enumerate().map(|(cycle, residual_n)| residual_n * stored_rate(cycle));
    let leads = products.filter(|product| product.is_finite()).sum::<f64>() < 0.0;
    let law = Law::by_cycle(("friction_rate", None), record.rows.len(), stored_rate);
    leads.then_some(Law { least_of_excess: LEAST_OF_DAMPING, ..law })
}

/// Returns the difference of a signal over so many cycles on either side, within the log of the cycle.
fn rate(record: &CableRecord<'_>, signal: impl Fn(usize) -> f64, cycles: usize, cycle: usize) -> f64 {
    let log = record.log_of(cycle);
    let (from, to) = (cycle.saturating_sub(cycles).max(log.start), (cycle + cycles).min(log.end - 1));
    signal(to) - signal(from)
}

#[cfg(test)]
mod tests {
    use super::jumps;

    #[test]
    fn jumps_are_where_they_explain_most() {
        // Samples that are missing do not hide them.
        let signal: Vec<f64> = (0..400).map(|place| 1.0 + 0.5 * f64::from(place % 7)).collect();
        let level = |place: usize| match place {
            0..90 => 0.2,
            90..250 => -0.1,
            _ => 0.4,
        };
        let residual = |place: usize| if (100..120).contains(&place) { f64::NAN } else { level(place) * signal[place] };
        let [one, two] = jumps((0..400).map(residual), |cycle| signal[cycle]);
        for (place, number) in (two.numbers)().enumerate() {
            assert!((number - level(place) * signal[place]).abs() < 1e-12, "{place}");
        }
        // The greater one, from the mean of what is before.
        let numbers: Vec<f64> = (one.numbers)().collect();
        let levels: Vec<f64> = numbers.iter().zip(&signal).map(|(number, signal)| number / signal).collect();
        assert!(levels[..250].iter().all(|level| (level - levels[0]).abs() < 1e-12 && (-0.1..0.2).contains(level)));
        assert!(levels[250..].iter().all(|level| (level - 0.4).abs() < 1e-12));
        assert_eq!((one.of, two.of, levels.len()), (None, None, 400));
    }
}
