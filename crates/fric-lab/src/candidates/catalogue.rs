//! The effects that may be missing: the rows of the catalogue with the start values of their searches.
//!
//! A search starts from several points if an effect's parameters have no influence at their neutral values, or if its sum of squares has several
//! minima. The data decide between them.

use std::f64::consts::FRAC_PI_2;

use fric_core::effects::Effect;
use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, SIGMA, VISCOUS, Values};

use crate::certainty::assumed::is_assumed;
use crate::effects;
use crate::effects::{Around, Periods};
use crate::replay::Deviation;
use crate::samples::cable::{CableRecord, PLAY_OF_NOISE};
use crate::search::vector::Parameter;

/// Start value of μ for a frictionless model.
const TYPICAL_MU: f64 = 0.02;
/// Start values of the presliding distance for a model without presliding, m.
const PRESLIDING_M: [f64; 4] = [3e-5, 2e-4, 1e-3, 6e-3];

/// Returns the surroundings of a cable whose friction coefficient is `mu`, with this noise and without ripple.
pub fn around(record: &CableRecord<'_>, mu: f64, noise_n: f64) -> Around {
    let gain = record.params.frictionless_gain();
    let (mut tension, mut speed) = (Deviation::default(), Deviation::default());
    let (mut sum_n, mut count) = (0.0, 0.0_f64);
    for row in record.rows.iter().filter(|row| row.is_sound()) {
        tension.add(row.signals.sensor_force_n * gain);
        (sum_n, count) = (sum_n + row.signals.sensor_force_n * gain, count + 1.0);
        if row.signals.displacement_m.abs() > 0.0 {
            speed.add(row.signals.speed_m_per_s);
        }
    }
    let tension_n = tension.rms().unwrap_or(1.0);
    let mean_tension_n = sum_n / count.max(1.0);
    let varies_n = (tension_n * tension_n - mean_tension_n * mean_tension_n).max(0.0).sqrt();
    let presliding_m = mu * tension_n / record.params.values()[SIGMA];
    // A wrap that the pose decides is taken as 90°.
    let wrap_factors = || {
        let wraps_rad = record.params.fixed_wraps_rad().map(|wrap_rad| wrap_rad.unwrap_or(FRAC_PI_2));
        wraps_rad.map(|wrap_rad| 2.0 * (0.5 * wrap_rad).sin())
    };
    Around {
        cycle_s: record.cycle_s,
        interval_s: record.interval_s,
        tension_n,
        mean_tension_n,
        noise_n,
        friction_n: mu * tension_n,
        speed_m_per_s: speed.rms().unwrap_or(0.1).max(1e-4),
        end_s: record.rows.iter().map(|row| row.cycle).fold(0.0, f64::max) * record.cycle_s,
        mu,
        compliance_m_per_n: if varies_n > 0.0 { presliding_m / varies_n } else { 0.0 },
        length_noise_m: record.length_noise_m().unwrap_or(0.0).max(record.length_play_m / PLAY_OF_NOISE),
        pulley_count: u32::try_from(record.params.pulley_count()).unwrap_or(0),
        sensor_ratio: gain.recip(),
        wrap_factor_sum: wrap_factors().sum(),
        wrap_factor_square_sum: wrap_factors().map(|factor| factor * factor).sum(),
        periods: Periods::default(),
    }
}

/// Whether a model already has the effect.
pub fn has(effect: Effect, values: &Values) -> bool {
    match effect {
        Effect::Coulomb => values[MU] > 0.0,
        Effect::Viscous => values[VISCOUS] > 0.0,
        Effect::Presliding => values[SIGMA] < NO_PRESLIDING_N_PER_M,
        _ => Parameter::of(effect)
            .filter(|parameter| parameter.row().fitted)
            .any(|parameter| values[parameter.place()].to_bits() != parameter.row().neutral.to_bits()),
    }
}

/// Whether a fit varies a parameter once its effect acts, although it has no neutral value from which a candidate could start: the period of a ripple,
/// and the time in which contacts age at rest.
pub fn is_fitted_once_it_acts(parameter: &Parameter) -> bool {
    parameter.is_period() || is_assumed(parameter)
}

/// Returns the parameters that a fit varies for an effect.
pub fn fitted(effect: Effect) -> Vec<Parameter> {
    Parameter::of(effect).filter(|parameter| parameter.row().fitted).collect()
}

/// Returns the start values for an effect that is added to a model at `current`.
pub fn starts(effect: Effect, current: &Values, around: &Around, record: &CableRecord<'_>) -> Vec<Values> {
    let set = |changes: &[(&str, f64)]| {
        let mut values = *current;
        for (key, value) in changes {
            if let Some(parameter) = Parameter::of(effect).find(|parameter| parameter.row().key == *key) {
                values[parameter.place()] = value.clamp(parameter.row().min, parameter.row().max);
            }
        }
        values
    };
    #[expect(clippy::cast_precision_loss, reason = "at most MAX_PULLEYS")]
    let pulleys = record.params.pulley_count() as f64;
    let tenth_n = 0.1 * around.friction_n.max(0.01 * around.tension_n) / pulleys;
    match effect {
        Effect::Coulomb => vec![set(&[("mu", TYPICAL_MU)])],
        Effect::Viscous => vec![set(&[("viscous_n_s_per_m", tenth_n / around.speed_m_per_s)])],
        Effect::Presliding => {
            let one_n_per_m = record.params.memory_m_per_n(current[MU].max(1e-4), 1.0) * around.tension_n;
            PRESLIDING_M.map(|way_m| set(&[("sigma_n_per_m", one_n_per_m / way_m)])).to_vec()
        }
        _ => effects::of(effect).iter().flat_map(|lab| (lab.starts)(around)).map(|start| set(&start)).collect(),
    }
}
