//! `stribeck` in the simulated robot: the boundary layer of a bearing that has not yet built up its film.
//!
//! The additional share of μ falls with speed as `exp(−(v/velocity)²)`, the law that the catalogue states; speed is the
//! cable's at the instant, within the cycle too.

use super::{Cause, Contact, TruthEffect};

#[derive(Debug)]
struct BoundaryLayer {
    additional_ratio: f64,
    velocity_m_per_s: f64,
}

pub fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [additional_ratio, velocity_m_per_s] = ["ratio", "velocity_m_per_s"].map(cause.value);
    Box::new(BoundaryLayer { additional_ratio, velocity_m_per_s })
}

impl TruthEffect for BoundaryLayer {
    fn mu_factor(&self, contact: &Contact) -> f64 {
        1.0 + self.additional_ratio * libm::exp(-libm::pow(contact.speed_m_per_s / self.velocity_m_per_s, 2.0))
    }
}
