//! Tables of numbers from CSV and from logs.

use std::collections::BTreeMap;
use std::path::PathBuf;

use fric_log::table::NumberTable;
use fric_log::with_advice;
use fric_log::write::LogWriter;
use tempfile::TempDir;

fn wanted() -> Vec<String> {
    ["time_s", "force_n", "shift_1_nm"].map(ToOwned::to_owned).to_vec()
}

struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn csv(&self, text: impl AsRef<[u8]>) -> Result<NumberTable, String> {
        std::fs::write(self.path("t.csv"), text).unwrap();
        NumberTable::read(&self.path("t.csv"), &wanted()).map_err(|error| with_advice(&error))
    }

    /// A log with JSON messages, each with its topic and log time in seconds.
    fn json(&self, messages: &[(&str, u64, &str)]) -> Result<NumberTable, String> {
        self.json_of(&messages.iter().map(|(topic, time_s, text)| (*topic, "", *time_s, *text)).collect::<Vec<_>>())
    }

    /// The same with the node in each message's channel.
    fn json_of(&self, messages: &[(&str, &str, u64, &str)]) -> Result<NumberTable, String> {
        let file = std::fs::File::create(self.path("t.mcap")).unwrap();
        let mut writer = mcap::Writer::new(std::io::BufWriter::new(file)).unwrap();
        for (place, (topic, node, time_s, text)) in messages.iter().enumerate() {
            let metadata = BTreeMap::from([("node".to_owned(), (*node).to_owned())]);
            let channel = writer.add_channel(0, topic, "json", &metadata).unwrap();
            let nanos = time_s * 1_000_000_000;
            let sequence = u32::try_from(place).unwrap();
            let header =
                mcap::records::MessageHeader { channel_id: channel, sequence, log_time: nanos, publish_time: nanos };
            writer.write_to_known_channel(&header, text.as_bytes()).unwrap();
        }
        writer.finish().unwrap();
        NumberTable::read(&self.path("t.mcap"), &wanted()).map_err(|error| with_advice(&error))
    }
}

#[test]
fn text_is_read_as_it_stands() {
    let place = Place::new();
    let table = place.csv("\u{feff}time_s, b\r\n0.1, 1e-3\r\n0.2,\r\n0.3,nan\r\n").unwrap();
    let [(first, times), (second, numbers)] = &table.columns[..] else { panic!("{table:?}") };
    assert_eq!((first.as_str(), second.as_str(), &times[..]), ("time_s", "b", &[0.1, 0.2, 0.3][..]));
    assert!((numbers[0] - 1e-3).abs() < 1e-18 && numbers[1].is_nan() && numbers[2].is_nan());
    let with_commas = place.csv("# measured on a bench\nsep=;\ntime_s;b\n0,1;1e-3\n0,2;\n0,3;nan\n").unwrap();
    assert_eq!(format!("{with_commas:?}"), format!("{table:?}"));
}

#[test]
fn text_that_is_no_table_is_told() {
    let place = Place::new();
    let said = |text: &str| {
        let sentence = place.csv(text).unwrap_err();
        sentence.rsplit_once("t.csv").unwrap().1.to_owned()
    };
    assert_eq!(said(""), " has no row of numbers below its header. Record again.");
    assert_eq!(said("a,b\n"), " has no row of numbers below its header. Record again.");
    let no_header =
        ", line 1: there are numbers where the names of the columns should be. Put a line with the names in front.";
    assert_eq!(said("1,2\n3,4\n"), no_header);
    assert!(said("a;b\n1,5;2\n1.5;2\n").starts_with(", line 3, column `a`: `1.5` is no number. "));
    assert_eq!(said("a,b,a\n1,2,3\n"), ": column `a` stands there twice. Take one of the two out.");
    assert_eq!(said("a,b\n1,2\n1,2,3\n"), ", line 3: 3 cells under a header of 2. Complete the row or take it out.");
    assert!(said("a,b\n1,2\n1,two\n").starts_with(", line 3, column `b`: `two` is no number. "));
    assert!(place.csv(b"a,b\n1,\xff\n").unwrap_err().contains("is neither CSV nor MCAP: line 2"));
    let missing = with_advice(&NumberTable::read(&place.path("none.csv"), &wanted()).unwrap_err());
    assert!(missing.contains("none.csv") && missing.ends_with(". Check the path."), "{missing}");
}

#[test]
fn a_last_line_that_is_cut_off_is_left_out_and_told() {
    let place = Place::new();
    let whole = place.csv("a,b\n1,2\n3,4\n").unwrap();
    assert_eq!(whole.warnings, [""; 0]);
    // Within a cell, behind a comma, within the last number, which then looks like a number.
    for rest in ["5", "5,", "5,6", "5,6e", "\"5", "x", "5,6,7"] {
        for end in ["\n", "\r\n"] {
            let lines = format!("a,b\n1,2\n3,4\n{rest}").replace('\n', end);
            let cut = place.csv(lines).unwrap();
            assert_eq!(cut.columns, whole.columns, "{rest}");
            let [warning] = &cut.warnings[..] else { panic!("{cut:?}") };
            assert!(warning.contains("t.csv` is cut off: its last line has no line end and is left out"), "{warning}");
        }
    }
    // Blanks are no row.
    assert_eq!(place.csv("a,b\n1,2\n3,4\n  ").unwrap(), whole);
    // Damage elsewhere stays an error.
    assert!(place.csv("a,b\n1,2\n3\n5,").unwrap_err().contains("line 3: 1 cells"));
}

#[test]
fn a_table_of_one_line_that_is_cut_off_says_what_is_missing() {
    for text in ["a,b\n1,2", "a,b\r\n1,"] {
        let sentence = Place::new().csv(text).unwrap_err();
        assert!(sentence.contains("t.csv has no whole row of numbers below its header: "), "{sentence}");
        assert!(sentence.ends_with(". If that line is whole, put a line end behind it."), "{sentence}");
    }
}

#[test]
fn a_log_gives_the_same_table() {
    let place = Place::new();
    let path = place.path("t.mcap");
    let mut writer = LogWriter::create(&path, &[] as &[&str], false).unwrap();
    let fields = ["force_n", "shift_1_nm", "other"].map(ToOwned::to_owned);
    let channel = writer.add_numbers("/run", "fric_msgs/msg/TendonRun", &fields).unwrap();
    for (stamp_nanos, force_n) in [(2_000_000_000, 1.5), (2_250_000_000, f64::NAN)] {
        writer.write_numbers(&channel, stamp_nanos, &[force_n, 0.25, 7.0]).unwrap();
    }
    assert!(writer.write_numbers(&channel, 0, &[1.0]).is_err());
    writer.finish().unwrap();
    let table = NumberTable::read(&path, &wanted()).unwrap();
    let names: Vec<&str> = table.columns.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["time_s", "force_n", "shift_1_nm"]);
    assert_eq!((&table.columns[0].1[..], &table.columns[2].1[..]), (&[0.0, 0.25][..], &[0.25, 0.25][..]));
    assert!((table.columns[1].1[0] - 1.5).abs() < 1e-15 && table.columns[1].1[1].is_nan());

    let mut writer = LogWriter::create(&place.path("u.mcap"), &[] as &[&str], false).unwrap();
    assert!(writer.add_numbers("/run", "a/msg/B", &["Bad Name".to_owned()]).is_err());
}

#[test]
fn messages_without_a_schema_are_asked_themselves() {
    let place = Place::new();
    let table = place
        .json(&[
            ("/log", 1, r#"{"text": "started"}"#),
            ("/run", 2, r#"{"time_s": 5.5, "force_n": 1.0}"#),
            ("/run", 3, r#"{"time_s": 5.6, "force_n": null}"#),
            ("/run", 4, r#"{"time_s": 5.7}"#),
        ])
        .unwrap();
    assert_eq!(table.columns[0], ("time_s".to_owned(), vec![5.5, 5.6]));
    assert!(table.columns[1].1[1].is_nan() && table.columns.len() == 2);
    assert!(table.warnings[0].starts_with("topic `/run`: 1 messages cannot be used; the first: "), "{table:?}");

    let none = place.json(&[("/log", 1, r#"{"text": "started"}"#)]).unwrap_err();
    assert!(none.contains("no topic has messages with a field `time_s`") && none.contains("/log"), "{none}");
    let two = place.json(&[("/a", 1, r#"{"force_n": 1}"#), ("/b", 1, r#"{"force_n": 1}"#)]).unwrap_err();
    assert!(two.contains("several topics (/a, /b)"), "{two}");
}

#[test]
fn a_topic_on_several_channels_is_one() {
    let place = Place::new();
    let table = place
        .json_of(&[
            ("/run", "first", 1, r#"{"force_n": 1}"#),
            ("/run", "second", 2, r#"{"force_n": 2, "shift_1_nm": 0.5}"#),
            ("/run", "third", 3, r#"{"text": "stopped"}"#),
            ("/run", "first", 4, r#"{"force_n": 3}"#),
        ])
        .unwrap();
    let [(_, times_s), (force, forces_n), (shift, shifts_nm)] = &table.columns[..] else { panic!("{table:?}") };
    assert_eq!((force.as_str(), shift.as_str()), ("force_n", "shift_1_nm"));
    assert_eq!((&times_s[..], &forces_n[..]), (&[0.0, 1.0, 3.0][..], &[1.0, 2.0, 3.0][..]));
    assert!(shifts_nm[0].is_nan() && shifts_nm[1].to_bits() == 0.5_f64.to_bits() && shifts_nm[2].is_nan());
    assert_eq!(table.warnings, [""; 0]);
}

#[test]
fn a_log_without_a_usable_message_says_why() {
    let place = Place::new();
    let mut writer = LogWriter::create(&place.path("t.mcap"), &[] as &[&str], false).unwrap();
    let channel = writer.add_numbers("/run", "fric_msgs/msg/TendonRun", &["force_n".to_owned()]).unwrap();
    writer.write_numbers(&channel, 1_000_000_000, &[1.0]).unwrap();
    writer.finish().unwrap();
    let whole = std::fs::read(place.path("t.mcap")).unwrap();
    // Without its end: what is damaged is said beside what is missing.
    std::fs::write(place.path("cut.mcap"), &whole[..60]).unwrap();
    let sentence = with_advice(&NumberTable::read(&place.path("cut.mcap"), &wanted()).unwrap_err());
    assert!(sentence.contains("(topics: none; `") && sentence.contains("cut off"), "{sentence}");

    let file = std::fs::File::create(place.path("t.mcap")).unwrap();
    let mut writer = mcap::Writer::new(std::io::BufWriter::new(file)).unwrap();
    let schema = writer.add_schema("demo/Force", "ros2msg", b"float64 force_n").unwrap();
    let channel_id = writer.add_channel(schema, "/run", "cdr", &BTreeMap::new()).unwrap();
    let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 1, publish_time: 1 };
    writer.write_to_known_channel(&header, &[0, 1, 0, 0, 0]).unwrap();
    writer.finish().unwrap();
    let sentence = with_advice(&NumberTable::read(&place.path("t.mcap"), &wanted()).unwrap_err());
    assert!(
        sentence.contains("no message on `/run` can be used (") && sentence.ends_with(". Record again."),
        "{sentence}"
    );
}
