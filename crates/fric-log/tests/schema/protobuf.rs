//! Protobuf messages.

use fric_log::schema::{FieldKind, MessageType};
use proptest::prelude::*;
use prost_reflect::prost::Message as _;
use prost_reflect::prost_types::field_descriptor_proto::{Label, Type};
use prost_reflect::prost_types::{
    DescriptorProto, EnumDescriptorProto, EnumValueDescriptorProto, FieldDescriptorProto, FileDescriptorProto,
    FileDescriptorSet,
};

use super::{list, numbers, texts, times};

fn field(name: &str, number: i32, kind: Type, type_name: &str, repeated: bool) -> FieldDescriptorProto {
    let label = if repeated { Label::Repeated } else { Label::Optional };
    FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        label: Some(label.into()),
        r#type: Some(kind.into()),
        type_name: (!type_name.is_empty()).then(|| type_name.to_owned()),
        ..FieldDescriptorProto::default()
    }
}

fn message(name: &str, field: Vec<FieldDescriptorProto>) -> DescriptorProto {
    DescriptorProto { name: Some(name.to_owned()), field, ..DescriptorProto::default() }
}

fn descriptor_set() -> Vec<u8> {
    let timestamp = FileDescriptorProto {
        name: Some("google/protobuf/timestamp.proto".to_owned()),
        package: Some("google.protobuf".to_owned()),
        message_type: vec![message(
            "Timestamp",
            vec![field("seconds", 1, Type::Int64, "", false), field("nanos", 2, Type::Int32, "", false)],
        )],
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    let value = |name: &str, number| EnumValueDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        ..EnumValueDescriptorProto::default()
    };
    let demo = FileDescriptorProto {
        name: Some("demo.proto".to_owned()),
        package: Some("demo".to_owned()),
        dependency: vec!["google/protobuf/timestamp.proto".to_owned()],
        message_type: vec![
            message(
                "Cable",
                vec![field("name", 1, Type::String, "", false), field("force", 2, Type::Float, "", false)],
            ),
            message(
                "State",
                vec![
                    field("stamp", 1, Type::Message, ".google.protobuf.Timestamp", false),
                    field("cables", 2, Type::Message, ".demo.Cable", true),
                    field("forces", 3, Type::Double, "", true),
                    field("mode", 4, Type::Enum, ".demo.Mode", false),
                    field("blob", 5, Type::Bytes, "", false),
                    field("first", 6, Type::Message, ".demo.Cable", false),
                    field("count", 7, Type::Sint64, "", false),
                    field("on", 8, Type::Bool, "", false),
                ],
            ),
        ],
        enum_type: vec![EnumDescriptorProto {
            name: Some("Mode".to_owned()),
            value: vec![value("IDLE", 0), value("RUN", 2)],
            ..EnumDescriptorProto::default()
        }],
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    };
    // The order of the files must not matter.
    FileDescriptorSet { file: vec![demo, timestamp] }.encode_to_vec()
}

fn state() -> MessageType {
    MessageType::new("protobuf", "demo.State", "protobuf", &descriptor_set()).unwrap()
}

/// Bytes by the rules of the wire format: stamp 5 s 7 ns, cables a (1.5 N) and b (0 N, not sent), packed
/// forces 1 and 2, one more unpacked, mode 2, count −3, an unknown field, on.
#[rustfmt::skip]
fn sent() -> Vec<u8> {
    let mut bytes = vec![0x0a, 4, 0x08, 5, 0x10, 7];
    bytes.extend([0x12, 8, 0x0a, 1, b'a', 0x15, 0, 0, 0xc0, 0x3f]);
    bytes.extend([0x12, 3, 0x0a, 1, b'b']);
    bytes.extend([0x1a, 16, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0x40]);
    bytes.extend([0x19, 0, 0, 0, 0, 0, 0, 0xf8, 0x7f]);
    bytes.extend([0x20, 2, 0x38, 5, 0x78, 1, 0x40, 1]);
    bytes
}

#[test]
fn reads_what_was_sent() {
    let mut decoder = state()
        .decoder(&[
            times("stamp"),
            texts("cables[:].name"),
            numbers("cables[:].force"),
            numbers("forces"),
            numbers("mode"),
            numbers("count"),
            numbers("on"),
            numbers("cables[:]{name==\"a\"}.force"),
            numbers("{mode==2}.forces[1]"),
            numbers("stamp.nanos"),
        ])
        .unwrap();
    let values = decoder.read(&sent()).unwrap();
    assert_eq!(values.time_nanos(0), Some(5_000_000_007));
    assert_eq!(list(values, 1), ["a", "b"]);
    assert_eq!(values.numbers(2), [1.5, 0.0]);
    assert_eq!(values.numbers(3)[..2], [1.0, 2.0]);
    assert!(values.numbers(3)[2].is_nan());
    let single: Vec<_> = (4..10).map(|index| values.number(index).unwrap()).collect();
    assert_eq!(single, [2.0, -3.0, 1.0, 1.5, 2.0, 7.0]);
}

#[test]
fn what_was_not_sent_has_its_default() {
    let wanted = [times("stamp"), texts("first.name"), numbers("first.force"), numbers("forces"), numbers("mode")];
    let mut decoder = state().decoder(&wanted).unwrap();
    let values = decoder.read(&[]).unwrap();
    assert_eq!(values.time_nanos(0), Some(0));
    assert_eq!(list(values, 1), [""]);
    assert_eq!(values.numbers(2), [0.0]);
    assert!(values.numbers(3).is_empty());
    assert_eq!(values.numbers(4), [0.0]);
}

#[test]
fn answers_what_a_field_is() {
    let state = state();
    for (path, kind, many, name) in [
        ("", FieldKind::Message, false, "demo.State"),
        ("stamp", FieldKind::Time, false, "google.protobuf.Timestamp"),
        ("cables", FieldKind::Message, true, "demo.Cable"),
        ("cables[0].name", FieldKind::Text, false, "string"),
        ("forces", FieldKind::Number, true, "double"),
        ("mode", FieldKind::Number, false, "demo.Mode"),
        ("blob", FieldKind::Other, false, "bytes"),
    ] {
        let found = state.field(&path.parse().unwrap()).unwrap();
        assert_eq!((found.kind, found.many, found.type_name.as_str()), (kind, many, name), "{path}");
    }
    let error = state.field(&"cables[0].mass".parse().unwrap()).unwrap_err();
    assert_eq!(error.to_string(), "`cables[0].mass`: demo.Cable has no member `mass`; it has name, force");
    assert!(state.field(&"cables.name".parse().unwrap()).is_err());
    assert!(state.decoder(&[numbers("blob")]).is_err());
}

#[test]
fn unusable_schemas_say_so() {
    let error = |name: &str, data: &[u8]| MessageType::new("protobuf", name, "protobuf", data).unwrap_err().to_string();
    assert!(error("demo.Nothing", &descriptor_set()).ends_with("it does not define this message"));
    assert!(error("demo.State", b"\xff\xff").contains("not a usable protobuf FileDescriptorSet"));
    assert!(error("demo.State", b"").contains("it does not define this message"));
}

proptest! {
    #[test]
    fn damage_never_panics(cut in 0usize..70, place in 0usize..70, value in any::<u8>()) {
        let mut bytes = sent();
        bytes.truncate(cut.max(1));
        let place = place % bytes.len();
        bytes[place] = value;
        let wanted = [times("stamp"), texts("cables[:].name"), numbers("forces")];
        let _ = state().decoder(&wanted).unwrap().read(&bytes);
    }
}
