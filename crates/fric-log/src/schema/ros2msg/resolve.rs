//! Resolves type names and checks that the whole is finite.

use std::collections::HashMap;

use super::definition::Definition;
use super::line::FieldLine;
use super::short_name;
use crate::schema::error::SchemaError;
use crate::schema::types::{Count, Element, Field, Primitive, TypeTable};

const TIME_TYPES: [&str; 2] = ["builtin_interfaces/Time", "builtin_interfaces/Duration"];

/// Deepest nesting of types; ROS messages stay below ten.
const MAX_DEPTH: usize = 64;

/// Converts definitions, the first of which is the schema's own, to a table of types.
pub(super) fn resolve(schema_name: &str, definitions: &[Definition<'_>]) -> Result<TypeTable, SchemaError> {
    let mut resolver = Resolver {
        schema_name,
        definitions,
        by_name: definitions.iter().enumerate().map(|(index, definition)| (definition.name.as_str(), index)).collect(),
        states: vec![State::Unvisited; definitions.len()],
        types: TypeTable::default(),
    };
    resolver.types.root = resolver.definition(0, 0)?;
    Ok(resolver.types)
}

#[derive(Clone, Copy)]
enum State {
    Unvisited,
    Open,
    /// Index into the table of types.
    Done(usize),
}

struct Resolver<'a> {
    schema_name: &'a str,
    definitions: &'a [Definition<'a>],
    by_name: HashMap<&'a str, usize>,
    states: Vec<State>,
    types: TypeTable,
}

impl<'a> Resolver<'a> {
    /// Resolves the definition with this index and everything in it. Returns its index among the messages.
    fn definition(&mut self, index: usize, depth: usize) -> Result<usize, SchemaError> {
        let definitions: &'a [Definition<'a>] = self.definitions;
        let Some(definition) = definitions.get(index) else {
            return Ok(self.push(String::new(), Vec::new()));
        };
        if depth >= MAX_DEPTH {
            return Err(SchemaError::TooLarge {
                name: self.schema_name.to_owned(),
                limit: MAX_DEPTH,
                what: "levels of nested types",
            });
        }
        self.set_state(index, State::Open);
        let package = definition.name.split_once('/').map(|(package, _)| package);
        let mut fields = Vec::with_capacity(definition.fields.len());
        for (field, line) in &definition.fields {
            let element = match Primitive::named(field.type_name) {
                Some(primitive) => Element::Number(primitive),
                None if field.type_name == "string" => Element::Text,
                None if field.type_name == "wstring" => Element::WideText,
                None => Element::Message(self.message(field, package, *line, depth)?),
            };
            fields.push(Field { name: field.name.to_owned(), element, count: field.count });
        }
        let done = self.push(definition.name.clone(), fields);
        self.set_state(index, State::Done(done));
        Ok(done)
    }

    fn message(
        &mut self,
        field: &FieldLine<'_>,
        package: Option<&str>,
        line: usize,
        depth: usize,
    ) -> Result<usize, SchemaError> {
        let written = field.type_name;
        let full = match package {
            _ if written.contains('/') => short_name(written),
            Some(package) => format!("{package}/{written}"),
            None => written.to_owned(),
        };
        let found = self.by_name.get(full.as_str());
        let found = match found {
            None if written == "Header" => self.by_name.get("std_msgs/Header"),
            found => found,
        };
        let Some(&index) = found else {
            if TIME_TYPES.contains(&full.as_str()) {
                return Ok(self.builtin_time(full));
            }
            return Err(SchemaError::UnknownType {
                name: self.schema_name.to_owned(),
                line,
                type_name: written.to_owned(),
            });
        };
        match self.states.get(index) {
            Some(State::Done(done)) => Ok(*done),
            Some(State::Open) => {
                Err(SchemaError::Recursive { name: self.schema_name.to_owned(), line, type_name: full })
            }
            _ => self.definition(index, depth + 1),
        }
    }

    fn set_state(&mut self, index: usize, state: State) {
        if let Some(slot) = self.states.get_mut(index) {
            *slot = state;
        }
    }

    fn builtin_time(&mut self, name: String) -> usize {
        self.types.position(&name).unwrap_or_else(|| {
            let field = |name: &str, primitive| Field {
                name: name.to_owned(),
                element: Element::Number(primitive),
                count: Count::One,
            };
            let fields = vec![field("sec", Primitive::Int32), field("nanosec", Primitive::Uint32)];
            self.push(name, fields)
        })
    }

    fn push(&mut self, name: String, fields: Vec<Field>) -> usize {
        let time = is_time(&name, &fields);
        self.types.push(name, fields, time)
    }
}

/// Whether a type is a time: it has such a name, and consists of signed seconds and nanoseconds.
fn is_time(name: &str, fields: &[Field]) -> bool {
    let is = |field: &Field, primitive| field.count == Count::One && field.element == Element::Number(primitive);
    TIME_TYPES.contains(&name)
        && match fields {
            [sec, nanosec] => {
                is(sec, Primitive::Int32)
                    && is(nanosec, Primitive::Uint32)
                    && sec.name == "sec"
                    && nanosec.name == "nanosec"
            }
            _ => false,
        }
}
