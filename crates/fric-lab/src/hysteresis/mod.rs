//! Hysteresis of the wrench: the dependence of the measured wrench on the direction from which a position is reached.
//!
//! It gives table II of \[P\]. The platform crosses one position along and about the base axes, in both directions. For each axis, the component of
//! the external wrench `−A^T f` (\[P\] 3) along it is evaluated at the position in each pass. The width of the hysteresis is the magnitude of the
//! difference between the means over the passes in each direction. It is computed for the frictionless forces (without compensation) and for the
//! compensated ones; the ratio of the second to the first is the remaining fraction.
//!
//! If a log contains the true external wrench, it is subtracted, so that applied forces do not count as hysteresis. Without it, gravity is equal in
//! both directions and inertia vanishes at constant speed, but other forces would count.
//!
//! The log is read twice, each time in bounded memory: [`Survey`] finds the crossed position from the poses; [`Hysteresis`] runs the compensator as
//! in the control loop ([`Replay`]) and collects the passes. Non-finite samples interrupt the current pass only.

mod error;
mod loops;
mod movement;
mod pass;
mod result;
mod survey;

use fric_core::robot::file::RobotFile;
use fric_core::{Pose, Sample};

use crate::axis::CartesianAxis;
use crate::replay::Replay;
use loops::LoopSums;
use pass::{Components, Pass, PassFinder};

pub use error::HysteresisError;
pub use loops::HysteresisLoop;
pub use result::{AxisResult, HysteresisResult, WidthResult};
pub use survey::{CrossedPose, Survey};

/// A platform this many tolerances aside is not on the axis.
const ON_AXIS: f64 = 3.0;

/// A width is significant from this many standard errors on.
const SIGNIFICANT: f64 = 2.0;

/// Width of a hysteresis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Width {
    /// Difference of the means in both directions, N or N m.
    pub width: f64,
    /// Standard error from the scatter of the passes; `None` if a direction has a single pass.
    pub standard_error: Option<f64>,
}

/// Hysteresis along or about one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisHysteresis {
    /// The axis.
    pub axis: CartesianAxis,
    /// Number of passes in both directions together.
    pub pass_count: u64,
    /// Width from frictionless forces.
    pub without: Width,
    /// Width from compensated forces.
    pub with: Width,
    /// Whether the external wrench of the log was subtracted.
    pub is_applied_subtracted: bool,
}

impl AxisHysteresis {
    /// Returns the width with compensation divided by the width without; `None` if the width without is within twice its standard error.
    #[must_use]
    pub fn lasting_ratio(&self) -> Option<f64> {
        let scatter = SIGNIFICANT * self.without.standard_error.unwrap_or(0.0);
        (self.without.width > scatter).then(|| self.with.width / self.without.width)
    }
}

/// The second reading of a log, which collects the passes.
#[derive(Debug)]
pub struct Hysteresis {
    replay: Replay,
    crossed: CrossedPose,
    axes: Vec<AxisPasses>,
}

#[derive(Debug)]
struct AxisPasses {
    axis: CartesianAxis,
    finder: PassFinder,
    loops: LoopSums,
    /// Passes against and in the direction of the axis.
    directions: [Gathered; 2],
}

/// Passes in one direction.
#[derive(Clone, Copy, Debug, Default)]
struct Gathered {
    without: Statistics,
    with: Statistics,
    /// The same minus the applied wrench, for passes in which that is known.
    without_less_applied: Statistics,
    with_less_applied: Statistics,
}

impl Hysteresis {
    /// Creates the second reading for a robot and the position that its log crosses.
    ///
    /// # Errors
    /// Returns [`HysteresisError::Robot`] for the errors of [`Replay::new`].
    pub fn new(robot: &RobotFile, crossed: &CrossedPose) -> Result<Self, HysteresisError> {
        let finder = |axis: CartesianAxis| {
            let (reach_m, tolerance_m) = (crossed.reach_m(axis)?, crossed.scale.tolerance_m);
            let (finder, loops) = (PassFinder::new(reach_m, tolerance_m), LoopSums::new(reach_m, tolerance_m));
            Some(AxisPasses { axis, finder, loops, directions: [Gathered::default(); 2] })
        };
        let axes = CartesianAxis::ALL.into_iter().filter_map(finder).collect();
        Ok(Self { replay: Replay::new(&robot.params())?, crossed: crossed.clone(), axes })
    }

    /// Runs one cycle.
    pub fn step(&mut self, sample: &Sample<'_>) {
        let with = self.replay.step(sample).outside_wrench;
        let wrenches = self.replay.frictionless_wrench().zip(with);
        let Some(pose) = sample.pose.filter(Pose::is_usable) else {
            for passes in &mut self.axes {
                passes.add(0.0, None);
            }
            return;
        };
        let scale = self.crossed.scale;
        for passes in &mut self.axes {
            let axis = passes.axis;
            let (along_m, aside_m) = scale.along_and_aside(&pose, self.crossed.pose(), axis);
            let components = wrenches.filter(|_| aside_m <= ON_AXIS * scale.tolerance_m).map(|(without, with)| {
                let applied = sample.outside_wrench.map_or(f64::NAN, |applied| axis.component(&applied));
                Components { without: axis.component(&without), with: axis.component(&with), applied }
            });
            passes.add(along_m, components);
        }
    }

    /// Returns the axes crossed in both directions, in the order x, y, z, a, b, c.
    ///
    /// # Errors
    /// Returns [`HysteresisError::NoWrench`] if there is none.
    pub fn axes(&self) -> Result<Vec<AxisHysteresis>, HysteresisError> {
        let axes: Vec<_> = self.axes.iter().filter_map(AxisPasses::hysteresis).collect();
        if axes.is_empty() { Err(HysteresisError::NoWrench) } else { Ok(axes) }
    }

    /// Returns the loops of the axes crossed in both directions, in the same order.
    #[must_use]
    pub fn loops(&self) -> Vec<HysteresisLoop> {
        let crossed = self.axes.iter().filter(|passes| passes.hysteresis().is_some());
        let lever_m = |axis: CartesianAxis| if axis.is_rotation() { self.crossed.scale.lever_m } else { 1.0 };
        crossed.map(|passes| passes.loops.finish(passes.axis, lever_m(passes.axis))).collect()
    }

    /// Returns the underlying replay, for its warnings about the cables.
    #[must_use]
    pub fn replay(&self) -> &Replay {
        &self.replay
    }
}

impl AxisPasses {
    fn add(&mut self, along_m: f64, components: Option<Components>) {
        self.loops.add(along_m, components.as_ref());
        let Some(Pass { is_forward, components }) = self.finder.add(along_m, components) else { return };
        let Components { without, with, applied } = components;
        let [back, forward] = &mut self.directions;
        let gathered = if is_forward { forward } else { back };
        gathered.without.add(without);
        gathered.with.add(with);
        if applied.is_finite() {
            gathered.without_less_applied.add(without - applied);
            gathered.with_less_applied.add(with - applied);
        }
    }

    fn hysteresis(&self) -> Option<AxisHysteresis> {
        let [back, forward] = &self.directions;
        // All passes or none: passes with and without subtraction cannot be compared.
        let is_applied_subtracted =
            self.directions.iter().all(|gathered| gathered.without_less_applied.count == gathered.without.count);
        let [without, with] = if is_applied_subtracted {
            [
                Statistics::width(&back.without_less_applied, &forward.without_less_applied),
                Statistics::width(&back.with_less_applied, &forward.with_less_applied),
            ]
        } else {
            [Statistics::width(&back.without, &forward.without), Statistics::width(&back.with, &forward.with)]
        };
        Some(AxisHysteresis {
            axis: self.axis,
            pass_count: back.without.count + forward.without.count,
            without: without?,
            with: with?,
            is_applied_subtracted,
        })
    }
}

/// Count, mean and scatter, from running sums.
#[derive(Clone, Copy, Debug, Default)]
struct Statistics {
    count: u64,
    mean: f64,
    squares: f64,
}

impl Statistics {
    fn add(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / number(self.count);
        self.squares += before * (value - self.mean);
    }

    /// Returns the width from the means of both directions; `None` if one has no passes.
    fn width(back: &Self, forward: &Self) -> Option<Width> {
        (back.count > 0 && forward.count > 0).then(|| Width {
            width: (forward.mean - back.mean).abs(),
            standard_error: back
                .variance_of_mean()
                .zip(forward.variance_of_mean())
                .map(|(one, other)| (one + other).sqrt()),
        })
    }

    fn variance_of_mean(&self) -> Option<f64> {
        (self.count > 1).then(|| self.squares / number(self.count - 1) / number(self.count))
    }
}

#[expect(clippy::cast_precision_loss, reason = "a count of passes")]
fn number(count: u64) -> f64 {
    count as f64
}
