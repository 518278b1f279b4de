//! The friction coefficient of a single hole, as in figure 9 of \[C\].

use serde::Serialize;

use crate::friction::HoleCoefficient;

/// `fric-continuum-hole/1`.
#[derive(Clone, Debug, Serialize)]
pub struct HoleResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// Number of loads.
    pub loads: usize,
    /// μ.
    pub mu: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// The 95 % confidence interval.
    pub interval: [f64; 2],
}

impl HoleResult {
    /// Name and version of the format.
    pub const FORMAT: &str = "fric-continuum-hole/1";

    /// Creates the result of a coefficient.
    #[must_use]
    pub fn new(found: &HoleCoefficient) -> Self {
        let HoleCoefficient { mu, standard_error, interval, count } = *found;
        Self { format: Self::FORMAT, loads: count, mu, standard_error, interval }
    }

    /// Returns a warning, one sentence, if the coefficient is negative.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        (self.interval[1] < 0.0).then(|| {
            "the tension falls towards the base, which no friction does while the tendon is pulled: `tension_1_n` is the side of the base; are \
             the two exchanged?"
                .to_owned()
        })
    }

    /// Returns a summary for people.
    #[must_use]
    pub fn summary(&self) -> String {
        let Self { loads, mu, standard_error, interval: [from, to], .. } = self;
        format!(
            "μ = {mu:.4} ± {standard_error:.4} from {loads} loads; {from:.4} … {to:.4} in 95 of 100 cases\n\n\
             F_1 − F_2 = μ (F_1 cos θ_1 + F_2 cos θ_2), by least squares through the origin.\n"
        )
    }
}
