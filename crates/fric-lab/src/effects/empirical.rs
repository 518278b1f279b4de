//! `empirical` in the simulated robot: a force, or a change of the friction, from a table.
//!
//! The load is the tension at the platform including friction, whereas the cycle uses it without friction.

use fric_core::effects::Effect;
use fric_core::effects::empirical::{Over, SHARE_PLACES, SIZE};

use super::truth::{Cause, Contact, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};
use crate::random::uniform;

/// The effect's entry in the lab. No search starts with it, because a table has no name to be found.
pub const LAB: LabEffect = LabEffect { truth, starts: |_: &Around| Vec::new(), typical, is_more_than_usual: always };

#[derive(Debug)]
struct Table {
    force_n: f64,
    friction_ratio: f64,
    over: Option<Over>,
    /// Points of the condition and the share at each.
    points: Vec<(f64, f64)>,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let parameters = Effect::Empirical.row().parameters;
    let values: Vec<f64> = parameters.iter().map(|parameter| (cause.value)(parameter.key)).collect();
    let value = |place: usize| values.get(place - SIZE).copied().unwrap_or(0.0);
    let over = Over::of(value);
    let (from, to) = over.map_or((0.0, 0.0), |over| (value(over.from()), value(over.to())));
    let shares: Vec<f64> = SHARE_PLACES.map(value).collect();
    #[expect(clippy::cast_precision_loss, reason = "a small count")]
    let at = |place: usize| from + (to - from) * place as f64 / (shares.len() - 1) as f64;
    let points = shares.iter().enumerate().map(|(place, share)| (at(place), *share)).collect();
    let [force_n, friction_ratio] = ["force_n", "friction_ratio"].map(cause.value);
    Box::new(Table { force_n, friction_ratio, over, points })
}

impl Table {
    /// Interpolates between the two neighbouring points.
    fn share(&self, speed_m_per_s: f64, length_m: f64, tension_n: f64) -> f64 {
        let Some(over) = self.over else { return 0.0 };
        let at = match over {
            Over::Speed => speed_m_per_s,
            Over::Length => length_m,
            Over::Load => tension_n,
        };
        let next = self.points.partition_point(|(place, _)| *place < at);
        let before = next.checked_sub(1).and_then(|before| self.points.get(before));
        match (before, self.points.get(next)) {
            (Some((from, one)), Some((to, other))) => one + (other - one) * (at - from) / (to - from),
            (Some((_, end)), None) | (None, Some((_, end))) => *end,
            (None, None) => 0.0,
        }
    }
}

impl TruthEffect for Table {
    fn mu_factor(&self, contact: &Contact) -> f64 {
        (1.0 + self.friction_ratio * self.share(contact.speed_m_per_s, contact.length_m, contact.tension_n)).max(0.0)
    }

    fn platform_force_n(&self, speed_m_per_s: f64, length_m: f64, tension_n: f64) -> f64 {
        self.force_n * self.share(speed_m_per_s, length_m, tension_n)
    }
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    // A bump over the speed.
    let force_n = scale.either(0.04 * scale.tension_n);
    let edge_m_per_s = uniform(scale.random, 0.2, 0.5);
    vec![
        ("force_n", force_n),
        ("speed_from_m_per_s", -edge_m_per_s),
        ("speed_to_m_per_s", edge_m_per_s),
        ("share_4", 0.5),
        ("share_5", 1.0),
        ("share_6", 0.7),
        ("share_7", 0.2),
    ]
}
