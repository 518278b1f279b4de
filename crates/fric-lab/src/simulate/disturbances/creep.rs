//! A cable that creeps, as ropes of plastic fibres do.
//!
//! Under a tension F the cable grows longer by x, which approaches `compliance·F` slowly: `τ·dx/dt = compliance·F − x` (the Kelvin-Voigt model). It
//! moves over its pulleys by that as if the winch paid it out: over pulley j of n by `(j/n)·x`. The logged length is the winch's. At the start of the
//! run the cable has crept to the end under its tension.

use super::{DisturbanceRow, parameter};
use crate::effects::truth::{Cause, Contact, TruthEffect};

pub const ROW: DisturbanceRow = DisturbanceRow {
    kind: "creep",
    cause: "the cable creeps under its load and pulls its contacts slowly while the winch rests",
    parameters: &[
        parameter("compliance_m_per_n", "m/N", 1e-4, [0.0, 1.0]),
        parameter("time_constant_s", "s", 5.0, [0.01, 1e6]),
    ],
    build,
};

#[derive(Debug)]
struct Creeping {
    compliance_m_per_n: f64,
    time_constant_s: f64,
    /// Present extra length, m; `None` before the start.
    extra_m: Option<f64>,
    rate_m_per_s: f64,
}

fn build(cause: &mut Cause<'_>) -> Box<dyn TruthEffect> {
    let [compliance_m_per_n, time_constant_s] = ["compliance_m_per_n", "time_constant_s"].map(cause.value);
    Box::new(Creeping { compliance_m_per_n, time_constant_s, extra_m: None, rate_m_per_s: 0.0 })
}

impl TruthEffect for Creeping {
    fn moved(&mut self, contact: &Contact, step_s: f64) {
        let final_m = self.compliance_m_per_n * contact.tension_n;
        let before_m = self.extra_m.unwrap_or(final_m);
        // Exact for a tension that stays the same over the step.
        let step_m = (before_m - final_m) * libm::expm1(-step_s / self.time_constant_s);
        self.extra_m = Some(before_m + step_m);
        self.rate_m_per_s = step_m / step_s;
    }

    fn creep_m_per_s(&self) -> f64 {
        self.rate_m_per_s
    }
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    use super::*;

    /// After a step of the tension `x = compliance·ΔF·(1 − e^(−t/τ))`.
    #[test]
    fn a_step_of_the_tension_is_followed_exponentially() {
        let value = |key: &str| if key == "time_constant_s" { 2.0 } else { 1e-4 };
        let random = &mut ChaCha8Rng::seed_from_u64(0);
        let mut creep = build(&mut Cause { value: &value, start_length_m: 1.0, sensor_ratio: 1.0, random });
        let at =
            |tension_n| Contact { speed_m_per_s: 0.0, length_m: 1.0, tension_n, time_s: 0.0, is_last_pulley: false };
        creep.moved(&at(5.0), 0.1);
        assert!(creep.creep_m_per_s().abs() < 1e-30);
        let mut extra_m = 0.0;
        for step in 1..=50 {
            creep.moved(&at(8.0), 0.1);
            extra_m += 0.1 * creep.creep_m_per_s();
            let expected_m = 3e-4 * (1.0 - libm::exp(-0.05 * f64::from(step)));
            assert!((extra_m - expected_m).abs() < 1e-15, "{extra_m} {expected_m}");
        }
    }
}
