//! `gear_backlash`: play between the encoder and the cable.
//!
//! Equation: the cable follows the winch within ± `play_m`/2. With its position s in the play, `s ← s + Δl` is clamped to ± `play_m`/2, and the
//! excess moves the cable. While the cable does not move its speed is 0; its length is that of the winch minus s. A run begins in the middle of the
//! play. Neutral: `play_m = 0`.
//!
//! A play of the size of the encoder's noise can hardly be distinguished from it; for length noise that moves nothing, use `length_noise_m` of the
//! monitor.
//!
//! Cause: worn teeth, or a loose coupling or key between the motor, whose encoder measures the length, and the drum.

use super::{Acting, Effect, EffectRow, Memory, OnMu, UNKNOWN};
use crate::parameters::ParameterRow;
use crate::scalar::Scalar;

const EXCITATION: &str = "small movements that reverse, and long ones in both directions";

/// The catalogue row.
pub const ROW: EffectRow = EffectRow {
    kind: "gear_backlash",
    cause: "gear or coupling have play, so that after each reversal the winch turns before the cable follows",
    remedy: "tighten or replace gear and coupling, preload the gear, or measure the length at the drum",
    parameters: &[ParameterRow::fitted("play_m", "m", [0.0, 0.0, 0.1], EXCITATION)],
    example: &[4e-4],
    memory: Memory::OfMotion(1),
    on_mu: OnMu::Unchanged,
    goes_by_time: false,
};

/// The effect as a set of one, to test whether it acts.
pub(crate) const ACTS: Acting = Effect::GearBacklash.acts();
/// Index of `play_m` in [`Values`](crate::parameters::Values).
pub const PLAY: usize = Effect::GearBacklash.first_place();

/// Index of its state: the position of the cable in the play, m.
pub(crate) const IN_PLAY: usize = Effect::GearBacklash.memory_places().start;

/// The effect's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearBacklash<T> {
    /// How far the winch turns after a reversal before the cable follows, m of cable.
    pub play_m: T,
}

impl<T: Scalar> GearBacklash<T> {
    /// Creates the parameters from a cable's values, by index.
    #[inline(always)]
    pub fn of(value: impl Fn(usize) -> T) -> Self {
        Self { play_m: value(PLAY) }
    }

    /// Returns the displacement of the cable and its new position in the play, m. `in_play_m` is its previous position, [`UNKNOWN`] at the start of a
    /// run.
    #[inline(always)]
    pub fn moved_m(&self, in_play_m: T, displacement_m: T) -> [T; 2] {
        let half_m = self.play_m.scale(T::splat(0.5));
        let pushed_m = in_play_m.keep(in_play_m.lt(T::splat(UNKNOWN))) + displacement_m;
        let next_m = pushed_m.min(half_m).max(-half_m);
        [pushed_m - next_m, next_m]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cable_follows_at_the_ends_of_the_play() {
        let gear = GearBacklash { play_m: 1.0 };
        let mut in_play_m = UNKNOWN;
        let mut moved_m = |displacement_m: f64| {
            let [moved_m, next_m] = gear.moved_m(in_play_m, displacement_m);
            in_play_m = next_m;
            moved_m
        };
        // 0.5 to the end, back over the whole play, and on.
        let moved = [0.3, 0.3, 1.0, -0.6, -0.6, -1.0, 0.0, 2.0].map(&mut moved_m);
        let expected = [0.0, 0.1, 1.0, 0.0, -0.2, -1.0, 0.0, 1.0];
        assert!(moved.iter().zip(expected).all(|(moved, expected)| (moved - expected).abs() < 1e-12), "{moved:?}");
        // Without play the cable's motion equals the winch's, to the bit.
        let [moved_m, in_play_m] = GearBacklash { play_m: 0.0 }.moved_m(UNKNOWN, -1.3e-5_f64);
        assert_eq!((moved_m.to_bits(), in_play_m.abs()), ((-1.3e-5_f64).to_bits(), 0.0));
    }
}
