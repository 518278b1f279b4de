//! The machine-readable result of a discovery, `format = "fric-discover/1"`, with additional data for reports.
//!
//! `before`, `after` and all `held_out` figures refer to the same samples: those of `held_out_samples`. The closed fraction of the gap is `1 − (error
//! − floor)/(before − floor)` in root mean squares; the fraction of an effect includes the effect and all above it in the list. If nothing is missing
//! there is no gap, and the fraction is null.

mod cable;
mod common;
mod effect;
mod machine;
mod place;
mod revised;
mod table;
mod wrench;

use fric_core::robot::file::RobotFile;
use serde::Serialize;

use super::report::CableDiscovery;
use super::wrench::WrenchDiscovery;
use crate::fit::FitError;
use crate::fit::readiness::Readiness;
use crate::words::Times;

use self::cable::cable_result;
use self::common::common_effects;
use self::machine::is_absent;

pub use cable::{DiscoverCableResult, Missing};
pub use common::{CommonEffect, CommonParameter};
pub use effect::{Candidate, EffectResult, Evidence, RunnerUpResult, TriedResult};
pub use machine::{Absent, Machine, Robot, Value};
pub use place::{UnexplainedResult, WhereResult};
pub use revised::RevisedResult;
pub use table::{TablePoint, TableResult};
pub use wrench::{GeometryResult, TriedTogether, WrenchComponent, WrenchGap};

/// The result of a discovery.
#[derive(Clone, Debug, Serialize)]
#[serde(bound = "")]
pub struct DiscoverResult<M: Machine = Robot> {
    /// Name and version of the format.
    pub format: &'static str,
    /// The logs, in order.
    pub log: Vec<String>,
    /// Start of each log, s. Several logs follow one another.
    #[serde(skip_serializing_if = "is_absent")]
    pub log_start_s: M::OfRobots<Vec<f64>>,
    /// Name of the robot or the manipulator.
    pub robot: String,
    /// The cables in the robot's order, or the tendon.
    pub cables: Vec<DiscoverCableResult<M>>,
    /// Effects that several cables share.
    #[serde(skip_serializing_if = "is_absent")]
    pub common_effects: M::OfRobots<Vec<CommonEffect>>,
    /// Results for all cables together, if they were compared with the wrench.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrench: Option<M::OfRobots<WrenchGap>>,
}

impl DiscoverResult {
    /// Creates the result for a robot's cables. `logs` holds the name and the start of each log, s.
    #[must_use]
    pub fn new(
        robot: &RobotFile,
        logs: &[(String, f64)],
        readiness: &Readiness,
        discoveries: &[CableDiscovery],
    ) -> Self {
        let names = robot.cable_names();
        let log: Vec<String> = logs.iter().map(|(name, _)| name.clone()).collect();
        let params = robot.params();
        let cables = discoveries.iter().zip(params.cables()).enumerate();
        let cables: Vec<DiscoverCableResult> = cables
            .map(|(place, (found, given))| {
                let lack = readiness.lack_of(place).map(|lack| (lack.cause.clone(), lack.advice));
                cable_result(place, &names, found, lack, &log, &given.values())
            })
            .collect();
        Self {
            format: Self::FORMAT,
            log,
            log_start_s: logs.iter().map(|(_, start_s)| *start_s).collect(),
            robot: robot.options().name.clone(),
            common_effects: common_effects(&cables),
            wrench: None,
            cables,
        }
    }

    /// Adds the findings for all cables together.
    #[must_use]
    pub fn with_wrench(mut self, found: Option<&WrenchDiscovery>) -> Self {
        let names: Vec<String> = self.cables.iter().map(|cable| cable.name.clone()).collect();
        self.wrench = found.map(|found| WrenchGap::of(found, &names));
        // A value that all cables share is as certain as on each cable.
        for effect in &mut self.common_effects {
            let first = self.cables.iter().flat_map(|cable| &cable.effects).find(|of| of.kind == effect.kind);
            let is_alike = found.is_some_and(|found| found.alike.iter().any(|alike| alike.kind() == effect.kind));
            for parameter in effect.parameters.iter_mut().filter(|_| is_alike) {
                let error = first.and_then(|of| of.standard_errors.get(parameter.key));
                parameter.standard_error = error.unwrap_or(parameter.standard_error);
            }
        }
        self
    }

    /// Returns the logs that its times are of.
    #[must_use]
    pub fn times(&self) -> Times<'_> {
        Times::new(self.log.iter().map(String::as_str).zip(self.log_start_s.iter().copied()))
    }

    /// Checks that at least one cable has a verdict.
    ///
    /// # Errors
    /// Returns a [`FitError`] with the reason if none has.
    pub fn check_told(&self) -> Result<(), FitError> {
        let missing: Vec<&Missing> = self.cables.iter().filter_map(|cable| cable.missing.as_ref()).collect();
        let (Some(first), true) = (missing.first(), missing.len() == self.cables.len()) else { return Ok(()) };
        let name = self.cables.first().map_or("", |cable| cable.name.as_str());
        let others = if self.cables.len() > 1 { ", and nothing of the others" } else { "" };
        Err(FitError::new(format!("the log tells nothing of {name}{others}: {}", first.cause), first.advice))
    }
}

impl<M: Machine> DiscoverResult<M> {
    /// Name and version of the format.
    pub const FORMAT: &str = "fric-discover/1";

    /// Returns a summary for people: the verdicts, then the findings.
    #[must_use]
    pub fn summary(&self) -> String {
        M::summary(self)
    }
}

/// Returns the number if it is finite.
fn finite(number: f64) -> Option<f64> {
    number.is_finite().then_some(number)
}
