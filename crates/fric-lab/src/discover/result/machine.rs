//! Kinds of machines: what differs between their results.

use std::any::TypeId;
use std::fmt::Debug;

use fric_core::effects::Effect;
use serde::Serialize;

use super::DiscoverResult;
use crate::discover::summary;

/// A kind of machine that has a discovery.
///
/// The results of all kinds have the same types, so that each key of `fric-discover/1` is defined once. A kind says which keys it lacks, and the types
/// of values that only make sense for it.
pub trait Machine: Clone + Debug + 'static {
    /// The value of a key that only robots have: the value itself, or [`Absent`].
    type OfRobots<T: Value>: Value;
    /// An end of a range in which the disagreement is concentrated.
    type Bound: Value;
    /// A signal or a cause that a rest correlates with.
    type GoesWith: Value;
    /// Distances from markers.
    type Markers: Value;
    /// The catalogue entry of an effect, which is not part of the JSON.
    type Entry: Clone + Debug;

    /// Returns a summary for people: the verdicts, then the findings.
    fn summary(result: &DiscoverResult<Self>) -> String;
}

/// A value in a result.
pub trait Value: Clone + Debug + Serialize + 'static {}

impl<T: Clone + Debug + Serialize + 'static> Value for T {}

/// A key that this kind of machine does not have; the JSON leaves it out.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Absent;

/// Whether a kind of machine does not have a key.
pub(super) fn is_absent<T: 'static>(_: &T) -> bool {
    TypeId::of::<T>() == TypeId::of::<Absent>()
}

/// A cable robot.
#[derive(Clone, Copy, Debug)]
pub struct Robot;

impl Machine for Robot {
    type OfRobots<T: Value> = T;
    type Bound = f64;
    type GoesWith = String;
    type Markers = Absent;
    type Entry = Effect;

    fn summary(result: &DiscoverResult) -> String {
        summary::describe(result)
    }
}
