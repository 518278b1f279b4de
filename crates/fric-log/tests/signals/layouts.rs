//! Messages laid out otherwise: paths, other ROS types, JSON, protobuf.

use fric_log::signals::Role;
use prost_reflect::prost::Message as _;
use prost_reflect::prost_types::field_descriptor_proto::{Label, Type};
use prost_reflect::prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet};

use super::support::*;

const HEADER: &str = "===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n===\n\
    MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const PARTS: &str = "===\nMSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n===\n\
    MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n===\n\
    MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n===\n\
    MSG: geometry_msgs/PoseWithCovariance\nPose pose\nfloat64[4] covariance\n===\n\
    MSG: geometry_msgs/Transform\nVector3 translation\nQuaternion rotation\n===\n\
    MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n===\n\
    MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\nTransform transform\n";

const NUMBERS: [f64; 7] = [1.0, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8];

fn ros(name: &'static str, fields: &str) -> Kind {
    (name, "ros2msg", format!("{fields}{PARTS}{HEADER}").leak().as_bytes(), "cdr")
}

/// The pose of each row, and what was wrong, for messages logged 1 s after their stamps.
fn poses(kind: Kind, path: &str, message: impl Fn(i64) -> Vec<u8>) -> (Vec<bool>, [u64; 6]) {
    let mut log = Log::default();
    log.cables(every(MS, 10 * S, 20));
    for stamp in every(2 * MS, 10 * S, 10) {
        log.add("/pose", kind, stamp + S, message(stamp));
    }
    let joined = log.read(&[(Role::Cable, "/cables"), (Role::Pose, path)], &["a"]);
    for row in joined.rows.iter().filter(|row| row.pose.is_some()) {
        assert_near(row.pose.as_ref().unwrap(), &NUMBERS, path);
    }
    (joined.rows.iter().map(|row| row.pose.is_some()).collect(), joined.counts(Role::Pose))
}

fn all_but_the_last() -> (Vec<bool>, [u64; 6]) {
    ((0..20).map(|row| row < 19).collect(), [10, 0, 0, 0, 0, 0])
}

#[test]
fn odometry_and_transforms_are_poses() {
    let odometry = ros(
        "nav_msgs/msg/Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n",
    );
    let message = |stamp| Cdr::header(stamp).text("platform").f64s(&NUMBERS).f64s(&[0.0; 4]).bytes();
    for path in ["/pose", "/pose.pose", "/pose.pose.pose"] {
        assert_eq!(poses(odometry, path, message), all_but_the_last(), "{path}");
    }
    let fields = "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n";
    let transform = ros("demo/msg/TransformStamped", fields);
    let message = |stamp| Cdr::header(stamp).text("platform").f64s(&NUMBERS).bytes();
    assert_eq!(poses(transform, "/pose", message), all_but_the_last());
    assert_eq!(poses(transform, "/pose.transform", message), all_but_the_last());
}

#[test]
fn a_pose_without_a_stamp_has_its_log_time() {
    let kind = ros("demo/msg/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n");
    let (known, counts) = poses(kind, "/pose", |_| Cdr::default().f64s(&NUMBERS).bytes());
    assert!(!known.contains(&true) && counts[0] == 10);
}

#[test]
fn a_stamp_at_the_root_is_found() {
    let kind = ros("demo/Tracked", "builtin_interfaces/Time stamp\ngeometry_msgs/Pose pose\n");
    let message = |stamp| Cdr::default().stamp(stamp).f64s(&NUMBERS).bytes();
    for path in ["/pose", "/pose.pose"] {
        assert_eq!(poses(kind, path, message), all_but_the_last(), "{path}");
    }
}

#[test]
fn a_frame_among_transforms_is_picked_by_a_filter() {
    let kind = ros("tf2_msgs/msg/TFMessage", "geometry_msgs/TransformStamped[] transforms\n");
    let path = "/pose.transforms[:]{child_frame_id==\"platform\"}";
    let frames = |stamp: i64, frames: &[&str]| {
        let start = Cdr::default().u32(u32::try_from(frames.len()).unwrap());
        let frame = |cdr: Cdr, frame: &&str| {
            let x = if *frame == "platform" { NUMBERS } else { [9.0; 7] };
            cdr.stamp(stamp).text("base").text(frame).f64s(&x)
        };
        frames.iter().fold(start, frame).bytes()
    };
    assert_eq!(poses(kind, path, |stamp| frames(stamp, &["arm", "platform"])), all_but_the_last());
    // Messages about other frames only are nobody's fault, several of the same are.
    let (known, counts) =
        poses(kind, path, |stamp| frames(stamp, if stamp % (4 * MS) == 0 { &["arm"] } else { &["platform"] }));
    assert_eq!((known[2], known[6], counts), (true, true, [5, 0, 0, 0, 0, 0]));
    let (_, counts) = poses(kind, path, |stamp| frames(stamp, &["platform", "platform"]));
    assert_eq!(counts, [0, 0, 0, 0, 0, 10]);
}

#[test]
fn paths_lead_to_the_numbers_themselves() {
    let array = ("std_msgs/msg/Float64MultiArray", "ros2msg", &b"uint32 data_offset\nfloat64[] data"[..], "cdr");
    let mut log = Log::default();
    for stamp in every(MS, S, 10) {
        let all = Cdr::default().u32(0).array(&[7.0, 8.0, 9.0, 10.0]).bytes();
        log.add("/force", array, stamp, all);
        let numbers = [1.0, 2.0];
        log.add("/joints", JOINT_STATES, stamp, joints(stamp, &["b", "a"], &numbers, &[], &[3.0, 4.0]));
    }
    let read = |cable, length: Option<&'static str>, cables: &[&str]| {
        let paths: Vec<_> = [(Role::Cable, Some(cable)), (Role::Length, length)].into_iter().collect();
        let paths: Vec<_> = paths.into_iter().filter_map(|(role, path)| Some((role, path?))).collect();
        let joined = log.read(&paths, cables);
        let row = joined.rows.get(5).unwrap_or_else(|| panic!("{cable}: {:?}", joined.error)).clone();
        (row.force_n, row.length_m)
    };
    assert_eq!(read("/joints.effort[:]", None, &["a", "b"]), (vec![4.0, 3.0], vec![2.0, 1.0]));
    assert_eq!(read("/joints.effort", None, &["a", "b"]), (vec![4.0, 3.0], vec![2.0, 1.0]));
    assert_eq!(read("/joints.effort[1]", None, &["a"]), (vec![4.0], vec![2.0]));
    assert_eq!(read("/force.data[2]", Some("/joints"), &["a"]), (vec![9.0], vec![2.0]));
    assert_eq!(read("/force.data[1:2]", Some("/joints.position[:]"), &["a", "b"]), (vec![8.0, 9.0], vec![2.0, 1.0]));
    let joined = log.read(&[(Role::Cable, "/force.data[2]")], &["a"]);
    assert!(joined.sentence().contains("as `length` under `[log]`"), "{}", joined.sentence());
    let joined = log.read(&[(Role::Cable, "/force.data"), (Role::Length, "/joints")], &["a"]);
    assert!(joined.sentence().contains("it holds 4 numbers where 1 are expected"), "{}", joined.sentence());
}

#[test]
fn signals_of_one_topic_coincide_also_over_a_clock_step() {
    let mut log = Log::default();
    for (time, stamp) in every(MS, S, 200).zip(every(MS, 90 * S, 100).chain(every(MS, 5 * S, 100))) {
        log.add("/cables", JOINT_STATES, time, joints(stamp, &["a"], &[ms(stamp)], &[], &[ms(stamp)]));
    }
    let paths = [(Role::Cable, "/cables.effort[:]"), (Role::Length, "/cables.position[:]")];
    let joined = log.read(&paths, &["a"]);
    assert_eq!(joined.rows.len(), 200);
    assert!(joined.rows.iter().all(|row| row.force_n == [ms(row.stamp_nanos)] && row.length_m == row.force_n));
    assert_eq!((joined.counts(Role::Cable)[3], joined.counts(Role::Length)[3]), (1, 1));
}

#[test]
fn json_tells_its_fields_message_by_message() {
    let mut log = Log::default();
    let stamp = |stamp: i64| format!("{{\"sec\":{},\"nsec\":{}}}", stamp / S, stamp % S);
    log.add("/cables", JSON, 10 * S, b"{\"name\":[\"a\"".to_vec());
    log.add("/cables", JSON, 10 * S, b"{}".to_vec());
    for time in every(MS, 10 * S, 20) {
        let header = stamp(time);
        let text = format!(
            "{{\"header\":{{\"stamp\":{header}}},\"name\":[\"b\",\"a\"],\"position\":[1,2],\"velocity\":[],\
             \"effort\":[3,null],\"more\":{{}}}}"
        );
        log.add("/cables", JSON, time + S, text.into_bytes());
        let text = format!(
            "{{\"timestamp\":{header},\"force\":{{\"x\":1,\"y\":2,\"z\":3}},\"torque\":{{\"x\":4,\"y\":5,\"z\":6}}}}"
        );
        log.add("/wrench", JSON, time + S, text.into_bytes());
        let turn = "\"rotation\":{\"x\":0,\"y\":0.6,\"z\":0,\"w\":0.8}";
        for frame in ["arm", "platform"] {
            let text = format!(
                "{{\"transforms\":[{{\"timestamp\":{header},\"child\":\"{frame}\",\"translation\":{{\"x\":1,\"y\":2,\"z\":3}},{turn}}}]}}"
            );
            log.add("/tf", JSON, time + S, text.into_bytes());
        }
    }
    let paths =
        [(Role::Cable, "/cables"), (Role::Wrench, "/wrench"), (Role::Pose, "/tf.transforms[:]{child==\"platform\"}")];
    let joined = log.read(&paths, &["a", "b"]);
    assert_eq!(joined.counts(Role::Cable), [20, 0, 0, 0, 0, 2]);
    assert_eq!((joined.counts(Role::Pose), joined.counts(Role::Wrench)), ([20, 0, 0, 0, 0, 0], [20, 0, 0, 0, 0, 0]));
    assert_eq!(joined.stamps(), every(MS, 10 * S, 20).collect::<Vec<_>>());
    for row in &joined.rows {
        assert_near(&row.force_n, &[f64::NAN, 3.0], "forces");
        assert_near(&row.length_m, &[2.0, 1.0], "lengths");
        assert_near(&row.speed_m_per_s, &[0.0, 0.0], "speeds");
        assert_near(row.pose.as_ref().unwrap(), &NUMBERS, "pose");
        assert_near(row.wrench.as_ref().unwrap(), &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "wrench");
    }
}

#[test]
fn json_without_a_header_has_its_log_time() {
    let mut log = Log::default();
    for time in every(MS, S, 5) {
        log.add("/cables", JSON, time, b"{\"name\":[\"a\"],\"position\":[1],\"effort\":[3]}".to_vec());
    }
    assert_eq!(log.read_a().stamps(), every(MS, S, 5).collect::<Vec<_>>());
}

fn message(name: &str, fields: &[(&str, &str)]) -> DescriptorProto {
    let field = |(index, (name, of)): (usize, &(&str, &str))| FieldDescriptorProto {
        name: Some((*name).to_owned()),
        number: Some(i32::try_from(index).unwrap() + 1),
        label: Some(Label::Optional.into()),
        r#type: Some(match *of {
            "double" => Type::Double.into(),
            "string" => Type::String.into(),
            "int64" => Type::Int64.into(),
            "int32" => Type::Int32.into(),
            _ => Type::Message.into(),
        }),
        type_name: of.starts_with('.').then(|| (*of).to_owned()),
        ..FieldDescriptorProto::default()
    };
    let field = fields.iter().enumerate().map(field).collect();
    DescriptorProto { name: Some(name.to_owned()), field, ..DescriptorProto::default() }
}

fn foxglove() -> Kind {
    let file = |name: &str, package: &str, dependency: &[&str], message_type| FileDescriptorProto {
        name: Some(name.to_owned()),
        package: Some(package.to_owned()),
        dependency: dependency.iter().map(|&name| name.to_owned()).collect(),
        message_type,
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    let time = vec![message("Timestamp", &[("seconds", "int64"), ("nanos", "int32")])];
    let xyz = [("x", "double"), ("y", "double"), ("z", "double"), ("w", "double")];
    let pose = [("timestamp", ".google.protobuf.Timestamp"), ("frame_id", "string"), ("pose", ".foxglove.Pose")];
    let types = vec![
        message("PoseInFrame", &pose),
        message("Pose", &[("position", ".foxglove.Vector3"), ("orientation", ".foxglove.Quaternion")]),
        message("Vector3", &xyz[..3]),
        message("Quaternion", &xyz),
    ];
    let files =
        vec![file("time.proto", "google.protobuf", &[], time), file("pose.proto", "foxglove", &["time.proto"], types)];
    let schema = FileDescriptorSet { file: files }.encode_to_vec();
    ("foxglove.PoseInFrame", "protobuf", schema.leak(), "protobuf")
}

fn varint(mut value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value >= 0x80 {
        bytes.push(u8::try_from(value & 0x7f).unwrap() | 0x80);
        value >>= 7;
    }
    bytes.push(u8::try_from(value).unwrap());
    bytes
}

fn within(number: u8, content: &[u8]) -> Vec<u8> {
    [&[number << 3 | 2], varint(content.len() as u64).as_slice(), content].concat()
}

#[test]
fn a_foxglove_pose_has_its_timestamp() {
    let doubles = |values: &[f64]| -> Vec<u8> {
        let one = |(index, value): (usize, &f64)| {
            [&[u8::try_from(index + 1).unwrap() << 3 | 1], &value.to_le_bytes()[..]].concat()
        };
        values.iter().enumerate().flat_map(one).collect()
    };
    let message = |stamp: i64| {
        let parts =
            [(8, stamp / S), (16, stamp % S)].map(|(tag, value)| [vec![tag], varint(value.cast_unsigned())].concat());
        let pose = [within(1, &doubles(&NUMBERS[..3])), within(2, &doubles(&NUMBERS[3..]))].concat();
        [within(1, &parts.concat()), within(3, &pose)].concat()
    };
    assert_eq!(poses(foxglove(), "/pose", message), all_but_the_last());
    assert_eq!(poses(foxglove(), "/pose.pose", message), all_but_the_last());
}
