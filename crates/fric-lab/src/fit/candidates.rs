//! What may be missing: the rows of the catalogue, each with where its search starts.
//!
//! An effect whose parameters say nothing at their neutral values, or whose sum of squares has several valleys, is started
//! from several places; the data tell which.

use fric_core::effects::{CATALOGUE, EffectRow};
use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, SIGMA, VISCOUS, Values};

use super::record::CableRecord;
use super::vector::Parameter;
use crate::replay::Deviation;

/// μ that a frictionless model starts from.
const TYPICAL_MU: f64 = 0.02;
/// Presliding distances that a model without presliding starts from, m.
const PRESLIDING_M: [f64; 4] = [3e-5, 2e-4, 1e-3, 6e-3];
/// Speeds at which friction may change, as shares of the speed at which the cable moves for the most part.
const SPEED_SHARES: [f64; 2] = [0.04, 0.25];
/// Time constants with which the acceleration is taken, in cycles: the noisier the speed, the longer.
const INERTIA_WINDOWS: [f64; 4] = [0.0, 1.0, 4.0, 16.0];

/// What the starts of a cable are made of.
#[derive(Clone, Debug)]
pub struct Scale {
    /// Root mean square of the cable tension, N.
    pub tension_n: f64,
    /// Standard deviation of the noise, N.
    pub noise_n: f64,
    /// Root mean square of the friction found so far, N.
    pub friction_n: f64,
    /// The same of the speed while it moves, m/s.
    pub speed_m_per_s: f64,
    /// Time from the first sample to the last, of the longest log, s.
    pub end_s: f64,
    /// Periods at which the residual ripples with the cable's length, m.
    pub periods_m: Vec<f64>,
}

impl Scale {
    /// Of a cable whose friction has come to a coefficient of `mu`, with this much noise; no ripple.
    pub fn of(record: &CableRecord<'_>, mu: f64, noise_n: f64) -> Self {
        let gain = record.params.frictionless_gain();
        let (mut tension, mut speed) = (Deviation::default(), Deviation::default());
        for row in record.rows.iter().filter(|row| row.is_sound()) {
            tension.add(row.signals.sensor_force_n * gain);
            if row.signals.displacement_m.abs() > 0.0 {
                speed.add(row.signals.speed_m_per_s);
            }
        }
        let tension_n = tension.rms().unwrap_or(1.0);
        Self {
            tension_n,
            noise_n,
            friction_n: mu * tension_n,
            speed_m_per_s: speed.rms().unwrap_or(0.1).max(1e-4),
            end_s: record.rows.iter().map(|row| row.cycle).fold(0.0, f64::max) * record.cycle_s,
            periods_m: Vec::new(),
        }
    }
}

/// Whether a row is of the friction that every model can have, not of an effect.
pub fn is_friction(row: &EffectRow) -> bool {
    !CATALOGUE.iter().any(|of| of.kind == row.kind)
}

/// Whether a model has what a row of the catalogue adds.
pub fn has(row: &EffectRow, values: &Values) -> bool {
    match row.kind {
        "coulomb" => values[MU] > 0.0,
        "viscous" => values[VISCOUS] > 0.0,
        "presliding" => values[SIGMA] < NO_PRESLIDING_N_PER_M,
        _ => Parameter::of_row(row)
            .filter(|parameter| parameter.row().fitted)
            .any(|parameter| values[parameter.place()].to_bits() != parameter.row().neutral.to_bits()),
    }
}

/// Parameters that a fit varies for a row.
pub fn fitted(row: &EffectRow) -> Vec<Parameter> {
    Parameter::of_row(row).filter(|parameter| parameter.row().fitted).collect()
}

/// Values to start from when a row joins a model that has come to `current`.
pub fn starts(row: &EffectRow, current: &Values, scale: &Scale, record: &CableRecord<'_>) -> Vec<Values> {
    let set = |changes: &[(&str, f64)]| {
        let mut values = *current;
        for (key, value) in changes {
            if let Some(parameter) = Parameter::of_row(row).find(|parameter| parameter.row().key == *key) {
                values[parameter.place()] = value.clamp(parameter.row().min, parameter.row().max);
            }
        }
        values
    };
    #[expect(clippy::cast_precision_loss, reason = "at most MAX_PULLEYS")]
    let pulleys = record.params.pulley_count() as f64;
    let tenth_n = 0.1 * scale.friction_n.max(0.01 * scale.tension_n) / pulleys;
    match row.kind {
        "coulomb" => vec![set(&[("mu", TYPICAL_MU)])],
        "viscous" => vec![set(&[("viscous_n_s_per_m", tenth_n / scale.speed_m_per_s)])],
        "presliding" => {
            let one_n_per_m = record.params.memory_m_per_n(current[MU].max(1e-4), 1.0) * scale.tension_n;
            PRESLIDING_M.map(|way_m| set(&[("sigma_n_per_m", one_n_per_m / way_m)])).to_vec()
        }
        "stribeck" => {
            let of_share = |share: f64| set(&[("ratio", 0.3), ("velocity_m_per_s", share * scale.speed_m_per_s)]);
            SPEED_SHARES.map(of_share).to_vec()
        }
        "load_nonlinearity" => vec![set(&[("reference_n", scale.tension_n)])],
        "time_delay" => [-4.0, 4.0].map(|cycles| set(&[("delay_s", cycles * record.cycle_s)])).to_vec(),
        "pulley_inertia" => INERTIA_WINDOWS.map(|cycles| set(&[("window_s", cycles * record.cycle_s)])).to_vec(),
        "pulley_eccentricity" => {
            let of_period = |period_m: &f64| set(&[("sin_ratio", 1e-3), ("cos_ratio", 1e-3), ("period_m", *period_m)]);
            scale.periods_m.iter().map(of_period).collect()
        }
        "friction_drift" | "sensor_drift" => vec![set(&[("until_s", scale.end_s)])],
        // Twice the noise of the sensor; that of the reference is in what is known of it too.
        "cable_elasticity" => [1.0, 1.6].map(|plays| set(&[("play_n", plays * scale.noise_n)])).to_vec(),
        _ => vec![*current],
    }
}
