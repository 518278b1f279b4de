"""Parts of logs by seconds, the signals of a log, and logs that are CSV."""

import json
import pickle

import fric
import numpy as np
import pytest
from support import BENCH, LOG, ROBOT, run

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
    # Python counts negative places from the end; a time before the first row would be the whole log.
    with pytest.raises(fric.ConfigError, match=r"0 or more, not by -1; its last second is log\[log.time_s\[-1\] - 1.0:\]"):
        log[-1:]
    for part in (slice(None, -0.5), slice(float("nan"), None)):
        with pytest.raises(fric.ConfigError, match="by seconds from its first row"):
            log[part]
    assert len(log[log.time_s[-1] - 1.0 :]) == 1001


def test_a_replay_of_a_slice_is_that_of_the_part(log, robot, tmp_path):
    result = fric.replay(robot, log[2.0:8.5])
    run("replay", LOG, "--start", "2", "--end", "8.5", "--json", tmp_path / "part.json")
    cables = json.loads((tmp_path / "part.json").read_text())["cables"]
    for cable, expected in zip(result.cables, cables, strict=True):
        assert (cable.samples, cable.after.rms_n) == (expected["samples"], expected["after"]["rms_n"])


def test_parts_of_a_log_are_runs_of_their_own(log, robot):
    result = fric.fit(robot, [log[:10.0], log[20.0:30.0]])
    assert result.cables[0].samples > 15_000
    with pytest.raises(fric.ConfigError, match="logs 1 and 2 of `log` are parts of one log that overlap"):
        fric.fit(robot, [log[:10.0], log[9.0:30.0]])


def test_samples_of_arrays_count_once(robot):
    log = fric.simulate(robot, duration_s=20.0)
    assert fric.fit(robot, [log[:10.0], log[10.0:]]).cables[0].samples > 5000
    again = pickle.loads(pickle.dumps(log))
    for call in (fric.fit, fric.discover):
        with pytest.raises(fric.ConfigError, match="logs 1 and 3 of `log` are parts of one log that overlap"):
            call(robot, [log[:6.0], log[6.0:12.0], log[5.0:]])
        for other in (log, again):
            with pytest.raises(fric.ConfigError, match="is given twice"):
                call(robot, [log, other])
    other = fric.simulate(robot, duration_s=20.0, seed=1)
    assert fric.fit(robot, [log, other]).cables[0].samples > 15_000


def test_a_log_without_rows_is_told_as_that(robot, log):
    empty = log[99:]
    assert len(empty) == 0
    for call in (fric.fit, fric.discover, fric.replay, fric.hysteresis):
        with pytest.raises(fric.LogError, match="the log has no rows: check its file, or the times by which it was cut"):
            call(robot, empty)
    none = fric.Log.from_arrays(cable_names=["winch"], stamp_nanos=[], sensor_force_n=np.zeros((0, 1)), length_m=np.zeros((0, 1)))
    assert len(none) == 0 and "0 rows" in none._repr_html_()


def test_dates_of_numpy_are_stamps():
    stamp_nanos = np.arange(3) * 10**6 + 1_700_000_000 * 10**9
    arrays = {"cable_names": ["winch"], "sensor_force_n": np.full((3, 1), 20.0), "length_m": np.zeros((3, 1))}
    log = fric.Log.from_arrays(stamp_nanos=stamp_nanos, **arrays)
    for dates in (stamp_nanos.astype("datetime64[ns]"), stamp_nanos.astype("datetime64[ns]").astype("datetime64[us]")):
        assert fric.Log.from_arrays(stamp_nanos=dates, **arrays) == log
    dates[1] = "NaT"
    with pytest.raises(fric.ShapeError, match="`stamp_nanos` has a date that is missing"):
        fric.Log.from_arrays(stamp_nanos=dates, **arrays)
    with pytest.raises(fric.ShapeError, match="or datetime64; what came is timedelta64"):
        fric.Log.from_arrays(stamp_nanos=stamp_nanos.astype("timedelta64[ns]"), **arrays)


@pytest.mark.parametrize("milliseconds", [1, 1000])
def test_stamps_in_another_unit_are_told(milliseconds):
    robot = fric.Robot.from_toml(BENCH)
    log = fric.simulate(robot, duration_s=20.0)
    names = ("cable_names", "sensor_force_n", "length_m", "speed_m_per_s", "reference_force_n")
    arrays = {name: getattr(log, name) for name in names}
    fric.replay(robot, fric.Log.from_arrays(stamp_nanos=log.stamp_nanos, **arrays))
    odd = fric.Log.from_arrays(stamp_nanos=np.arange(len(log)) * milliseconds, **arrays)
    for call in (fric.replay, fric.fit):
        with pytest.warns(fric.LogWarning, match="signal comes every .*, but `cycle_s` .* another unit than seconds"):
            call(robot, odd)


def test_a_number_that_overflows_errors_is_told():
    robot = fric.Robot.from_toml(BENCH)
    log = fric.simulate(robot, duration_s=2.0)
    reference_force_n = log.reference_force_n.copy()
    reference_force_n[500] = 1e300
    names = ("cable_names", "stamp_nanos", "sensor_force_n", "length_m", "speed_m_per_s")
    with pytest.warns(fric.LogWarning, match="`reference_force_n` of winch is 1e300 in row 500, which no cable has"):
        odd = fric.Log.from_arrays(reference_force_n=reference_force_n, **{name: getattr(log, name) for name in names})
    with pytest.warns(fric.LogWarning, match="times the reference"):
        cable = fric.replay(robot, odd).cables[0]
    assert cable.before.rms_n == cable.after.rms_n == np.inf



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
