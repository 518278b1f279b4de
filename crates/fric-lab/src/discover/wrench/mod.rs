//! Discovery with no force sensor at the platform: all cables jointly against the outside wrench, measured or by mass and pose.
//!
//! `A^T f(p) + w = 0` (\[P\] 3) has six equations a sample. The deviations are weighed by the inverse of their covariance, which is found anew with
//! every model that is better. For verdicts on a cable its share of a deviation is the error of its force alone that comes nearest to it:
//! what is said of one cable's rest may sit in another whose force has the same lever.
//!
//! **What it cannot see.** Forces that hold each other in balance (`A^T f = 0`: inner tension) change no wrench; what does the same to the
//! force of every cable in such a combination has no evidence and is not named.

mod bench;
mod geometry;
mod naming;
mod screen;
mod sensors;

use fric_core::Wrench;
use fric_core::effects::Effect;
use fric_core::robot::edit::{CableEdit, rewrite, set_platform};
use fric_core::robot::file::{RobotFile, RobotFileError};
use nalgebra::{DMatrix, Matrix6, Vector6};

use self::bench::{Bench, Trial, Unknown};
use self::geometry::{Changes, Description};
use self::naming::{Named, Naming, Search};
use self::screen::Candidate;
use self::sensors::Sensors;
use super::cable::{BELIEVED_RATIO, acts};
use super::extended::extended;
use super::faults::RecordingFault;
use super::figures::curve::curves;
use super::naming::Refusal;
use super::report::{CableDiscovery, Finding, Model, RunnerUp, Tried, Unexplained, Verdict};
use super::rest::places::Excess;
use super::rest::{WORTH, ranges, wander, with_interpolated};
use crate::fit::wrench::{ReferenceWrenches, first_model};
use crate::fit::{CableRecord, FitError, Measurements, Parameter, Progress, Row};
use crate::replay::{Deviation, WrenchErrors, WrenchReference};
use crate::samples::conditions::conditions;
use crate::samples::split::split;

pub use geometry::Geometry;

/// Searches with what was found taken for given, and deviations weighed by it.
const LOOKS: usize = 3;
/// How near to its minimum a model comes that is reported, in standard errors.
const AT_MINIMUM: f64 = 0.1;
/// A direction with less than this share of the greatest variance, components on one scale, has rounding only.
const LEAST_VARIANCE_RATIO: f64 = 1e-9;

/// What came out for all cables together.
#[derive(Clone, Debug)]
pub struct WrenchDiscovery {
    /// Each cable: its effects and its model. What concerns a reference force of its own is not there.
    pub cables: Vec<CableDiscovery>,
    /// What the forces were compared with.
    pub reference: WrenchReference,
    /// Of all cables together.
    pub verdict: Verdict,
    /// Deviation of the given model on the samples held out.
    pub before: WrenchDeviation,
    /// And of the extended one.
    pub after: WrenchDeviation,
    /// White noise of the six components, N and N m.
    pub noise: [f64; 6],
    /// Effects that all cables have alike.
    pub alike: Vec<Effect>,
    /// What is wrong about the description of the robot.
    pub geometry: Vec<GeometryFinding>,
    /// What helps and does not suffice, and is of no cable alone: names and reasons.
    pub tried: Vec<(String, Refusal)>,
    edits: Edits,
}

/// Deviation of the wrench.
#[derive(Clone, Copy, Debug, Default)]
pub struct WrenchDeviation {
    /// Of force and torque.
    pub errors: WrenchErrors,
    /// Root mean square of each component, N and N m.
    pub components: [f64; 6],
}

/// A number of the robot file that is wrong.
#[derive(Clone, Debug)]
pub struct GeometryFinding {
    /// Which.
    pub geometry: Geometry,
    /// What it should be, in the order of [`Geometry::names`].
    pub numbers: Vec<f64>,
    /// Schwarz's criterion with it less without it; negative speaks for it.
    pub delta_bic: f64,
}

/// What is to be written beside the parameters.
#[derive(Clone, Debug)]
struct Edits {
    platform: fric_core::robot::edit::PlatformEdit,
    base_m: Vec<Option<[f64; 3]>>,
    platform_m: Vec<Option<[f64; 3]>>,
}

/// Looks at all cables with the wrench on the platform; for [`Measurements`] with [`Reference::Wrench`](crate::fit::Reference::Wrench) of a robot of
/// which every cable has an attachment.
///
/// # Errors
/// [`FitError`] where the wrench cannot tell the forces of the cables, or the log is too short to tell the noise.
pub fn discover_wrench(measurements: &Measurements<'_>, progress: &Progress) -> Result<WrenchDiscovery, FitError> {
    let sensors = Sensors::of(measurements, &ReferenceWrenches::of(measurements)?);
    let measurements = &sensors.measurements;
    let references = ReferenceWrenches::of(measurements)?;
    let records: Vec<CableRecord<'_>> = measurements.cables().collect();
    progress.begin(LOOKS + 1);
    let is_sound = |place: usize| sensors.is_faulty.get(place) != Some(&true);
    let first = first_model(measurements, &references, &is_sound, acts, progress);
    let description = Description {
        robot: measurements.robot(),
        reference: references.kind,
        poses: measurements.poses(),
        structure: measurements.structure(),
        outside: &references.outside,
    };
    let mut bench = Bench {
        blocks: records.first().map(split).unwrap_or_default(),
        records,
        description,
        counts: crate::fit::cables::used(&first.standings),
        measured: &references.measured,
        whitening: Matrix6::identity(),
        stop: progress.stop_flag(),
    };
    let given = bench::Model { values: first.values, free: first.free, alike: Vec::new(), changes: Changes::new() };
    bench.whitening = whitening(&bench, &given).ok_or_else(too_short)?;
    let base = bench.fit(&given, AT_MINIMUM);
    let mut naming = Naming { trial: base.clone(), named: Vec::new(), tried: Vec::new() };
    for _ in 0..LOOKS {
        bench.whitening = whitening(&bench, &naming.trial.model).ok_or_else(too_short)?;
        let noise = noise_of(&bench, &naming.trial).ok_or_else(too_short)?;
        let believed_square = bench.believed_square(&naming.trial.model, BELIEVED_RATIO);
        let noise_square = bench.unit_square(&naming.trial.model)
            * (noise.iter().map(|noise| noise * noise).sum::<f64>() + believed_square);
        let again = bench.judged(base.model.clone());
        let search = Search::new(&bench, again, noise_square);
        let before = naming.named.iter().map(|named| named.candidate).collect::<Vec<_>>();
        naming = search.run(&naming.named, &naming.trial.model);
        progress.finish_one();
        if naming.named.iter().all(|named| before.contains(&named.candidate)) {
            break;
        }
    }
    // As an identification does it, with all samples.
    let mut all = bench.clone();
    all.blocks.iter_mut().for_each(|block| block.held_out = false);
    let fitted = naming.confirmed(&all, |model| all.fit(&with_given(&all, model), AT_MINIMUM));
    let covariances = all.covariances(&fitted.model);
    Case {
        bench: &bench,
        base: &base,
        naming: &naming,
        fitted: &fitted,
        samples: crate::samples::selection::count(&first.standings),
        faults: &sensors.faults,
    }
    .report(covariances.map(|[covariance, _]| covariance))
}

/// A model with the given friction where the samples do not determine it, now that it has what it lacked.
fn with_given(bench: &Bench<'_>, model: &bench::Model) -> bench::Model {
    let (_, all) = bench.with_problem(model, bench.used(false), |problem| {
        crate::certainty::undetermined::vagueness(problem, &model.values)
    });
    let mut held = model.clone();
    for (_, of) in all.into_iter().filter(|(vagueness, of)| *vagueness > 1.0 && of.parameter.effect().is_none()) {
        let place = of.parameter.place();
        held.free[of.member].retain(|free| *free != of.parameter);
        held.values[of.member][place] = bench.records[of.member].params.values()[place];
    }
    held
}

fn too_short() -> FitError {
    FitError::new(
        "the log is too short to tell what the noise of the wrench is".to_owned(),
        "Record a run of 10 s or longer in which the platform moves.",
    )
}

/// What turns the deviations of a model into independent ones of variance 1. Directions in which a robot has none, such as torques of a point that
/// hangs on cables, stay out.
fn whitening(bench: &Bench<'_>, model: &bench::Model) -> Option<Matrix6<f64>> {
    let plain = Bench { whitening: Matrix6::identity(), ..bench.clone() };
    let deviations = plain.deviations(model);
    let finite = || deviations.iter().filter(|deviation| deviation.iter().all(|part| part.is_finite()));
    let count = finite().fold(0.0, |count, _| count + 1.0);
    let covariance = finite().map(|deviation| deviation * deviation.transpose()).sum::<Matrix6<f64>>() / count;
    // Forces and torques on one scale.
    let size = |component: usize| covariance[(component, component)].sqrt();
    let unit = Matrix6::from_fn(|row, column| if row == column && size(row) > 0.0 { size(row).recip() } else { 0.0 });
    let eigen = (unit * covariance * unit).symmetric_eigen();
    let greatest = eigen.eigenvalues.max();
    let root = |value: f64| if value > LEAST_VARIANCE_RATIO * greatest { value.sqrt().recip() } else { 0.0 };
    let scaled = Matrix6::from_diagonal(&eigen.eigenvalues.map(root)) * eigen.eigenvectors.transpose() * unit;
    (greatest > 0.0 && scaled.iter().all(|entry| entry.is_finite())).then_some(scaled)
}

/// Standard deviation of the white noise in each component of the deviations.
fn noise_of(bench: &Bench<'_>, trial: &Trial) -> Option<[f64; 6]> {
    let deviations = bench.deviations(&trial.model);
    let mut noise = [0.0; 6];
    for (component, noise) in noise.iter_mut().enumerate() {
        *noise = bench.white_noise(deviations.iter().map(|deviation| deviation[component]))?;
    }
    Some(noise)
}

/// What is to be reported of.
struct Case<'b, 'a> {
    bench: &'b Bench<'a>,
    base: &'b Trial,
    naming: &'b Naming,
    /// The extended model, fitted to all samples.
    fitted: &'b Trial,
    samples: crate::fit::SampleCounts,
    /// What was wrong with the sensor of each cable.
    faults: &'b [Vec<RecordingFault>],
}

impl Case<'_, '_> {
    fn report(&self, covariance: Option<DMatrix<f64>>) -> Result<WrenchDiscovery, FitError> {
        let Self { bench, base, naming, fitted, .. } = *self;
        let plain = Bench { whitening: Matrix6::identity(), ..bench.clone() };
        let noise = noise_of(&plain, fitted).ok_or_else(too_short)?;
        let held_out = bench.used(true);
        let deviation = |trial: &Trial| WrenchDeviation::of(&plain.deviations(&trial.model), &held_out);
        let (before, after) = (deviation(base), deviation(fitted));
        let covariance = covariance.unwrap_or_else(|| {
            let count = fitted.model.unknowns().len();
            DMatrix::from_element(count, count, f64::INFINITY)
        });
        let cables: Vec<CableDiscovery> =
            (0..bench.records.len()).map(|cable| self.cable(cable, &covariance)).collect();
        let is_any = |verdict: Verdict| cables.iter().any(|cable| cable.verdict == verdict);
        let verdict = if is_any(Verdict::Unexplained) {
            Verdict::Unexplained
        } else if naming.named.is_empty() {
            Verdict::Complete
        } else {
            Verdict::Extended
        };
        let changes = &fitted.model.changes;
        let description = &bench.description;
        let geometry = naming::geometries(&naming.named)
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
        let edits = Edits {
            platform: description.platform_edit(changes),
            base_m: (0..count).map(|cable| point(Geometry::Base(cable))).collect(),
            platform_m: (0..count).map(|cable| point(Geometry::Attachment(cable))).collect(),
        };
        let tried = naming.tried.iter().filter_map(|tried| match tried.candidate {
            Candidate::Alike(effect) => Some((effect.kind().to_owned(), tried.refusal)),
            Candidate::Geometry(of) => Some((of.key().to_owned(), tried.refusal)),
            Candidate::Own(..) => None,
        });
        Ok(WrenchDiscovery {
            reference: description.reference,
            verdict,
            before,
            after,
            noise,
            alike: alike.collect(),
            geometry,
            tried: tried.collect(),
            edits,
            cables,
        })
    }

    fn cable(&self, cable: usize, covariance: &DMatrix<f64>) -> CableDiscovery {
        let Self { bench, base, naming, fitted, samples, faults } = *self;
        let record = &bench.records[cable];
        let residual_n = |trial: &Trial| bench.of_cable_n(&trial.model, &bench.deviations(&trial.model), cable);
        let (residual_before_n, residual_after_n) = (residual_n(base), residual_n(fitted));
        let noise_n = bench.white_noise(residual_after_n.iter().copied()).unwrap_or(f64::NAN);
        // No model is believed to less than a share of the tension; such errors of all cables may add up.
        let believed_n = bench.believed_n(&fitted.model, cable, BELIEVED_RATIO);
        let floor_n = noise_n.hypot(believed_n);
        let excess = Excess { record, blocks: &bench.blocks, residual_n: &residual_after_n, noise_n: floor_n };
        let share = excess.share();
        let all = if share <= WORTH { Vec::new() } else { conditions(record) };
        let places = excess.places(&all);
        let wander = if share <= WORTH { 0.0 } else { wander(&excess, &places) };
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
                Some(Tried { effect, delta_bic: tried.delta_bic, held_out_rms_n: f64::NAN, refusal: tried.refusal })
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
        let is_sound = |place: usize| record.rows.get(place).is_some_and(Row::is_sound);
        let judging = Bench { counts: with_interpolated(&bench.counts, bench.measured, is_sound), ..bench.clone() };
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
            findings,
            candidates: Vec::new(),
            tried: tried.collect(),
            places: Vec::new(),
            faults: faults.get(cable).cloned().unwrap_or_default(),
            unexplained,
            lack: None,
            profiles: Vec::new(),
            curves: curves(record, &residual_before_n, &residual_after_n),
            times_s: (0..record.rows.len()).map(|cycle| record.time_s(cycle)).collect(),
            residual_before_n,
            residual_after_n,
        }
    }
}

/// A name as one of a cable's.
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

impl WrenchDeviation {
    fn of(deviations: &[Vector6<f64>], held_out: &[bool]) -> Self {
        let mut errors = WrenchErrors::default();
        let (mut squares, mut count) = (Vector6::zeros(), 0.0);
        for (deviation, _) in deviations.iter().zip(held_out).filter(|(_, held_out)| **held_out) {
            if deviation.iter().all(|part| part.is_finite()) {
                errors.add(&Wrench {
                    force_n: deviation.fixed_rows::<3>(0).into(),
                    torque_nm: deviation.fixed_rows::<3>(3).into(),
                });
                squares += deviation.component_mul(deviation);
                count += 1.0;
            }
        }
        Self { errors, components: (squares / count).map(f64::sqrt).into() }
    }
}

/// The text of a robot file with what was found: as [`extended`], and corrected numbers of platform and geometry in their places.
///
/// # Errors
/// [`RobotFileError`] as [`rewrite`].
pub fn extended_by_wrench(text: &str, origin: &str, found: &WrenchDiscovery) -> Result<String, RobotFileError> {
    let text = extended(text, origin, &found.cables)?;
    let robot = RobotFile::parse(&text, origin)?;
    let points = found.edits.base_m.iter().zip(&found.edits.platform_m);
    let edits: Vec<CableEdit<'_>> = robot
        .cable_names()
        .into_iter()
        .zip(points)
        .map(|(name, (base_m, platform_m))| CableEdit {
            name,
            base_m: *base_m,
            platform_m: *platform_m,
            ..CableEdit::default()
        })
        .collect();
    let text = rewrite(&text, origin, &edits)?;
    if found.edits.platform == fric_core::robot::edit::PlatformEdit::default() {
        return Ok(text);
    }
    set_platform(&text, origin, &found.edits.platform)
}
