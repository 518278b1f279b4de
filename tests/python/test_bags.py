"""Bags of rosbag2 as the package `rosbags` writes them: what it reads, and the bits of the MCAP log they are made of."""

import json
import sqlite3

import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from support import LOG, ROBOT, run

TYPES = get_typestore(Stores.ROS2_HUMBLE)
SECONDS = 3


@pytest.fixture(scope="module")
def messages():
    """Topic, type, time and bytes of the first seconds of the example log."""
    with LOG.open("rb") as stream:
        found = []
        for schema, channel, message in make_reader(stream).iter_messages():
            found.append((channel.topic, schema.name, message.log_time, message.data))
    start = min(time for _, _, time, _ in found)
    return [message for message in found if message[2] <= start + SECONDS * 1_000_000_000]


def write(path, messages, storage=StoragePlugin.SQLITE3, mode=None):
    writer = Writer(path, version=9, storage_plugin=storage)
    if mode is not None:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for topic, kind, time, data in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=TYPES)
            writer.write(connections[topic], time, data)
    return path


FORMS = {
    "sqlite": {},
    "sqlite-messages": {"mode": CompressionMode.MESSAGE},
    "sqlite-file": {"mode": CompressionMode.FILE},
    "mcap": {"storage": StoragePlugin.MCAP},
    "mcap-messages": {"storage": StoragePlugin.MCAP, "mode": CompressionMode.MESSAGE},
    "mcap-file": {"storage": StoragePlugin.MCAP, "mode": CompressionMode.FILE},
}


@pytest.fixture(scope="module", params=FORMS)
def bag(request, messages, tmp_path_factory):
    return write(tmp_path_factory.mktemp("bags") / "bag", messages, **FORMS[request.param])


def replayed(log, directory, *arguments):
    output = directory / "out.mcap"
    run("replay", log, "--model", ROBOT, "-o", output, "--force", *arguments)
    with output.open("rb") as stream:
        return [(channel.topic, message.log_time, message.data) for _, channel, message in make_reader(stream).iter_messages()]


def test_info_counts_what_rosbags_counts(bag, tmp_path):
    run("info", bag, "--model", ROBOT, "--json", tmp_path / "info.json")
    info = json.loads((tmp_path / "info.json").read_text())
    with AnyReader([bag], default_typestore=TYPES) as reader:
        expected = {name: topic.msgcount for name, topic in reader.topics.items()}
        times = [time for _, time, _ in reader.messages()]
    assert {topic["topic"]: topic["messages"] for topic in info["topics"]} == expected
    assert max(topic["to_s"] for topic in info["topics"]) == pytest.approx((max(times) - min(times)) / 1e9)
    assert all(step["possible"] for step in info["steps"] if step["step"].startswith("replay")), info["steps"]


def test_a_replay_gives_the_bits_of_the_log(bag, tmp_path):
    expected = replayed(LOG, tmp_path, "--end", str(SECONDS))
    assert len(expected) > SECONDS * 1000 and replayed(bag, tmp_path, "--end", str(SECONDS)) == expected


def test_a_bag_in_parts_is_read_as_one(messages, tmp_path):
    bag = tmp_path / "parts"
    bag.mkdir()
    names = []
    middle = len(messages) // 2
    for number, part in enumerate([messages[:middle], messages[middle:]]):
        write(tmp_path / str(number), part)
        names.append(f"parts_{number}.db3")
        (tmp_path / str(number) / f"{number}.db3").rename(bag / names[-1])
    expected = replayed(LOG, tmp_path, "--end", str(SECONDS))
    # Without metadata, as where the recorder was ended; then with it.
    assert "no metadata.yaml that can be read" in run("info", bag)
    listed = "".join(f"\n    - {name}" for name in names)
    (bag / "metadata.yaml").write_text(f"rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:{listed}\n")
    assert run("info", bag) == ""
    assert replayed(bag, tmp_path, "--end", str(SECONDS)) == expected
    (bag / names[1]).unlink()
    assert "has no file `parts_1.db3`" in run("info", bag)


def test_a_bag_without_definitions_is_read(messages, tmp_path):
    bag = write(tmp_path / "bag", messages)
    with sqlite3.connect(bag / "bag.db3") as database:
        database.execute("DROP TABLE message_definitions")
    assert replayed(bag, tmp_path, "--end", str(SECONDS)) == replayed(LOG, tmp_path, "--end", str(SECONDS))


@pytest.mark.parametrize("share", [0.3, 0.7, 0.95])
def test_a_bag_that_is_cut_off_is_read_as_far_as_it_goes(messages, tmp_path, share):
    bag = write(tmp_path / "bag", messages)
    file = bag / "bag.db3"
    content = file.read_bytes()
    file.write_bytes(content[: int(len(content) * share)])
    assert "is damaged" in run("info", bag, "--json", tmp_path / "info.json")
    topics = json.loads((tmp_path / "info.json").read_text())["topics"]
    found = sum(topic["messages"] for topic in topics) / len(messages)
    assert share - 0.25 < found < share + 0.05, found
