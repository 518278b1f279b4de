//! Several logs, each with a zero of its own.

use fric_core::robot::file::RobotFile;
use fric_lab::discover::{CableDiscovery, DiscoverOptions, Verdict, discover};
use fric_lab::fit::{
    CableFit, FitOptions, LogZero, Measurements, Progress, Reference, ResidualFunction, Weighing, fit_cables,
    residuals_n,
};
use fric_lab::simulate::SimulationOptions;
use nalgebra::{DMatrix, DVector};

use super::logs::{Log, assert_near, parameter, value};
use super::oracle::PULLEYS;
use crate::simulate::robots::bench;

const TRUTH: [f64; 4] = [0.02, 900.0, 0.2, 0.0];
const ZEROS_N: [f64; 3] = [0.3, -0.5, 0.1];
/// White noise of the sensor, halved by its pulley of 180°, and that of the reference: √(0.01² + 0.01²) N.
const NOISE_N: f64 = 0.014_142_135_623_730_95;

/// A bench with an offset at the platform, and with an effect of the sensor.
fn robot(offset_n: f64, sensor_n: f64) -> RobotFile {
    let [mu, sigma, viscous, _] = TRUTH;
    let text = format!(
        "mu = {mu:?}, sigma_n_per_m = {sigma:?}, viscous_n_s_per_m = {viscous:?}, offset_n = {offset_n:?} }}\n\
         effects = [{{ kind = \"sensor_offset\", offset_n = {sensor_n:?} }}]\n# {{"
    );
    bench(PULLEYS, &text)
}

/// Three logs of one cable, each by a robot of its own.
fn logs(robot: impl Fn(f64) -> RobotFile) -> Vec<Log> {
    let of_log = |(seed, zero_n): (u64, f64)| {
        let options = SimulationOptions { seed, duration_s: Some(16.0), ..SimulationOptions::default() };
        Log::record(&robot(zero_n), &options)
    };
    (1..).zip(ZEROS_N).map(of_log).collect()
}

/// All logs as one.
fn together<'a>(logs: &[Log], robot: &'a RobotFile, zero: Option<LogZero>) -> Measurements<'a> {
    let mut measurements = Measurements::new(&robot.params(), Reference::Forces);
    for log in logs {
        log.add_to(&mut measurements);
    }
    measurements.with_zero_per_log(zero)
}

fn fit(measurements: &Measurements<'_>, options: &FitOptions) -> CableFit {
    fit_cables(measurements, options, &Progress::new()).remove(0)
}

fn rms_after_n(fit: &CableFit) -> f64 {
    fit.errors.after_n.rms().unwrap()
}

/// The zeros are within 3.5 standard errors of the truth, and these errors are no more than a tenth of a newton.
fn assert_zeros(fit: &CableFit) {
    assert_eq!(fit.per_log.len(), ZEROS_N.len());
    for (log, truth_n) in fit.per_log.iter().zip(ZEROS_N) {
        let log = log.unwrap();
        println!("{}: {} ± {}, truth {truth_n}", log.parameter, log.value, log.standard_error);
        assert!((log.value - truth_n).abs() < 3.5 * log.standard_error, "{log:?} instead of {truth_n}");
        assert!(log.standard_error < 0.1, "{log:?}");
    }
}

/// Friction is common and each log has its offset: all come out as they are. With one offset for all, the error left is that of the offsets, and the
/// friction is wrong or known far less.
#[test]
fn each_log_has_its_offset_and_all_have_the_friction() {
    let logs = logs(|zero_n| robot(zero_n, 0.0));
    let given = bench(PULLEYS, "mu = 0.05, sigma_n_per_m = 300.0");
    for weighing in [Weighing::LeastSquares, Weighing::Huber] {
        let options = FitOptions { weighing, ..FitOptions::default() };
        let measurements = together(&logs, &given, Some(LogZero::Platform));
        let found = fit(&measurements, &options);
        assert_zeros(&found);
        assert_near(&found, &["mu", "sigma_n_per_m", "viscous_n_s_per_m"], &TRUTH);
        let last = found.per_log[2].unwrap().value;
        assert_eq!(found.values[parameter("offset_n").place()].to_bits(), last.to_bits());
        assert!((rms_after_n(&found) / NOISE_N - 1.0).abs() < 0.05, "{}", rms_after_n(&found));
        // What is left in every cycle has no mean in any log.
        let left_n = residuals_n(&measurements, std::slice::from_ref(&found)).remove(0);
        for left_n in left_n.chunks(left_n.len() / 3) {
            let mean_n = left_n.iter().sum::<f64>() / 16_000.0;
            assert!(mean_n.abs() < 0.002, "{mean_n}");
        }
        let common = fit(&together(&logs, &given, None), &options);
        assert!(common.per_log.is_empty());
        assert!(rms_after_n(&common) > 5.0 * rms_after_n(&found), "{}", rms_after_n(&common));
        let error = |fit: &CableFit| fit.standard_error(&parameter("mu")).unwrap();
        assert!(error(&common) > 3.0 * error(&found), "{} {}", error(&common), error(&found));
    }
}

/// The elimination has the minimum and the covariance of the problem in which each offset has a column, made here from the residuals of the model without
/// any offset. The few samples of the warm-up that only one of the two counts move an estimate by up to half of its error by white noise.
#[test]
fn it_is_the_least_squares_with_a_column_for_each_log() {
    let logs = logs(|zero_n| robot(zero_n, 0.0));
    let given = bench(PULLEYS, "mu = 0.05, sigma_n_per_m = 300.0");
    let found = fit(&together(&logs, &given, Some(LogZero::Platform)), &FitOptions::default());
    let shared = ["mu", "sigma_n_per_m", "viscous_n_s_per_m"];
    let options = FitOptions { parameters: Some(shared.map(parameter).to_vec()), ..FitOptions::default() };
    let plain = together(&logs, &given, None);
    let function = ResidualFunction::new(&plain.cable(0).unwrap(), &options);
    let at = shared.map(|name| value(&found, name));
    let (residuals, jacobian) = (function.residuals(&at), function.jacobian(&at));
    let log_of: Vec<usize> = function.samples().map(|sample| sample / logs[0].0.len()).collect();
    let columns = DMatrix::from_fn(residuals.len(), 6, |row, column| match column {
        0..3 => jacobian[3 * row + column],
        _ => f64::from(u8::from(log_of[row] == column - 3)),
    });
    let residuals = DVector::from_vec(residuals);
    let inverse = (columns.transpose() * &columns).try_inverse().unwrap();
    let step = -&inverse * columns.transpose() * &residuals;
    let left = &residuals + &columns * &step;
    let variance = left.norm_squared() / 16_000.0 / 3.0;
    for (place, name) in shared.iter().enumerate() {
        let error = (variance * inverse[(place, place)]).sqrt();
        assert!(step[place].abs() < 0.5 * error, "{name}: {} {error}", step[place]);
        // Pulleys that may differ are in the stated error too.
        assert!(found.standard_error(&parameter(name)).unwrap() > 0.9 * error, "{name}");
    }
    for (log, of_log) in found.per_log.iter().enumerate() {
        let (log, of_log) = (3 + log, of_log.unwrap());
        let error = (variance * inverse[(log, log)]).sqrt();
        assert!((of_log.value - step[log]).abs() < 0.5 * error, "{} {} {error}", of_log.value, step[log]);
        assert!((0.9..6.0).contains(&(of_log.standard_error / error)), "{} {error}", of_log.standard_error);
    }
}

/// A sensor that is tared anew shifts the load on the bearings too, which an offset at the platform leaves unexplained.
#[test]
fn each_log_has_the_zero_of_its_sensor() {
    let logs = logs(|zero_n| robot(0.0, zero_n));
    let given = bench(PULLEYS, "mu = 0.05, sigma_n_per_m = 300.0");
    let found = fit(&together(&logs, &given, Some(LogZero::Sensor)), &FitOptions::default());
    assert_zeros(&found);
    assert_near(&found, &["mu", "sigma_n_per_m", "viscous_n_s_per_m"], &TRUTH);
    assert!((rms_after_n(&found) / NOISE_N - 1.0).abs() < 0.05, "{}", rms_after_n(&found));
}

/// The first cable's discovery.
fn look(measurements: Measurements<'_>) -> CableDiscovery {
    let found = discover(&measurements.into(), &DiscoverOptions::default(), &Progress::new()).unwrap().remove(0);
    let kinds: Vec<&str> = found.findings.iter().map(|finding| finding.effect.kind()).collect();
    let zeros: Vec<(f64, f64)> = found.per_log.iter().flatten().map(|log| (log.value, log.standard_error)).collect();
    println!("{:?} {kinds:?} {:?} {zeros:?}", found.verdict, found.after.held_out_n.rms());
    found
}

/// With a zero per log nothing is missing; with one for all, something is.
#[test]
fn zeros_of_the_logs_are_no_effect() {
    let given = robot(0.0, 0.0);
    for (zero, logs) in
        [(LogZero::Platform, logs(|zero_n| robot(zero_n, 0.0))), (LogZero::Sensor, logs(|zero_n| robot(0.0, zero_n)))]
    {
        let found = look(together(&logs, &given, Some(zero)));
        assert_eq!((found.findings.len(), found.verdict), (0, Verdict::Complete), "{zero:?}");
        assert!((found.after.held_out_n.rms().unwrap() / NOISE_N - 1.0).abs() < 0.05);
        for (log, truth_n) in found.per_log.iter().zip(ZEROS_N) {
            let log = log.unwrap();
            assert!((log.value - truth_n).abs() < 3.5 * log.standard_error && log.standard_error < 0.1, "{log:?}");
        }
        let common = look(together(&logs, &given, None));
        assert!(common.verdict != Verdict::Complete && common.per_log.is_empty(), "{zero:?}");
    }
}

/// What is missing beside the zeros is named as it is without them.
#[test]
fn an_effect_beside_the_zeros_is_named() {
    let with_gain = |zero_n: f64| {
        let text = format!(
            "mu = 0.02, sigma_n_per_m = 900.0, viscous_n_s_per_m = 0.2, offset_n = {zero_n:?} }}\n\
             effects = [{{ kind = \"sensor_gain\", gain = 1.05 }}]\n# {{"
        );
        bench(PULLEYS, &text)
    };
    let found = look(together(&logs(with_gain), &robot(0.0, 0.0), Some(LogZero::Platform)));
    let kinds: Vec<&str> = found.findings.iter().map(|finding| finding.effect.kind()).collect();
    assert_eq!((kinds, found.verdict), (vec!["sensor_gain"], Verdict::Extended));
    let gain = parameter("sensor_gain.gain");
    let (value, error) = (found.after.values[gain.place()], found.standard_error(&gain).unwrap());
    assert!((value - 1.05).abs() < 3.5 * error && error < 0.01, "{value} ± {error}");
    assert!((found.after.held_out_n.rms().unwrap() / NOISE_N - 1.0).abs() < 0.05);
}
