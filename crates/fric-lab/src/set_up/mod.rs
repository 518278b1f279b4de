//! What a run tells of its set-up: the scale of the sensor, sign and unit of length and speed, the geometry, and the order of the cables, which are often
//! wrong on the first day.

mod beside;
mod cause;
mod direction;
mod motion;
mod order;
mod scale;
mod sums;

pub(crate) use cause::cause_of_gain;
use direction::Direction;
use fric_core::{RobotParams, Sample};
use motion::Motions;
use order::Order;
use scale::Scale;

/// Sums over a cable's samples, in their order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SetUp {
    scale: Scale,
    direction: Direction,
}

impl SetUp {
    /// Creates empty sums for a cable whose sensor has this frictionless gain, and whose reference is measured or a load that the robot file states.
    pub fn new(frictionless_gain: f64, is_stated: bool) -> Self {
        Self { scale: Scale::new(frictionless_gain, is_stated), direction: Direction::default() }
    }

    /// Begins a log, or what follows a jump of the length.
    pub fn start(&mut self) {
        self.direction.start();
    }

    /// Whether sensor and reference change alike, so that a level between them is a zero and no scale.
    pub fn is_scale_told(&self) -> bool {
        self.scale.is_told_alike()
    }

    /// Adds a sample: its length, its reference, and the force at the platform by the sensor without friction and with the model's.
    pub fn add(&mut self, length_m: f64, reference_n: f64, forces_n: [f64; 2]) {
        let sign = self.direction.add(length_m, reference_n, forces_n[0]);
        self.scale.add(sign, reference_n, forces_n);
    }
}

/// Compares the signals of all cables with one another, sample by sample.
#[derive(Clone, Debug)]
pub(crate) struct Signals {
    motions: Motions,
    order: Order,
}

impl Signals {
    pub fn new(robot: &RobotParams<'_>) -> Self {
        Self { motions: Motions::new(robot), order: Order::new(robot.cables().len()) }
    }

    /// Begins another log.
    pub fn start(&mut self) {
        self.motions.start();
    }

    /// Adds a sample.
    pub fn add(&mut self, sample: &Sample<'_>) {
        self.motions.add(sample);
        self.order.add(sample);
    }

    /// Returns the cables whose length is the same in every sample of the present log.
    pub fn still(&self) -> Vec<usize> {
        self.motions.still()
    }

    /// Returns what is wrong if cables have their own sensor's force as the reference. `names` are those of the cables.
    pub fn copied(&self, names: &[&str]) -> Option<String> {
        self.order.copied(names)
    }

    /// Returns warnings about signals that contradict one another. `names` are those of the cables.
    pub fn warnings(&self, names: &[&str]) -> Vec<String> {
        self.motions.warnings(names).into_iter().chain(self.order.warnings(names)).collect()
    }
}

/// Returns warnings about cables whose forces contradict their set-up. Cables with the same cause share a line.
#[must_use]
pub(crate) fn warnings<'a>(cables: impl Iterator<Item = (&'a str, SetUp)> + Clone) -> Vec<String> {
    let mut warnings = scale::warnings(cables.clone().map(|(name, cable)| (name, cable.scale)));
    // On a wrong scale, of the other sign for example, the rest is no friction.
    let sound = cables.filter(|(_, cable)| !cable.scale.is_off());
    warnings.extend(direction::warning(sound.map(|(name, cable)| (name, cable.direction))));
    warnings
}

/// Returns a warning about cables whose sensor or reference has a zero; `None` without one. A fit or a discovery tells it as a value.
#[must_use]
pub(crate) fn zero_warning<'a>(cables: impl Iterator<Item = (&'a str, SetUp)>) -> Option<String> {
    scale::zero_warning(cables.map(|(name, cable)| (name, cable.scale)))
}
