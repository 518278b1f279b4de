//! Random values of random types, written by the encoder of these tests and read back.

use std::fmt::Write as _;

use proptest::prelude::*;

use fric_log::path::Selection;
use fric_log::schema::Wanted;

use super::encoder::Encoder;
use super::{list, numbers, ros, texts, times};

const PRIMITIVES: [&str; 11] =
    ["uint8", "bool", "int8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"];

/// Decisions taken from random bytes; 0 once they run out, which makes the simplest case.
struct Choices<'a>(&'a [u8]);

impl Choices<'_> {
    fn below(&mut self, limit: usize) -> usize {
        let Some((&first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        usize::from(first) % limit
    }
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Primitive(usize),
    Text,
    Time,
    Message(usize),
}

#[derive(Clone, Copy, Debug)]
enum Count {
    One,
    Fixed(usize),
    Sequence,
}

type Type = Vec<(Kind, Count)>;

#[derive(Clone, Debug)]
enum Value {
    Number(f64),
    Text(String),
    Time(i64),
    Message(Vec<Value>),
    Array(Vec<Value>),
}

/// Types of which each contains only later ones.
fn types(choices: &mut Choices<'_>) -> Vec<Type> {
    let count = 1 + choices.below(4);
    let field = |index: usize, choices: &mut Choices<'_>| {
        let kind = match choices.below(6) {
            0 | 1 => Kind::Primitive(choices.below(PRIMITIVES.len())),
            2 => Kind::Text,
            3 => Kind::Time,
            _ if index + 1 < count => Kind::Message(index + 1 + choices.below(count - index - 1)),
            _ => Kind::Primitive(10),
        };
        let count = match choices.below(4) {
            0 | 1 => Count::One,
            2 => Count::Fixed(1 + choices.below(3)),
            _ => Count::Sequence,
        };
        (kind, count)
    };
    (0..count).map(|index| (0..choices.below(5)).map(|_| field(index, choices)).collect()).collect()
}

fn schema(types: &[Type]) -> String {
    let mut text = String::new();
    for (index, fields) in types.iter().enumerate() {
        if index > 0 {
            write!(text, "{}\nMSG: demo/T{index}\n", "=".repeat(80)).unwrap();
        }
        for (place, (kind, count)) in fields.iter().enumerate() {
            match kind {
                Kind::Primitive(primitive) => text.push_str(PRIMITIVES[*primitive]),
                Kind::Text => text.push_str("string"),
                Kind::Time => text.push_str("builtin_interfaces/Time"),
                Kind::Message(message) => write!(text, "T{message}").unwrap(),
            }
            match count {
                Count::One => {}
                Count::Fixed(count) => write!(text, "[{count}]").unwrap(),
                Count::Sequence => text.push_str("[]"),
            }
            writeln!(text, " f{place}").unwrap();
        }
    }
    text
}

/// Writes one random element; what it should be read as.
fn element(kind: Kind, types: &[Type], choices: &mut Choices<'_>, encoder: &mut Encoder) -> Value {
    match kind {
        Kind::Primitive(primitive) => {
            let byte = u8::try_from(choices.below(256)).unwrap();
            let small = i16::from(byte) - 100;
            let (bytes, value) = match PRIMITIVES[primitive] {
                "uint8" => (vec![byte], f64::from(byte)),
                "bool" => (vec![byte & 1], f64::from(byte & 1)),
                "int8" => (byte.to_le_bytes().to_vec(), f64::from(byte.cast_signed())),
                "int16" => ((small * 200).to_le_bytes().to_vec(), f64::from(small * 200)),
                "uint16" => ((u16::from(byte) * 257).to_le_bytes().to_vec(), f64::from(u16::from(byte) * 257)),
                "int32" => ((i32::from(small) << 20).to_le_bytes().to_vec(), f64::from(i32::from(small) << 20)),
                "uint32" => ((u32::from(byte) << 24).to_le_bytes().to_vec(), f64::from(u32::from(byte) << 24)),
                "int64" => ((i64::from(small) << 30).to_le_bytes().to_vec(), f64::from(small) * 1_073_741_824.0),
                "uint64" => ((u64::from(byte) << 33).to_le_bytes().to_vec(), f64::from(byte) * 8_589_934_592.0),
                "float32" => ((f32::from(small) / 8.0).to_le_bytes().to_vec(), f64::from(small) / 8.0),
                _ => ((f64::from(small) / 7.0).to_le_bytes().to_vec(), f64::from(small) / 7.0),
            };
            encoder.scalar(&bytes);
            Value::Number(value)
        }
        Kind::Text => {
            let text = "käbel".chars().take(choices.below(6)).collect::<String>();
            encoder.text(&text);
            Value::Text(text)
        }
        Kind::Time => {
            let (sec, nanosec) = (choices.below(256), choices.below(256));
            encoder.count(sec).count(nanosec);
            Value::Time(i64::try_from(sec * 1_000_000_000 + nanosec).unwrap())
        }
        Kind::Message(index) => Value::Message(message(index, types, choices, encoder)),
    }
}

fn message(index: usize, types: &[Type], choices: &mut Choices<'_>, encoder: &mut Encoder) -> Vec<Value> {
    if types[index].is_empty() {
        encoder.scalar(&[0]);
    }
    let mut values = Vec::new();
    for &(kind, count) in &types[index] {
        let counted = match count {
            Count::One => {
                values.push(element(kind, types, choices, encoder));
                continue;
            }
            Count::Fixed(count) => count,
            Count::Sequence => choices.below(4),
        };
        if encoder.is_cdr2() && !matches!(kind, Kind::Primitive(_)) {
            encoder.u32(99);
        }
        if let Count::Sequence = count {
            encoder.count(counted);
        }
        let elements = (0..counted).map(|_| element(kind, types, choices, encoder));
        values.push(Value::Array(elements.collect()));
    }
    values
}

/// Appends random wanted fields below a type, with the values they should give.
fn want(
    index: usize,
    types: &[Type],
    prefix: &str,
    found: &[&Vec<Value>],
    choices: &mut Choices<'_>,
    wants: &mut Vec<(Wanted, Vec<Value>)>,
) {
    for (place, &(kind, count)) in types[index].iter().enumerate() {
        for _ in 0..choices.below(3) {
            let mut path = format!("{prefix}f{place}");
            let mut values: Vec<Value> = found.iter().map(|value| value[place].clone()).collect();
            if !matches!(count, Count::One) {
                let indices = [None, Some(0), Some(1), Some(-1), Some(-2)];
                let (first, last) = (indices[choices.below(5)], indices[choices.below(5)]);
                let selection = match (choices.below(3), first) {
                    (0, Some(index)) => Selection::One(index),
                    (1, _) => Selection::Slice { first, last },
                    _ => Selection::ALL,
                };
                write!(path, "{selection}").unwrap();
                values = values.iter().flat_map(|value| select(value, selection)).collect();
            }
            match kind {
                Kind::Primitive(_) => wants.push((numbers(&path), values)),
                Kind::Text => wants.push((texts(&path), values)),
                Kind::Time => wants.push((times(&path), values)),
                Kind::Message(index) => {
                    let inside: Vec<&Vec<Value>> = values
                        .iter()
                        .map(|value| match value {
                            Value::Message(fields) => fields,
                            other => panic!("{other:?}"),
                        })
                        .collect();
                    want(index, types, &format!("{path}."), &inside, choices, wants);
                }
            }
        }
    }
}

fn select(value: &Value, selection: Selection) -> Vec<Value> {
    let Value::Array(elements) = value else {
        panic!("{value:?}");
    };
    let count = i64::try_from(elements.len()).unwrap();
    let absolute = |index: i64| if index < 0 { index + count } else { index };
    let chosen = |index: i64| match selection {
        Selection::One(one) => index == absolute(one),
        Selection::Slice { first, last } => {
            index >= absolute(first.unwrap_or(0)) && index <= absolute(last.unwrap_or(-1))
        }
    };
    (0..).zip(elements).filter(|(index, _)| chosen(*index)).map(|(_, element)| element.clone()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn what_is_written_is_read(
        shape in prop::collection::vec(any::<u8>(), 0..100),
        content in prop::collection::vec(any::<u8>(), 0..200),
        paths in prop::collection::vec(any::<u8>(), 0..100),
        big_endian: bool,
        cdr2: bool,
    ) {
        let types = types(&mut Choices(&shape));
        let mut encoder = Encoder::new(big_endian, cdr2);
        let root = message(0, &types, &mut Choices(&content), &mut encoder);
        let bytes = encoder.done();
        let mut wants = Vec::new();
        want(0, &types, "", &[&root], &mut Choices(&paths), &mut wants);
        wants.truncate(60);
        let wanted: Vec<Wanted> = wants.iter().map(|(wanted, _)| wanted.clone()).collect();
        let mut decoder = ros(&schema(&types)).unwrap().decoder(&wanted).unwrap();
        // Twice, as the second time may find the texts unchanged.
        for _ in 0..2 {
            let values = decoder.read(&bytes).unwrap();
            for (index, (wanted, expected)) in wants.iter().enumerate() {
                let mut numbers = Vec::new();
                let mut strings = Vec::new();
                let mut stamps = Vec::new();
                for value in expected {
                    match value {
                        Value::Number(number) => numbers.push(*number),
                        Value::Text(text) => strings.push(text.as_str()),
                        Value::Time(nanos) => stamps.push(*nanos),
                        other => panic!("{other:?}"),
                    }
                }
                prop_assert_eq!(values.numbers(index), &numbers, "{}", wanted.path);
                prop_assert_eq!(list(values, index), strings, "{}", wanted.path);
                prop_assert_eq!(values.times_nanos(index), &stamps, "{}", wanted.path);
            }
        }
        // The whole message is walked, whatever is wanted of it.
        for length in 0..bytes.len() {
            prop_assert!(decoder.read(&bytes[..length]).is_err(), "{} of {}", length, bytes.len());
        }
        prop_assert!(decoder.read(&bytes).is_ok());
    }
}
