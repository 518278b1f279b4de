//! Writing logs: MCAP with the ROS 2 messages that fric produces.
//!
//! A log appears in its place, complete, when it is finished; see [`output`](crate::output). Equal calls give equal bytes: chunks have a fixed size,
//! one thread writes them all, and no clock is used.
//!
//! Exactly the message types named here are written, with the `ros2msg` definitions of the ROS 2 packages they come from. NaN and infinities are
//! written unchanged. A separate thread frames, compresses and writes, so that a later call, at the latest [`LogWriter::finish`], may report a
//! message that cannot be written. A [`LogWriter`] holds one chunk's index and less than a megabyte of messages.

mod background;
mod definitions;
mod error;
mod messages;
mod payload;
mod replayed;
mod sampled;

use std::collections::BTreeMap;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use mcap::{Attachment, Compression, McapError, WriteOptions};

use crate::output::{CompleteFile, OutputError, OutputFile};
use background::BackgroundWriter;
pub use error::WriteError;
pub use messages::{CableStatusChannel, JointState, JointStateChannel, NumbersChannel, PoseChannel, WrenchChannel};
use payload::Payload;
pub use replayed::ReplayedLog;
pub use sampled::SampledLog;

const LIBRARY: &str = concat!("fric ", env!("CARGO_PKG_VERSION"));
const CHUNK_BYTES: u64 = 1 << 20;
const ZSTD_LEVEL: u32 = 3;

/// A log being written.
///
/// ```
/// use fric_log::write::{JointState, LogWriter};
///
/// let directory = tempfile::tempdir()?;
/// let path = directory.path().join("forces.mcap");
/// let mut writer = LogWriter::create(&path, &["run.mcap"], false)?;
/// let forces = writer.add_joint_state("/fric/cable_forces", "", &["cable1", "cable2"])?;
/// let effort = [12.5, 13.0];
/// writer.write_joint_state(&forces, 1_000_000, JointState { effort: &effort, ..JointState::default() })?;
/// assert!(!path.exists());
/// writer.finish()?;
/// assert!(path.exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct LogWriter {
    writer: BackgroundWriter<BufWriter<OutputFile>>,
    path: PathBuf,
    topics: Vec<String>,
    payload: Payload,
}

impl LogWriter {
    /// Starts a log that will be at `path` once finished; `inputs` and `force` are those of [`OutputFile::create`].
    ///
    /// # Errors
    /// Returns the errors of [`OutputFile::create`].
    pub fn create(path: &Path, inputs: &[impl AsRef<Path>], force: bool) -> Result<Self, WriteError> {
        let file = OutputFile::create(path, inputs, force)?;
        let writer = WriteOptions::new()
            .profile("ros2")
            .library(LIBRARY)
            .compression(Some(Compression::Zstd))
            .compression_level(ZSTD_LEVEL)
            .compression_threads(0)
            .chunk_size(Some(CHUNK_BYTES))
            .create(BufWriter::new(file))
            .map_err(|source| mcap_error(path, source))?;
        let writer = BackgroundWriter::new(writer);
        Ok(Self { writer, path: path.to_owned(), topics: Vec::new(), payload: Payload::default() })
    }

    /// Attaches the text of the robot file, preferably before the first channel is added.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if the file cannot be written.
    pub fn attach_robot_file(&mut self, toml: &str) -> Result<(), WriteError> {
        let attachment = Attachment {
            log_time: 0,
            create_time: 0,
            name: crate::robot::ROBOT_FILE.to_owned(),
            media_type: "application/toml".to_owned(),
            data: toml.as_bytes().into(),
        };
        let result = self.writer.writer().and_then(|writer| writer.attach(&attachment));
        result.map_err(|source| mcap_error(&self.path, source))
    }

    /// Completes the log and puts it in its place.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if the file cannot be written, or if another one has appeared in its place and `force` is not set.
    pub fn finish(self) -> Result<(), WriteError> {
        Ok(self.complete()?.place()?)
    }

    /// Writes the log to its end, without putting it in its place.
    ///
    /// # Errors
    /// Returns a [`WriteError`] if a message, this one or an earlier one, cannot be written.
    pub fn complete(self) -> Result<CompleteFile, WriteError> {
        let Self { writer, path, .. } = self;
        let mut writer = writer.into_writer().map_err(|source| mcap_error(&path, source))?;
        writer.finish().map_err(|source| mcap_error(&path, source))?;
        let file = writer.into_inner().into_inner();
        let file = file.map_err(|error| OutputError::File { path, source: error.into_error() })?;
        Ok(file.complete()?)
    }

    fn add_channel(&mut self, topic: &str, schema_name: &str, schema: &str) -> Result<u16, WriteError> {
        if self.topics.iter().any(|known| known == topic) {
            return Err(WriteError::Topic { topic: topic.to_owned() });
        }
        self.topics.push(topic.to_owned());
        let id = self.writer.writer().and_then(|writer| {
            let schema = writer.add_schema(schema_name, "ros2msg", schema.as_bytes())?;
            writer.add_channel(schema, topic, "cdr", &BTreeMap::new())
        });
        id.map_err(|source| mcap_error(&self.path, source))
    }

    /// Writes the message in `payload`.
    fn write_payload(&mut self, channel_id: u16, stamp_nanos: u64) -> Result<(), WriteError> {
        let result = self.writer.write(channel_id, stamp_nanos, self.payload.bytes());
        result.map_err(|source| mcap_error(&self.path, source))
    }
}

fn mcap_error(path: &Path, source: McapError) -> WriteError {
    let path = path.to_owned();
    match (refused(&source), source) {
        (Some(source), _) | (None, McapError::Io(source)) => OutputError::File { path, source }.into(),
        (None, source) => WriteError::Mcap { path, source },
    }
}

/// Returns the message of the operating system, of which the writers of records (`binrw`) and of chunks only pass on the text.
fn refused(error: &McapError) -> Option<io::Error> {
    let text = match error {
        McapError::Parse(error) => error.to_string(),
        McapError::Io(error) if error.kind() == io::ErrorKind::Other => error.to_string(),
        _ => return None,
    };
    let (code, _) = text.split_once("(os error ")?.1.split_once(')')?;
    code.parse().ok().map(io::Error::from_raw_os_error)
}
