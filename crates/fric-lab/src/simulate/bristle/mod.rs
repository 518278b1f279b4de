//! The true friction of the simulation: a bristle in each pulley's bearing.
//!
//! A bearing sticks through an elastic bristle of stiffness `σ/n`. Its deflection z follows the cable and saturates as its force approaches the
//! greatest friction of the bearing, `f_c = μ·F_N`:
//!
//! `dz/dt = v·g(u)`, `u = 1 − sgn(v)·(σ/n)·z/f_c`, `g(u) = sgn(u)·|u|^a`, friction force `f = (σ/n)·z` (\[P\] 16 for the deflection instead of the
//! force; its exponent a is 1 unless an effect changes it), with the *exact* normal force `F_N = √(F_{j−1}² − 2F_{j−1}F_j cos α + F_j²)` (\[P\] 7).
//! [Effects](crate::effects) change how `f_c` is computed.
//!
//! The tension is given at the platform, so the chain is solved from there to the winch: `F_{j−1} = F_j − f_j − F_pv·v − m·dv/dt` (\[P\] 5, 6, and
//! Newton for a pulley with mass). The sensor shows `F_s = F_1 − F_0 cos α₁` (\[P\] 11), or `F_0` if it is in line with the cable.
//!
//! An elastic cable moves over its pulleys even when the winch rests: over pulley j of n with the winch's speed plus `(j/n)·c·dF_n/dt`, where c is
//! its compliance from the winch to the platform. A cable that grows longer by itself moves over them likewise. The force of a damped bristle leads its
//! deflection: `f = (σ/n)·(z + lead·dz/dt)`.
//!
//! Nothing is shared with the compensator: the unknown is the deflection, not the force; the normal force is exact, not the approximation \[P\] 8;
//! the chain runs from the platform to the winch; and the integration uses the two-stage, L-stable, diagonally implicit Runge-Kutta method of second
//! order with `γ = 1 − √2/2`, several steps per cycle. L-stability is needed because a bearing without presliding is an infinitely stiff bristle.
//!
//! The cable never slips on a pulley in this model. If friction would slacken a cable at the winch, its tension there is zero.

mod presliding;

use core::f64::consts::SQRT_2;

use crate::effects::truth::{Contact, TruthEffect};
use crate::simulate::truth::TruthEffects;

/// Stiffness that represents "no presliding", N/m: friction reverses within nanometres.
pub const STIFF_N_PER_M: f64 = 1e9;
/// Integration steps per cycle.
pub const SUBSTEPS: u32 = 10;

const GAMMA: f64 = 1.0 - SQRT_2 / 2.0;
/// The normal force depends on the unknown friction. This number of fixed-point iterations suffices for every μ that a robot file may have.
const MOST_ROUNDS: u32 = 200;
/// Relative tolerance of the friction iteration, as a fraction of the tension.
const SETTLED_SHARE: f64 = 1e-11;

/// The state of a cable at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Tension at the platform, N.
    pub force_n: f64,
    /// Length, m, positive paying out.
    pub length_m: f64,
    /// Rate of the length, m/s.
    pub speed_m_per_s: f64,
    /// Second derivative of the length, m/s².
    pub acceleration_m_per_s2: f64,
    /// Rate of the tension, N/s.
    pub force_n_per_s: f64,
    /// cos α of the pulley whose wrap follows the pose.
    pub pose_cos: f64,
    /// Time since the start, s.
    pub time_s: f64,
}

/// The true parameters of a pulley.
#[derive(Clone, Copy, Debug)]
pub struct PulleyTruth {
    /// Bearing friction coefficient, dimensionless.
    pub mu: f64,
    /// Cosine of its wrap angle; `None` if the wrap follows the pose.
    pub cos_wrap: Option<f64>,
    /// `F_pv`, N s/m.
    pub viscous_n_s_per_m: f64,
}

/// The pulleys of a cable from the winch to the platform, with the deflection of their bristles.
#[derive(Debug)]
pub struct BristleChain {
    pulleys: Vec<Bristle>,
    /// Whether the first pulley carries the sensor; otherwise the sensor is in line with the cable.
    sensor_pulley: bool,
    effects: TruthEffects,
}

#[derive(Clone, Copy, Debug)]
struct Bristle {
    pulley: PulleyTruth,
    stiffness_n_per_m: f64,
    deflection_m: f64,
    /// Rate of the deflection at the end of the last step, m/s.
    deflection_m_per_s: f64,
    /// Time by which the force leads the deflection, s.
    lead_s: f64,
    /// Exponent of presliding, dimensionless.
    exponent: f64,
    /// Pulley mass reduced to the rim, kg.
    mass_kg: f64,
    /// Position between the winch, 0, and the platform, 1: the share of the cable's stretch that passes this pulley.
    stretch_share: f64,
    /// Stretch of the cable from the winch to this pulley per tension, m/N.
    compliance_m_per_n: f64,
    /// Whether it is the pulley nearest to the platform.
    is_last: bool,
    /// Fraction of the quantities that all pulleys share.
    share: f64,
    /// Whether it has a μ of its own.
    has_own_mu: bool,
    /// Greatest friction that it holds, as a multiple of its load-dependent friction.
    held_ratio: f64,
}

impl BristleChain {
    /// Creates a chain at rest with all bristles relaxed. `sigma_n_per_m` is the stiffness of the whole cable, divided evenly among the pulleys.
    pub fn new(pulleys: &[PulleyTruth], sigma_n_per_m: f64, sensor_pulley: bool, effects: TruthEffects) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a number of pulleys")]
        let [count, places] = [pulleys.len(), pulleys.len().max(1)].map(|count| count as f64);
        let bristle = |(place, &pulley): (f64, &PulleyTruth)| Bristle {
            pulley: PulleyTruth { mu: effects.own_mu(place).unwrap_or(pulley.mu), ..pulley },
            share: 1.0 / places,
            has_own_mu: effects.own_mu(place).is_some(),
            held_ratio: effects.held_ratio(),
            stiffness_n_per_m: sigma_n_per_m / places,
            deflection_m: 0.0,
            deflection_m_per_s: 0.0,
            lead_s: effects.bristle_lead_s(),
            exponent: effects.presliding_exponent(),
            mass_kg: effects.pulley_mass_kg(),
            stretch_share: place / places,
            compliance_m_per_n: effects.compliance_m_per_n() * place / places,
            is_last: place >= count,
        };
        let pulleys = (1_u32..).map(f64::from).zip(pulleys).map(bristle).collect();
        Self { pulleys, sensor_pulley, effects }
    }

    /// Returns the effects on the cable, to advance them in time.
    pub fn effects(&mut self) -> &mut TruthEffects {
        &mut self.effects
    }

    /// Whether the pulleys have mass.
    pub fn has_mass(&self) -> bool {
        self.effects.pulley_mass_kg().abs() > 0.0
    }

    /// Integrates from one cycle to the next. In between, force and wrap change linearly. The speed follows the parabola that matches both end speeds
    /// and the change of length.
    pub fn advance(&mut self, from: &Moment, to: &Moment, cycle_s: f64, substeps: u32) {
        let span = Span::new(from, to, cycle_s);
        let step = 1.0 / f64::from(substeps);
        for part in 0..substeps {
            let start = f64::from(part) * step;
            // The stage times of the Runge-Kutta method; the second one is the end of the step.
            let stages = [span.at(start + GAMMA * step), span.at(start + step)];
            let mut forces_n = stages.map(|stage| self.chain_end_n(&stage));
            for bristle in self.pulleys.iter_mut().rev() {
                bristle.step(&stages, &mut forces_n, step * cycle_s, &self.effects);
            }
            let [_, end] = &stages;
            let winch = Contact {
                speed_m_per_s: end.speed_m_per_s,
                length_m: end.length_m,
                tension_n: end.force_n,
                time_s: end.time_s,
                is_last_pulley: false,
            };
            self.effects.moved(&winch, step * cycle_s);
        }
    }

    /// Returns the force on the sensor, N.
    pub fn sensor_force_n(&self, at: &Moment) -> f64 {
        let mut downstream_n = self.chain_end_n(at);
        let mut upstream_n = downstream_n;
        for bristle in self.pulleys.iter().rev() {
            downstream_n = upstream_n;
            let force_m = bristle.force_m(bristle.deflection_m, bristle.deflection_m_per_s);
            upstream_n = bristle.upstream_n(downstream_n, force_m, at, &self.effects);
        }
        match self.pulleys.first() {
            Some(bristle) if self.sensor_pulley => downstream_n - upstream_n * bristle.cos_wrap(at),
            _ => upstream_n,
        }
    }

    /// Returns the bearing friction that the sensor measures per tension while all pulleys slide in one direction, to first order in μ: with the
    /// pulleys' μ, and with a μ of 1. A pulley with a μ of its own is left out.
    pub fn sliding_per_tension(&self, pose_cos: f64) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (place, bristle) in self.pulleys.iter().enumerate().filter(|(_, bristle)| !bristle.has_own_mu) {
            let cos = bristle.pulley.cos_wrap.unwrap_or(pose_cos);
            // A sensor pulley adds its own friction on the winch side only; the friction of the other pulleys acts on both sides.
            let felt = if self.sensor_pulley && place == 0 { -cos / (1.0 - cos) } else { 1.0 };
            let share = felt * libm::sqrt(2.0 - 2.0 * cos);
            sums = [sums[0] + bristle.pulley.mu * share, sums[1] + share];
        }
        sums
    }

    /// Returns the tension behind the last pulley, N: the tension at the platform, apart from ripples in between.
    fn chain_end_n(&self, at: &Moment) -> f64 {
        let unnamed_n = self.effects.platform_force_n(at.speed_m_per_s, at.length_m, at.force_n);
        (at.force_n - unnamed_n) / self.effects.platform_factor(at.length_m)
    }

    /// Returns the force of each bristle, N, starting at the winch.
    #[cfg(test)]
    fn friction_n(&self) -> Vec<f64> {
        self.pulleys.iter().map(|bristle| bristle.stiffness_n_per_m * bristle.deflection_m).collect()
    }
}

impl Bristle {
    fn cos_wrap(&self, at: &Moment) -> f64 {
        self.pulley.cos_wrap.unwrap_or(at.pose_cos)
    }

    /// Returns the speed of the cable over this pulley, m/s.
    fn speed_m_per_s(&self, at: &Moment, effects: &TruthEffects) -> f64 {
        at.speed_m_per_s + self.compliance_m_per_n * at.force_n_per_s + self.stretch_share * effects.creep_m_per_s()
    }

    /// Returns the deflection of an undamped bristle with the force of this one, m.
    fn force_m(&self, deflection_m: f64, deflection_m_per_s: f64) -> f64 {
        deflection_m + self.lead_s * deflection_m_per_s
    }

    fn upstream_n(&self, downstream_n: f64, force_m: f64, at: &Moment, effects: &TruthEffects) -> f64 {
        let speed_m_per_s = self.speed_m_per_s(at, effects);
        let viscous_n = self.pulley.viscous_n_s_per_m * effects.viscous_factor(speed_m_per_s) * speed_m_per_s
            + effects.viscous_n(speed_m_per_s) * self.share;
        let inertia_n = self.mass_kg * at.acceleration_m_per_s2;
        (downstream_n - self.stiffness_n_per_m * force_m - viscous_n - inertia_n).max(0.0)
    }

    /// Integrates one step. `forces_n` holds the tensions behind the pulley at the stages; on return, those before it.
    fn step(&mut self, stages: &[Moment; 2], forces_n: &mut [f64; 2], step_s: f64, effects: &TruthEffects) {
        let [first, second] = stages;
        let own_s = GAMMA * step_s;
        let begin_m = self.deflection_m;
        let first_m = self.stage(begin_m, own_s, first, forces_n[0], begin_m, effects);
        let first_m_per_s = (first_m - begin_m) / own_s;
        let base_m = begin_m + (1.0 - GAMMA) * step_s * first_m_per_s;
        let second_m = self.stage(base_m, own_s, second, forces_n[1], first_m, effects);
        let second_m_per_s = (second_m - base_m) / own_s;
        let second_m = self.slipped_back_m(second_m, second, forces_n[1], effects);
        forces_n[0] = self.upstream_n(forces_n[0], self.force_m(first_m, first_m_per_s), first, effects);
        forces_n[1] = self.upstream_n(forces_n[1], self.force_m(second_m, second_m_per_s), second, effects);
        (self.deflection_m, self.deflection_m_per_s) = (second_m, second_m_per_s);
    }

    /// Returns the load-independent μ, and friction independent of the load, N.
    fn sliding(&self, at: &Moment, effects: &TruthEffects) -> (f64, f64) {
        let speed_m_per_s = self.speed_m_per_s(at, effects);
        let contact = Contact {
            speed_m_per_s,
            length_m: at.length_m,
            tension_n: at.force_n,
            time_s: at.time_s,
            is_last_pulley: self.is_last,
        };
        (self.pulley.mu * effects.mu_factor(&contact), effects.drag_n(&contact))
    }

    /// Returns the greatest friction of the bearing for the tension behind it at a deflection, N.
    fn sliding_n(
        &self,
        (mu, drag_n): (f64, f64),
        (force_n, force_m): (f64, f64),
        at: &Moment,
        effects: &TruthEffects,
    ) -> f64 {
        let upstream_n = self.upstream_n(force_n, force_m, at, effects);
        let squared = upstream_n * upstream_n - 2.0 * upstream_n * force_n * self.cos_wrap(at) + force_n * force_n;
        let normal_n = libm::sqrt(squared.max(0.0));
        mu * effects.load_factor(normal_n) * normal_n + drag_n
    }

    /// Returns the deflection after the part that the load does not hold has relaxed.
    fn slipped_back_m(&self, deflection_m: f64, at: &Moment, force_n: f64, effects: &TruthEffects) -> f64 {
        if self.held_ratio.is_infinite() {
            return deflection_m;
        }
        let sliding_n = self.sliding_n(self.sliding(at, effects), (force_n, deflection_m), at, effects);
        let most_m = self.held_ratio * sliding_n / self.stiffness_n_per_m;
        deflection_m.clamp(-most_m, most_m)
    }

    /// Solves `z = base + h·v·g(1 − sgn(v)·σ·z/f_c(z))` for z.
    fn stage(&self, base_m: f64, h_s: f64, at: &Moment, force_n: f64, guess_m: f64, effects: &TruthEffects) -> f64 {
        let speed_m_per_s = self.speed_m_per_s(at, effects);
        let travel_m = h_s * speed_m_per_s;
        if travel_m.abs() <= 0.0 {
            return base_m;
        }
        let sliding = self.sliding(at, effects);
        let mut deflection_m = guess_m;
        for _ in 0..MOST_ROUNDS {
            let force_m = self.force_m(deflection_m, (deflection_m - base_m) / h_s);
            let sliding_n = self.sliding_n(sliding, (force_n, force_m), at, effects);
            let last_m = deflection_m;
            deflection_m =
                presliding::stage(base_m, travel_m, self.stiffness_n_per_m, sliding_n, self.exponent, last_m);
            if (deflection_m - last_m).abs() * self.stiffness_n_per_m <= SETTLED_SHARE * force_n {
                break;
            }
        }
        deflection_m
    }
}

/// One cycle, as functions of its elapsed fraction.
struct Span {
    from: Moment,
    to: Moment,
    cycle_s: f64,
    excess_m_per_s: f64,
}

impl Span {
    fn new(from: &Moment, to: &Moment, cycle_s: f64) -> Self {
        let mean_m_per_s = (to.length_m - from.length_m) / cycle_s;
        // ∫₀¹ 6s(1 − s) ds = 1: the parabola adds what a straight line between the two speeds misses.
        let excess_m_per_s = mean_m_per_s - 0.5 * (from.speed_m_per_s + to.speed_m_per_s);
        Self { from: *from, to: *to, cycle_s, excess_m_per_s }
    }

    fn at(&self, share: f64) -> Moment {
        let between = |from: f64, to: f64| from + share * (to - from);
        let (from, to) = (&self.from, &self.to);
        let linear_m_per_s = from.speed_m_per_s + 0.5 * share * (to.speed_m_per_s - from.speed_m_per_s);
        let mean_m_per_s = linear_m_per_s + share * (3.0 - 2.0 * share) * self.excess_m_per_s;
        Moment {
            force_n: between(from.force_n, to.force_n),
            length_m: from.length_m + mean_m_per_s * share * self.cycle_s,
            speed_m_per_s: between(from.speed_m_per_s, to.speed_m_per_s)
                + 6.0 * share * (1.0 - share) * self.excess_m_per_s,
            acceleration_m_per_s2: between(from.acceleration_m_per_s2, to.acceleration_m_per_s2),
            force_n_per_s: (to.force_n - from.force_n) / self.cycle_s,
            pose_cos: between(from.pose_cos, to.pose_cos),
            time_s: between(from.time_s, to.time_s),
        }
    }
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod effect_tests;
