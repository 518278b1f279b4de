//! Divides the motion of a platform into straight movements along, and rotations about, one base axis at a time.
//!
//! Angles count as the distance that a point at the end of a lever travels, so that one tolerance serves for both. Anything below the tolerance is
//! noise. Rests do not divide a movement; reversals and lateral motion do.

use fric_core::Pose;
use nalgebra::Vector6;

use crate::axis::{CartesianAxis, displacement};

/// Minimum length of a movement, in tolerances.
const SHORTEST: f64 = 2.0;
/// Maximum lateral deviation of a movement, relative to its length. A greater deviation means motion along several axes at once.
const ASIDE_RATIO: f64 = 0.15;

/// The scale for deviations from a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Tolerance for deviations, m.
    pub tolerance_m: f64,
    /// Lever that converts angles to distances, m.
    pub lever_m: f64,
}

impl Scale {
    /// Returns the displacement of a pose from another, with angles as distances, m.
    pub fn displacement(&self, pose: &Pose, from: &Pose) -> Vector6<f64> {
        let Self { lever_m, .. } = *self;
        displacement(pose, from).component_mul(&Vector6::new(1.0, 1.0, 1.0, lever_m, lever_m, lever_m))
    }

    /// Returns the distance along an axis and the greatest deviation from it, m.
    pub fn along_and_aside(&self, pose: &Pose, from: &Pose, axis: CartesianAxis) -> (f64, f64) {
        split(&self.displacement(pose, from), axis)
    }
}

fn split(way_m: &Vector6<f64>, axis: CartesianAxis) -> (f64, f64) {
    let others = way_m.iter().enumerate().filter(|(index, _)| *index != axis.index());
    let along_m = way_m.iter().nth(axis.index()).copied().unwrap_or(0.0);
    (along_m, others.map(|(_, part)| part.abs()).fold(0.0, f64::max))
}

/// One movement along or about an axis.
#[derive(Clone, Copy, Debug)]
pub struct Movement {
    pub axis: CartesianAxis,
    pub from: Pose,
    pub to: Pose,
    /// Whether it runs in the direction of the axis.
    pub is_forward: bool,
}

/// Finds the movements in a sequence of poses.
#[derive(Debug)]
pub struct Movements {
    scale: Scale,
    /// The pose at which the present movement, or the rest, started.
    anchor: Option<Pose>,
    moving: Option<Moving>,
    strayed_m: f64,
}

/// A movement in progress.
#[derive(Clone, Copy, Debug)]
struct Moving {
    axis: CartesianAxis,
    sign: f64,
    furthest: Pose,
    furthest_m: f64,
    aside_m: f64,
}

impl Movements {
    pub fn new(scale: Scale) -> Self {
        Self { scale, anchor: None, moving: None, strayed_m: 0.0 }
    }

    /// Returns how far the platform moved along several axes at once, m.
    pub fn strayed_m(&self) -> f64 {
        self.strayed_m
    }

    /// Adds the next pose and returns the movement that it ends, if any.
    pub fn add(&mut self, pose: &Pose) -> Option<Movement> {
        let anchor = *self.anchor.get_or_insert(*pose);
        let Some(moving) = &mut self.moving else {
            self.start(pose, &anchor);
            return None;
        };
        let (along_m, aside_m) = self.scale.along_and_aside(pose, &anchor, moving.axis);
        let onward_m = along_m * moving.sign;
        let is_back = onward_m < moving.furthest_m - self.scale.tolerance_m;
        if is_back || aside_m > self.scale.tolerance_m {
            let ended = self.end();
            self.start(pose, &self.anchor.unwrap_or(*pose));
            return ended;
        }
        moving.aside_m = moving.aside_m.max(aside_m);
        if onward_m > moving.furthest_m {
            moving.furthest_m = onward_m;
            moving.furthest = *pose;
        }
        None
    }

    /// Returns the movement in progress at the end of the poses, if any.
    pub fn end(&mut self) -> Option<Movement> {
        let (moving, from) = self.moving.take().zip(self.anchor)?;
        self.anchor = Some(moving.furthest);
        if moving.aside_m > ASIDE_RATIO * moving.furthest_m {
            self.strayed_m += moving.furthest_m;
            return None;
        }
        Some(Movement { axis: moving.axis, from, to: moving.furthest, is_forward: moving.sign > 0.0 })
    }

    /// Starts a movement once the platform is far enough from the anchor.
    fn start(&mut self, pose: &Pose, anchor: &Pose) {
        let way_m = self.scale.displacement(pose, anchor);
        let (axis, along_m, aside_m) = CartesianAxis::ALL
            .map(|axis| {
                let (along_m, aside_m) = split(&way_m, axis);
                (axis, along_m, aside_m)
            })
            .into_iter()
            .fold(
                (CartesianAxis::X, 0.0_f64, 0.0_f64),
                |best, next| if next.1.abs() > best.1.abs() { next } else { best },
            );
        if along_m.abs() < SHORTEST * self.scale.tolerance_m {
            return;
        }
        if aside_m > self.scale.tolerance_m {
            self.strayed_m += along_m.abs();
            self.anchor = Some(*pose);
            return;
        }
        let sign = along_m.signum();
        self.moving = Some(Moving { axis, sign, furthest: *pose, furthest_m: along_m.abs(), aside_m });
    }
}
