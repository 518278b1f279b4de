//! Simple laws that effects of the catalogue may wrongly stand in for.
//!
//! Where a force sensor's curve is bent, say, a gain, an offset and a nonlinear load explain nearly all of it together, each with strong evidence, and
//! none of them is there. So a few plain laws are tried as rivals, each as one column or a few of the least-squares problem beside what the named effects
//! add. If a law makes names superfluous, and what is left explains as much as all names did, these names stand in for it, and are set aside. Where the
//! law is that of an effect, this has its turn then.

mod jumps;
mod laws;

use std::cmp::Reverse;

use fric_core::effects::Effect;
use fric_core::parameters::Values;

use self::jumps::jumps;
use self::laws::{Law, Numbers, contact_damping, laws};
use super::NEGLIGIBLE;
use super::projection::{Columns, Signals, visit_less_projection};
use crate::discover::rest::WORTH;
use crate::discover::workbench::{Evaluated, Trial, Workbench};
use crate::fit::Parameter;
use crate::search::problem::Problem;

/// A law that bends an effect's own law removes more than this fraction of the excess above the noise,
const MOST_BENT: f64 = 0.25;
/// and the effect beside the law explains less than this fraction of what it explains alone.
const LEAST_BESIDE_RATIO: f64 = 0.5;
/// A law with levels takes the place of the effect that one level is, if the jumps between them explain this fraction of what one level does: a zero
/// that is off for more than a tenth and less than nine tenths of a log. A wrong zero that also jumps a little is a wrong zero.
const LEAST_OF_JUMPS: f64 = 0.1;

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
    let (mut excess, mut of_noise) = (0.0, 0.0);
    for number in whole.residuals_n().filter(|number| number.is_finite()) {
        excess += number * number - noise_n * noise_n;
        of_noise += noise_n * noise_n;
    }
    let without: Vec<Evaluated<'_, '_>> = effects.iter().map(|(_, neutral)| bench.evaluated(neutral)).collect();
    // Friction warms up; the inertia on trial, for example, does not.
    let mut of_friction = model.values;
    for (parameters, neutral) in effects {
        for place in parameters.iter().filter(|parameter| !parameter.is_friction()).map(Parameter::place) {
            of_friction[place] = neutral[place];
        }
    }
    let laws = laws_beside(bench, &of_friction, kinds, effects, &without);
    let several = laws.iter().map(|law| law.columns.len()).filter(|count| *count > 1).sum::<usize>();
    let listed = listed(&laws, effects.len(), excess);
    let end = effects.len() + laws.iter().map(|law| law.columns.len()).sum::<usize>();
    let signals = || -> Signals<'_> {
        let columns = laws.iter().flat_map(|law| &law.columns);
        let mut of_laws: Vec<(usize, Numbers<'_>)> = columns.map(|numbers| (0, numbers())).collect();
        let (whole, without) = (&whole, &without);
        Box::new(move |cycle, numbers| {
            numbers.extend(without.iter().map(|without| whole.residual_n(cycle) - without.residual_n(cycle)));
            numbers.extend(of_laws.iter_mut().map(|(next, of_law)| {
                let skipped = cycle - std::mem::replace(next, cycle + 1);
                of_law.nth(skipped).unwrap_or(f64::NAN)
            }));
        })
    };
    let mut columns = Columns::new(end, effects.len(), effects.len() + several);
    visit_less_projection(&problem, &model.values, &signals, |cycle, numbers| {
        columns.add(numbers, whole.residual_n(cycle));
    })?;
    let gain = |places: &[usize]| columns.gain(places);
    let all: Vec<usize> = (0..effects.len()).collect();
    let by_name = gain(&all);
    let of_law = |Listed { signal, nearly_ratio, looks_like, level_of, columns: law, least }: &Listed| {
        let is_alike = |name: usize| looks_like.is_empty() || looks_like.contains(&kinds[name]);
        let together = gain(&[&all[..], law].concat());
        let others = |name: usize| -> Vec<usize> { all.iter().copied().filter(|other| *other != name).collect() };
        // What a name explains beside the law, as a fraction of what it explains without.
        let beside =
            |name: usize| (together - gain(&[&others(name)[..], law].concat())) / (by_name - gain(&others(name)));
        let mut places: Vec<usize> = [&all[..], law].concat();
        loop {
            let now = gain(&places);
            let without = |place: usize| {
                let others: Vec<usize> = places.iter().copied().filter(|other| *other != place).collect();
                (now - gain(&others), place)
            };
            // Several columns, or the past, explain something of any rest. That leaves a name what it explains by itself.
            let may_go =
                |place: &usize| *place < effects.len() && (*nearly_ratio <= 0.0 || beside(*place) < LEAST_BESIDE_RATIO);
            let weakest =
                places.iter().copied().filter(may_go).map(without).min_by(|one, other| one.0.total_cmp(&other.0));
            let Some((_, place)) = weakest.filter(|(loss, _)| *loss < enough) else { break };
            places.retain(|other| *other != place);
        }
        let is_level = |name: usize| {
            *level_of == Some(kinds[name]) && together - by_name < LEAST_OF_JUMPS * (by_name - gain(&others(name)))
        };
        if all.iter().any(|name| !places.contains(name) && is_level(*name)) {
            return None;
        }
        let replaces: Vec<usize> = all.iter().copied().filter(|place| !places.contains(place)).collect();
        let gain_left = gain(&places);
        // Several columns easily explain half of what a name does.
        let may_bend = law.len() == 1 && excess > NEGLIGIBLE * of_noise;
        if replaces.is_empty() && may_bend && together - by_name > enough.max(MOST_BENT * excess).max(*least) {
            // The law wins if it explains much of the rest, more than chance would, shares what it explains with one of the names, and explains more in its
            // place. A jump that is placed where a name explains most explains a part of that.
            let shares = all.iter().map(|name| (beside(*name), *name)).min_by(|one, other| one.0.total_cmp(&other.0));
            let (_, name) = shares.filter(|(share, _)| *share < LEAST_BESIDE_RATIO)?;
            let in_its_place = gain(&[&others(name)[..], law].concat());
            if in_its_place <= by_name {
                return None;
            }
            return Some(Rival { signal, replaces: vec![name], gain: together });
        }
        if *nearly_ratio > 0.0 && replaces.is_empty() && excess > WORTH * of_noise {
            // Where more than noise is left, a difference smaller than that does not tell a name from a law.
            let loss = |name: usize| by_name - gain(&[&others(name)[..], law].concat());
            let is_nearly = |name: &usize| {
                let of_name = by_name - gain(&others(*name));
                loss(*name) < (nearly_ratio * of_name).min(excess) && beside(*name) < LEAST_BESIDE_RATIO
            };
            let names = all.iter().copied().filter(|name| is_alike(*name)).filter(is_nearly);
            if let Some(name) = names.min_by(|one, other| loss(*one).total_cmp(&loss(*other))) {
                return Some(Rival { signal, replaces: vec![name], gain: together });
            }
        }
        // Each name that is removed requires one parameter less, each column one more.
        #[expect(clippy::cast_precision_loss, reason = "small counts")]
        let (of_columns, more) = (law.len() as f64 * white, (law.len() - 1) as f64 * white);
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let is_better = match replaces.len() {
            0 => false,
            1 => gain_left > by_name + of_columns.max(*least),
            count => gain_left + (count - 1) as f64 * enough > by_name + more + least,
        };
        is_better.then_some(Rival { signal, replaces, gain: gain_left })
    };
    listed.iter().filter_map(of_law).max_by(|one, other| one.gain.total_cmp(&other.gain))
}

/// Returns the laws that are none of the effects, those of several columns first. `without` lists the model without each of the effects.
fn laws_beside<'b>(
    bench: &'b Workbench<'b>,
    of_friction: &Values,
    kinds: &[Effect],
    effects: &[(Vec<Parameter>, Values)],
    without: &'b [Evaluated<'b, 'b>],
) -> Vec<Law<'b>> {
    let mut laws = laws(bench, of_friction);
    laws.retain(|law| law.of.is_none_or(|of| !kinds.contains(&of)));
    // Whatever has a name may be a jump or two, of the sensor's zero or of the friction, or the damping of the contacts.
    for ((_, neutral), without) in effects.iter().zip(without) {
        let of_zero = jumps(without.residuals_n(), |_| 1.0);
        laws.extend(of_zero.map(|law| Law { level_of: Some(Effect::SensorOffset), ..law }));
        laws.extend(jumps(without.residuals_n(), |cycle| without.added_n(cycle)));
        laws.extend(contact_damping(bench, neutral, without));
    }
    // Only columns of one law are asked for together.
    laws.sort_by_key(|law| Reverse(law.columns.len()));
    laws
}

/// Returns the places of the laws among the columns, from the first that is of no effect.
fn listed(laws: &[Law<'_>], first: usize, excess: f64) -> Vec<Listed> {
    let mut end = first;
    let place = |law: &Law<'_>| {
        let columns: Vec<usize> = (end..end + law.columns.len()).collect();
        end += columns.len();
        let least = law.least_of_excess * excess.max(0.0);
        let Law { signal, nearly_ratio, looks_like, level_of, .. } = *law;
        Listed { signal, nearly_ratio, looks_like, level_of, columns, least }
    };
    laws.iter().map(place).collect()
}

/// A law's place among the columns.
struct Listed {
    signal: &'static str,
    nearly_ratio: f64,
    looks_like: &'static [Effect],
    level_of: Option<Effect>,
    columns: Vec<usize>,
    /// Decrease of the sum of squares that is not enough for it, N².
    least: f64,
}
