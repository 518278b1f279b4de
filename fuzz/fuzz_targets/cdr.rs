//! Messages of known types, damaged: what is read depends on the message alone, and is no more than it holds.
#![no_main]

use arbitrary::Arbitrary;
use fric_log::schema::{Decoder, MessageType, Values, Wanted};
use libfuzzer_sys::fuzz_target;

const JOINTS: &str = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n\
                      ===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
                      ===\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const NESTED: &str = "A[] as\nstring[3] three\nB[2] fixed\nbool[] flags\n===\nMSG: demo/A\nstring name\nB[] bs\n\
                      Empty e\n===\nMSG: demo/B\nuint8 small\nfloat64 large\nint16[<=4] few\n===\nMSG: demo/Empty\n";

type Field = (&'static str, fn(fric_log::path::FieldPath) -> Wanted);

const JOINT_FIELDS: [Field; 7] = [
    ("header.stamp", Wanted::times),
    ("header.frame_id", Wanted::texts),
    ("name", Wanted::texts),
    ("position[1]", Wanted::numbers),
    ("velocity[-2:]", Wanted::numbers),
    ("effort", Wanted::numbers),
    ("header.stamp.nanosec", Wanted::numbers),
];
const NESTED_FIELDS: [Field; 7] = [
    ("as[:].bs[:].large", Wanted::numbers),
    ("as[:]{name==\"x\"}.bs[-1].few[:]", Wanted::numbers),
    ("as[0].name", Wanted::texts),
    ("three[1:]", Wanted::texts),
    ("fixed[:]{small!=0}.large", Wanted::numbers),
    ("flags", Wanted::numbers),
    ("as[:].name", Wanted::texts),
];

#[derive(Arbitrary, Debug)]
struct Input<'a> {
    nested: bool,
    /// Which of the fields are wanted, a bit each.
    wanted: u8,
    /// The representation: mostly one that is read.
    representation: u8,
    before: &'a [u8],
    message: &'a [u8],
}

fuzz_target!(|input: Input<'_>| {
    let (schema, fields) = if input.nested { (NESTED, NESTED_FIELDS) } else { (JOINTS, JOINT_FIELDS) };
    let message_type = MessageType::new("cdr", "demo/msg/Demo", "ros2msg", schema.as_bytes()).expect("a schema");
    let chosen = fields.iter().enumerate().filter(|(place, _)| input.wanted >> place & 1 == 1);
    let wanted: Vec<Wanted> = chosen.map(|(_, (path, wanted))| wanted(path.parse().expect("a path"))).collect();
    let decoder = || message_type.decoder(&wanted).expect("fields that are there");
    let message = |body: &[u8]| [&[0, input.representation % 20, 0, 0], body].concat();
    let (before, message) = (message(input.before), message(input.message));

    let mut used = decoder();
    let _ = used.read(&before);
    let _ = used.read(&before);
    let again = read(&mut used, &message, wanted.len());
    let first = read(&mut decoder(), &message, wanted.len());
    // The bits of NaN too, as the texts show them.
    assert_eq!(format!("{again:?}"), format!("{first:?}"));
    if let Some(first) = first {
        let mut nothing = message_type.decoder(&[]).expect("nothing");
        assert!(nothing.read(&message).is_ok(), "read with fields, not without");
        for (numbers, times, texts) in &first {
            let bytes = numbers.len() + times.len() + texts.iter().map(|text| 4 + text.len()).sum::<usize>();
            assert!(bytes <= message.len(), "{first:?}");
        }
    }
});

type Fields = Vec<(Vec<f64>, Vec<i64>, Vec<String>)>;

fn read(decoder: &mut Decoder, message: &[u8], count: usize) -> Option<Fields> {
    let field = |values: &Values, place: usize| {
        let texts = values.texts(place).iter().map(ToOwned::to_owned).collect();
        (values.numbers(place).to_vec(), values.times_nanos(place).to_vec(), texts)
    };
    decoder.read(message).ok().map(|values| (0..count).map(|place| field(values, place)).collect())
}
