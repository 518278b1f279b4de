//! Logs written and read back with the `mcap` crate and the crate's own decoders.

use std::fs;
use std::path::{Path, PathBuf};

use fric_core::{Pose, Wrench};
use fric_log::output::OutputError;
use fric_log::robot::ROBOT_FILE;
use fric_log::schema::{MessageType, Wanted};
use fric_log::write::{JointState, LogWriter, WriteError};
use mcap::MessageStream;
use mcap::sans_io::SummaryReader;
use tempfile::TempDir;

const BITS: [(&str, u32); 2] = [("slack", 1), ("SENSOR_FROZEN", 4)];
const NONE: [&str; 0] = [];

fn wanted(kind: fn(fric_log::path::FieldPath) -> Wanted, path: &str) -> Wanted {
    kind(path.parse().unwrap())
}

fn write(path: &Path, messages: u32) {
    let mut writer = LogWriter::create(path, &NONE, false).unwrap();
    writer.attach_robot_file("format = \"fric-robot/1\"\n").unwrap();
    let names = ["cable1", "cable 2", "ü"];
    let forces = writer.add_joint_state("/fric/cable_forces", "base", &names).unwrap();
    let friction = writer.add_joint_state("/fric/friction", "", &names[..1]).unwrap();
    let poses = writer.add_pose("/platform_pose", "world").unwrap();
    let wrenches = writer.add_wrench("/fric/wrench", "base").unwrap();
    let status = writer.add_cable_status("/fric/status", "base", &names, &BITS).unwrap();
    for index in 0..messages {
        let stamp_nanos = 1_700_000_000_000_000_000 + u64::from(index) * 1_000_001;
        let x = f64::from(index) / 3.0;
        let state = JointState { position: &[], velocity: &[x, f64::NAN, -0.0], effort: &[1.0, x, f64::INFINITY] };
        writer.write_joint_state(&forces, stamp_nanos, state).unwrap();
        let state = JointState { effort: &[x], ..JointState::default() };
        writer.write_joint_state(&friction, stamp_nanos, state).unwrap();
        let pose = Pose::from_parts([x, 2.0, 3.0], [0.0, 0.0, 0.6, 0.8]).unwrap();
        writer.write_pose(&poses, stamp_nanos, &pose).unwrap();
        let wrench = Wrench { force_n: [x, 5.0, 6.0].into(), torque_nm: [7.0, 8.0, -x].into() };
        writer.write_wrench(&wrenches, stamp_nanos, &wrench).unwrap();
        writer.write_cable_status(&status, stamp_nanos, &[0, 5, index]).unwrap();
    }
    writer.finish().unwrap();
}

fn in_directory() -> (TempDir, PathBuf) {
    let directory = TempDir::new().unwrap();
    let path = directory.path().join("out.mcap");
    (directory, path)
}

fn files(directory: &TempDir) -> Vec<String> {
    let entries = fs::read_dir(directory.path()).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Log time, numbers, texts and times of a message.
type Row = (u64, Vec<f64>, Vec<String>, Vec<i64>);

/// The numbers, texts and times of a topic's messages, in the order of the paths.
fn read(bytes: &[u8], topic: &str, paths: &[Wanted]) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut decoder = None;
    for message in MessageStream::new(bytes).unwrap() {
        let message = message.unwrap();
        if message.channel.topic != topic {
            continue;
        }
        let decoder = decoder.get_or_insert_with(|| {
            let schema = message.channel.schema.as_ref().unwrap();
            let encoding = &message.channel.message_encoding;
            let message_type = MessageType::new(encoding, &schema.name, &schema.encoding, &schema.data).unwrap();
            message_type.decoder(paths).unwrap()
        });
        assert_eq!(message.log_time, message.publish_time);
        let values = decoder.read(&message.data).unwrap();
        let all = 0..paths.len();
        rows.push((
            message.log_time,
            all.clone().flat_map(|index| values.numbers(index).to_vec()).collect(),
            all.clone().flat_map(|index| values.texts(index).iter().map(str::to_owned)).collect(),
            all.flat_map(|index| values.times_nanos(index).to_vec()).collect(),
        ));
    }
    rows
}

#[test]
fn what_is_written_is_read() {
    let (_directory, path) = in_directory();
    write(&path, 40);
    let bytes = fs::read(&path).unwrap();
    let stamp = wanted(Wanted::times, "header.stamp");
    let frame = wanted(Wanted::texts, "header.frame_id");
    let name = wanted(Wanted::texts, "name");
    let row = 7;
    let (time, x) = (1_700_000_000_007_000_007u64, 7.0 / 3.0);
    let stamps = vec![i64::try_from(time).unwrap()];

    let paths = ["position", "velocity", "effort"].map(|path| wanted(Wanted::numbers, path));
    let paths = [&[stamp.clone(), frame.clone(), name.clone()], &paths[..]].concat();
    let rows = read(&bytes, "/fric/cable_forces", &paths);
    assert_eq!(rows.len(), 40);
    let (log_time, numbers, texts, times) = &rows[row];
    assert_eq!((*log_time, texts.join("|"), times), (time, "base|cable1|cable 2|ü".to_owned(), &stamps));
    let bits: Vec<u64> = numbers.iter().map(|number| number.to_bits()).collect();
    assert_eq!(bits, [x, f64::NAN, -0.0, 1.0, x, f64::INFINITY].map(f64::to_bits));

    let rows = read(&bytes, "/fric/friction", &paths);
    assert_eq!(rows[row], (time, vec![x], vec![String::new(), "cable1".to_owned()], stamps.clone()));

    let paths = ["position.x", "position.y", "position.z"].map(|path| format!("pose.{path}"));
    let turns = ["x", "y", "z", "w"].map(|path| format!("pose.orientation.{path}"));
    let paths: Vec<_> = paths.iter().chain(&turns).map(|path| wanted(Wanted::numbers, path)).collect();
    let rows = read(&bytes, "/platform_pose", &paths);
    assert_eq!(rows[row].1, [x, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8]);

    let paths = ["force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"];
    let paths = paths.map(|path| wanted(Wanted::numbers, &format!("wrench.{path}")));
    assert_eq!(read(&bytes, "/fric/wrench", &paths)[row].1, [x, 5.0, 6.0, 7.0, 8.0, -x]);

    let paths = [stamp, name, wanted(Wanted::numbers, "flags")];
    let texts = ["cable1", "cable 2", "ü"].map(str::to_owned).to_vec();
    assert_eq!(read(&bytes, "/fric/status", &paths)[row], (time, vec![0.0, 5.0, 7.0], texts, stamps));
}

#[test]
fn the_file_is_indexed_and_says_where_it_is_from() {
    let (_directory, path) = in_directory();
    // More than one chunk.
    write(&path, 5_000);
    let bytes = fs::read(&path).unwrap();
    let mut reader = SummaryReader::new();
    let mut position = 0usize;
    while let Some(event) = reader.next_event() {
        match event.unwrap() {
            mcap::sans_io::SummaryReadEvent::ReadRequest(count) => {
                let end = bytes.len().min(position + count);
                reader.insert(count)[..end - position].copy_from_slice(&bytes[position..end]);
                reader.notify_read(end - position);
                position = end;
            }
            mcap::sans_io::SummaryReadEvent::SeekRequest(to) => {
                let start = bytes.len();
                position = match to {
                    std::io::SeekFrom::Start(offset) => usize::try_from(offset).unwrap(),
                    std::io::SeekFrom::End(offset) => start.checked_add_signed(offset.try_into().unwrap()).unwrap(),
                    std::io::SeekFrom::Current(offset) => {
                        position.checked_add_signed(offset.try_into().unwrap()).unwrap()
                    }
                };
                reader.notify_seeked(u64::try_from(position).unwrap());
            }
        }
    }
    let summary = reader.finish().unwrap();
    let statistics = summary.stats.unwrap();
    assert_eq!((statistics.message_count, statistics.channel_count, statistics.schema_count), (25_000, 5, 4));
    assert!(summary.chunk_indexes.len() > 1);
    assert!(summary.chunk_indexes.iter().all(|index| index.compression == "zstd"));
    let [attachment] = &summary.attachment_indexes[..] else { panic!("one attachment") };
    assert_eq!(attachment.name, ROBOT_FILE);
    let status = summary.channels.values().find(|channel| channel.topic == "/fric/status").unwrap();
    let schema = status.schema.as_ref().unwrap();
    let text = String::from_utf8(schema.data.to_vec()).unwrap();
    assert_eq!(schema.name, "fric_msgs/msg/CableStatus");
    assert!(text.contains("uint32 SLACK=1\nuint32 SENSOR_FROZEN=4\nstd_msgs/Header header\n"), "{text}");
    let header = String::from_utf8_lossy(&bytes[..80]);
    assert!(header.contains("ros2") && header.contains(concat!("fric ", env!("CARGO_PKG_VERSION"))), "{header}");
}

#[test]
fn the_same_calls_give_the_same_bytes() {
    let (_first_directory, first) = in_directory();
    let (_second_directory, second) = in_directory();
    write(&first, 6_000);
    write(&second, 6_000);
    assert!(fs::read(first).unwrap() == fs::read(second).unwrap());
}

#[test]
fn nothing_is_left_of_an_unfinished_log() {
    let (directory, path) = in_directory();
    let mut writer = LogWriter::create(&path, &NONE, false).unwrap();
    let poses = writer.add_pose("/p", "").unwrap();
    writer.write_pose(&poses, 1, &Pose::identity()).unwrap();
    assert_eq!(files(&directory).len(), 1);
    assert!(!path.exists());
    drop(writer);
    assert!(files(&directory).is_empty());
    LogWriter::create(&path, &NONE, false).unwrap().finish().unwrap();
    assert_eq!(files(&directory), ["out.mcap"]);
}

#[test]
fn existing_files_are_replaced_only_by_force() {
    let (directory, path) = in_directory();
    fs::write(&path, "mine").unwrap();
    let Err(error) = LogWriter::create(&path, &NONE, false) else { panic!("created") };
    assert!(matches!(error, WriteError::Output(OutputError::Exists { .. })), "{error}");
    assert!(error.to_string().ends_with("exists; choose another name, or force it to be replaced"), "{error}");

    let writer = LogWriter::create(&path, &NONE, true).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"mine");
    drop(writer);
    assert_eq!(fs::read(&path).unwrap(), b"mine");
    LogWriter::create(&path, &NONE, true).unwrap().finish().unwrap();
    assert!(fs::read(&path).unwrap().starts_with(mcap::MAGIC));

    // A file that appears while the log is written stays as well.
    let late = directory.path().join("late.mcap");
    let writer = LogWriter::create(&late, &NONE, false).unwrap();
    fs::write(&late, "other").unwrap();
    assert!(matches!(writer.finish(), Err(WriteError::Output(OutputError::Exists { .. }))));
    assert_eq!(fs::read(&late).unwrap(), b"other");
    assert_eq!(files(&directory), ["late.mcap", "out.mcap"]);
}

#[test]
fn inputs_are_never_replaced() {
    let (directory, path) = in_directory();
    let input = directory.path().join("in.mcap");
    fs::write(&input, "data").unwrap();
    let mut others = vec![directory.path().join(".").join("in.mcap")];
    #[cfg(unix)]
    {
        let linked = directory.path().join("soft.mcap");
        std::os::unix::fs::symlink(&input, &linked).unwrap();
        others.push(linked);
        let linked = directory.path().join("hard.mcap");
        fs::hard_link(&input, &linked).unwrap();
        others.push(linked);
    }
    for target in others {
        let inputs = [directory.path().join("missing.mcap"), input.clone()];
        let Err(error) = LogWriter::create(&target, &inputs, true) else { panic!("created") };
        assert!(matches!(error, WriteError::Output(OutputError::Input { .. })), "{error}");
    }
    LogWriter::create(&path, &[input], true).unwrap().finish().unwrap();
}

#[test]
fn impossible_places_and_messages_are_refused() {
    let (directory, path) = in_directory();
    for place in [directory.path().to_owned(), directory.path().join("no/such/place.mcap")] {
        let Err(error) = LogWriter::create(&place, &NONE, true) else { panic!("created") };
        assert!(matches!(error, WriteError::Output(OutputError::File { .. })), "{error}");
    }

    let mut writer = LogWriter::create(&path, &NONE, false).unwrap();
    let joints = writer.add_joint_state("/a", "", &["x", "y"]).unwrap();
    let error = writer.add_pose("/a", "").unwrap_err();
    assert!(matches!(error, WriteError::Topic { .. }), "{error}");
    for name in ["", "1st", "a-b", "ä"] {
        let error = writer.add_cable_status("/s", "", &["x"], &[(name, 1)]).unwrap_err();
        assert!(matches!(error, WriteError::FlagName { .. }), "{error}");
    }
    let status = writer.add_cable_status("/s", "", &["x"], &[]).unwrap();
    let state = JointState { effort: &[1.0], ..JointState::default() };
    let error = writer.write_joint_state(&joints, 0, state).unwrap_err();
    assert_eq!(error.to_string(), "topic `/a`: 1 elements of `effort` for 2 names");
    let error = writer.write_cable_status(&status, 0, &[]).unwrap_err();
    assert_eq!(error.to_string(), "topic `/s`: 0 elements of `flags` for 1 names");
    let last = (u64::from(i32::MAX.unsigned_abs()) + 1) * 1_000_000_000;
    assert!(writer.write_cable_status(&status, last - 1, &[0]).is_ok());
    let error = writer.write_cable_status(&status, last, &[0]).unwrap_err();
    assert!(error.to_string().contains("2038"), "{error}");
    writer.finish().unwrap();
    assert_eq!(read(&fs::read(path).unwrap(), "/s", &[wanted(Wanted::numbers, "flags")]).len(), 1);
}

#[cfg(unix)]
#[test]
fn the_file_is_as_public_as_any_other() {
    use std::os::unix::fs::PermissionsExt;
    let (directory, path) = in_directory();
    let other = directory.path().join("other");
    fs::write(&other, "").unwrap();
    LogWriter::create(&path, &NONE, false).unwrap().finish().unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&path), mode(&other));
}

#[test]
fn messages_and_channels_keep_their_order_however_many_there_are() {
    let (_directory, path) = in_directory();
    let mut writer = LogWriter::create(&path, &NONE, false).unwrap();
    let fields: Vec<String> = (0..32).map(|index| format!("x{index}")).collect();
    let mut written = Vec::new();
    // Each round is more than what waits for the thread at most.
    for topic in ["/a", "/b", "/c"] {
        let channel = writer.add_numbers(topic, "fric_msgs/msg/Test", &fields).unwrap();
        for _ in 0..4096 {
            let stamp_nanos = written.len() as u64;
            writer.write_numbers(&channel, stamp_nanos, &[0.5; 32]).unwrap();
            written.push((topic.to_owned(), stamp_nanos));
        }
        writer.attach_robot_file(topic).unwrap();
    }
    writer.finish().unwrap();
    let bytes = fs::read(&path).unwrap();
    let messages = MessageStream::new(&bytes).unwrap().map(Result::unwrap);
    let read: Vec<_> = messages.map(|message| (message.channel.topic.clone(), message.log_time)).collect();
    assert!(read == written);
}

#[test]
fn of_a_log_that_is_given_up_nothing_is_left() {
    let (directory, path) = in_directory();
    let mut writer = LogWriter::create(&path, &NONE, false).unwrap();
    let wrenches = writer.add_wrench("/fric/wrench", "base").unwrap();
    for stamp_nanos in 0..10_000 {
        writer.write_wrench(&wrenches, stamp_nanos, &Wrench::default()).unwrap();
    }
    drop(writer);
    assert_eq!(files(&directory), [""; 0]);
}
