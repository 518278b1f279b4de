//! The `ros2msg` definitions of the messages written.

use std::fmt::Write as _;

use super::error::WriteError;

pub(super) const JOINT_STATE: &str = "sensor_msgs/msg/JointState";
pub(super) const POSE: &str = "geometry_msgs/msg/PoseStamped";
pub(super) const WRENCH: &str = "geometry_msgs/msg/WrenchStamped";
pub(super) const CABLE_STATUS: &str = "fric_msgs/msg/CableStatus";

const HEADER: &[&str] = &[
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n",
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n",
];

pub(super) fn joint_state() -> String {
    let fields = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n";
    join(fields, &[])
}

pub(super) fn pose() -> String {
    join(
        "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
        &[
            "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
            "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n",
            "MSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
        ],
    )
}

pub(super) fn wrench() -> String {
    join(
        "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n",
        &[
            "MSG: geometry_msgs/Wrench\ngeometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n",
            "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n",
        ],
    )
}

/// Returns the definition of the status message, with the flags' names and bits as constants in upper case.
pub(super) fn cable_status(bits: &[(&str, u32)]) -> Result<String, WriteError> {
    let mut fields = String::from("# Per cable, in the order of name: the sum of the bits that are set\n");
    for (name, bit) in bits {
        let is_constant = name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !is_constant {
            return Err(WriteError::FlagName { name: (*name).to_owned() });
        }
        // Writing to a String cannot fail.
        let _ = writeln!(fields, "uint32 {}={bit}", name.to_ascii_uppercase());
    }
    fields.push_str("std_msgs/Header header\nstring[] name\nuint32[] flags\n");
    Ok(join(&fields, &[]))
}

/// Returns the definition of a message of numbers, one field each.
pub(super) fn numbers(fields: &[String]) -> Result<String, WriteError> {
    let mut text = String::from("std_msgs/Header header\n");
    for name in fields {
        let is_field = name.starts_with(|c: char| c.is_ascii_lowercase())
            && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        if !is_field {
            return Err(WriteError::FieldName { name: name.clone() });
        }
        // Writing to a String cannot fail.
        let _ = writeln!(text, "float64 {name}");
    }
    Ok(join(&text, &[]))
}

fn join(fields: &str, parts: &[&str]) -> String {
    let separator = format!("{}\n", "=".repeat(80));
    let mut text = fields.to_owned();
    for part in parts.iter().chain(HEADER) {
        text.push_str(&separator);
        text.push_str(part);
    }
    text
}
