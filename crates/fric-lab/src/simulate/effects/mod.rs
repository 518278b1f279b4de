//! What the effects of the catalogue do to the simulated robot.
//!
//! To add one: a file here that implements [`TruthEffect`] from the physics, not from the compensator's code, and a row
//! in [`SIMULATED`]. An effect that acts at a place where none has acted so far gets a new method with a default that
//! does nothing, and one call where that place is ([`bristle`](super::bristle), [`motion`](super::motion),
//! [`stream`](super::stream)). An effect of the catalogue without a row is refused by name.
//! [`disturbances`](super::disturbances), which are in no catalogue, act through the same methods.
//!
//! Where several act at one place, factors multiply and forces add up; of what the sensor shows the gain comes first, then
//! offsets, then noise, then what the amplifier makes of the sum.

mod bearing_drag;
mod cable_elasticity;
mod direction_asymmetry;
mod friction_drift;
mod load_nonlinearity;
mod presliding_shape;
mod pulley_eccentricity;
mod pulley_inertia;
mod sensor_drift;
mod sensor_gain;
mod sensor_offset;
mod stribeck;
mod time_delay;

use fric_core::effects::EffectParams;
use fric_core::robot::file::EffectTable;
use rand_chacha::ChaCha8Rng;

use super::disturbances::Disturbance;
use super::error::SimulationError;
use super::hidden::{HiddenEffect, list};

/// A bearing at one instant, as far as its friction depends on it beside the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// How fast the cable runs over its pulley, m/s, positive paying out.
    pub speed_m_per_s: f64,
    /// Length of the cable, m.
    pub length_m: f64,
    /// Since the start, s.
    pub time_s: f64,
    /// The pulley nearest to the platform.
    pub is_last_pulley: bool,
}

/// An effect at work on one cable. Every method's default is a cable without it.
pub trait TruthEffect: core::fmt::Debug + Send + Sync {
    /// Factor on a bearing's μ.
    fn mu_factor(&self, _contact: &Contact) -> f64 {
        1.0
    }

    /// Factor on a bearing's μ that depends on its load, N.
    fn load_factor(&self, _normal_force_n: f64) -> f64 {
        1.0
    }

    /// Sliding friction of a bearing beside `μ·F_N`, N.
    fn drag_n(&self, _contact: &Contact) -> f64 {
        0.0
    }

    /// Factor on `F_pv`.
    fn viscous_factor(&self, _speed_m_per_s: f64) -> f64 {
        1.0
    }

    /// Factor on the exponent of the presliding, which is 1 without.
    fn presliding_exponent(&self) -> f64 {
        1.0
    }

    /// Mass of each pulley at its rim, kg.
    fn pulley_mass_kg(&self) -> f64 {
        0.0
    }

    /// How much the cable stretches from the winch to the platform, m/N.
    fn compliance_m_per_n(&self) -> f64 {
        0.0
    }

    /// Tension at the platform per tension behind the last pulley at a length.
    fn platform_factor(&self, _length_m: f64) -> f64 {
        1.0
    }

    /// By how much the logged motion runs ahead of the cable's, s.
    fn motion_lead_s(&self) -> f64 {
        0.0
    }

    /// How far the winch turns on a reversal before the cable follows, m of cable.
    fn winch_play_m(&self) -> f64 {
        0.0
    }

    /// What the sensor shows per newton.
    fn sensor_gain(&self) -> f64 {
        1.0
    }

    /// What the sensor shows too much, N.
    fn sensor_offset_n(&self, _time_s: f64) -> f64 {
        0.0
    }

    /// What is logged of what the sensor shows, noise included, N.
    fn reading_n(&self, shown_n: f64) -> f64 {
        shown_n
    }

    /// Whether the last reading is logged again.
    fn is_frozen(&self, _time_s: f64) -> bool {
        false
    }
}

/// What one effect of one cable is made from.
pub struct Cause<'a> {
    /// Its parameters by key.
    pub value: &'a dyn Fn(&str) -> f64,
    /// Length of the cable where the run starts, m.
    pub start_length_m: f64,
    /// For phases and the like.
    pub random: &'a mut ChaCha8Rng,
}

/// What the effects of one cable are made from beside their parameters.
pub struct CableCause<'a> {
    /// Length where the run starts, m.
    pub start_length_m: f64,
    /// A stream of random numbers for the disturbance at a place of the list.
    pub random: &'a dyn Fn(usize) -> ChaCha8Rng,
}

/// All effects of one cable.
#[derive(Debug, Default)]
pub struct TruthEffects(Vec<Box<dyn TruthEffect>>);

/// The time that a drift has gone on for, s; one that ends at 0 has no end.
fn drifted_s(time_s: f64, until_s: f64) -> f64 {
    if until_s > 0.0 && time_s > until_s { until_s } else { time_s }
}

pub type Build = fn(&mut Cause<'_>) -> Box<dyn TruthEffect>;

/// What the simulation can do, by the catalogue's names.
const SIMULATED: &[(&str, Build)] = &[
    ("stribeck", stribeck::build),
    ("direction_asymmetry", direction_asymmetry::build),
    ("bearing_drag", bearing_drag::build),
    ("load_nonlinearity", load_nonlinearity::build),
    ("friction_drift", friction_drift::build),
    ("presliding_shape", presliding_shape::build),
    ("sensor_gain", sensor_gain::build),
    ("sensor_offset", sensor_offset::build),
    ("sensor_drift", sensor_drift::build),
    ("time_delay", time_delay::build),
    ("pulley_inertia", pulley_inertia::build),
    ("pulley_eccentricity", pulley_eccentricity::build),
    ("cable_elasticity", cable_elasticity::build),
];

impl TruthEffects {
    /// The effects that the robot file gives a cable, the hidden ones and the disturbances, all of which act.
    pub fn new(
        of_file: &[EffectTable],
        hidden: &[HiddenEffect],
        disturbances: &[Disturbance],
        cable: &CableCause<'_>,
    ) -> Result<Self, SimulationError> {
        let mut effects = Self::default();
        for table in of_file {
            let mut params = EffectParams::NEUTRAL;
            for (key, value) in &table.parameters {
                params.set(&table.kind, key, *value)?;
            }
            effects.add(&table.kind, &params, cable)?;
        }
        for effect in hidden {
            effects.add(effect.kind(), effect.params(), cable)?;
        }
        for (place, disturbance) in disturbances.iter().enumerate() {
            effects.0.push(disturbance.build(cable.start_length_m, &mut (cable.random)(place)));
        }
        Ok(effects)
    }

    fn add(&mut self, kind: &str, params: &EffectParams, cable: &CableCause<'_>) -> Result<(), SimulationError> {
        let Some((kind, build)) = SIMULATED.iter().find(|(name, _)| *name == kind) else {
            let known = list(SIMULATED.iter().map(|(name, _)| format!("`{name}`")));
            return Err(SimulationError::UnsupportedEffect { kind: kind.to_owned(), known });
        };
        let value = |key: &str| params.get(kind, key).unwrap_or_default();
        let CableCause { start_length_m, random } = cable;
        self.0.push(build(&mut Cause { value: &value, start_length_m: *start_length_m, random: &mut random(0) }));
        Ok(())
    }

    fn product(&self, factor: impl Fn(&(dyn TruthEffect + 'static)) -> f64) -> f64 {
        self.0.iter().map(|effect| factor(effect.as_ref())).product()
    }

    fn sum(&self, part: impl Fn(&(dyn TruthEffect + 'static)) -> f64) -> f64 {
        // Not `sum`, whose empty sum is −0.
        self.0.iter().fold(0.0, |sum, effect| sum + part(effect.as_ref()))
    }
}

impl TruthEffect for TruthEffects {
    fn mu_factor(&self, contact: &Contact) -> f64 {
        self.product(|effect| effect.mu_factor(contact))
    }

    fn load_factor(&self, normal_force_n: f64) -> f64 {
        self.product(|effect| effect.load_factor(normal_force_n))
    }

    fn drag_n(&self, contact: &Contact) -> f64 {
        self.sum(|effect| effect.drag_n(contact))
    }

    fn viscous_factor(&self, speed_m_per_s: f64) -> f64 {
        self.product(|effect| effect.viscous_factor(speed_m_per_s))
    }

    fn presliding_exponent(&self) -> f64 {
        self.product(TruthEffect::presliding_exponent)
    }

    fn pulley_mass_kg(&self) -> f64 {
        self.sum(TruthEffect::pulley_mass_kg)
    }

    fn compliance_m_per_n(&self) -> f64 {
        self.sum(TruthEffect::compliance_m_per_n)
    }

    fn platform_factor(&self, length_m: f64) -> f64 {
        self.product(|effect| effect.platform_factor(length_m))
    }

    fn motion_lead_s(&self) -> f64 {
        self.sum(TruthEffect::motion_lead_s)
    }

    fn winch_play_m(&self) -> f64 {
        self.sum(TruthEffect::winch_play_m)
    }

    fn sensor_gain(&self) -> f64 {
        self.product(TruthEffect::sensor_gain)
    }

    fn sensor_offset_n(&self, time_s: f64) -> f64 {
        self.sum(|effect| effect.sensor_offset_n(time_s))
    }

    fn reading_n(&self, shown_n: f64) -> f64 {
        self.0.iter().fold(shown_n, |shown_n, effect| effect.reading_n(shown_n))
    }

    fn is_frozen(&self, time_s: f64) -> bool {
        self.0.iter().any(|effect| effect.is_frozen(time_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::rand_core::SeedableRng;

    fn any_cable() -> CableCause<'static> {
        CableCause { start_length_m: 1.0, random: &|place| ChaCha8Rng::seed_from_u64(place as u64) }
    }

    #[test]
    fn every_simulated_effect_is_in_the_catalogue() {
        for (kind, _) in SIMULATED {
            assert!(fric_core::effects::row(kind).is_some(), "{kind}");
        }
    }

    #[test]
    fn an_effect_without_a_row_is_refused_by_name() {
        let error =
            TruthEffects::default().add("rust", &EffectParams::NEUTRAL, &any_cable()).map_err(|e| e.to_string());
        let expected =
            "the effect `rust` is in the catalogue, but the simulation cannot do it yet; it can do `stribeck`, ";
        assert!(error.is_err_and(|text| text.starts_with(expected)));
    }

    #[test]
    fn effects_of_file_and_hidden_ones_both_act() -> Result<(), Box<dyn core::error::Error>> {
        let table = EffectTable {
            kind: "stribeck".to_owned(),
            parameters: [("ratio".to_owned(), 0.5), ("velocity_m_per_s".to_owned(), 0.1)].into(),
        };
        let hidden = ["stribeck:ratio=0.2,velocity_m_per_s=0.05", "time_delay:delay_s=0.004"].map(HiddenEffect::parse);
        let hidden = hidden.into_iter().collect::<Result<Vec<_>, _>>()?;
        let hum = Disturbance::parse("hum:amplitude_n=0.1,frequency_hz=50")?;
        let effects = TruthEffects::new(&[table], &hidden, &[hum], &any_cable())?;
        let at = |speed_m_per_s| Contact { speed_m_per_s, length_m: 1.0, time_s: 0.0, is_last_pulley: false };
        assert!((effects.mu_factor(&at(0.0)) - 1.5 * 1.2).abs() < 1e-15);
        let expected = (1.0 + 0.5 * (-1.0_f64).exp()) * (1.0 + 0.2 * (-4.0_f64).exp());
        assert!((effects.mu_factor(&at(-0.1)) - expected).abs() < 1e-15);
        assert!((effects.motion_lead_s() - 0.004).abs() < 1e-18);
        let hum_n = effects.sensor_offset_n(0.005) + effects.sensor_offset_n(0.015);
        assert!(hum_n.abs() < 1e-12 && effects.sensor_offset_n(0.0).abs() <= 0.1);
        Ok(())
    }
}
