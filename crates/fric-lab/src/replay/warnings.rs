//! What is worth knowing about a replay, a sentence each.

use fric_core::CableStatus;
use fric_core::robot::file::{CableTable, RobotFile};

use super::Replay;
use crate::fit::readiness::without_reference;

impl Replay {
    /// What does nothing, what there is no error of, what is not compensated and what was flagged, so far; `robot` is the
    /// one replayed.
    #[must_use]
    pub fn warnings(&self, robot: &RobotFile) -> Vec<String> {
        let mut warnings = robot.warnings();
        if self.cables().iter().all(|cable| cable.before_n.count() == 0) {
            let (cause, advice) = without_reference(&robot.options().log.reference);
            warnings.push(match advice {
                None => format!(
                    "{cause} for these cables, without which the columns of errors stay empty; name their topic as \
                     `reference` under `[log]` in the robot file"
                ),
                Some(advice) => format!("{cause}; the columns of errors stay empty. {}", advice.trim_end_matches('.')),
            });
        }
        warnings.extend(self.cable_warnings(robot));
        warnings
    }

    /// What of it is about the cables, whatever they are compared with.
    #[must_use]
    pub fn cable_warnings(&self, robot: &RobotFile) -> Vec<String> {
        let mut warnings = Vec::new();
        let frictionless = |cable: &&CableTable| cable.friction.mu == 0.0 && cable.friction.viscous_n_s_per_m == 0.0;
        let tables = robot.options().cable.iter();
        let names: Vec<&str> = tables.filter(frictionless).map(|cable| cable.name.as_str()).collect();
        if !names.is_empty() {
            let names = names.join(", ");
            warnings.push(format!("the robot file gives no `friction` for {names}: nothing is compensated there"));
        }
        // Cables with the same trouble share a line.
        let mut flagged: Vec<(u64, u32, Vec<&str>)> = Vec::new();
        for (name, cable) in robot.cable_names().into_iter().zip(self.cables()) {
            match flagged.iter_mut().find(|(count, flags, _)| (*count, *flags) == (cable.flagged_count, cable.flags)) {
                Some((.., names)) => names.push(name),
                None if cable.flagged_count > 0 => flagged.push((cable.flagged_count, cable.flags, vec![name])),
                None => {}
            }
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
        warnings
    }
}
