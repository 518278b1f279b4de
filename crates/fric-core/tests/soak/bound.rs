//! How much friction a cable can have: from its parameters and the greatest force and speed there have been.
//!
//! Written from the equations' magnitudes, not from the cycle: at each pulley `f ≤ μk(T_0 + T_1)/2 + drag` and
//! `T_1 ≤ T_0 + f + F_pv|v| + m|a|`, whatever the direction; at the sensor pulley `T_1 = (F_s − c(f + F_pv v))/(1 − c)`.

use std::f64::consts::PI;

use fric_core::CableParams;
use fric_core::effects::Effect;

/// The run lasts no longer than this, s: what a drift can come to.
const LONGEST_RUN_S: f64 = 200.0;

/// An effect's parameter.
pub fn effect(cable: &CableParams, kind: &str, key: &str) -> f64 {
    cable.effects().get(Effect::of_kind(kind).unwrap(), key).unwrap()
}

/// Amplitudes of the two ripples of a kind, from those of sine and cosine.
pub fn amplitudes(cable: &CableParams, kind: &str, keys: [&str; 2]) -> [f64; 2] {
    let mut both = Effect::all_of_kind(kind).map(|effect| {
        let [sin, cos] = keys.map(|key| cable.effects().get(effect, key).unwrap());
        sin.hypot(cos)
    });
    [(); 2].map(|()| both.next().unwrap())
}

/// The greatest factor of two ripples together.
fn factor([one, other]: [f64; 2]) -> f64 {
    (1.0 + one) * (1.0 + other)
}

/// The greatest μ that stands at a pulley, by its number from 1, at the reference load of `load_nonlinearity`.
#[expect(clippy::cast_precision_loss, reason = "a few pulleys")]
pub fn greatest_mu_at(cable: &CableParams, pulley: usize) -> f64 {
    let has_defect = effect(cable, "pulley_defect", "pulley") == pulley as f64;
    let mu = cable.friction().mu;
    let mu = if has_defect { mu.max(effect(cable, "pulley_defect", "mu")) } else { mu };
    mu * (1.0 + effect(cable, "stribeck", "ratio").max(0.0))
        * (1.0 + effect(cable, "dwell_stiction", "ratio").max(0.0))
        * (1.0 + effect(cable, "friction_warmup", "ratio").max(0.0))
        * factor(amplitudes(cable, "friction_ripple", ["sin_ratio", "cos_ratio"]))
        * (1.0 + effect(cable, "empirical", "friction_ratio").abs())
        * (1.0 + effect(cable, "direction_asymmetry", "coulomb_ratio").abs())
        * (1.0 + effect(cable, "friction_drift", "rate_per_s").abs() * LONGEST_RUN_S)
}

/// The greatest of all pulleys.
pub fn greatest_mu(cable: &CableParams) -> f64 {
    (1..=cable.pulley_count()).fold(0.0, |greatest, pulley| greatest_mu_at(cable, pulley).max(greatest))
}

/// By how much what the contacts of a chain are apart may grow in sum: what one is apart is load of those behind it, whose sliding friction goes with the
/// load, `Π(1 + df/dT)`.
pub fn chain_growth(cable: &CableParams) -> f64 {
    let exponent = effect(cable, "load_nonlinearity", "exponent");
    // Where μ goes with the load, it may go up to its limit.
    let mu = if exponent == 1.0 { greatest_mu(cable).min(core_mu_limit(cable)) } else { core_mu_limit(cable) };
    let growth = |wrap_rad: Option<f64>| {
        let half = mu * (0.5 * wrap_rad.unwrap_or(PI)).sin();
        1.0 + exponent.max(1.0) * 2.0 * half / (1.0 - half).max(0.05)
    };
    cable.fixed_wraps_rad().map(growth).product()
}

/// cos α₁ of the sensor pulley; 0 for a sensor in line.
pub fn sensor_cos(cable: &CableParams) -> f64 {
    cable.sensor_wrap_rad().map_or(0.0, f64::cos)
}

/// The greatest friction of a cable, N, for forces (N, corrected) and speeds (m/s) up to these.
pub fn friction_bound_n(cable: &CableParams, force_n: f64, speed_m_per_s: f64, cycle_s: f64) -> f64 {
    let value = |kind, key| effect(cable, kind, key);
    // Where the force of the sensor is not known from what it shows in the cycle, nothing is known of the friction.
    let is_open = [("sensor_lag", "time_constant_s"), ("sensor_nonlinearity", "curvature_per_n")];
    if is_open.iter().any(|(kind, key)| value(kind, key).abs() > 0.0) {
        return f64::INFINITY;
    }
    let mu = greatest_mu(cable);
    let drag_n = value("bearing_drag", "drag_n");
    let viscous = cable.friction().viscous_n_s_per_m * (1.0 + value("direction_asymmetry", "viscous_ratio").abs());
    let window_s = value("pulley_inertia", "window_s") + cycle_s;
    // A lead takes the speed of three moments, 3, −3 and 1 times: of one that turns round 7 times.
    let led = if value("time_delay", "delay_s") < 0.0 { 7.0 } else { 1.0 };
    let speed_m_per_s = led * speed_m_per_s;
    // The acceleration is (1 + r, −1 − 2r, r) times the speed and its low passes by the window, r the share that it is led by.
    let lead_ratio = 1.0 - 0.5 * cycle_s / window_s;
    let accelerating = value("pulley_inertia", "mass_kg") * 2.0 * (1.0 + 2.0 * lead_ratio) / window_s;
    let quadratic = value("viscous_nonlinearity", "quadratic_n_s2_per_m2") * speed_m_per_s;
    let moved_n = speed_m_per_s * (viscous + quadratic + accelerating);
    // A slip limit takes from the stored friction what viscous friction is too much, and that stays stored.
    let stored_too_n = if cable.traction_mu().is_some() { 2.0 * moved_n } else { 0.0 };

    let cos = sensor_cos(cable);
    let gain = 1.0 / (1.0 - cos);
    // What the winch adds to what is shown, or takes from it.
    let winch_n: f64 = amplitudes(cable, "winch_ripple", ["sin_n", "cos_n"]).iter().sum();
    let rippled_n = gain * winch_n / value("sensor_gain", "gain");
    let mut tension_n = gain * force_n + rippled_n;
    let mut friction_n = rippled_n;
    for (place, wrap_rad) in cable.fixed_wraps_rad().enumerate() {
        let wrap_factor = 2.0 * (0.5 * wrap_rad.unwrap_or(PI)).sin();
        let is_sensor = place == 0 && cable.sensor_wrap_rad().is_some();
        let share = if is_sensor { gain * cos.abs() } else { 1.0 };
        // Both tensions together are at most 2T + (2·share + 1)(f + moved) at the sensor pulley, 2T + f + moved behind.
        let both = if is_sensor { 2.0 * share + 1.0 } else { 1.0 };
        let outside_n = 2.0 * tension_n + both * (moved_n + stored_too_n);
        let Some(sliding_n) = most_sliding_n(cable, (mu, wrap_factor), (outside_n, both), drag_n) else {
            return f64::INFINITY;
        };
        let stored_n = sliding_n + stored_too_n;
        friction_n += share * (stored_n + moved_n);
        tension_n += share * (stored_n + moved_n);
    }
    let ripple = factor(amplitudes(cable, "pulley_eccentricity", ["sin_ratio", "cos_ratio"])) - 1.0;
    // A slack cable's friction takes all its tension away.
    friction_n.max(gain * force_n + rippled_n) + ripple * tension_n + value("empirical", "force_n").abs()
}

/// The greatest friction `f = μ(F_N)·F_N + drag` of a sliding pulley, N, whose normal force is `k/2` times `outside_n + both·f`; `None` if it is hardly bounded.
fn most_sliding_n(
    cable: &CableParams,
    (mu, wrap_factor): (f64, f64),
    (outside_n, both): (f64, f64),
    drag_n: f64,
) -> Option<f64> {
    let [exponent, reference_n] = ["exponent", "reference_n"].map(|key| effect(cable, "load_nonlinearity", key));
    let proportional_n = |mu: f64| {
        let half = 0.5 * mu * wrap_factor;
        let left = 1.0 - half * both;
        (left > 0.05).then(|| (half * outside_n + drag_n) / left)
    };
    if exponent == 1.0 {
        return proportional_n(mu);
    }
    let most_mu = core_mu_limit(cable);
    let law_n = |friction_n: f64| {
        let normal_n = 0.5 * wrap_factor * (outside_n + both * friction_n);
        let factor = (normal_n / reference_n).max(1e-6).powf(exponent - 1.0);
        normal_n * (mu * factor).min(most_mu) + drag_n
    };
    // The law grows with the load, so going over it from above comes down to the greatest solution, and never passes it. Where the limit of μ bounds
    // nothing, an exponent below 1 does.
    let start_n = proportional_n(most_mu).or((exponent < 1.0).then_some(1e15))?;
    Some((0..300).fold(start_n, |friction_n, _| law_n(friction_n).min(friction_n)))
}

/// The limit that set-up puts on μ, 0.9, or less where two thirds of the sensor pulley's signal would be lost to friction.
fn core_mu_limit(cable: &CableParams) -> f64 {
    let taken = cable.sensor_wrap_rad().map_or(0.0, |wrap_rad| 2.0 * (0.5 * wrap_rad).sin() * (1.0 + wrap_rad.cos()));
    if taken > 0.0 { (4.0 / 3.0 * (1.0 - sensor_cos(cable)) / taken).min(0.9) } else { 0.9 }
}
