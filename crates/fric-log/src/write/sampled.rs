//! A log of samples, on the topics of its signals.

use fric_core::Sample;

use crate::output::CompleteFile;

use super::{JointState, JointStateChannel, LogWriter, PoseChannel, WrenchChannel, WriteError};

/// A log of a robot's signals: those of the cables in every sample, the others if they are added and known.
pub struct SampledLog {
    log: LogWriter,
    cables: JointStateChannel,
    reference: Option<JointStateChannel>,
    pose: Option<PoseChannel>,
    wrench: Option<WrenchChannel>,
    numbers: [Vec<f64>; 3],
}

impl SampledLog {
    /// Adds the topic of the cable signals to a log.
    ///
    /// # Errors
    /// Returns the errors of [`LogWriter::add_joint_state`], as the other functions that add a topic do.
    pub fn new(mut log: LogWriter, topic: &str, cable_names: &[impl AsRef<str>]) -> Result<Self, WriteError> {
        let cables = log.add_joint_state(topic, "base", cable_names)?;
        Ok(Self { log, cables, reference: None, pose: None, wrench: None, numbers: Default::default() })
    }

    /// Adds the topic of the forces at the platform, unless it exists.
    ///
    /// # Errors
    /// See [`Self::new`].
    pub fn add_reference(&mut self, topic: &str, cable_names: &[impl AsRef<str>]) -> Result<(), WriteError> {
        if self.reference.is_none() {
            self.reference = Some(self.log.add_joint_state(topic, "platform", cable_names)?);
        }
        Ok(())
    }

    /// Adds the topic of the pose, unless it exists.
    ///
    /// # Errors
    /// See [`Self::new`].
    pub fn add_pose(&mut self, topic: &str) -> Result<(), WriteError> {
        if self.pose.is_none() {
            self.pose = Some(self.log.add_pose(topic, "base")?);
        }
        Ok(())
    }

    /// Adds the topic of the wrench, unless it exists.
    ///
    /// # Errors
    /// See [`Self::new`].
    pub fn add_wrench(&mut self, topic: &str) -> Result<(), WriteError> {
        if self.wrench.is_none() {
            self.wrench = Some(self.log.add_wrench(topic, "base")?);
        }
        Ok(())
    }

    /// Writes a sample: pose and wrench only `with_platform`, a reference only if that of any cable is known.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if the stamp is before 1970 or too late, or the file cannot be written.
    pub fn write(&mut self, sample: &Sample<'_>, with_platform: bool) -> Result<(), WriteError> {
        let Self { log, cables, reference, pose, wrench, numbers } = self;
        let stamp_nanos = sample.stamp_nanos;
        let stamp_nanos = u64::try_from(stamp_nanos).map_err(|_| WriteError::EarlyStamp { stamp_nanos })?;
        let [position, velocity, effort] = numbers;
        for column in [&mut *position, velocity, effort] {
            column.clear();
        }
        position.extend(sample.cables.iter().map(|cable| cable.length_m));
        velocity.extend(sample.cables.iter().map(|cable| cable.speed_m_per_s));
        effort.extend(sample.cables.iter().map(|cable| cable.sensor_force_n));
        log.write_joint_state(cables, stamp_nanos, JointState { position, velocity, effort })?;
        let is_known = sample.reference_force_n.iter().any(|force_n| !force_n.is_nan());
        if let Some(channel) = reference.as_ref().filter(|_| is_known) {
            let measured = JointState { effort: sample.reference_force_n, ..JointState::default() };
            log.write_joint_state(channel, stamp_nanos, measured)?;
        }
        if !with_platform {
            return Ok(());
        }
        if let (Some(channel), Some(pose)) = (pose, &sample.pose) {
            log.write_pose(channel, stamp_nanos, pose)?;
        }
        if let (Some(channel), Some(outside)) = (wrench, &sample.outside_wrench) {
            log.write_wrench(channel, stamp_nanos, outside)?;
        }
        Ok(())
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
