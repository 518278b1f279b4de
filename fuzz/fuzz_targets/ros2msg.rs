//! Bytes as a `ros2msg` schema and, behind a NUL, a message of it.
#![no_main]

use fric_log::schema::{FieldKind, MessageType, Wanted};
use libfuzzer_sys::fuzz_target;

const FIELDS: [&str; 8] = ["header.stamp", "a", "b", "name", "a[:].b", "a[0]", "position", "a{b==1}.c"];

fuzz_target!(|data: &[u8]| {
    let mut parts = data.splitn(2, |byte| *byte == 0);
    let (schema, message) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    let Ok(message_type) = MessageType::new("cdr", "demo/msg/Demo", "ros2msg", schema) else { return };
    assert_eq!(message_type.name(), "demo/msg/Demo");
    let mut wanted = Vec::new();
    for path in FIELDS.map(|text| text.parse().expect("a path")) {
        match message_type.field(&path).map(|field| field.kind) {
            Ok(FieldKind::Number) => wanted.push(Wanted::numbers(path)),
            Ok(FieldKind::Text) => wanted.push(Wanted::texts(path)),
            Ok(FieldKind::Time) => wanted.push(Wanted::times(path)),
            _ => {}
        }
    }
    let nothing = message_type.decoder(&[]);
    // What cannot be read with nothing wanted cannot be read with something wanted either.
    let Ok(mut decoder) = message_type.decoder(&wanted) else { return };
    let mut nothing = nothing.expect("a decoder of nothing");
    let skipped = nothing.read(message).map(|_| ());
    if let Ok(values) = decoder.read(message) {
        assert_eq!(skipped, Ok(()));
        for place in 0..wanted.len() {
            let count = values.numbers(place).len() + values.times_nanos(place).len() + values.texts(place).len();
            assert!(count <= message.len(), "{count} values from {} bytes", message.len());
        }
    }
});
