//! The models of a question: what may be true, what looks like it, and what a run tells of them.

use std::sync::atomic::AtomicBool;

use fric_core::effects::Effect;
use fric_core::parameters::Values;
use rayon::prelude::*;

use super::criterion::{Measure, Test, Tests, sums_of_logs};
use super::hypothesis::{Hypothesis, Prediction, with_typical, without};
use super::studio::Studio;
use super::{Aim, Goal, KnownParameter, Question};
use crate::candidates::catalogue::has;
use crate::candidates::ripple::period_of;
use crate::discover::naming::STRONG_BIC;
use crate::excite::ExcitationError;
use crate::fit::{CableRecord, Measurements, Parameter};
use crate::search::problem::{Comparison, Loss, Member, Problem};

/// Evidence that would count for something (R. E. Kass, A. E. Raftery, *Bayes factors*, J. Am. Stat. Assoc. 90, 1995: 6 to 10 is strong).
const POSITIVE_BIC: f64 = 6.0;

/// A question with its models.
pub(super) enum QuestionModels {
    /// The true models with those to be distinguished from them, in the order of the question's effects. `first` is the index of the model whose
    /// effect size is known or assumed. The other effect gets the size at which it looks most like the first, and takes part as soon as that is
    /// known.
    Separate {
        base: Values,
        first: usize,
        right: Box<[Option<Hypothesis>; 2]>,
        wrong: [Vec<Hypothesis>; 2],
    },
    Determine {
        model: Hypothesis,
        wanted: Vec<Parameter>,
    },
}

impl QuestionModels {
    /// Returns the greatest period of the ripples that the cable may have, m; `None` if there is none.
    pub(super) fn greatest_period_m(&self) -> Option<f64> {
        let Self::Separate { right, .. } = self else { return None };
        let periods_m = right.iter().flatten().flat_map(|right| {
            let acting = Effect::CATALOGUE.iter().filter(|effect| has(**effect, &right.values));
            acting.filter_map(|effect| Some(right.values[period_of(*effect)?.place()]))
        });
        periods_m.reduce(f64::max)
    }

    /// Drops the question whether the second effect, if it is the true one, can be told from the first, and its figure, if a run of `count` training samples
    /// tells the other half and the first effect imitates the second: apart from its additional parameters it leaves no evidence. A bent sensor that is
    /// nearly straight does what a gain does. Returns `None` if nothing is to be dropped.
    pub(super) fn ask_for_first_alone(&mut self, goal: &mut Goal, count: f64) -> Option<()> {
        let Self::Separate { first, right, wrong, .. } = self else { return None };
        let Goal::Separated { delta_bic, .. } = goal else { return None };
        let second = 1 - *first;
        #[expect(clippy::cast_precision_loss, reason = "a few parameters")]
        let more = wrong[second].last()?.free.len() as f64 - right[second].as_ref()?.free.len() as f64;
        let is_imitated = delta_bic[second]? - more * count.ln() < POSITIVE_BIC;
        if delta_bic[*first]? < STRONG_BIC || !is_imitated {
            return None;
        }
        (right[second], delta_bic[second]) = (None, None);
        Some(())
    }
}

impl Studio<'_> {
    /// Returns the models of a question. The first effect is as in the model, or half as strong as the maximum in machines.
    pub(super) fn case(&self, question: &Question) -> Result<QuestionModels, ExcitationError> {
        let name = self.robot.cable_names().get(question.cable).copied().unwrap_or_default().to_owned();
        let bad = |problem: String| ExcitationError::BadQuestion { problem };
        let record = self.standard.cable(question.cable).ok_or_else(|| bad(format!("there is no cable {name}")))?;
        let model = question.values.unwrap_or_else(|| record.params.values());
        let unlikely = || self.no_forces(&format!("the model of {name} gives no forces on a run"));
        match &question.aim {
            Aim::Determine(wanted) => {
                if let Some(absent) = wanted.iter().find(|of| of.effect().is_some_and(|effect| !has(effect, &model))) {
                    let effect = absent.effect().map_or_else(String::new, |effect| effect.to_string());
                    return Err(bad(format!(
                        "{name} has no `{effect}` in the robot file, so that nobody knows how large `{absent}` may be; add the effect with \
                         the values to be expected"
                    )));
                }
                let mut model = Hypothesis::new(record.params, None, &model).ok_or_else(unlikely)?;
                let missing: Vec<Parameter> = wanted.iter().filter(|of| !model.free.contains(of)).copied().collect();
                model.free.extend(missing);
                Ok(QuestionModels::Determine { model, wanted: wanted.clone() })
            }
            Aim::Separate([one, other]) => {
                if one == other || (one.is_none() && other.is_none()) {
                    return Err(bad("two different effects are needed to be told apart; name two".to_owned()));
                }
                // The effect that the model has comes first, because its size is known.
                let is_known = |effect: &Option<Effect>| effect.is_some_and(|effect| has(effect, &model));
                let swapped = one.is_none() || (!is_known(one) && is_known(other));
                let [known, second] = if swapped { [*other, *one] } else { [*one, *other] };
                let base = without(&without(&model, known), second);
                let with_known = match known {
                    Some(effect) if has(effect, &model) => without(&model, second),
                    Some(effect) => with_typical(&record, &base, effect, self.duration_s).ok_or_else(|| {
                        bad(format!(
                            "{name} has no `{effect}` in the robot file; add it with the values to be expected"
                        ))
                    })?,
                    None => base,
                };
                let right = Hypothesis::new(record.params, known, &with_known).ok_or_else(unlikely)?;
                let stop = self.progress.stop_flag();
                let prediction = Prediction::new(&record, &right.values, stop).ok_or_else(unlikely)?;
                let (alike, _) = prediction.fitted(&base, second, question.noise_n, None).ok_or_else(unlikely)?;
                let first = usize::from(swapped);
                let (mut both, mut wrong) = ([None, None], [Vec::new(), Vec::new()]);
                wrong[1 - first].push(right.clone());
                wrong[first].push(alike);
                both[first] = Some(right);
                Ok(QuestionModels::Separate { base, first, right: Box::new(both), wrong })
            }
        }
    }

    /// Gives the second effect of a question the size at which it looks most like the first on the run of the last forecast. If it is then too small
    /// to be seen, the question of its presence is dropped.
    pub(super) fn establish(
        &self,
        question: &Question,
        measurements: &Measurements<'_>,
        case: &mut QuestionModels,
    ) -> Option<()> {
        let QuestionModels::Separate { base, first, right, wrong } = case else { return Some(()) };
        let Aim::Separate(effects) = question.aim else { return Some(()) };
        let (record, stop) = (measurements.cable(question.cable)?, self.progress.stop_flag());
        let second = effects[1 - *first].and(wrong[*first].last())?.clone();
        let prediction = Prediction::new(&record, &second.values, stop)?;
        let (_, without_it) = prediction.fitted(base, None, question.noise_n, None)?;
        if prediction.evidence(&second, &without_it, question.noise_n) >= STRONG_BIC {
            right[1 - *first] = Some(second);
        }
        Some(())
    }

    /// Returns the tests of all questions with their sums over each log.
    pub(super) fn tests(
        &self,
        cases: &[QuestionModels],
        measurements: &Measurements<'_>,
    ) -> Result<Tests, ExcitationError> {
        let of_case = |(question, case): (&Question, &QuestionModels)| {
            let record = measurements.cable(question.cable)?;
            let stop = self.progress.stop_flag();
            let noise_n = question.noise_n;
            match case {
                QuestionModels::Separate { right, wrong, .. } => {
                    let pairs = right.iter().zip(wrong).filter_map(|(right, wrong)| Some((right.as_ref()?, wrong)));
                    let pairs = pairs.flat_map(|(right, wrong)| wrong.iter().map(move |wrong| (right, wrong)));
                    let test = |(right, wrong): (&Hypothesis, &Hypothesis)| {
                        let prediction = Prediction::new(&record, &right.values, stop)?;
                        let pieces = sums_of_logs(&problem_of(prediction.record(), &wrong.free, stop), &wrong.values)?;
                        Some(Test { measure: Measure::Evidence, noise_n, pieces })
                    };
                    pairs.map(test).collect()
                }
                QuestionModels::Determine { model, wanted } => {
                    let prediction = Prediction::new(&record, &model.values, stop)?;
                    let problem = problem_of(prediction.record(), &model.free, stop);
                    let yardstick =
                        crate::certainty::undetermined::yardsticks(&problem, &[model.values]).first().copied()?;
                    let place = |of: &Parameter| model.free.iter().position(|free| free == of);
                    let wanted = wanted.iter().filter_map(|of| Some((place(of)?, *of))).collect();
                    let measure = Measure::Knowledge { wanted, values: Box::new(model.values), yardstick };
                    Some(vec![Test { measure, noise_n, pieces: sums_of_logs(&problem, &model.values)? }])
                }
            }
        };
        let all: Option<Tests> = self.questions.par_iter().zip(cases).map(of_case).collect();
        all.ok_or_else(|| self.broken_off())
    }

    /// Returns the expected results of a run, and adds the models that come nearest on it to the cases.
    pub(super) fn forecast(&self, measurements: &Measurements<'_>, cases: &mut [QuestionModels]) -> Vec<Option<Goal>> {
        let of_case = |(question, case): (&Question, &mut QuestionModels)| {
            let record = measurements.cable(question.cable)?;
            self.forecast_one(question, &record, case)
        };
        self.questions.par_iter().zip(cases).map(of_case).collect()
    }

    fn forecast_one(&self, question: &Question, record: &CableRecord<'_>, case: &mut QuestionModels) -> Option<Goal> {
        let (stop, noise_n) = (self.progress.stop_flag(), question.noise_n);
        match case {
            QuestionModels::Separate { base, right, wrong, .. } => {
                let mut delta_bic = [None; 2];
                let Aim::Separate(effects) = question.aim else { return None };
                for (place, (right, wrong)) in right.iter().zip(wrong).enumerate() {
                    let Some(right) = right else { continue };
                    let prediction = Prediction::new(record, &right.values, stop)?;
                    let other = effects[1 - place];
                    let (nearest, trial) = prediction.fitted(base, other, noise_n, wrong.last())?;
                    delta_bic[place] = Some(prediction.evidence(right, &trial, noise_n));
                    wrong.push(nearest);
                }
                Some(Goal::Separated { effects, delta_bic })
            }
            QuestionModels::Determine { model, wanted } => {
                let prediction = Prediction::new(record, &model.values, stop)?;
                let problem = problem_of(prediction.record(), &model.free, stop);
                let yardstick =
                    crate::certainty::undetermined::yardsticks(&problem, &[model.values]).first().copied()?;
                let (matrix, ..) = problem.gram(&[model.values])?.normal_equations();
                let inverse = crate::search::gram::inverse_of_normal(&matrix)?;
                let covariance = &inverse * (noise_n * noise_n)
                    + crate::certainty::unlike_pulleys::covariance(&problem, &[model.values], &inverse);
                #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
                let count = record.rows.len() as f64;
                let known = |parameter: &Parameter| {
                    let place = model.free.iter().position(|free| free == parameter)?;
                    let value = model.values[parameter.place()];
                    let standard_error = covariance[(place, place)].sqrt();
                    let leverage = (count * inverse[(place, place)]).sqrt();
                    let vagueness = yardstick.vagueness(parameter, &model.values, standard_error, leverage);
                    Some(KnownParameter { parameter: *parameter, value, standard_error, vagueness })
                };
                Some(Goal::Determined(wanted.iter().filter_map(known).collect()))
            }
        }
    }
}

/// Returns the least-squares problem of a cable over all its samples.
fn problem_of<'r>(record: CableRecord<'r>, free: &[Parameter], stop: &'r AtomicBool) -> Problem<'r> {
    Problem {
        used: vec![true; record.rows.len()],
        members: vec![Member { record, free: free.to_vec() }],
        comparison: Comparison::Forces,
        loss: Loss::Squares,
        stop,
        seat: None,
    }
}
