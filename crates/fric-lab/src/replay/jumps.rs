//! The changes of a cable's signals from one sample to the next, beside the limits of `[monitor]`.

use fric_core::robot::file::RobotFile;
use fric_core::{CableInput, CableStatus};

use super::Replay;
use crate::text::{listed, significant};

/// The changes of force and length in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Jumps {
    force_n: Changes,
    length_m: Changes,
}

/// The changes of a signal in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Changes {
    limit: f64,
    last: Option<f64>,
    count: u64,
    /// Number beyond the limit, and the greatest one.
    beyond_count: u64,
    greatest: f64,
}

impl Changes {
    fn add(&mut self, value: f64, elapsed_cycles: f64) {
        if let Some(last) = value.is_finite().then(|| self.last.replace(value)).flatten() {
            let change = (value - last).abs() / elapsed_cycles.max(1.0);
            self.count += 1;
            self.beyond_count += u64::from(change > self.limit);
            self.greatest = self.greatest.max(change);
        }
    }

    /// Returns what the log shows, with the unit.
    fn shown(&self, unit: &str) -> String {
        let Self { count, beyond_count, greatest, .. } = self;
        format!("in the log {beyond_count} of {count} changes are greater, up to {} {unit}", significant(*greatest))
    }
}

impl Jumps {
    /// Creates empty sums beside the limits of the robot, N and m.
    pub fn new(limit_n: f64, limit_m: f64) -> Self {
        let changes = |limit| Changes { limit, ..Changes::default() };
        Self { force_n: changes(limit_n), length_m: changes(limit_m) }
    }

    /// Adds a sample, so many cycles after the last one.
    pub fn add(&mut self, input: &CableInput, elapsed_cycles: f64) {
        self.force_n.add(input.sensor_force_n, elapsed_cycles);
        self.length_m.add(input.length_m, elapsed_cycles);
    }
}

impl Replay {
    /// Returns a warning for each limit of `[monitor]` that a signal exceeded, with what the log shows.
    pub(super) fn jump_warnings(&self, robot: &RobotFile) -> Vec<String> {
        let monitor = &robot.options().monitor;
        let origin = |is_stated: bool, otherwise: &'static str| if is_stated { "" } else { otherwise };
        let sensor_origin = origin(monitor.sensor_jump_n.is_some(), " (from σ and `length_jump_m`)");
        let length_origin = origin(monitor.length_jump_m.is_some(), " (10 m/s)");
        let sensor = self.beyond(robot, CableStatus::SENSOR_JUMP, |jumps| jumps.force_n).map(|(names, changes)| {
            format!(
                "{names}: SENSOR_JUMP is raised for up to 5 s where the force of the sensor changes by more than `sensor_jump_n` in a cycle, here {} N{sensor_origin}; \
                 {}. If that is the load and no fault, state a larger `sensor_jump_n` under `[monitor]` in the robot file",
                significant(changes.limit),
                changes.shown("N")
            )
        });
        let length = self.beyond(robot, CableStatus::LENGTH_JUMP, |jumps| jumps.length_m).map(|(names, changes)| {
            format!(
                "{names}: LENGTH_JUMP is raised where the length changes by more than `length_jump_m` in a cycle, here {} m{length_origin}; {}. If that is the \
                 motion, in metres, and no fault, state a larger `length_jump_m` under `[monitor]` in the robot file",
                significant(changes.limit),
                changes.shown("m")
            )
        });
        sensor.into_iter().chain(length).collect()
    }

    /// Returns the cables with a flag, and the changes of that whose signal changed most; `None` if there are none.
    fn beyond(
        &self,
        robot: &RobotFile,
        flag: CableStatus,
        changes: fn(&Jumps) -> Changes,
    ) -> Option<(String, Changes)> {
        let of_cables = robot.cable_names().into_iter().zip(self.cables());
        let (names, changes): (Vec<&str>, Vec<Changes>) = of_cables
            .filter(|(_, cable)| CableStatus::from_bits(cable.flags).contains(flag))
            .map(|(name, cable)| (name, changes(&cable.jumps)))
            .unzip();
        let most = changes.into_iter().max_by(|one, other| one.greatest.total_cmp(&other.greatest))?;
        Some((listed(&names), most))
    }
}
