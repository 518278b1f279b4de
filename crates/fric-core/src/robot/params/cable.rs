//! The checked parameters of a cable.

use nalgebra::Vector3;

use super::cable_options::{CableOptions, FrictionOptions, MAX_PULLEYS, Presliding, PulleyOptions, ValidatedRange};
use crate::effects::pulley_defect::{self, PulleyDefect};
use crate::effects::{Effect, EffectParams, OnMu, ripple};
use crate::parameters::{FRICTION, GREATEST_MU};
use crate::pulley::wrap_factor;
use crate::robot::error::{ParamError, ParamProblem, check};

/// A pulley of a checked cable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Wrap {
    Fixed { wrap_rad: f64 },
    Pose,
}

/// A checked cable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CableParams {
    /// Wrap of the sensor pulley, if there is one.
    pub(crate) sensor_wrap_rad: Option<f64>,
    pub(crate) wraps: [Wrap; MAX_PULLEYS],
    pub(crate) pulley_count: usize,
    pub(crate) presliding: Presliding,
    pub(crate) friction: FrictionOptions,
    pub(crate) geometry: Option<Geometry>,
    pub(crate) traction_mu: Option<f64>,
    pub(crate) validated: ValidatedRange,
    pub(crate) effects: EffectParams,
}

/// Checked attachment and last pulley; an eyelet (radius 0) if the last pulley does not swivel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Geometry {
    pub base_m: Vector3<f64>,
    pub platform_m: Vector3<f64>,
    pub radius_m: f64,
    pub axis: Vector3<f64>,
}

const PLACE_M: f64 = 1e4;

pub(super) fn check_point(key: &'static str, point: [f64; 3]) -> Result<Vector3<f64>, ParamError> {
    let [x, y, z] = point;
    Ok(Vector3::new(
        check(key, x, -PLACE_M, PLACE_M)?,
        check(key, y, -PLACE_M, PLACE_M)?,
        check(key, z, -PLACE_M, PLACE_M)?,
    ))
}

impl CableParams {
    /// Returns the radius of the pulley that follows the pose, m; `None` without one.
    #[must_use]
    pub fn pose_pulley_radius_m(&self) -> Option<f64> {
        self.geometry.map(|geometry| geometry.radius_m).filter(|radius_m| *radius_m > 0.0 && self.needs_pose())
    }

    /// Returns the same cable with another entry point into its last pulley and another attachment, m; `None` if it has no geometry, or a number is
    /// not finite or out of range.
    #[must_use]
    pub fn with_geometry(&self, base_m: [f64; 3], platform_m: [f64; 3]) -> Option<Self> {
        let base_m = check_point("base_m", base_m).ok()?;
        let platform_m = check_point("platform_m", platform_m).ok()?;
        let geometry = Geometry { base_m, platform_m, ..self.geometry? };
        Some(Self { geometry: Some(geometry), ..*self })
    }

    /// Checks a cable.
    ///
    /// # Errors
    /// Returns a [`ParamError`] with the first parameter that is not finite, out of its range or inconsistent with another.
    pub fn new(options: &CableOptions<'_>) -> Result<Self, ParamError> {
        let count = options.pulleys.len();
        if count == 0 || count > MAX_PULLEYS {
            let problem = ParamProblem::Count { count, min: 1, max: MAX_PULLEYS };
            return Err(ParamError { key: "pulleys", pulley: None, effect: None, problem });
        }
        if let Some(traction_mu) = options.traction_mu {
            check("traction_mu", traction_mu, 0.01, 2.0)?;
        }
        let ValidatedRange { force_n: [least_n, greatest_n], speed_m_per_s } = options.validated;
        check("force_n", least_n, -f64::MAX, f64::MAX)?;
        check("force_n", greatest_n, least_n, f64::MAX)?;
        check("speed_m_per_s", speed_m_per_s, 0.0, f64::MAX)?;

        let mut params = Self {
            sensor_wrap_rad: None,
            wraps: [Wrap::Fixed { wrap_rad: 0.0 }; MAX_PULLEYS],
            pulley_count: count,
            presliding: options.presliding,
            friction: options.friction,
            geometry: None,
            traction_mu: options.traction_mu,
            validated: options.validated,
            effects: options.effects,
        };
        let mut last_pulley = (0.0, Vector3::z());
        for (place, (pulley, wrap)) in options.pulleys.iter().zip(&mut params.wraps).enumerate() {
            let at = |error: ParamError| error.at_pulley(place);
            match *pulley {
                PulleyOptions::Fixed { wrap_rad, sensor } => {
                    check("wrap_rad", wrap_rad, 0.0, core::f64::consts::TAU).map_err(at)?;
                    *wrap = Wrap::Fixed { wrap_rad };
                    if sensor && place > 0 {
                        return Err(at(ParamError::conflict(
                            "sensor",
                            "must stand on the first pulley: list the pulleys from the sensor to the platform only",
                        )));
                    }
                    if sensor {
                        params.sensor_wrap_rad = Some(wrap_rad);
                    }
                }
                PulleyOptions::Swivel { radius_m, axis } => {
                    check("radius_m", radius_m, 0.0, 100.0).map_err(at)?;
                    let axis = check_point("axis", axis).map_err(at)?;
                    let norm = libm::sqrt(axis.dot(&axis));
                    if norm < 1e-9 {
                        return Err(at(ParamError::conflict("axis", "is the zero vector; give the cable's direction")));
                    }
                    if place + 1 != count {
                        return Err(at(ParamError::conflict("wrap", "can follow the pose at the last pulley only")));
                    }
                    if options.geometry.is_none() {
                        return Err(at(ParamError::conflict(
                            "wrap",
                            "follows the pose, which needs `base_m` and `platform_m` of the cable",
                        )));
                    }
                    *wrap = Wrap::Pose;
                    last_pulley = (radius_m, axis / norm);
                }
            }
        }
        params.check_friction()?;
        if let Some(geometry) = options.geometry {
            params.geometry = Some(Geometry {
                base_m: check_point("base_m", geometry.base_m)?,
                platform_m: check_point("platform_m", geometry.platform_m)?,
                radius_m: last_pulley.0,
                axis: last_pulley.1,
            });
        }
        Ok(params)
    }

    /// Checks whether the friction's numbers are in range, individually and together.
    pub(crate) fn check_friction(&self) -> Result<(), ParamError> {
        let FrictionOptions { mu, sigma_n_per_m, viscous_n_s_per_m, offset_n } = self.friction;
        let stated = [Some(mu), sigma_n_per_m, Some(viscous_n_s_per_m), Some(offset_n)];
        for (row, value) in FRICTION.iter().zip(stated) {
            value.map(|value| check(row.key, value, row.min, row.max)).transpose()?;
        }
        self.check_defect()?;
        self.check_ripples()?;
        let raised_mu = self.raised_mu()?;
        self.sensor_wrap_rad
            .map_or(Ok(()), |wrap_rad| check_sensor_wrap(wrap_rad, raised_mu).map_err(|error| error.at_pulley(0)))
    }

    /// Checks whether the pulley with its own friction, if any, is one of the cable's.
    fn check_defect(&self) -> Result<(), ParamError> {
        let values = self.values();
        let defect = PulleyDefect::of(|place| values[place]);
        if self.defect_pulley().is_some() || defect.pulley.abs() <= 0.0 && defect.mu.abs() <= 0.0 {
            return Ok(());
        }
        let problem = "is the number of none of the cable's pulleys; count them from 1 at the sensor";
        Err(ParamError::conflict("pulley", problem).of_effect(Effect::PulleyDefect))
    }

    /// Checks whether two ripples of a kind have different periods.
    fn check_ripples(&self) -> Result<(), ParamError> {
        let values = self.values();
        let Some(second) = Effect::CATALOGUE.iter().find(|effect| ripple::repeats_first(**effect, &values)) else {
            return Ok(());
        };
        let problem = "is within 1 % of the period of the other one, and no log can tell such two ripples apart; give \
                       one of them, or another period";
        Err(ParamError::conflict(ripple::PERIOD_KEY, problem).of_effect(*second))
    }

    /// Returns the pulley with its own friction, counted from 0.
    pub(crate) fn defect_pulley(&self) -> Option<usize> {
        let number = self.values()[pulley_defect::PULLEY];
        #[expect(clippy::cast_precision_loss, reason = "at most MAX_PULLEYS")]
        (0..self.pulley_count).find(|pulley| ((pulley + 1) as f64 - number).abs() <= 0.0)
    }

    /// Returns the greatest μ that effects can raise it to.
    ///
    /// # Errors
    /// Returns a [`ParamError`] with the effect that raises it beyond [`GREATEST_MU`].
    pub(crate) fn raised_mu(&self) -> Result<f64, ParamError> {
        let values = self.values();
        let mut mu = self.friction.mu;
        for effect in Effect::CATALOGUE {
            let OnMu::AtMost { factor, key, problem } = effect.row().on_mu else { continue };
            mu *= factor(values.get(effect.places()).unwrap_or_default());
            if mu > GREATEST_MU {
                return Err(ParamError::conflict(key, problem).of_effect(*effect));
            }
        }
        Ok(mu)
    }

    /// Returns the greatest μ that leaves the sensor pulley a third of its frictionless signal.
    pub(crate) fn greatest_mu(&self) -> f64 {
        self.sensor_wrap_rad.map_or(GREATEST_MU, |wrap_rad| {
            let (factor, cos) = (wrap_factor(wrap_rad), libm::cos(wrap_rad));
            let taken = factor * (1.0 + cos);
            // At 180° (cos = −1) friction does not reduce the sensor signal, so there is no bound.
            if taken > 0.0 { GREATEST_MU.min(4.0 / 3.0 * (1.0 - cos) / taken) } else { GREATEST_MU }
        })
    }

    /// Returns the number of pulleys, including the sensor pulley.
    #[must_use]
    pub fn pulley_count(&self) -> usize {
        self.pulley_count
    }

    /// Returns the wrap angle of each pulley from the winch to the platform, rad, 0…2π; `None` if it follows the pose
    /// ([`pose_wrap_rad`](Self::pose_wrap_rad)).
    pub fn fixed_wraps_rad(&self) -> impl Iterator<Item = Option<f64>> + '_ {
        self.wraps.iter().take(self.pulley_count).map(|wrap| match *wrap {
            Wrap::Fixed { wrap_rad } => Some(wrap_rad),
            Wrap::Pose => None,
        })
    }

    /// Returns the wrap angle of the first pulley if it carries the force sensor, rad.
    #[must_use]
    pub fn sensor_wrap_rad(&self) -> Option<f64> {
        self.sensor_wrap_rad
    }

    /// Returns the form of presliding.
    #[must_use]
    pub fn presliding(&self) -> Presliding {
        self.presliding
    }

    /// Returns the friction: μ (1, 0…0.9), σ (N/m, 10⁻³…10¹² if given), F_pv (N s/m, 0…10⁶), ε (N, ±10⁶).
    #[must_use]
    pub fn friction(&self) -> FrictionOptions {
        self.friction
    }

    /// Returns the effects, each parameter in the unit and range of its row in the catalogue.
    #[must_use]
    pub fn effects(&self) -> &EffectParams {
        &self.effects
    }

    /// Returns the friction coefficient μ_p between cable and pulley, 0.01…2; `None` if the cable never slips.
    #[must_use]
    pub fn traction_mu(&self) -> Option<f64> {
        self.traction_mu
    }

    /// Returns the entry point of the cable into the last pulley, base frame, m; `None` without geometry.
    #[must_use]
    pub fn base_m(&self) -> Option<Vector3<f64>> {
        self.geometry.map(|geometry| geometry.base_m)
    }

    /// Returns the attachment, platform frame, m; `None` without geometry.
    #[must_use]
    pub fn platform_m(&self) -> Option<Vector3<f64>> {
        self.geometry.map(|geometry| geometry.platform_m)
    }

    /// Whether the wrap of a pulley follows the pose.
    #[must_use]
    pub fn needs_pose(&self) -> bool {
        self.wraps.contains(&Wrap::Pose)
    }

    /// Whether the attachment is known, so that the cable contributes to the wrench.
    #[must_use]
    pub fn has_geometry(&self) -> bool {
        self.geometry.is_some()
    }
}

/// Checks the wrap of the sensor pulley. Its closed form is singular where `2(1 − c) + sμk(1 + c)` vanishes (\[P\] 10, 11), so this must keep a third
/// of its frictionless value.
fn check_sensor_wrap(wrap_rad: f64, greatest_mu: f64) -> Result<(), ParamError> {
    let (factor, cos) = (wrap_factor(wrap_rad), libm::cos(wrap_rad));
    let frictionless = 2.0 * (1.0 - cos);
    if frictionless >= 1e-2 && frictionless - greatest_mu * factor * (1.0 + cos) >= frictionless / 3.0 {
        Ok(())
    } else {
        Err(ParamError::conflict(
            "wrap_deg",
            "is too small for a sensor pulley with this friction: the sensor would feel friction and hardly any tension",
        ))
    }
}
