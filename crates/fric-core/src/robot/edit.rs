//! Writes new parameters into a robot file without changing comments, order and layout.
//!
//! [`rewrite`] takes the text and, per cable, friction values and effects, and returns the text in which exactly these have changed. Values are
//! replaced in place. New entries are added beside similar ones: in braces, on a line of their own, or under a header of their own, as the file does
//! it. Needs the feature `robot-file`; not for the cycle.

use std::borrow::ToOwned;
use std::format;
use std::string::String;
use std::vec::Vec;

use toml_edit::{Array, ArrayOfTables, Document, Item, Table, Value};

use super::file::{RobotFile, RobotFileError};
use super::locate::unknown_name;
use crate::effects::Effect;
use crate::toml_editor::{Body, Entry, Numbers, Splice, entry, refusal, replaced, splice};

/// Changes of one cable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CableEdit<'a> {
    /// Name of the cable in the file.
    pub name: &'a str,
    /// Friction values.
    pub friction: FrictionEdit,
    /// Entry point into the last pulley, m; `None` keeps it.
    pub base_m: Option<[f64; 3]>,
    /// Attachment to the platform, m; `None` keeps it.
    pub platform_m: Option<[f64; 3]>,
    /// Effects in sequence.
    pub effects: &'a [EffectEdit<'a>],
}

/// New friction values; `None` keeps a value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionEdit {
    /// Bearing friction μ, 1.
    pub mu: Option<f64>,
    /// Presliding stiffness of the whole cable, N/m.
    pub sigma_n_per_m: Option<f64>,
    /// Viscous friction of each pulley, N s/m.
    pub viscous_n_s_per_m: Option<f64>,
    /// Offset at the platform, N.
    pub offset_n: Option<f64>,
}

/// A change of one effect of a cable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EffectEdit<'a> {
    /// Sets parameters by key, in the units of the effect's catalogue row; the effect is appended if the cable does not have it.
    Set {
        /// The effect; the second of its kind needs the first before it.
        effect: Effect,
        /// Parameters; other parameters of an existing effect are kept.
        parameters: &'a [(&'a str, f64)],
    },
    /// Removes the effect, including a comment on its line; the effect must exist.
    Remove {
        /// The effect; a second of its kind then becomes the first.
        effect: Effect,
    },
}

impl FrictionEdit {
    /// Returns the given values by key, in the order of the file format.
    fn values(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let Self { mu, sigma_n_per_m, viscous_n_s_per_m, offset_n } = *self;
        let all = [
            ("mu", mu),
            ("sigma_n_per_m", sigma_n_per_m),
            ("viscous_n_s_per_m", viscous_n_s_per_m),
            ("offset_n", offset_n),
        ];
        all.into_iter().filter_map(|(key, value)| Some((key, value?)))
    }
}

/// Returns the text of a robot file with new parameters; `origin` names its source in error messages.
///
/// Numbers read back to the same bits. Everything else stays unchanged to the byte, including a value that is set to itself.
///
/// ```
/// use fric_core::effects::Effect;
/// use fric_core::robot::edit::{CableEdit, EffectEdit, FrictionEdit, rewrite};
/// # fn main() -> Result<(), fric_core::robot::file::RobotFileError> {
/// let text = r#"
/// format = "fric-robot/1"
/// name = "bench"
/// cycle_s = 0.001
///
/// [[cable]]
/// name = "winch"   # the left one
/// pulleys = [{ wrap_deg = 180.0, sensor = true }]
/// friction = { mu = 0.019, viscous_n_s_per_m = 0.5 }
/// "#;
/// let effects = [EffectEdit::Set { effect: Effect::Stribeck, parameters: &[("ratio", 0.5)] }];
/// let friction = FrictionEdit { mu: Some(0.0161), ..FrictionEdit::default() };
/// let fitted = rewrite(text, "robot.toml", &[CableEdit { name: "winch", friction, effects: &effects, ..CableEdit::default() }])?;
/// assert!(fitted.contains("# the left one"));
/// assert!(fitted.contains("friction = { mu = 0.0161, viscous_n_s_per_m = 0.5 }\n"));
/// assert!(fitted.ends_with("effects = [ { kind = \"stribeck\", ratio = 0.5 } ]\n"));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Returns [`RobotFileError::Invalid`] if the text is invalid before or with the new values, or has no such cable or effect.
pub fn rewrite(text: &str, origin: &str, edits: &[CableEdit<'_>]) -> Result<String, RobotFileError> {
    RobotFile::parse(text, origin)?;
    let mut draft = Draft { text: text.to_owned(), origin };
    for edit in edits {
        draft.edit(edit)?;
    }
    RobotFile::parse(&draft.text, &format!("{origin} with the new values"))?;
    Ok(draft.text)
}

/// Changes of the platform; `None` keeps a value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlatformEdit {
    /// Mass, kg.
    pub mass_kg: Option<f64>,
    /// Centre of mass, platform frame, m.
    pub center_of_mass_m: Option<[f64; 3]>,
    /// Inertia tensor about the centre of mass, platform axes, kg m²: xx, xy, xz, yy, yz, zz.
    pub inertia_kg_m2: Option<[f64; 6]>,
    /// Gravity, base frame, m/s².
    pub gravity_m_per_s2: Option<[f64; 3]>,
}

/// Returns the text of a robot file with other values of its platform table, which must exist. `origin` names the source of the text in error
/// messages.
///
/// # Errors
/// Returns [`RobotFileError::Invalid`] if the text is invalid before or with the new numbers, or has no table `platform`.
pub fn set_platform(text: &str, origin: &str, edit: &PlatformEdit) -> Result<String, RobotFileError> {
    RobotFile::parse(text, origin)?;
    let values = [
        ("mass_kg", edit.mass_kg.as_ref().map(|mass_kg| Numbers::One(*mass_kg))),
        ("center_of_mass_m", edit.center_of_mass_m.as_ref().map(|center_m| Numbers::List(center_m))),
        ("inertia_kg_m2", edit.inertia_kg_m2.as_ref().map(|inertia| Numbers::List(inertia))),
        ("gravity_m_per_s2", edit.gravity_m_per_s2.as_ref().map(|gravity| Numbers::List(gravity))),
    ];
    let mut text = text.to_owned();
    for (key, value) in values.into_iter().filter_map(|(key, value)| Some((key, value?))) {
        let splices = Document::parse(text.as_str())
            .ok()
            .and_then(|document| Body::of_item(document.get("platform")?)?.set(&text, "platform", key, value));
        let problem =
            || "`platform` is missing, or written in a way that cannot be added to; write it in one table".to_owned();
        let splices = splices.ok_or_else(|| invalid(origin, problem()))?;
        splice::apply(&mut text, splices);
    }
    RobotFile::parse(&text, &format!("{origin} with the new values"))?;
    Ok(text)
}

/// Returns the text of a robot file with a value of its monitor, by key: in its table, or under `cycle_s` if there is none. `origin` names the source
/// of the text in error messages.
///
/// # Errors
/// Returns [`RobotFileError::Invalid`] if the text is invalid before or with the new number.
pub fn set_monitor(text: &str, origin: &str, key: &str, value: f64) -> Result<String, RobotFileError> {
    RobotFile::parse(text, origin)?;
    let value = Numbers::One(value);
    let splices = Document::parse(text).ok().and_then(|document| {
        if let Some(item) = document.get("monitor") {
            return Body::of_item(item)?.set(text, "monitor", key, value);
        }
        let (name, item) = document.get_key_value("cycle_s")?;
        let place = Entry { start: name.span()?.start, end: item.as_value()?.span()?.end };
        Some(splice::below(text, &place, &format!("monitor.{}", entry(key, value))))
    });
    let splices = splices.ok_or_else(|| invalid(origin, refusal("monitor")))?;
    let mut text = text.to_owned();
    splice::apply(&mut text, splices);
    RobotFile::parse(&text, &format!("{origin} with the new values"))?;
    Ok(text)
}

fn invalid(origin: &str, problem: String) -> RobotFileError {
    RobotFileError::Invalid { origin: origin.to_owned(), line: None, cable: None, problem }
}

/// A text under construction. It is parsed again after each change, so that each change sees the current positions.
struct Draft<'a> {
    text: String,
    origin: &'a str,
}

impl Draft<'_> {
    fn edit(&mut self, edit: &CableEdit<'_>) -> Result<(), RobotFileError> {
        let CableEdit { name, friction, base_m, platform_m, effects } = *edit;
        for (key, point_m) in [("base_m", base_m), ("platform_m", platform_m)] {
            if let Some(point_m) = point_m {
                self.change(name, |cable, _| cable.set_point(key, point_m))?;
            }
        }
        for value in friction.values() {
            self.change(name, |cable, text| cable.set_friction(text, value))?;
        }
        for effect in effects {
            match *effect {
                EffectEdit::Set { effect, parameters } => {
                    self.change(name, |cable, text| cable.add_effect(text, effect, parameters))?;
                    for value in parameters {
                        self.change(name, |cable, text| cable.set_effect(text, effect, *value))?;
                    }
                }
                EffectEdit::Remove { effect } => self.change(name, |cable, text| cable.remove_effect(text, effect))?,
            }
        }
        Ok(())
    }

    /// Applies one change to a cable. The `Err` of the change function is the problem in words.
    fn change(
        &mut self,
        name: &str,
        plan: impl FnOnce(&Cable<'_>, &str) -> Result<Vec<Splice>, String>,
    ) -> Result<(), RobotFileError> {
        let planned = Document::parse(self.text.as_str())
            .map_err(|error| error.message().to_owned())
            .and_then(|document| plan(&Cable::find(&document, name)?, &self.text));
        let splices = planned.map_err(|problem| invalid(self.origin, problem))?;
        splice::apply(&mut self.text, splices);
        Ok(())
    }
}

/// A cable's table and its position.
struct Cable<'a> {
    name: &'a str,
    body: Body<'a>,
}

/// `effects` as written.
enum Effects<'a> {
    Missing,
    List(&'a Array),
    Tables(&'a ArrayOfTables),
}

impl<'a> Cable<'a> {
    fn find(document: &'a Table, name: &'a str) -> Result<Self, String> {
        let bodies: Vec<Body<'a>> = match document.get("cable") {
            Some(Item::ArrayOfTables(tables)) => tables.iter().map(Body::Lines).collect(),
            Some(Item::Value(Value::Array(list))) => {
                list.iter().filter_map(Value::as_inline_table).map(Body::Braces).collect()
            }
            _ => Vec::new(),
        };
        let name_of = |body: Body<'a>| body.table().get("name").and_then(Item::as_str);
        let found = bodies.iter().find(|body| name_of(**body) == Some(name));
        let known = || bodies.iter().filter_map(|body| name_of(*body));
        let body = *found.ok_or_else(|| unknown_name("cable", name, known()))?;
        Ok(Self { name, body })
    }

    /// Returns the message for a value that cannot be extended.
    fn refuse(&self, key: &str) -> String {
        format!("`{key}` of cable \"{}\" is written in a way that cannot be added to; write it in one table", self.name)
    }

    /// Inserts an entry after the first of these keys that is a line or list of the cable.
    fn append(&self, text: &str, behind: &[&str], entry: &str) -> Option<Vec<Splice>> {
        match self.body {
            Body::Braces(_) => self.body.append(text, "", entry),
            Body::Lines(table) => {
                let place = behind.iter().find_map(|key| {
                    let (key, item) = table.get_key_value(key)?;
                    Some(Entry { start: key.span()?.start, end: item.as_value()?.span()?.end })
                })?;
                Some(splice::below(text, &place, entry))
            }
        }
    }

    fn set_friction(&self, text: &str, (key, value): (&str, f64)) -> Result<Vec<Splice>, String> {
        let splices = match self.body.table().get("friction") {
            None => self.append(
                text,
                &["pulleys", "name"],
                &format!("friction = {{ {} }}", entry(key, Numbers::One(value))),
            ),
            Some(item) => Body::of_item(item).and_then(|body| body.set(text, "friction", key, Numbers::One(value))),
        };
        splices.ok_or_else(|| self.refuse("friction"))
    }

    /// Replaces a point of the geometry, which must exist.
    fn set_point(&self, key: &str, point_m: [f64; 3]) -> Result<Vec<Splice>, String> {
        let item = self.body.table().get(key);
        item.and_then(|item| replaced(item, Numbers::List(&point_m)))
            .ok_or_else(|| format!("cable \"{}\" has no `{key}` to be corrected", self.name))
    }

    fn effects(&self) -> Result<Effects<'a>, String> {
        match self.body.table().get("effects") {
            None => Ok(Effects::Missing),
            Some(Item::Value(Value::Array(array))) => Ok(Effects::List(array)),
            Some(Item::ArrayOfTables(tables)) => Ok(Effects::Tables(tables)),
            Some(_) => Err(self.refuse("effects")),
        }
    }

    /// Appends a new effect with its parameters.
    fn add_effect(&self, text: &str, effect: Effect, parameters: &[(&str, f64)]) -> Result<Vec<Splice>, String> {
        let effects = self.effects()?;
        if effects.find(effect).is_some() {
            return Ok(Vec::new());
        }
        if effect.first().is_some_and(|first| effects.find(first).is_none()) {
            return Err(format!(
                "cable \"{}\" has no effect `{}` for a second one to follow",
                self.name,
                effect.kind()
            ));
        }
        let mut entries = Vec::from([format!("kind = \"{}\"", effect.kind())]);
        entries.extend(parameters.iter().map(|(key, value)| entry(key, Numbers::One(*value))));
        let braces = || format!("{{ {} }}", entries.join(", "));
        let splices = match effects {
            Effects::Missing => {
                self.append(text, &["friction", "pulleys", "name"], &format!("effects = [ {} ]", braces()))
            }
            Effects::List(array) => {
                let last = array.iter().last().and_then(Value::span).map(Entry::from);
                array.span().map(|array| splice::in_list(text, &array, last.as_ref(), &braces()))
            }
            Effects::Tables(tables) => tables.iter().last().and_then(|last| {
                let header = last.span()?;
                let end = splice::last_entry(last)?;
                Some(splice::table_below(text, &header, &end, &entries))
            }),
        };
        splices.ok_or_else(|| self.refuse("effects"))
    }

    fn set_effect(&self, text: &str, effect: Effect, (key, value): (&str, f64)) -> Result<Vec<Splice>, String> {
        let found = self.effects()?.find(effect);
        found.and_then(|(_, body)| body.set(text, "", key, Numbers::One(value))).ok_or_else(|| self.refuse("effects"))
    }

    fn remove_effect(&self, text: &str, effect: Effect) -> Result<Vec<Splice>, String> {
        let effects = self.effects()?;
        let Some((index, body)) = effects.find(effect) else {
            return Err(format!("cable \"{}\" has no effect `{effect}` to be removed", self.name));
        };
        let splices = match (effects, body) {
            (Effects::List(array), _) => {
                let places: Vec<Entry> = array.iter().filter_map(Value::span).map(Entry::from).collect();
                array.span().and_then(|array| splice::out_of_list(text, &array, &places, index))
            }
            (_, Body::Lines(table)) => {
                table.span().map(|header| splice::without_lines(text, &header, splice::last_entry(table)))
            }
            _ => None,
        };
        splices.ok_or_else(|| self.refuse("effects"))
    }
}

impl<'a> Effects<'a> {
    /// Returns index and table of an effect.
    fn find(&self, effect: Effect) -> Option<(usize, Body<'a>)> {
        let bodies: Vec<Body<'a>> = match *self {
            Self::Missing => Vec::new(),
            Self::List(list) => list.iter().filter_map(Value::as_inline_table).map(Body::Braces).collect(),
            Self::Tables(tables) => tables.iter().map(Body::Lines).collect(),
        };
        let is_of_kind = |body: &Body<'a>| body.table().get("kind").and_then(Item::as_str) == Some(effect.kind());
        let mut of_kind = bodies.into_iter().enumerate().filter(|(_, body)| is_of_kind(body));
        of_kind.nth(usize::from(effect.is_second()))
    }
}
