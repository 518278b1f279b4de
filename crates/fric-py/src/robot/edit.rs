//! Access to values of a robot by their position in the robot file.

use fric_core::robot::file::{RobotFile, RobotFileError};
use toml::Value;

use crate::errors::{Fault, Outcome};

/// One step from the root of the robot file to a table.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    Key(&'static str),
    Index(usize),
}

/// Returns the value of a key in the table at a position; `None` if the file omits it.
pub fn get(file: &RobotFile, place: &[Step], key: &str) -> Outcome<Option<Value>> {
    let mut root = tree(file)?;
    Ok(table_at(&mut root, place).and_then(|table| table.remove(key)))
}

/// Returns the table at a position; `None` if the file omits it.
pub fn table(file: &RobotFile, place: &[Step]) -> Outcome<Option<Value>> {
    let mut root = tree(file)?;
    Ok(table_at(&mut root, place).map(|table| Value::Table(std::mem::take(table))))
}

/// Returns a robot with other values for keys of the table at a position, `None` to omit a key; checked like a file.
pub fn with(file: &RobotFile, place: &[Step], values: Vec<(String, Option<Value>)>) -> Outcome<RobotFile> {
    let mut root = tree(file)?;
    if let Some(table) = table_at(&mut root, place) {
        for (key, value) in values {
            match value {
                Some(value) => drop(table.insert(key, value)),
                None => drop(table.remove(&key)),
            }
        }
    }
    let text = toml::to_string(&root).map_err(unwritable)?;
    RobotFile::parse(&text, "robot").map_err(|error| match error {
        // Errors in values name the cable themselves, errors in keys and types do not.
        RobotFileError::Invalid { problem, cable: Some(_), .. } => Fault::config(problem),
        RobotFileError::Invalid { problem, .. } => Fault::config(cable_of(file, place) + &problem),
        error => error.into(),
    })
}

/// Returns the cable of the table at a position, for errors: `cable "x": `, or nothing.
pub fn cable_of(file: &RobotFile, place: &[Step]) -> String {
    let [Step::Key("cable"), Step::Index(index), ..] = place else { return String::new() };
    format!("cable \"{}\": ", file.cable_names().get(*index).copied().unwrap_or_default())
}

fn tree(file: &RobotFile) -> Outcome<Value> {
    Value::try_from(file.options()).map_err(unwritable)
}

#[expect(clippy::needless_pass_by_value, reason = "as `map_err` passes it")]
fn unwritable(error: toml::ser::Error) -> Fault {
    Fault::config(format!("the robot cannot be written as TOML: {error}"))
}

fn table_at<'a>(root: &'a mut Value, place: &[Step]) -> Option<&'a mut toml::Table> {
    let mut value = root;
    for step in place {
        value = match step {
            Step::Key(key) => value.get_mut(*key)?,
            Step::Index(index) => value.get_mut(*index)?,
        };
    }
    value.as_table_mut()
}
