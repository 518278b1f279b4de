//! Options of a cable, as a program or a robot file states them.

use crate::effects::EffectParams;

/// Maximum number of pulleys of one cable, including the sensor pulley.
pub const MAX_PULLEYS: usize = 8;

/// Options of one pulley.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PulleyOptions {
    /// A pulley with a constant wrap.
    Fixed {
        /// Wrap angle in rad, 0…2π.
        wrap_rad: f64,
        /// Whether it carries the force sensor; only the first pulley can.
        sensor: bool,
    },
    /// The last pulley, swivelling about the incoming cable; its wrap follows the pose.
    Swivel {
        /// Radius of the cable's centre line, m.
        radius_m: f64,
        /// Direction in which the cable enters, in the base frame, of any length.
        axis: [f64; 3],
    },
}

/// Form of presliding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Presliding {
    /// One Dahl state on each pulley.
    #[default]
    PerPulley,
    /// One Dahl state for the whole cable, as in the paper.
    Lumped,
}

/// Friction options of a cable. The default is without friction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionOptions {
    /// Bearing friction μ on the normal force, 0…0.9.
    pub mu: f64,
    /// Presliding stiffness σ of the whole cable, N/m; without it friction reverses at once.
    pub sigma_n_per_m: Option<f64>,
    /// Viscous friction F_pv of each pulley, N s/m.
    pub viscous_n_s_per_m: f64,
    /// Offset ε added to the force at the platform after friction, N (\[P\] 18): the difference between the two force sensors of an identification.
    /// It enters the wrench too; the paper neglects it in operation, which corresponds to 0.
    pub offset_n: f64,
}

/// Attachment options of a cable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeometryOptions {
    /// Entry point of the cable into the last pulley, base frame, m.
    pub base_m: [f64; 3],
    /// Attachment point, platform frame, m.
    pub platform_m: [f64; 3],
}

/// Range in which the parameters were identified; outside it a cycle is flagged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidatedRange {
    /// Least and greatest sensor force, N.
    pub force_n: [f64; 2],
    /// Greatest speed in either direction, m/s.
    pub speed_m_per_s: f64,
}

impl ValidatedRange {
    /// No limit.
    pub const ANY: Self = Self { force_n: [-f64::MAX, f64::MAX], speed_m_per_s: f64::MAX };
}

/// Options of one cable.
#[derive(Clone, Copy, Debug)]
pub struct CableOptions<'a> {
    /// Pulleys from the winch to the platform, 1…[`MAX_PULLEYS`]. Without a sensor pulley, the sensor is in line with the cable on the winch side of
    /// the first pulley.
    pub pulleys: &'a [PulleyOptions],
    /// Presliding form.
    pub presliding: Presliding,
    /// Friction.
    pub friction: FrictionOptions,
    /// Attachment; required for a swivelling pulley and for the wrench.
    pub geometry: Option<GeometryOptions>,
    /// Friction coefficient μ_p between cable and pulley, 0.01…2; without it the cable never slips.
    pub traction_mu: Option<f64>,
    /// Range of the identification.
    pub validated: ValidatedRange,
    /// Effects of the catalogue.
    pub effects: EffectParams,
}

impl CableOptions<'_> {
    /// Creates a cable over the given pulleys, without friction, geometry, slip limit, range or effects.
    #[must_use]
    pub const fn new(pulleys: &[PulleyOptions]) -> CableOptions<'_> {
        CableOptions {
            pulleys,
            presliding: Presliding::PerPulley,
            friction: FrictionOptions { mu: 0.0, sigma_n_per_m: None, viscous_n_s_per_m: 0.0, offset_n: 0.0 },
            geometry: None,
            traction_mu: None,
            validated: ValidatedRange::ANY,
            effects: EffectParams::NEUTRAL,
        }
    }
}
