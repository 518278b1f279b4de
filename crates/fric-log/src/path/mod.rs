//! Message paths: the location of a signal in a log.
//!
//! A path is a topic, or a topic and the path to a field inside its messages, in the notation of Foxglove: `/cable_states`, `/joints.effort[:]`,
//! `/force.data[2]`, `/platform.pose.position`, `/tf.transforms[:]{child_frame_id=="platform"}.transform.translation.x`.
//!
//! | part | meaning |
//! |---|---|
//! | `/topic` | the topic; in double quotes if it holds a dot, a bracket, a brace, a quote or a space |
//! | `.name` | a member; in double quotes if it is more than letters, digits and `_` |
//! | `[2]`, `[-1]` | one element, counted from 0, or from the end |
//! | `[:]`, `[1:4]`, `[:3]`, `[-2:]` | several elements; **both** ends belong to the slice |
//! | `{name=="x"}`, `{id!=3}`, `{on==true}` | only where the member has, or has not, the value |
//!
//! This module covers only the notation. Whether a field exists is decided by [`MessageType`](crate::schema::MessageType). Foxglove's variables
//! (`$x`), functions (`.@abs`) and order comparisons are not supported. No numbers of messages are processed here.

mod display;
mod parse;

use std::ops::Range;
use std::str::FromStr;

/// A topic and, optionally, a field inside its messages.
///
/// ```
/// use fric_log::path::MessagePath;
///
/// let path: MessagePath = "/joints.effort[:]".parse()?;
/// assert_eq!(path.topic, "/joints");
/// assert_eq!(path.field.to_string(), "effort[:]");
/// # Ok::<(), fric_log::path::PathError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct MessagePath {
    /// The topic, without quotes.
    pub topic: String,
    /// The path to the field; empty for a bare topic.
    pub field: FieldPath,
}

/// The path from a message to a field inside it; empty for the message itself.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct FieldPath {
    steps: Vec<Step>,
}

/// One step of a [`FieldPath`].
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Step {
    /// Into the member of this name.
    Member(String),
    /// Into these elements of an array.
    Elements(Selection),
    /// Continue only if the condition holds.
    Where(Condition),
}

/// The elements of an array that a path selects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Selection {
    /// One element; negative numbers count from the end, −1 being the last.
    One(i64),
    /// All elements from `first` to `last`, both included; `None` means the array's end.
    Slice {
        /// The first element, negative from the end; `None` is 0.
        first: Option<i64>,
        /// The last element, negative from the end; `None` is −1.
        last: Option<i64>,
    },
}

/// A filter: a comparison of a member with a fixed value.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Condition {
    /// The names leading to the member, starting at the filtered object.
    pub member: Vec<String>,
    /// `true` for `==`, `false` for `!=`.
    pub equal: bool,
    /// The value to compare with.
    pub value: Literal,
}

/// A value in a [`Condition`].
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Literal {
    /// A text in quotes.
    Text(String),
    /// A whole number; `true` and `false` are 1 and 0.
    Integer(i64),
}

/// The error of a message path that cannot be parsed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("message path `{path}`, character {position}: expected {expected}, found {found}")]
pub struct PathError {
    /// The whole path as given.
    pub path: String,
    /// Position of the wrong character, counted from 1.
    pub position: usize,
    /// What is expected there.
    pub expected: &'static str,
    /// What is there instead.
    pub found: String,
}

impl FieldPath {
    /// Returns the steps from the message to the field.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Whether the path denotes the message itself.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Returns this path, continued into a member.
    #[must_use]
    pub fn member(mut self, name: &str) -> Self {
        self.steps.push(Step::Member(name.to_owned()));
        self
    }

    /// Returns this path, continued by another one: `pose` and `position.x` give `pose.position.x`.
    #[must_use]
    pub fn join(mut self, rest: &Self) -> Self {
        self.steps.extend_from_slice(&rest.steps);
        self
    }
}

impl FromIterator<Step> for FieldPath {
    fn from_iter<I: IntoIterator<Item = Step>>(steps: I) -> Self {
        Self { steps: steps.into_iter().collect() }
    }
}

impl FromStr for MessagePath {
    type Err = PathError;

    fn from_str(text: &str) -> Result<Self, PathError> {
        parse::message_path(text)
    }
}

impl FromStr for FieldPath {
    type Err = PathError;

    /// Parses a field path without a topic: `header.stamp`, `effort[:]`, or nothing.
    fn from_str(text: &str) -> Result<Self, PathError> {
        parse::field_path(text)
    }
}

impl Selection {
    /// All elements, `[:]`.
    pub const ALL: Self = Self::Slice { first: None, last: None };

    /// Returns the selected elements of an array of `count`; empty if it has none of them.
    ///
    /// ```
    /// use fric_log::path::Selection;
    ///
    /// assert_eq!(Selection::One(-1).range(3), 2..3);
    /// assert_eq!(Selection::Slice { first: Some(1), last: Some(9) }.range(3), 1..3);
    /// assert!(Selection::One(3).range(3).is_empty());
    /// ```
    #[must_use]
    pub fn range(self, count: usize) -> Range<usize> {
        let from_front = |index: i64| {
            let distance = usize::try_from(index.unsigned_abs()).unwrap_or(usize::MAX);
            if index < 0 { count.checked_sub(distance) } else { Some(distance) }
        };
        match self {
            Self::One(index) => match from_front(index) {
                Some(index) if index < count => index..index + 1,
                _ => 0..0,
            },
            Self::Slice { first, last } => {
                let start = first.map_or(0, |first| from_front(first).unwrap_or(0));
                let end =
                    last.map_or(count, |last| from_front(last).map_or(0, |last| last.saturating_add(1).min(count)));
                if start < end { start..end } else { 0..0 }
            }
        }
    }
}
