//! Cable forces at the platform that are known without a sensor there: the load of a test bench.

/// The known force of a robot's cables at their platform ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KnownReference {
    /// A constant force, whatever the cable does: a pretension, a constant-force spring.
    Constant {
        /// Cable force at the platform, N.
        force_n: f64,
    },
    /// A mass that hangs freely on the vertical end of the cable.
    HangingMass {
        /// The mass, kg.
        mass_kg: f64,
        /// Magnitude of gravity, m/s².
        gravity_m_per_s2: f64,
    },
}

/// Greatest acceleration of quiet motion under a hanging mass, m/s²: 5 % of the weight. At half this value, ramps of 0.3 m/s² have no reference; at double,
/// the mass may oscillate by 10 % of its weight after the end of a ramp.
const QUIET_M_PER_S2: f64 = 0.5;

impl KnownReference {
    /// Half the width of the triangular window over which the acceleration of a hanging mass is the mean, s.
    pub const WINDOW_S: f64 = 0.02;

    /// Returns the greatest acceleration of the cable up to which the force counts as known, m/s²: infinite for a constant force.
    #[must_use]
    pub fn quiet_m_per_s2(&self) -> f64 {
        match self {
            Self::Constant { .. } => f64::INFINITY,
            Self::HangingMass { .. } => QUIET_M_PER_S2,
        }
    }

    /// Returns the cable force at the platform, N.
    ///
    /// For a hanging mass `F = m·(g − a)` by Newton's second law along the vertical, with the acceleration `a = d²l/dt²` of the paid-out length in
    /// m/s²: a cable that pays out with increasing speed lets the mass fall, and its force decreases. In free fall and beyond (`a ≥ g`) the cable is
    /// slack, and the force is 0. A constant force does not depend on `a`; NaN stays NaN.
    ///
    /// ```
    /// use fric_core::KnownReference;
    ///
    /// let weight = KnownReference::HangingMass { mass_kg: 5.0, gravity_m_per_s2: 9.80665 };
    /// assert!((weight.force_n(0.0) - 49.03325).abs() < 1e-12);
    /// assert!((weight.force_n(-1.0) - 54.03325).abs() < 1e-12);
    /// assert_eq!(weight.force_n(20.0), 0.0);
    /// ```
    #[must_use]
    pub fn force_n(&self, acceleration_m_per_s2: f64) -> f64 {
        match *self {
            Self::Constant { force_n } => force_n,
            Self::HangingMass { mass_kg, gravity_m_per_s2 } => {
                let specific = gravity_m_per_s2 - acceleration_m_per_s2;
                if specific <= 0.0 { 0.0 } else { mass_kg * specific }
            }
        }
    }
}
