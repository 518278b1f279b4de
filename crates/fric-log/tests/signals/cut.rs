//! A log that was cut off.

use std::fs;

use fric_log::signals::LengthWindow;

use super::support::*;

#[test]
fn a_log_cut_in_half_gives_the_rows_of_its_half() {
    let names: Vec<String> = (0..8).map(|index| format!("cable{index}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut log = Log::default();
    for (index, time) in every(MS, S, 55_000).enumerate() {
        // Numbers that do not compress to nothing.
        let noise =
            |salt: usize| f64::from(u32::try_from((index * 8 + salt) * 2_654_435_761 % 1_000_003).unwrap()) / 7.0;
        let numbers: Vec<f64> = (0..8).map(noise).collect();
        log.add("/cables", JOINT_STATES, time, joints(time, &names, &numbers, &[], &numbers));
        if index % 4 == 0 {
            log.add("/pose", POSES, time, pose(time, [ms(time), 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]));
        }
    }
    let whole = log.file();
    let bytes = fs::read(whole.path()).unwrap();
    assert!((3_000_000..6_000_000).contains(&bytes.len()), "{}", bytes.len());
    let all = read(&whole, &PATHS, &names).rows;
    let half = read(&to_file(&bytes[..bytes.len() / 2]), &PATHS, &names);
    assert!(half.error.is_none() && !half.reader.log().warnings().is_empty());
    let count = half.rows.len();
    assert!((24_000..30_000).contains(&count), "{count}");
    for (row, whole) in half.rows.iter().zip(&all) {
        assert_eq!((row.stamp_nanos, &row.force_n), (whole.stamp_nanos, &whole.force_n));
    }
    // The speeds of the last rows have fewer lengths after them to go by.
    let determined = &half.rows[..count - LengthWindow::REACH];
    assert!(determined.iter().zip(&all).all(|(row, whole)| row.speed_m_per_s == whole.speed_m_per_s));
    // The last pose is at most three rows before the end.
    assert!(half.rows[..count - 4].iter().zip(&all).all(|(row, whole)| row.pose == whole.pose));
}
