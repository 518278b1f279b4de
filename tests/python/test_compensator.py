"""The control loop's cycle from Python."""

import copy
import threading
import time

import fric
import numpy as np
import pytest
from support import ROBOT


@pytest.fixture(scope="module")
def robot():
    return fric.Robot.read(ROBOT)


@pytest.fixture(scope="module")
def log(robot):
    return fric.simulate(robot, duration_s=3.0, seed=11)


def signals(log, rows=slice(None)):
    return log.sensor_force_n[rows], log.length_m[rows], log.speed_m_per_s[rows]


def pose(log, rows=slice(None)):
    return {"position_m": log.position_m[rows], "orientation_xyzw": log.orientation_xyzw[rows]}


def assert_same(one, other):
    for name in ["force_at_platform_n", "friction_n", "frictionless_n", "status", "outside_wrench"]:
        assert np.array_equal(getattr(one, name), getattr(other, name)), name


def test_steps_are_a_run_and_a_run_is_a_replay(robot, log):
    run = fric.Compensator(robot).run(*signals(log), **pose(log))
    assert run.status.dtype == np.uint32 and run.outside_wrench.shape == (3000, 6)
    stepped = fric.Compensator(robot)
    for row in range(0, 700):
        cycle = stepped.step(*signals(log, row), **pose(log, row))
        assert np.array_equal(cycle.force_at_platform_n, run.force_at_platform_n[row])
        assert np.array_equal(cycle.outside_wrench, run.outside_wrench[row])
    assert_same(run, fric.replay(robot, log))


def test_a_run_can_be_cut_anywhere(robot, log):
    whole = fric.Compensator(robot).run(*signals(log), **pose(log))
    compensator = fric.Compensator(robot)
    cuts = [slice(0, 1), slice(1, 1700), slice(1700, None)]
    parts = [compensator.run(*signals(log, rows), **pose(log, rows)) for rows in cuts]
    assert np.array_equal(np.concatenate([part.friction_n for part in parts]), whole.friction_n)
    empty = compensator.run(*(np.empty((0, 8)),) * 3)
    assert empty.friction_n.shape == (0, 8) and empty.outside_wrench is None


def test_state_can_be_reset_and_restored(robot, log):
    compensator = fric.Compensator(robot)
    first = compensator.run(*signals(log), **pose(log))
    snapshot, friction_n = compensator.snapshot(), compensator.pulley_friction_n("cable1")
    assert friction_n.shape == (3,) and np.all(friction_n != 0)
    again = compensator.run(*signals(log), **pose(log))
    assert not np.array_equal(first.friction_n, again.friction_n)
    compensator.restore(snapshot)
    assert np.array_equal(compensator.pulley_friction_n("cable1"), friction_n)
    assert_same(compensator.run(*signals(log), **pose(log)), again)
    compensator.reset()
    assert_same(compensator.run(*signals(log), **pose(log)), first)
    with pytest.raises(fric.ConfigError, match="unknown cable `cable9`"):
        compensator.pulley_friction_n("cable9")
    head = 'format = "fric-robot/1"\nname = "bench"\ncycle_s = 0.001\n'
    bench = fric.Robot.from_toml(head + '[[cable]]\nname = "winch"\npulleys = [{ wrap_deg = 90.0 }]')
    with pytest.raises(fric.ShapeError, match="the snapshot is of a robot with 8 cables, this one has 1"):
        fric.Compensator(bench).restore(snapshot)


def test_trouble_is_flagged_by_name_and_stays_with_its_cable(robot, log):
    sensor, length, speed = (array.copy() for array in signals(log))
    sensor[1000:1010, 2] = np.nan
    length[2000, 5] = np.inf
    good = fric.Compensator(robot).run(*signals(log), **pose(log))
    bad = fric.Compensator(robot).run(sensor, length, speed, **pose(log))
    Status = fric.Status
    assert {Status(int(bits)) for bits in bad.status[1000:1010, 2]} == {Status.SENSOR_NOT_FINITE}
    assert Status.MOTION_NOT_FINITE in Status(int(bad.status[2000, 5]))
    others = [0, 1, 3, 4, 6, 7]
    assert np.array_equal(bad.force_at_platform_n[:, others], good.force_at_platform_n[:, others])
    assert np.all(np.isfinite(bad.force_at_platform_n))
    without = fric.Compensator(robot).step(*signals(log, 0))
    assert without.outside_wrench is None and Status(int(without.status[0])) == Status.POSE_MISSING


def test_skipped_cycles_allow_a_longer_way(robot):
    far = [np.full(8, length_m) for length_m in (0.5, 0.53)]
    for elapsed_cycles, expected in [(1.0, fric.Status.LENGTH_JUMP), (4.0, fric.Status(0))]:
        compensator = fric.Compensator(robot)
        for length_m in far:
            cycle = compensator.step(
                np.full(8, 9.0),
                length_m,
                np.zeros(8),
                position_m=[0, 0, 0],
                orientation_xyzw=[0, 0, 0, 1],
                elapsed_cycles=elapsed_cycles,
            )
        assert fric.Status(int(cycle.status[0])) == expected
        run = fric.Compensator(robot).run(
            np.full((2, 8), 9.0), np.stack(far), np.zeros((2, 8)), elapsed_cycles=[1.0, elapsed_cycles]
        )
        assert (fric.Status.LENGTH_JUMP in fric.Status(int(run.status[1, 0]))) == (expected != 0)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (
            {"sensor_force_n": np.zeros((3, 7))},
            "`sensor_force_n` must be real numbers (float64) of shape (N, 8), one number per cable; "
            "what came is float64 of shape (3, 7)",
        ),
        ({"length_m": np.zeros((2, 8))}, "`length_m` must be real numbers (float64) of shape (3, 8)"),
        ({"speed_m_per_s": np.zeros(8)}, "what came is float64 of shape (8,)"),
        ({"length_m": np.zeros((3, 8), complex)}, "what came is complex128 of shape (3, 8)"),
        ({"length_m": np.full((3, 8), "a")}, "what came is <U1 of shape (3, 8)"),
        ({"length_m": np.full((3, 8), True)}, "what came is bool of shape (3, 8)"),
        ({"length_m": [[1.0], [1.0, 2.0]]}, "what came is no array"),
        ({"position_m": np.zeros((3, 3))}, "give both or neither"),
        (
            {"position_m": np.zeros((3, 3)), "orientation_xyzw": np.zeros((3, 3))},
            "`orientation_xyzw` must be real numbers (float64) of shape (3, 4)",
        ),
        ({"elapsed_cycles": [1.0, np.nan, 1.0]}, "`elapsed_cycles` is not finite in row 1"),
        ({"elapsed_cycles": [1.0]}, "`elapsed_cycles` must be real numbers (float64) of shape (3,)"),
    ],
)
def test_arrays_that_do_not_fit_are_told(robot, change, told):
    zeros = np.zeros((3, 8))
    arguments = {"sensor_force_n": zeros, "length_m": zeros, "speed_m_per_s": zeros} | change
    with pytest.raises(fric.ShapeError) as raised:
        fric.Compensator(robot).run(**arguments)
    assert told in str(raised.value) and isinstance(raised.value, ValueError)


def test_arrays_of_any_layout_and_real_type_are_taken(robot, log):
    expected = fric.Compensator(robot).run(*signals(log))
    fortran = [np.asfortranarray(array) for array in signals(log)]
    doubled = [np.repeat(array, 2, axis=0)[::2] for array in signals(log)]
    for arrays in (fortran, doubled, [array.tolist() for array in signals(log)]):
        assert_same(fric.Compensator(robot).run(*arrays), expected)
    whole = np.round(log.sensor_force_n).astype(np.int16)
    of_integers, of_floats = (
        fric.Compensator(robot).run(sensor, *signals(log)[1:]) for sensor in (whole, whole.astype(float))
    )
    assert_same(of_integers, of_floats)


def test_other_threads_run_meanwhile(robot, log):
    arrays = [np.tile(array, (60, 1)) for array in signals(log)]
    running, counts = threading.Event(), [0]

    def count():
        running.set()
        while running.is_set():
            counts[0] += 1
            time.sleep(0)

    counter = threading.Thread(target=count)
    counter.start()
    running.wait()
    inside = []
    fric.Compensator(robot).run(*arrays, progress=lambda fraction: inside.append(counts[0]))
    running.clear()
    counter.join()
    # The count goes on between calls of the bar, while the cycles run.
    assert len(inside) > 10 and inside[-1] > inside[0] + 100


def test_one_call_at_a_time_uses_a_compensator(robot, log):
    compensator = fric.Compensator(robot)
    arrays = [log.sensor_force_n, log.length_m, log.speed_m_per_s]
    told = "another call uses this Compensator at the same time; give each thread a copy of its own"
    calls = [
        lambda: compensator.step(*(array[0] for array in arrays)),
        lambda: compensator.run(*arrays),
        compensator.reset,
        compensator.snapshot,
        lambda: compensator.pulley_friction_n("cable1"),
        lambda: copy.copy(compensator),
    ]
    errors = []

    def disturb(_):
        while len(errors) < len(calls):
            with pytest.raises(fric.InUseError, match=told):
                calls[len(errors)]()
            errors.append(None)

    whole = compensator.run(*arrays, progress=disturb)
    assert len(errors) == len(calls) and issubclass(fric.InUseError, (fric.FricError, RuntimeError))
    assert fric.Compensator(robot).run(*arrays) == whole and compensator == compensator
    assert len(compensator.run(*arrays).friction_n) == len(log)


def test_progress_is_told_and_what_it_raises_ends_the_run(robot, log, capsys):
    compensator, arrays = fric.Compensator(robot), [np.tile(array, (10, 1)) for array in signals(log)]
    fractions = []
    first = compensator.run(*arrays, progress=fractions.append)
    assert fractions[0] == 0.0 and fractions[-1] == 1.0 and fractions == sorted(fractions) and len(fractions) > 5
    compensator.reset()

    def stop(fraction):
        if fraction > 0.5:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        compensator.run(*arrays, progress=stop)
    assert_same(compensator.run(*arrays, progress=False), first)
    compensator.run(*arrays, progress=True)
    drawn = capsys.readouterr()
    assert drawn.out == "" and drawn.err.endswith(" 100%\n")


def test_a_compensator_keeps_the_robot_it_was_built_for(log):
    robot = fric.Robot.read(ROBOT)
    compensator = fric.Compensator(robot)
    robot.cable("cable1").friction.mu = 0.5
    assert_same(compensator.run(*signals(log)), fric.Compensator(fric.Robot.read(ROBOT)).run(*signals(log)))
