//! Play between the encoder and the cable: on a reversal the winch turns before the cable follows.

use super::{DisturbanceRow, parameter};
use crate::effects::truth::{Cause, TruthEffect};

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "backlash",
    cause: "gear or coupling have play, so that the cable moves less than the encoder shows after each reversal",
    parameters: &[parameter("play_m", "m", 0.0005, [0.0, 1.0])],
    build,
};

#[derive(Debug)]
struct Play {
    play_m: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Play { play_m: (cause.value)("play_m") })
}

impl TruthEffect for Play {
    fn winch_play_m(&self) -> f64 {
        self.play_m
    }
}
