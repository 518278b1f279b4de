//! Samples beyond memory: rows from the temporary file, and what is fitted to them.

use std::borrow::Cow;

use fric_core::robot::file::RobotFile;
use fric_lab::discover::{CorrectedFit, corrections, fit_cables_corrected};
use fric_lab::fit::{CableRecord, FitOptions, LogZero, Progress, Reference, Row, SampleStore, fit_cables, residuals_n};
use fric_lab::simulate::SimulationOptions;

use super::logs::{Log, mini_ipanema};

/// The robot that the logs are compared with.
fn robot() -> RobotFile {
    mini_ipanema(|_| "mu = 0.02, sigma_n_per_m = 900.0, viscous_n_s_per_m = 0.2".to_owned())
}

/// Two logs of eight cables, of different lengths.
fn logs(duration_s: f64) -> [Log; 2] {
    let truth = mini_ipanema(|cable| format!("mu = 0.0{}, sigma_n_per_m = 1000.0", 15 + cable));
    [(1, duration_s), (2, 0.7 * duration_s)].map(|(seed, duration_s)| {
        let options = SimulationOptions { seed, duration_s: Some(duration_s), ..SimulationOptions::default() };
        Log::record(&truth, &options)
    })
}

/// All that can be wrong about a row.
fn spoil(log: &mut Log) {
    for (count, cycle) in log.0.iter_mut().enumerate() {
        let cable = count % 8;
        match count % 97 {
            0 => cycle.cables[cable].sensor_force_n = f64::NAN,
            1 => cycle.cables[cable].sensor_force_n = -0.0,
            2 => cycle.cables[cable].length_m += 0.5,
            3 => cycle.cables[cable].length_m = f64::INFINITY,
            4 => cycle.reference_force_n[cable] = -f64::NAN,
            _ => {}
        }
    }
    // A pose that is lost later is held.
    log.0.iter_mut().take(50).for_each(|cycle| cycle.pose = None);
}

/// The logs in a store that keeps so many bytes in memory.
fn stored<'a>(logs: &[Log], robot: &'a RobotFile, memory_bytes: usize) -> SampleStore<'a> {
    let mut store = SampleStore::new(&robot.params(), Reference::Forces).within(memory_bytes);
    for log in logs {
        store.start_log();
        log.samples().for_each(|sample| store.add(&sample).unwrap());
    }
    store
}

/// Every number and every fact of a row.
fn bits((row, reference_n): (&Row, &f64)) -> ([u64; 8], [bool; 5]) {
    let Row { signals, pose_wrap, pose_fault, cycle } = row;
    let numbers = [
        signals.sensor_force_n,
        signals.displacement_m,
        signals.speed_m_per_s,
        signals.length_m,
        pose_wrap.wrap_factor,
        pose_wrap.traction_ratio,
        *reference_n,
        *cycle,
    ];
    let facts = [signals.sensor_finite, signals.frozen, signals.jump, signals.motion_finite, *pose_fault];
    (numbers.map(f64::to_bits), facts)
}

/// The oracle is what measurements in memory have made of the same samples, compared number by number.
#[test]
fn rows_come_back_with_the_same_bits() {
    let (robot, mut logs) = (robot(), logs(3.0));
    logs.iter_mut().for_each(spoil);
    let memory = stored(&logs, &robot, usize::MAX);
    let memory = memory.all().unwrap();
    assert!(matches!(memory, Cow::Borrowed(_)));
    for memory_bytes in [0, 10_000, 700_000, 3_000_000] {
        let store = stored(&logs, &robot, memory_bytes);
        for cables in [0..8, 0..1, 3..5, 7..8] {
            let loaded = store.load(cables.clone()).unwrap();
            assert_eq!((loaded.len(), loaded.log_starts_s()), (5_100, memory.log_starts_s()));
            assert_eq!(loaded.cables().count(), cables.len());
            for cable in 0..8 {
                let Some(found) = loaded.cable(cable) else {
                    assert!(!cables.contains(&cable));
                    continue;
                };
                let given = memory.cable(cable).unwrap();
                let bits_of = |of: CableRecord<'_>| of.rows.iter().zip(of.references_n).map(bits).collect::<Vec<_>>();
                assert_eq!(bits_of(found), bits_of(given), "cable {cable}");
                assert_eq!(found.logs().map(|(start, _)| start).collect::<Vec<usize>>(), [0, 3_000]);
                assert_eq!(found.time_s(5_099).to_bits(), given.time_s(5_099).to_bits());
            }
        }
    }
    let all: Vec<[bool; 5]> =
        memory.cables().flat_map(|cable| cable.rows.iter().map(|row| bits((row, &0.0)).1)).collect();
    for fact in [0, 2, 3, 4] {
        assert!([true, false].iter().all(|value| all.iter().any(|facts| facts[fact] == *value)), "fact {fact}");
    }
}

/// The fit, its residuals and the corrections of a store, every number in full.
fn results(store: &SampleStore<'_>) -> (CorrectedFit, Vec<Vec<f64>>, String) {
    let mut left_n = Vec::new();
    let options = FitOptions::default();
    let fit = fit_cables_corrected(store, &options, &Progress::new(), |of_cable| left_n.push(of_cable)).unwrap();
    let shown = format!("{fit:?} {left_n:?} {:?}", corrections(store, &Progress::new()).unwrap());
    (fit, left_n, shown)
}

/// Cables one by one, and up to three together; one of them with a late reference.
#[test]
fn fits_are_those_in_memory() {
    let (robot, mut logs) = (robot(), logs(22.0));
    for log in &mut logs {
        for place in (8..log.0.len()).rev() {
            log.0[place].reference_force_n[2] = log.0[place - 8].reference_force_n[2];
        }
    }
    for zero in [None, Some(LogZero::Platform)] {
        let memory = stored(&logs, &robot, usize::MAX).with_zero_per_log(zero);
        let (fit, left_n, shown) = results(&memory);
        assert_eq!(fit.faults.iter().map(Vec::len).collect::<Vec<usize>>(), [0, 0, 1, 0, 0, 0, 0, 0]);
        let measurements = memory.all().unwrap();
        let plain = fit_cables(&measurements, &FitOptions::default(), &Progress::new());
        let plain_n = residuals_n(&measurements, &plain);
        for cable in (0..8).filter(|cable| *cable != 2) {
            assert_eq!(format!("{:?}", plain[cable]), format!("{:?}", fit.cables[cable]));
            assert!(plain_n[cable].iter().map(|n| n.to_bits()).eq(left_n[cable].iter().map(|n| n.to_bits())));
        }
        for memory_bytes in [1_000_000, 2_300_000] {
            let store = stored(&logs, &robot, memory_bytes).with_zero_per_log(zero);
            assert!(matches!(store.load(0..1).unwrap(), Cow::Owned(_)));
            assert!(results(&store).2 == shown, "{memory_bytes} bytes");
        }
    }
}
