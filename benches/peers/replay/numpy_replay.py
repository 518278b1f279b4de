"""Replay with Python's `mcap` and NumPy, as one writes it without fric: all messages into arrays, forces, and the same four topics out.

Geometry and wrench are computed for all samples at once, the recursion over time for all cables at once. The model is
`per_pulley` with a sensor pulley of 180° first and a swivelling pulley last; no status is found out.

Usage: numpy_replay.py LOG.mcap ROBOT.toml OUT.mcap OURS.mcap    OURS is what `fric-cli replay -o` wrote of LOG

Prints `messages`, `seconds` and `processor_seconds` of reading, computing and writing, then how far the outputs are from OURS where
that has no flag, and exits 1 beyond 1e-9.
"""

import sys
import time
import tomllib

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.reader import read_ros2_messages
from mcap_ros2.writer import Writer

CABLE, POSE = "/cable_states", "/platform_pose"
FORCES, FRICTION, WRENCH, STATUS = "/fric/cable_forces", "/fric/friction", "/fric/wrench", "/fric/status"
TOLERANCE = 1e-9


def stamp_of(message):
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


def read(path):
    """Cable and pose messages with their stamps, and how many messages of all topics there are."""
    messages = {CABLE: [], POSE: []}
    count = 0
    for message in read_ros2_messages(path):
        count += 1
        if message.channel.topic in messages:
            messages[message.channel.topic].append(message.ros_msg)
    stamps = {topic: np.array([stamp_of(message) for message in of_topic]) for topic, of_topic in messages.items()}
    return messages, stamps, count


def poses_at(stamps, pose_stamps, poses):
    """Positions and quaternions at the cables' stamps, NaN outside the poses'."""
    values = np.array([
        [p.x, p.y, p.z, q.x, q.y, q.z, q.w]
        for p, q in ((message.pose.position, message.pose.orientation) for message in poses)
    ])
    before = np.clip(np.searchsorted(pose_stamps, stamps, side="right") - 1, 0, len(pose_stamps) - 2)
    ratio = ((stamps - pose_stamps[before]) / (pose_stamps[before + 1] - pose_stamps[before]))[:, np.newaxis]
    earlier, later = values[before], values[before + 1]
    opposite = np.sum(earlier[:, 3:] * later[:, 3:], axis=1) < 0.0
    later[opposite, 3:] *= -1.0
    values = earlier + ratio * (later - earlier)
    values[(stamps < pose_stamps[0]) | (stamps > pose_stamps[-1])] = np.nan
    return values[:, :3], values[:, 3:] / np.linalg.norm(values[:, 3:], axis=1, keepdims=True)


def rotated(quaternions, vector):
    axis, w = quaternions[:, :3], quaternions[:, 3:]
    twice = 2.0 * np.cross(axis, vector)
    return vector + w * twice + np.cross(axis, twice)


def last_pulley(cable, positions, quaternions):
    """2 sin(β/2) of the swivelling pulley's wrap β, direction of the cable's pull, and lever arm, at each pose."""
    pulley = cable["pulleys"][-1]
    radius = pulley["radius_m"]
    axis = np.array(pulley["axis"]) / np.linalg.norm(pulley["axis"])
    arm = rotated(quaternions, np.array(cable["platform_m"]))
    relative = positions + arm - np.array(cable["base_m"])
    z = relative @ axis
    radial = relative - np.outer(z, axis)
    distance = np.linalg.norm(radial, axis=1)
    x = distance - radius
    squared = x * x + z * z
    free = np.sqrt(squared - radius * radius)
    cos, sin = (x * radius - z * free) / squared, (z * radius + x * free) / squared
    leaves = ((radius + radius * cos) / distance)[:, np.newaxis] * radial + np.outer(radius * sin, axis)
    return np.sqrt(2.0 * (1.0 + cos)), (leaves - relative) / free[:, np.newaxis], arm


def compute(robot, messages, stamps):
    """Forces at the platform, frictions and wrenches."""
    cables = robot["cable"]
    cable_messages = messages[CABLE]
    names = list(cable_messages[0].name)
    columns = [names.index(cable["name"]) for cable in cables]
    sensor, lengths, speeds = (
        np.array([getattr(message, field) for message in cable_messages])[:, columns]
        for field in ("effort", "position", "velocity")
    )
    positions, quaternions = poses_at(stamps[CABLE], stamps[POSE], messages[POSE])
    geometry = [last_pulley(cable, positions, quaternions) for cable in cables]

    assert all(cable["pulleys"][0] == {"wrap_deg": 180.0, "sensor": True} for cable in cables)
    assert all(cable.get("presliding", "per_pulley") == "per_pulley" for cable in cables)
    fixed = np.radians([[pulley["wrap_deg"] for pulley in cable["pulleys"][1:-1]] for cable in cables]).T
    mu, sigma, viscous = (
        np.array([cable["friction"][key] for cable in cables]) for key in ("mu", "sigma_n_per_m", "viscous_n_s_per_m")
    )
    offset = np.array([cable["friction"].get("offset_n", 0.0) for cable in cables])
    wrap_factors = np.array([wrap for wrap, _, _ in geometry]).T
    slopes = [0.5 * mu * factors for factors in 2.0 * np.sin(0.5 * fixed)]
    sensor_slidings = mu * sensor
    last_slopes = 0.5 * mu * wrap_factors
    displacements = np.diff(lengths, axis=0, prepend=lengths[:1])
    # A length that jumps is no motion.
    displacements[np.abs(displacements) > 10.0 * robot["cycle_s"]] = 0.0
    ways = sigma / (len(slopes) + 2) * np.abs(displacements)
    signs = np.sign(displacements)
    drags = viscous * speeds

    stored = np.zeros((len(slopes) + 2, len(cables)))
    tensions = np.empty_like(sensor)

    def slide(place, sliding, way, sign):
        sliding = np.maximum(sliding, 1e-30)
        target = sign * sliding
        friction = np.where(way > 0.0, target + (stored[place] - target) * np.exp(-way / sliding), stored[place])
        stored[place] = friction
        return friction

    for i in range(len(sensor)):
        drag, way, sign = drags[i], ways[i], signs[i]
        tension = 0.5 * (sensor[i] + slide(0, sensor_slidings[i], way, sign) + drag)
        for place, slope in enumerate((*slopes, last_slopes[i]), start=1):
            sliding = slope * (2.0 * tension + stored[place] + drag)
            tension = tension + slide(place, sliding, way, sign) + drag
        tensions[i] = tension
    forces = np.maximum(tensions, 0.0) + offset
    wrenches = np.zeros((len(forces), 6))
    for force, (_, direction, arm) in zip(forces.T, geometry):
        pull = force[:, np.newaxis] * direction
        wrenches[:, :3] -= pull
        wrenches[:, 3:] -= np.cross(arm, pull)
    return forces, forces - 0.5 * sensor - offset, wrenches


def write(log, path, names, stamps, outputs):
    with open(log, "rb") as file:
        texts = {schema.name: schema.data.decode() for schema in make_reader(file).get_summary().schemas.values()}
    joint_state, wrench_stamped = texts["sensor_msgs/msg/JointState"], texts["geometry_msgs/msg/WrenchStamped"]
    _, *parts = joint_state.partition("=" * 80)
    status = "std_msgs/Header header\nstring[] name\nuint32[] flags\n" + "".join(parts)
    with open(path, "wb") as file:
        writer = Writer(file)
        joint_state = writer.register_msgdef("sensor_msgs/msg/JointState", joint_state)
        wrench_stamped = writer.register_msgdef("geometry_msgs/msg/WrenchStamped", wrench_stamped)
        status = writer.register_msgdef("fric_msgs/msg/CableStatus", status)
        flags = [0] * len(names)
        for stamp, force, friction, wrench in zip(stamps.tolist(), *(array.tolist() for array in outputs)):
            time_of = {"stamp": {"sec": stamp // 1_000_000_000, "nanosec": stamp % 1_000_000_000}}
            platform, base = {**time_of, "frame_id": "platform"}, {**time_of, "frame_id": "base"}
            x, y, z, a, b, c = wrench
            wrench = {"force": {"x": x, "y": y, "z": z}, "torque": {"x": a, "y": b, "z": c}}
            for topic, schema, message in (
                (FORCES, joint_state, {"header": platform, "name": names, "position": [], "velocity": [], "effort": force}),
                (FRICTION, joint_state, {"header": platform, "name": names, "position": [], "velocity": [], "effort": friction}),
                (WRENCH, wrench_stamped, {"header": base, "wrench": wrench}),
                (STATUS, status, {"header": {**time_of, "frame_id": ""}, "name": names, "flags": flags}),
            ):
                writer.write_message(topic, schema, message, log_time=stamp, publish_time=stamp)
        writer.finish()


def numbers(path):
    """By topic: stamps and numbers of the messages."""
    values = {FORCES: [], FRICTION: [], WRENCH: [], STATUS: []}
    for message in read_ros2_messages(path):
        content = message.ros_msg
        if message.channel.topic == WRENCH:
            force, torque = content.wrench.force, content.wrench.torque
            row = [force.x, force.y, force.z, torque.x, torque.y, torque.z]
        else:
            row = content.flags if message.channel.topic == STATUS else content.effort
        values[message.channel.topic].append([stamp_of(content), *row])
    # Nanoseconds since 1970 would not fit into a float's 53 bits, those since the log's first do.
    first = values[STATUS][0][0]
    return {topic: np.array([[row[0] - first, *row[1:]] for row in rows], dtype=float) for topic, rows in values.items()}


def compare(ours, theirs):
    """The greatest deviation of each topic, over the cycles of which ours has flagged no cable."""
    fine = ours[STATUS][~ours[STATUS][:, 1:].any(axis=1), 0]
    print(f"compared: {len(fine)} of {len(ours[STATUS])} cycles; others are flagged")
    for topic in (FORCES, FRICTION, WRENCH):
        one, other = (of[topic][np.isin(of[topic][:, 0], fine)] for of in (ours, theirs))
        assert one.shape == other.shape and (one[:, 0] == other[:, 0]).all(), f"{topic}: other messages"
        deviation = np.abs(one - other).max()
        print(f"{topic}: the outputs agree to {deviation:.1e}")
        yield deviation


def main(log, robot_file, out, ours):
    with open(robot_file, "rb") as file:
        robot = tomllib.load(file)
    start, processor = time.perf_counter(), time.process_time()
    messages, stamps, count = read(log)
    has_read = time.perf_counter()
    outputs = compute(robot, messages, stamps)
    has_computed = time.perf_counter()
    write(log, out, [cable["name"] for cable in robot["cable"]], stamps[CABLE], outputs)
    end = time.perf_counter()
    print(f"messages {count}")
    print(f"seconds {end - start:.6f}")
    print(f"processor_seconds {time.process_time() - processor:.6f}")
    print(f"of that: reading {has_read - start:.1f} s, computing {has_computed - has_read:.1f} s, writing {end - has_computed:.1f} s")
    sys.exit(0 if max(compare(numbers(ours), numbers(out))) <= TOLERANCE else 1)


if __name__ == "__main__":
    main(*sys.argv[1:])
