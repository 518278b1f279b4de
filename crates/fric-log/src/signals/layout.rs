//! Determines the fields of a message that form a signal.
//!
//! The schema determines them; if it leaves them open (JSON), a message does.

use crate::path::{FieldPath, Step};
use crate::schema::{DecodeError, FieldKind, MessageType, SchemaError, Wanted};

use super::Role;

/// The fields of a signal, in the order for the decoder.
#[derive(Debug, Default)]
pub(super) struct Layout {
    pub wanted: Vec<Wanted>,
    /// Indices of the stamps, the innermost first.
    pub stamps: Vec<usize>,
    /// Index of the cables' names.
    pub names: Option<usize>,
    /// Indices of the numbers: force, length, speed of cables; the single array of length, speed and reference; position and orientation of the pose,
    /// force and torque of the wrench, coordinate by coordinate.
    pub numbers: Vec<Option<usize>>,
}

/// The reason why there is no layout.
#[derive(Debug)]
pub(super) enum Unfit {
    /// No message of this type has the fields.
    Type(SchemaError),
    /// Only cable lengths are missing.
    NoLength,
    /// This message lacks them, but the next one may have them.
    Message(String),
    /// The path selects nothing in this message, but may in the next one.
    Nothing,
}

impl From<SchemaError> for Unfit {
    fn from(error: SchemaError) -> Self {
        Self::Type(error)
    }
}

/// A message type and a message of it.
pub(crate) struct Probe<'a> {
    pub message_type: &'a MessageType,
    pub message: &'a [u8],
}

impl Probe<'_> {
    /// Whether there is a field of the wanted kind, with several elements or one.
    pub(crate) fn has(&self, wanted: Wanted, kind: FieldKind) -> bool {
        match self.message_type.field(&wanted.path) {
            Ok(field) if field.kind == FieldKind::Unknown => {
                let decoder = self.message_type.decoder(&[wanted]);
                decoder.is_ok_and(|mut decoder| decoder.read(self.message).is_ok())
            }
            Ok(field) => field.kind == kind,
            Err(_) => false,
        }
    }

    fn has_numbers(&self, path: FieldPath) -> bool {
        self.has(Wanted::numbers(path), FieldKind::Number)
    }

    /// Checks that there are numbers; if only messages can tell, that this one has them.
    fn require_numbers(&self, path: &FieldPath) -> Result<(), Unfit> {
        if self.message_type.field(path)?.kind != FieldKind::Unknown {
            return Ok(());
        }
        let mut decoder = self.message_type.decoder(&[Wanted::numbers(path.clone())])?;
        let values = decoder.read(self.message).map_err(|error: DecodeError| Unfit::Message(error.to_string()))?;
        let is_filtered = path.steps().iter().any(|step| !matches!(step, Step::Member(_)));
        if is_filtered && values.numbers(0).is_empty() { Err(Unfit::Nothing) } else { Ok(()) }
    }
}

impl Layout {
    /// Finds the fields of `role` at `path`.
    ///
    /// # Errors
    /// Returns an [`Unfit`] if the messages, or this one, do not contain them.
    pub fn find(role: Role, path: &FieldPath, probe: &Probe<'_>) -> Result<Self, Unfit> {
        let mut layout = Self::default();
        match role {
            Role::Cable => layout.cable_numbers(path, probe, &["effort", "position", "velocity"])?,
            Role::Length => layout.cable_numbers(path, probe, &["position"])?,
            Role::Speed => layout.cable_numbers(path, probe, &["velocity"])?,
            Role::Reference => layout.cable_numbers(path, probe, &["effort"])?,
            Role::Pose => layout.vectors(path, probe, POSES)?,
            Role::Wrench => layout.vectors(path, probe, WRENCHES)?,
        }
        layout.find_stamps(path, probe);
        Ok(layout)
    }

    fn want(&mut self, wanted: Wanted) -> usize {
        self.wanted.push(wanted);
        self.wanted.len() - 1
    }

    /// Finds the stamps of the objects on the path, from the innermost to the message itself.
    fn find_stamps(&mut self, path: &FieldPath, probe: &Probe<'_>) {
        let steps = path.steps();
        for count in (0..=steps.len()).rev() {
            let parent: FieldPath = steps.iter().take(count).cloned().collect();
            let mut stamps = STAMPS.iter().map(|names| members(&parent, names));
            if let Some(stamp) = stamps.find(|stamp| probe.has(Wanted::times(stamp.clone()), FieldKind::Time)) {
                let index = self.want(Wanted::times(stamp));
                self.stamps.push(index);
            }
        }
    }

    /// Finds the numbers in an object with names and arrays, such as `JointState`, or at a path to the numbers themselves, whose neighbours are
    /// searched too. The first of `members` must exist.
    fn cable_numbers(&mut self, path: &FieldPath, probe: &Probe<'_>, members: &[&str]) -> Result<(), Unfit> {
        let steps = path.steps();
        let is_direct = !path.is_empty() && probe.has_numbers(path.clone());
        let selection = match steps.last() {
            Some(Step::Elements(selection)) if is_direct => Some(*selection),
            _ => None,
        };
        let inner = usize::from(is_direct) + usize::from(selection.is_some());
        let parent = steps.get(..steps.len().saturating_sub(inner)).unwrap_or_default();
        let field = |name: &str| -> FieldPath {
            let member = parent.iter().cloned().chain([Step::Member(name.to_owned())]);
            member.chain(selection.map(Step::Elements)).collect()
        };
        let first = if is_direct { path.clone() } else { field(members.first().copied().unwrap_or_default()) };
        // Reports what is wrong with the path, or which members exist instead.
        probe.require_numbers(&first)?;
        let names = field("name");
        if probe.has(Wanted::texts(names.clone()), FieldKind::Text) {
            self.names = Some(self.want(Wanted::texts(names)));
        }
        let index = self.want(Wanted::numbers(first.clone()));
        self.numbers.push(Some(index));
        for member in members.iter().skip(1) {
            let field = field(member);
            let found = field != first && probe.has_numbers(field.clone());
            let index = found.then(|| self.want(Wanted::numbers(field)));
            self.numbers.push(index);
        }
        Ok(())
    }

    /// Finds two vectors, coordinate by coordinate, under the first of several names that the messages have.
    fn vectors(&mut self, path: &FieldPath, probe: &Probe<'_>, forms: &[Vectors]) -> Result<(), Unfit> {
        let first = |form: &Vectors| members(path, form.prefix).member(form.first).member("x");
        let form = forms.iter().find(|form| probe.require_numbers(&first(form)).is_ok());
        let Some(form) = form.or(forms.first()) else { return Ok(()) };
        for (vector, coordinates) in [(form.first, AXES), (form.second, form.second_coordinates)] {
            for coordinate in coordinates {
                let field = members(path, form.prefix).member(vector).member(coordinate);
                probe.require_numbers(&field)?;
                let index = self.want(Wanted::numbers(field));
                self.numbers.push(Some(index));
            }
        }
        Ok(())
    }
}

fn members(path: &FieldPath, names: &[&str]) -> FieldPath {
    names.iter().fold(path.clone(), |path, name| path.member(name))
}

/// Possible names of two vectors in a message.
struct Vectors {
    prefix: &'static [&'static str],
    first: &'static str,
    second: &'static str,
    second_coordinates: &'static [&'static str],
}

/// Possible locations of an object's stamp.
pub(crate) const STAMPS: [&[&str]; 3] = [&["header", "stamp"], &["stamp"], &["timestamp"]];

const QUATERNION: &[&str] = &["x", "y", "z", "w"];
const AXES: &[&str] = &["x", "y", "z"];

const POSES: &[Vectors] = &[
    Vectors { prefix: &["pose"], first: "position", second: "orientation", second_coordinates: QUATERNION },
    Vectors { prefix: &[], first: "position", second: "orientation", second_coordinates: QUATERNION },
    Vectors { prefix: &["pose", "pose"], first: "position", second: "orientation", second_coordinates: QUATERNION },
    Vectors { prefix: &["transform"], first: "translation", second: "rotation", second_coordinates: QUATERNION },
    Vectors { prefix: &[], first: "translation", second: "rotation", second_coordinates: QUATERNION },
];

const WRENCHES: &[Vectors] = &[
    Vectors { prefix: &["wrench"], first: "force", second: "torque", second_coordinates: AXES },
    Vectors { prefix: &[], first: "force", second: "torque", second_coordinates: AXES },
];
