//! The whole cycle once more: one cable at a time, angles instead of vector algebra, the platform's `exp`.
//!
//! Written from `[P]` and the sign convention of the crate's documentation, not from its code. Knows no faults.

use crate::support::{add, cross, dot, norm, scale};

#[derive(Clone)]
pub struct Geometry {
    pub base_m: [f64; 3],
    pub platform_m: [f64; 3],
    pub axis: [f64; 3],
    pub radius_m: f64,
}

/// How a cable leaves its swivelling pulley, by angles.
pub struct Exit {
    pub wrap_rad: f64,
    /// From the attachment to the exit point.
    pub direction: [f64; 3],
}

impl Geometry {
    /// The swivelling pulley by its angles φ and γ.
    pub fn exit(&self, attachment_m: [f64; 3]) -> Exit {
        let relative = add(attachment_m, scale(self.base_m, -1.0));
        let z = dot(relative, self.axis);
        let radial = add(relative, scale(self.axis, -z));
        let x = norm(radial);
        let r = self.radius_m;
        let centre_distance = (x - r).hypot(z);
        let angle = z.atan2(x - r) + (r / centre_distance).acos();
        let (tangent_x, tangent_z) = (r + r * angle.cos(), r * angle.sin());
        let outward = if x > 0.0 { scale(radial, 1.0 / x) } else { [0.0; 3] };
        let tangent = add(scale(outward, tangent_x), scale(self.axis, tangent_z));
        let free = add(tangent, scale(relative, -1.0));
        let wrap_rad = std::f64::consts::PI - angle;
        Exit { wrap_rad, direction: scale(free, 1.0 / norm(free)) }
    }
}

/// What the catalogue can add to a cable.
#[derive(Clone, Copy)]
pub struct Effects {
    pub coulomb_ratio: f64,
    pub viscous_ratio: f64,
    pub drag_n: f64,
    pub load_exponent: f64,
    pub load_reference_n: f64,
    pub drift_per_s: f64,
    pub dahl_exponent: f64,
    pub gain: f64,
    pub sensor_offset_n: f64,
    pub sensor_drift_n_per_s: f64,
    pub mass_kg: f64,
    pub mass_window_s: f64,
    pub ripples: [[f64; 3]; 2],
    pub compliance_m_per_n: f64,
    pub stretch_play_n: f64,
}

impl Effects {
    pub const NONE: Self = Self {
        coulomb_ratio: 0.0,
        viscous_ratio: 0.0,
        drag_n: 0.0,
        load_exponent: 1.0,
        load_reference_n: 10.0,
        drift_per_s: 0.0,
        dahl_exponent: 1.0,
        gain: 1.0,
        sensor_offset_n: 0.0,
        sensor_drift_n_per_s: 0.0,
        mass_kg: 0.0,
        mass_window_s: 0.002,
        ripples: [[0.0, 0.0, 0.1]; 2],
        compliance_m_per_n: 0.0,
        stretch_play_n: 0.0,
    };
}

/// What the effects remember.
#[derive(Clone, Copy, Default)]
pub struct Memory {
    cycles: u32,
    speed: f64,
    slow_speed: f64,
    slower_speed: f64,
    settled_n: f64,
    waiting_m: f64,
    friction_n: f64,
}

const CYCLE_S: f64 = 0.001;

#[derive(Clone)]
pub struct Cable {
    pub lumped: bool,
    /// Wraps from the winch; `None` follows the pose.
    pub wraps_rad: Vec<Option<f64>>,
    /// The first pulley carries the sensor; otherwise it is in line before it.
    pub sensor_pulley: bool,
    pub mu: f64,
    pub sigma_n_per_m: f64,
    pub viscous: f64,
    pub offset_n: f64,
    pub stribeck: Option<(f64, f64)>,
    pub effects: Effects,
    pub memory: Memory,
    pub geometry: Geometry,
    pub length_m: Option<f64>,
    pub stored_n: Vec<f64>,
}

fn dahl(exponent: f64, f: f64, sliding_n: f64, sigma: f64, displacement_m: f64) -> f64 {
    if displacement_m == 0.0 {
        return f;
    }
    let bound = displacement_m.signum() * sliding_n;
    if sliding_n == 0.0 {
        return 0.0;
    }
    let way = sigma * displacement_m.abs() / sliding_n;
    if exponent == 1.0 {
        return bound + (f - bound) * (-way).exp();
    }
    let u = 1.0 - f / bound;
    let bracket = u.abs().powf(1.0 - exponent) + (exponent - 1.0) * way;
    let left = if bracket > 0.0 && u != 0.0 { bracket.powf(1.0 / (1.0 - exponent)) } else { 0.0 };
    bound * (1.0 - u.signum() * left)
}

/// What moves in a cycle: displacement at the winch, stretch of the whole cable, speed, inertia's force of one pulley.
#[derive(Clone, Copy)]
struct Motion {
    displacement_m: f64,
    stretch_m: f64,
    speed: f64,
    inertia_n: f64,
}

fn direction(displacement_m: f64) -> f64 {
    if displacement_m == 0.0 { 0.0 } else { displacement_m.signum() }
}

impl Cable {
    /// Force at the platform, with the sensor's force, the length and speed, and the attachment in the base frame.
    pub fn step(&mut self, shown_n: f64, length_m: f64, speed: f64, attachment_m: [f64; 3]) -> f64 {
        let effects = self.effects;
        let displacement_m = length_m - self.length_m.unwrap_or(length_m);
        self.length_m = Some(length_m);
        let time_s = f64::from(self.memory.cycles) * CYCLE_S;
        // The speed over the cycle is the mean of those at both its ends.
        let speed_before = if self.memory.cycles == 0 { speed } else { self.memory.speed };
        let mean_speed = 0.5 * (speed_before + speed);
        let mut mu =
            self.stribeck.map_or(self.mu, |(ratio, at)| self.mu * (1.0 + ratio * (-(mean_speed / at).powi(2)).exp()));
        mu *= 1.0 + effects.drift_per_s * time_s;
        let pose_wrap_rad = self.geometry.exit(attachment_m).wrap_rad;
        let wraps_rad: Vec<f64> = self.wraps_rad.iter().map(|wrap| wrap.unwrap_or(pose_wrap_rad)).collect();
        let sensor_n = (shown_n - effects.sensor_offset_n - effects.sensor_drift_n_per_s * time_s) / effects.gain;

        // What the platform feels, with the friction of the cycle before.
        let straight_n = self.frictionless(sensor_n, &wraps_rad);
        let tension_n = (straight_n + self.memory.friction_n).max(0.0);
        if self.memory.cycles == 0 {
            (self.memory.slow_speed, self.memory.slower_speed, self.memory.settled_n) = (speed, speed, tension_n);
        }
        let settled_n =
            self.memory.settled_n.clamp(tension_n - effects.stretch_play_n, tension_n + effects.stretch_play_n);
        let waiting_m = self.memory.waiting_m + effects.compliance_m_per_n * (settled_n - self.memory.settled_n);
        // A twentieth in a cycle of 1 ms; more where the winch would turn the middle pulley back, or where more than the play waits.
        let least_m = if waiting_m > 0.0 { -2.0 * displacement_m } else { 2.0 * displacement_m };
        let excess_m = waiting_m.abs() - effects.compliance_m_per_n * effects.stretch_play_n;
        let going_m = [waiting_m.abs() / 20.0, least_m, excess_m].into_iter().fold(0.0, f64::max);
        let stretch_m = going_m.min(waiting_m.abs()).copysign(waiting_m);
        let waiting_m = waiting_m - stretch_m;
        let low_pass = |slow: f64, now: f64, window_s: f64| (window_s * slow + CYCLE_S * now) / (window_s + CYCLE_S);
        let slow_speed = low_pass(self.memory.slow_speed, speed, effects.mass_window_s);
        let slower_speed = low_pass(self.memory.slower_speed, self.memory.slow_speed, effects.mass_window_s);
        let [near, far] = [slow_speed - self.memory.slow_speed, slower_speed - self.memory.slower_speed]
            .map(|change| change / CYCLE_S);
        let led = (effects.mass_window_s + 0.5 * CYCLE_S) / (effects.mass_window_s + CYCLE_S);
        let inertia_n = effects.mass_kg * ((1.0 + led) * near - led * far);

        let motion = Motion { displacement_m, stretch_m, speed, inertia_n };
        let chain_n = if self.lumped {
            self.lumped(mu, sensor_n, motion, &wraps_rad)
        } else {
            self.per_pulley(mu, sensor_n, motion, &wraps_rad)
        };
        let mut force_n = chain_n;
        for [sin, cos, period_m] in effects.ripples {
            let angle = std::f64::consts::TAU * (length_m / period_m);
            force_n *= 1.0 + sin * angle.sin() + cos * angle.cos();
        }
        let friction_n = force_n - straight_n;
        self.memory = Memory {
            cycles: self.memory.cycles + 1,
            speed,
            slow_speed,
            slower_speed,
            settled_n,
            waiting_m,
            friction_n,
        };
        force_n + self.offset_n
    }

    fn lumped(&mut self, mu: f64, sensor_n: f64, motion: Motion, wraps_rad: &[f64]) -> f64 {
        let effects = self.effects;
        #[expect(clippy::cast_precision_loss, reason = "a handful")]
        let count = wraps_rad.len() as f64;
        let displacement_m = motion.displacement_m + motion.stretch_m * (count + 1.0) / (2.0 * count);
        let s = direction(displacement_m);
        let mu = mu * (1.0 + s * effects.coulomb_ratio);
        // [P] 5, 6, 8 of a pulley: F_j(1 − sμk/2) = F_{j−1}(1 + sμk/2) + what else resists.
        let chain = |resisting_n: f64| {
            let mut tension_n = sensor_n;
            for (place, wrap_rad) in wraps_rad.iter().enumerate() {
                let half = 0.5 * s * mu * (2.0 * (1.0 - wrap_rad.cos())).sqrt();
                let (a, b) = (1.0 - half, 1.0 + half);
                tension_n = if place == 0 && self.sensor_pulley {
                    // Cramer's rule on a·F_1 − b·F_0 = resisting and F_1 − cos α·F_0 = F_s.
                    let cos = wrap_rad.cos();
                    (resisting_n * -cos + b * sensor_n) / (-a * cos + b)
                } else {
                    (tension_n * b + resisting_n) / a
                };
            }
            tension_n
        };
        let coulomb_n = chain(s * effects.drag_n);
        let viscous_n = chain(s * effects.drag_n + self.viscous_n(motion)) - coulomb_n;
        let straight_n = self.frictionless(sensor_n, wraps_rad);
        let full_n = coulomb_n - straight_n;
        // Towards the friction of sliding this way; its sign need not be the motion's (sensor pulleys below 90°).
        let toward = if full_n * s < 0.0 { -displacement_m } else { displacement_m };
        self.stored_n[0] = dahl(effects.dahl_exponent, self.stored_n[0], full_n.abs(), self.sigma_n_per_m, toward);
        straight_n + self.stored_n[0] + viscous_n
    }

    fn per_pulley(&mut self, mu: f64, sensor_n: f64, motion: Motion, wraps_rad: &[f64]) -> f64 {
        let effects = self.effects;
        #[expect(clippy::cast_precision_loss, reason = "a handful")]
        let count = wraps_rad.len() as f64;
        let drag_n = self.viscous_n(motion);
        let mut tension_n = sensor_n;
        let mut share = 0.0;
        for (place, (wrap_rad, stored_n)) in wraps_rad.iter().zip(&mut self.stored_n).enumerate() {
            share += 1.0 / count;
            let displacement_m = motion.displacement_m + motion.stretch_m * share;
            // [P] 11 with F_0 = F_1 − friction; behind every other pulley the friction adds up.
            let senses = place == 0 && self.sensor_pulley;
            let behind = |friction_n: f64| {
                if senses {
                    (sensor_n - wrap_rad.cos() * friction_n) / (1.0 - wrap_rad.cos())
                } else {
                    tension_n + friction_n
                }
            };
            let before = |friction_n: f64| behind(friction_n) - friction_n;
            let held_n = *stored_n + drag_n;
            let normal_n = 0.5 * (before(held_n) + behind(held_n)) * (2.0 * (1.0 - wrap_rad.cos())).sqrt();
            let mu = mu * (1.0 + direction(displacement_m) * effects.coulomb_ratio);
            let reference_n = effects.load_reference_n;
            let sliding_n = mu * reference_n * (normal_n / reference_n).max(0.0).powf(effects.load_exponent);
            let sigma = self.sigma_n_per_m / count;
            *stored_n = dahl(effects.dahl_exponent, *stored_n, sliding_n + effects.drag_n, sigma, displacement_m);
            tension_n = behind(*stored_n + drag_n);
        }
        tension_n
    }

    /// What a pulley needs no presliding distance for.
    fn viscous_n(&self, motion: Motion) -> f64 {
        let ratio = self.effects.viscous_ratio * direction(motion.speed);
        self.viscous * (1.0 + ratio) * motion.speed + motion.inertia_n
    }

    fn frictionless(&self, sensor_n: f64, wraps_rad: &[f64]) -> f64 {
        if self.sensor_pulley { sensor_n / (1.0 - wraps_rad[0].cos()) } else { sensor_n }
    }
}

/// `−Σ f_i [u_i; (R b_i) × u_i]`, \[P\] 2 and 3.
pub fn outside_wrench(columns: &[([f64; 3], [f64; 3])], forces_n: &[f64]) -> ([f64; 3], [f64; 3]) {
    let (mut force, mut torque) = ([0.0; 3], [0.0; 3]);
    for ((direction, arm), force_n) in columns.iter().zip(forces_n) {
        force = add(force, scale(*direction, -force_n));
        torque = add(torque, scale(cross(*arm, *direction), -force_n));
    }
    (force, torque)
}
