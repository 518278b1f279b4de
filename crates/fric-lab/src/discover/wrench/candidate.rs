//! What may be missing from a model of all cables.

use fric_core::effects::Effect;

use super::geometry::Geometry;
use super::model::Model;
use crate::candidates::catalogue::{fitted, has};
use crate::candidates::ripple::period_of;
use crate::discover::naming::Refusal;
use crate::fit::Parameter;

/// Something that a model may lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Candidate {
    /// An effect that all cables have, with the same parameters.
    Alike(Effect),
    /// An effect of the cable of this index.
    Own(usize, Effect),
    /// A wrong entry of the robot file.
    Geometry(Geometry),
}

impl Candidate {
    /// Returns how many parameters it adds to a model; the period of a ripple is one.
    pub fn count(self) -> usize {
        match self {
            Self::Alike(effect) | Self::Own(_, effect) => {
                fitted(effect).len() + usize::from(period_of(effect).is_some())
            }
            Self::Geometry(of) => of.count(),
        }
    }

    /// Returns the effect; `None` for an entry of the robot file.
    pub fn effect(self) -> Option<Effect> {
        match self {
            Self::Alike(effect) | Self::Own(_, effect) => Some(effect),
            Self::Geometry(_) => None,
        }
    }

    /// Returns the reason against it where it is no more than robots without it show.
    pub fn usual(self) -> Refusal {
        self.effect().map_or(Refusal::Usual, Refusal::usual)
    }

    /// Returns its name without the cables.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Alike(effect) | Self::Own(_, effect) => effect.kind(),
            Self::Geometry(of) => of.key(),
        }
    }

    /// Whether a model already has it. An effect of all cables counts as present if any cable has that effect.
    pub fn is_in(self, model: &Model) -> bool {
        match self {
            Self::Own(cable, effect) => model.values.get(cable).is_some_and(|values| has(effect, values)),
            Self::Alike(effect) => model.values.iter().any(|values| has(effect, values)),
            Self::Geometry(of) => model.changes.contains_key(&of),
        }
    }

    /// Removes it from a model: its parameters become neutral and are not varied.
    pub fn remove_from(self, model: &mut Model) {
        match self {
            Self::Own(cable, effect) => {
                let is_own = |of: &Parameter| of.effect() == Some(effect);
                model.free.iter_mut().skip(cable).take(1).for_each(|free| free.retain(|of| !is_own(of)));
                let values = model.values.iter_mut().skip(cable).take(1);
                values.for_each(|values| Parameter::of(effect).for_each(|of| values[of.place()] = of.row().neutral));
            }
            Self::Alike(effect) => {
                model.alike.retain(|of| of.effect() != Some(effect));
                let values = model.values.iter_mut();
                values.for_each(|values| Parameter::of(effect).for_each(|of| values[of.place()] = of.row().neutral));
            }
            Self::Geometry(of) => {
                model.changes.remove(&of);
            }
        }
    }
}
