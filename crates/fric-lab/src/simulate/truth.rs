//! The influence of effects and disturbances on the simulated robot.
//!
//! Each implements [`TruthEffect`](crate::effects::truth::TruthEffect) from the physics, not from the compensator's code: [`effects`](crate::effects)
//! those of the catalogue, [`disturbances`](super::disturbances) those outside it.
//!
//! Where several act at one place, factors multiply and forces add. In the sensor signal the nonlinear curve comes first, then the gain, offsets and
//! noise, and then the amplifier.

use fric_core::effects::Effect;
use fric_core::effects::EffectParams;
use fric_core::robot::file::EffectTable;
use rand_chacha::ChaCha8Rng;

use super::disturbances::Disturbance;
use super::error::SimulationError;
use super::hidden::HiddenEffect;
use crate::effects;
use crate::effects::truth::{Cause, Contact, TruthEffect};

/// The inputs, besides their parameters, from which the effects of one cable are created.
pub struct CableCause<'a> {
    /// Length at the start of the run, m.
    pub start_length_m: f64,
    /// Ratio of the sensor signal to the tension without friction, dimensionless.
    pub sensor_ratio: f64,
    /// Returns a stream of random numbers for the disturbance at an index of the list.
    pub random: &'a dyn Fn(usize) -> ChaCha8Rng,
}

/// All effects of one cable.
#[derive(Debug, Default)]
pub struct TruthEffects(Vec<Box<dyn TruthEffect>>);

impl TruthEffects {
    /// Creates the effects from the robot file's entries of a cable, the hidden effects and the disturbances. All of them act.
    pub fn new(
        of_file: &[EffectTable],
        hidden: &[HiddenEffect],
        disturbances: &[Disturbance],
        cable: &CableCause<'_>,
    ) -> Result<Self, SimulationError> {
        let mut all = Self::default();
        for table in of_file {
            // A robot file contains only effects of the catalogue.
            let Some(effect) = Effect::of_kind(&table.kind) else { continue };
            let mut params = EffectParams::NEUTRAL;
            for (key, value) in &table.parameters {
                params.set(effect, key, *value)?;
            }
            all.add(effect, &params, cable);
        }
        for hidden in hidden {
            all.add(hidden.effect(), hidden.params(), cable);
        }
        for (place, disturbance) in disturbances.iter().enumerate() {
            all.0.push(disturbance.build(cable.start_length_m, &mut (cable.random)(place)));
        }
        Ok(all)
    }

    fn add(&mut self, effect: Effect, params: &EffectParams, cable: &CableCause<'_>) {
        let value = |key: &str| params.get(effect, key).unwrap_or_default();
        let CableCause { start_length_m, sensor_ratio, random } = *cable;
        let mut cause = Cause { value: &value, start_length_m, sensor_ratio, random: &mut random(0) };
        self.0.extend(effects::of(effect).map(|lab| (lab.truth)(&mut cause)));
    }

    fn product(&self, factor: impl Fn(&(dyn TruthEffect + 'static)) -> f64) -> f64 {
        self.0.iter().map(|effect| factor(effect.as_ref())).product()
    }

    fn sum(&self, part: impl Fn(&(dyn TruthEffect + 'static)) -> f64) -> f64 {
        // `sum` is avoided because its empty sum is −0.
        self.0.iter().fold(0.0, |sum, effect| sum + part(effect.as_ref()))
    }
}

impl TruthEffect for TruthEffects {
    fn mu_factor(&self, contact: &Contact) -> f64 {
        self.product(|effect| effect.mu_factor(contact))
    }

    fn moved(&mut self, contact: &Contact, step_s: f64) {
        self.0.iter_mut().for_each(|effect| effect.moved(contact, step_s));
    }

    fn load_factor(&self, normal_force_n: f64) -> f64 {
        self.product(|effect| effect.load_factor(normal_force_n))
    }

    fn drag_n(&self, contact: &Contact) -> f64 {
        self.sum(|effect| effect.drag_n(contact))
    }

    fn own_mu(&self, pulley: f64) -> Option<f64> {
        self.0.iter().find_map(|effect| effect.own_mu(pulley))
    }

    fn held_ratio(&self) -> f64 {
        self.0.iter().fold(f64::INFINITY, |least, effect| least.min(effect.held_ratio()))
    }

    fn viscous_n(&self, speed_m_per_s: f64) -> f64 {
        self.sum(|effect| effect.viscous_n(speed_m_per_s))
    }

    fn viscous_factor(&self, speed_m_per_s: f64) -> f64 {
        self.product(|effect| effect.viscous_factor(speed_m_per_s))
    }

    fn bristle_lead_s(&self) -> f64 {
        self.sum(TruthEffect::bristle_lead_s)
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

    fn creep_m_per_s(&self) -> f64 {
        self.sum(TruthEffect::creep_m_per_s)
    }

    fn platform_factor(&self, length_m: f64) -> f64 {
        self.product(|effect| effect.platform_factor(length_m))
    }

    fn platform_force_n(&self, speed_m_per_s: f64, length_m: f64, tension_n: f64) -> f64 {
        self.sum(|effect| effect.platform_force_n(speed_m_per_s, length_m, tension_n))
    }

    fn motion_lead_s(&self) -> f64 {
        self.sum(TruthEffect::motion_lead_s)
    }

    fn winch_play_m(&self) -> f64 {
        self.sum(TruthEffect::winch_play_m)
    }

    fn bent_n(&self, force_n: f64) -> f64 {
        self.0.iter().fold(force_n, |force_n, effect| effect.bent_n(force_n))
    }

    fn winch_force_n(&self, length_m: f64) -> f64 {
        self.sum(|effect| effect.winch_force_n(length_m))
    }

    fn sensor_gain(&self) -> f64 {
        self.product(TruthEffect::sensor_gain)
    }

    fn sensor_offset_n(&self, time_s: f64) -> f64 {
        self.sum(|effect| effect.sensor_offset_n(time_s))
    }

    fn lagging_n(&mut self, force_n: f64, step_s: f64) -> f64 {
        self.0.iter_mut().fold(force_n, |force_n, effect| effect.lagging_n(force_n, step_s))
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
        CableCause { start_length_m: 1.0, sensor_ratio: 1.0, random: &|place| ChaCha8Rng::seed_from_u64(place as u64) }
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
        let at = |speed_m_per_s| Contact {
            speed_m_per_s,
            length_m: 1.0,
            tension_n: 5.0,
            time_s: 0.0,
            is_last_pulley: false,
        };
        assert!((effects.mu_factor(&at(0.0)) - 1.5 * 1.2).abs() < 1e-15);
        let expected = (1.0 + 0.5 * (-1.0_f64).exp()) * (1.0 + 0.2 * (-4.0_f64).exp());
        assert!((effects.mu_factor(&at(-0.1)) - expected).abs() < 1e-15);
        assert!((effects.motion_lead_s() - 0.004).abs() < 1e-18);
        let hum_n = effects.sensor_offset_n(0.005) + effects.sensor_offset_n(0.015);
        assert!(hum_n.abs() < 1e-12 && effects.sensor_offset_n(0.0).abs() <= 0.1);
        Ok(())
    }
}
