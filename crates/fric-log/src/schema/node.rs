//! Reads wanted fields from messages that are decoded as a whole: JSON and protobuf.

use std::borrow::Cow;

use crate::path::{Condition, Literal, Step};

use super::error::DecodeError;
use super::field::{Wanted, WantedKind};
use super::time::OutOfRange;
use super::values::Slot;

/// A decoded value.
pub(super) trait Node: Clone {
    /// Returns a member; `None` if the value has none of this name.
    fn member(&self, name: &str) -> Option<Cow<'_, Self>>;
    /// Returns the elements, if the value is an array.
    fn elements(&self) -> Option<&[Self]>;
    fn number(&self) -> Option<f64>;
    fn text(&self) -> Option<&str>;
    /// Returns the time in nanoseconds.
    fn time_nanos(&self) -> Option<Result<i64, OutOfRange>>;
    /// Returns a description of the value for errors: `a text`, `an array`.
    fn describe(&self) -> &'static str;
}

/// Reads one wanted field.
pub(super) fn read<N: Node>(root: &N, wanted: &Wanted, slot: &mut Slot) -> Result<(), DecodeError> {
    follow(root, wanted.path.steps(), wanted, slot)
}

fn follow<N: Node>(node: &N, steps: &[Step], wanted: &Wanted, slot: &mut Slot) -> Result<(), DecodeError> {
    let Some((step, rest)) = steps.split_first() else {
        return match node.elements() {
            Some(elements) => elements.iter().try_for_each(|node| leaf(node, wanted, slot)),
            None => leaf(node, wanted, slot),
        };
    };
    match step {
        Step::Member(name) => follow(member(node, name, wanted)?.as_ref(), rest, wanted, slot),
        Step::Elements(selection) => {
            let elements = node.elements().ok_or_else(|| wrong_kind(node, wanted, "an array"))?;
            let chosen = elements.get(selection.range(elements.len())).unwrap_or_default();
            chosen.iter().try_for_each(|node| follow(node, rest, wanted, slot))
        }
        Step::Where(condition) => {
            if holds(node, condition, wanted)? {
                follow(node, rest, wanted, slot)
            } else {
                Ok(())
            }
        }
    }
}

fn member<'a, N: Node>(node: &'a N, name: &str, wanted: &Wanted) -> Result<Cow<'a, N>, DecodeError> {
    node.member(name).ok_or_else(|| DecodeError::Missing {
        field: wanted.path.to_string(),
        place: node.describe(),
        member: name.to_owned(),
    })
}

/// Whether the condition holds; a value of another kind than the literal is unequal.
fn holds<N: Node>(node: &N, condition: &Condition, wanted: &Wanted) -> Result<bool, DecodeError> {
    let mut found = Cow::Borrowed(node);
    for name in &condition.member {
        found = Cow::Owned(member(found.as_ref(), name, wanted)?.into_owned());
    }
    let equal = match &condition.value {
        Literal::Text(text) => found.text() == Some(text),
        #[expect(clippy::cast_precision_loss, reason = "all numbers are compared as f64")]
        Literal::Integer(value) => found.number() == Some(*value as f64),
    };
    Ok(equal == condition.equal)
}

fn leaf<N: Node>(node: &N, wanted: &Wanted, slot: &mut Slot) -> Result<(), DecodeError> {
    let wrong = || wrong_kind(node, wanted, wanted.kind.name());
    match wanted.kind {
        WantedKind::Numbers => slot.numbers.push(node.number().ok_or_else(wrong)?),
        WantedKind::Texts => slot.texts.push(node.text().ok_or_else(wrong)?),
        WantedKind::Times => {
            let time_nanos = node.time_nanos().ok_or_else(wrong)?;
            let time_nanos =
                time_nanos.map_err(|OutOfRange| DecodeError::TimeRange { field: wanted.path.to_string() })?;
            slot.times_nanos.push(time_nanos);
        }
    }
    Ok(())
}

fn wrong_kind<N: Node>(node: &N, wanted: &Wanted, kind: &'static str) -> DecodeError {
    DecodeError::Kind { field: wanted.path.to_string(), found: node.describe(), wanted: kind }
}
