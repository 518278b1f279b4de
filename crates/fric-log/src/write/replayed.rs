//! The output log of a replay.

use std::path::Path;

use fric_core::{CableOutput, CableStatus, Wrench};

use crate::output::CompleteFile;

use super::{CableStatusChannel, JointState, JointStateChannel, LogWriter, WrenchChannel, WriteError};

/// A log with `/fric/cable_forces`, `/fric/friction`, `/fric/wrench` and `/fric/status`, and the robot file attached.
pub struct ReplayedLog {
    log: LogWriter,
    forces: JointStateChannel,
    friction: JointStateChannel,
    wrench: WrenchChannel,
    status: CableStatusChannel,
    numbers: Vec<f64>,
    flags: Vec<u32>,
}

impl ReplayedLog {
    /// Starts a log like [`LogWriter::create`]; `robot_text` is the text of the robot file.
    ///
    /// # Errors
    /// Returns the errors of [`LogWriter::create`].
    pub fn create(
        path: &Path,
        inputs: &[impl AsRef<Path>],
        force: bool,
        robot_text: &str,
        cable_names: &[impl AsRef<str>],
    ) -> Result<Self, WriteError> {
        let mut log = LogWriter::create(path, inputs, force)?;
        log.attach_robot_file(robot_text)?;
        let bits = CableStatus::NAMES.map(|(name, flag)| (name, flag.bits()));
        Ok(Self {
            forces: log.add_joint_state("/fric/cable_forces", "platform", cable_names)?,
            friction: log.add_joint_state("/fric/friction", "platform", cable_names)?,
            wrench: log.add_wrench("/fric/wrench", "base")?,
            status: log.add_cable_status("/fric/status", "", cable_names, &bits)?,
            numbers: Vec::with_capacity(cable_names.len()),
            flags: Vec::with_capacity(cable_names.len()),
            log,
        })
    }

    /// Writes one cycle.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if there is not one output per cable, the stamp is before 1970 or too late, or the file cannot be written.
    pub fn write(
        &mut self,
        stamp_nanos: i64,
        cables: &[CableOutput],
        outside_wrench: Option<&Wrench>,
    ) -> Result<(), WriteError> {
        let stamp_nanos = u64::try_from(stamp_nanos).map_err(|_| WriteError::EarlyStamp { stamp_nanos })?;
        let Self { log, forces, friction, wrench, status, numbers, flags } = self;
        numbers.clear();
        numbers.extend(cables.iter().map(|cable| cable.force_at_platform_n));
        log.write_joint_state(forces, stamp_nanos, JointState { effort: numbers, ..JointState::default() })?;
        numbers.clear();
        numbers.extend(cables.iter().map(|cable| cable.friction_n));
        log.write_joint_state(friction, stamp_nanos, JointState { effort: numbers, ..JointState::default() })?;
        if let Some(outside) = outside_wrench {
            log.write_wrench(wrench, stamp_nanos, outside)?;
        }
        flags.clear();
        flags.extend(cables.iter().map(|cable| cable.status.bits()));
        log.write_cable_status(status, stamp_nanos, flags)
    }

    /// Completes the log and puts it in its place.
    ///
    /// # Errors
    /// Returns the errors of [`LogWriter::finish`].
    pub fn finish(self) -> Result<(), WriteError> {
        self.log.finish()
    }

    /// Writes the log to its end, without putting it in its place.
    ///
    /// # Errors
    /// Returns the errors of [`LogWriter::complete`].
    pub fn complete(self) -> Result<CompleteFile, WriteError> {
        self.log.complete()
    }
}
