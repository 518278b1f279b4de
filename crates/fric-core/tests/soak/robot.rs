//! Random robots: every form, every effect, parameters of machines that could be built.

use fric_core::effects::Effect;
use fric_core::robot::{
    CableOptions, FrictionOptions, GeometryOptions, MonitorOptions, PlatformOptions, Presliding, PulleyOptions,
    ValidatedRange,
};
use fric_core::{CableParams, Compensator, RobotParams};

use super::episode::MOST_CABLES;
use crate::random::Random;

/// A robot and what the checks have to know of it.
pub struct Robot {
    pub cables: Vec<CableParams>,
    pub cycle_s: f64,
    pub monitor: MonitorOptions,
}

impl Robot {
    pub fn new(random: &mut Random) -> Self {
        let cycle_s = pick(&[1e-3, 1e-3, 1e-3, 5e-4, 4e-3], random);
        let standard = MonitorOptions::for_cycle(cycle_s);
        let monitor = MonitorOptions {
            frozen_cycles: pick(&[0, 3, 20, 100], random),
            length_noise_m: pick(&[0.0, 0.0, 0.0, 1e-6, 1e-5], random),
            ..standard
        };
        let count = 1 + random.below(MOST_CABLES as u64);
        // Every other robot has effects, a few of them.
        let has_effects = once_in(random, 2);
        let kinds: Vec<&str> =
            Effect::kinds().map(Effect::kind).filter(|_| has_effects && once_in(random, 5)).collect();
        Self { cables: (0..count).map(|_| cable(random, cycle_s, &kinds)).collect(), cycle_s, monitor }
    }

    pub fn compensator(&self) -> Compensator<MOST_CABLES> {
        let platform = PlatformOptions { mass_kg: 2.0, center_of_mass_m: [0.01, 0.0, -0.02], ..Default::default() };
        let robot = RobotParams::new(self.cycle_s, &platform, self.monitor, &self.cables).unwrap();
        Compensator::new(&robot).unwrap()
    }
}

pub fn pick<T: Copy>(values: &[T], random: &mut Random) -> T {
    values[usize::try_from(random.below(values.len() as u64)).unwrap()]
}

/// True once in so many times.
pub fn once_in(random: &mut Random, times: u64) -> bool {
    random.below(times) == 0
}

/// Between two positive numbers, every order of magnitude as often.
pub fn magnitude(random: &mut Random, least: f64, greatest: f64) -> f64 {
    least * (greatest / least).powf(random.unit())
}

fn cable(random: &mut Random, cycle_s: f64, kinds: &[&str]) -> CableParams {
    // What is at odds with itself, such as a sensor pulley of hardly any wrap, is drawn again.
    loop {
        if let Ok(cable) = any_cable(random, cycle_s, kinds) {
            return cable;
        }
    }
}

fn any_cable(random: &mut Random, cycle_s: f64, kinds: &[&str]) -> Result<CableParams, fric_core::ParamError> {
    let mut pulleys: Vec<PulleyOptions> = (0..=random.below(5)).map(|_| fixed(random)).collect();
    if let PulleyOptions::Fixed { wrap_rad, sensor } = &mut pulleys[0]
        && !once_in(random, 3)
    {
        *sensor = true;
        *wrap_rad = pick(&[std::f64::consts::PI, std::f64::consts::FRAC_PI_2, *wrap_rad], random);
    }
    if once_in(random, 2) {
        let radius_m = pick(&[0.0, 0.01, 0.05], random);
        let swivel = PulleyOptions::Swivel { radius_m, axis: random.unit_vector() };
        if pulleys.len() > 1 { *pulleys.last_mut().unwrap() = swivel } else { pulleys.push(swivel) }
    }
    let mut options = CableOptions {
        presliding: pick(&[Presliding::PerPulley, Presliding::Lumped], random),
        friction: FrictionOptions {
            mu: pick(&[0.0, 0.02, random.range(0.0, 0.05), random.range(0.0, 0.2)], random),
            sigma_n_per_m: Some(magnitude(random, 300.0, 1e5)),
            viscous_n_s_per_m: pick(&[0.0, 0.0, random.range(0.0, 2.0)], random),
            offset_n: pick(&[0.0, random.range(-1.0, 1.0)], random),
        },
        geometry: Some(GeometryOptions { base_m: random.vector(1.0), platform_m: random.vector(0.05) }),
        traction_mu: once_in(random, 6).then(|| random.range(0.03, 1.0)),
        ..CableOptions::new(&pulleys)
    };
    if once_in(random, 2) {
        options.validated = ValidatedRange { force_n: [0.5, 80.0], speed_m_per_s: 2.0 };
    }
    add_effects(random, cycle_s, kinds, &mut options);
    CableParams::new(&options)
}

fn fixed(random: &mut Random) -> PulleyOptions {
    let wrap_rad = pick(&[0.0, std::f64::consts::FRAC_PI_2, random.range(0.0, 1.9 * std::f64::consts::PI)], random);
    PulleyOptions::Fixed { wrap_rad, sensor: false }
}

#[expect(clippy::cast_precision_loss, reason = "a few pulleys")]
fn add_effects(random: &mut Random, cycle_s: f64, kinds: &[&str], options: &mut CableOptions<'_>) {
    // Friction that follows a tension it adds to is stable below 1, see `cable_elasticity`.
    let sensor_gain = match options.pulleys[0] {
        PulleyOptions::Fixed { wrap_rad, sensor: true } => wrap_rad.cos().abs() / (1.0 - wrap_rad.cos()),
        _ => 0.0,
    };
    let stable_m_per_n = 1.0 / (options.friction.sigma_n_per_m.unwrap_or(1.0) * sensor_gain.max(1.0));
    if kinds.is_empty() {
        return;
    }
    for effect in Effect::CATALOGUE.iter().filter(|effect| kinds.contains(&effect.kind())) {
        for (parameter, example) in effect.row().parameters.iter().zip(effect.row().example) {
            // Not all cables alike.
            if once_in(random, 3) {
                continue;
            }
            let value = match (effect, parameter.key) {
                (Effect::CableElasticity, "compliance_m_per_n") => random.range(0.0, 0.5) * stable_m_per_n,
                // One of those that there are.
                (Effect::PulleyDefect, "pulley") => pick(&[1.0, options.pulleys.len() as f64], random),
                (Effect::TimeDelay, _) => cycle_s * random.range(-10.0, 40.0),
                // Both ways from neutral, and beyond what the example has; a setting of another order of magnitude.
                (_, _) if parameter.fitted => {
                    parameter.neutral + (example - parameter.neutral) * random.range(-2.0, 3.0)
                }
                (_, _) => example * magnitude(random, 0.1, 10.0),
            };
            options.effects.set(*effect, parameter.key, value.clamp(parameter.min, parameter.max)).unwrap();
        }
    }
}
