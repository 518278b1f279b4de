//! Discovery: where a model and a log disagree, which physical effect is missing, and how much smaller the gap is with it.
//!
//! For one cable at a time, from [`Measurements`] with reference forces:
//!
//! 1. *Gap.* The given model is fitted to half of the log, in blocks; the other half judges (`split`). The noise is
//!    estimated from the residual alone (`noise`).
//! 2. *Where.* Which operating conditions carry what is above the noise (`places`).
//! 3. *Name.* Candidates of the catalogue enter, justify themselves and are exchanged (`naming`): the evidence for each (`evidence`), whether it has one size in every
//!    condition (`steadiness`), and whether a law without a name makes it superfluous (`rivals`). The model with all names is taken for the given one until nothing more
//!    is found, and fitted to all samples as an identification does.
//! 4. *Rest.* What is wrong with the log itself has its own names (`foreign`) and is corrected before: lines in the spectrum (`lines`), a length that trembles
//!    (`length_noise`), a reference that comes late (`timing`), a sensor that stands still, spikes or is at the end of its range. A stretch of cable (`stretch`) or of time (`rest`) is left out, and the rest
//!    judged once more; signals of other cables that it goes with are told (`neighbours`). A wander of the sensors that has nothing to do with the motion is noise.
//!
//! 5. *Table.* A rest that is more than noise and has no name may be a function of a condition all the same: then a table tells how large it is and where (`empirical`). The verdict stays *unexplained*.
//!
//! The model is the control cycle's own; what is found runs in it as it is.

mod cable;
mod extended;
mod faults;
mod figures;
pub(crate) mod naming;
pub(crate) mod readiness;
mod report;
mod rest;
pub mod result;
mod summary;
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

/// What a discovery can be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DiscoverOptions {
    /// Whether what is left and has no name may become a table.
    pub empirical: bool,
}

impl Default for DiscoverOptions {
    fn default() -> Self {
        Self { empirical: true }
    }
}

/// One cable among all of a robot.
struct Task<'a> {
    options: DiscoverOptions,
    own: usize,
    records: &'a [CableRecord<'a>],
    progress: &'a Progress,
    stages: Stages<'a>,
}

/// Looks at a cable with its reference where it belongs: as far as the given model tells, and then as far as the one that has what it lacked.
fn discover_retimed(record: &CableRecord<'_>, task: &Task<'_>) -> (CableDiscovery, Option<RecordingFault>) {
    let stop = task.progress.stop_flag();
    let Some((rows, fault)) = faults::timing::retimed(record, stop) else {
        return (cable::discover_cable(record, task), None);
    };
    let found = cable::discover_cable(&record.with_signals(&rows), task);
    let named = found.findings.iter().any(|finding| finding.effect != Effect::Empirical);
    // What a table stands for may be the late reference itself.
    let values = rest::empirical::without_table(&found.after.values);
    let extended = record.params.with_values(&values).ok().filter(|_| named);
    let Some(params) = extended else { return (found, Some(fault)) };
    // What the given model lacks may have looked like it.
    match faults::timing::retimed(&record.with_params(&params), stop) {
        Some((rows, fault)) => (cable::discover_cable(&record.with_signals(&rows), task), Some(fault)),
        None => (cable::discover_cable(record, task), None),
    }
}

/// What was found, by what the model was compared with.
#[derive(Clone, Debug)]
pub enum Discoveries {
    /// By cable forces, each cable by itself.
    Forces(Vec<CableDiscovery>),
    /// By the wrench, all cables together.
    Wrench(Box<WrenchDiscovery>),
}

impl Discoveries {
    /// Looks at all cables with the reference of the measurements; `options` are for forces: by the wrench nothing becomes a table.
    ///
    /// # Errors
    /// [`FitError`] as [`discover_wrench`].
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

    /// What was found on each cable.
    #[must_use]
    pub fn cables(&self) -> &[CableDiscovery] {
        match self {
            Self::Forces(cables) => cables,
            Self::Wrench(found) => &found.cables,
        }
    }

    /// What concerns all cables together.
    #[must_use]
    pub fn wrench(&self) -> Option<&WrenchDiscovery> {
        match self {
            Self::Forces(_) => None,
            Self::Wrench(found) => Some(found),
        }
    }

    /// The text of a robot file with what was found, see [`extended`].
    ///
    /// # Errors
    /// [`RobotFileError`](fric_core::robot::file::RobotFileError) as [`extended`].
    pub fn extended(&self, text: &str, origin: &str) -> Result<String, fric_core::robot::file::RobotFileError> {
        match self {
            Self::Forces(cables) => extended(text, origin, cables),
            Self::Wrench(found) => wrench::extended_by_wrench(text, origin, found),
        }
    }
}

/// Looks at every cable that has a reference.
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
        let (mut found, late) = discover_retimed(record, &task);
        for fault in late.into_iter().chain(noisy) {
            cable::tell_of(&mut found, &given[place], fault, progress.stop_flag());
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
