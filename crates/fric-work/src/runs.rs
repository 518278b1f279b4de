//! The samples of one or several logs, for work on all of them at once.

use fric_core::CableParams;
use fric_core::robot::file::RobotFile;
use fric_lab::fit::readiness::{self, Holdings, Readiness};
use fric_lab::fit::{LogZero, Reference, SampleStore};
use fric_log::signals::{Role, TimesApart};

use crate::source::{SampleSource, read_and_warn};
use crate::supervisor::Supervisor;

/// Returns the signal that work with a reference does not use, and that need not be read.
#[must_use]
pub const fn unread(reference: Reference) -> Role {
    match reference {
        Reference::Forces => Role::Wrench,
        Reference::Wrench => Role::Reference,
    }
}

/// Returns the signal that is compared with.
const fn compared(reference: Reference) -> Role {
    match reference {
        Reference::Forces => Role::Reference,
        Reference::Wrench => Role::Wrench,
    }
}

/// Logs, each a run of its own.
#[derive(Debug)]
pub struct Runs<'a> {
    pub(crate) robot: &'a RobotFile,
    /// The origin of the robot file, for people.
    pub(crate) origin: &'a str,
    /// Names of the logs, for people.
    pub(crate) names: Vec<String>,
    /// The samples read so far.
    pub samples: SampleStore<'a>,
    /// The number of samples with each signal.
    pub holdings: Holdings,
    read_count: usize,
    /// The last warning about the cycle, which logs of one machine share.
    cycle_warning: Option<String>,
    /// Required signals whose times are apart from those of the cable signal in every log.
    all_apart: Vec<Role>,
    /// The first of them, in the last log.
    apart: Option<TimesApart>,
}

impl<'a> Runs<'a> {
    /// Prepares for reading the logs of these names; `zero` is the one that each has of its own.
    ///
    /// # Errors
    /// Returns a [`FitError`](fric_lab::fit::FitError) if the robot file alone makes the reference impossible, and the errors of the supervisor.
    pub fn new<W: Supervisor>(
        robot: &'a RobotFile,
        origin: &'a str,
        reference: Reference,
        zero: Option<LogZero>,
        names: Vec<String>,
        watch: &mut W,
    ) -> Result<Self, W::Error> {
        if let Some(lack) = readiness::geometry(robot, origin).filter(|_| reference == Reference::Wrench) {
            return Err(lack.error().into());
        }
        watch.warn(&robot.warnings())?;
        let params = robot.params();
        let is_needed = |role: &Role| match role {
            Role::Pose => reference == Reference::Wrench || params.cables().iter().any(CableParams::needs_pose),
            // The platform's mass may replace it.
            Role::Wrench => params.mass_kg() <= 0.0,
            _ => true,
        };
        let required = [Role::Length, compared(reference), Role::Pose];
        Ok(Self {
            robot,
            origin,
            names,
            samples: SampleStore::new(&params, reference).with_zero_per_log(zero),
            holdings: Holdings::new(params.cables().len()),
            read_count: 0,
            cycle_warning: None,
            all_apart: required.into_iter().filter(is_needed).collect(),
            apart: None,
        })
    }

    /// Reads the next log, which warnings call `told`. After the last, the warnings about all samples follow.
    ///
    /// # Errors
    /// Returns a [`SignalError`](fric_log::signals::SignalError) of the log, a [`StoreError`](fric_lab::fit::StoreError) if the samples find no room, a
    /// [`FitError`](fric_lab::fit::FitError) if the reference of a cable is its own sensor's force, and the errors of the supervisor.
    pub fn add<W: Supervisor>(
        &mut self,
        told: &str,
        source: &mut impl SampleSource,
        watch: &mut W,
    ) -> Result<(), W::Error> {
        let Self { robot, names, samples, .. } = self;
        let reference = samples.reference();
        let unknown = vec![f64::NAN; samples.robot().cables().len()];
        let mut holdings = Holdings::new(unknown.len());
        samples.start_log();
        let about = read_and_warn(source, robot, watch, |sample| {
            let mut sample = *sample;
            match reference {
                Reference::Forces => sample.outside_wrench = None,
                Reference::Wrench => sample.reference_force_n = &unknown,
            }
            holdings.add(&sample);
            Ok(samples.add(&sample)?)
        })?;
        if about.cycle.is_some() && about.cycle != self.cycle_warning {
            let of_log = if names.len() > 1 { format!("{told}: ") } else { String::new() };
            watch.warn(&about.cycle.iter().map(|cycle| of_log.clone() + cycle).collect::<Vec<_>>())?;
            self.cycle_warning.clone_from(&about.cycle);
        }
        self.all_apart.retain(|role| about.times_apart(*role).is_some());
        self.apart = self.all_apart.first().and_then(|role| about.times_apart(*role));
        if names.len() > 1 && !holdings.has_reference() && holdings.wrenched == 0 {
            let key = compared(reference).key();
            watch.warn(&[format!("{told} has nothing to compare with on the signal `{key}`")])?;
        }
        if self.read_count == 0 {
            self.holdings = holdings.of_columns(about.has_columns);
        } else {
            self.holdings.join(&holdings);
        }
        self.read_count += 1;
        if self.read_count == names.len() {
            readiness::references(samples, &robot.cable_names())?;
            watch.warn(&samples.warnings(&robot.cable_names())?)?;
        }
        Ok(())
    }

    /// Returns warnings about what is missing for some cables. If all is missing because a signal is of other times, the error says so.
    pub(crate) fn check<W: Supervisor>(&self, readiness: &Readiness) -> Result<Vec<String>, W::Error> {
        readiness.check().map_err(|error| self.apart.map_or_else(|| error.into(), Into::into))
    }
}
