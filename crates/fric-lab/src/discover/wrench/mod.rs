//! Discovery without force sensors at the platform: all cables jointly against the outside wrench, measured or computed from mass and pose.
//!
//! `A^T f(p) + w = 0` (\[P\] 3) gives six equations per sample: the wrenches of the cable forces `f` and the outside wrench `w` add up to zero. Their
//! deviations are multiplied by a whitening, the inverse root of their covariance, and it is computed again from each better model. For the verdict on a
//! single cable, its share of a deviation is the error of its force alone that comes nearest to the deviation. If cables have similar lever arms, the
//! cause may be in another one.
//!
//! **What the wrench does not show.** Cable forces in balance with each other (`A^T f = 0`, inner tension) have no wrench. An effect that changes the
//! forces of all cables in such a combination leaves no evidence and is not named.

mod bench;
mod candidate;
mod covariance;
mod geometry;
mod lengths;
mod model;
mod naming;
mod report;
mod screen;
mod sensors;

use std::sync::Arc;

use fric_core::Wrench;
use fric_core::effects::Effect;
use fric_core::robot::edit::{CableEdit, rewrite, set_platform};
use fric_core::robot::file::{RobotFile, RobotFileError};
use nalgebra::{Matrix6, Vector6};

use self::bench::{Bench, Trial};
use self::covariance::{reweighted, whitening};
use self::geometry::Description;
use self::model::Model;
use self::naming::{Naming, Search};
use self::sensors::Sensors;
use super::extended::extended;
use super::given::acts;
use super::naming::Refusal;
use super::report::{CableDiscovery, Verdict};
use super::rest::WORTH;
use crate::fit::wrench::{ReferenceWrenches, first_model};
use crate::fit::{CableRecord, FitError, Measurements, Progress, Stages};
use crate::replay::{WrenchErrors, WrenchReference};
use crate::samples::split::split;
use crate::search::solve::GROSS_CONTRADICTION;

pub use geometry::Geometry;

/// Maximum number of searches in a chain. Each starts from the names of the one before, with the whitening and the noise of its model.
const LOOKS: usize = 3;
/// Distance from its minimum to which the reported model is optimised, in standard errors.
const AT_MINIMUM: f64 = 0.1;
/// The result for all cables together.
#[derive(Clone, Debug)]
pub struct WrenchDiscovery {
    /// The effects and the model of each cable. Everything that needs a reference force of the cable is empty or NaN.
    pub cables: Vec<CableDiscovery>,
    /// The reference of the comparison.
    pub reference: WrenchReference,
    /// The verdict on all cables together.
    pub verdict: Verdict,
    /// Whether something is left that no error of one cable's force accounts for: the cables' own verdicts do not see it.
    pub is_of_no_cable: bool,
    /// Deviation of the given model on the held-out samples.
    pub before: WrenchDeviation,
    /// Deviation of the extended model on the held-out samples.
    pub after: WrenchDeviation,
    /// Standard deviation of the white noise in the six components, N and N m.
    pub noise: [f64; 6],
    /// Effects that all cables have with the same parameters.
    pub alike: Vec<Effect>,
    /// Wrong entries of the robot file.
    pub geometry: Vec<GeometryFinding>,
    /// Candidates of all cables or of the robot file that help but do not suffice: names, the cable whose entry it is, and reasons.
    pub tried: Vec<(String, Option<usize>, Refusal)>,
    /// The fitted inertia tensor in the order of the file's key, if the log determines it.
    pub inertia_kg_m2: Option<[f64; 6]>,
    edits: Edits,
}

/// Deviation of the cables' wrench from its reference.
#[derive(Clone, Copy, Debug, Default)]
pub struct WrenchDeviation {
    /// Errors of force and torque.
    pub errors: WrenchErrors,
    /// Root mean square of each component, N and N m.
    pub components: [f64; 6],
}

/// A wrong entry of the robot file.
#[derive(Clone, Debug)]
pub struct GeometryFinding {
    /// The entry.
    pub geometry: Geometry,
    /// Its corrected numbers, in the order of [`Geometry::names`].
    pub numbers: Vec<f64>,
    /// BIC of the model with the correction minus that of the model without it; negative values favour the correction.
    pub delta_bic: f64,
}

/// Corrections of the robot file in addition to the parameters of the friction.
#[derive(Clone, Debug)]
struct Edits {
    platform: fric_core::robot::edit::PlatformEdit,
    base_m: Vec<Option<[f64; 3]>>,
    platform_m: Vec<Option<[f64; 3]>>,
}

/// Finds what the model lacks from the wrench on the platform. Takes [`Measurements`] with [`Reference::Wrench`](crate::fit::Reference::Wrench) of a robot
/// whose cables all have attachments.
///
/// # Errors
/// [`FitError`] if the wrench does not determine the forces of the cables, or if the log is too short to estimate the noise.
pub fn discover_wrench(measurements: &Measurements<'_>, progress: &Progress) -> Result<WrenchDiscovery, FitError> {
    let sensors = Sensors::of(measurements, &ReferenceWrenches::of(measurements)?);
    let measurements = &sensors.measurements;
    let references = ReferenceWrenches::of(measurements)?;
    let records: Vec<CableRecord<'_>> = measurements.cables().collect();
    progress.begin(2 * LOOKS + 1);
    let is_sound = |place: usize| sensors.is_faulty.get(place) != Some(&true);
    let first = first_model(measurements, &references, &is_sound, acts, progress);
    let description = Description {
        robot: measurements.robot(),
        reference: references.kind,
        poses: measurements.poses(),
        motions: &references.motions,
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
        effort: Arc::default(),
    };
    let given =
        Model { values: first.values, free: first.free, alike: Vec::new(), changes: bench.description.fitted() };
    bench.whitening = whitening(&bench, &given).ok_or_else(too_short)?;
    let base = bench.fit(&given, AT_MINIMUM);
    let nothing = Naming::start(base.clone(), &bench.whitening, Vec::new());
    let mut search = Search::new(&bench, &base, &base.model).ok_or_else(too_short)?;
    let doubted = if search.is_explained() { None } else { naming::sensors_doubted(&bench, &base) };
    // The better start first, and the other one if that leaves something.
    let (start, other_start) = match doubted {
        Some(doubted) if search.is_worse_than(&doubted) => {
            search = Search::new(&bench, &base, &doubted.trial.model).ok_or_else(too_short)?;
            (doubted, Some(nothing))
        }
        doubted => (nothing, doubted),
    };
    let mut naming = searched(&bench, &base, search, start, progress)?;
    if let Some(start) = other_start.filter(|_| !naming.is_complete && !naming.is_cut_short) {
        let search = Search::new(&bench, &base, &start.trial.model).ok_or_else(too_short)?;
        let other = searched(&bench, &base, search, start, progress)?;
        if naming::is_better(&bench, &other, &naming.trial, &naming.candidates()) {
            naming = other;
        }
    }
    // The reported model is fitted to all samples, as an identification does it, with the covariance of its own deviations.
    let mut all = bench.clone();
    all.blocks.iter_mut().for_each(|block| block.held_out = false);
    all.whitening = naming.whitening;
    let confirmed = |naming: &mut Naming| {
        naming.confirmed(&all, |model| reweighted(&all, fit_with_given(&all, model), fit_with_given))
    };
    let (mut fitted, mut whitening) = confirmed(&mut naming).ok_or_else(too_short)?;
    // Names that leave more of the wrench than there was stand for something that the whitening has taken for noise.
    if !naming.named.is_empty() && leaves_more(&bench, &base.model, &fitted.model) {
        let tried = std::mem::take(&mut naming.tried);
        naming = Naming { tried, ..Naming::start(base.clone(), &bench.whitening, Vec::new()) };
        (fitted, whitening) = confirmed(&mut naming).ok_or_else(too_short)?;
    }
    all.whitening = whitening;
    bench.whitening = whitening;
    let covariances = all.covariances(&fitted.model);
    report::Case {
        bench: &bench,
        base: &base,
        naming: &naming,
        fitted: &fitted,
        samples: crate::samples::selection::count(&first.standings),
        faults: &sensors.faults,
        times_s: measurements.times_s(),
    }
    .report(covariances)
}

/// Returns what a chain of searches names that begins with some names.
fn searched<'a>(
    bench: &Bench<'a>,
    base: &Trial,
    mut search: Search<'a>,
    mut naming: Naming,
    progress: &Progress,
) -> Result<Naming, FitError> {
    let stages = Stages::new(progress, LOOKS);
    for look in 1.. {
        let before = naming.candidates();
        naming = search.run(&naming);
        stages.finish_one();
        if look == LOOKS
            || naming.is_cut_short
            || naming.candidates().iter().all(|candidate| before.contains(candidate))
        {
            break;
        }
        search = Search::new(bench, base, &naming.trial.model).ok_or_else(too_short)?;
    }
    Ok(naming)
}

/// Fits a model in which friction that the samples do not determine beside the names has its given values; with these in what grossly contradicts the samples,
/// it is varied too.
fn fit_with_given(bench: &Bench<'_>, model: &Model) -> Trial {
    let held = bench.fit(&with_given(bench, model), AT_MINIMUM);
    let most = GROSS_CONTRADICTION * bench.judged(model.clone()).training;
    if held.training <= most { held } else { bench.fit(model, AT_MINIMUM) }
}

/// Returns a model in which friction that the samples do not determine beside the names has its given values and is not varied.
fn with_given(bench: &Bench<'_>, model: &Model) -> Model {
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

/// Whether a model leaves more of the wrench than another one on the held-out samples, by more than its noise may differ.
fn leaves_more(bench: &Bench<'_>, before: &Model, after: &Model) -> bool {
    let plain = Bench { whitening: Matrix6::identity(), ..bench.clone() };
    let held_out = bench.used(true);
    let components = |model: &Model| WrenchDeviation::of(&plain.deviations(model), &held_out).components;
    let Some(noise) = plain.noise(before) else { return false };
    let (after, before) = (components(after), components(before));
    let squares = |of: [f64; 6]| -> f64 {
        of.into_iter().zip(noise).filter(|(_, noise)| *noise > 0.0).map(|(rms, noise)| (rms / noise).powi(2)).sum()
    };
    #[expect(clippy::cast_precision_loss, reason = "at most six")]
    let count = noise.iter().filter(|noise| **noise > 0.0).count() as f64;
    squares(after) - squares(before) > WORTH * count
}

fn too_short() -> FitError {
    FitError::new(
        "the log is too short to tell what the noise of the wrench is".to_owned(),
        "Record a run of 10 s or longer in which the platform moves.",
    )
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

/// Returns the text of a robot file with the effects found, as [`extended`] does, and with the corrected entries of platform and geometry.
///
/// # Errors
/// Returns the [`RobotFileError`] of [`rewrite`].
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
