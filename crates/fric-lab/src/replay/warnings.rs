//! Warnings about a replay, one sentence each.

use fric_core::CableStatus;
use fric_core::robot::file::{CableTable, RobotFile};

use super::Replay;
use crate::fit::readiness::{NEGATIVE_ADVICE, NEGATIVE_FORCE, without_reference};
use crate::lateness::{self, Lateness};
use crate::set_up;
use crate::weight::NEVER_QUIET;

/// Poses come at 10 Hz or faster, so a log ends no later than this after the last one.
const POSE_INTERVAL_S: f64 = 0.1;

impl Replay {
    /// Returns the number of cycles that a log may continue after its last pose.
    fn cycles_between_poses(&self) -> u64 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive, and saturates")]
        let cycles = (POSE_INTERVAL_S / self.cycle_s).ceil() as u64;
        cycles
    }

    /// Returns warnings about inputs that had no effect, missing references, uncompensated cables and flagged cycles so far. `robot` is the replayed
    /// robot, and `has_columns` tells a log of rows from one of messages.
    #[must_use]
    pub fn warnings(&self, robot: &RobotFile, has_columns: bool) -> Vec<String> {
        let mut warnings = robot.warnings();
        if self.cables().iter().all(|cable| cable.before_n.count() == 0) {
            let (cause, advice) = without_reference(&robot.options().log.reference, has_columns);
            warnings.push(match advice {
                None => format!(
                    "{cause} for these cables, without which the columns of errors stay empty; name their topic as \
                     `reference` under `[log]` in the robot file"
                ),
                Some(advice) => format!("{cause}; the columns of errors stay empty. {}", advice.trim_end_matches('.')),
            });
        }
        if self.by_mass.as_ref().is_some_and(|by_mass| by_mass.has_wrench && by_mass.before.rms().is_none()) {
            warnings.push(format!("the wrench is not compared with the platform's weight: {NEVER_QUIET}"));
        }
        warnings.extend(self.cable_warnings(robot));
        warnings.extend(self.signals.warnings(&robot.cable_names()));
        let late_s = self.lateness.iter().map(Lateness::seconds);
        warnings.extend(lateness::warnings(robot.cable_names().into_iter().zip(late_s)));
        let set_ups = self.cables().iter().map(|cable| cable.set_up);
        let set_ups = robot.cable_names().into_iter().zip(set_ups);
        warnings.extend(set_up::warnings(set_ups.clone()));
        warnings.extend(set_up::zero_warning(set_ups));
        warnings
    }

    /// Returns those warnings that concern the cables, independent of the reference.
    #[must_use]
    pub fn cable_warnings(&self, robot: &RobotFile) -> Vec<String> {
        let mut warnings = Vec::new();
        let frictionless = |cable: &&CableTable| cable.friction.mu == 0.0 && cable.friction.viscous_n_s_per_m == 0.0;
        let tables = robot.options().cable.iter();
        let names: Vec<&str> = tables.filter(frictionless).map(|cable| cable.name.as_str()).collect();
        if !names.is_empty() {
            let names = names.join(", ");
            warnings.push(format!(
                "the robot file has no `friction` for {names}: what acts there are effects and offset alone"
            ));
        }
        // Poses are not extrapolated past the last one, which is no problem.
        let end_count = |count: u64| if count <= self.cycles_between_poses() { count } else { 0 };
        // Cables with the same problem share a line.
        let mut flagged: Vec<(u64, u32, Vec<&str>)> = Vec::new();
        for (name, cable) in robot.cable_names().into_iter().zip(self.cables()) {
            let end_count = end_count(cable.poseless_end_count);
            let flags = if end_count > 0 { cable.flags_before_end } else { cable.flags };
            let trouble = (cable.flagged_count - end_count, flags);
            match flagged.iter_mut().find(|(count, flags, _)| (*count, *flags) == trouble) {
                Some((.., names)) => names.push(name),
                None if trouble.0 > 0 => flagged.push((trouble.0, trouble.1, vec![name])),
                None => {}
            }
        }
        let of_cables = robot.cable_names().into_iter().zip(self.cables());
        let pushing = of_cables.filter(|(_, cable)| cable.tension.is_turned());
        let names: Vec<&str> = pushing.map(|(name, _)| name).collect();
        if !names.is_empty() {
            let names = names.join(", ");
            warnings.push(format!("{NEGATIVE_FORCE} of {names}. {}", NEGATIVE_ADVICE.trim_end_matches('.')));
        }
        let still: Vec<&str> =
            self.signals.still().into_iter().filter_map(|cable| robot.cable_names().get(cable).copied()).collect();
        if !still.is_empty() {
            warnings.push(format!(
                "the length of {} never changes; friction is that of motion, so that none is compensated there",
                still.join(", ")
            ));
        }
        let silent = CableStatus::SENSOR_NOT_FINITE | CableStatus::MOTION_NOT_FINITE;
        let total = self.cycle_count();
        for (count, flags, names) in flagged {
            let (names, flags) = (names.join(", "), CableStatus::from_bits(flags));
            warnings.push(if count == total && flags == silent {
                format!("the log has no signal of {names}; compare the names in it")
            } else {
                format!("{count} of {total} samples are flagged {flags}: {names}")
            });
        }
        warnings.extend(self.jump_warnings(robot));
        warnings
    }
}
