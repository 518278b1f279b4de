"""Logs, simulated and replayed, from Python and by the command line: the same bits."""

import json
import pickle
import struct
from itertools import islice

import fric
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from support import LOG, ROBOT, SLOW_BENCH, run

ARRAYS = [
    "stamp_nanos",
    "sensor_force_n",
    "length_m",
    "speed_m_per_s",
    "reference_force_n",
    "position_m",
    "orientation_xyzw",
    "outside_force_n",
    "outside_torque_nm",
]


@pytest.fixture(scope="module")
def robot():
    return fric.Robot.read(ROBOT)


@pytest.fixture(scope="module")
def log():
    return fric.read_log(LOG)


def arrays_of(log):
    return {name: np.array(getattr(log, name)) for name in ARRAYS}


def of_bits(array):
    return np.ascontiguousarray(array).view(np.uint64)


def test_a_log_has_named_arrays(log, robot):
    assert len(log) == 50_000 and log.robot == robot and log.cable_names == robot.cable_names
    shapes = {name: getattr(log, name).shape[1:] for name in ARRAYS}
    assert shapes == {
        "stamp_nanos": (),
        "sensor_force_n": (8,),
        "length_m": (8,),
        "speed_m_per_s": (8,),
        "reference_force_n": (8,),
        "position_m": (3,),
        "orientation_xyzw": (4,),
        "outside_force_n": (3,),
        "outside_torque_nm": (3,),
    }
    assert log.stamp_nanos.dtype == np.int64 and all(getattr(log, name).dtype == np.float64 for name in ARRAYS[1:])
    assert np.allclose(log.time_s, np.arange(50_000) * 1e-3, rtol=0, atol=1e-12)
    for name in [*ARRAYS, "time_s"]:
        with pytest.raises(ValueError, match="read-only"):
            getattr(log, name)[0] = 0


def test_a_replay_tells_what_the_command_line_tells(tmp_path, robot, log):
    path, output = tmp_path / "result.json", [tmp_path / "cli.mcap", tmp_path / "python.mcap"]
    assert run("replay", LOG, "--json", path, "-o", output[0]) == ""
    told = json.loads(path.read_text(encoding="utf-8"))
    result = fric.replay(robot, LOG, output=output[1])
    cables = [
        {
            "name": cable.name,
            "samples": cable.samples,
            "flagged": cable.flagged,
            "before": {"rms_n": cable.before.rms_n, "mae_n": cable.before.mae_n},
            "after": {"rms_n": cable.after.rms_n, "mae_n": cable.after.mae_n},
        }
        for cable in result.cables
    ]
    assert cables == told["cables"] and result.robot == told["robot"]
    before, after = (
        {"force_rms_n": error.force_rms_n, "torque_rms_nm": error.torque_rms_nm} for error in result.wrench
    )
    assert {"reference": result.wrench_reference, "before": before, "after": after} == told["wrench"]
    assert result.cable("cable3").after.rms_n == result.cables[2].after.rms_n

    # The files differ in nothing but the comments of the robot file attached.
    attached = fric.Robot.read(ROBOT)
    logs = []
    for file in output:
        for topic in ["/fric/cable_forces", "/fric/friction"]:
            effort = topic + ".effort[:]"
            attached.log.set(cable=topic, length=effort, speed=effort, wrench="/fric/wrench")
            with pytest.warns(fric.LogWarning, match="no pose"):
                logs.append(fric.read_log(file, attached))
    for ours, name, column in [(logs[2], "force_at_platform_n", 0), (logs[3], "friction_n", 1)]:
        assert np.array_equal(ours.sensor_force_n, getattr(result, name))
        assert np.array_equal(ours.sensor_force_n, logs[column].sensor_force_n)
    assert np.array_equal(np.hstack([logs[2].outside_force_n, logs[2].outside_torque_nm]), result.outside_wrench)
    with pytest.raises(fric.OutputError, match="exists"):
        fric.replay(robot, log, output=output[1])
    with pytest.raises(fric.OutputError, match="inputs are never overwritten"):
        fric.replay(robot, logs[3], output=output[1], force=True)


def test_a_log_in_arrays_is_replayed_to_the_same_bits(robot, log):
    expected = fric.replay(robot, log)
    names = {"cable_names": log.cable_names}
    for other in [fric.replay(robot, fric.Log.from_arrays(**names, **arrays_of(log))), fric.replay(robot, [LOG])]:
        assert repr(other.cables) == repr(expected.cables) and repr(other.wrench) == repr(expected.wrench)
        for name in ["force_at_platform_n", "friction_n", "frictionless_n", "status"]:
            assert np.array_equal(getattr(other, name), getattr(expected, name))
        assert np.array_equal(other.outside_wrench, expected.outside_wrench, equal_nan=True)


@pytest.mark.filterwarnings("ignore:.*times the reference")
@pytest.mark.parametrize(
    ("key", "stated"),
    [("reference", {"constant_n": 9.0}), ("reference", {"hanging_mass_kg": 1.0}), ("pose", "lengths")],
)
def test_arrays_have_what_the_robot_file_states(log, key, stated):
    robot = fric.Robot.read(ROBOT)
    setattr(robot.log, key, stated)
    measured = {"reference": "reference_force_n", "pose": "position_m"}
    arrays = {name: array for name, array in arrays_of(log).items() if name != measured[key]}
    if key == "pose":
        del arrays["orientation_xyzw"]
    made = fric.replay(robot, fric.Log.from_arrays(cable_names=robot.cable_names, **arrays))
    read = fric.replay(robot, LOG)
    assert made.cables == read.cables and made.wrench == read.wrench
    assert read.cables[0].after is not None
    assert np.array_equal(made.outside_wrench, read.outside_wrench, equal_nan=True)


def test_a_replay_tells_where_its_poses_come_from(tmp_path, log):
    robot = fric.Robot.read(ROBOT)
    assert fric.replay(robot, log[:1.0]).pose is None
    robot.log.pose = "lengths"
    model, path = tmp_path / "lengths.toml", tmp_path / "result.json"
    model.write_text(robot.to_toml(), encoding="utf-8")
    run("replay", LOG, "--model", model, "--json", path)
    expected = fric.ComputedPoses(**json.loads(path.read_text(encoding="utf-8"))["pose"])
    assert (expected.source, expected.samples, expected.missing) == ("lengths", 50_000, 0)
    read, arrays = fric.read_log(LOG, robot), arrays_of(log)
    del arrays["position_m"], arrays["orientation_xyzw"]
    made = fric.Log.from_arrays(cable_names=robot.cable_names, **arrays)
    for same in [LOG, read, pickle.loads(pickle.dumps(read)), made]:
        assert fric.replay(robot, same).pose == expected
    # The error of the lengths is known for the whole log only.
    assert fric.replay(robot, read[1.0:3.0]).pose == fric.ComputedPoses("lengths", 2000, 0, None)


def test_what_is_missing_is_named_as_the_log_has_it(tmp_path):
    path = tmp_path / "bench.csv"
    rows = [f"{row * 0.004:.3f},{20 + row % 7 / 100},{1 + 0.1 * np.sin(row * 0.01):.6f}" for row in range(2000)]
    path.write_text("\n".join(["time_s,winch.force_n,winch.length_m", *rows]) + "\n", encoding="utf-8")
    bench = fric.Robot.from_toml(SLOW_BENCH)
    with pytest.warns(fric.LogWarning, match=r"in columns such as `cable1.reference_n`"):
        fric.replay(bench, path)
    with pytest.raises(fric.FitError, match=r"in columns such as `cable1.reference_n`"):
        fric.fit(bench, path)


def test_a_reference_of_other_times_is_the_reason(tmp_path, robot):
    path = tmp_path / "apart.mcap"
    with LOG.open("rb") as source, path.open("wb") as target:
        writer, channels = Writer(target), {}
        writer.start()
        for schema, channel, message in islice(make_reader(source).iter_messages(), 2500):
            if channel.topic not in channels:
                schema_id = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(channel.topic, channel.message_encoding, schema_id)
            data = bytearray(message.data)
            if channel.topic == "/reference_forces":
                # The seconds of the stamp, behind four bytes that announce the encoding.
                data[4:8] = struct.pack("<i", struct.unpack_from("<i", data, 4)[0] + 1000)
            writer.add_message(channels[channel.topic], message.log_time, bytes(data), message.publish_time)
        writer.finish()
    with pytest.warns(fric.LogWarning) as warnings:
        fric.replay(robot, path)
    told = [str(warning.message) for warning in warnings]
    assert ["messages is of a time of the cable signal" in text for text in told] == [True]
    with (
        pytest.warns(fric.LogWarning, match="none of its"),
        pytest.raises(fric.FitError, match="no message of the reference signal is of a time .* by one clock"),
    ):
        fric.fit(robot, path)


def test_a_simulation_has_the_bits_of_the_command_line(tmp_path, robot):
    path = tmp_path / "log.mcap"
    effect = "stribeck:ratio=0.5,velocity_m_per_s=0.02"
    cli = ["--duration", "3", "--seed", "5", "--effect", effect, "--mu-spread-ratio", "0.1"]
    run("simulate", "--model", ROBOT, "-o", path, *cli)
    options = {"seed": 5, "duration_s": 3.0, "mu_spread_ratio": 0.1}
    of_dict = {"kind": "stribeck", "ratio": 0.5, "velocity_m_per_s": 0.02}
    read = fric.read_log(path)
    for effects in [[effect], [of_dict]]:
        ours = fric.simulate(robot, effects=effects, **options)
        for name in [*ARRAYS[:5], "time_s"]:
            assert np.array_equal(of_bits(getattr(ours, name)), of_bits(getattr(read, name))), name
        # Pose and wrench stand in the file every 4 ms, and are interpolated between.
        for name in ARRAYS[5:]:
            assert np.array_equal(of_bits(getattr(ours, name)[::4]), of_bits(getattr(read, name)[::4])), name
        assert np.allclose(ours.position_m, read.position_m, rtol=0, atol=1e-5)
    assert not np.array_equal(fric.simulate(robot, **options).sensor_force_n, read.sensor_force_n)


def test_a_log_read_with_another_known_reference_is_told(log):
    other = fric.Robot.read(ROBOT)
    other.log.reference = {"constant_n": 5.0}
    with pytest.warns(fric.LogWarning, match="read with another known `reference`"):
        fric.replay(other, log)


def test_what_spoils_a_simulated_log_is_that_of_the_command_line(tmp_path, robot):
    path = tmp_path / "log.mcap"
    numbers = {
        "sensor_wander_n": 0.05,
        "reference_wander_n": 0.03,
        "wander_s": 0.5,
        "hand_n": 2.0,
        "length_noise_m": 1e-6,
        "length_resolution_m": 2e-6,
    }
    cli = [text for key, value in numbers.items() for text in ("--" + key.replace("_", "-"), str(value))]
    run("simulate", "--model", ROBOT, "-o", path, "--duration", "1", "--disturbance", "hum:amplitude_n=0.1", *cli)
    read = fric.read_log(path)
    for disturbance in ["hum:amplitude_n=0.1", {"kind": "hum", "amplitude_n": 0.1}]:
        ours = fric.simulate(robot, duration_s=1.0, disturbances=[disturbance], **numbers)
        for name in ARRAYS[:5]:
            assert np.array_equal(of_bits(getattr(ours, name)), of_bits(getattr(read, name))), name
    for left_out in ["disturbances", *numbers]:
        options = numbers | {"disturbances": [disturbance]}
        del options[left_out]
        other = fric.simulate(robot, duration_s=1.0, **options)
        assert any(not np.array_equal(getattr(ours, name), getattr(other, name)) for name in ARRAYS[1:5]), left_out


def test_simulated_crossing_runs_are_those_of_the_command_line(tmp_path, robot):
    path = tmp_path / "log.mcap"
    run("simulate", "--model", ROBOT, "-o", path, "--run", "crossing", "--duration", "3")
    read, ours = fric.read_log(path), fric.simulate(robot, run="crossing", duration_s=3.0)
    assert np.array_equal(of_bits(ours.sensor_force_n), of_bits(read.sensor_force_n))
    assert not np.array_equal(fric.simulate(robot, duration_s=3.0).length_m, ours.length_m)


def test_what_no_robot_could_do_is_told_as_by_the_command_line(tmp_path):
    text = """
        format = "fric-robot/1"
        name = "hung"
        cycle_s = 0.01
        platform = { mass_kg = 1.0 }
        [[cable]]
        name = "left"
        pulleys = [{ wrap_deg = 180.0, sensor = true }]
        base_m = [1.0, 0.0, 1.0]
        platform_m = [0.1, 0.0, 0.0]
        [[cable]]
        name = "right"
        pulleys = [{ wrap_deg = 180.0, sensor = true }]
        base_m = [-1.0, 0.5, 1.0]
        platform_m = [-0.1, 0.0, 0.1]
    """
    (tmp_path / "robot.toml").write_text(text)
    told = run("simulate", "--model", tmp_path / "robot.toml", "-o", tmp_path / "log.mcap", "--duration", "1")
    assert "cannot hold the platform" in told
    with pytest.warns(fric.LogWarning) as issued:
        fric.simulate(fric.Robot.from_toml(text), duration_s=1.0)
    assert [f"warning: {warning.message}" for warning in issued] == told.splitlines()


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"duration_s": -1.0}, "`duration_s` is -1; allowed is 0.001 to"),
        ({"sensor_noise_n": float("nan")}, "`sensor_noise_n` is NaN"),
        ({"run": "crosing"}, "unknown run `crosing`; did you mean `crossing`?"),
        ({"effects": ["stribek:ratio=1"]}, "there is no effect `stribek`; did you mean `stribeck`? known are"),
        ({"effects": [{"kind": "stribeck", "ratio": 9.0}]}, "`ratio` of the effect `stribeck` is 9; allowed is -0.9"),
        ({"effects": [{"kind": "stribeck", "ratio": "much"}]}, "`ratio` of an effect is no number"),
        ({"effects": [{"ratio": 0.5}]}, "an effect is a dict such as"),
        ({"effects": [3]}, "an effect is a dict such as"),
        ({"disturbances": [3]}, "a disturbance is a dict such as {\"kind\": \"hum\", \"amplitude_n\": 0.1}, or a text"),
        ({"disturbances": [{"kind": "hum", "amplitude_n": "much"}]}, "`amplitude_n` of a disturbance is no number"),
        ({"disturbances": ["hmu"]}, "there is no disturbance `hmu`; did you mean `hum`? known are"),
        ({"disturbances": ["hum:amplitude_n=0.1"] * 2}, "the disturbance `hum` is hidden twice. Give each"),
        ({"wander_s": 0.0}, "`wander_s` is 0; allowed is 0.001 to"),
        ({"length_resolution_m": -1e-6}, "`length_resolution_m` is -0.000001; allowed is 0 to 1"),
    ],
)
def test_options_out_of_range_are_told(robot, options, told):
    with pytest.raises(fric.ConfigError) as raised:
        fric.simulate(robot, **options)
    assert told in str(raised.value)


def test_what_cannot_be_read_is_told(tmp_path, robot, log):
    with pytest.raises(fric.LogError, match="there is no file `.*none.mcap`. Check the path"):
        fric.read_log(tmp_path / "none.mcap")
    with pytest.raises(fric.LogError, match="is not an MCAP recording"):
        fric.read_log(ROBOT)
    with pytest.raises(TypeError, match="`paths` must be a path or a list of paths; what came is 3"):
        fric.read_log(3)
    with pytest.raises(fric.OutputError, match=r"cannot be written: No such file or directory \(os error 2\)$"):
        fric.replay(log.robot, log, output=tmp_path / "nowhere" / "out.mcap")
    robot = fric.Robot.read(ROBOT)
    robot.log.cable = "/elsewhere"
    with pytest.raises(fric.LogError, match="no messages on `/elsewhere`"):
        fric.read_log(LOG, robot)
    robot.log.cable = "/a["
    with pytest.raises(fric.ConfigError, match=r"`cable` under \[log\]: message path `/a\[`"):
        fric.read_log(LOG, robot)
    robot = fric.Robot.read(ROBOT)
    robot.cable("cable1").name = "other"
    with pytest.raises(fric.ShapeError, match="the log has the cables cable1, .* the robot other, "):
        fric.replay(robot, log)


def test_warnings_are_those_of_the_command_line(tmp_path, robot):
    whole, cut, model = tmp_path / "whole.mcap", tmp_path / "cut.mcap", tmp_path / "robot.toml"
    run("simulate", "--model", ROBOT, "-o", whole, "--duration", "3")
    cut.write_bytes(whole.read_bytes()[:-200_000])
    robot = fric.Robot.read(ROBOT)
    robot.log.pose = "/nowhere"
    robot.cable("cable2").friction.set(mu=0.0, viscous_n_s_per_m=0.0)
    robot.cable("cable3").validated = {"force_n": [0.0, 1.0]}
    robot.cable("cable4").effects = [{"kind": "stribeck", "ratio": 0.0, "velocity_m_per_s": 0.02}]
    robot.cycle_s = 0.01
    robot.write(model)
    expected = [line.removeprefix("warning: ") for line in run("replay", cut, "--model", model).splitlines()]
    assert len(expected) >= 6 and any("does nothing" in line for line in expected)
    with pytest.warns(fric.LogWarning) as issued:
        fric.replay(robot, cut)
    assert [str(warning.message) for warning in issued] == expected
    with pytest.warns(fric.LogWarning, match="no reference forces"):
        arrays = {name: array for name, array in arrays_of(fric.read_log(whole)).items() if name != "reference_force_n"}
        result = fric.replay(fric.Robot.read(ROBOT), fric.Log.from_arrays(cable_names=robot.cable_names, **arrays))
    assert result.cables[0].before is None and result.cables[0].after is None


def good():
    return {
        "cable_names": ["one", "two"],
        "stamp_nanos": np.arange(4) * 1_000_000,
        "sensor_force_n": np.full((4, 2), 20.0),
        "length_m": np.arange(8.0).reshape(4, 2) * 1e-3,
    }


def test_speed_that_is_not_given_is_derived(log):
    length_m = good()["length_m"]
    length_m[2, 1] = np.nan
    made = fric.Log.from_arrays(**good() | {"length_m": length_m})
    # Over what is missing it comes from the lengths known before and after.
    assert np.allclose(made.speed_m_per_s, [[2, 2], [2, 2], [2, np.nan], [2, 2]], equal_nan=True)
    assert np.isnan(made.reference_force_n).all() and np.isnan(made.orientation_xyzw).all() and made.robot is None


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            {"stamp_nanos": np.arange(4) * 1e6},
            "`stamp_nanos` must be whole numbers (int64) of shape (N,), nanoseconds since 1970, or datetime64; what came is float64",
        ),
        ({"stamp_nanos": [0, 2, 2, 3]}, "`stamp_nanos` does not ascend from row 1 to row 2"),
        ({"sensor_force_n": np.zeros((3, 2))}, "`sensor_force_n` must be real numbers (float64) of shape (4, 2)"),
        ({"cable_names": ["one", "one"]}, '`cable_names` has "one" twice'),
        ({"cable_names": []}, "`cable_names` is empty"),
        ({"position_m": np.zeros((4, 3))}, "in row 0 are no pose"),
        ({"position_m": np.zeros((4, 3)), "orientation_xyzw": np.zeros((4, 4))}, "in row 0 are no pose"),
        ({"outside_force_n": np.zeros((4, 3))}, "in row 0 are no wrench"),
        ({"outside_torque_nm": np.full((4, 3), np.inf)}, "in row 0 are no wrench"),
    ],
)
def test_arrays_that_are_no_log_are_told(change, told):
    with pytest.raises(fric.ShapeError) as raised:
        fric.Log.from_arrays(**good() | change)
    assert told in str(raised.value)


def test_arrays_are_copied_and_quaternions_normalised():
    orientation = np.array([[0.0, 0.0, 0.0, 1.05], [np.nan] * 4, [0.0, 0.6, 0.8, 0.0], [0.5, 0.5, 0.5, 0.5]])
    position = np.where(np.isnan(orientation[:, :1]), np.nan, np.ones((4, 3)))
    arrays = good() | {"position_m": position, "orientation_xyzw": orientation}
    made = fric.Log.from_arrays(**arrays)
    assert made.orientation_xyzw[0].tolist() == [0.0, 0.0, 0.0, 1.0] and np.isnan(made.orientation_xyzw[1]).all()
    arrays["length_m"][:] = 9.0
    assert made.length_m[0, 0] == 0.0


def test_a_log_is_a_table_in_a_notebook(log):
    part = log[0.0:1.0]
    page = part._repr_html_()
    assert "1000 rows, 0.999 s" in page and "position_m" in page
    force_n = part.sensor_force_n[:, 1]
    assert f"<tr><th>cable2</th><td>{force_n.min():.4g} … {force_n.max():.4g}</td>" in page
    nothing = fric.Log.from_arrays(
        cable_names=["<b>"], stamp_nanos=[0], sensor_force_n=[[np.nan]], length_m=[[np.nan]], speed_m_per_s=[[np.nan]]
    )
    assert "signals: none" in nothing._repr_html_() and "<th>&lt;b&gt;</th></tr>" in nothing._repr_html_()
    assert "0 rows, 0.000 s" in log[1e6:]._repr_html_()


@pytest.mark.parametrize("library", ["polars", "pandas"])
def test_logs_become_data_frames(log, library, monkeypatch):
    frame = getattr(log, f"to_{library}")()
    assert list(frame.columns)[:3] == ["stamp_nanos", "time_s", "sensor_force_n.cable1"]
    assert frame.shape == (50_000, 2 + 4 * 8 + 13)
    assert np.array_equal(frame["length_m.cable7"].to_numpy(), log.length_m[:, 6])
    assert np.array_equal(frame["orientation_xyzw.w"].to_numpy(), log.orientation_xyzw[:, 3])
    monkeypatch.setitem(__import__("sys").modules, library, None)
    with pytest.raises(ImportError, match=f"pip install {library}"):
        getattr(log, f"to_{library}")()


def test_a_recording_is_not_named_as_another_file(robot, tmp_path):
    log = fric.simulate(robot, duration_s=0.1)
    with pytest.raises(fric.OutputError, match=r"`output` is `.*x.csv`, and what is written is MCAP; name it `.mcap`"):
        fric.replay(robot, log, output=tmp_path / "x.csv")
    assert not list(tmp_path.iterdir())
    fric.replay(robot, log, output=tmp_path / "x.mcap")
