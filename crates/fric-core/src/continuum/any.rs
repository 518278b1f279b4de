//! A model for an arm whose number of disks is known only at run time.

use alloc::boxed::Box;

use super::friction::Friction;
use super::inverse::{Command, Drive, Goal};
use super::model::StaticModel;
use super::params::{MAX_DISKS, ManipulatorError, ManipulatorParams, Tendon};
use super::shape::ShapeStatus;

/// [`StaticModel`] for any number of disks up to [`MAX_DISKS`]: the smallest of a few sizes that holds the arm. The size does not change a
/// bit of the result. Set-up allocates once, nothing else does. Needs the feature `alloc`.
#[derive(Clone, Debug)]
pub struct AnyStaticModel(OfSize);

#[derive(Clone, Debug)]
enum OfSize {
    Eight(Box<StaticModel<8>>),
    Sixteen(Box<StaticModel<16>>),
    Most(Box<StaticModel<MAX_DISKS>>),
}

/// The same work on the model of any size.
macro_rules! each {
    ($any:expr, $model:ident => $work:expr) => {
        match $any {
            OfSize::Eight($model) => $work,
            OfSize::Sixteen($model) => $work,
            OfSize::Most($model) => $work,
        }
    };
}

impl AnyStaticModel {
    /// Straight, without tension, with relaxed holes.
    ///
    /// # Errors
    /// As [`StaticModel::new`]; none for parameters that have been checked.
    pub fn new(params: &ManipulatorParams) -> Result<Self, ManipulatorError> {
        Ok(Self(match params.disk_count() {
            0..=8 => OfSize::Eight(Box::new(StaticModel::new(params)?)),
            9..=16 => OfSize::Sixteen(Box::new(StaticModel::new(params)?)),
            _ => OfSize::Most(Box::new(StaticModel::new(params)?)),
        }))
    }

    /// The parameters.
    #[must_use]
    pub fn params(&self) -> &ManipulatorParams {
        each!(&self.0, model => model.params())
    }

    /// See [`StaticModel::reset`].
    pub fn reset(&mut self) {
        each!(&mut self.0, model => model.reset());
    }

    /// See [`StaticModel::solve`].
    pub fn solve(&mut self, base_tension_n: [f64; 2], friction: Friction<'_>) -> ShapeStatus {
        each!(&mut self.0, model => model.solve(base_tension_n, friction))
    }

    /// See [`StaticModel::tension_for`].
    pub fn tension_for(&mut self, goal: Goal, friction: Friction<'_>, drive: &Drive) -> Command {
        each!(&mut self.0, model => model.tension_for(goal, friction, drive))
    }

    /// See [`Shape::disk_position_m`](super::Shape::disk_position_m).
    #[must_use]
    pub fn disk_position_m(&self) -> &[[f64; 2]] {
        each!(&self.0, model => model.shape().disk_position_m())
    }

    /// See [`Shape::bend_rad`](super::Shape::bend_rad).
    #[must_use]
    pub fn bend_rad(&self) -> f64 {
        each!(&self.0, model => model.shape().bend_rad())
    }

    /// See [`Shape::tension_n`](super::Shape::tension_n).
    #[must_use]
    pub fn tension_n(&self, tendon: Tendon) -> &[f64] {
        each!(&self.0, model => model.shape().tension_n(tendon))
    }

    /// See [`Shape::friction_n`](super::Shape::friction_n).
    #[must_use]
    pub fn friction_n(&self, tendon: Tendon) -> &[f64] {
        each!(&self.0, model => model.shape().friction_n(tendon))
    }

    /// See [`Shape::bound_n`](super::Shape::bound_n).
    #[must_use]
    pub fn bound_n(&self, tendon: Tendon) -> &[f64] {
        each!(&self.0, model => model.shape().bound_n(tendon))
    }
}
