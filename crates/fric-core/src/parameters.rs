//! The list of all parameters of a cable's friction, which an identification may vary.
//!
//! The four parameters of the robot file's `friction` come first, then those of each effect in the order of the catalogue. The order is that of
//! [`Values`]; a [`ParameterRow`] describes each.

use crate::effects::{self, EFFECT_PARAMETER_COUNT, Effect};
use crate::robot::{CableParams, FrictionOptions, ParamError};

/// One parameter of the friction model.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ParameterRow {
    /// Its key in robot files, including the unit.
    pub key: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The value without effect, which is also the default in a file.
    pub neutral: f64,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Whether an identification varies it by default; if not, it is a setting or must be found by other means.
    pub fitted: bool,
    /// What a log must contain to identify it.
    pub excitation: &'static str,
}

impl ParameterRow {
    /// Creates the row of a parameter that an identification varies, from its key, its unit, its least, neutral and greatest value, and what identifies it.
    pub(crate) const fn fitted(
        key: &'static str,
        unit: &'static str,
        [min, neutral, max]: [f64; 3],
        excitation: &'static str,
    ) -> Self {
        Self { key, unit, neutral, min, max, fitted: true, excitation }
    }

    /// Creates the row of a parameter that is a setting, or found by other means; see [`fitted`](Self::fitted).
    pub(crate) const fn setting(
        key: &'static str,
        unit: &'static str,
        range: [f64; 3],
        excitation: &'static str,
    ) -> Self {
        Self { fitted: false, ..Self::fitted(key, unit, range, excitation) }
    }
}

/// Represents "no presliding": motion of a picometre reverses any friction.
pub const NO_PRESLIDING_N_PER_M: f64 = 1e15;
/// `2 − μk` of \[P\] 10 stays well above zero for every wrap.
pub const GREATEST_MU: f64 = 0.9;

/// Parameters of the robot file's `friction`, the vector p of \[P\] 18.
pub const FRICTION: [ParameterRow; FRICTION_COUNT] = [
    ParameterRow::fitted(
        "mu",
        "1",
        [0.0, 0.0, GREATEST_MU],
        "motion of the cable in both directions, each time much further than its presliding distance",
    ),
    ParameterRow::fitted(
        "sigma_n_per_m",
        "N/m",
        [1e-3, NO_PRESLIDING_N_PER_M, 1e12],
        "small movements that reverse: steps of 0.25 … 10 mm there and back, with breaks",
    ),
    ParameterRow::fitted(
        "viscous_n_s_per_m",
        "N s/m",
        [0.0, 0.0, 1e6],
        "fast motion beside slow: strokes at several speeds up to the highest",
    ),
    ParameterRow::fitted(
        "offset_n",
        "N",
        [-1e6, 0.0, 1e6],
        "long movements in both directions, with a force sensor at the platform or poses throughout the workspace",
    ),
];
/// Number of parameters of the robot file's `friction`.
pub const FRICTION_COUNT: usize = 4;
/// Index of μ.
pub const MU: usize = 0;
/// Index of σ of the whole cable.
pub const SIGMA: usize = 1;
/// Index of F_pv.
pub const VISCOUS: usize = 2;
/// Index of ε.
pub const OFFSET: usize = 3;

/// Number of parameters of a cable.
pub const PARAMETER_COUNT: usize = FRICTION_COUNT + EFFECT_PARAMETER_COUNT;

/// A value for each parameter of a cable; `T` is a plain number or one that carries derivatives.
pub type Values<T = f64> = [T; PARAMETER_COUNT];

/// Returns each parameter in the order of [`Values`], with its effect; `None` for those of `friction`.
pub fn parameters() -> impl Iterator<Item = (Option<Effect>, &'static ParameterRow)> {
    let of_effects = effects::parameters().map(|(effect, parameter)| (Some(effect), parameter));
    FRICTION.iter().map(|parameter| (None, parameter)).chain(of_effects)
}

impl CableParams {
    /// Returns the values of all parameters.
    #[must_use]
    pub fn values(&self) -> Values {
        let FrictionOptions { mu, sigma_n_per_m, viscous_n_s_per_m, offset_n } = self.friction;
        let friction = [mu, sigma_n_per_m.unwrap_or(NO_PRESLIDING_N_PER_M), viscous_n_s_per_m, offset_n];
        let mut all = friction.into_iter().chain(*self.effects.values());
        core::array::from_fn(|_| all.next().unwrap_or(0.0))
    }

    /// Returns the same cable with other values.
    ///
    /// # Errors
    /// Returns a [`ParamError`] with the first value that is out of range or inconsistent with the rest of the cable. A σ of
    /// [`NO_PRESLIDING_N_PER_M`] means no presliding.
    pub fn with_values(&self, values: &Values) -> Result<Self, ParamError> {
        let &[mu, sigma_n_per_m, viscous_n_s_per_m, offset_n, ref effects @ ..] = values;
        let sigma_n_per_m = (sigma_n_per_m < NO_PRESLIDING_N_PER_M).then_some(sigma_n_per_m);
        let friction = FrictionOptions { mu, sigma_n_per_m, viscous_n_s_per_m, offset_n };
        let params = Self { friction, effects: effects::EffectParams::from_values(*effects)?, ..*self };
        params.check_friction()?;
        Ok(params)
    }
}
