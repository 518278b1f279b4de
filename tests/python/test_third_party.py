"""What `fric-cli` writes, opened with the readers other people use and computed again with NumPy."""

import json
import re

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from support import ROBOT, run

CABLES = [f"cable{number}" for number in range(1, 9)]
# As documented at `CableStatus`; a name or number that changes breaks the users' scripts.
FLAGS = [
    "SLACK",
    "SLIP",
    "SENSOR_NOT_FINITE",
    "SENSOR_FROZEN",
    "LENGTH_JUMP",
    "MOTION_NOT_FINITE",
    "OUT_OF_RANGE",
    "POSE_MISSING",
    "POSE_UNREACHABLE",
    "SENSOR_JUMP",
    "UNSETTLED",
]


class Log:
    """All of an MCAP file: checksums verified, every message decoded."""

    def __init__(self, path):
        self.schemas, self.messages, self.stamps = {}, {}, {}
        with open(path, "rb") as file:
            reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
            self.summary = reader.get_summary()
            self.header = reader.get_header()
            for schema, channel, message, decoded in reader.iter_decoded_messages():
                assert channel.message_encoding == "cdr" and schema.encoding == "ros2msg"
                stamp = decoded.header.stamp
                stamp_nanos = stamp.sec * 1_000_000_000 + stamp.nanosec
                assert message.log_time == stamp_nanos
                self.schemas[channel.topic] = schema
                self.messages.setdefault(channel.topic, []).append(decoded)
                self.stamps.setdefault(channel.topic, []).append(stamp_nanos)
            self.attachments = {attachment.name: attachment.data for attachment in reader.iter_attachments()}

    def nanos(self, topic):
        return np.array(self.stamps[topic])

    def joints(self, topic, field="effort"):
        """One row per message, one column per cable."""
        assert all(list(message.name) == CABLES for message in self.messages[topic])
        return np.array([list(getattr(message, field)) for message in self.messages[topic]])

    def wrench(self, topic):
        def six(message):
            force, torque = message.wrench.force, message.wrench.torque
            return [force.x, force.y, force.z, torque.x, torque.y, torque.z]

        return np.array([six(message) for message in self.messages[topic]])


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Paths of a simulated log, the replayed one and its result."""
    folder = tmp_path_factory.mktemp("third_party")
    log, output, result = folder / "log.mcap", folder / "out.mcap", folder / "result.json"
    assert run("simulate", "--model", ROBOT, "-o", log, "--duration", "5", "--seed", "5") == ""
    assert run("replay", log, "-o", output, "--json", result) == ""
    return log, output, result


@pytest.fixture(scope="module")
def simulated(files):
    return Log(files[0])


@pytest.fixture(scope="module")
def replayed(files):
    return Log(files[1])


@pytest.fixture(scope="module")
def result(files):
    return json.loads(files[2].read_text(encoding="utf-8"))


def rms(deviations):
    return np.sqrt(np.mean(np.square(deviations), axis=0))


def test_a_simulated_log_opens(simulated):
    assert simulated.header.profile == "ros2"
    assert {topic: schema.name for topic, schema in simulated.schemas.items()} == {
        "/cable_states": "sensor_msgs/msg/JointState",
        "/reference_forces": "sensor_msgs/msg/JointState",
        "/platform_pose": "geometry_msgs/msg/PoseStamped",
        "/platform_wrench": "geometry_msgs/msg/WrenchStamped",
    }
    assert simulated.attachments == {"fric-robot.toml": ROBOT.read_bytes()}
    assert simulated.summary.statistics.message_count == sum(map(len, simulated.messages.values()))
    nanos = simulated.nanos("/cable_states")
    assert len(nanos) == 5000 and np.all(np.diff(nanos) == 1_000_000)
    for field in ["position", "velocity", "effort"]:
        assert np.all(np.isfinite(simulated.joints("/cable_states", field)))
    assert simulated.joints("/cable_states", "position").min() > 0
    orientations = [message.pose.orientation for message in simulated.messages["/platform_pose"]]
    assert np.allclose([q.x**2 + q.y**2 + q.z**2 + q.w**2 for q in orientations], 1.0, rtol=0, atol=1e-12)


def test_speed_is_the_change_of_length(simulated):
    length, speed = (simulated.joints("/cable_states", field) for field in ["position", "velocity"])
    assert np.allclose((length[2:] - length[:-2]) / 0.002, speed[1:-1], rtol=0, atol=5e-3)


def test_a_replayed_log_opens(replayed, simulated):
    assert {topic: schema.name for topic, schema in replayed.schemas.items()} == {
        "/fric/cable_forces": "sensor_msgs/msg/JointState",
        "/fric/friction": "sensor_msgs/msg/JointState",
        "/fric/wrench": "geometry_msgs/msg/WrenchStamped",
        "/fric/status": "fric_msgs/msg/CableStatus",
    }
    assert replayed.attachments == simulated.attachments
    for topic in replayed.schemas:
        assert np.array_equal(replayed.nanos(topic), simulated.nanos("/cable_states")), topic


def test_the_errors_told_are_those_of_the_forces(replayed, simulated, result):
    assert np.array_equal(replayed.nanos("/fric/cable_forces"), simulated.nanos("/reference_forces"))
    reference = simulated.joints("/reference_forces")
    after = replayed.joints("/fric/cable_forces") - reference
    # The sensor is on a pulley of 180 degrees: without friction it feels the cable twice.
    before = simulated.joints("/cable_states") / 2 - reference
    assert [cable["name"] for cable in result["cables"]] == CABLES
    for when, deviations in [("before", before), ("after", after)]:
        told = np.array([[cable[when]["rms_n"], cable[when]["mae_n"]] for cable in result["cables"]])
        assert np.allclose(told[:, 0], rms(deviations), rtol=1e-9, atol=0)
        assert np.allclose(told[:, 1], np.abs(deviations).mean(axis=0), rtol=1e-9, atol=0)
    assert np.all(rms(after) < 0.2 * rms(before))


def test_the_friction_is_what_lies_between(replayed, simulated):
    sensor = simulated.joints("/cable_states") / 2
    friction, force = replayed.joints("/fric/friction"), replayed.joints("/fric/cable_forces")
    difference = np.abs(force - sensor)
    assert np.allclose(np.abs(friction), difference, rtol=0, atol=1e-9)


def test_the_wrench_error_told_is_that_of_the_wrenches(replayed, simulated, result):
    slow, fast = simulated.nanos("/platform_wrench"), replayed.nanos("/fric/wrench")
    start = slow[0]
    reference = simulated.wrench("/platform_wrench")
    between = np.stack([np.interp(fast - start, slow - start, column) for column in reference.T], axis=1)
    deviations = replayed.wrench("/fric/wrench") - between
    told = result["wrench"]["after"]
    lengths = [np.linalg.norm(part, axis=1) for part in (deviations[:, :3], deviations[:, 3:])]
    assert np.allclose([told["force_rms_n"], told["torque_rms_nm"]], [rms(part) for part in lengths], rtol=1e-9, atol=0)


def test_the_status_says_what_its_bits_mean(replayed, result):
    definition = replayed.schemas["/fric/status"].data.decode()
    constants = dict(re.findall(r"^uint32 ([A-Z_]+)=([0-9]+)$", definition, flags=re.MULTILINE))
    assert constants == {name: str(1 << bit) for bit, name in enumerate(FLAGS)}
    assert all(list(message.name) == CABLES for message in replayed.messages["/fric/status"])
    flags = np.array([list(message.flags) for message in replayed.messages["/fric/status"]])
    assert flags.shape == (5000, 8)
    assert np.array_equal((flags != 0).sum(axis=0), [cable["flagged"] for cable in result["cables"]])


def test_flags_arrive(tmp_path, files, simulated):
    """A robot that leaves the range it is validated for: the flag is set then, for that cable alone."""
    sensor = simulated.joints("/cable_states")[:, 0]
    middle_n = float(np.median(sensor))
    name = 'name = "cable1"\n'
    validated = f"{name}validated = {{ force_n = [0.0, {middle_n}], speed_m_per_s = 9.0 }}\n"
    robot, output = tmp_path / "robot.toml", tmp_path / "out.mcap"
    robot.write_text(ROBOT.read_text(encoding="utf-8").replace(name, validated), encoding="utf-8")
    warning = run("replay", files[0], "--model", robot, "-o", output)
    flags = np.array([list(message.flags) for message in Log(output).messages["/fric/status"]])
    assert np.all(flags[:, 1:] == 0)
    assert np.array_equal(flags[:, 0], np.where(sensor > middle_n, 1 << FLAGS.index("OUT_OF_RANGE"), 0))
    assert "2500 of 5000 samples are flagged OUT_OF_RANGE: cable1" in warning
