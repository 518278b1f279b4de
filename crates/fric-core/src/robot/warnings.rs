//! Warnings about allowed but probably unintended content of a robot file, one sentence each.

use std::format;
use std::string::String;
use std::vec::Vec;

use super::file::{EffectTable, RobotFile};
use crate::effects::Effect;

/// Cycle time above which it is probably not in seconds, s: no winch is controlled at less than 5 Hz, and in milliseconds this is 5 kHz.
const GREAT_CYCLE_S: f64 = 0.2;

impl RobotFile {
    /// Returns warnings about a cycle time that no controller has, and about effects that change nothing.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let is_idle = |effect: &EffectTable| {
            Effect::of_kind(&effect.kind).is_some_and(|named| {
                let neutral =
                    |key: &str| named.row().parameters.iter().find(|row| row.key == key).map(|row| row.neutral);
                effect.parameters.iter().all(|(key, value)| neutral(key) == Some(*value))
            })
        };
        let mut warnings = Vec::new();
        let cycle_s = self.options().cycle_s;
        if cycle_s > GREAT_CYCLE_S {
            warnings.push(format!(
                "`cycle_s` of the robot file is {cycle_s} s, the cycle time of no controller, and the checks of jumps depend on it; give the time from \
                 one cycle to the next in seconds, 0.001 at 1 kHz"
            ));
        }
        for named in Effect::kinds() {
            let has_idle =
                |effects: &[EffectTable]| effects.iter().any(|effect| effect.kind == named.kind() && is_idle(effect));
            let cables = self.options().cable.iter().filter(|cable| has_idle(&cable.effects));
            let names: Vec<&str> = cables.map(|cable| cable.name.as_str()).collect();
            if !names.is_empty() {
                warnings.push(format!(
                    "the effect `{}` of {} has only neutral values and does nothing; give it others, or take it out of \
                     the robot file",
                    named.kind(),
                    names.join(", ")
                ));
            }
        }
        warnings
    }
}
