//! The delay line against linear interpolation of the whole history.

use fric_core::effects::time_delay::{Delay, DelayLine, MAX_DELAY_CYCLES, MAX_LEAD_CYCLES};

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
    #[expect(clippy::cast_precision_loss, reason = "a small number")]
    let most = -(MAX_LEAD_CYCLES as f64);
    for (cycles, whole, fraction) in [
        (-1.0, 0, -1.0),
        (-1e9, 0, most),
        (f64::NEG_INFINITY, 0, most),
        (f64::NAN, 0, most),
        (1e9, MAX_DELAY_CYCLES - 1, 0.0),
    ] {
        let delay = Delay::from_cycles(cycles, cycles);
        assert_eq!(delay, Delay { cycles: whole, fraction, leads: cycles < 0.0 });
    }
    // A delay that was not made by `from_cycles` must not reach past the line.
    let mut line = DelayLine::EMPTY;
    assert!(line.shift(1.0, true, Delay { cycles: usize::MAX - 1, fraction: 0.5, leads: false }).is_finite());
}

/// A parabola led by linear extrapolation is wrong by its curvature alone: `x(t + n) − x − n(x − x₋₁) = c·n(n + 1)`.
#[test]
fn leads_by_linear_extrapolation() {
    let parabola = |cycle: f64| 3.0 - 0.2 * cycle + 0.01 * cycle * cycle;
    for lead in [0.25, 1.0, 7.5, 20.0] {
        let mut line = DelayLine::EMPTY;
        for cycle in 0..50 {
            let time = f64::from(cycle);
            let shifted = line.shift(parabola(time), true, Delay::from_cycles(-lead, -lead));
            // The first cycles are not known to be in order.
            let expected = if cycle < 2 { parabola(time) } else { parabola(time + lead) - 0.01 * lead * (lead + 1.0) };
            assert_near(shifted, expected, 1e-12);
        }
    }
}

/// What makes up for cycles that were not believed is no speed to go on with.
#[test]
fn nothing_is_extrapolated_around_a_cycle_out_of_order() {
    let mut line = DelayLine::EMPTY;
    let mut leads = |value: f64, in_order: bool| line.shift(value, in_order, Delay::from_cycles(-10.0, -10.0));
    for _ in 0..5 {
        assert_eq!(leads(1.0, true), 1.0);
    }
    assert_eq!(leads(0.0, false), 0.0);
    assert_eq!(leads(2.0, true), 2.0);
    assert_eq!(leads(1.0, true), 1.0);
    assert_eq!(leads(1.5, true), 6.5);
}
