//! CSV logs: what they look like, what is missing in them, and what is told of it.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use fric_core::robot::file::ColumnTable;
use fric_log::log::Log;
use fric_log::signals::{Role, SignalPaths, SignalReader};
use tempfile::TempDir;

/// A row: time in ns, force, length, speed, reference of the one cable, x of the pose.
type Row = (i64, f64, f64, f64, f64, Option<f64>);

struct Read {
    rows: Vec<Row>,
    error: Option<String>,
    warnings: Vec<String>,
    gap_count: u64,
}

impl Read {
    #[track_caller]
    fn is(&self, expected: &[Row]) {
        let plain = |row: &Row| format!("{row:?}");
        let (found, expected): (Vec<_>, Vec<_>) =
            (self.rows.iter().map(plain).collect(), expected.iter().map(plain).collect());
        assert_eq!(found, expected, "{:?}", self.error);
        assert!(self.error.is_none(), "{:?}", self.error);
    }

    #[track_caller]
    fn fails(&self, words: &[&str]) {
        let error = self.error.as_deref().unwrap();
        assert!(words.iter().all(|word| error.contains(word)), "{words:?} in {error}");
    }

    #[track_caller]
    fn warns(&self, words: &[&str]) {
        assert!(
            self.warnings.iter().any(|text| words.iter().all(|word| text.contains(word))),
            "{words:?} in {:?}",
            self.warnings
        );
    }
}

fn read_files(files: &[(&str, &[u8])], columns: &[(&str, ColumnTable)]) -> Read {
    let directory = TempDir::new().unwrap();
    let paths: Vec<PathBuf> = files.iter().map(|(name, _)| directory.path().join(name)).collect();
    for (path, (_, content)) in paths.iter().zip(files) {
        fs::write(path, content).unwrap();
    }
    let topics = SignalPaths::default()
        .with(Role::Cable, Some("/cables".parse().unwrap()))
        .with(Role::Reference, Some("/reference".parse().unwrap()))
        .with(Role::Pose, Some("/pose".parse().unwrap()))
        .with(Role::Wrench, Some("/wrench".parse().unwrap()));
    let columns: BTreeMap<String, ColumnTable> =
        columns.iter().map(|(key, table)| ((*key).to_owned(), table.clone())).collect();
    let mut read = Read { rows: Vec::new(), error: None, warnings: Vec::new(), gap_count: 0 };
    let log = match Log::open(&paths) {
        Ok(log) => log,
        Err(error) => {
            read.error = Some(fric_log::with_advice(&error));
            return read;
        }
    };
    let mut reader = SignalReader::new(log, topics.with_columns(columns), &["a"]);
    loop {
        match reader.next_row() {
            Ok(Some(row)) => {
                let cable = row.cables[0];
                read.rows.push((
                    row.stamp_nanos,
                    cable.sensor_force_n,
                    cable.length_m,
                    cable.speed_m_per_s,
                    row.reference_force_n[0],
                    row.pose.map(|pose| pose.position_m.x),
                ));
            }
            Ok(None) => break,
            Err(error) => {
                read.error = Some(fric_log::with_advice(&error));
                break;
            }
        }
    }
    read.warnings = reader.log().warnings();
    read.warnings.extend(reader.warnings());
    read.gap_count = reader.counts(Role::Cable).gap_count;
    read
}

fn read(text: &str) -> Read {
    read_files(&[("run.csv", text.as_bytes())], &[])
}

fn column(column: &str, factor: f64, offset: f64) -> ColumnTable {
    ColumnTable { column: column.to_owned(), factor, offset }
}

const NAN: f64 = f64::NAN;
const MS: i64 = 1_000_000;

/// The rows of all forms below.
const ROWS: [Row; 3] =
    [(0, 10.5, 0.25, 1.0, NAN, None), (MS, 11.0, 0.251, 1.0, NAN, None), (2 * MS, 11.5, 0.252, 1.0, NAN, None)];

#[test]
fn all_forms_give_the_same_rows() {
    for text in [
        "time_s,a.force_n,a.length_m,a.speed_m_per_s\n0,10.5,0.25,1\n0.001,11,0.251,1\n0.002,11.5,0.252,1\n",
        "time_s;a.force_n;a.length_m;a.speed_m_per_s\r\n0;10,5;0,25;1\r\n0,001;11;0,251;1\r\n0,002;11,5;0,252;1\r\n",
        "\u{feff}time_s\ta.force_n\ta.length_m\ta.speed_m_per_s\n0\t10.5\t0.25\t1\n1e-3\t11\t0.251\t1.0\n0.002\t11.5\t0.252\t1\n",
        "# a, rig; of the lab\n\"time_s\", \"a.length_m\" ,a.speed_m_per_s,note,a.force_n\n\n0,0.25,1,start,10.5\n\
         # here the door was opened\n0.001,0.251,1,,11\n\"0.002\",0.252,1,\"end, at last\",11.5\n",
        "sep=;\ntime_s;a.force_n;a.length_m;a.speed_m_per_s\n0;10.5;0.25;1\n0.001;11;0.251;1\n0.002;11.5;0.252;1\n",
        "time_s  a.force_n\ta.length_m a.speed_m_per_s\n  0 10.5   0.25 1  \n0.001 11\t0.251 1.0\n0.002 11.5 0.252 1\n",
        "# time_s a.force_n a.length_m a.speed_m_per_s\n0.000e+00 1.05e+01 2.5e-01 1e0\n1e-3 11 0.251 1\n2e-3 11.5 0.252 1\n",
        "# time_s,a.force_n,a.length_m,a.speed_m_per_s\n0,10.5,0.25,1\n0.001,11,0.251,1\n0.002,11.5,0.252,1\n",
    ] {
        read(text).is(&ROWS);
        // Whatever the file is called.
        read_files(&[("run.txt", text.as_bytes())], &[]).is(&ROWS);
    }
}

#[test]
fn other_names_units_and_signs_are_said_once() {
    let text = "Zeit [ms];Kraft [kg];\"gewickelt; mm\"\n0;-1,0;250\n1;-1,5;249\n2;-2;248\n";
    let columns = [
        ("time_s", column("Zeit [ms]", 0.001, 0.0)),
        ("a.force_n", column("Kraft [kg]", -10.0, 0.5)),
        ("a.length_m", column("gewickelt; mm", -0.001, 0.5)),
    ];
    let rows = read_files(&[("run.csv", text.as_bytes())], &columns).rows;
    for (row, (time, force_n, length_m)) in rows.iter().zip([(0, 10.5, 0.25), (MS, 15.5, 0.251), (2 * MS, 20.5, 0.252)])
    {
        assert_eq!(row.0, time);
        // The speed that is not there is derived.
        for (found, expected) in [(row.1, force_n), (row.2, length_m), (row.3, 1.0)] {
            assert!((found - expected).abs() < 1e-9, "{row:?}");
        }
    }
    assert_eq!(rows.len(), 3);
    // A header in Latin-1, as spreadsheets write it.
    let latin = b"time_s;F\xfc;L\xe4nge\n0;1;2\n";
    let columns = [("a.force_n", column("F\u{fc}", 1.0, 0.0)), ("a.length_m", column("L\u{e4}nge", 1.0, 0.0))];
    assert_eq!(read_files(&[("run.csv", latin)], &columns).rows.len(), 1);
    // Nanoseconds since 1970, which a double cannot hold.
    let text = "t,a.force_n,a.length_m\n1700000000123456789,1,2\n1700000000124456789,1,2\n";
    let rows = read_files(&[("run.csv", text.as_bytes())], &[("time_s", column("t", 1e-9, 0.0))]).rows;
    assert_eq!(
        rows.iter().map(|row| row.0).collect::<Vec<_>>(),
        [1_700_000_000_123_456_789, 1_700_000_000_124_456_789]
    );
}

#[test]
fn empty_cells_are_gaps_of_their_signal() {
    let mut text =
        "time_s,a.force_n,a.length_m,a.reference_n,pose.x_m,pose.y_m,pose.z_m,pose.qx,pose.qy,pose.qz,pose.qw\n"
            .to_owned();
    for at in 0..40_usize {
        let pose = if at % 4 == 0 { format!("{at},0,0,0,0,0,1") } else { ",,,,,,".to_owned() };
        let without = ["nan", "NA", "#N/A", "null", "n.v.", "-", "---", "-1.#IND"][at / 2 % 8];
        let reference = if at % 2 == 0 { at.to_string() } else { without.to_owned() };
        let force = if at == 5 { String::new() } else { at.to_string() };
        let length = if at == 5 { String::new() } else { "0.5".to_owned() };
        let length = if at == 7 { "NaN".to_owned() } else { length };
        text += &format!("0.{at:03},{force},{length},{reference},{pose}\n");
    }
    let Read { rows, error, warnings, .. } = read(&text);
    assert!(error.is_none() && warnings.is_empty(), "{error:?} {warnings:?}");
    // A row without force and length is none of the cable; pose and reference are interpolated as between messages.
    assert_eq!(rows.len(), 39);
    let row = |at: i64| rows.iter().find(|row| row.0 == at * MS).unwrap();
    assert_eq!((row(6).1, row(6).4, row(6).5), (6.0, 6.0, Some(6.0)));
    assert_eq!((row(9).4, row(9).5), (9.0, Some(9.0)));
    assert!(row(7).2.is_nan() && row(39).5.is_none() && row(39).4.is_nan());
    // A pause of the cable's is a gap.
    let rows: String = (0..40).filter(|at| !(10..30).contains(at)).map(|at| format!("0.{at:03},1,2\n")).collect();
    let read = read(&format!("time_s,a.force_n,a.length_m\n{rows}"));
    assert_eq!((read.rows.len(), read.gap_count), (20, 1));
    read.warns(&["a.force_n", "1 gap"]);
}

#[test]
fn what_cannot_be_used_is_told_with_its_place() {
    let header = "time_s,a.force_n,a.length_m\n";
    read(&format!("{header}0,1,2\n0.001,1\n0.002,1,2,3\n0.003,1,2\n"))
        .warns(&["2 rows are left out", "line 3 has 2 cells under a header of 3"]);
    read(&format!("{header}0,1,2\n,1,2\n0.002,1,2\n")).warns(&["1 row is left out", "line 3 has no time", "`time_s`"]);
    read(&format!("{header}0,1,2\n0.001,ERR,2\n"))
        .fails(&["run.csv`, line 3, column `a.force_n`: `ERR` is no number", "leave the cell empty"]);
    read("time_s;a.force_n;a.length_m\n0;1.5;2\n1;1,234;2\n").fails(&["line 3", "`1,234` is no number", "thousands"]);
    read(header).fails(&["run.csv` has no whole row of numbers", "record again"]);
    read(&format!("{header}0,1,2")).fails(&["no whole row"]);
    read("# nothing\n").fails(&["no whole row"]);
    read(&format!("{header}0,,\n1,,nan\n")).fails(&["no row has a number"]);
    read(&format!("{header}0,1\n1,1\n")).fails(&["no row that can be used", "line 2 has 2 cells under a header of 3"]);
    for separator in [",", ";", "\t", "  "] {
        read(&"0,1,2\n0.001,1,2\n".replace(',', separator)).fails(&["line 1", "numbers where the names", "Put a line"]);
    }
    read("time force length\n0 1\n0.1 1 2 3\n")
        .fails(&["one column alone, `time force length`", "as many in each row"]);
    let dated = read_files(
        &[("run.csv", b"Zeit [ms];a.force_n;a.length_m\n03.05.2026 12:34:56;1;2\n")],
        &[("time_s", column("Zeit [ms]", 1e-3, 0.0))],
    );
    dated.fails(&["line 2, column `Zeit [ms]`: `03.05.2026 12:34:56` is a date", "takes no factor", "remove"]);
    read("time_s,a.force_n,a.force_n,a.length_m\n0,1,1,2\n").fails(&["`a.force_n` stands there twice"]);
    let cut = read(&format!("{header}0,1,2\n0.001,1,2\n0.002,1,2.1"));
    assert_eq!(cut.rows.len(), 2);
    cut.warns(&["run.csv` is cut off", "last line"]);
    let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain("t,a\n".bytes().flat_map(|byte| [byte, 0])).collect();
    read_files(&[("run.csv", &utf16)], &[]).fails(&["UTF-16", "UTF-8"]);
}

#[test]
fn columns_that_are_missing_are_named_beside_those_there_are() {
    let text = "t,Force a,a.length_m\n0,1,2\n";
    read(text).fails(&["has no column `time_s`; it has `t`, `Force a`, `a.length_m`", "[log.columns]"]);
    let time = ("time_s", column("t", 1.0, 0.0));
    read_files(&[("run.csv", text.as_bytes())], std::slice::from_ref(&time))
        .fails(&["no column `a.force_n`; it has", "`Force a`"]);
    let force = ("a.force_n", column("Force A", 1.0, 0.0));
    read_files(&[("run.csv", text.as_bytes())], &[time, force]).fails(&[
        "no column `Force A`, which the robot file names for `a.force_n`",
        "did you mean `Force a`? it has `t`, ",
    ]);
    read("time_s,a.force_n,a.length_m,pose.x_m,pose.y_m\n0,1,2,3,4\n").warns(&["no column `pose.z_m`"]);
}

/// Columns whose names have another unit than the signal.
#[test]
fn units_in_names_that_no_factor_applies_are_told() {
    let text = "Zeit [ms],F_Winde/kN,l (mm),v [m/s]\n12:00:00.1,1.5,200,0.1\n12:00:00.2,1.5,201,0.1\n";
    let columns = |factor| {
        [
            ("time_s", column("Zeit [ms]", 1.0, 0.0)),
            ("a.force_n", column("F_Winde/kN", factor, 0.0)),
            ("a.length_m", column("l (mm)", 1.0, 0.0)),
            ("a.speed_m_per_s", column("v [m/s]", 1.0, 0.0)),
        ]
    };
    read_files(&[("run.csv", text.as_bytes())], &columns(1.0))
        .warns(&["by the header `F_Winde/kN` is in kN, `l (mm)` is in mm, which is not applied"]);
    let told = read_files(&[("run.csv", text.as_bytes())], &columns(1e3));
    told.warns(&["by the header `l (mm)` is in mm, which"]);
}

#[test]
fn times_that_go_backwards_are_told_as_of_messages() {
    let header = "time_s,a.force_n,a.length_m\n";
    let rows = |times: &[i32]| times.iter().map(|at| format!("{at},1,2\n")).collect::<String>();
    read(&format!("{header}{}", rows(&[0, 1, 2, 3, 2, 4, 5, 5, 6])))
        .warns(&["1 late", "1 message with a stamp used before"]);
    let back: Vec<i32> = (100..130).chain(0..30).collect();
    let read = read(&format!("{header}{}", rows(&back)));
    read.warns(&["1 clock step backwards"]);
    assert_eq!(read.rows.len(), 60);
}

#[test]
fn values_that_look_like_another_unit_are_warned_of() {
    let text = |force: &str, length: &str, speed: &str| {
        format!(
            "time_s,a.force_n,a.length_m,a.speed_m_per_s\n0,{force},{length},{speed}\n0.001,{force},{length},{speed}\n"
        )
    };
    assert!(read(&text("20", "1.5", "0.3")).warnings.is_empty());
    read(&text("5000", "1.5", "0.3")).warns(&["forces are on average 5000", "grams", "factor = 0.00980665"]);
    read(&text("20", "800", "0.3")).warns(&["lengths are up to 800", "millimetres", "factor = 0.001"]);
    read(&text("20", "1.5", "300")).warns(&["speeds are up to 300", "millimetres a second"]);
    read(&text("0.02", "1.5", "0.3")).warns(&["forces are at most 0.02", "kilonewtons"]);
    // Only the columns that look so are named.
    let two = "time_s,a.force_n,a.length_m,a.reference_n\n0,5000,1.5,9\n0.001,5000,1.5,9\n";
    read(two).warns(&["in `a.force_n` forces are on average 5000", "grams"]);
    let three = "time_s,a.force_n,a.length_m,a.reference_n\n0,0.05,1.5,9\n0.001,0.05,1.5,9\n";
    assert!(read(three).warnings.is_empty(), "a slack cable");
}

/// A winch of a kite pays out 300 m, and the forces of a mast are those of a lorry.
#[test]
fn great_values_that_another_measure_confirms_are_no_other_unit() {
    let text = |force: f64, reference: f64, size: f64, speed: f64| {
        let row = |row: i32| {
            let angle = 0.005 * f64::from(row);
            let (length_m, speed_m_per_s) = (size * (1.0 + 0.5 * angle.sin()), speed * size * 0.025 * angle.cos());
            let ripple = 1.0 + 0.2 * angle.sin();
            format!(
                "{:.1},{},{length_m},{speed_m_per_s},{}\n",
                0.1 * f64::from(row),
                force * ripple,
                reference * ripple
            )
        };
        let rows: String = (0..300).map(row).collect();
        format!("time_s,a.force_n,a.length_m,a.speed_m_per_s,a.reference_n\n{rows}")
    };
    let units = |text: &str, columns: &[(&str, ColumnTable)]| -> Vec<String> {
        let mut warnings = read_files(&[("run.csv", text.as_bytes())], columns).warnings;
        warnings.retain(|warning| warning.contains("looks like"));
        warnings
    };
    assert_eq!(units(&text(30_000.0, 29_000.0, 250.0, 1.0), &[]), [""; 0]);
    // A speed that contradicts, or that no winch has, confirms nothing; nor does a force of another size.
    for (text, words) in [
        (text(20.0, 20.0, 250.0, 1e-3), "lengths are up to"),
        (text(20.0, 20.0, 2500.0, 1.0), "lengths are up to"),
        (text(30_000.0, 30.0, 1.0, 1.0), "in `a.force_n` forces are on average"),
        (text(0.05, 0.05, 1.0, 1.0), "forces are at most"),
    ] {
        assert!(units(&text, &[]).iter().any(|warning| warning.contains(words)), "{words}: {:?}", units(&text, &[]));
    }
    // An offset says nothing about the unit.
    let force = |key, name| (key, column(name, 1.0, 30_000.0));
    let columns = [force("a.force_n", "a.force_n")];
    assert_eq!(units(&text(300.0, 300.0, 1.0, 1.0), &columns), [""; 0]);
}

#[test]
fn lines_without_end_are_refused() {
    let names: String = (0..60_000).map(|column| format!(",c{column}")).collect();
    let wide = format!("time_s{names}\n{}\n", vec!["1"; 60_001].join(","));
    read(&wide).fails(&["names of the columns has more than 256 KiB"]);
    let row = format!("time_s,a.force_n,a.length_m\n0,1,2\n0.001,1,2\n0.002,{}1\n", "1,".repeat(3 << 20));
    read(&row).fails(&["a line of more than 4 MiB"]);
}

/// A file system leaves zeros where the power failed.
#[test]
fn zeros_behind_the_rows_are_no_table() {
    let rows: String = (0..50).map(|at| format!("0.{at:03},1,2\n")).collect();
    let read = read(&format!("time_s,a.force_n,a.length_m\n{rows}0.05{}", "\0".repeat(4096)));
    assert_eq!(read.rows.len(), 50);
    read.warns(&["is cut off"]);
}

#[test]
fn a_time_with_too_few_digits_is_no_slow_clock() {
    let rows =
        |count: u32| -> String { (0..count).map(|row| format!("{},1,{}\n", 1_700_000_000 + row / 4, row)).collect() };
    let read = read(&format!("time_s,a.force_n,a.length_m\n{}", rows(12)));
    read.warns(&["9 of 12 rows have the time of the row before", "too few digits"]);
    assert!(read.warnings.iter().all(|text| !text.contains("milliseconds")), "{:?}", read.warnings);
}

#[test]
fn several_files_are_parts_of_one_log_and_no_other_kind_stands_among_them() {
    let header = "time_s,a.force_n,a.length_m\n";
    let (late, early) = (format!("{header}2,1,2\n3,1,2\n"), "a.length_m,time_s,a.force_n\n2,0,1\n2,1,1\n");
    let read = read_files(&[("late.csv", late.as_bytes()), ("early.csv", early.as_bytes())], &[]);
    assert_eq!(read.rows.iter().map(|row| row.0 / 1_000_000_000).collect::<Vec<_>>(), [0, 1, 2, 3]);
    // Nothing but the slow time is told.
    assert!(read.warnings.iter().all(|text| text.contains("from row to row")), "{:?}", read.warnings);
    read_files(&[("run.csv", late.as_bytes()), ("run.mcap", b"\x89MCAP0\r\n")], &[]).fails(&[
        "run.csv` is CSV",
        "run.mcap` is not",
        "of one kind",
    ]);
}
