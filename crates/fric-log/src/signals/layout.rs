//! Which fields of a message a signal is made of.
//!
//! Asked of the schema; where that leaves the fields open (JSON), of the first message.

use crate::path::{FieldPath, Step};
use crate::schema::{FieldKind, MessageType, SchemaError, Wanted};

use super::Role;

/// The fields of a signal, in the order in which a decoder is asked for them.
#[derive(Debug, Default)]
pub(super) struct Layout {
    pub wanted: Vec<Wanted>,
    /// Index of the stamp.
    pub stamp: Option<usize>,
    /// Index of the cables' names.
    pub names: Option<usize>,
    /// Indices of the numbers: force, length, speed of cables; the one array of length, speed and reference; position
    /// and orientation of the pose, force and torque of the wrench, coordinate by coordinate.
    pub numbers: Vec<Option<usize>>,
}

/// A message type and the first message of it.
pub(super) struct Probe<'a> {
    pub message_type: &'a MessageType,
    pub first_message: &'a [u8],
}

impl Probe<'_> {
    /// Whether there is a field to be read as wanted, with several elements or one.
    fn has(&self, wanted: &Wanted, kind: FieldKind) -> bool {
        match self.message_type.field(&wanted.path) {
            Ok(field) if field.kind == FieldKind::Unknown => self
                .message_type
                .decoder(std::slice::from_ref(wanted))
                .is_ok_and(|mut decoder| decoder.read(self.first_message).is_ok()),
            Ok(field) => field.kind == kind,
            Err(_) => false,
        }
    }

    fn has_numbers(&self, path: &FieldPath) -> bool {
        self.has(&Wanted::numbers(path.clone()), FieldKind::Number)
    }

    fn has_texts(&self, path: &FieldPath) -> bool {
        self.has(&Wanted::texts(path.clone()), FieldKind::Text)
    }

    fn has_time(&self, path: &FieldPath) -> bool {
        self.has(&Wanted::times(path.clone()), FieldKind::Time)
    }
}

impl Layout {
    /// The fields of `role` at `path`.
    ///
    /// # Errors
    /// [`SchemaError`] where the messages do not have them.
    pub fn find(role: Role, path: &FieldPath, probe: &Probe<'_>) -> Result<Self, SchemaError> {
        let mut layout = Self::default();
        layout.find_stamp(path, probe);
        match role {
            Role::Cable => layout.cable_numbers(path, probe, &["effort", "position", "velocity"])?,
            Role::Length => layout.cable_numbers(path, probe, &["position"])?,
            Role::Speed => layout.cable_numbers(path, probe, &["velocity"])?,
            Role::Reference => layout.cable_numbers(path, probe, &["effort"])?,
            Role::Pose => layout.vectors(path, probe, POSES)?,
            Role::Wrench => layout.vectors(path, probe, WRENCHES)?,
        }
        Ok(layout)
    }

    fn want(&mut self, wanted: Wanted) -> usize {
        self.wanted.push(wanted);
        self.wanted.len() - 1
    }

    /// `header.stamp` of the message, or of the innermost object on the path that has one.
    fn find_stamp(&mut self, path: &FieldPath, probe: &Probe<'_>) {
        let steps = path.steps();
        let parents = (0..=steps.len()).rev().map(|count| steps.iter().take(count).cloned().collect::<FieldPath>());
        let mut stamps = parents.map(|parent| parent.member("header").member("stamp"));
        self.stamp = stamps.find(|stamp| probe.has_time(stamp)).map(|stamp| self.want(Wanted::times(stamp)));
    }

    /// An object with names and arrays, as `JointState`; or a path to the numbers themselves, the neighbours of which
    /// are looked at too. The first of `members` has to be there.
    fn cable_numbers(&mut self, path: &FieldPath, probe: &Probe<'_>, members: &[&str]) -> Result<(), SchemaError> {
        let steps = path.steps();
        let direct = !path.is_empty() && probe.has_numbers(path);
        let selection = match steps.last() {
            Some(Step::Elements(selection)) if direct => Some(*selection),
            _ => None,
        };
        let inner = usize::from(direct) + usize::from(selection.is_some());
        let parent = steps.get(..steps.len().saturating_sub(inner)).unwrap_or_default();
        let field = |name: &str| -> FieldPath {
            let member = parent.iter().cloned().chain([Step::Member(name.to_owned())]);
            member.chain(selection.map(Step::Elements)).collect()
        };
        let first = if direct { path.clone() } else { field(members.first().copied().unwrap_or_default()) };
        if !direct {
            // Says what is wrong with the path, or which members there are instead.
            probe.message_type.field(&first)?;
        }
        let names = field("name");
        if probe.has_texts(&names) {
            self.names = Some(self.want(Wanted::texts(names)));
        }
        let index = self.want(Wanted::numbers(first.clone()));
        self.numbers.push(Some(index));
        for member in members.iter().skip(1) {
            let field = field(member);
            let found = field != first && probe.has_numbers(&field);
            let index = found.then(|| self.want(Wanted::numbers(field)));
            self.numbers.push(index);
        }
        Ok(())
    }

    /// Two vectors, coordinate by coordinate, under the first of several names that the messages have.
    fn vectors(&mut self, path: &FieldPath, probe: &Probe<'_>, forms: &[Vectors]) -> Result<(), SchemaError> {
        let at = |form: &Vectors| form.prefix.iter().fold(path.clone(), |path, name| path.member(name));
        let form = forms.iter().find(|form| probe.has_numbers(&at(form).member(form.first).member("x")));
        let Some(form) = form.or(forms.first()) else { return Ok(()) };
        for (vector, coordinates) in [(form.first, AXES), (form.second, form.second_coordinates)] {
            for coordinate in coordinates {
                let field = at(form).member(vector).member(coordinate);
                probe.message_type.field(&field)?;
                let index = self.want(Wanted::numbers(field));
                self.numbers.push(Some(index));
            }
        }
        Ok(())
    }
}

/// How a message may name two vectors.
struct Vectors {
    prefix: &'static [&'static str],
    first: &'static str,
    second: &'static str,
    second_coordinates: &'static [&'static str],
}

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
