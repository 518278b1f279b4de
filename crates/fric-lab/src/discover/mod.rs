//! Discovery: where a model and a log disagree, which physical effect is missing, and how much the effect reduces the gap.
//!
//! The discovery works on one cable at a time, from [`Measurements`] with reference forces:
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
mod faults;
mod figures;
pub(crate) mod naming;
pub(crate) mod readiness;
mod report;
mod rest;
pub mod result;
mod summary;
mod tared;
pub mod words;
pub(crate) mod workbench;
mod wrench;

use fric_core::effects::Effect;
use rayon::prelude::*;

use crate::fit::{CableRecord, FitError, Measurements, Progress, Reference, Stages};

pub use extended::extended;
pub use faults::correction::{CorrectedFit, Corrections, corrections, fit_cables_corrected};
pub use faults::{Fault, RecordingFault};
pub use figures::curve::{FrictionCurves, FrictionPoint};
pub use figures::profile::{Profile, ProfileBin, ProfileCell};
pub use figures::spectrum::{Autocorrelation, Spectrum, autocorrelation, spectrum};
pub use naming::Refusal;
pub use readiness::Lack;
pub use report::{CableDiscovery, Candidate, Finding, Model, RunnerUp, Tried, Unexplained, Verdict};
pub use rest::neighbours::Neighbour;
pub use rest::places::Place;
pub use wrench::{Geometry, GeometryFinding, WrenchDeviation, WrenchDiscovery, discover_wrench};

/// Options of a discovery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DiscoverOptions {
    /// Whether a rest without a name may become a table.
    pub empirical: bool,
}

impl Default for DiscoverOptions {
    fn default() -> Self {
        Self { empirical: true }
    }
}

/// One cable among all cables of a robot.
struct Task<'a> {
    options: DiscoverOptions,
    own: usize,
    records: &'a [CableRecord<'a>],
    progress: &'a Progress,
    stages: Stages<'a>,
}

/// Runs the discovery on a cable with its reference at its correct time: first as determined by the given model, then by the model with the effects
/// that were missing.
fn discover_retimed(record: &CableRecord<'_>, task: &Task<'_>) -> (CableDiscovery, Option<RecordingFault>) {
    let stop = task.progress.stop_flag();
    let Some((rows, fault)) = faults::timing::retimed(record, stop) else {
        return (cable::discover_cable(record, task), None);
    };
    let found = cable::discover_cable(&record.with_signals(&rows), task);
    let named = found.findings.iter().any(|finding| finding.effect != Effect::Empirical);
    // A table may represent the late reference itself.
    let values = rest::empirical::without_table(&found.after.values);
    let extended = record.params.with_values(&values).ok().filter(|_| named);
    let Some(params) = extended else { return (found, Some(fault)) };
    // A missing effect in the given model may have looked like a late reference.
    match faults::timing::retimed(&record.with_params(&params), stop) {
        Some((rows, fault)) => (cable::discover_cable(&record.with_signals(&rows), task), Some(fault)),
        None => (cable::discover_cable(record, task), None),
    }
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
    /// Runs the discovery on all cables with the reference of the measurements. `options` apply to forces only: with the wrench nothing becomes a
    /// table.
    ///
    /// # Errors
    /// Returns the [`FitError`] of [`discover_wrench`].
    pub fn of(
        measurements: &Measurements<'_>,
        options: &DiscoverOptions,
        progress: &Progress,
    ) -> Result<Self, FitError> {
        Ok(match measurements.reference() {
            Reference::Forces => Self::Forces(discover(measurements, options, progress)),
            Reference::Wrench => Self::Wrench(Box::new(discover_wrench(measurements, progress)?)),
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
#[must_use]
pub fn discover(
    measurements: &Measurements<'_>,
    options: &DiscoverOptions,
    progress: &Progress,
) -> Vec<CableDiscovery> {
    let given: Vec<CableRecord<'_>> = measurements.cables().collect();
    progress.begin(cable::STAGES * given.len());
    let steadied = faults::length_noise::steadied(measurements, progress.stop_flag());
    let records = faults::length_noise::records(&given, steadied.as_ref());
    let of_cable = |(place, record): (usize, &CableRecord<'_>)| {
        let noisy = steadied.as_ref().and_then(|steadied| steadied.faults.get(place)?.clone());
        let stages = Stages::new(progress, cable::STAGES);
        let task = Task { options: *options, own: place, records: &records, progress, stages };
        let tared = tared::tared(record, progress.stop_flag());
        let (mut found, late) = match &tared {
            Some((rows, _)) => discover_retimed(&record.with_signals(rows), &task),
            None => discover_retimed(record, &task),
        };
        found.add_to_zeros(tared.as_ref().map_or(&[][..], |(_, changed_n)| changed_n));
        for fault in late.into_iter().chain(noisy) {
            cable::add_corrected_fault(&mut found, &given[place], fault, progress.stop_flag());
        }
        found
    };
    let mut cables: Vec<CableDiscovery> = records.par_iter().enumerate().map(of_cable).collect();
    for (place, cable) in cables.iter_mut().enumerate() {
        if let Some(unexplained) = &mut cable.unexplained {
            unexplained.neighbours = rest::neighbours::neighbours_of(&cable.residual_after_n, place, &records);
        }
    }
    cables
}
