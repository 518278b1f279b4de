//! The parameters that a fit varies, and the coordinates in which it varies them.
//!
//! A change of coordinates enforces the ranges, so that the optimiser itself needs no bounds. A positive quantity of unknown magnitude is varied by
//! its logarithm, a quantity of both signs with bounds that are never reached is varied directly, and every other `p ∈ [a, b]` is varied by `u` with
//! `p = a + (b − a)·sin²(u/2)`. The coordinate scale matches the resolution of the parameter, because the optimiser ends when steps are small
//! relative to the coordinates, each weighted by its effect.

use std::fmt;

use fric_core::effects::Effect;
use fric_core::effects::ripple::PERIOD_KEY;
use fric_core::effects::time_delay::{DELAY, delay_range_s};
use fric_core::parameters::{self, FRICTION_COUNT, ParameterRow, Values};
use fric_core::robot::unknown_name;

/// One parameter of a cable: its index in [`Values`] and its catalogue row.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    place: usize,
    effect: Option<Effect>,
    row: &'static ParameterRow,
}

impl Parameter {
    /// Returns every parameter, in the order of [`Values`].
    pub fn all() -> impl Iterator<Item = Self> {
        parameters::parameters().enumerate().map(|(place, (effect, row))| Self { place, effect, row })
    }

    /// Returns the parameters of an effect of the catalogue, or of the friction that every model has.
    pub fn of(effect: Effect) -> impl Iterator<Item = Self> {
        Self::all().skip(effect.places().start).take(effect.places().len())
    }

    /// Returns the parameter with this name: a key of the robot file's `friction`, or `effect.key`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|parameter| parameter.to_string() == name)
    }

    /// Returns the parameters with these names.
    ///
    /// # Errors
    /// Returns a sentence without its full stop about the first name that is unknown or repeated.
    pub fn all_named<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Vec<Self>, String> {
        let mut parameters = Vec::new();
        for name in names {
            let parameter = Self::named(name).ok_or_else(|| {
                let known: Vec<String> = Self::all().map(|parameter| parameter.to_string()).collect();
                unknown_name("parameter", name, known.iter().map(String::as_str))
            })?;
            if parameters.contains(&parameter) {
                return Err(format!("`{name}` is named twice; name it once"));
            }
            parameters.push(parameter);
        }
        Ok(parameters)
    }

    /// Returns its index in [`Values`].
    #[must_use]
    pub fn place(&self) -> usize {
        self.place
    }

    /// Returns its effect; `None` for the parameters of `friction`.
    #[must_use]
    pub fn effect(&self) -> Option<Effect> {
        self.effect
    }

    /// Returns its row: unit, range and neutral value.
    #[must_use]
    pub fn row(&self) -> &'static ParameterRow {
        self.row
    }

    /// Whether it is the period of a ripple.
    #[must_use]
    pub fn is_period(&self) -> bool {
        self.row.key == PERIOD_KEY
    }

    /// Returns how far it is from doing nothing, in its unit: from its neutral value, or from 0 if it is always positive. The two components of a ripple
    /// are as large as the ripple's amplitude, whatever its phase.
    #[must_use]
    pub fn size(&self, values: &Values) -> f64 {
        let distance = |of: &Self| values[of.place] - if of.row.min > 0.0 { 0.0 } else { of.row.neutral };
        match self.effect {
            Some(effect) if !self.is_period() && Self::of(effect).any(|of| of.is_period()) => {
                let components = Self::of(effect).filter(|of| !of.is_period());
                components.map(|of| distance(&of).powi(2)).sum::<f64>().sqrt()
            }
            _ => distance(self).abs(),
        }
    }

    /// Whether it belongs to `friction`.
    #[must_use]
    pub fn is_friction(&self) -> bool {
        self.place < FRICTION_COUNT
    }
}

/// Writes the name that [`Parameter::named`] accepts.
impl fmt::Display for Parameter {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(effect) = self.effect {
            write!(formatter, "{effect}.")?;
        }
        formatter.write_str(self.row.key)
    }
}

impl PartialEq for Parameter {
    fn eq(&self, other: &Self) -> bool {
        self.place == other.place
    }
}

impl Eq for Parameter {}

/// The coordinate in which a number is varied: its logarithm if the range spans orders of magnitude, an angle in any other range (so that long steps
/// towards a bound become shorter), or the number itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    min: f64,
    max: f64,
    shape: Shape,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Logarithmic,
    Plain,
    Bounded,
}

/// A range spans orders of magnitude if the ratio of its ends exceeds this value.
const WIDE_RATIO: f64 = 1e3;
/// Bounds of both signs beyond this value are never reached, in the parameter's unit.
const FAR: f64 = 1e3;
/// Starts and searches keep this fraction of the range's width away from the bounds, because the coordinate has zero slope at a bound.
const START_RATIO: f64 = 1e-9;
const END_RATIO: f64 = 1e-10;
/// Maximum relative difference of slopes over a step that counts as straight: a thousandth of a standard error is too little to matter.
const STRAIGHT_RATIO: f64 = 1e-3;

impl Coordinate {
    /// The coordinate of an unbounded number.
    pub const UNBOUNDED: Self = Self { min: f64::NEG_INFINITY, max: f64::INFINITY, shape: Shape::Plain };

    /// Returns the coordinate of a parameter at a cycle time.
    pub fn of(parameter: &Parameter, cycle_s: f64) -> Self {
        let ParameterRow { min, max, .. } = *parameter.row;
        let (min, max) = if parameter.place == DELAY { delay_range_s(cycle_s) } else { (min, max) };
        let shape = if min > 0.0 && max / min > WIDE_RATIO {
            Shape::Logarithmic
        } else if min < -FAR && max > FAR {
            Shape::Plain
        } else {
            Shape::Bounded
        };
        Self { min, max, shape }
    }

    /// Returns the least and the greatest value.
    pub fn range(self) -> (f64, f64) {
        (self.min, self.max)
    }

    /// Returns the bound that a search was driven to: the value is nearer to it than any start, or than `near`.
    pub fn bound_at(self, value: f64, near: f64) -> Option<f64> {
        let bound = if value - self.min < self.max - value { self.min } else { self.max };
        let margin = match self.shape {
            Shape::Bounded => 0.5 * START_RATIO * (self.max - self.min),
            // A bound comes back from its logarithm with rounding.
            Shape::Logarithmic => START_RATIO * bound,
            Shape::Plain => 0.0,
        };
        ((value - bound).abs() <= margin.max(near)).then_some(bound)
    }

    /// Returns the coordinate of a value. A value out of range is moved into it.
    pub fn place_of(self, value: f64) -> f64 {
        match self.shape {
            Shape::Logarithmic => value.clamp(self.min, self.max).ln(),
            Shape::Plain => value.clamp(self.min, self.max),
            Shape::Bounded => {
                angle_of(((value - self.min) / (self.max - self.min)).clamp(START_RATIO, 1.0 - START_RATIO))
            }
        }
    }

    /// Returns the nearest coordinate that a search may use.
    pub fn kept_in(self, place: f64) -> f64 {
        match self.shape {
            Shape::Logarithmic => place.clamp(self.min.ln(), self.max.ln()),
            Shape::Plain => place.clamp(self.min, self.max),
            Shape::Bounded => place.clamp(angle_of(END_RATIO), angle_of(1.0 - END_RATIO)),
        }
    }

    /// Whether the value is linear in the coordinate from one point to another, to [`STRAIGHT_RATIO`].
    pub fn is_straight(self, from: f64, to: f64) -> bool {
        let (before, after) = (self.value_at(from).1, self.value_at(to).1);
        (after - before).abs() <= STRAIGHT_RATIO * before.abs()
    }

    /// Returns the value at a coordinate, and its slope.
    pub fn value_at(self, place: f64) -> (f64, f64) {
        match self.shape {
            Shape::Logarithmic => {
                let value = place.exp().clamp(self.min, self.max);
                (value, value)
            }
            Shape::Plain => (place.clamp(self.min, self.max), 1.0),
            Shape::Bounded => {
                let (sin, cos) = (0.5 * place).sin_cos();
                let width = self.max - self.min;
                (self.min + width * sin * sin, width * sin * cos)
            }
        }
    }
}

/// Returns the angle at a fraction of a range.
fn angle_of(share: f64) -> f64 {
    2.0 * share.sqrt().asin()
}

/// Returns `values` with `changed` in the positions of `free`.
pub fn with(values: &Values, free: &[Parameter], changed: impl IntoIterator<Item = f64>) -> Values {
    let mut values = *values;
    for (parameter, value) in free.iter().zip(changed) {
        values[parameter.place] = value;
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_keep_the_range_and_their_slope_is_the_derivative() {
        for parameter in Parameter::all() {
            let coordinate = Coordinate::of(&parameter, 0.001);
            for share in [1e-4, 0.01, 0.3, 0.8] {
                let (min, max) = (coordinate.min, coordinate.max);
                let value = if coordinate.shape == Shape::Logarithmic {
                    min * (max / min).powf(share)
                } else {
                    min + share * (max - min)
                };
                let place = coordinate.place_of(value);
                let (back, slope) = coordinate.value_at(place);
                assert!(
                    (back - value).abs() <= 1e-9 * (max - min).min(value.abs().max(1.0)),
                    "{parameter}: {value} {back}"
                );
                assert_eq!(coordinate.kept_in(place).to_bits(), place.to_bits(), "{parameter}");
                let h = 1e-6 * place.abs().max(1e-3);
                let numeric = (coordinate.value_at(place + h).0 - coordinate.value_at(place - h).0) / (2.0 * h);
                assert!((slope - numeric).abs() <= 1e-5 * numeric.abs(), "{parameter}: {slope} {numeric}");
            }
            for wild in [-1e9, -1.0, 0.0, 17.3, 1e4] {
                let (value, _) = coordinate.value_at(coordinate.kept_in(wild));
                assert!((coordinate.min..=coordinate.max).contains(&value), "{parameter}");
            }
        }
    }

    #[test]
    fn a_search_is_at_a_bound_where_no_start_is() {
        let mu = Coordinate::of(&Parameter::named("mu").unwrap(), 0.001);
        assert_eq!(mu.bound_at(mu.value_at(mu.kept_in(-1.0)).0, 0.0), Some(0.0));
        assert_eq!(mu.bound_at(mu.value_at(mu.place_of(0.0)).0, 0.0), None);
        assert_eq!(mu.bound_at(1e-6, 1e-5), Some(0.0));
        assert_eq!(mu.bound_at(0.9, 0.0), Some(0.9));
        assert_eq!(mu.bound_at(0.02, 1e-5), None);
        let sigma = Coordinate::of(&Parameter::named("sigma_n_per_m").unwrap(), 0.001);
        assert_eq!(sigma.bound_at(700.0, 0.0), None);
    }

    #[test]
    fn names_lead_to_their_parameter() {
        assert_eq!(Parameter::named("mu").map(|parameter| parameter.place()), Some(parameters::MU));
        assert_eq!(Parameter::named("time_delay.delay_s").map(|parameter| parameter.place()), Some(DELAY));
        assert!(Parameter::named("delay_s").is_none());
        assert!(Parameter::all().all(|parameter| Parameter::named(&parameter.to_string()) == Some(parameter)));
    }
}
