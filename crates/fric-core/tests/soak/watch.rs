//! What holds for every cable in every cycle: finite, bounded, passive, flagged.

use fric_core::robot::{MonitorOptions, Presliding};
use fric_core::{CableInput, CableOutput, CableParams, CableStatus};

use super::bound::{amplitudes, effect, friction_bound_n, sensor_cos};
use super::robot::Robot;

/// Flags of signals that are not to be believed.
pub const FAULTY: CableStatus = CableStatus::SENSOR_NOT_FINITE
    .union(CableStatus::SENSOR_FROZEN)
    .union(CableStatus::LENGTH_JUMP)
    .union(CableStatus::MOTION_NOT_FINITE);

/// One cable of one compensator, watched.
#[derive(Clone)]
pub struct Watch {
    law: Law,
    monitor: MonitorOptions,
    cycle_s: f64,
    /// Last good sensor force as shown, N.
    shown_n: f64,
    /// Last length of a finite motion, m; NaN before the first.
    length_m: f64,
    greatest_force_n: f64,
    greatest_speed_m_per_s: f64,
    bound_n: f64,
    /// What the contacts store, N, and the scale of its rounding.
    stored: Option<([f64; 8], f64)>,
}

/// What of a cable's parameters the checks go by.
#[derive(Clone)]
struct Law {
    cable: CableParams,
    gain: f64,
    /// The sensor's own errors: gain, offset (N), drift (N/s).
    sensor: [f64; 3],
    /// Stiffness of a contact, N/m, where what it stores can be seen: on every pulley, or on the cable.
    contact_n_per_m: Option<f64>,
}

impl Law {
    fn new(cable: &CableParams, monitor: &MonitorOptions) -> Self {
        let sigma_n_per_m = cable.friction().sigma_n_per_m.unwrap();
        let is = |kind: &str, key: &str, neutral: f64| (effect(cable, kind, key) - neutral).abs() == 0.0;
        // The way of each contact has to be known: not delayed, not stretched, without play or slip.
        let way_is_known = is("time_delay", "delay_s", 0.0)
            && is("cable_elasticity", "compliance_m_per_n", 0.0)
            && is("gear_backlash", "play_m", 0.0)
            && monitor.length_noise_m == 0.0
            && cable.traction_mu().is_none();
        // What is stored is all the friction there is, and resists the motion.
        let is_plain = cable.friction().viscous_n_s_per_m == 0.0
            && is("pulley_inertia", "mass_kg", 0.0)
            && amplitudes(cable, "pulley_eccentricity", ["sin_ratio", "cos_ratio"]) == [0.0; 2]
            && amplitudes(cable, "winch_ripple", ["sin_n", "cos_n"]) == [0.0; 2]
            && is("sensor_gain", "gain", 1.0)
            && is("sensor_offset", "offset_n", 0.0)
            && is("sensor_drift", "rate_n_per_s", 0.0)
            && is("sensor_warmup", "final_n", 0.0)
            && is("sensor_nonlinearity", "curvature_per_n", 0.0)
            && is("sensor_lag", "time_constant_s", 0.0)
            && is("empirical", "force_n", 0.0)
            && is("viscous_nonlinearity", "quadratic_n_s2_per_m2", 0.0)
            && sensor_cos(cable) < 1e-9;
        #[expect(clippy::cast_precision_loss, reason = "a handful")]
        let contact_n_per_m = match cable.presliding() {
            Presliding::PerPulley if way_is_known => Some(sigma_n_per_m / cable.pulley_count() as f64),
            Presliding::Lumped if way_is_known && is_plain => Some(sigma_n_per_m),
            _ => None,
        };
        let sensor = [("sensor_gain", "gain"), ("sensor_offset", "offset_n"), ("sensor_drift", "rate_n_per_s")]
            .map(|(kind, key)| effect(cable, kind, key));
        Self { cable: *cable, gain: 1.0 / (1.0 - sensor_cos(cable)), sensor, contact_n_per_m }
    }
}

impl Watch {
    pub fn new(robot: &Robot, cable: &CableParams) -> Self {
        Self {
            law: Law::new(cable, &robot.monitor),
            monitor: robot.monitor,
            cycle_s: robot.cycle_s,
            shown_n: 0.0,
            length_m: f64::NAN,
            greatest_force_n: 0.0,
            greatest_speed_m_per_s: 0.0,
            bound_n: 0.0,
            stored: Some(([0.0; 8], 0.0)),
        }
    }

    /// Whether the friction of single pulleys is wanted of the compensator.
    pub fn wants_pulleys(&self) -> bool {
        self.law.contact_n_per_m.is_some() && self.law.cable.presliding() == Presliding::PerPulley
    }

    /// Checks a cycle; the `Err` is what is wrong.
    pub fn check(
        &mut self,
        (input, elapsed_cycles): (&CableInput, f64),
        time_s: f64,
        output: &CableOutput,
        pulley_friction_n: Option<[f64; 8]>,
    ) -> Result<(), String> {
        let CableOutput { force_at_platform_n, friction_n, frictionless_n, status } = *output;
        if ![force_at_platform_n, friction_n, frictionless_n].iter().all(|number| number.is_finite()) {
            return Err("not finite".to_owned());
        }
        let sensor_finite = input.sensor_force_n.abs() <= 1e9;
        if status.contains(CableStatus::SENSOR_NOT_FINITE) == sensor_finite {
            return Err("SENSOR_NOT_FINITE is not right".to_owned());
        }
        let motion_finite = input.length_m.abs() <= 1e6 && input.speed_m_per_s.abs() <= 1e6;
        if status.contains(CableStatus::MOTION_NOT_FINITE) == motion_finite {
            return Err("MOTION_NOT_FINITE is not right".to_owned());
        }
        let mut way_m = 0.0;
        if motion_finite {
            let change_m = input.length_m - self.length_m;
            let limit_m = self.monitor.length_jump_m * elapsed_cycles;
            if self.monitor.length_noise_m == 0.0
                && status.contains(CableStatus::LENGTH_JUMP) != (change_m.abs() > limit_m)
            {
                return Err(format!("LENGTH_JUMP is not right: {change_m} m"));
            }
            way_m = if change_m.abs() <= limit_m { change_m } else { 0.0 };
            self.length_m = input.length_m;
        }
        if sensor_finite {
            self.shown_n = input.sensor_force_n;
        }
        self.bounded(input, motion_finite, time_s, output)?;
        self.passive(way_m, output, pulley_friction_n)
    }

    fn bounded(
        &mut self,
        input: &CableInput,
        motion_finite: bool,
        time_s: f64,
        output: &CableOutput,
    ) -> Result<(), String> {
        let law = &self.law;
        let [gain, offset_n, rate_n_per_s] = law.sensor;
        let warmed = 1.0 - (-time_s / effect(&law.cable, "sensor_warmup", "time_constant_s")).exp();
        let added_n = offset_n + rate_n_per_s * time_s + effect(&law.cable, "sensor_warmup", "final_n") * warmed;
        let force_n = (self.shown_n - added_n) / gain;
        let speed_m_per_s = if motion_finite { input.speed_m_per_s.abs() } else { 0.0 };
        if force_n.abs() > self.greatest_force_n || speed_m_per_s > self.greatest_speed_m_per_s {
            // A little more than needed, so that it is not worked out anew in every cycle.
            self.greatest_force_n = self.greatest_force_n.max(1.01 * force_n.abs());
            self.greatest_speed_m_per_s = self.greatest_speed_m_per_s.max(1.01 * speed_m_per_s);
            self.bound_n =
                friction_bound_n(&law.cable, self.greatest_force_n, self.greatest_speed_m_per_s, self.cycle_s);
        }
        let friction_n = output.force_at_platform_n - law.cable.friction().offset_n - law.gain * force_n;
        if friction_n.abs() > self.bound_n * (1.0 + 1e-9) + 1e-9 * law.gain * force_n.abs() {
            return Err(format!("friction of {friction_n} N beyond {} N", self.bound_n));
        }
        Ok(())
    }

    /// Each contact dissipates: the work of its friction over the way, `f·Δl` with the friction after it, is at least what
    /// the energy `f²/2σ` that it stores has grown by.
    ///
    /// By Dahl's law `df/dx = σ(1 − s·f/f_c)` the work is `∫f dx = Δ(f²/2σ) + ∫(f²/f_c)|dx|`, and along the way `s·f` only grows
    /// towards `f_c`; where the load has fallen and it falls instead, the stored energy falls with it.
    fn passive(&mut self, way_m: f64, output: &CableOutput, pulley_friction_n: Option<[f64; 8]>) -> Result<(), String> {
        let Some(sigma_n_per_m) = self.law.contact_n_per_m else { return Ok(()) };
        // The step from a state to the next is rounded as the sliding friction, and so as the tension, which is what all contacts before it have stored too.
        let scale_n = output.frictionless_n.abs() + output.friction_n.abs() + self.law.cable.friction().offset_n.abs();
        let stored = match pulley_friction_n {
            Some(stored_n) => Some((stored_n, scale_n)),
            // What the cable stores is not to be seen while the output is held or slack.
            None if output.status.intersects(FAULTY | CableStatus::SLACK) => None,
            None => Some((std::array::from_fn(|place| if place == 0 { output.friction_n } else { 0.0 }), scale_n)),
        };
        if let (Some((before_n, scale_before_n)), Some((after_n, scale_n))) = (self.stored, stored) {
            for (before_n, after_n) in before_n.into_iter().zip(after_n) {
                let work_j = after_n * way_m;
                let stored_j = 0.5 * (after_n * after_n - before_n * before_n) / sigma_n_per_m;
                let largest_n = before_n.abs().max(after_n.abs());
                // Behind a sensor pulley of 90° what a lumped contact stores shows by the rounding of the cosine, 6·10⁻¹⁷, alone.
                let scale_n = largest_n + scale_n.max(scale_before_n) + 0.01;
                let rounding_j = 1e-13 * scale_n * (way_m.abs() + largest_n / sigma_n_per_m);
                if work_j - stored_j < -rounding_j - 1e-20 {
                    return Err(format!(
                        "fed {} J: from {before_n} N to {after_n} N over {way_m} m",
                        stored_j - work_j
                    ));
                }
            }
        }
        self.stored = stored;
        Ok(())
    }
}
