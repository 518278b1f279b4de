//! Logs made message by message, and the rows read from them.

use std::collections::BTreeMap;
use std::io::{Cursor, Write};

use fric_log::recording::Recording;
use fric_log::signals::{Role, SignalError, SignalPaths, SignalReader};
use mcap::WriteOptions;
use mcap::records::MessageHeader;
use tempfile::NamedTempFile;

/// Schema name, schema encoding, schema, message encoding.
pub type Kind = (&'static str, &'static str, &'static [u8], &'static str);

const JOINT_STATE: &str = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n\
    float64[] effort\n===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n===\n\
    MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const POSE: &str = "std_msgs/Header header\nPose pose\n===\nMSG: geometry_msgs/Pose\nPoint position\n\
    Quaternion orientation\n===\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n===\n\
    MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n===\n\
    MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n===\n\
    MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const WRENCH: &str = "std_msgs/Header header\nWrench wrench\n===\nMSG: geometry_msgs/Wrench\nVector3 force\n\
    Vector3 torque\n===\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n===\n\
    MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n===\n\
    MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

pub const JOINT_STATES: Kind = ("sensor_msgs/msg/JointState", "ros2msg", JOINT_STATE.as_bytes(), "cdr");
pub const POSES: Kind = ("geometry_msgs/msg/PoseStamped", "ros2msg", POSE.as_bytes(), "cdr");
pub const WRENCHES: Kind = ("geometry_msgs/msg/WrenchStamped", "ros2msg", WRENCH.as_bytes(), "cdr");
pub const JSON: Kind = ("", "", b"", "json");

pub const MS: i64 = 1_000_000;
pub const S: i64 = 1_000_000_000;

/// A CDR message under construction.
#[derive(Default)]
pub struct Cdr(Vec<u8>);

impl Cdr {
    pub fn header(stamp_nanos: i64) -> Self {
        Self::default().stamp(stamp_nanos).text("base")
    }

    fn align(&mut self, align: usize) {
        self.0.resize(self.0.len().next_multiple_of(align), 0);
    }

    pub fn stamp(self, stamp_nanos: i64) -> Self {
        let sec = i32::try_from(stamp_nanos.div_euclid(S)).unwrap();
        self.u32(sec.cast_unsigned()).u32(u32::try_from(stamp_nanos.rem_euclid(S)).unwrap())
    }

    pub fn u32(mut self, value: u32) -> Self {
        self.align(4);
        self.0.extend(value.to_le_bytes());
        self
    }

    pub fn text(self, text: &str) -> Self {
        let mut cdr = self.u32(u32::try_from(text.len() + 1).unwrap());
        cdr.0.extend(text.as_bytes());
        cdr.0.push(0);
        cdr
    }

    pub fn texts(self, texts: &[&str]) -> Self {
        let cdr = self.u32(u32::try_from(texts.len()).unwrap());
        texts.iter().fold(cdr, |cdr, text| cdr.text(text))
    }

    /// Numbers one after the other.
    pub fn f64s(mut self, values: &[f64]) -> Self {
        for value in values {
            self.align(8);
            self.0.extend(value.to_le_bytes());
        }
        self
    }

    /// An array with its length.
    pub fn array(self, values: &[f64]) -> Self {
        self.u32(u32::try_from(values.len()).unwrap()).f64s(values)
    }

    pub fn bytes(self) -> Vec<u8> {
        [&[0, 1, 0, 0], self.0.as_slice()].concat()
    }
}

pub fn joints(stamp: i64, names: &[&str], position: &[f64], velocity: &[f64], effort: &[f64]) -> Vec<u8> {
    Cdr::header(stamp).texts(names).array(position).array(velocity).array(effort).bytes()
}

/// A message of one cable `a`.
pub fn cable(stamp: i64, force_n: f64, length_m: f64) -> Vec<u8> {
    joints(stamp, &["a"], &[length_m], &[], &[force_n])
}

pub fn pose(stamp: i64, position_m: [f64; 3], quaternion: [f64; 4]) -> Vec<u8> {
    Cdr::header(stamp).f64s(&position_m).f64s(&quaternion).bytes()
}

pub fn wrench(stamp: i64, parts: [f64; 6]) -> Vec<u8> {
    Cdr::header(stamp).f64s(&parts).bytes()
}

/// Messages of several topics.
#[derive(Default)]
pub struct Log {
    messages: Vec<(i64, String, Kind, Vec<u8>)>,
}

impl Log {
    pub fn add(&mut self, topic: &str, kind: Kind, log_time: i64, data: Vec<u8>) {
        self.messages.push((log_time, topic.to_owned(), kind, data));
    }

    /// Cable messages of one cable at these times, logged when they are stamped: force and length are the time in ms.
    pub fn cables(&mut self, stamps: impl IntoIterator<Item = i64>) {
        for stamp in stamps {
            self.add("/cables", JOINT_STATES, stamp, cable(stamp, ms(stamp), ms(stamp)));
        }
    }

    /// Reference forces that are the time in ms.
    pub fn references(&mut self, stamps: impl IntoIterator<Item = i64>) {
        for stamp in stamps {
            self.add("/reference", JOINT_STATES, stamp, joints(stamp, &["a"], &[], &[], &[ms(stamp)]));
        }
    }

    /// Writes it in the order of log time, at equal times as added.
    pub fn file(&self) -> NamedTempFile {
        let mut messages: Vec<_> = self.messages.iter().collect();
        messages.sort_by_key(|message| message.0);
        let options = WriteOptions::new().chunk_size(Some(1 << 16));
        let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
        for (log_time, topic, (name, encoding, schema, message_encoding), data) in messages {
            let schema = if encoding.is_empty() { 0 } else { writer.add_schema(name, encoding, schema).unwrap() };
            let channel_id = writer.add_channel(schema, topic, message_encoding, &BTreeMap::new()).unwrap();
            let log_time = u64::try_from(*log_time).unwrap();
            let header = MessageHeader { channel_id, sequence: 0, log_time, publish_time: log_time };
            writer.write_to_known_channel(&header, data).unwrap();
        }
        writer.finish().unwrap();
        to_file(&writer.into_inner().into_inner())
    }

    pub fn read(&self, paths: &[(Role, &str)], cables: &[&str]) -> Joined {
        read(&self.file(), paths, cables)
    }

    /// Reads cable `a` from the topics that [`Log::cables`] and the like write.
    pub fn read_a(&self) -> Joined {
        self.read(&PATHS, &["a"])
    }
}

/// The topics of most tests.
pub const PATHS: [(Role, &str); 4] =
    [(Role::Cable, "/cables"), (Role::Reference, "/reference"), (Role::Pose, "/pose"), (Role::Wrench, "/wrench")];

pub fn to_file(bytes: &[u8]) -> NamedTempFile {
    let mut file = NamedTempFile::with_suffix(".mcap").unwrap();
    file.write_all(bytes).unwrap();
    file
}

/// A row that owns its numbers.
#[derive(Debug, Clone)]
pub struct Row {
    pub stamp_nanos: i64,
    pub force_n: Vec<f64>,
    pub length_m: Vec<f64>,
    pub speed_m_per_s: Vec<f64>,
    pub reference_n: Vec<f64>,
    /// Position, then the quaternion x, y, z, w.
    pub pose: Option<Vec<f64>>,
    pub wrench: Option<Vec<f64>>,
}

/// All rows, how they ended, and the reader.
pub struct Joined {
    pub rows: Vec<Row>,
    pub error: Option<SignalError>,
    pub reader: SignalReader,
    /// The most cable messages that were read but not given out.
    pub most_waiting: u64,
}

impl Joined {
    pub fn stamps(&self) -> Vec<i64> {
        self.rows.iter().map(|row| row.stamp_nanos).collect()
    }

    pub fn row(&self, stamp_nanos: i64) -> &Row {
        self.rows.iter().find(|row| row.stamp_nanos == stamp_nanos).unwrap()
    }

    /// Message, duplicate, late, clock step, gap, undecodable.
    pub fn counts(&self, role: Role) -> [u64; 6] {
        let it = self.reader.counts(role);
        let TrackCounts { message_count, duplicate_count, late_count, .. } = it;
        [message_count, duplicate_count, late_count, it.clock_step_count, it.gap_count, it.undecodable_count]
    }

    pub fn sentence(&self) -> String {
        fric_log::with_advice(self.error.as_ref().unwrap())
    }

    pub fn problem(&self, role: Role) -> &str {
        self.reader.first_problem(role).unwrap()
    }
}

use fric_log::signals::TrackCounts;

pub fn read(file: &NamedTempFile, paths: &[(Role, &str)], cables: &[&str]) -> Joined {
    let with = |all: SignalPaths, (role, path): &(Role, &str)| all.with(*role, Some(path.parse().unwrap()));
    let paths = paths.iter().fold(SignalPaths::default(), with);
    let mut reader = SignalReader::new(Recording::open(&[file.path()]).unwrap(), paths, cables);
    let (mut rows, mut error, mut most_waiting) = (Vec::new(), None, 0);
    loop {
        let row = match reader.next_row() {
            Ok(Some(row)) => row,
            Ok(None) => break,
            Err(found) => {
                error = Some(found);
                break;
            }
        };
        rows.push(Row {
            stamp_nanos: row.stamp_nanos,
            force_n: row.cables.iter().map(|cable| cable.sensor_force_n).collect(),
            length_m: row.cables.iter().map(|cable| cable.length_m).collect(),
            speed_m_per_s: row.cables.iter().map(|cable| cable.speed_m_per_s).collect(),
            reference_n: row.reference_force_n.to_vec(),
            pose: row.pose.map(|it| it.position_m.iter().chain(it.orientation.coords.iter()).copied().collect()),
            wrench: row.outside_wrench.map(|it| it.force_n.iter().chain(it.torque_nm.iter()).copied().collect()),
        });
        most_waiting = most_waiting.max(reader.counts(Role::Cable).message_count - rows.len() as u64);
    }
    Joined { rows, error, reader, most_waiting }
}

/// A time in milliseconds.
#[expect(clippy::cast_precision_loss, reason = "test times are short")]
pub fn ms(nanos: i64) -> f64 {
    nanos as f64 / 1e6
}

/// Times from `first` on, `count` of them.
pub fn every(interval: i64, first: i64, count: i64) -> impl Iterator<Item = i64> + Clone {
    (0..count).map(move |index| first + index * interval)
}

/// Equal, or both NaN.
#[track_caller]
pub fn assert_near(found: &[f64], expected: &[f64], what: &str) {
    let is_near = |(found, expected): (&f64, &f64)| {
        (found.is_nan() && expected.is_nan())
            || found.to_bits() == expected.to_bits()
            || (found - expected).abs() <= 1e-9 * expected.abs().max(1.0)
    };
    let is_same = found.len() == expected.len() && found.iter().zip(expected).all(is_near);
    assert!(is_same, "{what}: {found:?} instead of {expected:?}");
}
