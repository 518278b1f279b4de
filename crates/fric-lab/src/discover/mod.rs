//! Discovery: where a model and a log disagree, which physical effect is missing, and how much the effect reduces the gap.
//!
//! The discovery works on one cable at a time, from a [`SampleStore`] with reference forces:
//!
//! 1. *Gap.* The given model is fitted to half of the log, in blocks; the other half is held out to judge (`split`). The noise is estimated from the
//!    residual alone (`noise`).
//! 2. *Where.* The operating conditions that carry the excess above the noise are located (`places`).
//! 3. *Name.* Candidates of the catalogue enter, justify themselves and are exchanged (`naming`). The criteria are the evidence for each
//!    (`evidence`), a constant size in every condition (`steadiness`), and no unnamed law that makes the effect superfluous (`rivals`). The model
//!    with all names becomes the given one until nothing more is found, and is then fitted to all samples as in an identification.
//! 4. *Rest.* Faults of the log have names of their own (`faults`) and are corrected first: spectral lines (`lines`), a noisy length
//!    (`length_noise`), a late reference (`timing`), and a sensor that is frozen, spikes or saturates. A stretch of cable (`stretch`) or of time
//!    (`rest`) is left out, and the rest is judged again. Signals of other cables that correlate with the rest are reported (`neighbours`). Sensor
//!    drift that is unrelated to the motion is noise.
//!
//! 5. *Table.* A rest that exceeds the noise and has no name may still be a function of a condition. A table then says how large it is and where
//!    (`empirical`). The verdict stays *unexplained*.
//!
//! The model is the control cycle itself, so the findings run in the cycle unchanged.

mod cable;
mod effort;
mod extended;
pub(crate) mod faults;
mod figures;
mod given;
mod lack;
mod lag;
pub(crate) mod naming;
pub mod readiness;
mod report;
mod rest;
pub mod result;
mod summary;
mod tared;
pub mod words;
pub(crate) mod workbench;
mod wrench;

use std::ops::Range;

use fric_core::effects::Effect;
use rayon::prelude::*;
use thiserror::Error;

use self::faults::length_noise::{self, LengthNoise};
use self::faults::timing::Retimed;
use self::rest::neighbours::neighbours_of;

use crate::fit::{CableRecord, FitError, Progress, Reference, SampleStore, Stages, StoreError};
use crate::recording_fault::RecordingFault;
use crate::set_up;

pub use extended::extended;
pub use faults::correction::{CorrectedFit, Corrections, corrections, fit_cables_corrected};
pub use figures::curve::{FrictionCurves, FrictionPoint};
pub use figures::profile::{Profile, ProfileBin, ProfileCell};
pub use figures::spectrum::{Autocorrelation, Spectrum, autocorrelation, spectrum};
pub use lack::Lack;
pub use naming::Refusal;
pub use report::{CableDiscovery, Candidate, Finding, Model, RunnerUp, Tried, Unexplained, Verdict};
pub use rest::neighbours::Neighbour;
pub use rest::places::Place;
pub use wrench::{Geometry, GeometryFinding, WrenchDeviation, WrenchDiscovery, discover_wrench};

/// Options of a discovery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DiscoverOptions {
    /// Whether a rest without a name may become a table.
    pub empirical: bool,
    /// Whether the residuals of each cycle stay with the findings of a cable: 16 bytes a sample and cable.
    pub series: bool,
}

impl Default for DiscoverOptions {
    fn default() -> Self {
        Self { empirical: true, series: true }
    }
}

/// One cable among all cables of a robot.
struct Task<'a> {
    options: DiscoverOptions,
    own: usize,
    /// The record of the cable before anything but the noise of its length is corrected.
    record: &'a CableRecord<'a>,
    all: &'a AllCables<'a>,
    progress: &'a Progress,
    stages: Stages<'a>,
}

/// The cables of a robot without the noise of their lengths where it matters.
struct AllCables<'a> {
    samples: &'a SampleStore<'a>,
    noise: Option<LengthNoise>,
}

impl AllCables<'_> {
    /// Runs work on the records of some cables without the noise of their lengths.
    fn with<T>(&self, cables: Range<usize>, work: impl FnOnce(&[CableRecord<'_>]) -> T) -> Result<T, StoreError> {
        let measurements = length_noise::steadied(self.samples.load(cables.clone())?, self.noise.as_ref());
        Ok(work(&cables.filter_map(|cable| measurements.cable(cable)).collect::<Vec<_>>()))
    }
}

/// Runs the discovery on a cable with its reference at its correct time: first as determined by the given model, then, if effects were missing, by the
/// model with these. A missing effect may have looked like a late reference, or hidden one.
fn discover_retimed(
    record: &CableRecord<'_>,
    task: &Task<'_>,
) -> Result<(CableDiscovery, Option<RecordingFault>), StoreError> {
    let stop = task.progress.stop_flag();
    let found_with = |retimed: Option<Retimed>| {
        let found = match &retimed {
            Some(of) => cable::discover_cable(&record.with_interpolated(&of.references_n, of.noise_reach), task)?,
            None => cable::discover_cable(record, task)?,
        };
        Ok((found, retimed.map(|retimed| retimed.fault)))
    };
    let (found, fault) = found_with(faults::timing::retimed(record, stop))?;
    let named = found.findings.iter().any(|finding| finding.effect != Effect::Empirical);
    // A table may represent the late reference itself.
    let values = rest::empirical::without_table(&found.after.values);
    let extended = record.params.with_values(&values).ok().filter(|_| named);
    let Some(params) = extended else { return Ok((found, fault)) };
    let retimed = faults::timing::retimed(&record.with_params(&params), stop);
    if retimed.is_none() && fault.is_none() {
        return Ok((found, None));
    }
    found_with(retimed)
}

/// The reason why a discovery says nothing.
#[derive(Debug, Error)]
pub enum DiscoverError {
    /// The data allow none.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The samples have no room.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// The findings, by the kind of reference.
#[derive(Clone, Debug)]
pub enum Discoveries {
    /// Compared with cable forces, each cable by itself.
    Forces(Vec<CableDiscovery>),
    /// Compared with the wrench, all cables together.
    Wrench(Box<WrenchDiscovery>),
}

impl Discoveries {
    /// Runs the discovery on all cables with the reference of the samples. `options` apply to forces only: with the wrench nothing becomes a table.
    ///
    /// # Errors
    /// Returns the errors of [`discover`] and [`discover_wrench`].
    pub fn of(
        samples: &SampleStore<'_>,
        options: &DiscoverOptions,
        progress: &Progress,
    ) -> Result<Self, DiscoverError> {
        Ok(match samples.reference() {
            Reference::Forces => Self::Forces(discover(samples, options, progress)?),
            Reference::Wrench => Self::Wrench(Box::new(discover_wrench(samples.all()?.as_ref(), progress)?)),
        })
    }

    /// Returns the findings of each cable.
    #[must_use]
    pub fn cables(&self) -> &[CableDiscovery] {
        match self {
            Self::Forces(cables) => cables,
            Self::Wrench(found) => &found.cables,
        }
    }

    /// Returns the findings that concern all cables together.
    #[must_use]
    pub fn wrench(&self) -> Option<&WrenchDiscovery> {
        match self {
            Self::Forces(_) => None,
            Self::Wrench(found) => Some(found),
        }
    }

    /// Returns warnings about cables whose forces contradict their set-up: scale or direction. `names` are those of the cables.
    #[must_use]
    pub fn warnings(&self, names: &[&str]) -> Vec<String> {
        set_up::warnings(names.iter().copied().zip(self.cables().iter().map(|cable| cable.set_up)))
    }

    /// Returns the text of a robot file with the findings; see [`extended`].
    ///
    /// # Errors
    /// Returns the [`RobotFileError`](fric_core::robot::file::RobotFileError) of [`extended`].
    pub fn extended(&self, text: &str, origin: &str) -> Result<String, fric_core::robot::file::RobotFileError> {
        match self {
            Self::Forces(cables) => extended(text, origin, cables),
            Self::Wrench(found) => wrench::extended_by_wrench(text, origin, found),
        }
    }
}

/// Runs the discovery on every cable that has a reference.
///
/// # Errors
/// Returns the [`StoreError`] of a log that does not fit into memory.
pub fn discover(
    samples: &SampleStore<'_>,
    options: &DiscoverOptions,
    progress: &Progress,
) -> Result<Vec<CableDiscovery>, StoreError> {
    progress.begin(cable::STAGES * samples.robot().cables().len());
    let all = AllCables { samples, noise: LengthNoise::of(samples, progress.stop_flag())? };
    let mut cables = Vec::new();
    for group in samples.groups() {
        let discover = |records: &[CableRecord<'_>]| {
            let of_cable = |(own, record): (usize, &CableRecord<'_>)| {
                let stages = Stages::new(progress, cable::STAGES);
                discover_one(&Task { options: *options, own, record, all: &all, progress, stages })
            };
            let of_cables = group.clone().into_par_iter().zip(records);
            of_cables.map(of_cable).collect::<Result<Vec<(CableDiscovery, Vec<RecordingFault>)>, StoreError>>()
        };
        let mut found = all.with(group.clone(), discover)??;
        if found.iter().any(|(_, corrected)| !corrected.is_empty()) {
            // Loaded again, with the noise of their lengths, instead of kept all the time.
            let given = samples.load(group.clone())?;
            let given: Vec<CableRecord<'_>> = given.cables().collect();
            let of_cables = found.par_iter_mut().zip(&given).filter(|((_, corrected), _)| !corrected.is_empty());
            of_cables.for_each(|((found, corrected), given)| {
                cable::add_corrected_faults(found, given, corrected, progress.stop_flag());
            });
        }
        for (mut found, _) in found {
            if !options.series {
                (found.residual_before_n, found.residual_after_n) = (Vec::new(), Vec::new());
            }
            cables.push(found);
        }
    }
    Ok(cables)
}

/// Runs the discovery on one cable. Returns the faults that were corrected for its whole log too, which are not among its findings yet.
fn discover_one(task: &Task<'_>) -> Result<(CableDiscovery, Vec<RecordingFault>), StoreError> {
    let (record, stop) = (task.record, task.progress.stop_flag());
    let of_length = task.all.noise.as_ref().and_then(|noise| noise.faults.get(task.own)?.clone());
    let tared = tared::tared(record, stop);
    let (mut found, late) = match &tared {
        Some((zeroed, _)) => discover_retimed(&record.zeroed(zeroed), task)?,
        None => discover_retimed(record, task)?,
    };
    found.add_to_zeros(tared.as_ref().map_or(&[][..], |(_, changed_n)| changed_n));
    if let Some(unexplained) = &mut found.unexplained {
        unexplained.neighbours = neighbours_of(&found.residual_after_n, task)?;
    }
    Ok((found, late.into_iter().chain(of_length).collect()))
}
