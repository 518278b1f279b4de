//! The delay line against linear interpolation of the whole history.

use fric_core::effects::time_delay::{Delay, DelayLine, MAX_DELAY_CYCLES};

use crate::support::{Random, assert_near};

#[test]
#[expect(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "small numbers")]
fn delays_by_any_number_of_cycles() {
    let mut random = Random::new(21);
    let longest = (MAX_DELAY_CYCLES - 1) as f64;
    let delays =
        [0.0, 0.25, 1.0, 7.5, longest - 0.01, longest].into_iter().chain((0..50).map(|_| random.range(0.0, longest)));
    for delay_cycles in delays.collect::<Vec<_>>() {
        let mut line = DelayLine::EMPTY;
        let history: Vec<f64> = (0..300).map(|_| random.range(-1.0, 1.0)).collect();
        // Before the start nothing moved.
        let at = |cycle: i64| usize::try_from(cycle).map_or(0.0, |cycle| history[cycle]);
        for (cycle, value) in history.iter().enumerate() {
            let time = cycle as f64 - delay_cycles;
            let (before, share) = (time.floor() as i64, time - time.floor());
            let expected = if share == 0.0 { at(before) } else { at(before) * (1.0 - share) + at(before + 1) * share };
            assert_near(line.shift(*value, true, Delay::from_cycles(delay_cycles, delay_cycles)), expected, 1e-12);
        }
    }
}

#[test]
fn out_of_range_delays_are_held_within() {
    for (cycles, whole) in [(-1.0, 0), (f64::NAN, 0), (f64::NEG_INFINITY, 0), (1e9, MAX_DELAY_CYCLES - 1)] {
        assert_eq!(Delay::from_cycles(cycles, cycles), Delay { cycles: whole, fraction: 0.0 });
    }
    // A delay that was not made by `from_cycles` must not reach past the line.
    let mut line = DelayLine::EMPTY;
    assert!(line.shift(1.0, true, Delay { cycles: usize::MAX - 1, fraction: 0.5, leads: false }).is_finite());
}
