//! Definitions of common robot message types, for bags whose recorder stored none.

/// Each type and the lines of its own definition.
const TYPES: [(&str, &str); 24] = [
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
    ("std_msgs/String", "string data\n"),
    ("std_msgs/Float32", "float32 data\n"),
    ("std_msgs/Float64", "float64 data\n"),
    ("std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride\n"),
    ("std_msgs/MultiArrayLayout", "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n"),
    ("std_msgs/Float32MultiArray", "std_msgs/MultiArrayLayout layout\nfloat32[] data\n"),
    ("std_msgs/Float64MultiArray", "std_msgs/MultiArrayLayout layout\nfloat64[] data\n"),
    (
        "sensor_msgs/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    ),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"),
    ("geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"),
    ("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"),
    ("geometry_msgs/PoseWithCovarianceStamped", "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n"),
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"),
    (
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    ),
    ("tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"),
    ("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"),
    ("geometry_msgs/TwistStamped", "std_msgs/Header header\ngeometry_msgs/Twist twist\n"),
    ("geometry_msgs/Wrench", "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n"),
    ("geometry_msgs/WrenchStamped", "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n"),
];

/// Returns the `ros2msg` text of a type such as `sensor_msgs/msg/JointState`, including the types that it uses; `None` for an unknown type.
pub(super) fn of_type(name: &str) -> Option<String> {
    let name = name.replacen("/msg/", "/", 1);
    let own = |name: &str| TYPES.iter().find(|(of, _)| *of == name).map(|(_, lines)| *lines);
    let mut text = own(&name)?.to_owned();
    let (mut used, mut next) = (vec![name], 0);
    while let Some(lines) = used.get(next).and_then(|name| own(name)) {
        for field in lines.lines() {
            let of = field.split([' ', '[']).next().unwrap_or_default().to_owned();
            if own(&of).is_some() && !used.contains(&of) {
                used.push(of);
            }
        }
        next += 1;
    }
    for name in used.iter().skip(1) {
        text.extend([&"=".repeat(80), "\nMSG: ", name, "\n", own(name).unwrap_or_default()]);
    }
    Some(text)
}
