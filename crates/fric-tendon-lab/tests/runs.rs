//! Runs as columns: what is refused, and gratings that have died.

use fric_tendon::file::ManipulatorFile;
use fric_tendon::{ManipulatorOptions, ManipulatorParams, TendonOptions};
use fric_tendon_lab::comparison::compare;
use fric_tendon_lab::fbg::Calibration;
use fric_tendon_lab::gratings::Gratings;
use fric_tendon_lab::guard::Guarded;
use fric_tendon_lab::result::FrictionResult;
use fric_tendon_lab::shape_errors::{Way, shapes};
use fric_tendon_lab::simulate::{Experiment, SimulatedRun, TendonSimulationOptions, simulate};
use fric_tendon_lab::{ContinuumError, Run, RunSample, hole_loads, load_steps};

type Columns = Vec<(String, Vec<f64>)>;

fn published() -> ManipulatorParams {
    ManipulatorParams::new(&ManipulatorOptions::published()).unwrap()
}

fn simulated() -> SimulatedRun {
    let options = TendonSimulationOptions { experiment: Experiment::Mixed, seed: 2, ..Default::default() };
    simulate(&published(), &options).unwrap()
}

/// A run as a file would have it.
fn columns(samples: &[RunSample]) -> Columns {
    let mut all = vec![
        ("time_s".to_owned(), samples.iter().map(|sample| sample.time_s).collect::<Vec<f64>>()),
        ("tension_base_n".to_owned(), samples.iter().map(|sample| sample.tension_base_n).collect()),
    ];
    for place in 0..8 {
        let shift_nm = samples.iter().map(|sample| sample.shift_nm[place]).collect();
        all.push((format!("shift_{}_nm", place + 1), shift_nm));
    }
    for place in 0..8 {
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let marker_m = samples.iter().map(|sample| sample.marker_m[place][axis]).collect();
            all.push((format!("marker_{}_{name}_m", place + 1), marker_m));
        }
    }
    all
}

fn said(columns: &Columns) -> String {
    Run::from_columns(columns, 8).unwrap_err().to_string()
}

#[test]
fn columns_become_the_samples() {
    let run = simulated();
    let read = Run::from_columns(&columns(&run.samples), 8).unwrap();
    for (one, other) in read.samples().iter().zip(&run.samples) {
        assert_eq!((one.time_s, one.tension_base_n), (other.time_s, other.tension_base_n));
        assert_eq!((&one.shift_nm, &one.marker_m), (&other.shift_nm, &other.marker_m));
        assert!(one.shift_reference_nm.is_nan());
    }
    assert!(read.has_tension() && read.has_shifts() && read.has_markers() && !read.has_reference());
    assert_eq!(read.begin_warning(), None);
    let cut = Run::new(run.samples[46..].to_vec(), 8).unwrap();
    assert!(cut.begin_warning().unwrap().contains("begins at 0.9"), "{:?}", cut.begin_warning());
    // Each group may be missing.
    let mut columns = columns(&run.samples);
    columns.truncate(2);
    let bare = Run::from_columns(&columns, 8).unwrap();
    assert!(bare.has_tension() && !bare.has_shifts() && !bare.has_markers());
    columns.truncate(1);
    assert!(!Run::from_columns(&columns, 8).unwrap().has_tension());
}

#[test]
fn bad_runs_get_their_sentence() {
    let good = columns(&simulated().samples[..20]);
    let with = |place: usize, row: usize, value: f64| {
        let mut bad = good.clone();
        bad[place].1[row] = value;
        said(&bad)
    };
    assert_eq!(with(0, 3, 0.2), "time goes from 0.2 s to 0.2 s at sample 4");
    assert!(with(0, 3, f64::NAN).starts_with("`time_s` of sample 4 is NaN"));
    assert!(with(1, 3, f64::NAN).starts_with("`tension_base_n` is NaN at 0.3 s (sample 4); it must"));
    assert!(with(1, 3, -0.1).starts_with("`tension_base_n` is -0.1 at "));
    assert!(with(1, 3, f64::INFINITY).starts_with("`tension_base_n` is inf at "));
    let renamed = |from: &str, to: &str| {
        let mut bad = good.clone();
        bad.iter_mut().filter(|(name, _)| name == from).for_each(|(name, _)| *name = to.to_owned());
        said(&bad)
    };
    assert!(
        renamed("tension_base_n", "tension_n")
            .starts_with("unknown column `tension_n`; did you mean `tension_base_n`?")
    );
    assert!(renamed("shift_3_nm", "shift_9_nm").starts_with("unknown column `shift_9_nm`; did you mean `shift_"));
    let without = |name: &str| said(&good.iter().filter(|(other, _)| other != name).cloned().collect());
    assert!(without("time_s").starts_with("column `time_s` is missing"));
    assert!(without("shift_3_nm").starts_with("column `shift_3_nm` is missing beside `shift_1_nm`"));
    assert!(without("marker_8_y_m").starts_with("column `marker_8_y_m` is missing beside `marker_1_x_m`"));
    let mut short = good.clone();
    short[4].1.pop();
    assert!(said(&short).starts_with("column `shift_3_nm` has 19 values, the first column 20"));

    let run = Run::from_columns(&good, 8).unwrap();
    let weak = TendonOptions { capacity_n: 0.1, ..TendonOptions::published() };
    let weak = ManipulatorOptions { tendons: [weak; 2], ..ManipulatorOptions::published() };
    let over = run.check_sizes(&ManipulatorParams::new(&weak).unwrap()).unwrap_err().to_string();
    assert!(over.contains("above the tendon's capacity of 0.1 N"), "{over}");
    let mut in_mm = good.clone();
    let markers = in_mm.iter_mut().filter(|(name, _)| name.starts_with("marker_"));
    markers.flat_map(|(_, numbers)| numbers).for_each(|number| *number *= 1e3);
    let in_mm = Run::from_columns(&in_mm, 8).unwrap().check_sizes(&published()).unwrap_err().to_string();
    assert!(in_mm.contains("likely in mm"), "{in_mm}");
    let limp = ManipulatorOptions { bending_stiffness_n_m2: 2e-6, ..ManipulatorOptions::published() };
    let beyond = compare(&ManipulatorParams::new(&limp).unwrap(), &run, None, &Way::ALL).unwrap_err();
    assert!(matches!(beyond, ContinuumError::BeyondModel { .. }), "{beyond}");
    let nothing = Run::from_columns(&[good[0].clone()], 8).unwrap();
    let nothing = compare(&published(), &nothing, None, &Way::ALL).unwrap_err().to_string();
    assert!(nothing.starts_with("the run has no tension: "), "{nothing}");
}

/// Frictions that a run shows with one grating spoilt, and in how many samples that one is bridged.
fn spoilt(run: &SimulatedRun, grating: usize, spoil: impl Fn(usize, &mut f64)) -> (FrictionResult, Vec<usize>) {
    let mut samples = run.samples.clone();
    for (row, sample) in samples.iter_mut().enumerate() {
        spoil(row, &mut sample.shift_nm[grating]);
    }
    let samples = Run::new(samples, 8).unwrap();
    let gratings = Gratings::new(Calibration::fit_all(&run.calibration).unwrap());
    let guarded = Guarded { measured: gratings.read(&samples).unwrap(), guards: Vec::new() };
    let count = |place: usize| guarded.measured.iter().filter(|sample| sample.is_bridged[place]).count();
    (FrictionResult::new("arm", &samples, &guarded), (0..8).map(count).collect())
}

/// Where no grating says anything nothing is made up, also not by the tension at the base.
#[test]
fn a_sample_without_any_grating_is_not_measured() {
    let run = simulated();
    let mut samples = run.samples.clone();
    samples[50].shift_nm.fill(f64::NAN);
    let lines = Calibration::fit_all(&run.calibration).unwrap();
    let measured = Gratings::new(lines).read(&Run::new(samples.clone(), 8).unwrap()).unwrap();
    assert!(
        measured[50].tension.iter().all(|tension| tension.value_n.is_nan()) && measured[50].is_bridged == [true; 8]
    );
    let shapes = shapes(&published(), &samples, Way::Measured, &measured).unwrap();
    let without: Vec<usize> = (0..shapes.len()).filter(|place| !shapes[*place].status.has_shape()).collect();
    assert_eq!(without, [50]);
}

#[test]
fn a_dead_grating_is_found_whatever_it_shows() {
    let run = simulated();
    let count = run.samples.len();
    for grating in [0, 3, 7] {
        let noise = |row: usize| 0.0005 * (f64::from(u32::try_from(row).unwrap()) * 12.9).sin();
        // Silent, standing still, showing noise; each may begin within the run.
        for from in [0, 60] {
            let shown = |way: usize, row: usize| [f64::NAN, 0.0731, noise(row)][way];
            for way in 0..3 {
                let (result, bridged) = spoilt(&run, grating, |row, shift| {
                    if row >= from {
                        *shift = shown(way, row);
                    }
                });
                // At tensions near 0 a grating that shows nothing may be right.
                assert!(bridged[grating] + 40 > count - from, "way {way}: {bridged:?} of {count}");
                assert!((0..8).all(|other| other == grating || bridged[other] == 0), "way {way}: {bridged:?}");
                assert_eq!(result.bridged[0].grating, grating + 1);
                let sentence = result.bridged[0].warning(count);
                assert!(sentence.starts_with(&format!("grating {} is dead in ", grating + 1)), "{sentence}");
                // Friction there is uncertain, so that no direction is made up.
                let hole = &result.holes[grating];
                assert!(from > 0 || hole.standard_error_n > 0.02, "{hole:?}");
            }
        }
    }
    let all_dead = Run::new(
        run.samples.iter().map(|sample| RunSample { shift_nm: vec![f64::NAN; 8], ..sample.clone() }).collect(),
        8,
    );
    let gratings = Gratings::new(Calibration::fit_all(&run.calibration).unwrap());
    assert_eq!(gratings.read(&all_dead.unwrap()), Err(ContinuumError::AllDead));
}

#[test]
fn without_the_tension_at_the_base_the_first_hole_is_not_known() {
    let run = simulated();
    let samples = run.samples.iter().map(|sample| RunSample { tension_base_n: f64::NAN, ..sample.clone() }).collect();
    let samples = Run::new(samples, 8).unwrap();
    let gratings = Gratings::new(Calibration::fit_all(&run.calibration).unwrap());
    let guarded = Guarded::read(&published(), &gratings, &samples).unwrap();
    let result = FrictionResult::new("arm", &samples, &guarded);
    assert!(result.holes[0].mean_n.is_nan() && result.holes[1].mean_n.is_finite());
    let ways = compare(&published(), &samples, Some(&guarded.measured), &Way::ALL).unwrap();
    assert_eq!(ways.iter().map(|way| way.way.name()).collect::<Vec<_>>(), ["measured"]);
    assert!(ways[0].errors.mean_mm().unwrap() < 1.0);
}

#[test]
fn a_reference_takes_the_temperature_off() {
    let run = simulated();
    let text = include_str!("../../../examples/tendon-prototype.toml");
    let lines = Calibration::fit_all(&run.calibration).unwrap();
    let slopes: Vec<f64> = lines.iter().map(|line| line.newton_per_nm).collect();
    let offsets: Vec<f64> = lines.iter().map(|line| line.offset_n).collect();
    let more = "wavelength_nm = 1545.0\nreference_wavelength_nm = 1560.0\n";
    let text = format!("{text}\n[gratings]\nnewton_per_nm = {slopes:?}\noffset_n = {offsets:?}\n{more}");
    let gratings = Gratings::from_file(&ManipulatorFile::parse(&text, "arm.toml").unwrap()).unwrap().unwrap();
    // α_Λ + α_n of silica over 10 K.
    let thermal = 6.85e-6 * 10.0;
    let sample = &run.samples[80];
    let warm = RunSample {
        shift_nm: sample.shift_nm.iter().map(|shift| shift + 1545.0 * thermal).collect(),
        shift_reference_nm: 1560.0 * thermal,
        ..sample.clone()
    };
    for (cold, warm) in gratings.tensions(sample, 0.0).iter().zip(gratings.tensions(&warm, 0.0)) {
        assert!((cold.value_n - warm.value_n).abs() < 1e-12);
    }
}

#[test]
fn load_benches_are_read() {
    let column = |name: &str, values: &[f64]| (name.to_owned(), values.to_vec());
    let mut steps: Columns = vec![column("load_g", &[20.0, 100.0, 200.0])];
    steps.extend((1..=8).map(|place| column(&format!("shift_{place}_nm"), &[0.02, 0.1, 0.2])));
    let params = published();
    let load_steps = |steps: &Columns| load_steps(steps, &params, None);
    let read = load_steps(&steps).unwrap();
    assert!((read[2].load_n - 1.96133).abs() < 1e-12 && read[2].shift_nm == [0.2; 8]);
    steps[0].0 = "load_n".to_owned();
    let in_grams = load_steps(&steps).unwrap_err().to_string();
    assert!(in_grams.starts_with("`load_n` goes up to 200 N, above the tendon's capacity of 4 N: it is likely in g"));
    steps[0].1 = vec![0.2, 1.0, 2.0];
    assert!((load_steps(&steps).unwrap()[2].load_n - 2.0).abs() < 1e-12);
    steps[0].1[1] = f64::NAN;
    assert!(load_steps(&steps).unwrap_err().to_string().starts_with("`load_n` is NaN in row 2"));
    steps.remove(0);
    assert!(load_steps(&steps).unwrap_err().to_string().starts_with("column `load_g` is missing"));

    let hole = vec![
        column("tension_1_n", &[1.0, 2.0, 3.0]),
        column("tension_2_n", &[0.9, 1.8, 2.7]),
        column("angle_1_rad", &[1.0; 3]),
        column("angle_2_rad", &[1.1; 3]),
    ];
    assert!((hole_loads(&hole).unwrap()[1].second_rad - 1.1).abs() < 1e-15);
    assert!(hole_loads(&hole[..3]).unwrap_err().to_string().starts_with("column `angle_2_rad` is missing"));
}
