//! Known messages in CDR.

use fric_log::schema::{DecodeError, Wanted};

use super::encoder::{Encoder, joint_state};
use super::{JOINT_STATE, decoder, list, numbers, texts, times};

fn joint_state_wanted() -> Vec<Wanted> {
    vec![
        times("header.stamp"),
        texts("name"),
        numbers("position"),
        numbers("velocity"),
        numbers("effort"),
        texts("header.frame_id"),
    ]
}

#[test]
fn reads_a_joint_state_byte_by_byte() {
    // Written down from the CDR rules: header, stamp, frame "b", names "c1" and "cable2", one number each.
    #[rustfmt::skip]
    let little = [
        0, 1, 0, 0,
        0xff, 0xff, 0xff, 0xff,  0x01, 0, 0, 0, // -1 s, 1 ns
        2, 0, 0, 0, b'b', 0,  0, 0, // "b", padding
        2, 0, 0, 0, // two names
        3, 0, 0, 0, b'c', b'1', 0,  0,
        7, 0, 0, 0, b'c', b'a', b'b', b'l', b'e', b'2', 0,  0,
        1, 0, 0, 0, 0, 0, 0, 0,  0, 0, 0, 0, 0, 0, 0xf0, 0x3f, // 1.0, aligned
        0, 0, 0, 0, // none, and no padding for what is not there
        2, 0, 0, 0,  0, 0, 0, 0, 0, 0, 0xf8, 0x7f,  0, 0, 0, 0, 0, 0, 0, 0xc0, // NaN, -2.0
    ];
    let mut decoder = decoder(JOINT_STATE, &joint_state_wanted());
    let values = decoder.read(&little).unwrap();
    assert_eq!(values.time_nanos(0), Some(-999_999_999));
    assert_eq!(list(values, 1), ["c1", "cable2"]);
    assert_eq!(values.numbers(2), [1.0]);
    assert_eq!(values.numbers(3), [0.0; 0]);
    assert!(values.numbers(4)[0].is_nan());
    assert_eq!(values.numbers(4)[1].to_bits(), (-2.0f64).to_bits());
    assert_eq!(values.texts(5).get(0), Some("b"));
    assert_eq!(values.texts(5).get(1), None);
    assert_eq!((values.number(2), values.number(3), values.number(4)), (Some(1.0), None, None));
    assert_eq!((values.numbers(9).len(), values.texts(9).len(), values.time_nanos(9)), (0, 0, None));
}

#[test]
fn every_representation_gives_the_same() {
    let arrays: [&[f64]; 3] = [&[0.1, 0.2], &[], &[f64::INFINITY, -0.0]];
    let mut decoder = decoder(JOINT_STATE, &joint_state_wanted());
    for id in [0x00, 0x01, 0x06, 0x07, 0x10, 0x11] {
        let mut encoder = Encoder::new(id % 2 == 0, id > 1);
        joint_state(&mut encoder, (1_700_000_000, 999_999_999), &["a", "bb"], arrays);
        let mut bytes = encoder.done();
        bytes[1] = id;
        bytes[3] = 2; // options, of no concern
        bytes.extend([0xee; 3]); // nor is padding at the end
        let values = decoder.read(&bytes).unwrap();
        assert_eq!(values.time_nanos(0), Some(1_700_000_000_999_999_999));
        assert_eq!(list(values, 1), ["a", "bb"]);
        for (index, array) in arrays.iter().enumerate() {
            assert_eq!(values.numbers(index + 2), *array, "{id}");
        }
    }
    for (id, name) in
        [(0x02, "PL_CDR, "), (0x03, "PL_CDR, "), (0x09, "D_CDR2, "), (0x0b, "PL_CDR2, "), (0x77, "0x0077")]
    {
        let error = decoder.read(&[0, id, 0, 0, 1, 2, 3]).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
    let error = decoder.read(&[0, 1, 0]).unwrap_err();
    assert!(error.to_string().contains("header cut short (3 bytes)"), "{error}");
}

#[test]
fn revision_tells_whether_names_are_new() {
    let mut decoder =
        decoder(JOINT_STATE, &[texts("name"), texts("name[0]"), texts("{header.frame_id==\"base\"}.name")]);
    let mut revisions = |big_endian, names: &[&str]| {
        let mut encoder = Encoder::new(big_endian, false);
        joint_state(&mut encoder, (0, 0), names, [&[], &[], &[]]);
        let values = decoder.read(&encoder.done()).unwrap();
        assert_eq!(list(values, 0), names);
        assert_eq!(list(values, 1), &names[..1.min(names.len())]);
        assert_eq!(list(values, 2), names);
        [0, 1, 2].map(|index| values.texts(index).revision())
    };
    assert_eq!(revisions(false, &["a", "b"]), [1, 1, 1]);
    assert_eq!(revisions(false, &["a", "b"]), [1, 1, 1]);
    assert_eq!(revisions(true, &["a", "b"]), [1, 1, 1]);
    assert_eq!(revisions(true, &["a", "c"]), [2, 1, 2]);
    assert_eq!(revisions(true, &["a", "c", "d"]), [3, 1, 3]);
    assert_eq!(revisions(true, &["a", "c"]), [4, 1, 4]);
    assert_eq!(revisions(true, &[]), [5, 2, 5]);
}

#[test]
fn a_bad_message_does_not_spoil_the_next() {
    let mut decoder = decoder(JOINT_STATE, &[texts("name"), numbers("effort")]);
    let message = |names: &[&str]| {
        let mut encoder = Encoder::new(false, false);
        joint_state(&mut encoder, (0, 0), names, [&[], &[], &[1.0]]);
        encoder.done()
    };
    let (first, second) = (message(&["a"]), message(&["b"]));
    assert_eq!(list(decoder.read(&first).unwrap(), 0), ["a"]);
    // The names are read, the rest is missing.
    assert!(decoder.read(&second[..second.len() - 1]).is_err());
    assert_eq!(list(decoder.read(&second).unwrap(), 0), ["b"]);
    let values = decoder.read(&second).unwrap();
    assert_eq!((list(values, 0), values.numbers(1), values.texts(0).revision()), (vec!["b"], [1.0].as_slice(), 2));
}

#[test]
fn all_number_types_arrive_as_numbers() {
    let text = "bool a\nint8 b\nuint8 c\nint16 d\nuint16 e\nint32 f\nuint32 g\nint64 h\nuint64 i\nfloat32 j\nfloat64 k";
    let paths = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k"];
    let mut decoder = decoder(text, &paths.map(numbers));
    let mut encoder = Encoder::new(true, false);
    let bytes: [&[u8]; 11] = [
        &[7],
        &(-5i8).to_le_bytes(),
        &[200],
        &(-300i16).to_le_bytes(),
        &60_000u16.to_le_bytes(),
        &(-70_000i32).to_le_bytes(),
        &4_000_000_000u32.to_le_bytes(),
        &(-9_007_199_254_740_993i64).to_le_bytes(),
        &u64::MAX.to_le_bytes(),
        &0.1f32.to_le_bytes(),
        &0.1f64.to_le_bytes(),
    ];
    for bytes in bytes {
        encoder.scalar(bytes);
    }
    let values = decoder.read(&encoder.done()).unwrap();
    let read: Vec<f64> = (0..11).map(|index| values.number(index).unwrap()).collect();
    let nearest = [-9_007_199_254_740_992.0, 18_446_744_073_709_551_616.0];
    let expected = [1.0, -5.0, 200.0, -300.0, 60_000.0, -70_000.0, 4e9, nearest[0], nearest[1], f64::from(0.1f32), 0.1];
    assert_eq!(read, expected);
}

#[test]
fn filters_and_selections_work_on_arrays_of_messages() {
    let text = "\
T[] transforms
int32 last
===
MSG: demo/T
string child
int32 id
float64[] v
Time[<=2] stamps
===
MSG: demo/Time
builtin_interfaces/Time t
";
    let wanted = [
        numbers("transforms[:]{child==\"b\"}.v[:]"),
        numbers("transforms[:]{child!=\"b\"}.id"),
        numbers("transforms[1].v[-1]"),
        numbers("transforms[:].v[0]"),
        texts("transforms[-2:].child"),
        numbers("transforms[0]{id==7}{child==\"x\"}.id"),
        times("transforms[:].stamps[:].t"),
        numbers("transforms[:].stamps[0].t.sec"),
        numbers("last"),
        numbers("{last==-1}.last"),
        numbers("{last==1}.transforms[0].id"),
        numbers("transforms[:]{child==\"b\"}.v[:]"),
    ];
    let mut decoder = decoder(text, &wanted);
    for (big_endian, cdr2) in [(false, false), (true, false), (false, true)] {
        let mut encoder = Encoder::new(big_endian, cdr2);
        if cdr2 {
            encoder.u32(0);
        }
        encoder.count(3);
        for (child, id, v) in [("a", 7, &[1.0, 2.0][..]), ("b", 8, &[3.0, 4.0, 5.0]), ("c", 9, &[])] {
            encoder.text(child).u32(id).f64s(v);
            if cdr2 {
                encoder.u32(0);
            }
            encoder.count(1).u32(id).u32(5);
        }
        encoder.u32(u32::MAX);
        let values = decoder.read(&encoder.done()).unwrap();
        assert_eq!(values.numbers(0), [3.0, 4.0, 5.0]);
        assert_eq!(values.numbers(1), [7.0, 9.0]);
        assert_eq!(values.numbers(2), [5.0]);
        assert_eq!(values.numbers(3), [1.0, 3.0]);
        assert_eq!(list(values, 4), ["b", "c"]);
        assert_eq!(values.numbers(5), [0.0; 0]);
        assert_eq!(values.times_nanos(6), [7_000_000_005, 8_000_000_005, 9_000_000_005]);
        assert_eq!(values.numbers(7), [7.0, 8.0, 9.0]);
        assert_eq!(values.numbers(8), [-1.0]);
        assert_eq!(values.numbers(9), [-1.0]);
        assert_eq!(values.numbers(10), [0.0; 0]);
        assert_eq!(values.numbers(11), [3.0, 4.0, 5.0]);
        // What filters are tested on is nobody's field.
        assert!((12..20).all(|index| values.numbers(index).is_empty() && values.texts(index).is_empty()));
    }
}

#[test]
fn empty_messages_take_one_byte() {
    let mut decoder =
        decoder("E e\nuint8 x\nE[2] es\nuint8 y\n===\nMSG: demo/E\n# nothing", &[numbers("x"), numbers("y")]);
    let values = decoder.read(&[0, 1, 0, 0, 0xff, 5, 0xff, 0xff, 6]).unwrap();
    assert_eq!((values.number(0), values.number(1)), (Some(5.0), Some(6.0)));
}

#[test]
fn texts_need_no_final_nul_but_valid_utf8() {
    let mut decoder = decoder("string s\nuint8 x", &[texts("s"), numbers("x")]);
    let mut read = |bytes: &[u8]| {
        let message = [&[0, 1, 0, 0], bytes].concat();
        let values = decoder.read(&message)?;
        Ok::<_, DecodeError>((values.texts(0).get(0).unwrap().to_owned(), values.number(1)))
    };
    assert_eq!(read(&[0, 0, 0, 0, 9]), Ok((String::new(), Some(9.0))));
    assert_eq!(read(&[1, 0, 0, 0, 0, 9]), Ok((String::new(), Some(9.0))));
    assert_eq!(read(&[2, 0, 0, 0, b'h', b'i', 9]), Ok(("hi".to_owned(), Some(9.0))));
    let field = "s".to_owned();
    assert_eq!(read(&[2, 0, 0, 0, 0xff, 0, 9]), Err(DecodeError::Text { field, offset: 8 }));
}

#[test]
fn a_time_with_a_second_of_nanoseconds_is_refused() {
    let mut decoder = decoder("builtin_interfaces/Duration t", &[times("t")]);
    let mut read = |sec: i32, nanosec: u32| {
        let mut encoder = Encoder::new(false, false);
        encoder.u32(sec.cast_unsigned()).u32(nanosec);
        decoder.read(&encoder.done()).map(|values| values.time_nanos(0))
    };
    assert_eq!(read(i32::MIN, 0), Ok(Some(-2_147_483_648_000_000_000)));
    assert_eq!(read(i32::MAX, 999_999_999), Ok(Some(2_147_483_647_999_999_999)));
    assert!(matches!(read(0, 1_000_000_000), Err(DecodeError::TimeRange { .. })));
}

#[test]
fn texts_behind_a_filter_come_and_go() {
    let mut decoder = decoder("string id\nstring[] name", &[texts("{id==\"x\"}.name")]);
    let mut read = |id: &str| {
        let mut encoder = Encoder::new(false, false);
        encoder.text(id).texts(&["a", "b"]);
        let values = decoder.read(&encoder.done()).unwrap();
        (values.texts(0).len(), values.texts(0).revision())
    };
    assert_eq!([read("x"), read("x"), read("y"), read("y"), read("x")], [(2, 1), (2, 1), (0, 2), (0, 2), (2, 3)]);
}
