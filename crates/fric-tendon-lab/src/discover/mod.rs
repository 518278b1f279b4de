//! Discovery on a manipulator: what a manipulator file lacks or has wrong.
//!
//! The search starts with bending, loads and measurement: `machine` searches among the `candidate`s on one cost of tensions and markers (`joint`),
//! with friction and calibration lines free within their prior uncertainty. With these findings in the file, the search for friction follows, on the
//! tensions alone.
//!
//! The workflow is that of [`fric_lab::discover`]: the given model, fitted to half of the run in blocks, leaves a gap above the noise on
//! the other half; candidates enter one after the other where they help on the samples held out; what is left is noise, or
//! unexplained. The residual is that of the tensions in the segments: gratings less model.
//!
//! | effect | the file has | what it names |
//! |---|---|---|
//! | `coulomb` | `mu = 0` | friction at the holes at all |
//! | `presliding` | no `sigma_n_per_m` | holes remember: their friction follows from the history, not from one direction |
//! | `sensor_drift` | | the shift of a grating drifts with time, as one that warms up |
//! | `hole_friction` | | a hole has a μ of its own |
//!
//! A wrong calibration line (for instance that of another grating) has no name: a drift must explain more than it would. If a rest remains, a
//! grating, or a hole between two gratings, is only named if no more remains there than at the others.
//!
//! The calibration errors of the lines are estimated together with each model (`lines`). The remaining residual is noise if consecutive samples are
//! uncorrelated (`noise`). If the run has markers, they contribute to the verdict: shapes under the measured tensions (`markers`) must agree with
//! them within the noise of both. The rest may correlate with one of a few physical causes (`goes_with`). An effect that makes shapes or tensions
//! worse than with the given file is not written (`worse`), nor is a value that the run does not contradict (`final_fit`). Intervals include the
//! calibration error and the differences between holes that share a μ (`spread`).

mod assemble;
mod case;
mod extended_file;
mod final_fit;
pub(super) mod friction;
mod goes_with;
mod machine;
mod marker_faults;
pub(super) mod markers;
pub(super) mod noise;
mod places;
mod result;
mod summary;
pub(super) mod worse;

use fric_lab::discover::Verdict;
use fric_lab::discover::result::DiscoverResult;
use fric_lab::fit::Progress;
use fric_tendon::edit::ManipulatorEdit;
use fric_tendon::file::ManipulatorFile;

use self::case::Case;
use self::friction::model::Effect;
use self::machine::Machine;
use self::machine::candidate::Candidate;
use self::noise::excess_n;
use super::base_noise::{BaseNoise, steadied};
use super::error::ContinuumError;
use super::gratings::Gratings;
use super::measuring::corrected;
use super::run::Run;

pub(super) use case::thinned;
pub use goes_with::GoesWith;
pub use result::{Manipulator, MarkerError, TendonMarkers};
pub use summary::{alternatives, rest_in_words, tried_in_words};

/// The result of a discovery.
#[derive(Clone, Debug)]
pub struct TendonDiscovery {
    /// The result for machines and people.
    pub result: DiscoverResult<Manipulator>,
    /// The changes to the manipulator file.
    pub edit: ManipulatorEdit,
    /// Noise that was taken off the tension at the base.
    pub base_noise: Option<BaseNoise>,
    /// Times of the compared samples, s.
    pub time_s: Vec<f64>,
    /// Residual of the given model, fitted, in each segment, N; NaN where nothing was measured.
    pub residual_before_n: Vec<Vec<f64>>,
    /// Residual of the extended model in each segment, N; NaN where nothing was measured.
    pub residual_after_n: Vec<Vec<f64>>,
}

/// Searches for what a manipulator file lacks. `log` is the name of the run. Another thread can stop the work by `progress`.
///
/// # Errors
/// Returns [`ContinuumError::MissingGroup`] without the tension at the base or gratings, [`ContinuumError::NoGratings`] if the file does not say how
/// shifts become tensions, [`ContinuumError::TooShort`] for a run with too few samples to hold any out, [`ContinuumError::UntoldNoise`] for gratings
/// with more gaps than samples, [`ContinuumError::OverCapacity`], or [`ContinuumError::NotIdentified`] if the work was stopped.
pub fn discover(
    file: &ManipulatorFile,
    run: &Run,
    log: &str,
    progress: &Progress,
) -> Result<TendonDiscovery, ContinuumError> {
    progress.begin(1);
    let lack = |what, remedy| ContinuumError::MissingGroup { what, consequence: "there is nothing to compare", remedy };
    if !run.has_tension() {
        return Err(lack("tension at the base", "`tension_base_n`"));
    }
    if !run.has_shifts() {
        return Err(lack("gratings", "`shift_1_nm` and so on"));
    }
    run.check_sizes(file.params())?;
    let gratings = Gratings::from_file(file)?.ok_or(ContinuumError::NoGratings)?;
    let (run, base_noise) = steadied(run);
    let (mut run, mut faults) = marker_faults::mended(&run, file.params());
    let base_error_n = base_noise.map_or(0.0, |noise| noise.error_n);
    let kept = thinned(run.samples());
    let Machine { named, tables, lines, marker_lag_s, rough, mu: mu_of_holes } =
        machine::search(file, &run, progress).unwrap_or_else(|| Machine::none(file));
    if progress.is_stopped() {
        return Err(ContinuumError::NotIdentified);
    }
    let extended = if named.is_empty() { None } else { ManipulatorFile::check(tables).ok() };
    if marker_lag_s != 0.0 {
        let (ahead, fault) = marker_faults::ahead(&run, extended.as_ref().unwrap_or(file), marker_lag_s)?;
        run = ahead;
        faults.push(fault);
    }
    let as_given = corrected(&run, file)?;
    let case = Case { found_lines: lines.clone(), ..Case::new(file, &as_given, &gratings, &kept, base_error_n)? };
    // The search for friction starts with these findings in the file.
    let with_found = match &extended {
        Some(extended) => {
            let run = corrected(&run, extended)?;
            let gratings = Gratings::from_file(extended)?.ok_or(ContinuumError::NoGratings)?;
            let with_found = Case::new(extended, &run, &gratings, &kept, base_error_n)?;
            let with_found = Case { found_lines: lines, ..with_found };
            let outcome = friction::naming::name(&with_found)?.beside(&case)?;
            // A lag that leaves more than it accounts for is something else.
            let is_lag = named.iter().any(|one| one.candidate == Candidate::TensionLag);
            let is_guess = excess_n(&outcome.before).powi(2) < 2.0 * excess_n(&outcome.after).powi(2);
            (!is_lag || !is_guess).then_some((extended, with_found, outcome))
        }
        None => None,
    };
    let (outcome, mut discovery) = if let Some((extended, with_found, outcome)) = with_found {
        let mut discovery = assemble::told(&with_found, &outcome, &named, &faults, log);
        let ManipulatorEdit { mu, sigma_n_per_m, drift_nm_per_s, .. } = discovery.edit;
        let bending = ManipulatorEdit::between(file.tables(), extended.tables());
        discovery.edit = ManipulatorEdit { mu, sigma_n_per_m, drift_nm_per_s, ..bending };
        (outcome, discovery)
    } else {
        let outcome = friction::naming::name(&case)?;
        let discovery = assemble::told(&case, &outcome, &[], &faults, log);
        (outcome, discovery)
    };
    // If the search for friction names nothing but the file changes, the holes get the values of the joint fit.
    let is_settled = outcome.findings.is_empty() && outcome.verdict != Verdict::Unexplained;
    if is_settled && !mu_of_holes.is_empty() && discovery.edit != ManipulatorEdit::default() {
        discovery.edit.mu = mu_of_holes;
    }
    if !run.has_markers() {
        // Friction at a hole may then be that of a segment that bends more or less than the others.
        let holes = discovery.result.cables.iter_mut().flat_map(|tendon| &mut tendon.effects);
        for effect in holes.filter(|effect| effect.kind == Effect::HoleFriction(0).kind()) {
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let is_rough = rough.iter().any(|hole| effect.parameters.get("hole") == Some((hole + 1) as f64));
            if !is_rough {
                effect.alike.push(Candidate::SegmentStiffness(0).kind());
            }
        }
    }
    discovery.base_noise = base_noise;
    progress.finish_one();
    Ok(discovery)
}
