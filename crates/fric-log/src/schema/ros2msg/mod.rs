//! Schema texts of encoding `ros2msg`: the definition of a message and, after lines of `=`, of every
//! type it uses.
//!
//! It reads what rosbag2 and common MCAP writers produce: all primitive types, bounded and fixed arrays, bounded strings, constants, default values,
//! comments. Constants and defaults are checked for syntax and dropped, because they are not in the messages. Array and string bounds are not
//! enforced on messages. `.idl` and ROS 1 definitions are not read.

mod definition;
mod line;
mod node;
mod resolve;

pub(super) use node::RosNode;
use resolve::resolve;

use super::error::SchemaError;
use super::types::TypeTable;

/// Reads the schema text of the message type `name`.
pub(super) fn parse(name: &str, text: &str) -> Result<TypeTable, SchemaError> {
    resolve(name, &definition::split(name, text)?)
}

/// Returns `package/Type` for `package/msg/Type`, `package/Type` or, without a package, `Type`.
fn short_name(name: &str) -> String {
    match (name.split_once('/'), name.rsplit_once('/')) {
        (Some((package, _)), Some((_, type_name))) => format!("{package}/{type_name}"),
        _ => name.to_owned(),
    }
}
