//! Bytes as a table, CSV or a log, and as the run of a manipulator.
#![no_main]

use std::fs;
use std::sync::LazyLock;

use fric_log::table::NumberTable;
use fric_tendon_lab::{Run, columns};
use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

static PLACE: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder for tables"));

fuzz_target!(|data: &[u8]| {
    let path = PLACE.path().join("table");
    fs::write(&path, data).expect("room for a table");
    let Ok(table) = NumberTable::read(&path, &columns::of_run(2)) else { return };
    let rows = table.columns[0].1.len();
    assert!(rows > 0 && table.columns.iter().all(|(_, numbers)| numbers.len() == rows));
    for (place, (name, _)) in table.columns.iter().enumerate() {
        assert!(table.columns[..place].iter().all(|(other, _)| other != name), "{name} twice");
    }
    let Ok(run) = Run::from_columns(&table.columns, 2) else { return };
    assert_eq!(run.samples().len(), rows);
    assert!(run.samples().windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
    assert!(!run.has_tension() || run.samples().iter().all(|sample| sample.tension_base_n >= 0.0));
});
