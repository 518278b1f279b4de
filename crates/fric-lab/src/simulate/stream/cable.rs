//! One simulated cable: winch, chain of bristles, sensor and encoder, advanced cycle by cycle.

use fric_core::CableParams;
use fric_core::robot::file::CableTable;
use rand_chacha::ChaCha8Rng;

use super::encoder::Encoder;
use super::random::{Purpose, random, random_of};
use super::wander::Wander;
use crate::effects::truth::TruthEffect;
use crate::random::uniform;
use crate::simulate::bristle::{BristleChain, Moment, PulleyTruth, STIFF_N_PER_M, SUBSTEPS};
use crate::simulate::error::SimulationError;
use crate::simulate::mechanics::motion::{CableMotion, Motion, Play, Winch};
use crate::simulate::options::SimulationOptions;
use crate::simulate::truth::{CableCause, TruthEffects};
use crate::trajectory::SetPoint;

#[derive(Debug)]
pub(super) struct SimulatedCable {
    pub(super) winch: Winch,
    play: Play,
    pub(super) chain: BristleChain,
    lead_s: f64,
    pub(super) offset_n: f64,
    pub(super) noise: ChaCha8Rng,
    pub(super) sensor_wander: Wander,
    pub(super) reference_wander: Wander,
    pub(super) encoder: Encoder,
    moment: Option<Moment>,
    wound: CableMotion,
    pub(super) reading_n: Option<f64>,
}

impl SimulatedCable {
    pub(super) fn new(
        cable: usize,
        table: &CableTable,
        params: &CableParams,
        options: &SimulationOptions,
        cycle_s: f64,
        motion: &Motion,
    ) -> Result<Self, SimulationError> {
        let of = |purpose| random(options.seed, purpose, cable);
        let start = motion.of_cable(params, motion.platform(0.0).as_ref(), 0.0);
        let cause = CableCause {
            start_length_m: start.map_or(0.0, |start| start.length_m),
            sensor_ratio: 1.0 / params.frictionless_gain(),
            random: &|place| random_of(options.seed, Purpose::Disturbance as u64 + place as u64, cable),
        };
        let effects = TruthEffects::new(&table.effects, &options.effects, &options.disturbances, &cause)?;
        let wander =
            |standard_deviation_n, purpose| Wander::new(standard_deviation_n, options.wander_s, cycle_s, of(purpose));
        Ok(Self {
            winch: Winch::new(params, &mut of(Purpose::Micro)),
            play: Play::new(effects.winch_play_m()),
            lead_s: effects.motion_lead_s(),
            chain: chain(table, options, cable, effects),
            offset_n: table.friction.offset_n,
            noise: of(Purpose::Noise),
            sensor_wander: wander(options.sensor_wander_n, Purpose::SensorWander),
            reference_wander: wander(options.reference_wander_n, Purpose::ReferenceWander),
            encoder: Encoder::new(options.length_resolution_m, options.length_noise_m, of(Purpose::Encoder)),
            moment: None,
            wound: CableMotion { length_m: 0.0, speed_m_per_s: 0.0 },
            reading_n: None,
        })
    }

    /// Advances to a time and returns the force at the sensor.
    pub(super) fn advance(
        &mut self,
        motion: &Motion,
        platform: Option<&SetPoint>,
        time_s: f64,
        force_n: f64,
        cycle_s: f64,
    ) -> f64 {
        // The workspace was checked, so only a position between the checked ones can have no way out; the cable then stops.
        let held = CableMotion { length_m: self.wound.length_m, speed_m_per_s: 0.0 };
        self.wound = self.winch.motion(motion, platform, time_s).unwrap_or(held);
        let CableMotion { length_m, speed_m_per_s } = self.play.follow(self.wound);
        let is_sped_up = self.chain.has_mass() && speed_m_per_s.abs() > 0.0;
        let moment = Moment {
            force_n,
            length_m,
            speed_m_per_s,
            acceleration_m_per_s2: if is_sped_up { self.winch.acceleration_m_per_s2(motion, time_s) } else { 0.0 },
            force_n_per_s: self.moment.map_or(0.0, |last| (force_n - last.force_n) / cycle_s),
            pose_cos: self.winch.pose_cos(platform),
            time_s,
        };
        if let Some(last) = self.moment {
            self.chain.advance(&last, &moment, cycle_s, SUBSTEPS);
        }
        self.moment = Some(moment);
        self.chain.sensor_force_n(&moment)
    }

    /// Returns the logged motion.
    pub(super) fn logged(&mut self, motion: &Motion, time_s: f64, cycle_s: f64) -> CableMotion {
        let mut wound = self.wound;
        if self.lead_s.abs() > 0.0 {
            let other_s = time_s + self.lead_s;
            wound = self.winch.motion(motion, motion.platform(other_s).as_ref(), other_s).unwrap_or(wound);
        }
        self.encoder.read(wound, cycle_s)
    }

    /// Returns the logged force.
    pub(super) fn reading_n(&mut self, sensor_force_n: f64, noise_n: f64, time_s: f64, cycle_s: f64) -> f64 {
        let length_m = self.wound.length_m;
        let effects = self.chain.effects();
        let felt_n = effects.sensor_gain() * effects.bent_n(sensor_force_n);
        let shown_n = felt_n + effects.winch_force_n(length_m) + effects.sensor_offset_n(time_s) + noise_n;
        let shown_n = effects.lagging_n(shown_n, cycle_s);
        let reading_n = match self.reading_n {
            Some(last_n) if effects.is_frozen(time_s) => last_n,
            _ => effects.reading_n(shown_n),
        };
        self.reading_n = Some(reading_n);
        reading_n
    }
}

/// Returns the cable's pulleys with their individual μ.
pub fn chain(table: &CableTable, options: &SimulationOptions, cable: usize, effects: TruthEffects) -> BristleChain {
    let spread = &mut random(options.seed, Purpose::Spread, cable);
    let ratio = options.mu_spread_ratio;
    let pulleys: Vec<PulleyTruth> = table
        .pulleys
        .iter()
        .map(|pulley| PulleyTruth {
            mu: table.friction.mu * (1.0 + uniform(spread, -ratio, ratio)),
            cos_wrap: pulley.wrap_deg.map(|wrap_deg| libm::cos(wrap_deg.to_radians())),
            viscous_n_s_per_m: table.friction.viscous_n_s_per_m,
        })
        .collect();
    let sensor_pulley = table.pulleys.first().is_some_and(|pulley| pulley.sensor == Some(true));
    let sigma_n_per_m = table.friction.sigma_n_per_m.unwrap_or(STIFF_N_PER_M);
    BristleChain::new(&pulleys, sigma_n_per_m, sensor_pulley, effects)
}
