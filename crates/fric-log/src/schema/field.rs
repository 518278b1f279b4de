//! The target of a field path, determined from the schema alone.

use crate::path::{Condition, FieldPath, Literal, Step};

use super::error::SchemaError;

/// The content of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum FieldKind {
    /// A number, a truth value or an enumeration value.
    Number,
    /// A text.
    Text,
    /// A time stamp or a duration.
    Time,
    /// A message with members of its own.
    Message,
    /// Something that cannot be read as any of these: protobuf `bytes` and maps.
    Other,
    /// Not determined by the schema; only JSON messages have such fields.
    Unknown,
}

/// The type of a field.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldType {
    /// The content of the field, or of each of its elements.
    pub kind: FieldKind,
    /// Whether a message may contain a number of them other than one.
    pub many: bool,
    /// The name of one element in the schema: `float64`, `geometry_msgs/Pose`, `foxglove.Pose`.
    pub type_name: String,
}

/// A wanted field of a message and its wanted kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wanted {
    /// The path to the field.
    pub path: FieldPath,
    /// The wanted kind.
    pub kind: WantedKind,
}

/// The wanted kind of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WantedKind {
    /// As `f64`: any number type, truth values as 0 and 1, enumerations as their numbers.
    Numbers,
    /// As text.
    Texts,
    /// As a time in nanoseconds.
    Times,
}

impl Wanted {
    /// Creates a wanted field of numbers.
    #[must_use]
    pub fn numbers(path: FieldPath) -> Self {
        let kind = WantedKind::Numbers;
        Self { path, kind }
    }

    /// Creates a wanted field of texts.
    #[must_use]
    pub fn texts(path: FieldPath) -> Self {
        let kind = WantedKind::Texts;
        Self { path, kind }
    }

    /// Creates a wanted field of times.
    #[must_use]
    pub fn times(path: FieldPath) -> Self {
        let kind = WantedKind::Times;
        Self { path, kind }
    }
}

impl WantedKind {
    /// Returns the kind of field that can be read this way.
    pub(super) fn field_kind(self) -> FieldKind {
        match self {
            Self::Numbers => FieldKind::Number,
            Self::Texts => FieldKind::Text,
            Self::Times => FieldKind::Time,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Numbers => "a number",
            Self::Texts => "a text",
            Self::Times => "a time",
        }
    }
}

/// A type in any schema language, as seen by [`lookup`].
pub(super) trait TypeNode: Sized {
    fn kind(&self) -> FieldKind;
    fn type_name(&self) -> String;
    fn is_array(&self) -> bool;
    /// Returns the type of one element.
    fn element(self) -> Self;
    /// Returns the type of a member; `None` if there is none of this name.
    fn member(&self, name: &str) -> Option<Self>;
    fn member_names(&self) -> Vec<String>;
}

/// Follows a path through a type.
pub(super) fn lookup<T: TypeNode>(root: T, path: &FieldPath) -> Result<FieldType, SchemaError> {
    let mut node = root;
    let mut many = false;
    let wrong = |node: &T, expected| SchemaError::Path { path: path.to_string(), found: describe(node), expected };
    for step in path.steps() {
        match step {
            Step::Elements(selection) => {
                if !node.is_array() {
                    return Err(wrong(&node, "no index, as it is not an array"));
                }
                many |= matches!(selection, crate::path::Selection::Slice { .. });
                node = node.element();
            }
            Step::Member(_) | Step::Where(_) if node.is_array() => {
                return Err(wrong(&node, "an index or a slice, such as `[0]` or `[:]`"));
            }
            Step::Member(name) => node = member(&node, name, path)?,
            Step::Where(condition) => {
                check_condition(&node, condition, path)?;
                many = true;
            }
        }
    }
    Ok(FieldType { kind: node.kind(), many: many || node.is_array(), type_name: node.type_name() })
}

/// Follows the path of a wanted field and checks that it can be read as wanted.
pub(super) fn check<T: TypeNode>(root: T, wanted: &Wanted) -> Result<(), SchemaError> {
    let found = lookup(root, &wanted.path)?;
    if found.kind == wanted.kind.field_kind() {
        return Ok(());
    }
    Err(SchemaError::Kind { path: wanted.path.to_string(), found: found.type_name, wanted: wanted.kind.name() })
}

fn describe<T: TypeNode>(node: &T) -> String {
    let name = node.type_name();
    if node.is_array() { format!("an array of {name}") } else { name }
}

fn member<T: TypeNode>(node: &T, name: &str, path: &FieldPath) -> Result<T, SchemaError> {
    node.member(name).ok_or_else(|| {
        let names = node.member_names();
        SchemaError::NoMember {
            path: path.to_string(),
            type_name: node.type_name(),
            member: name.to_owned(),
            available: if names.is_empty() { "none".to_owned() } else { names.join(", ") },
        }
    })
}

fn check_condition<T: TypeNode>(node: &T, condition: &Condition, path: &FieldPath) -> Result<(), SchemaError> {
    let mut names = condition.member.iter();
    let mut found = match names.next() {
        Some(name) => member(node, name, path)?,
        None => return Ok(()),
    };
    for name in names {
        if found.is_array() {
            break;
        }
        found = member(&found, name, path)?;
    }
    let (kind, wanted) = match condition.value {
        Literal::Text(_) => (FieldKind::Text, "a single text"),
        Literal::Integer(_) => (FieldKind::Number, "a single number"),
    };
    if found.kind() == kind && !found.is_array() {
        return Ok(());
    }
    Err(SchemaError::Kind { path: format!("{path}` in its filter `{condition}"), found: describe(&found), wanted })
}
