//! What is hidden in a case, on which cables, and how strong.

use fric_core::effects::Effect;
use fric_core::effects::ripple::PERIOD_KEY;
use rand_chacha::ChaCha8Rng;

use super::super::case::NORMAL_PER_TENSION;
use super::super::robots::CABLE_COUNT;
use super::super::values;
use super::robot::Body;
use super::{WrenchCase, WrenchGroup};
use crate::effects::Sizing;
use crate::random::uniform;
use crate::simulate::error::HiddenError;
use crate::simulate::hidden::HiddenEffect;

/// By how much a wrong mass is off at full strength, as a share, and a wrong point, m.
const MASS_RATIO: f64 = 0.08;
const BASE_M: f64 = 0.015;
/// Circumference of the pulleys, m: a ripple turns with them, and a run goes through several turns.
const PULLEY_M: f64 = core::f64::consts::TAU * 0.01;
/// Standard gravity, m/s², and the mass below which the tensions do not fall further, kg.
const G_M_PER_S2: f64 = 9.80665;
const LIGHT_KG: f64 = 0.41;
/// Amplitude of hum at full strength, N.
const HUM_N: f64 = 0.12;

/// A number of the robot file that is not right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Misstated {
    /// The mass of the platform.
    Mass,
    /// Where this cable enters its last pulley.
    Base(usize),
}

/// A line of the mains in a force sensor.
#[derive(Clone, Copy, Debug)]
pub struct Hum {
    pub amplitude_n: f64,
    pub frequency_hz: f64,
    pub phase_rad: f64,
}

/// What the seed has drawn.
#[derive(Debug)]
pub struct Drawn {
    /// The robot of the log, with its effects.
    pub truth: Body,
    /// The robot as its file describes it.
    pub given: Body,
    pub misstated: Option<Misstated>,
    pub hum: Vec<Option<Hum>>,
}

/// Draws the robot and what is hidden in its log.
pub fn draw(case: &WrenchCase, duration_s: f64, random: &mut ChaCha8Rng) -> Result<Drawn, HiddenError> {
    let mut truth = Body::draw(random);
    // Two different cables.
    let one = below(random, CABLE_COUNT);
    let other = (one + 1 + below(random, CABLE_COUNT - 1)) % CABLE_COUNT;
    let mut given = truth.guessed();
    let mut hide = |cables: &[usize], effect: Effect, is_alike: bool| -> Result<(), HiddenError> {
        let mut first = None;
        for cable in cables {
            let drawn = effect_on(case, &truth, *cable, effect, duration_s, random)?;
            let drawn = if is_alike { first.get_or_insert(drawn).clone() } else { drawn };
            truth.effects[*cable].push(drawn);
        }
        Ok(())
    };
    let all: Vec<usize> = (0..CABLE_COUNT).collect();
    let (mut misstated, mut hum) = (None, vec![None; CABLE_COUNT]);
    match case.group {
        WrenchGroup::Nothing | WrenchGroup::Hand | WrenchGroup::Hum | WrenchGroup::Mass | WrenchGroup::Base => {}
        WrenchGroup::Gain | WrenchGroup::HumAndGain => hide(&[one], Effect::SensorGain, false)?,
        WrenchGroup::GainOnEach => hide(&all, Effect::SensorGain, false)?,
        WrenchGroup::GainOnAll => hide(&all, Effect::SensorGain, true)?,
        WrenchGroup::Drag => hide(&[one], Effect::BearingDrag, false)?,
        WrenchGroup::DragOnAll => hide(&all, Effect::BearingDrag, true)?,
        WrenchGroup::Stribeck => hide(&[one, other], Effect::Stribeck, false)?,
        WrenchGroup::Inertia => hide(&[one], Effect::PulleyInertia, false)?,
        WrenchGroup::InertiaOnAll => hide(&all, Effect::PulleyInertia, true)?,
        WrenchGroup::Asymmetry => hide(&[one], Effect::DirectionAsymmetry, false)?,
        WrenchGroup::Ripple => hide(&[one], Effect::PulleyEccentricity, false)?,
        WrenchGroup::WinchRipple => hide(&[one], Effect::WinchRipple, false)?,
        WrenchGroup::Delay => hide(&[one], Effect::TimeDelay, false)?,
        WrenchGroup::DelayOnAll => hide(&all, Effect::TimeDelay, true)?,
        WrenchGroup::GainAndDrag => {
            hide(&[one], Effect::SensorGain, false)?;
            hide(&all, Effect::BearingDrag, true)?;
        }
        WrenchGroup::GainAndStribeck => {
            hide(&[one], Effect::SensorGain, false)?;
            hide(&[other], Effect::Stribeck, false)?;
        }
    }
    match case.group {
        WrenchGroup::Hum => hum[one] = Some(Hum::draw(case, random)),
        WrenchGroup::HumAndGain => {
            let line = Hum::draw(case, random);
            hum.fill_with(|| Some(Hum { phase_rad: uniform(random, 0.0, core::f64::consts::TAU), ..line }));
        }
        WrenchGroup::Mass => {
            given.mass_kg *= 1.0 + either(case.strength_ratio * MASS_RATIO, random);
            misstated = Some(Misstated::Mass);
        }
        WrenchGroup::Base => {
            let [base_m, _] = &mut given.points_m[one];
            for number in base_m {
                *number += either(case.strength_ratio * BASE_M, random);
            }
            misstated = Some(Misstated::Base(one));
        }
        _ => {}
    }
    Ok(Drawn { truth, given, misstated, hum })
}

impl Hum {
    fn draw(case: &WrenchCase, random: &mut ChaCha8Rng) -> Self {
        Self {
            amplitude_n: case.strength_ratio * HUM_N * uniform(random, 0.85, 1.15),
            frequency_hz: if uniform(random, -1.0, 1.0) < 0.0 { 50.0 } else { 60.0 },
            phase_rad: uniform(random, 0.0, core::f64::consts::TAU),
        }
    }

    pub fn force_n(&self, time_s: f64) -> f64 {
        self.amplitude_n * libm::sin(core::f64::consts::TAU * self.frequency_hz * time_s + self.phase_rad)
    }
}

fn effect_on(
    case: &WrenchCase,
    body: &Body,
    cable: usize,
    effect: Effect,
    duration_s: f64,
    random: &mut ChaCha8Rng,
) -> Result<HiddenEffect, HiddenError> {
    let friction = body.friction[cable];
    let tension_n = body.mass_kg.max(LIGHT_KG) * G_M_PER_S2 + 3.0 * friction.viscous_n_s_per_m;
    let drawn = values::effect(
        effect,
        &mut Sizing {
            strength_ratio: case.strength_ratio,
            mu: friction.mu,
            tension_n,
            normal_n: NORMAL_PER_TENSION * tension_n,
            duration_s,
            random,
        },
    )?;
    let of_this_robot = |(key, value): &(&'static str, f64)| (*key, if *key == PERIOD_KEY { PULLEY_M } else { *value });
    HiddenEffect::of(effect, &drawn.values().iter().map(of_this_robot).collect::<Vec<_>>())
}

/// A size of either sign, drawn around a full one.
fn either(full: f64, random: &mut ChaCha8Rng) -> f64 {
    let value = full * uniform(random, 0.85, 1.15);
    if uniform(random, -1.0, 1.0) < 0.0 { -value } else { value }
}

/// A whole number below a small count.
fn below(random: &mut ChaCha8Rng, count: usize) -> usize {
    #[expect(clippy::cast_precision_loss, reason = "a count of cables")]
    let place = uniform(random, 0.0, count as f64);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below the count")]
    let place = place as usize;
    place.min(count - 1)
}
