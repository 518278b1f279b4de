//! Which effects are missing: candidates enter, are exchanged, and have to justify themselves.
//!
//! 1. *Enter.* Every candidate is fitted together with all that the model has. The best on the samples learned from
//!    enters if it also helps on those held out; leniently, for what is still missing colours the residual.
//! 2. *Exchange.* For every effect that has entered, all others are tried in its place.
//! 3. *Leave.* An effect stays if the evidence for it is strong, if it is large enough to matter, and if it explains more than
//!    what remains unexplained: a name that leaves most of the gap open is not the name.

use fric_core::effects::{self, EffectRow};
use fric_core::parameters::MU;

use super::candidates::{self, Scale, fitted, has, is_friction, starts};
use super::evidence::inflation;
use super::workbench::{Model, Trial, Workbench};
use crate::fit::Parameter;

/// Most effects of one cable.
const MOST_EFFECTS: usize = 4;
/// Of the squares above the noise, a candidate has to take away this share to enter.
const LEAST_GAIN: f64 = 0.02;
/// And of the noise itself this share: the rms falls by half of it.
const LEAST_SIZE: f64 = 0.002;
/// What is left above the noise, as a share of it, that is not worth a further search.
const NEGLIGIBLE: f64 = 0.002;
/// Evidence that an effect has to have to stay, and names have to have over each other to be told apart.
pub const STRONG_BIC: f64 = 10.0;
/// Rounds of entering and exchanging.
const ROUNDS: usize = 4;

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
    /// What was found, in the order in which it entered.
    pub named: Vec<Named>,
    /// The models on the way from the first to the last, one more than effects.
    pub ladder: Vec<Trial>,
    /// Every candidate's first fit beside the given model.
    pub first_round: Vec<(&'static EffectRow, Trial)>,
}

/// The search on one cable.
pub struct Search<'b, 'a> {
    /// The cable.
    pub bench: &'b Workbench<'a>,
    /// Noise, N.
    pub noise_n: f64,
    /// For the starts.
    pub scale: Scale,
}

impl Search<'_, '_> {
    /// Names what a model lacks.
    pub fn run(&mut self, base: &Trial) -> Naming {
        let mut model = base.clone();
        let mut rows: Vec<&'static EffectRow> = Vec::new();
        let mut first_round = Vec::new();
        for _ in 0..ROUNDS {
            let before = rows.clone();
            while rows.len() < MOST_EFFECTS && self.excess(&model) > NEGLIGIBLE {
                let tried = self.round(&model, &rows);
                if first_round.is_empty() {
                    first_round.clone_from(&tried);
                }
                let Some((row, trial)) = best(tried).filter(|(_, trial)| self.enters(&model, trial)) else { break };
                rows.push(row);
                model = trial;
            }
            self.exchange(&mut model, &mut rows);
            if kinds(&rows) == kinds(&before) {
                break;
            }
        }
        let named = self.justify(base, &mut model, &mut rows);
        let ladder = self.ladder(base, &model, &rows);
        Naming { model, named, ladder, first_round }
    }

    /// Mean square above the noise of the samples held out, as a share of the noise's.
    pub fn excess(&self, trial: &Trial) -> f64 {
        trial.held_out / self.noise_squares() - 1.0
    }

    /// Squares that noise alone leaves in the samples held out, N².
    fn noise_squares(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let count = self.bench.count(true) as f64;
        count * self.noise_n * self.noise_n
    }

    /// Whether a candidate is let in.
    fn enters(&self, before: &Trial, after: &Trial) -> bool {
        let gain = before.held_out - after.held_out;
        let gap = (before.held_out - self.noise_squares()).max(0.0);
        gain > LEAST_GAIN * gap && gain > LEAST_SIZE * self.noise_squares()
    }

    /// Each candidate that a model lacks, fitted beside all that it has; the ladder of friction comes before everything else.
    fn round(&mut self, model: &Trial, rows: &[&'static EffectRow]) -> Vec<(&'static EffectRow, Trial)> {
        self.renew_scale(model);
        let lacks = |row: &&'static EffectRow| !has(row, &model.values) && !contains(rows, row);
        let friction: Vec<&'static EffectRow> = effects::named()
            .filter(|row| is_friction(row))
            .filter(lacks)
            .filter(|row| self.is_possible(row, model))
            .collect();
        if !friction.is_empty() {
            let tried = self.try_rows(model, &friction);
            if tried.iter().any(|(_, trial)| self.enters(model, trial)) {
                return tried;
            }
        }
        let others: Vec<&'static EffectRow> = effects::named().filter(|row| !is_friction(row)).filter(lacks).collect();
        self.try_rows(model, &others)
    }

    /// Presliding needs friction to preslide.
    fn is_possible(&self, row: &EffectRow, model: &Trial) -> bool {
        row.kind != "presliding" || model.values[MU] > 0.0
    }

    fn renew_scale(&mut self, model: &Trial) {
        self.scale.periods_m = candidates::periods_m(&self.bench.record, &self.bench.residuals_n(&model.values));
    }

    /// The best fit of each row beside a model.
    fn try_rows(&self, model: &Trial, rows: &[&'static EffectRow]) -> Vec<(&'static EffectRow, Trial)> {
        let mut models = Vec::new();
        let mut owners = Vec::new();
        for row in rows {
            for values in starts(row, &model.values, &self.scale, &self.bench.record) {
                let mut free = model.free.clone();
                free.extend(fitted(row).into_iter().filter(|parameter| !model.free.contains(parameter)));
                models.push(Model { values, free });
                owners.push(*row);
            }
        }
        let mut tried: Vec<(&'static EffectRow, Trial)> = Vec::new();
        for (row, trial) in owners.into_iter().zip(self.bench.try_all(&models)) {
            match tried.iter_mut().find(|(of, _)| of.kind == row.kind) {
                Some((_, best)) if trial.training < best.training => *best = trial,
                Some(_) => {}
                None => tried.push((row, trial)),
            }
        }
        tried.retain(|(_, trial)| trial.training.is_finite());
        tried
    }

    /// A model without one of its effects, fitted anew.
    fn without(&self, model: &Trial, row: &EffectRow) -> Trial {
        let mut values = model.values;
        for parameter in Parameter::of_row(row) {
            values[parameter.place()] = parameter.row().neutral;
        }
        let fitted = fitted(row);
        let free: Vec<Parameter> = model.free.iter().copied().filter(|parameter| !fitted.contains(parameter)).collect();
        self.bench.try_one(&Model { values, free })
    }

    /// Tries all other effects in the place of each.
    fn exchange(&mut self, model: &mut Trial, rows: &mut [&'static EffectRow]) {
        for place in 0..rows.len() {
            let Some(row) = rows.get(place).copied() else { continue };
            let Some((other, trial)) = self.alternative(model, rows, row) else { continue };
            if trial.training < model.training && trial.held_out < model.held_out {
                *model = trial;
                rows[place] = other;
            }
        }
    }

    /// The best other effect in the place of one.
    fn alternative(
        &mut self,
        model: &Trial,
        rows: &[&'static EffectRow],
        row: &'static EffectRow,
    ) -> Option<(&'static EffectRow, Trial)> {
        if is_friction(row) {
            return None;
        }
        let without = self.without(model, row);
        let others: Vec<&'static EffectRow> = rows.iter().copied().chain([row]).collect();
        best(self.round(&without, &others))
    }

    /// Takes away what cannot justify itself, the weakest first.
    fn justify(&mut self, base: &Trial, model: &mut Trial, rows: &mut Vec<&'static EffectRow>) -> Vec<Named> {
        loop {
            let mut named = Vec::new();
            for row in rows.clone() {
                let without = self.without(model, row);
                let inflation = inflation(self.bench, model, &fitted(row));
                named.push(Named { row, without, runner_up: None, inflation });
            }
            let remains = (model.held_out - self.noise_squares()).max(0.0);
            let gain = |named: &Named| named.without.held_out - model.held_out;
            let fails = |named: &&Named| {
                let strong = self.delta_bic(&named.without, model, named.inflation) < -STRONG_BIC;
                !(strong && gain(named) > LEAST_SIZE * self.noise_squares() && gain(named) > remains)
            };
            let weakest = named.iter().filter(fails).min_by(|one, other| gain(one).total_cmp(&gain(other)));
            let Some(weakest) = weakest.map(|named| named.row) else {
                for named in &mut named {
                    named.runner_up = self.alternative(model, rows, named.row);
                }
                return named;
            };
            rows.retain(|row| row.kind != weakest.kind);
            *model = if rows.is_empty() { base.clone() } else { self.without(model, weakest) };
        }
    }

    /// Difference of Schwarz's criterion from one model to another over the samples learned from; negative speaks for the other.
    pub fn delta_bic(&self, from: &Trial, to: &Trial, inflation: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts")]
        let (count, more) = (self.bench.count(false) as f64 / inflation, to.free.len() as f64 - from.free.len() as f64);
        count * (to.training / from.training).ln() + more * count.ln()
    }

    /// The given model, then one effect more at each step.
    fn ladder(&self, base: &Trial, model: &Trial, rows: &[&'static EffectRow]) -> Vec<Trial> {
        let mut ladder = vec![model.clone()];
        for row in rows.iter().skip(1).rev() {
            let Some(last) = ladder.last() else { break };
            let shorter = self.without(last, row);
            ladder.push(shorter);
        }
        if !rows.is_empty() {
            ladder.push(base.clone());
        }
        ladder.reverse();
        ladder
    }
}

/// The best on the samples learned from.
fn best(tried: Vec<(&'static EffectRow, Trial)>) -> Option<(&'static EffectRow, Trial)> {
    tried.into_iter().min_by(|(_, one), (_, other)| one.training.total_cmp(&other.training))
}

fn contains(rows: &[&'static EffectRow], row: &EffectRow) -> bool {
    rows.iter().any(|of| of.kind == row.kind)
}

fn kinds(rows: &[&'static EffectRow]) -> Vec<&'static str> {
    rows.iter().map(|row| row.kind).collect()
}
