"""Parts of logs by seconds, the signals of a log, and logs that are CSV."""

import json

import fric
import numpy as np
import pytest
from support import LOG, ROBOT, run

SIGNALS = [
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


def test_a_slice_by_seconds_is_the_rows_between(log):
    part = log[2.0:8.5]
    within = (log.time_s >= 2.0) & (log.time_s < 8.5)
    assert len(part) == within.sum() == 6500
    assert part.cable_names == log.cable_names and part.robot == log.robot and part.time_s[0] == 0.0
    for name in ["stamp_nanos", *SIGNALS]:
        assert np.array_equal(getattr(part, name), getattr(log, name)[within], equal_nan=True), name
    assert len(log[:1]) == 1000 and len(log[49:]) == 1000 and len(log[:]) == len(log) and len(log[99:]) == 0
    with pytest.raises(TypeError, match="without a step"):
        log[0:1:2]
    with pytest.raises(TypeError, match="by seconds"):
        log["a":"b"]
    with pytest.raises(TypeError, match="cut by seconds"):
        log[3]


def test_a_replay_of_a_slice_is_that_of_the_part(log, robot, tmp_path):
    result = fric.replay(robot, log[2.0:8.5])
    run("replay", LOG, "--start", "2", "--end", "8.5", "--json", tmp_path / "part.json")
    cables = json.loads((tmp_path / "part.json").read_text())["cables"]
    for cable, expected in zip(result.cables, cables, strict=True):
        assert (cable.samples, cable.after.rms_n) == (expected["samples"], expected["after"]["rms_n"])


def test_parts_of_a_log_are_runs_of_their_own(log, robot):
    result = fric.fit(robot, [log[:10.0], log[20.0:30.0]])
    assert result.cables[0].samples > 15_000
    with pytest.raises(fric.ConfigError, match="given twice"):
        fric.fit(robot, [log[:10.0], log[9.0:30.0]])


def test_the_signals_of_a_log(log):
    assert list(log) == SIGNALS
    assert "position_m" in log and "temperature" not in log
    assert log["length_m"] is log.length_m
    with pytest.raises(KeyError, match="length_m"):
        log["lenght_m"]
    bare = fric.Log.from_arrays(
        cable_names=["winch"], stamp_nanos=[0, 1], sensor_force_n=[[1.0], [2.0]], length_m=[[0.0], [1.0]]
    )
    assert list(bare) == ["sensor_force_n", "length_m", "speed_m_per_s"] and "position_m" not in bare


def test_a_csv_log_is_read_with_a_robot(tmp_path):
    robot = fric.Robot.from_toml(
        """
format = "fric-robot/1"
name = "bench"
cycle_s = 0.001
[log.columns]
"winch.force_n" = { column = "F [kg]", factor = 10.0 }
[[cable]]
name = "winch"
pulleys = [{ wrap_deg = 90.0 }]
"""
    )
    assert robot.log.columns["winch.force_n"]["column"] == "F [kg]"
    rows = [f"{at / 1000:.3f};{2 + at % 3};{at / 1000}" for at in range(100)]
    path = tmp_path / "run.csv"
    path.write_text("\n".join(["time_s;F [kg];winch.length_m", *rows, ""]))
    log = fric.read_log(path, robot)
    assert len(log) == 100 and list(log) == ["sensor_force_n", "length_m", "speed_m_per_s"]
    assert log.sensor_force_n[:3, 0].tolist() == [20.0, 30.0, 40.0]
    assert np.allclose(log.speed_m_per_s, 1.0)
    with pytest.raises(fric.LogError, match="has no column `winch.force_n`"):
        robot.log.columns = None
        fric.read_log(path, robot)
