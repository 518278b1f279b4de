"""What crafted recordings may take: 256 MiB, and one sentence. The tests in Rust see what is read of them, these what it costs."""

import sqlite3
import struct
import subprocess
import sys

import pytest
import zstandard
from support import HANG_S, PROGRAM, ROBOT

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="ru_maxrss is in KiB on Linux only")

MOST_KIB = 256 << 10
MIB = 1 << 20
MAGIC = b"\x89MCAP0\r\n"
END = [(15, struct.pack("<I", 0)), (2, bytes(20))]
CDR = b"\0\1\0\0"


def text(content):
    content = content.encode() if isinstance(content, str) else content
    return struct.pack("<I", len(content)) + content


def record(kind, body):
    return bytes([kind]) + struct.pack("<Q", len(body)) + body


def schema(number, name, encoding, definition):
    return record(3, struct.pack("<H", number) + text(name) + text(encoding) + text(definition))


def channel(number, topic, encoding):
    return record(4, struct.pack("<HH", number, number) + text(topic) + text(encoding) + struct.pack("<I", 0))


def message(nanos, data):
    return record(5, struct.pack("<HIQQ", 1, 0, nanos, nanos) + data)


def chunk(content, first_nanos=1, last_nanos=1):
    packed = zstandard.ZstdCompressor(level=3).compress(content)
    head = struct.pack("<QQQI", first_nanos, last_nanos, len(content), 0)
    return record(6, head + text("zstd") + struct.pack("<Q", len(packed)) + packed)


def recording(*records):
    return MAGIC + record(1, text("") + text("crafted")) + b"".join(records) + b"".join(record(*end) for end in END) + MAGIC


def of_signals(definition, content, encoding="cdr"):
    """A recording with the topic that a robot file expects, of this type."""
    kinds = {"cdr": ("sensor_msgs/msg/JointState", "ros2msg"), "json": ("JointState", "jsonschema")}
    return recording(schema(1, *kinds[encoding], definition), channel(1, "/cable_states", encoding), *content)


def a_chunk_beyond_any():
    return of_signals("float64 x", [chunk(record(0x80, bytes(300 * MIB)))])


def chunks_that_overlap():
    """All of them are open at once, as each has the earliest and the latest message."""
    other = record(0x80, bytes(60 * MIB))
    chunks = [chunk(message(1 + i, CDR + bytes(8)) + other + message(1000 + i, CDR + bytes(8)), 1 + i, 1000 + i) for i in range(20)]
    return of_signals("float64 x", chunks)


def definitions_of_two_gigabytes():
    pairs = (b"".join(schema(i, f"S{i}", "ros2msg", b"#" * (60 * MIB)) + channel(i, f"/t{i}", "cdr") for i in (j, j + 1)) for j in range(1, 33, 2))
    return recording(*map(chunk, pairs))


def definitions_outside_of_chunks():
    return recording(*(schema(number, f"S{number}", "ros2msg", b"#" * (30 * MIB)) for number in range(1, 11)))


def metadata_of_any_size():
    entries = text("key") + text(b"#" * (30 * MIB))
    return recording(*(record(12, text(f"{number}") + text(entries)) for number in range(10)))


def metadata_of_three_million_entries():
    def entries(first):
        return b"".join(text(b"%x" % number) + text("") for number in range(first, first + 60_000))

    return recording(*(record(12, text("") + text(entries(60_000 * part))) for part in range(50)))


def channels_of_three_million_entries():
    entries = b"".join(text(b"%x" % number) + text("") for number in range(60_000))
    bodies = (struct.pack("<HH", number, 0) + text(f"/{number}") + text("cdr") + text(entries) for number in range(1, 51))
    return recording(chunk(b"".join(record(4, body) for body in bodies)))


def channels_with_long_names():
    return recording(*(chunk(channel(number, f"/{number}" + "n" * 10_000, "cdr")) for number in range(1, 65_536)))


def fields_by_the_million():
    return of_signals("".join(f"bool {number:x}\n" for number in range(0xA00000, 0xA00000 + 2_500_000)), [message(1, CDR + bytes(64))])


def a_message_of_json():
    wanted = '{"type":"object","properties":{"effort":{"type":"array","items":{"type":"number"}}}}'
    numbers = b"1," * (30 * MIB)
    return of_signals(wanted, [chunk(message(1, b'{"name":["a"],"position":[' + numbers + b'1],"effort":[' + numbers + b"1]}"))], "json")


def a_message_of_many_names():
    count = 15 * MIB
    names = struct.pack("<I", count) + b"\1\0\0\0\0\0\0\0" * count
    joints = "string[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
    return of_signals(joints, [chunk(message(1, CDR + names + bytes(12)))])


def a_line_of_csv():
    return b"time_s,cable1.force_n,cable1.length_m\n0,1,1\n0.001,1,1\n0.002," + b"1," * (150 * MIB) + b"1\n0.003,1,1\n"


def a_header_of_csv():
    return b"time_s," + b"a," * (150 * MIB) + b"b\n0,1,1\n"


def a_value_that_sqlite_computes(path):
    with sqlite3.connect(path) as database:
        database.execute("create table topics(id integer primary key, name text, type text, serialization_format text, offered_qos_profiles text)")
        blob = "data blob generated always as (zeroblob(900000000)) virtual"
        database.execute(f"create table messages(id integer primary key, topic_id integer, timestamp integer, {blob})")
        database.execute("insert into topics values(1, '/cable_states', 'sensor_msgs/msg/JointState', 'cdr', '')")
        database.execute("insert into messages values(1, 1, 10)")
    database.close()


def a_packed_file(path):
    with path.open("wb") as file, zstandard.ZstdCompressor(level=1).stream_writer(file) as packed:
        for _ in range(64):
            packed.write(bytes(64 * MIB))


CRAFTED = {
    "chunk.mcap": a_chunk_beyond_any,
    "overlap.mcap": chunks_that_overlap,
    "definitions.mcap": definitions_of_two_gigabytes,
    "outside.mcap": definitions_outside_of_chunks,
    "metadata.mcap": metadata_of_any_size,
    "entries.mcap": metadata_of_three_million_entries,
    "channels.mcap": channels_of_three_million_entries,
    "names.mcap": channels_with_long_names,
    "fields.mcap": fields_by_the_million,
    "json.mcap": a_message_of_json,
    "message.mcap": a_message_of_many_names,
    "line.csv": a_line_of_csv,
    "header.csv": a_header_of_csv,
    "computed.db3": a_value_that_sqlite_computes,
    "packed.mcap.zstd": a_packed_file,
}


# In a process of its own: a child's peak begins with that of the process that starts it.
MEASURE = """
import os, subprocess, sys
program = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(program.pid, 0)
print(usage.ru_maxrss, os.waitstatus_to_exitcode(status))
"""


@pytest.mark.parametrize("name", CRAFTED)
def test_a_crafted_recording_takes_256_mib_at_most(tmp_path, name):
    path = tmp_path / name
    craft = CRAFTED[name]
    if path.suffix in (".mcap", ".csv"):
        path.write_bytes(craft())
    else:
        craft(path)
    for command in (["info", name], ["replay", name, "--model", ROBOT]):
        measured = [sys.executable, "-c", MEASURE, PROGRAM, *command]
        done = subprocess.run(measured, cwd=tmp_path, capture_output=True, text=True, encoding="utf-8", check=True, timeout=HANG_S)
        peak_kib, code = map(int, done.stdout.split())
        assert peak_kib <= MOST_KIB, f"{command}: {peak_kib >> 10} MiB"
        assert code in (0, 1), done.stderr
        assert len(done.stderr) < 10_000
        assert "panicked" not in done.stderr
        assert done.stderr.count("error: ") == code, done.stderr
    # Some have hundreds of megabytes.
    path.unlink()
