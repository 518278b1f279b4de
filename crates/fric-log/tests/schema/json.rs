//! JSON messages.

use fric_log::schema::{Decoder, FieldKind, MessageType, Wanted};

use super::{list, numbers, texts, times};

fn decoder(wanted: &[Wanted]) -> Decoder {
    let message_type = MessageType::new("json", "Demo", "jsonschema", b"whatever").unwrap();
    message_type.decoder(wanted).unwrap()
}

fn number(json: &str) -> Result<f64, String> {
    let mut decoder = decoder(&[numbers("a")]);
    match decoder.read(json.as_bytes()) {
        Ok(values) => Ok(values.number(0).unwrap()),
        Err(error) => Err(error.to_string()),
    }
}

fn time(json: &str) -> Result<i64, String> {
    let mut decoder = decoder(&[times("t")]);
    match decoder.read(format!("{{\"t\":{json}}}").as_bytes()) {
        Ok(values) => Ok(values.time_nanos(0).unwrap()),
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn reads_the_same_fields_as_cdr() {
    let message = r#"{"header": {"stamp": {"sec": 5, "nanosec": 7}}, "name": ["a", "b"],
        "effort": [1, 2.5, null, "NaN", "-Infinity", true], "deep": [{"id": "x", "v": [1, 2]}, {"id": "y", "v": [3]}]}"#;
    let mut decoder = decoder(&[
        times("header.stamp"),
        texts("name"),
        numbers("effort"),
        numbers("effort[1]"),
        numbers("deep[:].v[:]"),
        numbers("deep[:]{id==\"y\"}.v[0]"),
        numbers("deep[:]{id!=\"y\"}.v[-1]"),
        texts("name[5]"),
        numbers("{header.stamp.sec==6}.effort"),
    ]);
    let values = decoder.read(message.as_bytes()).unwrap();
    assert_eq!(values.time_nanos(0), Some(5_000_000_007));
    assert_eq!(list(values, 1), ["a", "b"]);
    let effort = values.numbers(2);
    assert_eq!((effort[0], effort[1], effort[4], effort[5]), (1.0, 2.5, f64::NEG_INFINITY, 1.0));
    assert!(effort[2].is_nan() && effort[3].is_nan());
    assert_eq!(values.numbers(3), [2.5]);
    assert_eq!(values.numbers(4), [1.0, 2.0, 3.0]);
    assert_eq!(values.numbers(5), [3.0]);
    assert_eq!(values.numbers(6), [2.0]);
    assert!(values.texts(7).is_empty());
    assert!(values.numbers(8).is_empty());
    assert_eq!(values.texts(1).revision(), 1);
    assert_eq!(decoder.read(message.as_bytes()).unwrap().texts(1).revision(), 1);
}

#[test]
fn numbers_take_the_forms_json_gives_them() {
    assert_eq!(number(r#"{"a": 0.1}"#), Ok(0.1));
    assert_eq!(number(r#"{"a": 1.0000000000000002}"#), Ok(1.000_000_000_000_000_2));
    assert_eq!(number(r#"{"a": "123"}"#), Ok(123.0));
    assert_eq!(number(r#"{"a": "Infinity"}"#), Ok(f64::INFINITY));
    assert!(number(r#"{"a": null}"#).unwrap().is_nan());
    assert_eq!(number(r#"{"a": "fast"}"#), Err("field `a` holds a text, but a number is wanted there".into()));
    assert_eq!(number(r#"{"a": {}}"#), Err("field `a` holds an object, but a number is wanted there".into()));
    assert_eq!(number(r#"{"b": 1}"#), Err("field `a` is missing in the message: an object has no member `a`".into()));
    assert_eq!(number("[1]"), Err("field `a` is missing in the message: an array has no member `a`".into()));
    assert!(number("{").unwrap_err().starts_with("the message is not valid JSON: EOF"));
    assert!(number("\u{0}").is_err());
    assert!(number(&"[".repeat(100_000)).is_err());
}

#[test]
fn times_take_the_forms_json_gives_them() {
    assert_eq!(time(r#"{"sec": -1, "nsec": 5}"#), Ok(-999_999_995));
    assert_eq!(time(r#"{"sec": "12", "nanosec": 5}"#), Ok(12_000_000_005));
    assert_eq!(time("1700000000"), Ok(1_700_000_000_000_000_000));
    assert_eq!(time("1.5"), Ok(1_500_000_000));
    assert_eq!(time("-0.25"), Ok(-250_000_000));
    assert_eq!(time("0.1234567891"), Ok(123_456_789));
    assert_eq!(time(r#""1970-01-01T00:00:00Z""#), Ok(0));
    assert_eq!(time(r#""2024-02-29T12:34:56.789Z""#), Ok(1_709_210_096_789_000_000));
    assert_eq!(time(r#""2024-05-01T12:00:00.25+02:00""#), Ok(1_714_557_600_250_000_000));
    assert_eq!(time(r#""2000-03-01T00:00:00-00:30""#), Ok(951_870_600_000_000_000));
    assert_eq!(time(r#""1969-12-31T23:59:59.9999999999Z""#), Ok(-1));
    for wrong in [
        r#""2023-02-29T00:00:00Z""#,
        r#""2024-13-01T00:00:00Z""#,
        r#""2024-01-01T24:00:00Z""#,
        r#""2024-01-01T00:00:00""#,
        r#""2024-01-01T00:00:00.Z""#,
        r#""2024-01-01T00:00:00Z!""#,
        r#""soon""#,
        r#"{"sec": 1}"#,
        r#"{"sec": 1.5, "nanosec": 0}"#,
        "null",
    ] {
        assert!(time(wrong).unwrap_err().contains("but a time is wanted"), "{wrong}");
    }
    for wrong in [
        r#"{"sec": 1, "nanosec": 1000000000}"#,
        r#"{"sec": 9300000000, "nanosec": 0}"#,
        "1e30",
        "9300000000",
        r#""3000-01-01T00:00:00Z""#,
    ] {
        assert!(time(wrong).unwrap_err().contains("out of range"), "{wrong}");
    }
}

#[test]
fn any_path_is_unknown_until_read() {
    let message_type = MessageType::new("json", "", "", b"").unwrap();
    assert_eq!(message_type.field(&"a.b[0]".parse().unwrap()).unwrap().kind, FieldKind::Unknown);
}
