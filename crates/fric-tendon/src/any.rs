//! A model for a manipulator whose number of disks is known only at run time.

use alloc::boxed::Box;
use alloc::vec::Vec;

use fric_core::words::Words as _;

use super::friction::Friction;
use super::inverse::{Command, Drive, Goal};
use super::model::{StateMismatch, StaticModel};
use super::params::{MAX_DISKS, ManipulatorError, ManipulatorParams, Tendon};
use super::shape::ShapeStatus;

/// A [`StaticModel`] for any number of disks up to [`MAX_DISKS`]: it uses the smallest of a few sizes that holds the manipulator. The size does not
/// change a bit of the result. Only set-up allocates, once. Needs the feature `alloc`.
#[derive(Clone, Debug)]
pub struct AnyStaticModel(OfSize);

#[derive(Clone, Debug)]
enum OfSize {
    Eight(Box<StaticModel<8>>),
    Sixteen(Box<StaticModel<16>>),
    Most(Box<StaticModel<MAX_DISKS>>),
}

/// Runs the same code on the model of any size.
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
    /// Creates a straight model without tension and with relaxed holes.
    ///
    /// # Errors
    /// Returns the errors of [`StaticModel::new`]; none for checked parameters.
    pub fn new(params: &ManipulatorParams) -> Result<Self, ManipulatorError> {
        Ok(Self(match params.disk_count() {
            0..=8 => OfSize::Eight(Box::new(StaticModel::new(params)?)),
            9..=16 => OfSize::Sixteen(Box::new(StaticModel::new(params)?)),
            _ => OfSize::Most(Box::new(StaticModel::new(params)?)),
        }))
    }

    /// Returns the parameters.
    #[must_use]
    pub fn params(&self) -> &ManipulatorParams {
        each!(&self.0, model => model.params())
    }

    /// Resets the model; see [`StaticModel::reset`].
    pub fn reset(&mut self) {
        each!(&mut self.0, model => model.reset());
    }

    /// Copies the state of another model of the same manipulator. Does not allocate.
    ///
    /// # Errors
    /// Returns a [`StateMismatch`] if the other manipulator has another number of disks; nothing is changed then.
    pub fn copy_state(&mut self, from: &Self) -> Result<(), StateMismatch> {
        match (&mut self.0, &from.0) {
            (OfSize::Eight(model), OfSize::Eight(from)) => model.restore(&from.snapshot()),
            (OfSize::Sixteen(model), OfSize::Sixteen(from)) => model.restore(&from.snapshot()),
            (OfSize::Most(model), OfSize::Most(from)) => model.restore(&from.snapshot()),
            _ => Err(StateMismatch { expected: self.params().disk_count(), found: from.params().disk_count() }),
        }
    }

    /// Returns the state as words, bit for bit, for another process. The words are valid only for this version of the crate.
    #[must_use]
    pub fn state_words(&self) -> Vec<u64> {
        let mut words = Vec::new();
        each!(&self.0, model => model.snapshot().each_word(&mut |word| words.push(*word)));
        words
    }

    /// Restores the state from the words of [`state_words`](Self::state_words) of the same manipulator.
    ///
    /// # Errors
    /// Returns a [`StateMismatch`] if the words belong to a manipulator with another number of disks, or to another version; nothing is changed then.
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

    /// Computes the shape; see [`StaticModel::solve`].
    pub fn solve(&mut self, base_tension_n: [f64; 2], friction: Friction<'_>) -> ShapeStatus {
        each!(&mut self.0, model => model.solve(base_tension_n, friction))
    }

    /// Begins the history with what the holes hold; see [`StaticModel::begin_history`].
    pub fn begin_history(&mut self, base_tension_n: [f64; 2], tension_n: [&[f64]; 2]) -> ShapeStatus {
        each!(&mut self.0, model => model.begin_history(base_tension_n, tension_n))
    }

    /// Computes the base tensions for a goal; see [`StaticModel::tension_for`].
    pub fn tension_for(&mut self, goal: Goal, friction: Friction<'_>, drive: &Drive) -> Command {
        each!(&mut self.0, model => model.tension_for(goal, friction, drive))
    }

    /// Returns the centres of the disks, m; see [`Shape::disk_position_m`](super::Shape::disk_position_m).
    #[must_use]
    pub fn disk_position_m(&self) -> &[[f64; 2]] {
        each!(&self.0, model => model.shape().disk_position_m())
    }

    /// Returns the bend of each segment, rad; see [`Shape::segment_bend_rad`](super::Shape::segment_bend_rad).
    #[must_use]
    pub fn segment_bend_rad(&self) -> &[f64] {
        each!(&self.0, model => model.shape().segment_bend_rad())
    }

    /// Returns the bend of the whole manipulator, rad; see [`Shape::bend_rad`](super::Shape::bend_rad).
    #[must_use]
    pub fn bend_rad(&self) -> f64 {
        each!(&self.0, model => model.shape().bend_rad())
    }

    /// Returns the tension in each segment, N; see [`Shape::tension_n`](super::Shape::tension_n).
    #[must_use]
    pub fn tension_n(&self, tendon: Tendon) -> &[f64] {
        each!(&self.0, model => model.shape().tension_n(tendon))
    }

    /// Returns the friction at each hole, N; see [`Shape::friction_n`](super::Shape::friction_n).
    #[must_use]
    pub fn friction_n(&self, tendon: Tendon) -> &[f64] {
        each!(&self.0, model => model.shape().friction_n(tendon))
    }

    /// Returns the greatest friction at each hole, N; see [`Shape::bound_n`](super::Shape::bound_n).
    #[must_use]
    pub fn bound_n(&self, tendon: Tendon) -> &[f64] {
        each!(&self.0, model => model.shape().bound_n(tendon))
    }
}
