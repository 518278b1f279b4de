//! Damaged and hostile messages: errors, never panics, nor memory by what a message only claims.

use fric_log::schema::DecodeError;
use proptest::prelude::*;

use super::encoder::{Encoder, joint_state};
use super::{JOINT_STATE, decoder, numbers, ros, texts, times};

const NESTED: &str = "\
A[] as
string[3] three
B[2] fixed
bool[] flags
===
MSG: demo/A
string name
B[] bs
wchar_free/Empty e
===
MSG: demo/B
uint8 small
float64 large
int16[<=4] few
===
MSG: wchar_free/Empty
";

#[test]
fn cut_short_anywhere_is_an_error() {
    let mut encoder = Encoder::new(false, false);
    joint_state(&mut encoder, (1, 2), &["a", "cable"], [&[1.0], &[2.0, 3.0], &[4.0]]);
    let message = encoder.done();
    let all = [times("header.stamp"), texts("name"), numbers("effort"), texts("header.frame_id")];
    // With everything, something and nothing wanted, the whole message is checked.
    for wanted in [&all[..], &all[..1], &[]] {
        let mut decoder = decoder(JOINT_STATE, wanted);
        for length in 0..message.len() {
            assert!(decoder.read(&message[..length]).is_err(), "{length}");
        }
        assert!(decoder.read(&message).is_ok());
    }
}

#[test]
fn errors_name_field_and_place() {
    let mut decoder = decoder(JOINT_STATE, &[numbers("effort"), texts("name")]);
    let mut encoder = Encoder::new(false, false);
    joint_state(&mut encoder, (1, 2), &["a"], [&[], &[], &[4.0]]);
    let message = encoder.done();
    let cut = |length: usize, decoder: &mut fric_log::schema::Decoder| decoder.read(&message[..length]).unwrap_err();
    assert_eq!(
        cut(message.len() - 1, &mut decoder).to_string(),
        "the message ends within field `effort`, at byte 52 of 59; it is cut short or not of its schema"
    );
    let error = cut(8, &mut decoder);
    assert_eq!(
        error.to_string(),
        "the message ends within field `header.stamp`, at byte 4 of 8; it is cut short or not of its schema"
    );
    let mut hostile = message.clone();
    hostile[24..28].copy_from_slice(&u32::MAX.to_le_bytes());
    let field = "name".to_owned();
    let expected = DecodeError::Count { field, offset: 24, count: 4_294_967_295, remaining: 32 };
    assert_eq!(decoder.read(&hostile).unwrap_err(), expected);
}

#[test]
fn claimed_counts_cost_nothing() {
    let wanted = [numbers("as[:].bs[:].large"), texts("three"), numbers("flags"), texts("as[:].name")];
    let mut reader = decoder(NESTED, &wanted);
    let mut skipper = decoder(NESTED, &[]);
    for count in [1, 2, 0x7fff_ffff, u32::MAX] {
        let message = [&[0, 1, 0, 0], &count.to_le_bytes()[..], &[0; 3]].concat();
        assert!(reader.read(&message).is_err());
        assert!(skipper.read(&message).is_err());
    }
    // A schema may claim as well.
    let schema = "E[4294967295] es\nE[4294967295] more\n===\nMSG: demo/E\nstring s\nuint8[4294967295] x";
    let mut skipper = decoder(schema, &[numbers("more[:].x[0]")]);
    assert!(skipper.read(&[0, 1, 0, 0, 1, 2, 3, 4]).is_err());
}

proptest! {
    #[test]
    fn random_bytes_never_panic(mut bytes in prop::collection::vec(any::<u8>(), 0..200), id in 0u8..18) {
        if let Some(first) = bytes.first_mut() {
            *first = 0;
        }
        if let Some(second) = bytes.get_mut(1) {
            *second = id;
        }
        let wanted = [
            numbers("as[:].bs[-1].large"),
            numbers("as[:]{name==\"\"}.bs[:].few[:]"),
            texts("as[0].name"),
            texts("three[:]"),
            numbers("fixed[1].small"),
            numbers("flags"),
        ];
        let mut reader = decoder(NESTED, &wanted);
        if let Ok(values) = reader.read(&bytes) {
            prop_assert!(values.numbers(5).len() <= bytes.len());
        }
        let _ = decoder(NESTED, &[]).read(&bytes);
        let _ = decoder(JOINT_STATE, &[texts("name"), numbers("effort")]).read(&bytes);
    }

    #[test]
    fn few_values_decide_lengths(words in prop::collection::vec(0u32..4, 0..60)) {
        // Small numbers everywhere, so that counts are often possible and reading goes far.
        let mut encoder = Encoder::new(false, false);
        for word in words {
            encoder.u32(word);
        }
        let message = encoder.done();
        let _ = decoder(NESTED, &[numbers("as[:].bs[:].large"), texts("three")]).read(&message);
        let _ = decoder(NESTED, &[]).read(&message);
    }

    #[test]
    fn random_schemas_never_panic(text in "[a-zA-Z0-9_/ \\[\\]<=#\"\n.:]{0,80}") {
        let _ = ros(&text);
    }

    #[test]
    fn schema_like_schemas_never_panic(
        lines in prop::collection::vec("(A|B|demo/A|string|int8|wstring|float64|===|MSG: demo/|MSG: demo/A|MSG: B)(\\[\\]|\\[2\\]|<=3)?( a| b| c)?(=1| 2|#)?", 0..12)
    ) {
        if let Ok(message_type) = ros(&lines.join("\n"))
            && let Ok(mut decoder) = message_type.decoder(&[])
        {
            let _ = decoder.read(&[0; 40]);
        }
    }
}
