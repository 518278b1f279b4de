//! The logs of a fit or a discovery.

use fric_core::robot::file::RobotFile;
use fric_lab::fit::{LogZero, Parameter, Reference, zero_per_log};
use fric_work::provenance::shown_path;
use fric_work::runs::{self, unread};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};

use crate::arguments::refused;
use crate::errors::{Fault, Outcome};
use crate::log::{self, Log};
use crate::robot::Robot;
use crate::watch::Watch;
use crate::work::fit::ORIGIN;

/// Logs, each a run of its own.
pub struct Runs<'py>(Vec<Bound<'py, PyAny>>);

impl<'py> Runs<'py> {
    /// Accepts a Log, a path, or several of them.
    pub fn new(given: &Bound<'py, PyAny>) -> Outcome<Self> {
        let is_one = |item: &Bound<'py, PyAny>| item.is_instance_of::<Log>() || item.extract::<PathBuf>().is_ok();
        let refuse = |given: &Bound<'_, PyAny>| refused("log", "a Log, a path, or a list of them", given);
        let runs: Vec<Bound<'py, PyAny>> = if is_one(given) {
            vec![given.clone()]
        } else {
            let items = given.try_iter().map_err(|_| refuse(given))?;
            items.collect::<PyResult<_>>()?
        };
        if let Some(other) = runs.iter().find(|item| !is_one(item)) {
            return Err(refuse(other));
        }
        if runs.is_empty() {
            return Err(Fault::config("`log` is an empty list; give at least one log"));
        }
        let runs = Self(runs);
        runs.check_given_once()?;
        Ok(runs)
    }

    /// Checks that no sample counts twice.
    fn check_given_once(&self) -> Outcome {
        let files = |item: &Bound<'_, PyAny>| -> Vec<PathBuf> {
            sources(item).iter().filter_map(|path| Path::canonicalize(path).ok()).collect()
        };
        for (count, item) in self.0.iter().enumerate() {
            let (own, span) = (files(item), span(item)?);
            for (place, other) in self.0.iter().take(count).enumerate() {
                if !overlap(span, self::span(other)?) {
                    continue;
                }
                if other.eq(item)? || !is_read(item) && files(other).iter().any(|file| own.contains(file)) {
                    let name = own.first().map_or_else(|| "a log".to_owned(), |path| path.display().to_string());
                    return Err(Fault::config(format!("{name} is given twice, and its samples would count twice")));
                }
                if is_part_of_one(item, other) || files(other).iter().any(|file| own.contains(file)) {
                    return Err(Fault::config(format!(
                        "logs {} and {} of `log` are parts of one log that overlap, and common samples would count twice; give parts \
                         such as log[0.0:5.0] and log[5.0:]",
                        place + 1,
                        count + 1
                    )));
                }
            }
        }
        Ok(())
    }

    /// Returns names for people: the path, or the number of a log without a file.
    pub fn names(&self) -> Vec<String> {
        let name = |(place, item): (usize, &Bound<'_, PyAny>)| {
            let sources = sources(item);
            let names: Vec<String> = sources.iter().map(|path| shown_path(path)).collect();
            if names.is_empty() { format!("log {}", place + 1) } else { names.join(", ") }
        };
        self.0.iter().enumerate().map(name).collect()
    }

    /// Returns the files of all logs.
    pub fn files(&self) -> Vec<PathBuf> {
        self.0.iter().flat_map(sources).collect()
    }

    /// Reads all logs, leaving one more part of the progress to the caller.
    pub fn read<'a>(
        &self,
        robot: &Bound<'py, Robot>,
        file: &'a RobotFile,
        reference: Reference,
        zero: Option<LogZero>,
        watch: &mut Watch<'py>,
    ) -> Outcome<runs::Runs<'a>> {
        let part_count = self.0.len() as u64 + 1;
        let mut runs = runs::Runs::new(file, ORIGIN, reference, zero, self.names(), watch)?;
        for (place, item) in self.0.iter().enumerate() {
            watch.part(place as u64, part_count);
            // Signals that are not compared with are not read.
            let log = log::of(item, robot, Some(unread(reference)), watch)?;
            let told = format!("log {} of `log`", place + 1);
            log.get().with_source(robot.py(), |source| runs.add(&told, source, watch))?;
        }
        watch.part(part_count - 1, part_count);
        Ok(runs)
    }
}

/// Returns the files of a log.
fn sources(item: &Bound<'_, PyAny>) -> Vec<PathBuf> {
    match item.cast::<Log>() {
        Ok(log) => log.get().sources.clone(),
        Err(_) => item.extract().into_iter().collect(),
    }
}

/// Whether this is a log that has been read, not a path.
fn is_read(item: &Bound<'_, PyAny>) -> bool {
    item.is_instance_of::<Log>()
}

/// Whether two logs that have been read are the same one or parts of the same one.
fn is_part_of_one(item: &Bound<'_, PyAny>, other: &Bound<'_, PyAny>) -> bool {
    let logs = item.cast::<Log>().ok().zip(other.cast::<Log>().ok());
    logs.is_some_and(|(log, other)| log.get().shares_origin(other.get()))
}

/// Returns the first and the last stamp of a log, ns: of a path, all times; `None` without rows.
fn span(item: &Bound<'_, PyAny>) -> Outcome<Option<(i64, i64)>> {
    item.cast::<Log>().map_or(Ok(Some((i64::MIN, i64::MAX))), |log| log.get().stamps_nanos(item.py()))
}

/// Whether two logs overlap in time.
fn overlap(one: Option<(i64, i64)>, other: Option<(i64, i64)>) -> bool {
    one.zip(other).is_some_and(|((from, to), (other_from, other_to))| from <= other_to && other_from <= to)
}

/// Returns the zero that each log has of its own, by name.
pub fn named_zero(per_log: Option<&[String]>, runs: &Runs<'_>, reference: Reference) -> Outcome<Option<LogZero>> {
    zero_per_log(per_log.unwrap_or_default(), runs.0.len(), reference).map_err(|error| {
        let advice = error.advice(|reference| format!("reference=\"{}\"", reference.name()));
        let advice = advice.map_or_else(String::new, |advice| format!(". {advice}"));
        Fault::config(format!("`per_log`: {}{advice}", error.cause))
    })
}

/// Returns parameters by name.
pub fn named_parameters(names: &[String]) -> Outcome<Vec<Parameter>> {
    Parameter::all_named(names.iter().map(String::as_str))
        .map_err(|problem| Fault::config(format!("`parameters`: {problem}")))
}
