//! The messages that can be written, each on a channel of its own type.

use fric_core::{Pose, Wrench};

use super::definitions;
use super::error::WriteError;
use super::payload::encode_texts;
use super::{LogWriter, Payload};

/// A channel of `sensor_msgs/msg/JointState`.
#[derive(Debug)]
pub struct JointStateChannel(Channel);

/// A channel of `geometry_msgs/msg/PoseStamped`.
#[derive(Debug)]
pub struct PoseChannel(Channel);

/// A channel of `geometry_msgs/msg/WrenchStamped`.
#[derive(Debug)]
pub struct WrenchChannel(Channel);

/// A channel of `fric_msgs/msg/CableStatus`.
#[derive(Debug)]
pub struct CableStatusChannel(Channel);

/// The numbers of a `JointState`, in the order of the channel's names; each array may be empty.
///
/// For cables the units are metres, metres per second, newtons.
#[derive(Debug, Clone, Copy, Default)]
pub struct JointState<'a> {
    /// Lengths.
    pub position: &'a [f64],
    /// Speeds.
    pub velocity: &'a [f64],
    /// Forces.
    pub effort: &'a [f64],
}

/// A channel of messages with one number for each of some fields.
#[derive(Debug)]
pub struct NumbersChannel(Channel);

#[derive(Debug)]
struct Channel {
    id: u16,
    topic: String,
    /// Number of names in its messages.
    names: usize,
    /// The bytes between the stamp and the numbers.
    texts: Vec<u8>,
}

impl LogWriter {
    /// Adds a topic of joint states, all of them with these names.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if the topic is taken or the file cannot be written.
    pub fn add_joint_state(
        &mut self,
        topic: &str,
        frame_id: &str,
        names: &[impl AsRef<str>],
    ) -> Result<JointStateChannel, WriteError> {
        let names = owned(names);
        let schema = definitions::joint_state();
        self.add(topic, definitions::JOINT_STATE, &schema, frame_id, Some(&names)).map(JointStateChannel)
    }

    /// Adds a topic of poses.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if the topic is taken or the file cannot be written.
    pub fn add_pose(&mut self, topic: &str, frame_id: &str) -> Result<PoseChannel, WriteError> {
        self.add(topic, definitions::POSE, &definitions::pose(), frame_id, None).map(PoseChannel)
    }

    /// Adds a topic of wrenches.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if the topic is taken or the file cannot be written.
    pub fn add_wrench(&mut self, topic: &str, frame_id: &str) -> Result<WrenchChannel, WriteError> {
        self.add(topic, definitions::WRENCH, &definitions::wrench(), frame_id, None).map(WrenchChannel)
    }

    /// Adds a topic of cable states; `bits` are the names and values of the flags.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if the topic is taken, a flag's name is invalid, or the file cannot be written.
    pub fn add_cable_status(
        &mut self,
        topic: &str,
        frame_id: &str,
        names: &[impl AsRef<str>],
        bits: &[(&str, u32)],
    ) -> Result<CableStatusChannel, WriteError> {
        let names = owned(names);
        let schema = definitions::cable_status(bits)?;
        self.add(topic, definitions::CABLE_STATUS, &schema, frame_id, Some(&names)).map(CableStatusChannel)
    }

    /// Adds a topic of messages of the type `name`, such as `fric_msgs/msg/TendonRun`, with a header and one `float64` per field.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if the topic is taken, a field's name is invalid, or the file cannot be written.
    pub fn add_numbers(&mut self, topic: &str, name: &str, fields: &[String]) -> Result<NumbersChannel, WriteError> {
        let schema = definitions::numbers(fields)?;
        let channel = self.add(topic, name, &schema, "", None)?;
        Ok(NumbersChannel(Channel { names: fields.len(), ..channel }))
    }

    /// Writes one number per field; stamp, log time and publish time are `stamp_nanos` since 1970.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if there is not one number per field, the stamp is too late, or the file cannot be written.
    pub fn write_numbers(
        &mut self,
        channel: &NumbersChannel,
        stamp_nanos: u64,
        numbers: &[f64],
    ) -> Result<(), WriteError> {
        channel.0.check_length("numbers", numbers.len())?;
        self.write(&channel.0, stamp_nanos, |payload| {
            for number in numbers {
                payload.f64(*number);
            }
        })
    }

    /// Writes one joint state; stamp, log time and publish time are `stamp_nanos` since 1970.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if a non-empty array does not have one element per name, the stamp is too late, or the file cannot be written.
    pub fn write_joint_state(
        &mut self,
        channel: &JointStateChannel,
        stamp_nanos: u64,
        state: JointState<'_>,
    ) -> Result<(), WriteError> {
        let channel = &channel.0;
        let JointState { position, velocity, effort } = state;
        for (field, numbers) in [("position", position), ("velocity", velocity), ("effort", effort)] {
            if !numbers.is_empty() {
                channel.check_length(field, numbers.len())?;
            }
        }
        self.write(channel, stamp_nanos, |payload| {
            payload.f64_sequence(position);
            payload.f64_sequence(velocity);
            payload.f64_sequence(effort);
        })
    }

    /// Writes one pose, in the frame of the channel; stamp, log time and publish time are `stamp_nanos` since 1970.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if the stamp is too late or the file cannot be written.
    pub fn write_pose(&mut self, channel: &PoseChannel, stamp_nanos: u64, pose: &Pose) -> Result<(), WriteError> {
        self.write(&channel.0, stamp_nanos, |payload| {
            // The quaternion's coordinates are in the order of the message: x, y, z, w.
            for number in pose.position_m.iter().chain(pose.orientation.coords.iter()) {
                payload.f64(*number);
            }
        })
    }

    /// Writes one wrench, in the axes of the channel's frame; stamp, log time and publish time are `stamp_nanos` since 1970.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if the stamp is too late or the file cannot be written.
    pub fn write_wrench(
        &mut self,
        channel: &WrenchChannel,
        stamp_nanos: u64,
        wrench: &Wrench,
    ) -> Result<(), WriteError> {
        self.write(&channel.0, stamp_nanos, |payload| {
            for number in wrench.force_n.iter().chain(wrench.torque_nm.iter()) {
                payload.f64(*number);
            }
        })
    }

    /// Writes the flags of all cables; stamp, log time and publish time are `stamp_nanos` since 1970.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if there is not one flag word per name, the stamp is too late, or the file cannot be written.
    pub fn write_cable_status(
        &mut self,
        channel: &CableStatusChannel,
        stamp_nanos: u64,
        flags: &[u32],
    ) -> Result<(), WriteError> {
        channel.0.check_length("flags", flags.len())?;
        self.write(&channel.0, stamp_nanos, |payload| payload.u32_sequence(flags))
    }

    fn add(
        &mut self,
        topic: &str,
        schema_name: &str,
        schema: &str,
        frame_id: &str,
        names: Option<&[String]>,
    ) -> Result<Channel, WriteError> {
        let texts = encode_texts(frame_id, names)?;
        Ok(Channel {
            id: self.add_channel(topic, schema_name, schema)?,
            topic: topic.to_owned(),
            names: names.map_or(0, <[String]>::len),
            texts,
        })
    }

    fn write(
        &mut self,
        channel: &Channel,
        stamp_nanos: u64,
        numbers: impl FnOnce(&mut Payload),
    ) -> Result<(), WriteError> {
        self.payload.start(&channel.topic, stamp_nanos)?;
        self.payload.encoded(&channel.texts);
        numbers(&mut self.payload);
        self.write_payload(channel.id, stamp_nanos)
    }
}

impl Channel {
    fn check_length(&self, field: &'static str, found: usize) -> Result<(), WriteError> {
        if found == self.names {
            return Ok(());
        }
        Err(WriteError::Length { topic: self.topic.clone(), field, expected: self.names, found })
    }
}

fn owned(names: &[impl AsRef<str>]) -> Vec<String> {
    names.iter().map(|name| name.as_ref().to_owned()).collect()
}
