//! The stream of rows.

use std::collections::BTreeSet;

use fric_core::Sample;

use super::channel::{ChannelReader, Rejection};
use super::error::SignalError;
use super::hanging::HangingRows;
use super::layout::Unfit;
use super::lengths::{LengthPoses, PosesFromLengths};
use super::part::{Part, Progress, Side};
use super::row::RowBuffer;
use super::speed::SpeedRows;
use super::track::Track;
use super::{Role, SignalPaths, TrackCounts, WAIT_NANOS, WAITING_LIMIT};
use crate::log::{Content, Log};
use crate::recording::Message;

/// Greatest number of topics that an error names.
const MOST_LISTED: usize = 50;

/// Reads the rows of a log.
///
/// ```no_run
/// use fric_log::log::Log;
/// use fric_log::signals::{Role, SignalPaths, SignalReader};
///
/// let paths = SignalPaths::default().with(Role::Cable, Some("/cable_states".parse()?));
/// let log = Log::open(&["run.mcap"])?;
/// let mut reader = SignalReader::new(log, paths, &["cable1"]);
/// while let Some(row) = reader.next_row()? {
///     println!("{} {} N", row.stamp_nanos, row.cables[0].sensor_force_n);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SignalReader {
    log: Log,
    topics: Topics,
    /// Roles by channel.
    channels: Vec<Option<ChannelRoles>>,
    tracks: Tracks,
    is_ended: bool,
    /// The first time of a table.
    table_start_nanos: Option<i64>,
    /// The latest log time so far.
    log_time_nanos: u64,
    buffer: RowBuffer,
    /// Rows that wait for their speeds.
    speeds: SpeedRows,
    /// Rows that wait for the acceleration of a hanging mass.
    hanging: Option<HangingRows>,
    /// Computes the poses, if they come from the lengths.
    length_poses: Option<PosesFromLengths>,
    /// The part to deliver.
    progress: Progress,
}

/// The tracks of all roles.
#[derive(Debug, Default)]
struct Tracks {
    cable: Track,
    /// Tracks of all roles except the cable signal, in order.
    others: [Track; 5],
}

impl Tracks {
    fn get(&self, role: Role) -> &Track {
        let index = (role as usize).checked_sub(1);
        index.and_then(|index| self.others.get(index)).unwrap_or(&self.cable)
    }

    fn get_mut(&mut self, role: Role) -> &mut Track {
        let index = (role as usize).checked_sub(1);
        index.and_then(|index| self.others.get_mut(index)).unwrap_or(&mut self.cable)
    }
}

/// The wanted topics, and their problems.
#[derive(Debug)]
struct Topics {
    paths: SignalPaths,
    cable_names: Vec<String>,
    /// By role: whether rows wait for it. They do not if it is not wanted, or its type lacks it.
    is_awaited: [bool; 6],
    has_cable_messages: bool,
    /// By role: whether any message has a stamp.
    is_stamped: [bool; 6],
    /// By role: the problem of the first unusable message.
    first_problem: [Option<String>; 6],
    /// By role: the content of the first message that does not concern the robot.
    first_foreign: [Option<String>; 6],
}

/// The readers of a channel.
#[derive(Debug, Default)]
struct ChannelRoles {
    readers: Vec<ChannelReader>,
    /// Roles whose fields were not found in the messages so far, but may be in others.
    open: Vec<Role>,
}

impl SignalReader {
    /// Creates a reader for a robot with cables of these names.
    #[must_use]
    pub fn new(log: impl Into<Log>, paths: SignalPaths, cable_names: &[impl AsRef<str>]) -> Self {
        let log = log.into();
        let paths = if log.column_names().is_some() { paths.of_table() } else { paths };
        let topics = Topics {
            is_awaited: Role::ALL.map(|role| paths.get(role).is_some()),
            cable_names: cable_names.iter().map(|name| name.as_ref().to_owned()).collect(),
            paths,
            has_cable_messages: false,
            is_stamped: [false; 6],
            first_problem: Default::default(),
            first_foreign: Default::default(),
        };
        let buffer = RowBuffer::new(topics.cable_names.len(), &topics.paths);
        let speeds = SpeedRows::new(topics.cable_names.len());
        let (channels, tracks) = (Vec::new(), Tracks::default());
        let length_poses = PosesFromLengths::of(&topics.paths);
        let hanging = HangingRows::of(&topics.paths);
        Self {
            log,
            topics,
            channels,
            tracks,
            is_ended: false,
            table_start_nanos: None,
            log_time_nanos: 0,
            buffer,
            speeds,
            hanging,
            length_poses,
            progress: Progress::default(),
        }
    }

    /// Restricts the rows to a part of the log.
    #[must_use]
    pub fn within(mut self, part: Part) -> Self {
        self.progress.part = part;
        self
    }

    /// Returns the log, for its damage and its progress.
    #[must_use]
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// Returns the location of a signal for people: its topic or path, or the columns of a table; `None` if it is not read.
    #[must_use]
    pub fn place(&self, role: Role) -> Option<String> {
        const SHOWN: usize = 3;
        let path = self.topics.paths.get(role)?;
        let Content::Csv(table) = &self.log.content else { return Some(path.to_string()) };
        let columns = table.columns_of(role);
        Some(match columns.get(..SHOWN) {
            Some(shown) if columns.len() > SHOWN => format!("{}, …", shown.join(", ")),
            _ if columns.is_empty() => default_columns(role).to_owned(),
            _ => columns.join(", "),
        })
    }

    /// Returns the locations of the signals.
    #[must_use]
    pub fn paths(&self) -> &SignalPaths {
        &self.topics.paths
    }

    /// Returns the counts of a role since the part began; stamps and interval cover everything read.
    #[must_use]
    pub fn counts(&self, role: Role) -> TrackCounts {
        self.tracks.get(role).counts().since(&self.progress.before[role as usize])
    }

    /// Returns the statistics of poses from the cable lengths since the part began; `None` if the pose is read from the log.
    #[must_use]
    pub fn length_poses(&self) -> Option<LengthPoses> {
        self.length_poses.as_ref().map(|poses| poses.summary)
    }

    /// Returns the problem of the first unusable message of a role. If none is usable because none concerns the robot, returns the content of the
    /// first one.
    #[must_use]
    pub fn first_problem(&self, role: Role) -> Option<&str> {
        let foreign = self.topics.first_foreign[role as usize].as_deref();
        let foreign = foreign.filter(|_| self.counts(role).message_count == 0);
        self.topics.first_problem[role as usize].as_deref().or(foreign)
    }

    /// Whether any message of a role has a stamp.
    pub(super) fn is_stamped(&self, role: Role) -> bool {
        self.topics.is_stamped[role as usize]
    }

    /// Returns the next row; `None` at the end of the log.
    ///
    /// # Errors
    /// Returns a [`SignalError`] if the recording cannot be read on, or has no usable cable signal.
    pub fn next_row(&mut self) -> Result<Option<Sample<'_>>, SignalError> {
        while !self.progress.is_over {
            let Some(stamp_nanos) = self.make_row()? else {
                self.progress.is_over = true;
                break;
            };
            match self.progress.side(stamp_nanos) {
                // Only taking a row makes room for the next, and poses need every row.
                Side::Before => drop(self.take_row(false)),
                Side::After => self.progress.is_over = true,
                Side::Within => {
                    if !std::mem::replace(&mut self.progress.has_begun, true) && self.progress.part.start_s.is_some() {
                        self.progress.before = Role::ALL.map(|role| *self.tracks.get(role).counts());
                    }
                    return Ok(self.take_row(true));
                }
            }
        }
        if self.progress.has_begun || self.progress.part == Part::default() {
            return Ok(None);
        }
        let Progress { part, last_s: row_s, .. } = self.progress;
        let is_followed = part.end_s.is_some_and(|end_s| row_s >= end_s);
        Err(SignalError::NothingInPart { part, row_s, is_followed })
    }

    /// Returns the prepared row, with the pose from its lengths if requested.
    fn take_row(&mut self, counts: bool) -> Option<Sample<'_>> {
        let row = match &mut self.hanging {
            Some(hanging) => hanging.pop(),
            None => Some(self.buffer.row.sample()),
        };
        match &mut self.length_poses {
            Some(poses) => row.map(|row| Sample { pose: poses.next_pose(row.cables, counts), ..row }),
            None => row,
        }
    }

    /// Prepares the next row, in the buffer or in front of the hanging ones. Returns its time, `None` at the end of the log.
    fn make_row(&mut self) -> Result<Option<i64>, SignalError> {
        let Some(mut hanging) = self.hanging.take() else {
            return Ok(self.next_with_speeds()?.then_some(self.buffer.row.stamp_nanos));
        };
        let mut outcome = Ok(());
        while outcome.is_ok() && !hanging.is_ready() {
            outcome = self
                .next_with_speeds()
                .map(|has_row| if has_row { hanging.push(self.buffer.row.clone()) } else { hanging.end() });
        }
        let hanging = self.hanging.insert(hanging);
        outcome.map(|()| hanging.next_stamp_nanos())
    }

    /// Puts the next row, with its speeds, into the buffer. Returns false at the end of the log.
    fn next_with_speeds(&mut self) -> Result<bool, SignalError> {
        if !self.buffer.derives_speed() {
            return self.join_row();
        }
        while !self.speeds.is_ready() {
            if !self.join_row()? {
                self.speeds.end();
            } else if self.speeds.passes(&self.buffer.row) {
                return Ok(true);
            } else {
                self.speeds.push(self.buffer.row.clone());
            }
        }
        let row = self.speeds.pop();
        let has_row = row.is_some();
        self.buffer.row = row.unwrap_or_default();
        Ok(has_row)
    }

    /// Joins the next row. Returns false at the end of the log.
    fn join_row(&mut self) -> Result<bool, SignalError> {
        while !self.is_ready() {
            if self.is_ended {
                return self.check_end().map(|()| false);
            }
            self.read_next()?;
        }
        let Tracks { cable, others } = &mut self.tracks;
        let Some(sample) = cable.pop() else { return Ok(false) };
        for track in &mut *others {
            track.advance(sample.stamp_nanos);
        }
        self.buffer.fill(&sample, others);
        let stamp_nanos = sample.stamp_nanos;
        cable.recycle(sample);
        if cable.is_stepped() && cable.samples().is_empty() {
            self.follow_cable_step(stamp_nanos);
        }
        Ok(true)
    }

    /// Whether the oldest cable sample is final.
    fn is_ready(&self) -> bool {
        let Tracks { cable, others } = &self.tracks;
        let Some(oldest) = cable.samples().front() else { return false };
        if self.is_ended || cable.is_stepped() {
            return true;
        }
        let awaited = self.topics.is_awaited.iter().skip(1);
        let mut tracks = others.iter().zip(awaited);
        // Messages of the same time may name the missing cables.
        let is_whole = oldest.missing_cables == 0 || cable.samples().len() > 1;
        is_whole && tracks.all(|(track, is_awaited)| !is_awaited || track.has_reached(oldest.stamp_nanos))
            || self.log_time_nanos.saturating_sub(oldest.log_time_nanos) >= WAIT_NANOS
            || cable.samples().len() >= WAITING_LIMIT
            || others.iter().any(|track| track.samples().len() >= WAITING_LIMIT)
    }

    /// Reads the next item of the log: a message, or a row of a table.
    fn read_next(&mut self) -> Result<(), SignalError> {
        if matches!(self.log.content, Content::Csv(_)) { self.read_table_row() } else { self.read_message() }
    }

    fn end(&mut self) {
        self.is_ended = true;
        self.tracks.cable.finish();
        self.tracks.others.iter_mut().for_each(Track::finish);
    }

    fn read_table_row(&mut self) -> Result<(), SignalError> {
        let Content::Csv(table) = &mut self.log.content else { return Ok(()) };
        let Some(row) = table.next_row(&self.topics.cable_names, &self.topics.paths)? else {
            self.end();
            return Ok(());
        };
        let stamp_nanos = row.stamp_nanos;
        // A table has no log time of its own; only the waiting time of a row matters.
        let start_nanos = *self.table_start_nanos.get_or_insert(stamp_nanos);
        let log_time_nanos = u64::try_from(stamp_nanos.saturating_sub(start_nanos)).unwrap_or(0);
        self.log_time_nanos = self.log_time_nanos.max(log_time_nanos);
        for role in Role::ALL {
            if let Some(values) = row.values(role) {
                self.topics.is_stamped[role as usize] = true;
                let track = self.tracks.get_mut(role);
                track.push(stamp_nanos, self.log_time_nanos, 0, |out| out.extend_from_slice(values));
            }
        }
        if !self.topics.has_cable_messages {
            self.topics.has_cable_messages = true;
            for role in [Role::Reference, Role::Pose, Role::Wrench] {
                self.topics.is_awaited[role as usize] = !table.columns_of(role).is_empty();
            }
        }
        Ok(())
    }

    fn read_message(&mut self) -> Result<(), SignalError> {
        let Some(message) = self.log.next_message()? else {
            self.end();
            return Ok(());
        };
        self.log_time_nanos = self.log_time_nanos.max(message.log_time_nanos);
        let id = message.channel.id;
        if self.channels.len() <= id {
            self.channels.resize_with(id + 1, || None);
        }
        let Some(entry) = self.channels.get_mut(id) else { return Ok(()) };
        let roles = entry.get_or_insert_with(|| self.topics.roles_of(&message.channel.topic));
        if !roles.open.is_empty() {
            self.topics.open(roles, &message, &mut self.tracks)?;
        }
        for reader in &mut roles.readers {
            let role = reader.role;
            let track = self.tracks.get_mut(role);
            match reader.read(&message, &self.topics.cable_names) {
                Ok(decoded) => {
                    self.topics.is_stamped[role as usize] |= decoded.is_stamped;
                    let missing_cables = decoded.missing_cables();
                    track.push(decoded.stamp_nanos, message.log_time_nanos, missing_cables, |values| {
                        decoded.fill(values);
                    });
                }
                Err(Rejection::Unusable(reason)) => {
                    track.count_undecodable();
                    self.topics.first_problem[role as usize].get_or_insert(reason);
                }
                Err(Rejection::Foreign) => {
                    let foreign = &mut self.topics.first_foreign[role as usize];
                    foreign.get_or_insert_with(|| reader.describe_foreign(&self.topics.cable_names));
                }
            }
        }
        Ok(())
    }

    /// Switches to the new time when the rows before a clock step are done.
    fn follow_cable_step(&mut self, old_nanos: i64) {
        let Tracks { cable, others } = &mut self.tracks;
        cable.follow_step();
        let Some(new_nanos) = cable.samples().back().map(|sample| sample.stamp_nanos) else { return };
        for track in others.iter_mut().filter(|track| !track.is_stepped()) {
            // Topics that have not noticed the step yet would hide later messages.
            let newest = track.samples().back().map(|sample| sample.stamp_nanos);
            if newest.is_some_and(|newest| newest.abs_diff(old_nanos) < newest.abs_diff(new_nanos)) {
                track.expect_step();
            }
        }
    }

    fn check_end(&self) -> Result<(), SignalError> {
        if let Content::Csv(table) = &self.log.content {
            let has_cables = self.tracks.cable.counts().message_count > 0;
            return if has_cables { Ok(()) } else { Err(table.without_numbers().into()) };
        }
        let topic = self.topics.paths.get(Role::Cable).map_or_else(String::new, |path| path.topic.clone());
        if !self.topics.has_cable_messages {
            let channels = self.log.channels().iter();
            let topics: BTreeSet<_> = channels.map(|channel| &channel.topic).filter(|it| **it != topic).collect();
            let other_count = topics.len().saturating_sub(MOST_LISTED);
            let topics: Vec<_> = topics.into_iter().take(MOST_LISTED).cloned().collect();
            let beheaded = self.log.beheaded();
            if let Some(path) = beheaded.filter(|_| topics.is_empty() || self.log.lost_messages() > 0) {
                return Err(SignalError::NoBeginning { topic, path: path.to_owned() });
            }
            return Err(SignalError::NoCableTopic { topic, topics, other_count });
        }
        if self.tracks.cable.counts().message_count == 0 {
            let reason = self.first_problem(Role::Cable).unwrap_or("it is empty").to_owned();
            return Err(SignalError::NoUsableMessage { topic, reason });
        }
        Ok(())
    }
}

/// Returns the default column names of a signal.
fn default_columns(role: Role) -> &'static str {
    match role {
        Role::Cable | Role::Length | Role::Speed => "NAME.force_n, NAME.length_m",
        Role::Reference => "NAME.reference_n",
        Role::Pose => "pose.x_m … pose.qw",
        Role::Wrench => "wrench.fx_n … wrench.tz_nm",
    }
}

impl Topics {
    /// Returns the roles of a topic.
    fn roles_of(&self, topic: &str) -> ChannelRoles {
        let roles = Role::ALL.into_iter();
        let open = roles.filter(|role| self.paths.get(*role).is_some_and(|path| path.topic == topic)).collect();
        ChannelRoles { readers: Vec::new(), open }
    }

    /// Tries to find the fields of a channel's open roles with the help of a message.
    #[cold]
    fn open(
        &mut self,
        roles: &mut ChannelRoles,
        message: &Message<'_>,
        tracks: &mut Tracks,
    ) -> Result<(), SignalError> {
        for role in std::mem::take(&mut roles.open) {
            let Some(path) = self.paths.get(role) else { continue };
            self.has_cable_messages |= role == Role::Cable;
            let problem = &mut self.first_problem[role as usize];
            match ChannelReader::new(role, &path.field, &self.paths, message.channel, message.data) {
                Ok(reader) => {
                    self.is_awaited[role as usize] = true;
                    roles.readers.push(reader);
                }
                Err(Unfit::Nothing) => {
                    let reason = "it holds nothing of what the path selects";
                    self.first_foreign[role as usize].get_or_insert_with(|| reason.to_owned());
                    roles.open.push(role);
                }
                Err(Unfit::Message(reason)) => {
                    tracks.get_mut(role).count_undecodable();
                    problem.get_or_insert(reason);
                    roles.open.push(role);
                }
                Err(Unfit::NoLength) => return Err(SignalError::NoLength { topic: path.topic.clone() }),
                Err(Unfit::Type(source)) if role == Role::Cable && tracks.cable.counts().message_count == 0 => {
                    return Err(SignalError::CableFields { topic: path.topic.clone(), source });
                }
                Err(Unfit::Type(source)) => {
                    problem.get_or_insert_with(|| source.to_string());
                    self.is_awaited[role as usize] = tracks.get_mut(role).counts().message_count > 0;
                }
            }
        }
        Ok(())
    }
}
