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
    pub geometry: Geometry,
    pub length_m: Option<f64>,
    pub stored_n: Vec<f64>,
}

fn dahl(f: f64, sliding_n: f64, sigma: f64, displacement_m: f64) -> f64 {
    if displacement_m == 0.0 {
        return f;
    }
    let bound = displacement_m.signum() * sliding_n;
    if sliding_n == 0.0 { 0.0 } else { bound + (f - bound) * (-sigma * displacement_m.abs() / sliding_n).exp() }
}

impl Cable {
    /// Force at the platform, with the sensor's force, the length and speed, and the attachment in the base frame.
    pub fn step(&mut self, sensor_n: f64, length_m: f64, speed: f64, attachment_m: [f64; 3]) -> f64 {
        let displacement_m = length_m - self.length_m.unwrap_or(length_m);
        self.length_m = Some(length_m);
        let mu = self.stribeck.map_or(self.mu, |(ratio, at)| self.mu * (1.0 + ratio * (-(speed / at).powi(2)).exp()));
        let pose_wrap_rad = self.geometry.exit(attachment_m).wrap_rad;
        let wraps_rad: Vec<f64> = self.wraps_rad.iter().map(|wrap| wrap.unwrap_or(pose_wrap_rad)).collect();
        if self.lumped {
            self.lumped(mu, sensor_n, displacement_m, speed, &wraps_rad) + self.offset_n
        } else {
            self.per_pulley(mu, sensor_n, displacement_m, speed, &wraps_rad) + self.offset_n
        }
    }

    fn lumped(&mut self, mu: f64, sensor_n: f64, displacement_m: f64, speed: f64, wraps_rad: &[f64]) -> f64 {
        let s = if displacement_m == 0.0 { 0.0 } else { displacement_m.signum() };
        // [P] 5, 6, 8 of a pulley: F_j(1 − sμk/2) = F_{j−1}(1 + sμk/2) + F_pv v.
        let chain = |viscous_n: f64| {
            let mut tension_n = sensor_n;
            for (place, wrap_rad) in wraps_rad.iter().enumerate() {
                let half = 0.5 * s * mu * (2.0 * (1.0 - wrap_rad.cos())).sqrt();
                let (a, b) = (1.0 - half, 1.0 + half);
                tension_n = if place == 0 && self.sensor_pulley {
                    // Cramer's rule on a·F_1 − b·F_0 = F_pv v and F_1 − cos α·F_0 = F_s.
                    let cos = wrap_rad.cos();
                    (viscous_n * -cos + b * sensor_n) / (-a * cos + b)
                } else {
                    (tension_n * b + viscous_n) / a
                };
            }
            tension_n
        };
        let coulomb_n = chain(0.0);
        let viscous_n = chain(self.viscous * speed) - coulomb_n;
        let straight_n = self.frictionless(sensor_n, wraps_rad);
        let full_n = coulomb_n - straight_n;
        // Towards the friction of sliding this way; its sign need not be the motion's (sensor pulleys below 90°).
        let toward = if full_n * s < 0.0 { -displacement_m } else { displacement_m };
        self.stored_n[0] = dahl(self.stored_n[0], full_n.abs(), self.sigma_n_per_m, toward);
        straight_n + self.stored_n[0] + viscous_n
    }

    fn per_pulley(&mut self, mu: f64, sensor_n: f64, displacement_m: f64, speed: f64, wraps_rad: &[f64]) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a handful")]
        let sigma = self.sigma_n_per_m / wraps_rad.len() as f64;
        let mut tension_n = sensor_n;
        for (place, (wrap_rad, stored_n)) in wraps_rad.iter().zip(&mut self.stored_n).enumerate() {
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
            let drag_n = self.viscous * speed;
            let held_n = *stored_n + drag_n;
            let normal_n = 0.5 * (before(held_n) + behind(held_n)) * (2.0 * (1.0 - wrap_rad.cos())).sqrt();
            *stored_n = dahl(*stored_n, (mu * normal_n).max(0.0), sigma, displacement_m);
            tension_n = behind(*stored_n + drag_n);
        }
        tension_n
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
