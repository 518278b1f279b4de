//! Decoding of message payloads.

mod cdr;
mod definitions;
mod encoder;
mod hostile;
mod json;
mod protobuf;
mod random;

use fric_log::schema::{Decoder, MessageType, SchemaError, Values, Wanted};

pub(crate) const JOINT_STATE: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

pub(crate) fn ros(text: &str) -> Result<MessageType, SchemaError> {
    MessageType::new("cdr", "demo/msg/Demo", "ros2msg", text.as_bytes())
}

pub(crate) fn numbers(path: &str) -> Wanted {
    Wanted::numbers(path.parse().unwrap())
}

pub(crate) fn texts(path: &str) -> Wanted {
    Wanted::texts(path.parse().unwrap())
}

pub(crate) fn times(path: &str) -> Wanted {
    Wanted::times(path.parse().unwrap())
}

pub(crate) fn decoder(text: &str, wanted: &[Wanted]) -> Decoder {
    ros(text).unwrap().decoder(wanted).unwrap()
}

pub(crate) fn list(values: &Values, index: usize) -> Vec<&str> {
    values.texts(index).iter().collect()
}
