//! The result of a search by the wrench: each cable, the wrench before and after, the corrections of the robot file.

use std::sync::Arc;

use fric_core::robot::PlatformOptions;
use fric_core::robot::edit::PlatformEdit;
use nalgebra::{DMatrix, Matrix6};

use super::bench::{Bench, Trial};
use super::candidate::Candidate;
use super::geometry::{Geometry, entries};
use super::model::{Model as WrenchModel, Unknown};
use super::naming::{Named, Naming};
use super::{Edits, GeometryFinding, WrenchDeviation, WrenchDiscovery, too_short};
use crate::certainty::determined::HALF_INTERVAL;
use crate::discover::cable::BELIEVED_RATIO;
use crate::discover::figures::curve::curves;
use crate::discover::report::{CableDiscovery, Finding, Model, RunnerUp, Tried, Unexplained, Verdict};
use crate::discover::rest::places::Excess;
use crate::discover::rest::{WORTH, ranges, wander, with_interpolated};
use crate::fit::{FitError, Parameter, Row, SampleCounts};
use crate::recording_fault::RecordingFault;
use crate::replay::Deviation;
use crate::samples::conditions::conditions;
use crate::set_up::SetUp;

/// Something is left of the wrench if its mean square exceeds that of noise, friction error and wander by more than this fraction, 1.1 times the rms. A cable's
/// own verdict does not see it where the whitening takes it for noise. Of an independent simulator's logs, those that are rightly called complete or extended
/// have up to 1.09 times the noise alone, so that half of this would refuse some; twice as much still finds all its forces from outside, at 3 times and more.
const MOST_EXCESS: f64 = 0.21;

/// A finished search.
pub struct Case<'b, 'a> {
    pub bench: &'b Bench<'a>,
    /// The given model, fitted.
    pub base: &'b Trial,
    pub naming: &'b Naming,
    /// The extended model, fitted to all samples.
    pub fitted: &'b Trial,
    pub samples: SampleCounts,
    /// The faults of each cable's sensor.
    pub faults: &'b [Vec<RecordingFault>],
    /// The time of each sample, s since the first one.
    pub times_s: Arc<Vec<f64>>,
}

impl Case<'_, '_> {
    /// Returns the result from the covariances of the extended model's unknowns ([`Bench::covariances`]). Without them, none counts as determined.
    ///
    /// # Errors
    /// [`FitError`] if the log is too short to estimate the noise.
    pub fn report(&self, covariances: Option<[DMatrix<f64>; 2]>) -> Result<WrenchDiscovery, FitError> {
        let Self { bench, base, naming, fitted, .. } = *self;
        let plain = Bench { whitening: Matrix6::identity(), ..bench.clone() };
        let noise = plain.noise(&fitted.model).ok_or_else(too_short)?;
        let held_out = bench.used(true);
        let deviation = |trial: &Trial| WrenchDeviation::of(&plain.deviations(&trial.model), &held_out);
        let (before, after) = (deviation(base), deviation(fitted));
        let [covariance, independent] = covariances.unwrap_or_else(|| {
            let count = fitted.model.unknowns().len();
            [(); 2].map(|()| DMatrix::from_element(count, count, f64::INFINITY))
        });
        let cables: Vec<CableDiscovery> =
            (0..bench.records.len()).map(|cable| self.cable(cable, &covariance)).collect();
        let is_any = |verdict: Verdict| cables.iter().any(|cable| cable.verdict == verdict);
        let is_of_no_cable =
            !is_any(Verdict::Unexplained) && plain.leaves_more_than_noise(&fitted.model, &after, &noise, &cables);
        let verdict = if is_of_no_cable || is_any(Verdict::Unexplained) {
            Verdict::Unexplained
        } else if naming.named.is_empty() {
            Verdict::Complete
        } else {
            Verdict::Extended
        };
        let changes = &fitted.model.changes;
        let description = &bench.description;
        let geometry = naming
            .geometries()
            .map(|(named, of)| GeometryFinding {
                geometry: of,
                numbers: description.corrected(of, changes),
                delta_bic: named.delta_bic,
            })
            .collect();
        let alike = naming.named.iter().filter_map(|named| match named.candidate {
            Candidate::Alike(effect) => Some(effect),
            _ => None,
        });
        let point = |of: Geometry| {
            let numbers = changes.contains_key(&of).then(|| description.corrected(of, changes));
            numbers.and_then(|numbers| numbers.first_chunk::<3>().copied())
        };
        let count = bench.records.len();
        let inertia_kg_m2 = self.inertia_kg_m2(&[covariance.clone(), independent]);
        let edits = Edits {
            platform: PlatformEdit { inertia_kg_m2, ..description.platform_edit(changes) },
            base_m: (0..count).map(|cable| point(Geometry::Base(cable))).collect(),
            platform_m: (0..count).map(|cable| point(Geometry::Attachment(cable))).collect(),
        };
        let tried = naming.tried.iter().filter_map(|tried| match tried.candidate {
            Candidate::Own(..) => None,
            Candidate::Geometry(of) => Some((of.key().to_owned(), of.cable(), tried.refusal)),
            Candidate::Alike(effect) => Some((effect.kind().to_owned(), None, tried.refusal)),
        });
        Ok(WrenchDiscovery {
            reference: description.reference,
            verdict,
            is_of_no_cable,
            before,
            after,
            noise,
            alike: alike.collect(),
            geometry,
            tried: tried.collect(),
            inertia_kg_m2,
            edits,
            cables,
        })
    }

    /// Returns the fitted inertia tensor in the order of the file's key, if the log determines it and the file states none or another one. `covariances` are
    /// those of [`Bench::covariances`].
    ///
    /// Each moment has to be known to within half of it, as it is asked of a parameter, by its interval of 95 % and by the greatest shift that an error of
    /// the friction could cause; a log of few turns has a large one. Noise of the poses makes the moments too small, so there must be little.
    fn inertia_kg_m2(&self, covariances: &[DMatrix<f64>; 2]) -> Option<[f64; 6]> {
        let Self { bench, fitted, .. } = *self;
        let (model, description) = (&fitted.model, &bench.description);
        let tensor_kg_m2 = description.platform_edit(&model.changes).inertia_kg_m2?;
        #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
        let samples = (bench.count(false) + bench.count(true)) as f64;
        let believed = bench.believed_wrench(model, BELIEVED_RATIO, &vec![0.0; bench.records.len()]);
        let shift = (samples * believed.iter().map(|error| error * error).sum::<f64>()).sqrt();
        let half_widths: Vec<f64> = model
            .unknowns()
            .iter()
            .enumerate()
            .filter(|(_, unknown)| matches!(unknown, Unknown::Geometry(Geometry::Inertia, _)))
            .map(|(column, _)| covariances.each_ref().map(|of| of[(column, column)].sqrt()))
            .map(|[error, independent]| HALF_INTERVAL * error + shift * independent)
            .collect();
        let is_known = |moment: usize| half_widths.get(moment).is_some_and(|half| *half < 0.5 * tensor_kg_m2[moment]);
        let given_kg_m2 = entries(&description.robot.inertia_kg_m2());
        let differs = (0..tensor_kg_m2.len()).any(|number| {
            half_widths.get(number).is_some_and(|half| (tensor_kg_m2[number] - given_kg_m2[number]).abs() > *half)
        });
        let is_tensor =
            PlatformOptions { inertia_kg_m2: tensor_kg_m2, ..PlatformOptions::default() }.is_inertia_of_a_body();
        ([0, 3, 5].into_iter().all(is_known) && differs && is_tensor && description.sees_turns())
            .then_some(tensor_kg_m2)
    }

    /// Returns the result of one cable.
    fn cable(&self, cable: usize, covariance: &DMatrix<f64>) -> CableDiscovery {
        let Self { bench, base, naming, fitted, samples, faults, .. } = *self;
        let record = &bench.records[cable];
        let residual_n = |trial: &Trial| bench.of_cable_n(&trial.model, &bench.deviations(&trial.model), cable);
        let (residual_before_n, residual_after_n) = (residual_n(base), residual_n(fitted));
        let noise_n = bench.white_noise(residual_after_n.iter().copied()).unwrap_or(f64::NAN);
        // No friction model is exact, of this cable and of the others.
        let believed_n = bench.believed_n(&fitted.model, cable, BELIEVED_RATIO);
        let floor_n = noise_n.hypot(believed_n);
        let excess = Excess { record, blocks: &bench.blocks, residual_n: &residual_after_n, noise_n: floor_n };
        let share = excess.share();
        let all = if share <= WORTH { Vec::new() } else { conditions(record) };
        let places = excess.places(&all);
        let wander = wander(&excess, &places).map_or(0.0, |(wander, _)| wander);
        let is_noise = share - wander <= WORTH * (1.0 + wander);
        let model = |trial: &Trial, covariance: &DMatrix<f64>| {
            let (columns, fitted): (Vec<usize>, Vec<Parameter>) = trial
                .model
                .unknowns()
                .into_iter()
                .enumerate()
                .filter_map(|(column, unknown)| match unknown {
                    Unknown::Own(of, parameter) if of == cable => Some((column, parameter)),
                    Unknown::Alike(parameter) => Some((column, parameter)),
                    _ => None,
                })
                .unzip();
            Model {
                values: trial.model.values[cable],
                covariance: covariance.select_rows(&columns).select_columns(&columns),
                fitted,
                held_out_n: Deviation::default(),
            }
        };
        let findings: Vec<Finding> = naming.named.iter().filter_map(|named| finding(named, cable)).collect();
        let tried = naming.tried.iter().filter_map(|tried| match tried.candidate {
            Candidate::Own(of, effect) if of == cable => {
                let (delta_bic, refusal) = (tried.delta_bic, tried.refusal);
                Some(Tried { effect, delta_bic, held_out_rms_n: f64::NAN, refusal, takes_rest: false })
            }
            _ => None,
        });
        let unexplained = (!is_noise).then(|| Unexplained {
            rms_n: (share.max(0.0) * floor_n * floor_n).sqrt(),
            places: places.clone(),
            intervals_s: excess.intervals_s(|cycle| {
                residual_after_n.get(cycle).is_some_and(|number: &f64| number.abs() > 4.0 * floor_n)
            }),
            neighbours: Vec::new(),
        });
        let sound: Vec<bool> = record.rows.iter().map(Row::is_sound).collect();
        let judging = Bench { counts: with_interpolated(&bench.counts, bench.measured, &sound), ..bench.clone() };
        let count = base.model.unknowns().len();
        CableDiscovery {
            samples,
            reference_variation_n: f64::NAN,
            held_out: ranges(judging.used(true).into_iter())
                .into_iter()
                .map(|range| [range.start, range.end])
                .collect(),
            noise_floor_n: noise_n,
            wander_n: floor_n * wander.sqrt(),
            verdict: match (&unexplained, findings.is_empty()) {
                (Some(_), _) => Verdict::Unexplained,
                (None, true) => Verdict::Complete,
                (None, false) => Verdict::Extended,
            },
            before: model(base, &DMatrix::from_element(count, count, f64::NAN)),
            after: model(fitted, covariance),
            per_log: Vec::new(),
            findings,
            candidates: Vec::new(),
            tried: tried.collect(),
            places: Vec::new(),
            faults: faults.get(cable).cloned().unwrap_or_default(),
            unexplained,
            lack: None,
            profiles: Vec::new(),
            curves: curves(record, &residual_before_n, &residual_after_n),
            times_s: Arc::clone(&self.times_s),
            residual_before_n,
            residual_after_n,
            set_up: SetUp::default(),
        }
    }
}

impl Bench<'_> {
    /// Whether the force or the torque that a model leaves is more than noise, the error of the friction model and the wander of the cables' sensors.
    fn leaves_more_than_noise(
        &self,
        model: &WrenchModel,
        after: &WrenchDeviation,
        noise: &[f64; 6],
        cables: &[CableDiscovery],
    ) -> bool {
        let wander_n: Vec<f64> = cables.iter().map(|cable| cable.wander_n).collect();
        let known = self.believed_wrench(model, BELIEVED_RATIO, &wander_n);
        [0..3, 3..6].into_iter().any(|part| {
            let sum = |of: &[f64]| of.get(part.clone()).unwrap_or_default().iter().map(|one| one * one).sum::<f64>();
            sum(&after.components) > (1.0 + MOST_EXCESS) * (sum(noise) + sum(&known))
        })
    }
}

/// Returns a name as a finding of a cable; `None` if the cable does not have the effect.
fn finding(named: &Named, cable: usize) -> Option<Finding> {
    let effect = match named.candidate {
        Candidate::Alike(effect) => effect,
        Candidate::Own(of, effect) if of == cable => effect,
        _ => return None,
    };
    let runner_up = named.runner_up.and_then(|(candidate, delta_bic, is_as_good)| {
        let effect = candidate.effect()?;
        Some(RunnerUp { effect, delta_bic, held_out_squares: f64::NAN, is_as_good })
    });
    Some(Finding { effect, held_out_n: Deviation::default(), delta_bic: named.delta_bic, runner_up })
}
