//! Several logs together, and the number of threads.

use fric_lab::fit::{CableFit, FitOptions, Measurements, Progress, Reference, fit_cables, fit_wrench};
use fric_lab::simulate::SimulationOptions;
use rayon::ThreadPoolBuilder;

use super::logs::{FRICTION, Log, assert_near, mini_ipanema, parameter, value};
use super::oracle::{Bench, PULLEYS, strokes, wandering};
use crate::simulate::robots::bench;

#[test]
fn two_logs_agree_with_each_and_tell_more() {
    let robot = bench(PULLEYS, "mu = 0.05, sigma_n_per_m = 300.0");
    let truth = Bench::default();
    let one = truth.run(10.0, strokes(0.05, 1.0), wandering(8.0));
    // Another day: the winch stands elsewhere, and what the pulleys had stored is gone.
    let other = Bench { seed: 1, ..truth.clone() }.run(10.0, |time_s| 3.0 + strokes(0.03, 0.7)(time_s), wandering(5.0));
    let mut both = Measurements::new(&robot.params(), Reference::Forces);
    one.add_to(&mut both);
    other.add_to(&mut both);
    assert_eq!((both.len(), both.cable(0).unwrap().logs().count()), (20_000, 2));
    let options = FitOptions::default();
    let together = fit_cables(&both, &options, &Progress::new()).remove(0);
    assert_near(&together, &FRICTION, &truth.truth());
    let singles = [&one, &other].map(|log| log.fit(&robot, &options).remove(0));
    assert!(singles.iter().all(|single| together.samples.used > single.samples.used));
    assert_eq!(together.samples.flagged, 0);
    for name in FRICTION {
        let error = |fit: &CableFit| fit.standard_error(&parameter(name)).unwrap();
        // What pulleys that are not alike do to a parameter does not average out.
        let worse = error(&singles[0]).max(error(&singles[1]));
        assert!(error(&together) < 1.05 * worse, "{name}: {} {worse}", error(&together));
        for single in &singles {
            let apart = (value(&together, name) - value(single, name)).abs();
            assert!(apart < 3.5 * error(single), "{name}: {apart} {}", error(single));
        }
    }
}

fn bits(fits: &[CableFit]) -> Vec<u64> {
    fits.iter().flat_map(|fit| fit.values.iter().chain(&fit.covariance)).map(|number| number.to_bits()).collect()
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let robot = mini_ipanema(|_| "mu = 0.02, sigma_n_per_m = 900.0, viscous_n_s_per_m = 0.2".to_owned());
    let log = Log::record(&robot, &SimulationOptions { duration_s: Some(22.0), ..SimulationOptions::default() });
    let (forces, wrench) = (log.measured(&robot, Reference::Forces), log.measured(&robot, Reference::Wrench));
    let results = [1, 2].map(|threads| {
        ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let options = FitOptions::default();
            let few = FitOptions { parameters: Some(vec![parameter("mu")]), ..FitOptions::default() };
            let mut bits_of_both = bits(&fit_cables(&forces, &options, &Progress::new()));
            bits_of_both.extend(bits(&fit_wrench(&wrench, &few, &Progress::new()).unwrap().cables));
            bits_of_both
        })
    });
    assert!(results[0].len() > 8 * 2 * 7);
    assert!(results[0] == results[1]);
}
