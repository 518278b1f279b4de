//! The samples of several logs for work on all of them at once, and the supervision of such work.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use fric_core::{CableParams, Sample};
use fric_lab::discover::{self, Corrections};
use fric_lab::fit::readiness::{Holdings, Readiness};
use fric_lab::fit::{Progress, Reference, SampleStore, StoreError};
use fric_log::log::Log;
use fric_log::signals::{Part, Role, SignalError, SignalReader, TimesApart};

use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::model::{self, Model};
use crate::progress::{self, STRIDE};
use crate::warnings::{warn, warn_all};

/// Interval of updating the progress bar and checking Ctrl-C while all cores compute.
const WATCH_INTERVAL: Duration = Duration::from_millis(20);

/// Checks that no sample counts twice.
pub fn check_named_once(logs: &[PathBuf]) -> Outcome {
    for (count, log) in logs.iter().enumerate() {
        let is_same =
            |other: &PathBuf| log.canonicalize().is_ok_and(|path| other.canonicalize().is_ok_and(|of| of == path));
        if logs.iter().take(count).any(is_same) {
            return Err(Failure::usage(format!("{} is named twice, and its samples would count twice", log.display()))
                .advise("Name each log once."));
        }
    }
    Ok(())
}

/// Returns the named robot file, or else the first that is attached to a log.
pub fn find_model(named: Option<&Path>, logs: &[PathBuf]) -> Outcome<Model> {
    for log in logs {
        if let Some(model) = Model::find(named, &Log::open(&[log])?)? {
            return Ok(model);
        }
    }
    Err(model::missing())
}

/// The data read from all logs.
pub struct LogsRead<'a> {
    pub samples: SampleStore<'a>,
    pub holdings: Holdings,
    /// A required signal whose times in all logs differ from those of the cable signal.
    apart: Option<TimesApart>,
}

impl LogsRead<'_> {
    /// Returns warnings about what is missing for some cables.
    pub fn check(&self, readiness: &Readiness) -> Outcome<Vec<String>> {
        readiness.check().map_err(|error| self.apart.map_or_else(|| error.into(), Failure::from))
    }
}

/// Reads the same part of all logs, each as a log of its own.
pub fn read<'a>(logs: &[PathBuf], part: Part, model: &'a Model, reference: Reference) -> Outcome<LogsRead<'a>> {
    // Signals that are not compared with are not read.
    let (unread, compared) = match reference {
        Reference::Forces => (Role::Wrench, Role::Reference),
        Reference::Wrench => (Role::Reference, Role::Wrench),
    };
    let paths = model.signal_paths()?.with(unread, None);
    warn_all(&model.robot.warnings());
    let names = model.robot.cable_names();
    let params = model.robot.params();
    let is_needed = |role: &Role| match role {
        Role::Pose => reference == Reference::Wrench || params.cables().iter().any(CableParams::needs_pose),
        // The platform's mass may replace it.
        Role::Wrench => params.mass_kg() <= 0.0,
        _ => true,
    };
    let mut all_apart: Vec<Role> = [Role::Length, compared, Role::Pose].into_iter().filter(is_needed).collect();
    let mut apart = None;
    let mut samples = SampleStore::new(&params, reference);
    let mut all: Option<Holdings> = None;
    for log in logs {
        samples.start_log();
        let mut reader = SignalReader::new(Log::open(&[log])?, paths.clone(), &names).within(part);
        let holdings = read_one(&mut reader, &mut samples, names.len())?;
        warn_all(reader.cycle_warning(&model.robot).as_slice());
        all_apart.retain(|role| reader.times_apart(*role).is_some());
        apart = all_apart.first().and_then(|role| reader.times_apart(*role));
        let has_compared = holdings.has_reference() || holdings.wrenched > 0;
        match &mut all {
            Some(all) => all.join(&holdings),
            None => all = Some(holdings),
        }
        if logs.len() > 1 && !has_compared {
            let (log, key) = (log.display(), compared.key());
            warn(&format!("`{log}` has nothing to compare with on the signal `{key}`"));
        }
    }
    warn_all(&samples.warnings(&names)?);
    let holdings = all.unwrap_or_else(|| Holdings::new(names.len()));
    Ok(LogsRead { samples, holdings, apart })
}

/// Reads all rows with a progress bar; the inner error is that of the log.
fn take_all(
    reader: &mut SignalReader,
    mut take: impl FnMut(&Sample<'_>) -> Result<(), StoreError>,
) -> Outcome<Result<(), SignalError>> {
    let bar = progress::bytes(reader.log().total_bytes());
    let mut count = 0_u64;
    let end = loop {
        if count.is_multiple_of(STRIDE) {
            interrupt::check()?;
            bar.set_position(reader.log().bytes_read());
        }
        count += 1;
        match reader.next_row() {
            Ok(Some(sample)) => take(&sample)?,
            Ok(None) => break Ok(()),
            Err(error) => break Err(error),
        }
    };
    progress::finish(&bar);
    Ok(end)
}

fn read_one(reader: &mut SignalReader, samples: &mut SampleStore<'_>, cable_count: usize) -> Outcome<Holdings> {
    let mut holdings = Holdings::new(cable_count).of_columns(reader.log().column_names().is_some());
    let end = take_all(reader, |sample| {
        holdings.add(sample);
        samples.add(sample)
    })?;
    warn_all(&reader.log().warnings());
    end?;
    warn_all(&reader.warnings());
    Ok(holdings)
}

/// Returns the corrections of the parts of one log before it is compared with its reference. Warnings are left to the next reading.
pub fn corrections(parts: &[PathBuf], part: Part, model: &Model) -> Outcome<Corrections> {
    let paths = model.signal_paths()?.with(Role::Wrench, None);
    let names = model.robot.cable_names();
    let params = model.robot.params();
    let mut samples = SampleStore::new(&params, Reference::Forces);
    let mut reader = SignalReader::new(Log::open(parts)?, paths, &names).within(part);
    // An error occurs again in the actual reading.
    let _ = take_all(&mut reader, |sample| samples.add(sample))?;
    Ok(watched("checking", "cables", |progress| discover::corrections(&samples, progress))??)
}

/// Runs work with a progress bar, until it is done or Ctrl-C is pressed; `doing` names the work, and the bar counts its `steps`.
pub fn watched<T: Send>(doing: &'static str, steps: &str, work: impl FnOnce(&Progress) -> T + Send) -> Outcome<T> {
    let progress = Progress::new();
    let bar = progress::steps(doing, steps);
    let result = thread::scope(|scope| {
        let worker = scope.spawn(|| work(&progress));
        while !worker.is_finished() {
            if interrupt::check().is_err() {
                progress.stop();
            }
            let (done, total) = progress.steps();
            bar.set_length(total as u64);
            bar.set_position(done as u64);
            thread::sleep(WATCH_INTERVAL);
        }
        worker.join()
    });
    progress::finish(&bar);
    interrupt::check()?;
    result.map_err(|_| Failure::new("the work broke off: this is a defect of fric; please report it with the log"))
}
