//! Checks what a log holds for a discovery, and what it lacks.

use fric_core::robot::file::RobotFile;

use super::lack::too_short;
use crate::fit::readiness::{self, Holdings, Readiness, of_cables};

/// Returns what is missing for a discovery by the forces at the platform.
#[must_use]
pub fn by_forces(robot: &RobotFile, holdings: &Holdings) -> Readiness {
    let advice = "Name their topic as `reference` under `[log]` in the robot file, or search without them";
    let mut readiness = readiness::of_forces(robot, holdings, advice);
    let is_short = |cable: &usize| too_short(holdings.referenced_s(*cable)).is_some();
    let names = robot.cable_names();
    let cables: Vec<usize> = (0..names.len()).filter(|cable| !readiness.is_lacking(*cable)).filter(is_short).collect();
    // Of several cables, the one with the longest record is reported.
    let most_s = cables.iter().map(|cable| holdings.referenced_s(*cable)).fold(0.0, f64::max);
    if let Some(lack) = too_short(most_s).filter(|_| !cables.is_empty()) {
        let cause = lack.cause + &of_cables(&names, &cables);
        readiness.add(cause, lack.advice, cables);
    }
    readiness
}

/// Returns what is missing for a discovery by the wrench on the platform. `origin` names the source of the robot file.
#[must_use]
pub fn by_wrench(robot: &RobotFile, origin: &str, holdings: &Holdings) -> Readiness {
    let mut readiness = readiness::by_wrench(robot, origin, holdings);
    if let Some(lack) = too_short(holdings.balanced_s()).filter(|_| readiness.is_possible()) {
        readiness.add(lack.cause, lack.advice, (0..robot.cable_names().len()).collect());
    }
    readiness
}
