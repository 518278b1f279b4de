//! A model for an arm whose number of disks is known only at run time.

use alloc::boxed::Box;
use alloc::vec::Vec;

use fric_core::words::Words as _;

use super::friction::Friction;
use super::inverse::{Command, Drive, Goal};
use super::model::{StateMismatch, StaticModel};
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

    /// Goes on from where another model of the same manipulator is. Does not allocate.
    ///
    /// # Errors
    /// [`StateMismatch`] if the other manipulator has another number of disks; nothing is changed then.
    pub fn copy_state(&mut self, from: &Self) -> Result<(), StateMismatch> {
        match (&mut self.0, &from.0) {
            (OfSize::Eight(model), OfSize::Eight(from)) => model.restore(&from.snapshot()),
            (OfSize::Sixteen(model), OfSize::Sixteen(from)) => model.restore(&from.snapshot()),
            (OfSize::Most(model), OfSize::Most(from)) => model.restore(&from.snapshot()),
            _ => Err(StateMismatch { expected: self.params().disk_count(), found: from.params().disk_count() }),
        }
    }

    /// The state as words, bit for bit, for another process. They are of use to this version of the crate.
    #[must_use]
    pub fn state_words(&self) -> Vec<u64> {
        let mut words = Vec::new();
        each!(&self.0, model => model.snapshot().each_word(&mut |word| words.push(*word)));
        words
    }

    /// Goes on from the words that [`state_words`](Self::state_words) gave for the same manipulator.
    ///
    /// # Errors
    /// [`StateMismatch`] if they are of a manipulator with another number of disks, or of another version; nothing is changed then.
    pub fn restore_words(&mut self, words: &[u64]) -> Result<(), StateMismatch> {
        let expected = self.params().disk_count();
        let found = words.first().and_then(|count| usize::try_from(*count).ok()).unwrap_or(0);
        let mut count = 0;
        each!(&self.0, model => model.snapshot().each_word(&mut |_| count += 1));
        if words.len() != count {
            return Err(StateMismatch { expected, found });
        }
        let mut words = words.iter();
        let mut next = |word: &mut u64| *word = words.next().copied().unwrap_or_default();
        each!(&mut self.0, model => {
            let mut snapshot = model.snapshot();
            snapshot.each_word(&mut next);
            model.restore(&snapshot)
        })
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

    /// See [`Shape::segment_bend_rad`](super::Shape::segment_bend_rad).
    #[must_use]
    pub fn segment_bend_rad(&self) -> &[f64] {
        each!(&self.0, model => model.shape().segment_bend_rad())
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
