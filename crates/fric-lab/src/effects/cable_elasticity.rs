//! `cable_elasticity` in the simulated robot: a cable that is a spring.
//!
//! Under the tension F at the platform, its material is displaced by `(j/n)·c·F` at pulley j of n. As F changes, the cable moves over the pulleys,
//! most over the far ones, whether the winch turns or not. Within a cycle F changes linearly.

use super::truth::{Cause, TruthEffect};
use super::{Around, LabEffect, Sizing, Start, always};

/// The effect's entry in the lab.
pub const LAB: LabEffect = LabEffect { truth, starts, typical, is_more_than_usual: always };

#[derive(Debug)]
struct Spring {
    compliance_m_per_n: f64,
}

fn truth(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    Box::new(Spring { compliance_m_per_n: (cause.value)("compliance_m_per_n") })
}

impl TruthEffect for Spring {
    fn compliance_m_per_n(&self) -> f64 {
        self.compliance_m_per_n
    }
}

/// Plays of twice the noise of the sensor; that of the reference is in what is known of it too. A friction that was fitted to a cable that does not give may have
/// no slope towards one that gives a little.
fn starts(around: &Around) -> Vec<Start> {
    let compliance = ("compliance_m_per_n", around.compliance_m_per_n);
    [1.0, 1.6].map(|plays| vec![("play_n", plays * around.noise_n), compliance]).to_vec()
}

fn typical(scale: &mut Sizing<'_>) -> Start {
    vec![("compliance_m_per_n", scale.about(2.5e-4))]
}
