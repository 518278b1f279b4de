//! Checks one `[[cable]]` of a robot file.

use std::borrow::ToOwned;
use std::format;
use std::string::ToString;
use std::vec::Vec;

use super::file::{CableTable, PreslidingName, PulleyTable, WrapName};
use super::locate::{Step, unknown_name};
use super::options_error::OptionsError;
use super::{
    CableOptions, CableParams, FrictionOptions, GeometryOptions, ParamError, ParamProblem, Presliding, PulleyOptions,
    ValidatedRange,
};
use crate::effects::empirical::Over;
use crate::effects::{Effect, EffectParams};

impl CableTable {
    /// Returns the checked cable.
    pub(super) fn check(&self) -> Result<CableParams, OptionsError> {
        if self.name.trim().is_empty() {
            let problem = "is empty; give the name that the log has for the cable".to_owned();
            return Err(OptionsError::new(&[Step::Key("name")], "name", problem));
        }
        let pulleys = self
            .pulleys
            .iter()
            .enumerate()
            .map(|(place, pulley)| pulley.check(place))
            .collect::<Result<Vec<_>, _>>()?;
        let geometry = match (self.base_m, self.platform_m) {
            (Some(base_m), Some(platform_m)) => Some(GeometryOptions { base_m, platform_m }),
            (None, None) => None,
            (given, _) => {
                let (given, missing) =
                    if given.is_some() { ("base_m", "platform_m") } else { ("platform_m", "base_m") };
                let problem = format!("is given without `{missing}`; give both or neither");
                return Err(OptionsError::new(&[Step::Key(given)], given, problem));
            }
        };
        let validated = self.validated.as_ref().map_or(ValidatedRange::ANY, |table| ValidatedRange {
            force_n: table.force_n.unwrap_or(ValidatedRange::ANY.force_n),
            speed_m_per_s: table.speed_m_per_s.unwrap_or(ValidatedRange::ANY.speed_m_per_s),
        });
        CableParams::new(&CableOptions {
            pulleys: &pulleys,
            presliding: match self.presliding {
                PreslidingName::PerPulley => Presliding::PerPulley,
                PreslidingName::Lumped => Presliding::Lumped,
            },
            friction: FrictionOptions {
                mu: self.friction.mu,
                sigma_n_per_m: self.friction.sigma_n_per_m,
                viscous_n_s_per_m: self.friction.viscous_n_s_per_m,
                offset_n: self.friction.offset_n,
            },
            geometry,
            traction_mu: self.traction_mu,
            validated,
            effects: self.effect_params()?,
        })
        .map_err(|error| self.name_parameter(error))
    }

    /// Returns the error with the position of a refused parameter in this cable's table: in one of its effects, or in the table itself.
    pub(super) fn name_parameter(&self, error: ParamError) -> OptionsError {
        let Some(effect) = error.effect else { return OptionsError::from(error) };
        let kind = effect.kind();
        let mut of_kind = self.effects.iter().enumerate().filter(|(_, effect)| effect.kind == kind);
        if let Some((index, _)) = of_kind.nth(usize::from(effect.is_second())) {
            let path = [Step::Key("effects"), Step::Index(index), Step::Key(error.key)];
            return OptionsError::new(&path, error.key, format!("of effect `{kind}` {}", error.problem));
        }
        OptionsError::from(error)
    }

    fn effect_params(&self) -> Result<EffectParams, OptionsError> {
        let mut params = EffectParams::NEUTRAL;
        for (index, effect) in self.effects.iter().enumerate() {
            let path = [Step::Key("effects"), Step::Index(index)];
            let before = self.effects.iter().take(index).filter(|other| other.kind == effect.kind).count();
            let Some(named) = Effect::all_of_kind(&effect.kind).nth(before) else {
                let problem = match before {
                    0 => {
                        let known = Effect::kinds().map(Effect::kind);
                        format!("names an {}", unknown_name("effect", &effect.kind, known))
                    }
                    1 => format!("names the effect `{}`, which the cable already has", effect.kind),
                    _ => format!(
                        "names the effect `{}`, which the cable already has twice, as often as it can",
                        effect.kind
                    ),
                };
                return Err(OptionsError::new(&path, "kind", problem));
            };
            for (key, value) in &effect.parameters {
                let known = || named.row().parameters.iter().map(|parameter| parameter.key);
                if !known().any(|name| name == key) {
                    let problem = format!("has an {}", unknown_name("key", key, known()));
                    return Err(OptionsError::new(&path, named.kind(), problem));
                }
                params.set(named, key, *value).map_err(|error| self.name_parameter(error))?;
            }
            if named == Effect::Empirical {
                check_ranges(&params, &path)?;
            }
        }
        Ok(params)
    }
}

/// Checks whether an `empirical` table is over one condition.
fn check_ranges(params: &EffectParams, path: &[Step]) -> Result<(), OptionsError> {
    let row = Effect::Empirical.row();
    let value = |place: usize| {
        let parameter = row.parameters.get(place - Effect::Empirical.first_place());
        parameter.and_then(|parameter| params.get(Effect::Empirical, parameter.key)).unwrap_or(0.0)
    };
    let count = Over::ALL.iter().filter(|over| value(over.from()) < value(over.to())).count();
    let acts = row.parameters.iter().any(|parameter| {
        parameter.fitted && params.get(Effect::Empirical, parameter.key).is_some_and(|value| value.abs() > 0.0)
    });
    let problem = match count {
        0 if acts => {
            "has no range; give the beginning and the end of one, such as `speed_from_m_per_s` and `speed_to_m_per_s`"
        }
        0 | 1 => return Ok(()),
        _ => "has the ranges of several conditions; a table is over one: give the range of one",
    };
    Err(OptionsError::new(path, row.kind, problem.to_owned()))
}

impl PulleyTable {
    fn check(&self, place: usize) -> Result<PulleyOptions, OptionsError> {
        let wrong = |key: &'static str, problem: &str| {
            let path = [Step::Key("pulleys"), Step::Index(place), Step::Key(key)];
            Err(OptionsError::new(&path, key, format!("of pulley {} {problem}", place + 1)))
        };
        let sensor = self.sensor.unwrap_or(false);
        match (self.wrap_deg, self.wrap, self.radius_m, self.axis) {
            (Some(wrap_deg), None, None, None) => Ok(PulleyOptions::Fixed { wrap_rad: wrap_deg.to_radians(), sensor }),
            (Some(_), Some(_), ..) => wrong("wrap", "stands beside `wrap_deg`; give one of them"),
            (Some(_), None, Some(_), _) => wrong("radius_m", "belongs to `wrap = \"pose\"`, not to a fixed wrap"),
            (Some(_), None, None, Some(_)) => wrong("axis", "belongs to `wrap = \"pose\"`, not to a fixed wrap"),
            (None, Some(WrapName::Pose), Some(_), Some(_)) if sensor => {
                wrong("sensor", "cannot be true: the wrap of the sensor pulley has to be fixed")
            }
            (None, Some(WrapName::Pose), Some(radius_m), Some(axis)) => Ok(PulleyOptions::Swivel { radius_m, axis }),
            (None, Some(WrapName::Pose), None, _) => wrong("wrap", "is \"pose\", which needs `radius_m` beside it"),
            (None, Some(WrapName::Pose), _, None) => wrong("wrap", "is \"pose\", which needs `axis` beside it"),
            (None, None, ..) => {
                wrong("wrap_deg", "is missing; give it, or `wrap = \"pose\"` with `radius_m` and `axis`")
            }
        }
    }
}

/// Converts checked names and radians back to the keys and degrees of the file.
impl From<ParamError> for OptionsError {
    fn from(error: ParamError) -> Self {
        let (key, problem) = match (error.key, error.problem) {
            ("wrap_rad", ParamProblem::OutOfRange { value, min, max }) => {
                let [value, min, max] = [value, min, max].map(|angle_rad| (angle_rad.to_degrees() * 1e9).round() / 1e9);
                ("wrap_deg", ParamProblem::OutOfRange { value, min, max })
            }
            (key, problem) => (key, problem),
        };
        let place =
            error.pulley.map_or_else(|| problem.to_string(), |pulley| format!("of pulley {} {problem}", pulley + 1));
        let mut path = Vec::new();
        if let Some(pulley) = error.pulley {
            path.extend([Step::Key("pulleys"), Step::Index(pulley)]);
        } else if ["mu", "sigma_n_per_m", "viscous_n_s_per_m", "offset_n"].contains(&key) {
            path.push(Step::Key("friction"));
        } else if ["force_n", "speed_m_per_s"].contains(&key) {
            path.push(Step::Key("validated"));
        }
        path.push(Step::Key(key));
        Self::new(&path, key, place)
    }
}
