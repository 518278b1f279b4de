//! Why a candidate is not named.

use fric_core::effects::Effect;

use crate::fit::Parameter;

/// Effects that are no matter of size: with some values they are others.
const DEGENERATE: [Effect; 3] = [Effect::SensorWarmup, Effect::FrictionWarmup, Effect::SensorNonlinearity];

/// The reason why a candidate that helps is not named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// The evidence is weaker than what chance produces.
    Weak,
    /// The effect removes so little of what is left that the model error of another effect can look like it.
    Small,
    /// The search ended before it could judge the effect.
    Unjudged,
    /// A parameter is stuck at the bound of its range.
    AtBound,
    /// Its parameters are within a few standard errors of the values at which it does nothing.
    Absent,
    /// What is left without it is no more than noise, as far as the log shows the noise.
    WithinNoise,
    /// The log cannot distinguish the effect from this parameter.
    Open(Parameter),
    /// The effect's size differs between operating conditions of this name, so something else is mistaken for it.
    Unsteady(&'static str),
    /// An unnamed law over this signal explains more in the effect's place and leaves it little to explain.
    StandsIn(&'static str),
    /// The effect is no stronger than in robots without it.
    Usual,
    /// With its values the effect is another one: a warm-up that is over at once is a zero, or what the start of the run has stored; a curve that is bent
    /// beyond all loads is a gain with a zero.
    Degenerate,
    /// The effect explains no more than this other effect does, which sound robots have too.
    UsualInstead(Effect),
    /// A straight line explains as much as the effect's curve: a gain with an offset, or a drift.
    Straight,
    /// The rest would vanish if the effect's size varied with this condition, so its law is a different one.
    Bent(&'static str),
    /// The lengths of the log contradict the correction of the robot file.
    Contradicted,
    /// Undoing the sensor's lag makes more noise than it explains.
    Louder {
        /// Time constant of the lag, s, as it shows behind a low-pass filter.
        time_constant_s: f64,
    },
}

impl Refusal {
    /// Returns the reason against an effect that is no more than robots without it show.
    pub(crate) fn usual(effect: Effect) -> Self {
        if DEGENERATE.contains(&effect) { Self::Degenerate } else { Self::Usual }
    }

    /// Whether an effect that is refused so may be there all the same.
    pub(crate) fn leaves_open(self) -> bool {
        matches!(self, Self::Usual | Self::Open(_))
    }
}
