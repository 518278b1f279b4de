//! Faults of the recording that are corrected before model and log are compared: `replay --correct`, and `fit` by itself.

use std::sync::OnceLock;

use serde_json::Value;

use super::discover::two_cables;
use super::logs::with_data;
use super::support::{Place, Run};

/// A log of two cables by the model that it is replayed with.
fn clean() -> &'static [u8] {
    static LOG: OnceLock<Vec<u8>> = OnceLock::new();
    LOG.get_or_init(|| {
        let place = Place::empty();
        place.write("robot.toml", two_cables());
        let options = ["-o", "log.mcap", "--duration", "25", "--seed", "5"];
        place.run(&[&["simulate", "--model", "robot.toml"], &options[..]].concat()).succeeds();
        place.read("log.mcap")
    })
}

/// The log with other stamps of the reference: nanoseconds since the first one to nanoseconds since the first one.
fn restamped(stamp_nanos: impl Fn(i64) -> i64) -> Vec<u8> {
    let number = |data: &[u8], at: usize| i64::from(u32::from_le_bytes(data[at..at + 4].try_into().unwrap()));
    let stamp_of = |data: &[u8]| number(data, 4) * 1_000_000_000 + number(data, 8);
    let first = std::cell::OnceCell::new();
    with_data(clean(), "/reference_forces", |data| {
        let first = *first.get_or_init(|| stamp_of(data));
        let stamp = first + stamp_nanos(stamp_of(data) - first);
        let parts = [stamp.div_euclid(1_000_000_000), stamp.rem_euclid(1_000_000_000)];
        let mut data = data.to_vec();
        for (part, at) in parts.into_iter().zip([4, 8]) {
            data[at..at + 4].copy_from_slice(&u32::try_from(part).unwrap().to_le_bytes());
        }
        data
    })
}

fn replay(log: &[u8], options: &[&str]) -> (Run, Value, Place) {
    let place = Place::empty();
    place.write("log.mcap", log);
    let run = place.run(&[&["replay", "log.mcap", "--json", "result.json"], options].concat()).succeeds();
    let result = place.json("result.json");
    (run, result, place)
}

fn cables(result: &Value) -> &[Value] {
    result["cables"].as_array().unwrap()
}

fn after_n(cable: &Value) -> f64 {
    cable["after"]["rms_n"].as_f64().unwrap()
}

/// The only fault of a cable.
#[track_caller]
fn fault<'a>(cable: &'a Value, kind: &str) -> &'a Value {
    let [fault] = cable["faults"].as_array().unwrap().as_slice() else { panic!("not one fault: {cable}") };
    assert!(fault["kind"] == kind && fault["intervals_s"].as_array().unwrap().is_empty(), "{fault}");
    &fault["parameters"]
}

#[test]
fn nothing_is_said_of_a_clean_log_and_no_figure_changes() {
    let [(run, plain, _), (corrected_run, corrected, _)] =
        [&[][..], &["--correct"]].map(|options| replay(clean(), options));
    assert_eq!(plain["cables"], corrected["cables"]);
    let without_times = |run: &Run| run.stdout.lines().filter(|line| !line.contains("one takes")).collect::<String>();
    assert_eq!(without_times(&run), without_times(&corrected_run));
}

#[test]
fn a_late_reference_is_put_where_it_belongs() {
    let late = restamped(|nanos| nanos + 20_000_000);
    let (_, clean, _) = replay(clean(), &[]);
    let (_, plain, _) = replay(&late, &[]);
    let (run, corrected, place) = replay(&late, &["--correct", "--report", "report.html", "-o", "out.mcap"]);
    let page = String::from_utf8(place.read("report.html")).unwrap();
    for ((clean, plain), corrected) in cables(&clean).iter().zip(cables(&plain)).zip(cables(&corrected)) {
        assert!(plain.get("faults").is_none(), "{plain}");
        let delay_s = fault(corrected, "reference_delay")["delay_s"].as_f64().unwrap();
        assert!((delay_s / 20e-3 - 1.0).abs() < 0.05, "{corrected}");
        assert!(after_n(plain) > 1.5 * after_n(clean), "{plain} {clean}");
        assert!(after_n(corrected) < 1.05 * after_n(clean), "{corrected} {clean}");
        let told = format!("{}, recording: the reference comes late by", corrected["name"].as_str().unwrap());
        assert!(run.stdout.contains(&told), "{run:#?}");
    }
    assert!(page.contains("Faults of the recording") && page.contains("the reference comes late by"));
}

/// As from a computer of its own: every time counts as well as a few milliseconds, and without `--correct` it is told too.
#[test]
fn a_reference_that_is_seconds_late_is_told_and_found() {
    let late = restamped(|nanos| nanos + 8_000_000_000);
    let place = Place::empty();
    place.write("log.mcap", &late);
    let warned =
        "the references of winch and other agree with the sensors' forces only if they are taken for 8.00 s earlier";
    place.run(&["replay", "log.mcap"]).warns(&[warned, "--correct"]);
    let (_, clean, _) = replay(clean(), &[]);
    let (_, corrected, _) = replay(&late, &["--correct"]);
    for (clean, corrected) in cables(&clean).iter().zip(cables(&corrected)) {
        let delay_s = fault(corrected, "reference_delay")["delay_s"].as_f64().unwrap();
        assert!((delay_s - 8.0).abs() < 1e-3, "{corrected}");
        assert!(after_n(corrected) < 1.05 * after_n(clean), "{corrected} {clean}");
    }
}

#[test]
fn a_reference_by_another_clock_is_put_where_it_belongs() {
    let (_, clean, _) = replay(clean(), &[]);
    // Later and later, by 2 ms each second.
    let (_, corrected, _) = replay(&restamped(|nanos| nanos + nanos / 500), &["--correct"]);
    for (clean, corrected) in cables(&clean).iter().zip(cables(&corrected)) {
        let skew = fault(corrected, "clock_skew")["skew_ratio"].as_f64().unwrap();
        assert!((skew / -2e-3 - 1.0).abs() < 0.05, "{corrected}");
        // Between two samples of the reference its noise is less.
        assert!(after_n(corrected) < 1.05 * after_n(clean), "{corrected} {clean}");
    }
}

#[test]
fn a_fit_corrects_by_itself_and_says_so() {
    let fit = |log: &[u8]| {
        let place = Place::empty();
        place.write("log.mcap", log);
        let run = place.run(&["fit", "log.mcap", "-o", "fitted.toml", "--json", "result.json"]).succeeds();
        (run, place.json("result.json"))
    };
    let (run, clean) = fit(clean());
    assert!(!run.stdout.contains("recording") && cables(&clean).iter().all(|cable| cable.get("faults").is_none()));
    // Friction fitted to a reference that is 120 ms late is far off.
    for late_ms in [20_u32, 120, 8000] {
        let (run, late) = fit(&restamped(|nanos| nanos + i64::from(late_ms) * 1_000_000));
        assert!(run.stdout.contains("recording: the reference comes late by"), "{run:#?}");
        for (clean, late) in cables(&clean).iter().zip(cables(&late)) {
            let delay_s = fault(late, "reference_delay")["delay_s"].as_f64().unwrap();
            assert!((delay_s * 1e3 / f64::from(late_ms) - 1.0).abs() < 0.05, "{late}");
            for (key, ratio) in [("mu", 0.01), ("sigma_n_per_m", 0.05)] {
                let [clean, late] = [clean, late].map(|cable| cable["parameters"][key].as_f64().unwrap());
                assert!((late / clean - 1.0).abs() < ratio, "{key}: {late} {clean}");
            }
            assert!(after_n(late) < 1.05 * after_n(clean), "{late} {clean}");
        }
    }
}
