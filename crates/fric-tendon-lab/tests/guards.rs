//! Guards of the gratings, and runs that begin under tension.

use fric_tendon::{ManipulatorOptions, ManipulatorParams, ShapeStatus, TendonOptions};
use fric_tendon_lab::comparison::{WayShapes, compare};
use fric_tendon_lab::fbg::Calibration;
use fric_tendon_lab::gratings::Gratings;
use fric_tendon_lab::guard::{Guard, Guarded};
use fric_tendon_lab::shape_errors::Way;
use fric_tendon_lab::simulate::{Experiment, SimulatedRun, TendonSimulationOptions, simulate};
use fric_tendon_lab::{BeginSource, Run, RunSample};

fn published() -> ManipulatorParams {
    ManipulatorParams::new(&ManipulatorOptions::published()).unwrap()
}

fn simulated(experiment: Experiment, seed: u64) -> SimulatedRun {
    simulate(&published(), &TendonSimulationOptions { experiment, seed, ..TendonSimulationOptions::default() }).unwrap()
}

/// Reads a run whose shifts were changed, with the tension in each segment and what the guards found.
fn read(run: &SimulatedRun, change: impl Fn(usize, usize, &mut f64)) -> Guarded {
    let mut samples = run.samples.clone();
    for (row, sample) in samples.iter_mut().enumerate() {
        sample.shift_nm.iter_mut().enumerate().for_each(|(grating, shift_nm)| change(row, grating, shift_nm));
    }
    let gratings = Gratings::new(Calibration::fit_all(&run.calibration).unwrap());
    Guarded::read(&published(), &gratings, &Run::new(samples, 8).unwrap()).unwrap()
}

/// Greatest error of a tension, N.
fn off_n(run: &SimulatedRun, guarded: &Guarded) -> f64 {
    let errors = guarded.measured.iter().zip(&run.truth).flat_map(|(sample, truth)| {
        sample.tension.iter().zip(&truth.tension_n).map(|(tension, tension_n)| (tension.value_n - tension_n).abs())
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn clean_runs_have_nothing_to_guard() {
    for experiment in Experiment::ALL {
        for seed in 0..10 {
            let run = simulated(experiment, seed);
            let guarded = read(&run, |_, _, _| {});
            assert!(guarded.guards.is_empty(), "{experiment:?} {seed} {:?}", guarded.guards);
            let gratings = Gratings::new(Calibration::fit_all(&run.calibration).unwrap());
            assert_eq!(guarded.measured, gratings.read(&Run::new(run.samples.clone(), 8).unwrap()).unwrap());
        }
    }
}

#[test]
fn a_common_step_is_taken_off() {
    for experiment in Experiment::ALL {
        for (seed, step_nm, from) in [(0, 0.0115, 40), (1, -0.05, 30), (2, 0.06, 20), (3, 0.4, 61)] {
            let run = simulated(experiment, seed);
            let clean_n = off_n(&run, &read(&run, |_, _, _| {}));
            let guarded = read(&run, |row, _, shift_nm| *shift_nm += if row >= from { step_nm } else { 0.0 });
            let [Guard::CommonStep { time_s, step_nm: found_nm }] = guarded.guards[..] else {
                panic!("{experiment:?} {step_nm} {:?}", guarded.guards)
            };
            assert_eq!(time_s.to_bits(), run.samples[from].time_s.to_bits());
            assert!((found_nm - step_nm).abs() < 0.0008, "{experiment:?} {step_nm} {found_nm}");
            assert!(off_n(&run, &guarded) < clean_n + 0.01, "{} {clean_n}", off_n(&run, &guarded));
        }
    }
}

#[test]
fn steps_of_the_tension_itself_are_none() {
    // A staircase with one sample a step moves all gratings, as the tension at the base explains.
    let run = simulated(Experiment::OneWay, 3);
    let stairs = SimulatedRun {
        samples: run.samples.iter().step_by(9).cloned().collect(),
        truth: run.truth.iter().step_by(9).cloned().collect(),
        ..run
    };
    let guarded = read(&stairs, |_, _, _| {});
    assert!(guarded.guards.is_empty(), "{:?}", guarded.guards);
}

#[test]
fn a_grating_that_contradicts_its_neighbours_is_bridged() {
    let run = simulated(Experiment::Mixed, 4);
    let count = run.samples.len();
    for (grating, jump_nm, rows) in [(2, 0.012, 50..90), (5, -0.02, 100..count), (7, 0.03, 33..34)] {
        let guarded = read(&run, |row, place, shift_nm| {
            *shift_nm += if place == grating && rows.contains(&row) { jump_nm } else { 0.0 };
        });
        let [Guard::ContradictingGrating { grating: found, samples, intervals_s }] = &guarded.guards[..] else {
            panic!("{grating} {:?}", guarded.guards)
        };
        assert_eq!((*found, *samples, intervals_s.len()), (grating + 1, rows.len(), 1));
        for (row, sample) in guarded.measured.iter().enumerate() {
            assert!((0..8).all(|place| sample.is_bridged[place] == (place == grating && rows.contains(&row))), "{row}");
        }
    }
    // Off from the beginning, so that it never jumps: neighbouring holes cannot hold what it shows.
    let guarded = read(&run, |_, place, shift_nm| *shift_nm += if place == 3 { 0.018 } else { 0.0 });
    let [Guard::ContradictingGrating { grating: 4, samples, .. }, ..] = &guarded.guards[..] else {
        panic!("{:?}", guarded.guards)
    };
    assert!(2 * samples > count, "{samples}");
}

#[test]
fn a_hole_beyond_its_bound_is_reported() {
    let mut mu = [0.1753; 8];
    mu[3] = 0.4;
    let tendon = TendonOptions { mu: &mu, ..TendonOptions::published() };
    let rough = ManipulatorParams::new(&ManipulatorOptions { tendons: [tendon; 2], ..ManipulatorOptions::published() });
    let options = TendonSimulationOptions { mu_spread_ratio: 0.0, ..TendonSimulationOptions::default() };
    let run = simulate(&rough.unwrap(), &options).unwrap();
    let guarded = read(&run, |_, _, _| {});
    let [Guard::BeyondBound { hole: 4, bound_ratio, share_ratio }] = guarded.guards[..] else {
        panic!("{:?}", guarded.guards)
    };
    // The simulator's friction is of the whole contact force, the model's of its normal part.
    let expected = 0.4 / (1.0 - 0.4_f64.powi(2)).sqrt() / 0.1753;
    assert!((bound_ratio / expected - 1.0).abs() < 0.05, "{bound_ratio} {expected}");
    // At small tensions the bound is within the noise.
    assert!(share_ratio > 0.3, "{share_ratio}");
}

/// Mean distance of the shapes by the history from the true ones, mm, of a run that begins at a sample.
fn of_part(run: &SimulatedRun, from: usize, change: impl Fn(&mut RunSample)) -> (f64, WayShapes) {
    let mut samples = run.samples[from..].to_vec();
    samples.iter_mut().for_each(change);
    let samples = Run::new(samples, 8).unwrap();
    let gratings = Gratings::new(Calibration::fit_all(&run.calibration).unwrap());
    let measured = samples.has_shifts().then(|| gratings.read(&samples).unwrap());
    let history = compare(&published(), &samples, measured.as_deref(), &[Way::History]).unwrap().remove(0);
    let mut off_mm = 0.0;
    for (shape, sample) in history.shapes.iter().zip(&run.samples[from..]) {
        let tip_m = shape.disk_position_m[7];
        off_mm += 1e3 * (tip_m[0] - sample.marker_m[7][0]).hypot(tip_m[1] - sample.marker_m[7][1]);
    }
    let count = f64::from(u32::try_from(history.shapes.len()).unwrap());
    (off_mm / count, history)
}

#[test]
fn a_run_that_begins_after_a_release_finds_its_memory() {
    let options = TendonSimulationOptions { experiment: Experiment::Mixed, marker_noise_m: 1e-5, ..Default::default() };
    let run = simulate(&published(), &options).unwrap();
    // In the release that follows the first pull.
    let from = 46;
    assert!(run.truth[from].is_mixed());
    // The whole run knows what the holes hold.
    let (_, whole) = of_part(&run, 0, |_| {});
    assert_eq!(whole.begin, None);
    let no_gratings = |sample: &mut RunSample| sample.shift_nm.clear();
    let bare = |sample: &mut RunSample| {
        no_gratings(sample);
        sample.marker_m.clear();
    };
    let (gratings_mm, by_gratings) = of_part(&run, from, |_| {});
    let (markers_mm, by_markers) = of_part(&run, from, no_gratings);
    let (bare_mm, by_middle) = of_part(&run, from, bare);
    // As if pulled from slack to there.
    let slack = fric_tendon_lab::shape_errors::shapes(&published(), &run.samples[from..], Way::History, &[]).unwrap();
    let slack_mm = slack.iter().zip(&run.samples[from..]).fold(0.0, |sum, (shape, sample)| {
        let tip_m = shape.disk_position_m[7];
        sum + 1e3 * (tip_m[0] - sample.marker_m[7][0]).hypot(tip_m[1] - sample.marker_m[7][1])
    }) / f64::from(u32::try_from(slack.len()).unwrap());
    let found = (gratings_mm, markers_mm, bare_mm, slack_mm);
    assert!(gratings_mm < 0.4 * slack_mm && markers_mm < 0.4 * slack_mm && bare_mm < 0.8 * slack_mm, "{found:?}");
    for (history, source) in
        [(&by_gratings, BeginSource::Gratings), (&by_markers, BeginSource::Markers), (&by_middle, BeginSource::Middle)]
    {
        let begin = history.begin.as_ref().unwrap();
        assert_eq!(begin.source, source);
        // Uncertain at first, and certain once all holes have slid, without a return.
        let uncertain: Vec<bool> =
            history.shapes.iter().map(|shape| shape.status.contains(ShapeStatus::MEMORY_UNCERTAIN)).collect();
        assert!(uncertain[0] && !uncertain[uncertain.len() - 1], "{source:?}");
        assert!(uncertain.is_sorted_by(|one, other| one >= other));
        assert_eq!(begin.uncertain_samples, uncertain.iter().filter(|is_so| **is_so).count());
        // From then on it is the history of the whole run, however it began.
        let last = history.shapes.last().unwrap();
        let same = last.disk_position_m[7][0] - whole.shapes.last().unwrap().disk_position_m[7][0];
        assert!(same.abs() < 1e-5, "{source:?} {same}");
    }
}
