//! `gear_backlash` in the simulated robot: after a reversal the winch turns before the cable follows.

use fric_core::effects::gear_backlash::PLAY;
use fric_core::parameters::Values;

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual };

/// Start values of the play, m: the sum of squares has a minimum at each small movement that a play absorbs.
const PLAYS_M: [f64; 3] = [5e-5, 3e-4, 1.5e-3];

/// A play to either side of up to this many standard deviations of the length's noise counts as that noise.
const LEAST_DEVIATIONS: f64 = 4.0;

#[derive(Debug)]
struct Loose {
    play_m: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Loose { play_m: (cause.value)("play_m") })
}

impl TruthEffect for Loose {
    fn winch_play_m(&self) -> f64 {
        self.play_m
    }
}

fn starts(_: &Around) -> Vec<Start> {
    PLAYS_M.map(|play_m| vec![("play_m", play_m)]).to_vec()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("play_m", scale.about(3e-4))]
}

fn is_more_than_usual(values: &Values, around: &Around) -> bool {
    values[PLAY] > 2.0 * LEAST_DEVIATIONS * around.length_noise_m
}
