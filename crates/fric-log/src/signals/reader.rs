//! The stream of rows.

use fric_core::{CableInput, Pose, Sample, Wrench};
use thiserror::Error;

use super::channel::ChannelReader;
use super::track::{Arrival, Track, Tracked};
use super::{Role, SignalPaths, TrackCounts, WAIT_NANOS};
use crate::recording::{Message, Recording, RecordingError};
use crate::schema::SchemaError;

/// Why there are no rows.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SignalError {
    /// The recording cannot be read any further.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The recording has no cable signal.
    #[error("the log has no messages on `{topic}`, the topic of the cable signals; {}", available(topics))]
    NoCableTopic {
        /// The topic looked for.
        topic: String,
        /// Those there are.
        topics: Vec<String>,
    },
    /// The cable signal cannot be found in its messages.
    #[error("the messages on `{topic}` cannot be read as cable signals: {source}")]
    CableFields {
        /// The topic.
        topic: String,
        /// Why.
        source: SchemaError,
    },
    /// Not one message on the cable topic could be used.
    #[error("no message on `{topic}` can be used: {reason}")]
    NoUsableMessage {
        /// The topic.
        topic: String,
        /// What is wrong with the first one.
        reason: String,
    },
    /// There is force but no length.
    #[error(
        "the messages on `{topic}` bring forces but no cable lengths (`position`); name the topic or path of the \
         lengths as `length` under `[log]` in the robot file"
    )]
    NoLength {
        /// The topic.
        topic: String,
    },
}

fn available(topics: &[String]) -> String {
    if topics.is_empty() {
        return "it has no messages at all".to_owned();
    }
    format!("it has {}. Name the right one as `cable` under `[log]` in the robot file", topics.join(", "))
}

/// Reads the rows of a recording.
///
/// ```no_run
/// use fric_log::recording::Recording;
/// use fric_log::signals::{Role, SignalPaths, SignalReader};
///
/// let paths = SignalPaths::default().with(Role::Cable, Some("/cable_states".parse()?));
/// let recording = Recording::open(&["run.mcap"])?;
/// let mut reader = SignalReader::new(recording, paths, &["cable1"]);
/// while let Some(row) = reader.next_row()? {
///     println!("{} {} N", row.stamp_nanos, row.cables[0].sensor_force_n);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SignalReader {
    recording: Recording,
    paths: SignalPaths,
    cable_names: Vec<String>,
    /// By channel: who reads it; `None` until its first message.
    channels: Vec<Option<Vec<ChannelReader>>>,
    tracks: [Track; 6],
    /// Messages that could not be used: role and reason of the first.
    first_problem: [Option<String>; 6],
    cable_topic: Option<CableTopic>,
    is_ended: bool,
    /// The cable clock was set back: rows of the time before no longer wait.
    flush: Option<Flush>,
    row: RowBuffer,
}

/// What the messages of the cable signal bring.
#[derive(Debug, Clone, Copy)]
struct CableTopic {
    has_speed: bool,
}

/// A clock step: the last time before, and the latest time since.
#[derive(Debug, Clone, Copy)]
struct Flush {
    old_nanos: i64,
    new_nanos: i64,
}

/// The row given out, and what the next one needs of it.
#[derive(Debug, Default)]
struct RowBuffer {
    stamp_nanos: i64,
    cables: Vec<CableInput>,
    reference_force_n: Vec<f64>,
    pose: Option<Pose>,
    outside_wrench: Option<Wrench>,
    last: Option<i64>,
    last_length_m: Vec<f64>,
}

impl SignalReader {
    /// Rows of a recording for a robot with cables of these names.
    #[must_use]
    pub fn new(recording: Recording, paths: SignalPaths, cable_names: &[impl AsRef<str>]) -> Self {
        let cable_names: Vec<String> = cable_names.iter().map(|name| name.as_ref().to_owned()).collect();
        let row = RowBuffer {
            cables: vec![CableInput::default(); cable_names.len()],
            reference_force_n: vec![f64::NAN; cable_names.len()],
            last_length_m: vec![f64::NAN; cable_names.len()],
            ..RowBuffer::default()
        };
        Self {
            recording,
            paths,
            cable_names,
            channels: Vec::new(),
            tracks: Default::default(),
            first_problem: Default::default(),
            cable_topic: None,
            is_ended: false,
            flush: None,
            row,
        }
    }

    /// The recording, for its damage and its progress.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// What has been counted for a role so far.
    #[must_use]
    pub fn counts(&self, role: Role) -> &TrackCounts {
        self.tracks[role as usize].counts()
    }

    /// What was wrong with the first message of a role that could not be used.
    #[must_use]
    pub fn first_problem(&self, role: Role) -> Option<&str> {
        self.first_problem[role as usize].as_deref()
    }

    /// The next row; `None` at the end of the log.
    ///
    /// # Errors
    /// [`SignalError`] where the recording cannot be read on, or has no usable cable signal.
    pub fn next_row(&mut self) -> Result<Option<Sample<'_>>, SignalError> {
        while !self.is_ready() {
            if self.is_ended {
                return self.check_end().map(|()| None);
            }
            self.read_message()?;
        }
        let Some(sample) = self.tracks[Role::Cable as usize].pop() else { return Ok(None) };
        self.fill_row(&sample);
        let track = &mut self.tracks[Role::Cable as usize];
        track.recycle(sample);
        if track.samples().is_empty()
            && let Some(flush) = self.flush.take()
        {
            self.finish_flush(flush);
        }
        let row = &self.row;
        Ok(Some(Sample {
            stamp_nanos: row.stamp_nanos,
            cables: &row.cables,
            reference_force_n: &row.reference_force_n,
            pose: row.pose,
            outside_wrench: row.outside_wrench,
        }))
    }

    /// Whether the oldest cable sample has all that it can get.
    fn is_ready(&self) -> bool {
        let [cable, others @ ..] = &self.tracks;
        let Some(oldest) = cable.samples().front() else { return false };
        if self.is_ended || self.flush.is_some() {
            return true;
        }
        let stamp_nanos = oldest.stamp_nanos;
        let roles = Role::ALL.iter().skip(1);
        let complete = others.iter().zip(roles).all(|(track, role)| {
            self.paths.get(*role).is_none() || track.newest_nanos().is_some_and(|newest| newest >= stamp_nanos)
        });
        complete || cable.newest_nanos().is_some_and(|newest| newest.saturating_sub(stamp_nanos) >= WAIT_NANOS)
    }

    fn read_message(&mut self) -> Result<(), SignalError> {
        let Some(message) = self.recording.next_message()? else {
            self.is_ended = true;
            self.tracks.iter_mut().for_each(Track::finish);
            return Ok(());
        };
        let id = message.channel.id;
        if self.channels.len() <= id {
            self.channels.resize_with(id + 1, || None);
        }
        let Some(entry) = self.channels.get_mut(id) else { return Ok(()) };
        let readers = match entry {
            Some(readers) => readers,
            None => entry.insert(open_channel(&message, &self.paths, &mut self.cable_topic, &mut self.first_problem)?),
        };
        let mut clock_step = None;
        for reader in readers {
            let role = reader.role;
            let track = &mut self.tracks[role as usize];
            match reader.read(&message, &self.cable_names) {
                Ok(decoded) => {
                    if track.push(decoded.stamp_nanos, |values| decoded.fill(values)) == Arrival::ClockStep {
                        clock_step = Some((role, decoded.stamp_nanos));
                    }
                }
                Err(reason) => {
                    track.count_undecodable();
                    self.first_problem[role as usize].get_or_insert(reason);
                }
            }
        }
        match clock_step {
            Some((Role::Cable, new_nanos)) => {
                let newest_nanos = self.tracks[Role::Cable as usize].newest_nanos();
                let flush = Flush { old_nanos: newest_nanos.unwrap_or(new_nanos), new_nanos };
                match newest_nanos {
                    Some(_) => self.flush = Some(flush),
                    None => self.finish_flush(flush),
                }
            }
            Some((role, _)) => self.tracks[role as usize].restart(),
            None => {}
        }
        Ok(())
    }

    /// The rows of the time before a clock step are out: all goes on in the new time.
    fn finish_flush(&mut self, flush: Flush) {
        let [cable, others @ ..] = &mut self.tracks;
        cable.restart();
        for track in others {
            // Some signals may have gone back already; those that have not would hide what is to come.
            let is_old = |newest: i64| newest.abs_diff(flush.old_nanos) < newest.abs_diff(flush.new_nanos);
            if track.newest_nanos().is_some_and(is_old) {
                track.clear();
            }
        }
    }

    fn check_end(&self) -> Result<(), SignalError> {
        let topic = self.paths.get(Role::Cable).map_or_else(String::new, |path| path.topic.clone());
        if self.cable_topic.is_none() {
            let topics = self.recording.channels().iter().map(|channel| channel.topic.clone()).collect();
            return Err(SignalError::NoCableTopic { topic, topics });
        }
        if self.counts(Role::Cable).message_count == 0 {
            let reason = self.first_problem(Role::Cable).unwrap_or("it is empty").to_owned();
            return Err(SignalError::NoUsableMessage { topic, reason });
        }
        Ok(())
    }

    fn fill_row(&mut self, sample: &Tracked) {
        let row = &mut self.row;
        let stamp_nanos = sample.stamp_nanos;
        row.stamp_nanos = stamp_nanos;
        let [_, length, speed, reference, pose, wrench] = &mut self.tracks;
        for track in [&mut *length, speed, reference, pose, wrench] {
            track.advance(stamp_nanos);
        }
        let count = row.cables.len();
        let quantity = |index: usize, cable: usize| sample.values.get(index * count + cable).copied();
        let has_speed = self.cable_topic.is_some_and(|topic| topic.has_speed);
        let own_length = self.paths.get(Role::Length).is_none();
        let own_speed = self.paths.get(Role::Speed).is_none();
        let lengths = if own_length { None } else { length.around(stamp_nanos) };
        let speeds = if own_speed { None } else { speed.around(stamp_nanos) };
        #[expect(clippy::cast_precision_loss, reason = "an interval between two rows")]
        let interval_s = row.last.map_or(f64::NAN, |last| stamp_nanos.saturating_sub(last) as f64 * 1e-9);
        for (index, (cable, last_length_m)) in row.cables.iter_mut().zip(&mut row.last_length_m).enumerate() {
            cable.sensor_force_n = quantity(0, index).unwrap_or(f64::NAN);
            cable.length_m = if own_length { quantity(1, index).unwrap_or(f64::NAN) } else { between(lengths, index) };
            cable.speed_m_per_s = match (own_speed, has_speed) {
                (false, _) => between(speeds, index),
                (true, true) => quantity(2, index).unwrap_or(f64::NAN),
                (true, false) => derived_speed(cable.length_m - *last_length_m, interval_s),
            };
            *last_length_m = cable.length_m;
        }
        row.last = Some(stamp_nanos);
        let references = reference.around(stamp_nanos);
        for (index, place) in row.reference_force_n.iter_mut().enumerate() {
            *place = between(references, index);
        }
        row.pose = pose.around(stamp_nanos).and_then(|(before, after, ratio)| {
            let first = pose_of(&before.values)?;
            if ratio == 0.0 { Some(first) } else { Some(first.interpolate(&pose_of(&after.values)?, ratio)) }
        });
        let wrenches = wrench.around(stamp_nanos);
        row.outside_wrench = wrenches.map(|_| {
            let coordinate = |index: usize| between(wrenches, index);
            Wrench {
                force_n: [coordinate(0), coordinate(1), coordinate(2)].into(),
                torque_nm: [coordinate(3), coordinate(4), coordinate(5)].into(),
            }
        });
    }
}

/// Who reads a channel, found at its first message.
fn open_channel(
    message: &Message<'_>,
    paths: &SignalPaths,
    cable_topic: &mut Option<CableTopic>,
    first_problem: &mut [Option<String>; 6],
) -> Result<Vec<ChannelReader>, SignalError> {
    let mut readers = Vec::new();
    for role in Role::ALL {
        let Some(path) = paths.get(role).filter(|path| path.topic == message.channel.topic) else { continue };
        match ChannelReader::new(role, &path.field, message.channel, message.data) {
            Ok(reader) => {
                if role == Role::Cable {
                    if !reader.has_quantity(1) && paths.get(Role::Length).is_none() {
                        return Err(SignalError::NoLength { topic: path.topic.clone() });
                    }
                    *cable_topic = Some(CableTopic { has_speed: reader.has_quantity(2) });
                }
                readers.push(reader);
            }
            Err(source) if role == Role::Cable => {
                return Err(SignalError::CableFields { topic: path.topic.clone(), source });
            }
            Err(source) => first_problem[role as usize] = Some(source.to_string()),
        }
    }
    Ok(readers)
}

/// Change of length per time; 0 where there is no row before, or time went back.
fn derived_speed(change_m: f64, interval_s: f64) -> f64 {
    let speed_m_per_s = change_m / interval_s;
    if interval_s > 0.0 && speed_m_per_s.is_finite() { speed_m_per_s } else { 0.0 }
}

fn between(samples: Option<(&Tracked, &Tracked, f64)>, index: usize) -> f64 {
    let Some((before, after, ratio)) = samples else { return f64::NAN };
    let at = |sample: &Tracked| sample.values.get(index).copied().unwrap_or(f64::NAN);
    // Without the second look a NaN in a message not needed would spoil the number.
    if ratio == 0.0 { at(before) } else { at(before) + ratio * (at(after) - at(before)) }
}

fn pose_of(values: &[f64]) -> Option<Pose> {
    let &[x, y, z, qx, qy, qz, qw] = values else { return None };
    Pose::from_parts([x, y, z], [qx, qy, qz, qw])
}
