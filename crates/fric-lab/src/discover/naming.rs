//! Which effects are missing: candidates enter, are exchanged, and have to justify themselves.
//!
//! 1. *Enter.* Every candidate is fitted together with all that the model has. The best on the samples learned from
//!    enters if it also helps on those held out; leniently, for what is still missing colours the residual.
//! 2. *Exchange.* For every effect that has entered, all others are tried in its place.
//! 3. *Leave.* An effect stays if the evidence for it is strong, if it is large enough to matter, if it explains more than
//!    what remains unexplained (a name that leaves most of the gap open is not the name), and if its parameters keep clear of the
//!    ends of their ranges: a law that is bent as far as it goes imitates something else.

use std::collections::BTreeMap;

use fric_core::effects::pulley_inertia::MASS;
use fric_core::effects::time_delay::DELAY;
use fric_core::effects::{self, EffectRow, pulley_eccentricity};
use fric_core::parameters::{MU, VISCOUS, Values};

use super::candidates::{Scale, fitted, has, is_friction, starts};
use super::evidence::inflation;
use super::noise::white_noise_throughout;
use super::ripple::periods_m;
use super::workbench::{Model, NEAR_ERRORS, Trial, Workbench};
use crate::fit::Parameter;
use crate::fit::engine::Coordinate;

/// Most effects of one cable.
const MOST_EFFECTS: usize = 4;
/// Of the squares above the noise, a candidate has to take away this share to enter: of those that are left,
const LEAST_GAIN: f64 = 0.02;
/// and of those that the given model leaves, with the friction that every model has. Real friction is never quite that of an equation, and what the equation of a strong
/// effect leaves must not be taken for a weak one.
const LEAST_GAIN_OF_ALL: f64 = 0.004;
/// And of the noise itself this share: the rms falls by half of it.
const LEAST_SIZE: f64 = 0.002;
/// What is left above the noise, as a share of it, from which on no further name is sought: the rms is half of it above.
const NEGLIGIBLE: f64 = 0.01;
/// Candidates are first brought so near to their minima that what is left to gain is this part of what a candidate needs to enter.
const UNDECIDED: f64 = 0.5;
/// Speeds and accelerations that are taken from differences lag, by less than this many cycles.
const LAG_CYCLES: f64 = 1.0;
/// Of the way from its neutral value to an end of its range, a parameter that has less than this share left has run into the end.
const END_RATIO: f64 = 0.01;
/// Evidence that an effect has to have to stay, and names have to have over each other to be told apart. 10 would do if the memory of the residual were
/// known; where noise wanders, the best of a dozen candidates comes to nearly 30 by chance, and effects that are there mostly to hundreds.
pub const STRONG_BIC: f64 = 30.0;
/// The named model is brought this near to its minimum, in standard errors.
const AT_MINIMUM: f64 = 0.01;
/// Rounds of entering and exchanging.
const ROUNDS: usize = 2;

/// Names of effects in the order of the alphabet.
type Kinds = Vec<&'static str>;

/// An effect in a model with what speaks for it.
#[derive(Clone, Debug)]
pub struct Named {
    /// Its row.
    pub row: &'static EffectRow,
    /// The model without it, fitted anew.
    pub without: Trial,
    /// The best other effect in its place.
    pub runner_up: Option<(&'static EffectRow, Trial)>,
    /// By how much memory in the residual weakens the evidence, at least 1.
    pub inflation: f64,
}

/// What came out.
#[derive(Clone, Debug)]
pub struct Naming {
    /// The model with all that was found.
    pub model: Trial,
    /// The given model with what it lacked of the friction that every model has.
    pub with_friction: Trial,
    /// What was found, in the order in which it entered.
    pub named: Vec<Named>,
    /// The models on the way from the first to the last, one more than effects.
    pub ladder: Vec<Trial>,
    /// Every candidate's first fit beside the given model.
    pub first_round: Vec<(&'static EffectRow, Trial)>,
}

/// The search on one cable. Every set of effects is fitted once.
pub struct Search<'b, 'a> {
    bench: &'b Workbench<'a>,
    noise_squares: f64,
    scale: Scale,
    fits: BTreeMap<Kinds, Trial>,
}

impl<'b, 'a> Search<'b, 'a> {
    /// From the given model, fitted; `noise_n` is the standard deviation of the noise.
    pub fn new(bench: &'b Workbench<'a>, noise_n: f64, scale: Scale, base: &Trial) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let noise_squares = bench.count(true) as f64 * noise_n * noise_n;
        Self { bench, noise_squares, scale, fits: BTreeMap::from([(Kinds::new(), base.clone())]) }
    }

    /// Names what the model lacks.
    pub fn run(&mut self) -> Naming {
        let mut rows: Vec<&'static EffectRow> = Vec::new();
        let base = self.fit(&rows);
        let first_round = if self.excess(&base) > NEGLIGIBLE { self.round(&rows) } else { Vec::new() };
        for _ in 0..ROUNDS {
            let before = rows.clone();
            self.enter(&mut rows);
            self.exchange(&mut rows);
            if kinds(&rows) == kinds(&before) {
                break;
            }
        }
        let named = self.justify(&mut rows);
        self.polish(&rows);
        let ladder = (0..=rows.len()).map(|count| self.fit(rows.get(..count).unwrap_or_default())).collect();
        Naming { model: self.fit(&rows), with_friction: self.fit(&friction_of(&rows)), named, ladder, first_round }
    }

    /// Difference of Schwarz's criterion from one model to another over the samples learned from; negative speaks for the other.
    pub fn delta_bic(&self, from: &Trial, to: &Trial, inflation: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (self.bench.count(false) as f64 / inflation, to.free.len() as f64 - from.free.len() as f64);
        delta_bic(count, to.training / from.training, more)
    }

    /// Mean square above the noise of the samples held out, as a share of the noise's.
    fn excess(&self, trial: &Trial) -> f64 {
        trial.held_out / self.noise_squares - 1.0
    }

    /// What the white noise of a model's residual has of the squares held out, where it is loud too, N².
    fn noise_squares_throughout(&self, model: &Trial) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = self.bench.count(true) as f64;
        let residual_n = self.bench.residuals_n(&model.values);
        let throughout_n = white_noise_throughout(&self.bench.measured_of(&residual_n));
        throughout_n.map_or(self.noise_squares, |noise_n| (count * noise_n * noise_n).max(self.noise_squares))
    }

    /// Lets the best candidates in as long as they help.
    fn enter(&mut self, rows: &mut Vec<&'static EffectRow>) {
        while rows.len() < MOST_EFFECTS {
            let model = self.fit(rows);
            if self.excess(&model) <= NEGLIGIBLE {
                break;
            }
            let enough = self.least_gain(rows, &model);
            let Some((row, _)) = best(self.round(rows)).filter(|(_, trial)| gains(&model, trial, enough)) else {
                break;
            };
            rows.push(row);
        }
    }

    /// By how much the squares of the samples held out have to fall for a candidate to be let in beside some effects, N².
    fn least_gain(&mut self, rows: &[&'static EffectRow], before: &Trial) -> f64 {
        let noise_squares = self.noise_squares;
        let gap = |trial: &Trial| (trial.held_out - noise_squares).max(0.0);
        let all = gap(&self.fit(&friction_of(rows)));
        (LEAST_GAIN * gap(before)).max(LEAST_GAIN_OF_ALL * all).max(LEAST_SIZE * self.noise_squares)
    }

    /// Each candidate that a model lacks, fitted beside all that it has; the ladder of friction comes before everything else.
    fn round(&mut self, rows: &[&'static EffectRow]) -> Vec<(&'static EffectRow, Trial)> {
        let model = self.fit(rows);
        let lacking = |friction: bool| -> Vec<&'static EffectRow> {
            let slides = model.values[MU] > 0.0;
            effects::named()
                .filter(|row| is_friction(row) == friction && !has(row, &model.values) && !contains(rows, row))
                .filter(|row| row.kind != "presliding" || slides)
                .collect()
        };
        let friction = self.beside(rows, &lacking(true));
        let enough = self.least_gain(rows, &model);
        if friction.iter().any(|(_, trial)| gains(&model, trial, enough)) {
            return friction;
        }
        self.beside(rows, &lacking(false))
    }

    /// The model with one more effect, for each of several.
    fn beside(
        &mut self,
        rows: &[&'static EffectRow],
        candidates: &[&'static EffectRow],
    ) -> Vec<(&'static EffectRow, Trial)> {
        let with = |row: &&'static EffectRow| kinds(&[rows, &[*row]].concat());
        let model = self.fit(rows);
        let unknown: Vec<&'static EffectRow> =
            candidates.iter().copied().filter(|row| !self.fits.contains_key(&with(row))).collect();
        if unknown.iter().any(|row| row.kind == "pulley_eccentricity") {
            let residuals_n = self.bench.residuals_n(&model.values);
            self.scale.periods_m = periods_m(&self.bench.record, &residuals_n);
        }
        let (mut models, mut owners) = (Vec::new(), Vec::new());
        for row in unknown {
            for values in starts(row, &model.values, &self.scale, &self.bench.record) {
                let mut free = model.free.clone();
                free.extend(fitted(row).into_iter().filter(|parameter| !model.free.contains(parameter)));
                models.push(Model { values, free });
                owners.push(with(&row));
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "counts of samples")]
        let [learned, held_out] = [false, true].map(|held_out| self.bench.count(held_out) as f64);
        let needed = self.least_gain(rows, &model) * learned / held_out;
        let near_errors = (UNDECIDED * needed * learned / model.training).sqrt().max(NEAR_ERRORS);
        for (owner, trial) in owners.into_iter().zip(self.bench.try_all(&models, near_errors)) {
            let is_better = self.fits.get(&owner).is_none_or(|other| trial.training < other.training);
            if trial.training.is_finite() && is_better {
                self.fits.insert(owner, trial);
            }
        }
        // Those that may enter, and may be the best, come to their minima.
        let trained = |row: &&'static EffectRow| self.fits.get(&with(row)).map(|trial| trial.training);
        let enough = model.training - UNDECIDED * needed;
        let bound = candidates.iter().filter_map(trained).fold(enough, |least, training| least.min(training + needed));
        let contenders: Vec<&'static EffectRow> =
            candidates.iter().copied().filter(|row| trained(row).is_some_and(|training| training < bound)).collect();
        self.refine(contenders.iter().map(with));
        candidates.iter().filter_map(|row| Some((*row, self.fits.get(&with(row))?.clone()))).collect()
    }

    /// Brings the models with some sets of effects to their minima.
    fn refine(&mut self, sets: impl Iterator<Item = Kinds>) {
        let coarse: Vec<Kinds> =
            sets.filter(|set| self.fits.get(set).is_some_and(|trial| trial.near_errors > NEAR_ERRORS)).collect();
        let models: Vec<Model> = coarse.iter().filter_map(|set| self.fits.get(set)).map(Trial::model).collect();
        let fits = self.bench.try_all(&models, NEAR_ERRORS);
        self.fits.extend(coarse.into_iter().zip(fits));
    }

    /// The model with a set of effects. One that has not been tried yet is fitted from the best that has one more.
    fn fit(&mut self, rows: &[&'static EffectRow]) -> Trial {
        let set = kinds(rows);
        self.refine(std::iter::once(set.clone()));
        if let Some(trial) = self.fits.get(&set) {
            return trial.clone();
        }
        let larger = self
            .fits
            .iter()
            .filter(|(kinds, _)| kinds.len() == set.len() + 1 && set.iter().all(|kind| kinds.contains(kind)))
            .min_by(|(_, one), (_, other)| one.training.total_cmp(&other.training));
        let Some((larger, of_larger)) = larger else { return self.fit(&[]) };
        let mut model = of_larger.model();
        for row in effects::named().filter(|row| larger.contains(&row.kind) && !set.contains(&row.kind)) {
            for parameter in Parameter::of_row(row) {
                model.values[parameter.place()] = parameter.row().neutral;
            }
            let of_row = fitted(row);
            model.free.retain(|parameter| !of_row.contains(parameter));
        }
        let trial = self.bench.try_one(&model);
        self.fits.insert(set, trial.clone());
        trial
    }

    /// Brings the model with a set of effects to its minimum, the period of a ripple with it: it was found by a scan.
    fn polish(&mut self, rows: &[&'static EffectRow]) {
        let mut model = self.fit(rows).model();
        if contains(rows, &pulley_eccentricity::ROW) {
            let is_period = |parameter: &Parameter| parameter.place() == pulley_eccentricity::PERIOD;
            model.free.extend(Parameter::all().find(is_period));
        }
        self.fits.insert(kinds(rows), self.bench.fit(&model, AT_MINIMUM));
    }

    /// Tries all other effects in the place of each.
    fn exchange(&mut self, rows: &mut [&'static EffectRow]) {
        for place in 0..rows.len() {
            let Some((other, trial)) = self.alternative(rows, place) else { continue };
            let model = self.fit(rows);
            if trial.training < model.training && trial.held_out < model.held_out {
                rows[place] = other;
            }
        }
    }

    /// The best other effect in the place of one; friction that every model has stays.
    fn alternative(&mut self, rows: &[&'static EffectRow], place: usize) -> Option<(&'static EffectRow, Trial)> {
        let row = *rows.get(place)?;
        if is_friction(row) {
            return None;
        }
        let others: Vec<&'static EffectRow> = rows.iter().copied().filter(|other| other.kind != row.kind).collect();
        best(self.round(&others).into_iter().filter(|(other, _)| other.kind != row.kind))
    }

    /// Takes away what cannot justify itself, the weakest first.
    fn justify(&mut self, rows: &mut Vec<&'static EffectRow>) -> Vec<Named> {
        loop {
            let model = self.fit(rows);
            let mut named = Vec::new();
            for row in rows.iter().copied() {
                let others: Vec<&'static EffectRow> =
                    rows.iter().copied().filter(|other| other.kind != row.kind).collect();
                let inflation = inflation(self.bench, &model, &fitted(row));
                named.push(Named { row, without: self.fit(&others), runner_up: None, inflation });
            }
            let remains = (model.held_out - self.noise_squares_throughout(&model)).max(0.0);
            let gain = |named: &Named| named.without.held_out - model.held_out;
            let fails = |named: &&Named| {
                let strong = self.delta_bic(&named.without, &model, named.inflation) < -STRONG_BIC;
                let cycle_s = self.bench.record.cycle_s;
                let is_real =
                    !is_lag(named.row, &model.values, cycle_s) && !is_at_end(named.row, &model.values, cycle_s);
                !(is_real && strong && gain(named) > LEAST_SIZE * self.noise_squares && gain(named) > remains)
            };
            let weakest = named.iter().filter(fails).min_by(|one, other| gain(one).total_cmp(&gain(other)));
            let Some(weakest) = weakest.map(|named| named.row.kind) else {
                for (place, named) in named.iter_mut().enumerate() {
                    named.runner_up = self.alternative(rows, place);
                }
                return named;
            };
            rows.retain(|row| row.kind != weakest);
        }
    }
}

/// Difference of Schwarz's criterion for so many samples that do not depend on each other, a ratio of the sums of squares, and so many
/// more parameters; of less than two samples there is no evidence.
fn delta_bic(count: f64, squares_ratio: f64, more: f64) -> f64 {
    if count < 2.0 { f64::INFINITY } else { count * squares_ratio.ln() + more * count.ln() }
}

/// Whether an effect is no greater than what the lag of differences makes of another: of the acceleration of `pulley_inertia` a
/// delay, of the speed v in viscous friction `viscous·(v − a·lag)` an inertia.
fn is_lag(row: &EffectRow, values: &Values, cycle_s: f64) -> bool {
    let lag_s = LAG_CYCLES * cycle_s;
    match row.kind {
        "time_delay" => values[MASS] > 0.0 && values[DELAY].abs() < lag_s,
        "pulley_inertia" => values[MASS] < values[VISCOUS] * lag_s,
        _ => false,
    }
}

/// Whether a parameter of an effect has run into an end of its range that is not its neutral value; of friction that every model
/// has the ranges are orders of magnitude.
fn is_at_end(row: &EffectRow, values: &Values, cycle_s: f64) -> bool {
    let has_run = |parameter: &Parameter| {
        let (least, greatest) = Coordinate::of(parameter, cycle_s).range();
        let neutral = parameter.row().neutral;
        let left = |end: f64| (end - values[parameter.place()]).abs() / (end - neutral).abs();
        [least, greatest].into_iter().any(|end| left(end) < END_RATIO)
    };
    !is_friction(row) && fitted(row).iter().any(has_run)
}

/// Whether a model has so much less of the squares held out than another, N².
fn gains(before: &Trial, after: &Trial, enough: f64) -> bool {
    before.held_out - after.held_out > enough
}

/// Those that every model has.
fn friction_of(rows: &[&'static EffectRow]) -> Vec<&'static EffectRow> {
    rows.iter().copied().filter(|row| is_friction(row)).collect()
}

/// The best on the samples learned from.
fn best(tried: impl IntoIterator<Item = (&'static EffectRow, Trial)>) -> Option<(&'static EffectRow, Trial)> {
    tried.into_iter().min_by(|(_, one), (_, other)| one.training.total_cmp(&other.training))
}

fn contains(rows: &[&'static EffectRow], row: &EffectRow) -> bool {
    rows.iter().any(|of| of.kind == row.kind)
}

fn kinds(rows: &[&'static EffectRow]) -> Kinds {
    let mut kinds: Kinds = rows.iter().map(|row| row.kind).collect();
    kinds.sort_unstable();
    kinds
}

#[cfg(test)]
mod tests {
    use fric_core::effects::pulley_inertia::MASS;
    use fric_core::effects::time_delay::DELAY;
    use fric_core::effects::{presliding_shape, pulley_inertia, stribeck, time_delay};
    use fric_core::parameters::{PARAMETER_COUNT, VISCOUS, Values};

    use super::{delta_bic, fitted, is_at_end, is_lag};
    use crate::fit::Parameter;

    const CYCLE_S: f64 = 1e-3;

    fn neutral() -> Values {
        let mut values = [0.0; PARAMETER_COUNT];
        for parameter in Parameter::all() {
            values[parameter.place()] = parameter.row().neutral;
        }
        values
    }

    #[test]
    fn what_a_lag_of_half_a_cycle_makes_is_no_effect() {
        let mut values = neutral();
        (values[VISCOUS], values[MASS], values[DELAY]) = (0.3, 0.3 * 0.5 * CYCLE_S, -0.5 * CYCLE_S);
        assert!(is_lag(&pulley_inertia::ROW, &values, CYCLE_S) && is_lag(&time_delay::ROW, &values, CYCLE_S));
        assert!(!is_lag(&stribeck::ROW, &values, CYCLE_S));
        (values[MASS], values[DELAY]) = (0.01, 2.0 * CYCLE_S);
        assert!(!is_lag(&pulley_inertia::ROW, &values, CYCLE_S) && !is_lag(&time_delay::ROW, &values, CYCLE_S));
        (values[MASS], values[DELAY]) = (0.0, 0.5 * CYCLE_S);
        assert!(!is_lag(&time_delay::ROW, &values, CYCLE_S));
    }

    #[test]
    fn a_parameter_at_the_end_of_its_range_has_run_into_it() {
        for (row, inside, end) in
            [(presliding_shape::ROW, 0.5, 0.3), (stribeck::ROW, 2.0, 5.0), (time_delay::ROW, 0.02, 0.063)]
        {
            let place = fitted(&row)[0].place();
            for (value, has_run) in [(inside, false), (end, true), (end * (1.0 - 1e-6), true)] {
                let mut values = neutral();
                values[place] = value;
                assert_eq!(is_at_end(&row, &values, CYCLE_S), has_run, "{}: {value}", row.kind);
            }
        }
        // At an end that is the neutral value there is only little of the effect.
        assert!(!is_at_end(&pulley_inertia::ROW, &neutral(), CYCLE_S));
    }

    #[test]
    fn what_nothing_is_known_of_is_no_evidence() {
        let few = delta_bic(10.0, 0.5, 1.0);
        assert!((few - (10.0 * 0.5_f64.ln() + 10.0_f64.ln())).abs() < 1e-12);
        assert!(delta_bic(0.0, 0.5, 1.0) > 0.0 && delta_bic(1.5, 0.01, 1.0) > 0.0);
    }
}
