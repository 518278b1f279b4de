//! `ros2msg` texts, and what they say of a field.

use fric_log::schema::{FieldKind, MessageType, SchemaError};

use super::{JOINT_STATE, numbers, ros, texts, times};

fn kind(message_type: &MessageType, path: &str) -> (FieldKind, bool, String) {
    let found = message_type.field(&path.parse().unwrap()).unwrap();
    (found.kind, found.many, found.type_name)
}

#[test]
fn answers_what_a_field_is() {
    let joint_state = MessageType::new("cdr", "sensor_msgs/msg/JointState", "ros2msg", JOINT_STATE.as_bytes()).unwrap();
    assert_eq!(joint_state.name(), "sensor_msgs/msg/JointState");
    for (path, expected, many, name) in [
        ("", FieldKind::Message, false, "sensor_msgs/JointState"),
        ("header", FieldKind::Message, false, "std_msgs/Header"),
        ("header.stamp", FieldKind::Time, false, "builtin_interfaces/Time"),
        ("header.stamp.sec", FieldKind::Number, false, "int32"),
        ("header.frame_id", FieldKind::Text, false, "string"),
        ("name", FieldKind::Text, true, "string"),
        ("name[0]", FieldKind::Text, false, "string"),
        ("effort", FieldKind::Number, true, "float64"),
        ("effort[:]", FieldKind::Number, true, "float64"),
        ("effort[-1]", FieldKind::Number, false, "float64"),
        ("{header.frame_id==\"a\"}.effort[0]", FieldKind::Number, true, "float64"),
    ] {
        assert_eq!(kind(&joint_state, path), (expected, many, name.to_owned()), "{path}");
    }
}

#[test]
fn paths_that_lead_nowhere_say_why() {
    let joint_state = ros(JOINT_STATE).unwrap();
    let field = |path: &str| joint_state.field(&path.parse().unwrap()).unwrap_err().to_string();
    assert_eq!(
        field("efort"),
        "`efort`: demo/Demo has no member `efort`; it has header, name, position, velocity, effort"
    );
    assert_eq!(
        field("effort.x"),
        "`effort.x`: an array of float64 is at this place, which needs an index or a slice, such as `[0]` or `[:]`"
    );
    assert!(field("effort[0].x").contains("float64 has no member `x`; it has none"));
    assert!(field("header[0]").contains("std_msgs/Header is at this place, which needs no index"));
    assert!(field("{name==\"a\"}").contains("an array of string"));
    assert!(field("{header.frame_id==1}").contains("a single number is wanted"));
    assert!(field("{header.stamp==1}").contains("builtin_interfaces/Time"));
    assert!(field("{header.nothing==1}").contains("no member `nothing`"));
    for wanted in [texts("effort"), numbers("name"), times("effort"), numbers("header"), numbers("header.stamp")] {
        let error = joint_state.decoder(std::slice::from_ref(&wanted)).unwrap_err();
        assert!(matches!(error, SchemaError::Kind { .. }), "{wanted:?}: {error}");
    }
}

#[test]
fn reads_everything_a_definition_may_hold() {
    let text = "\u{feff}# a comment\r\n\
        \r\n\
        \t  # another\r\n\
        bool flag TRUE\r\n\
        byte b\r\n\
        char c 65 # as a number\r\n\
        int8 i8 -1\r\n\
        uint8 u8#comment\r\n\
        int16 i16\r\n\
        uint16 u16 0xFF\r\n\
        int32 i32\r\n\
        uint32 u32\r\n\
        int64 i64\r\n\
        uint64 u64 18446744073709551615\r\n\
        float32 f32 1e-3\r\n\
        float64 w 1\r\n\
        int32 X=5\r\n\
        int32 Y = -5 # five\r\n\
        string S=text with # in it\r\n\
        string T='#'\r\n\
        float64 PI=3.14\r\n\
        string s \"a # b\"\r\n\
        string<=12 bounded\r\n\
        string<=5[<=3] both\r\n\
        int32[] a [1,2]\r\n\
        int32[3] three [1, 2, 3] # and a comment\r\n\
        bool[<=10] few\r\n\
        string[] words [\"a\", \"#\"]\r\n\
        float64[] none []\r\n\
        builtin_interfaces/Time stamp\r\n\
        builtin_interfaces/msg/Duration span\r\n\
        Header header\r\n\
        Local local\r\n\
        other_msgs/msg/Far[2] far\r\n\
        wstring<=3 wide\r\n\
        ================================================================================\r\n\
        MSG: std_msgs/Header\r\n\
        builtin_interfaces/Time stamp\r\n\
        string frame_id\r\n\
        ================================================================================\r\n\
        MSG: demo/Local\r\n\
        ================================================================================\r\n\
        MSG: other_msgs/msg/Far\r\n\
        Near near\r\n\
        ================================================================================\r\n\
        MSG: other_msgs/Near\r\n\
        float32 x\r\n";
    let message_type = ros(text).unwrap();
    for (path, expected) in [
        ("flag", "bool"),
        ("b", "uint8"),
        ("c", "uint8"),
        ("i8", "int8"),
        ("u8", "uint8"),
        ("u64", "uint64"),
        ("f32", "float32"),
        ("bounded", "string"),
        ("both", "string"),
        ("three", "int32"),
        ("stamp", "builtin_interfaces/Time"),
        ("span", "builtin_interfaces/Duration"),
        ("header.frame_id", "string"),
        ("local", "demo/Local"),
        ("far[1].near.x", "float32"),
        ("wide", "wstring"),
    ] {
        assert_eq!(kind(&message_type, path).2, expected, "{path}");
    }
    for constant in ["X", "Y", "S", "T", "PI"] {
        assert!(message_type.field(&constant.parse().unwrap()).is_err(), "{constant}");
    }
}

#[test]
fn time_is_told_by_its_name_and_its_members() {
    let own = "Time t\n===\nMSG: demo/Time\nint32 sec\nuint32 nanosec";
    assert_eq!(kind(&ros(own).unwrap(), "t").0, FieldKind::Message);
    let odd = "builtin_interfaces/Time t\n===\nMSG: builtin_interfaces/Time\nfloat64 seconds";
    let odd = ros(odd).unwrap();
    assert_eq!(kind(&odd, "t").0, FieldKind::Message);
    assert_eq!(kind(&odd, "t.seconds").0, FieldKind::Number);
}

#[test]
fn wrong_lines_are_named() {
    for (text, line, expected) in [
        ("float64", 1, "a field name"),
        ("float64 2x", 1, "a field name"),
        ("int32 a\nfloat64 x-y", 2, "nothing, a comment"),
        ("float64 x y", 1, "nothing, a comment"),
        ("float64 x 1 2", 1, "nothing, a comment"),
        ("float64[] x 1", 1, "nothing, a comment"),
        ("float64[2] x [1,a]", 1, "nothing, a comment"),
        ("int32 x 0xg", 1, "nothing, a comment"),
        ("float64 x[3]", 1, "nothing, a comment"),
        ("\n\nfloat64[ x", 3, "`[]`"),
        ("float64[-1] x", 1, "`[]`"),
        ("float64[0] x", 1, "`[]`"),
        ("float64[<=] x", 1, "`[]`"),
        ("float64[<3] x", 1, "`[]`"),
        ("float64[99999999999] x", 1, "`[]`"),
        ("float64<=3 x", 1, "a type"),
        ("string<=x y", 1, "a type"),
        ("a/b/c/d x", 1, "a type"),
        ("/b x", 1, "a type"),
        ("{\"type\": \"object\"}", 1, "a type"),
        ("int32 X=", 1, "a value after `=`"),
        ("int32 X= # five", 1, "a value after `=`"),
        ("int32[] X=5", 1, "a value after `=`"),
        ("int32 a\n===", 2, "`MSG: package/Type`"),
        ("int32 a\n===\nfloat64 x", 3, "`MSG: package/Type`"),
        ("int32 a\n===\nMSG: \n", 3, "`MSG: package/Type`"),
    ] {
        match ros(text).unwrap_err() {
            SchemaError::Syntax { line: found_line, expected: found, .. } => {
                assert_eq!(found_line, line, "{text}");
                assert!(found.starts_with(expected), "{text}: {found}");
            }
            other => panic!("{text}: {other}"),
        }
    }
    assert_eq!(
        ros("int32 a\nfloat64 x y").unwrap_err().to_string(),
        "schema `demo/msg/Demo`, line 2: expected nothing, a comment, or a default value of the field's type, found `y`"
    );
}

#[test]
fn types_must_exist_once_and_end() {
    let check = |text: &str, expected: &str| {
        let error = ros(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{text}: {error}");
    };
    check("int32 a\nFoo b", "line 2: type `Foo` is not defined");
    check("geometry_msgs/Pose p", "line 1: type `geometry_msgs/Pose` is not defined");
    check("Header h", "line 1: type `Header` is not defined");
    check("int32 a\nint32 a", "line 2: `a` is defined a second time");
    check("A a\n===\nMSG: demo/A\nint32 x\n===\nMSG: demo/msg/A\nint32 x", "line 6: `demo/A` is defined a second time");
    check("Demo again", "line 1: type `demo/Demo` contains itself");
    check("A a\n===\nMSG: demo/A\nint32 x\nB b\n===\nMSG: demo/B\nA[] a", "line 8: type `demo/A` contains itself");
    check("A a\n===\nIDL: demo/msg/A\nmodule demo {};", "`ros2idl`");
}

#[test]
fn deep_and_wide_schemas_are_refused_quickly() {
    use std::fmt::Write as _;
    let chain = |count: usize, uses: usize| {
        let mut text = String::from("T0 a\n");
        for index in 0..count {
            write!(text, "===\nMSG: demo/T{index}\n").unwrap();
            for field in 0..uses {
                // A text in between, so that no type has a fixed size.
                write!(text, "string s{field}\nT{} t{field}\n", index + 1).unwrap();
            }
        }
        write!(text, "===\nMSG: demo/T{count}\nfloat64 x\n").unwrap();
        text
    };
    assert!(ros(&chain(10_000, 1)).unwrap_err().to_string().contains("more than 64 levels"));
    assert!(ros(&chain(100_000, 1)).unwrap_err().to_string().contains("more than 50000 fields and types"));
    let fields = (0..60_000).map(|index| format!("float64 x{index}\n")).collect::<Vec<_>>().concat();
    assert!(ros(&fields).unwrap_err().to_string().contains("more than 50000 fields and types"));
    // 2⁵⁰ fields in all.
    let wide = ros(&chain(50, 2)).unwrap();
    assert!(wide.decoder(&[]).unwrap_err().to_string().contains("more than 50000 fields"));
    let deep = ros(&chain(50, 1)).unwrap();
    assert!(deep.decoder(&[]).is_ok());
}

#[test]
fn unsupported_encodings_say_what_is_supported() {
    let error =
        |message: &str, schema: &str| MessageType::new(message, "x/Y", schema, b"int32 a").unwrap_err().to_string();
    for (message, schema) in [("ros1", "ros1msg"), ("flatbuffer", "flatbuffer"), ("cdr", ""), ("protobuf", "")] {
        let text = error(message, schema);
        assert!(text.contains("supported are `cdr` with `ros2msg`"), "{text}");
    }
    assert!(error("cdr", "ros2idl").contains("record again"));
    let error = MessageType::new("cdr", "x/Y", "ros2msg", b"int32 a\nint32 \xff").unwrap_err();
    assert_eq!(error.to_string(), "schema `x/Y`, line 2: expected UTF-8 text, found `byte 0xff`");
}

#[test]
fn wide_texts_hide_only_what_follows_them() {
    let message_type = ros("float64 a\nIn[] in\nfloat64 b\n===\nMSG: demo/In\nfloat64 c\nwstring w").unwrap();
    assert!(message_type.decoder(&[numbers("a")]).is_ok());
    for (wanted, path) in [(numbers("b"), "b"), (numbers("in[0].c"), "in[0].c"), (texts("in[0].w"), "in[0].w")] {
        let error = message_type.decoder(&[wanted]).unwrap_err();
        assert_eq!(error, SchemaError::WideText { path: path.to_owned(), wide: "in[].w".to_owned() });
    }
}
