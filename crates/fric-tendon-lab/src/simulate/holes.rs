//! The true friction of the simulation: a tendon that sticks and slips in its holes.
//!
//! The law is rate-independent: after each step of the base tension the state minimises
//!
//! `V(ψ) − T_0·u_1 + Σ c_i·|u_i − u_i,before|`
//!
//! This is the energy with the work of the base tension and the dissipation in the holes, where `u_i` is the displacement of the (inextensible)
//! tendon through hole i towards the base and `c_i = μ_i·|T_{i−1} + T_i|` is evaluated at the end of the step (\[C\] 12, 13, with the vectors
//! themselves). The dual problem is solved: frictions within `±c_i`, such that a tendon moves only where its friction is at the bound. It contains no
//! presliding, no Dahl state and no stretch of the tendon.

use super::elastica::{Elastica, NoMinimum};
use nalgebra::Vector2;

/// Maximum number of rounds per step, each of which updates bounds and compliance.
const MOST_ROUNDS: u32 = 400;
/// Maximum number of sweeps over the holes per round.
const MOST_SWEEPS: u32 = 4000;
/// Tolerance of the frictions, N.
const SETTLED_N: f64 = 1e-10;

/// A manipulator with its first tendon in holes with friction.
#[derive(Clone, Debug)]
pub struct Rubbing {
    elastica: Elastica,
    mu: Vec<f64>,
    friction_n: Vec<f64>,
    bound_n: Vec<f64>,
    tension_n: Vec<f64>,
    /// Displacement of the tendon through each hole, m.
    travel_m: Vec<f64>,
}

impl Rubbing {
    /// Creates the manipulator as it hangs, with a tendon without tension.
    pub fn new(mut elastica: Elastica, mu: Vec<f64>) -> Result<Self, NoMinimum> {
        elastica.settle([&[], &[]])?;
        let zeros = vec![0.0; mu.len()];
        let mut rubbing = Self {
            elastica,
            mu,
            friction_n: zeros.clone(),
            bound_n: zeros.clone(),
            tension_n: zeros.clone(),
            travel_m: zeros,
        };
        rubbing.travel_m = rubbing.travel();
        Ok(rubbing)
    }

    pub fn elastica(&self) -> &Elastica {
        &self.elastica
    }

    /// Returns `T_{i−1} − T_i`, N.
    pub fn friction_n(&self) -> &[f64] {
        &self.friction_n
    }

    /// Returns `c_i`, N.
    pub fn bound_n(&self) -> &[f64] {
        &self.bound_n
    }

    /// Returns the tension in each segment, N.
    pub fn tension_n(&self) -> &[f64] {
        &self.tension_n
    }

    /// Returns the displacements, summed from the tip: each piece of tendon that has become shorter has moved tendon out through the holes before it.
    fn travel(&self) -> Vec<f64> {
        let mut sum_m = 0.0;
        let mut travel_m: Vec<f64> = (0..self.mu.len())
            .rev()
            .map(|segment| {
                sum_m -= self.elastica.strand(segment, 1.0).length_m;
                sum_m
            })
            .collect();
        travel_m.reverse();
        travel_m
    }

    fn tensions(&self, base_n: f64) -> Vec<f64> {
        let mut tension_n = base_n;
        let behind = |friction_n: &f64| {
            tension_n -= friction_n;
            tension_n
        };
        self.friction_n.iter().map(behind).collect()
    }

    /// Returns `μ_i·|T_{i−1} + T_i|` with the tensions as vectors on the hole.
    fn bounds(&self, base_n: f64) -> Vec<f64> {
        let mut before = base_n * Vector2::x();
        let each = |(segment, (mu, tension_n)): (usize, (&f64, &f64))| {
            let behind = *tension_n * self.elastica.strand(segment, 1.0).direction;
            let load_n = (behind - before).norm();
            before = behind;
            mu * load_n
        };
        self.mu.iter().zip(&self.tension_n).enumerate().map(each).collect()
    }

    /// Changes the base tension and finds the new equilibrium.
    pub fn step(&mut self, base_n: f64) -> Result<(), NoMinimum> {
        let before_m = self.travel_m.clone();
        for _ in 0..MOST_ROUNDS {
            self.tension_n = self.tensions(base_n);
            let factor = self.elastica.settle([&self.tension_n, &[]])?;
            self.bound_n = self.bounds(base_n);
            self.travel_m = self.travel();
            let softness = self.softness(&self.elastica.compliance(&factor, 1.0));
            let motion_m: Vec<f64> = self.travel_m.iter().zip(&before_m).map(|(now, before)| now - before).collect();
            let next_n = self.frictions(&softness, &motion_m);
            let changes = next_n.iter().zip(&self.friction_n).map(|(next, now)| (next - now).abs());
            let largest_n = changes.fold(0.0, f64::max);
            if largest_n < SETTLED_N {
                return Ok(());
            }
            self.friction_n = next_n;
        }
        Err(NoMinimum)
    }

    /// Returns how much less the tendon moves through hole i per newton more of friction at hole k, m/N.
    fn softness(&self, compliance: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let count = self.mu.len();
        let beyond = |one: usize, other: usize| compliance[other..].iter().flat_map(|row| &row[one..]).sum::<f64>();
        (0..count).map(|one| (0..count).map(|other| -beyond(one, other)).collect()).collect()
    }

    /// Returns frictions within their bounds that allow motion only where they are at the bound, for motions that are linear in the frictions.
    fn frictions(&self, softness: &[Vec<f64>], motion_m: &[f64]) -> Vec<f64> {
        let mut friction_n: Vec<f64> =
            self.friction_n.iter().zip(&self.bound_n).map(|(now, bound)| now.clamp(-bound, *bound)).collect();
        for _ in 0..MOST_SWEEPS {
            let mut largest_n = 0.0_f64;
            for hole in 0..friction_n.len() {
                let row = &softness[hole];
                let changes = friction_n.iter().zip(&self.friction_n).map(|(next, now)| next - now);
                let left_m = motion_m[hole] - row.iter().zip(changes).map(|(soft, change)| soft * change).sum::<f64>();
                let bound_n = self.bound_n[hole];
                let next_n = (friction_n[hole] + left_m / row[hole]).clamp(-bound_n, bound_n);
                largest_n = largest_n.max((next_n - friction_n[hole]).abs());
                friction_n[hole] = next_n;
            }
            if largest_n < 0.01 * SETTLED_N {
                break;
            }
        }
        friction_n
    }
}
