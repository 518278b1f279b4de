//! `dwell_stiction` in the simulated robot: contacts that strengthen by creep at rest and are renewed by sliding.
//!
//! The age of the contacts follows `dθ/dt = (1 − θ)/time − θ·|v|/distance`, integrated in the substeps of the bristles by the implicit Euler method.

use super::truth::{Cause, Contact, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};
use crate::random::uniform;

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

#[derive(Debug)]
struct AgeingContacts {
    ratio: f64,
    time_s: f64,
    distance_m: f64,
    age: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [ratio, time_s, distance_m] = ["ratio", "time_s", "distance_m"].map(cause.value);
    Box::new(AgeingContacts { ratio, time_s, distance_m, age: 0.0 })
}

impl TruthEffect for AgeingContacts {
    fn mu_factor(&self, _: &Contact) -> f64 {
        1.0 + self.ratio * self.age
    }

    fn moved(&mut self, contact: &Contact, step_s: f64) {
        let growing = step_s / self.time_s;
        self.age = (self.age + growing) / (1.0 + growing + contact.speed_m_per_s.abs() * step_s / self.distance_m);
    }
}

/// Times of ageing to start from, s.
const TIMES_S: [f64; 3] = [0.6, 0.2, 1.8];

/// Starts from a distance over which presliding builds up.
fn starts(_: &Around) -> Vec<Start> {
    TIMES_S.map(|time_s| vec![("ratio", 0.3), ("time_s", time_s), ("distance_m", 1e-3)]).to_vec()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    let ratio = scale.about(0.8);
    let [time_s, distance_m] = [(0.2, 1.0), (3e-4, 2e-3)].map(|(least, most)| uniform(scale.random, least, most));
    vec![("ratio", ratio), ("time_s", time_s), ("distance_m", distance_m)]
}
