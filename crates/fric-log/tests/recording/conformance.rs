//! Every file of the MCAP project's conformance suite.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fric_log::recording::Recording;
use serde_json::Value;

fn directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/mcap-conformance")
}

fn field<'a>(record: &'a Value, name: &str) -> &'a Value {
    let fields = record["fields"].as_array().unwrap();
    let found = fields.iter().find(|field| field[0] == name);
    &found.unwrap_or_else(|| panic!("no {name} in {record}"))[1]
}

fn number(record: &Value, name: &str) -> u64 {
    field(record, name).as_str().unwrap().parse().unwrap()
}

fn text<'a>(record: &'a Value, name: &str) -> &'a str {
    field(record, name).as_str().unwrap()
}

fn bytes(record: &Value, name: &str) -> Vec<u8> {
    let numbers = field(record, name).as_array().unwrap();
    numbers.iter().map(|byte| byte.as_str().unwrap().parse().unwrap()).collect()
}

fn of_type<'a>(records: &'a [Value], kind: &'a str) -> impl Iterator<Item = &'a Value> {
    records.iter().filter(move |record| record["type"] == kind)
}

fn check(path: &Path, records: &[Value]) {
    let by_id = |kind, id: u64| of_type(records, kind).find(|record| number(record, "id") == id);
    let mut expected: Vec<&Value> = of_type(records, "Message").collect();
    // Stable, so that equal times keep the order of the file.
    expected.sort_by_key(|record| number(record, "log_time"));

    let mut recording = Recording::open(&[path]).unwrap();
    for record in &expected {
        let message = recording.next_message().unwrap().expect("a message");
        assert_eq!(u64::from(message.sequence), number(record, "sequence"));
        assert_eq!(message.log_time_nanos, number(record, "log_time"));
        assert_eq!(message.publish_time_nanos, number(record, "publish_time"));
        assert_eq!(message.data, bytes(record, "data"));
        let channel = by_id("Channel", number(record, "channel_id")).unwrap();
        assert_eq!(message.channel.topic, text(channel, "topic"));
        assert_eq!(message.channel.message_encoding, text(channel, "message_encoding"));
        let metadata: BTreeMap<String, String> = serde_json::from_value(field(channel, "metadata").clone()).unwrap();
        assert_eq!(message.channel.metadata, metadata);
        let schema = by_id("Schema", number(channel, "schema_id")).unwrap();
        let found = message.channel.schema.as_ref().unwrap();
        assert_eq!(found.name, text(schema, "name"));
        assert_eq!(found.encoding, text(schema, "encoding"));
        assert_eq!(found.data, bytes(schema, "data"));
    }
    assert!(recording.next_message().unwrap().is_none());
    assert!(recording.next_message().unwrap().is_none());
    assert!(recording.damage().is_empty(), "{}", recording.damage());
    assert_eq!(recording.late_count(), 0);
    assert_eq!(recording.bytes_read(), recording.total_bytes());
    let statistics = of_type(records, "Statistics").next();
    let count = statistics.map(|record| number(record, "message_count"));
    assert_eq!(recording.expected_message_count(), count);
    assert_eq!(recording.attachments().len(), of_type(records, "Attachment").count());
    assert_eq!(recording.metadata().len(), of_type(records, "Metadata").count());
    let channels = recording.channels();
    for (place, channel) in channels.iter().enumerate() {
        assert_eq!(channel.id, place);
    }
}

#[test]
fn every_file_reads_as_described() {
    let expected = std::fs::read_to_string(directory().join("expected.json")).unwrap();
    let expected: BTreeMap<String, Vec<Value>> = serde_json::from_str(&expected).unwrap();
    assert_eq!(expected.len(), 154);
    for (name, records) in &expected {
        println!("{name}");
        check(&directory().join(format!("{name}.mcap")), records);
    }
}
