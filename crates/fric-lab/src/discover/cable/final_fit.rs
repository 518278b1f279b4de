//! The fit of an extended model to all samples, as an identification of its robot file fits it.

use fric_core::effects::Effect;
use fric_core::parameters::{OFFSET, Values};
use nalgebra::DMatrix;

use super::CableLog;
use crate::certainty::one_load::{is_gain, is_one_load, is_zero};
use crate::certainty::undetermined::{covariance, reported_covariance};
use crate::discover::given::acts;
use crate::discover::workbench::{self, Trial};
use crate::fit::{FitOptions, HALF_INTERVAL, Parameter};
use crate::samples::selection::Standing;
use crate::search::gang::Gang;
use crate::search::problem::Problem;
use crate::search::solve::{Solution, Unknown, contradicts};

/// A model fitted to all samples.
#[derive(Clone)]
pub(super) struct Fitted {
    pub(super) values: Values,
    pub(super) parameters: Vec<Parameter>,
    /// Parameters that the samples do not determine.
    pub(super) undetermined: Vec<Unknown>,
    /// Parameters among those that were fitted whose values are one choice of many, of which the given one is none: a gain under one load, and the friction
    /// that changes with it.
    pub(super) open: Vec<Parameter>,
    pub(super) covariance: DMatrix<f64>,
}

impl Fitted {
    pub(super) fn model(&self) -> workbench::Model {
        workbench::Model { values: self.values, free: self.parameters.clone() }
    }
}

impl CableLog<'_> {
    /// Fits the model with everything found to all samples that count, as an identification of the extended robot file does. Friction that is neither
    /// in the file nor found stays out. An offset that is larger than chance stays out too, because naming has refused it.
    pub(super) fn fitted(&self, counts: &[bool], model: &Trial, noise_n: f64) -> Fitted {
        let fit = FinalFit::new(self, counts, model);
        let with_offset = fit.run(|parameter| parameter.place() == OFFSET);
        let fitted = with_offset.filter(|fitted| fit.has_chance_offset(fitted, noise_n)).or_else(|| fit.run(|_| false));
        let mut fitted = fitted.unwrap_or_else(|| fit.as_named());
        fit.widen_beside_gain(&mut fitted);
        fitted
    }
}

/// The fit of one model to the samples that count.
struct FinalFit<'f, 'a> {
    log: &'f CableLog<'a>,
    counts: &'f [bool],
    model: &'f Trial,
    /// The values of the robot file.
    given: Values,
    /// The parameters that an identification of the robot file fits.
    of_file: Vec<Parameter>,
    standings: Vec<Standing>,
}

impl<'f, 'a> FinalFit<'f, 'a> {
    fn new(log: &'f CableLog<'a>, counts: &'f [bool], model: &'f Trial) -> Self {
        let left_out = log.counts.iter().zip(counts).map(|(all, counts)| *all && !counts);
        let standing = |(standing, left_out)| if left_out { Standing::Flagged } else { standing };
        Self {
            log,
            counts,
            model,
            given: log.record.params.values(),
            of_file: FitOptions::default().shared(&log.record),
            standings: log.standings.iter().copied().zip(left_out).map(standing).collect(),
        }
    }

    /// Fits what an identification of the extended file would fit, as far as it is known, and `also` what is asked for.
    fn run(&self, also: fn(&Parameter) -> bool) -> Option<Fitted> {
        let record = &self.log.record;
        let params = record.params.with_values(&self.model.values).ok()?;
        let mut parameters = FitOptions::default().shared(&record.with_params(&params));
        parameters.retain(|parameter| self.is_known(parameter) || also(parameter));
        let is_gain_open = self.of_file.iter().any(is_gain) && is_one_load(&self.problem(&[]), &self.model.values);
        if is_gain_open {
            parameters.retain(|parameter| !is_zero(parameter));
        }
        let fitted = self.as_given(self.solved(&self.model.values, parameters.clone())?, &parameters, |_| false)?;
        if !is_gain_open {
            return Some(fitted);
        }
        let mut fitted = self.as_given(fitted, &parameters, is_gain)?;
        if fitted.parameters.iter().any(is_gain) {
            let changes = |parameter: &&Parameter| parameter.is_friction() || is_gain(parameter);
            fitted.open = fitted.parameters.iter().filter(changes).copied().collect();
        }
        Some(fitted)
    }

    /// Whether the model says what a parameter is. What the log did not determine stays as given: beside a model that lacks something it would stand for that.
    fn is_known(&self, parameter: &Parameter) -> bool {
        let is_free = self.model.free.contains(parameter) || !acts(parameter, &self.given);
        let is_there = acts(parameter, &self.model.values) || acts(parameter, &self.given);
        !parameter.is_friction() || is_free && is_there
    }

    fn solved(&self, start: &Values, parameters: Vec<Parameter>) -> Option<Fitted> {
        let CableLog { record, stop, .. } = *self.log;
        let params = record.params.with_values(start).ok()?;
        let record = record.with_params(&params);
        let options = FitOptions { parameters: Some(parameters), ..FitOptions::default() };
        let gang = Gang::new(1, stop);
        let search = crate::fit::cables::Search::run(&record, &self.standings, &options, stop, gang.seat(0));
        let Solution { values, undetermined, covariance, unknowns, .. } = search.solution;
        let parameters = unknowns.iter().map(|unknown| unknown.parameter).collect();
        Some(Fitted { values: *values.first()?, parameters, undetermined, open: Vec::new(), covariance })
    }

    /// Returns the fit in which what these samples do not determine, or what `is_held` asks for, is as the file has it, unless they contradict that. The model
    /// that is judged has it so too.
    fn as_given(&self, fitted: Fitted, parameters: &[Parameter], is_held: fn(&Parameter) -> bool) -> Option<Fitted> {
        let problem = self.problem(&[]);
        let (best, mut fitted, mut held) = (fitted.values, fitted, Vec::new());
        loop {
            let stays = |of: &&Parameter| is_held(of) || !fitted.parameters.contains(of) || held.contains(*of);
            held = self.of_file.iter().filter(stays).copied().collect();
            let mut start = fitted.values;
            for place in held.iter().map(Parameter::place) {
                start[place] = self.given[place];
            }
            if start.map(f64::to_bits) == fitted.values.map(f64::to_bits) {
                return Some(fitted);
            }
            let free = parameters.iter().filter(|parameter| !held.contains(parameter)).copied().collect();
            let next = self.solved(&start, free)?;
            if contradicts(&problem, &[next.values], &problem, &[best]) {
                return Some(fitted);
            }
            fitted = next;
        }
    }

    /// Whether an offset was found, or is no larger than chance. An offset that is known less well than a single sample stands in for something else.
    fn has_chance_offset(&self, fitted: &Fitted, noise_n: f64) -> bool {
        let place = fitted.parameters.iter().position(|parameter| parameter.place() == OFFSET);
        let error_n = place.map_or(0.0, |place| fitted.covariance[(place, place)].sqrt());
        let is_chance = fitted.values[OFFSET].abs() <= HALF_INTERVAL * error_n && HALF_INTERVAL * error_n <= noise_n;
        self.model.values[OFFSET].abs() > 0.0 || is_chance
    }

    /// Returns the model as naming has fitted it.
    fn as_named(&self) -> Fitted {
        let Trial { values, free, .. } = self.model;
        let covariance = covariance(&self.problem(free), &[*values]);
        let (undetermined, open) = (Vec::new(), Vec::new());
        Fitted { values: *values, parameters: free.clone(), undetermined, open, covariance }
    }

    /// Widens the errors of a model with a gain of the file to those that it has with a zero of the sensor beside it: what is known of the gain rests on that
    /// zero. A gain that is named has shown itself.
    fn widen_beside_gain(&self, fitted: &mut Fitted) {
        let has_zero =
            self.log.bench(self.counts).has_zero(&fitted.parameters) || fitted.parameters.iter().any(is_zero);
        let is_of_file = self.of_file.iter().any(is_gain);
        if has_zero || !is_of_file || !fitted.parameters.iter().any(is_gain) || !fitted.open.is_empty() {
            return;
        }
        let count = fitted.parameters.len();
        let zero = Parameter::of(Effect::SensorOffset);
        let free: Vec<Parameter> = fitted.parameters.iter().copied().chain(zero).collect();
        let problem = Problem { used: self.counts.to_vec(), ..self.problem(&free) };
        let covariance = reported_covariance(&problem, &[fitted.values], &fitted.undetermined);
        fitted.covariance = covariance.view((0, 0), (count, count)).into_owned();
    }

    fn problem(&self, free: &[Parameter]) -> Problem<'_> {
        self.log.bench(self.counts).problem(free, None)
    }
}
