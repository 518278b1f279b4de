//! The friction truth: a tendon that sticks and slips in its holes.
//!
//! Rate-independent: after each step of the base tension the state is the one that makes
//!
//! `V(ψ) − T_0·u_1 + Σ c_i·|u_i − u_i,before|`
//!
//! least, the energy with the work of the base tension and what the holes dissipate, with `u_i` the way of the (inextensible) tendon
//! through hole i towards the base and `c_i = μ_i·|T_{i−1} + T_i|` taken at the end of the step (\[C\] 12, 13, by the vectors
//! themselves). Its dual is solved: frictions within `±c_i`, such that a tendon moves only where friction is at its bound.
//! There is no presliding, no Dahl state and no stretch of the tendon in it.

use super::elastica::{Elastica, NoMinimum};
use nalgebra::Vector2;

/// Rounds of one step, in which bounds and compliance are renewed.
const MOST_ROUNDS: u32 = 400;
/// Sweeps over the holes in one round.
const MOST_SWEEPS: u32 = 4000;
/// Frictions are settled to this, N.
const SETTLED_N: f64 = 1e-10;

/// A manipulator with its first tendon in rubbing holes.
#[derive(Clone, Debug)]
pub struct Rubbing {
    elastica: Elastica,
    mu: Vec<f64>,
    friction_n: Vec<f64>,
    bound_n: Vec<f64>,
    tension_n: Vec<f64>,
    /// Way of the tendon through each hole, m.
    travel_m: Vec<f64>,
}

impl Rubbing {
    /// With a tendon that lies without tension in the manipulator as it hangs.
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

    /// `T_{i−1} − T_i`, N.
    pub fn friction_n(&self) -> &[f64] {
        &self.friction_n
    }

    /// `c_i`, N.
    pub fn bound_n(&self) -> &[f64] {
        &self.bound_n
    }

    /// In each segment, N.
    pub fn tension_n(&self) -> &[f64] {
        &self.tension_n
    }

    /// From the tip: each strand that has become shorter has let tendon out through the holes before it.
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

    /// `μ_i·|T_{i−1} + T_i|` with the tensions as vectors on the hole.
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

    /// One step: the base tension changes, everything settles.
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

    /// How much less a tendon moves through hole i for one newton more of friction at hole k, m/N.
    fn softness(&self, compliance: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let count = self.mu.len();
        let beyond = |one: usize, other: usize| compliance[other..].iter().flat_map(|row| &row[one..]).sum::<f64>();
        (0..count).map(|one| (0..count).map(|other| -beyond(one, other)).collect()).collect()
    }

    /// Frictions within their bounds that leave motion only where they are at them, for motions that change linearly.
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
