//! What may be missing: the rows of the catalogue, each with where its search starts.
//!
//! An effect whose parameters say nothing at their neutral values, or whose sum of squares has several valleys, is started
//! from several places; the data tell which.

use std::f64::consts::TAU;

use fric_core::effects::{CATALOGUE, EffectRow};
use fric_core::parameters::{MU, NO_PRESLIDING_N_PER_M, SIGMA, VISCOUS, Values};

use crate::fit::{CableRecord, Parameter};

/// μ that a frictionless model starts from.
const TYPICAL_MU: f64 = 0.02;
/// Presliding distances that a model without presliding starts from, m.
const PRESLIDING_M: [f64; 4] = [3e-5, 2e-4, 1e-3, 6e-3];
/// Speeds at which friction may change, as shares of the speed at which the cable moves for the most part.
const SPEED_SHARES: [f64; 2] = [0.04, 0.25];
/// Periods of a ripple that are looked for, and the strongest of them that are tried.
const PERIODS: usize = 512;
const MOST_PERIODS: usize = 2;

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
    /// Periods at which the residual ripples with the cable's length, m.
    pub periods_m: Vec<f64>,
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
        "bearing_drag" => vec![set(&[("drag_n", tenth_n)])],
        "load_nonlinearity" => vec![set(&[("reference_n", scale.tension_n)])],
        "time_delay" => [-4.0, 4.0].map(|cycles| set(&[("delay_s", cycles * record.cycle_s)])).to_vec(),
        "pulley_inertia" => {
            [0.0, 10.0].map(|cycles| set(&[("mass_kg", 0.01), ("window_s", cycles * record.cycle_s)])).to_vec()
        }
        "pulley_eccentricity" => {
            let of_period = |period_m: &f64| set(&[("sin_ratio", 1e-3), ("cos_ratio", 1e-3), ("period_m", *period_m)]);
            scale.periods_m.iter().map(of_period).collect()
        }
        // Twice the noise of the sensor; that of the reference is in what is known of it too.
        "cable_elasticity" => [(1e-4, 1.0), (1e-4, 1.6)]
            .map(|(compliance, plays)| set(&[("compliance_m_per_n", compliance), ("play_n", plays * scale.noise_n)]))
            .to_vec(),
        _ => vec![*current],
    }
}

/// The periods in the cable's length at which a residual ripples in proportion to the tension, the strongest first.
pub fn periods_m(record: &CableRecord<'_>, residual_n: &[f64]) -> Vec<f64> {
    /// Samples that are enough.
    const ENOUGH: usize = 6000;
    let moving = record.rows.iter().zip(residual_n).filter(|(row, residual_n)| {
        residual_n.is_finite() && row.signals.displacement_m.abs() > 0.0 && row.signals.sensor_force_n > 0.0
    });
    let samples: Vec<(f64, f64)> =
        moving.map(|(row, residual_n)| (row.signals.length_m, residual_n / row.signals.sensor_force_n)).collect();
    let (least_m, greatest_m) =
        samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), (length_m, _)| {
            (least.min(*length_m), most.max(*length_m))
        });
    let range_m = greatest_m - least_m;
    if samples.len() < ENOUGH / 10 || range_m <= 0.0 {
        return Vec::new();
    }
    let few: Vec<(f64, f64)> = samples.iter().step_by(samples.len() / ENOUGH + 1).copied().collect();
    let powers: Vec<(f64, f64)> = (3..PERIODS)
        .map(|half_turns| {
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let period_m = 2.0 * range_m / half_turns as f64;
            (period_m, ripple_power(&few, period_m))
        })
        .collect();
    let mut peaks: Vec<(f64, f64)> = powers
        .windows(3)
        .filter(|three| three[1].1 > three[0].1 && three[1].1 >= three[2].1)
        .map(|three| three[1])
        .collect();
    peaks.sort_by(|one, other| other.1.total_cmp(&one.1));
    peaks.into_iter().take(MOST_PERIODS).map(|(period_m, _)| period_m).collect()
}

/// How much of the squares a sine of a period takes away, beside a constant.
fn ripple_power(samples: &[(f64, f64)], period_m: f64) -> f64 {
    let (mut matrix, mut right) = (nalgebra::Matrix3::<f64>::zeros(), nalgebra::Vector3::<f64>::zeros());
    for (length_m, ratio) in samples {
        let (sin, cos) = (TAU * length_m / period_m).sin_cos();
        let row = nalgebra::Vector3::new(1.0, sin, cos);
        matrix += row * row.transpose();
        right += row * *ratio;
    }
    let constant = right[0] * right[0] / matrix[(0, 0)];
    matrix.cholesky().map_or(0.0, |factor| factor.solve(&right).dot(&right) - constant)
}
