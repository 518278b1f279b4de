//! The delay line against linear interpolation of the whole history.

use fric_core::effects::time_delay::{Delay, DelayLine, MAX_DELAY_CYCLES, MAX_LEAD_CYCLES};
use fric_core::effects::{Effect, EffectParams};
use fric_core::robot::{CableOptions, FrictionOptions};
use fric_core::{CableInput, CycleInput};

use crate::random::Random;
use crate::support::{FRICTION, GUIDE_90, UNMONITORED, assert_near, compensator};

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
            assert_near(line.shift(*value, true, Delay::from_cycles(delay_cycles)), expected, 1e-12);
        }
    }
}

#[test]
#[expect(clippy::cast_precision_loss, reason = "small numbers")]
fn out_of_range_delays_are_held_within() {
    let (longest, most) = ((MAX_DELAY_CYCLES - 1) as f64, -(MAX_LEAD_CYCLES as f64));
    for (cycles, held) in [(1e9, longest), (f64::INFINITY, longest), (-1e9, most), (f64::NEG_INFINITY, most)] {
        assert_eq!(Delay::from_cycles(cycles), Delay::from_cycles(held));
    }
    let mut line = DelayLine::EMPTY;
    assert!((0..100).all(|_| line.shift(1.0, true, Delay::from_cycles(f64::NAN)).is_finite()));
}

/// A parabola is led to where it goes; from one cycle on each of the two values that were is interpolated between cycles, which misses the share
/// `f·(1 − f)·c` of the curvature `c`.
#[test]
fn a_lead_follows_the_parabola() {
    let (a, b, c) = (3.0, -0.2, 0.01);
    let parabola = |cycle: f64| a + b * cycle + c * cycle * cycle;
    let missed = |age: f64| c * (age - age.floor()) * (1.0 - (age - age.floor()));
    for lead in [0.01, 0.25, 0.5, 0.99, 1.0, 7.5, 7.3, 20.0] {
        let mut line = DelayLine::EMPTY;
        for cycle in 0..60 {
            let time = f64::from(cycle);
            let shifted = line.shift(parabola(time), true, Delay::from_cycles(-lead));
            // Until all it rests on is known to be in order.
            let (known, error) = if lead < 1.0 {
                (3.0, 0.0)
            } else {
                ((2.0 * lead).floor() + 2.0, missed(2.0 * lead) - 3.0 * missed(lead))
            };
            let led = parabola(time + lead) + error;
            assert_near(shifted, if time >= known { led } else { parabola(time) }, 1e-12);
        }
    }
}

/// A search for the lead would stop where its slope jumps: below one cycle, and at one cycle from below, it does not.
#[test]
fn a_short_lead_has_a_slope_without_jumps() {
    let mut random = Random::new(22);
    let history: Vec<f64> = (0..20).map(|_| random.range(-1.0, 1.0)).collect();
    let led = |lead: f64| {
        let mut line = DelayLine::EMPTY;
        history.iter().map(|value| line.shift(*value, true, Delay::from_cycles(-lead))).next_back().unwrap()
    };
    let step = 1e-5;
    for lead in (1..100).map(|percent| 0.01 * f64::from(percent)) {
        let [before, after] = [led(lead) - led(lead - step), led(lead + step) - led(lead)];
        assert!((after - before).abs() < 10.0 * step * step, "{lead}: {before} {after}");
    }
    assert_near(led(1.0 - 1e-9), led(1.0), 1e-7);
}

/// What makes up for cycles that were not believed is no speed to go on with.
#[test]
fn nothing_is_extrapolated_around_a_cycle_out_of_order() {
    let mut line = DelayLine::EMPTY;
    let mut leads = |value: f64, in_order: bool| line.shift(value, in_order, Delay::from_cycles(-1.0));
    for _ in 0..8 {
        assert_eq!(leads(1.0, true), 1.0);
    }
    assert_eq!(leads(0.0, false), 0.0);
    for value in [2.0, 1.0, 3.0, 4.0] {
        assert_eq!(leads(value, true), value);
    }
    // 3·5 − 3·4 + 3.
    assert_eq!(leads(5.0, true), 6.0);
}

/// A lead rests on the cycles before; after a pause that is reported, it waits until they follow one another again.
#[test]
fn a_lead_waits_after_a_pause() {
    let mut effects = EffectParams::default();
    effects.set(Effect::TimeDelay, "delay_s", -0.002).unwrap();
    let friction = FrictionOptions { mu: 0.0, viscous_n_s_per_m: 3.0, offset_n: 0.0, ..FRICTION };
    let options = [CableOptions { friction, effects, ..CableOptions::new(&[GUIDE_90]) }];
    for (elapsed_cycles, leads) in [(1.0, true), (5.0, false)] {
        let mut compensator = compensator::<1>(&options, UNMONITORED);
        for cycle in 0..100 {
            let time_s = f64::from(cycle) * 1e-3;
            // A steady acceleration, which the lead follows.
            let speed_m_per_s = 0.1 + 0.8 * time_s;
            let length_m = 1.0 + 0.1 * time_s + 0.4 * time_s * time_s;
            let cables = [CableInput { sensor_force_n: 20.0 + time_s, length_m, speed_m_per_s }];
            let elapsed_cycles = if cycle == 90 { elapsed_cycles } else { 1.0 };
            let output = compensator.step(&CycleInput { cables, elapsed_cycles, ..CycleInput::default() });
            // A lead of two cycles rests on seven in order.
            let led_m_per_s = if !leads && (90..97).contains(&cycle) { 0.0 } else { 0.8 * 0.002 };
            if cycle >= 20 {
                assert_near(output.cables[0].friction_n, 3.0 * (speed_m_per_s + led_m_per_s), 1e-9);
            }
        }
    }
}
