"""The static model in Python: the bits of the command line's shapes, goals that are reached, mistakes that are named."""

import copy
import pickle

import fric
import numpy as np
import pytest
from fric import continuum
from support import ROOT

ARM = ROOT / "examples" / "tendon-prototype.toml"
# Pulled and released by turns, N.
TIME = np.arange(120) * 0.1
TENSION_N = 0.8 + 0.5 * np.sin(0.9 * TIME) + 0.1 * np.sin(4.1 * TIME)
BENDS_RAD = np.array([0.3, 0.9, 0.88, 0.89, 0.5, 0.52, 1.4, 1.1, 0.2])


@pytest.fixture(scope="module")
def arm():
    return continuum.Manipulator.read(ARM)


@pytest.fixture
def model(arm):
    return continuum.StaticModel(arm)


def same(one, other):
    return np.array_equal(np.asarray(one).view(np.int64), np.asarray(other).view(np.int64))


def test_one_call_at_a_time_uses_a_model():
    model = continuum.StaticModel(continuum.Manipulator.read(ARM))
    errors = []

    def disturb(_):
        for call in (model.reset, lambda: model.solve(0.2), lambda: model.tension_for(bend_rad=0.1), lambda: model.follow(bend_rad=[0.1])):
            with pytest.raises(fric.InUseError, match="another call uses this StaticModel at the same time"):
                call()
            errors.append(None)

    model.run(np.linspace(0.0, 1.0, 30), progress=disturb)
    assert errors and model == model
    model.reset()


def test_a_run_has_the_bits_of_the_command_line_s_shapes(arm):
    # Pulled from slack first: under tension at its beginning, a run begins with a memory that the model alone does not have.
    time_s, tension_n = np.arange(140) * 0.1, np.concatenate([np.linspace(0.0, 0.78, 20), TENSION_N])
    expected = continuum.shape(arm, continuum.TendonRun.from_arrays(arm, time_s=time_s, tension_base_n=tension_n))
    for way, friction in [("history", "history"), ("none", "none"), ("coulomb", "pulling")]:
        # The other ways start their search from the last shape.
        shapes = continuum.StaticModel(arm).run(tension_n, friction=friction)
        assert shapes.is_new.all() and not shapes.status.any()
        assert same(shapes.disk_position_m, expected.disk_position_m(way))
        assert same(shapes.tension_n[:, 0], expected.tension_n(way))
        assert same(shapes.friction_n[:, 0], expected.friction_n(way))
        assert same(shapes.bend_rad, expected.bend_rad(way))
        assert not shapes.tension_n[:, 1].any() and shapes.bound_n.shape == (len(time_s), 2, 8)


def test_a_run_under_tension_begins_with_an_uncertain_memory(arm):
    run = continuum.TendonRun.from_arrays(arm, time_s=TIME, tension_base_n=TENSION_N)
    with pytest.warns(fric.LogWarning, match="begins at 0.80 N at the base"):
        result = continuum.shape(arm, run, ways=["history"]).to_dict()
    begin = result["ways"][0]["begin"]
    assert begin["source"] == "middle" and begin["tension_n"] == [TENSION_N[0]] * 8
    status = result["series"][0]["status"]
    assert status[: begin["uncertain_samples"]] == ["MEMORY_UNCERTAIN"] * begin["uncertain_samples"]
    assert set(status[begin["uncertain_samples"] :]) == {"ok"}


def test_steps_are_the_rows_of_a_run(arm, model):
    pairs_n = np.stack([TENSION_N, np.full(len(TIME), 0.1)], axis=1)
    whole = continuum.StaticModel(arm).run(pairs_n)
    shapes = [model.solve(pair_n) for pair_n in pairs_n[:30]]
    assert all(same(shape.disk_position_m, whole.disk_position_m[row]) for row, shape in enumerate(shapes))
    assert shapes[3].bend_rad.shape == () and f"{shapes[3].bend_rad:.2f}" == f"{float(whole.bend_rad[3]):.2f}"
    # Friction is the difference of the tensions on both sides of a hole.
    last = shapes[-1]
    before_n = np.concatenate([[pairs_n[29, 0]], last.tension_n[0, :-1]])
    assert np.allclose(last.friction_n[0], before_n - last.tension_n[0], rtol=0, atol=1e-15)
    assert np.isclose(last.segment_bend_rad.sum(), float(last.bend_rad), rtol=1e-15)
    # Slack, the second tendon is that of a number alone.
    assert same(continuum.StaticModel(arm).solve([0.7, 0.0]).tension_n, continuum.StaticModel(arm).solve(0.7).tension_n)


def test_measured_tensions_are_taken_as_they_are(model):
    tension_n = np.linspace(0.9, 0.7, 8)
    one = model.solve(0.95, friction="measured", tension_n=tension_n)
    both = model.solve(0.95, friction="measured", tension_n=np.stack([tension_n, np.zeros(8)]))
    assert same(one.tension_n[0], tension_n) and one == both
    rows = model.run(np.full(3, 0.95), friction="measured", tension_n=np.tile(tension_n, (3, 1)))
    assert same(rows.disk_position_m[2], one.disk_position_m)


def test_goals_are_reached_and_the_memory_moves_with_solve_alone(model):
    before = model.snapshot()
    command = model.tension_for(bend_rad=0.6)
    assert command.is_reached and model.snapshot() == before and command.base_tension_n[1] == 0.0
    shape = model.solve(command.base_tension_n)
    assert abs(shape.bend_rad - 0.6) < 1e-8 and abs(command.bend_rad - 0.6) < 1e-8
    assert np.allclose(shape.disk_position_m[-1], command.tip_m, rtol=0, atol=1e-8)
    back = model.tension_for(bend_rad=0.59)
    assert continuum.GoalStatus(int(back.status)) == continuum.GoalStatus.REVERSAL | continuum.GoalStatus.DEAD_BAND
    tip_m = shape.disk_position_m[-1]
    there = model.tension_for(tip_m=tip_m)
    assert there.is_reached and np.allclose(there.tip_m, tip_m, rtol=0, atol=1e-8)
    # Without friction less tension does.
    assert model.tension_for(bend_rad=0.9, friction="none").base_tension_n[0] < model.tension_for(bend_rad=0.9).base_tension_n[0]
    far = model.tension_for(bend_rad=9.0)
    assert not far.is_reached and continuum.GoalStatus.OUT_OF_REACH in continuum.GoalStatus(int(far.status))


def test_a_path_is_goals_one_after_the_other(arm, model):
    path = continuum.StaticModel(arm).follow(bend_rad=BENDS_RAD)
    for row, bend_rad in enumerate(BENDS_RAD):
        command = model.tension_for(bend_rad=bend_rad)
        assert same(command.base_tension_n, path.base_tension_n[row]) and command.status == path.status[row]
        model.solve(command.base_tension_n)
    assert path.is_reached.all() and np.allclose(path.bend_rad, BENDS_RAD, rtol=0, atol=1e-8)
    tips = continuum.StaticModel(arm).follow(tip_m=path.tip_m)
    assert np.allclose(tips.base_tension_n, path.base_tension_n, rtol=0, atol=1e-6)


def test_the_drive_limits_and_holds(arm):
    both = continuum.StaticModel(arm, least_tension_n=[0.1, 0.1], greatest_tension_n=(3.0, 3.0))
    command = both.tension_for(bend_rad=-0.5)
    assert command.is_reached and command.base_tension_n[0] == 0.1 < command.base_tension_n[1]
    held = continuum.StaticModel(arm, hold_rad=0.01)
    shape = held.solve(0.5)
    assert int(held.tension_for(bend_rad=float(shape.bend_rad) + 0.005).status) == continuum.GoalStatus.HELD
    weak = continuum.StaticModel(arm, greatest_tension_n=[0.3, 0.0])
    assert weak.tension_for(bend_rad=1.5).base_tension_n[0] == 0.3


def test_states_are_kept_restored_and_carried(arm, model):
    model.run(TENSION_N[:50])
    snapshot = model.snapshot()
    others = [pickle.loads(pickle.dumps(model)), copy.copy(model), copy.deepcopy(model)]
    expected = model.run(TENSION_N[50:])
    assert model != others[0] == others[1]
    for other in others:
        assert other.run(TENSION_N[50:]) == expected and other == model
    model.restore(pickle.loads(pickle.dumps(snapshot)))
    assert model.run(TENSION_N[50:]) == expected
    model.reset()
    fresh = continuum.StaticModel(arm)
    assert model == fresh and fresh.run(TENSION_N[50:]) != expected
    assert fresh != continuum.StaticModel(arm, hold_rad=0.01) and model.manipulator == arm
    shorter = continuum.Manipulator.from_toml(arm.to_toml().replace("disk_count = 8", "disk_count = 7"))
    with pytest.raises(fric.ShapeError, match="the state is of a manipulator with 8 disks, this one has 7"):
        continuum.StaticModel(shorter).restore(snapshot)


def test_what_is_not_finite_is_flagged_and_changes_nothing(model):
    shape = model.solve(0.5)
    before = model.snapshot()
    for value in [np.nan, np.inf, -0.1]:
        held = model.solve([value, 0.0])
        assert not held.is_new and continuum.ShapeStatus(int(held.status)) == continuum.ShapeStatus.NOT_FINITE
        assert same(held.disk_position_m, shape.disk_position_m)
    rows = model.run([0.5, np.nan, 0.5])
    assert rows.is_new.tolist() == [True, False, True] and np.isfinite(rows.disk_position_m).all()
    command = model.tension_for(tip_m=[np.nan, 0.0])
    assert int(command.status) == continuum.GoalStatus.NOT_USABLE and command.base_tension_n[0] == 0.5
    assert model.snapshot() == before
    nan = model.solve(0.5, friction="measured", tension_n=np.full(8, np.nan))
    assert not nan.is_new


def test_mistakes_are_named(arm, model):
    with pytest.raises(fric.ShapeError, match="`base_tension_n` must be .* of shape \\(2,\\)"):
        model.solve([0.5, 0.0, 0.1])
    with pytest.raises(fric.ShapeError, match="`base_tension_n` must be .* of shape \\(N, 2\\)"):
        model.run(np.zeros((3, 3)))
    with pytest.raises(fric.ArrayTypeError, match="`base_tension_n`"):
        model.solve("0.5")
    with pytest.raises(fric.ConfigError, match="friction.*histry.*did you mean `history`"):
        model.solve(0.5, friction="histry")
    with pytest.raises(fric.ShapeError, match="needs `tension_n`"):
        model.solve(0.5, friction="measured")
    with pytest.raises(fric.ShapeError, match="`tension_n` must be .* of shape \\(8,\\)"):
        model.solve(0.5, friction="measured", tension_n=np.zeros(7))
    with pytest.raises(fric.ShapeError, match="goes with friction=.measured. alone"):
        model.solve(0.5, tension_n=np.zeros(8))
    for goal in [{}, {"bend_rad": 0.1, "tip_m": [0.2, 0.1]}]:
        with pytest.raises(fric.ShapeError, match="a goal is `bend_rad` or `tip_m`"):
            model.tension_for(**goal)
    with pytest.raises(fric.ConfigError, match="friction"):
        model.tension_for(bend_rad=0.1, friction="measured")
    with pytest.raises(fric.ConfigError, match="`greatest_tension_n` of the tendon is 5; allowed is 0 to 4"):
        continuum.StaticModel(arm, greatest_tension_n=[5.0, 0.0])
    with pytest.raises(fric.ConfigError, match="`hold_rad` is NaN|`hold_rad` is nan"):
        continuum.StaticModel(arm, hold_rad=np.nan)


def test_the_flags_are_the_core_s():
    assert {flag.name: flag.value for flag in continuum.ShapeStatus} == fric._fric.SHAPE_STATUS_BITS
    assert {flag.name: flag.value for flag in continuum.GoalStatus} == fric._fric.GOAL_STATUS_BITS


def test_a_path_on_the_simulated_arm(arm):
    path = continuum.track(arm, bend_rad=BENDS_RAD, seed=4)
    assert path.ways == ["none", "coulomb", "history"]
    assert path.tip_m.shape == (3, len(BENDS_RAD), 2) and path.wanted_tip_m.shape == (len(BENDS_RAD), 2)
    error_m = np.linalg.norm(path.tip_m - path.wanted_tip_m, axis=2)
    assert np.allclose(error_m, path.error_m, rtol=0, atol=1e-15)
    none_rad, _, history_rad = np.abs(path.bend_rad - BENDS_RAD).mean(axis=1)
    assert history_rad < 0.1 * none_rad
    # The commands are those of a model that follows the path.
    commands = continuum.StaticModel(arm).follow(bend_rad=BENDS_RAD)
    assert same(commands.base_tension_n[:, 0], path.base_tension_n[2])
    assert np.array_equal(commands.status, path.status[2])
    again = continuum.track(arm, tip_m=path.wanted_tip_m, seed=4)
    assert (np.abs(again.along_m[2]) < 0.1 * np.abs(again.along_m[0])).mean() > 0.8
    with pytest.raises(fric.FricError, match=r"`tip_m` is nan in row 2|`tip_m` is NaN in row 2"):
        continuum.track(arm, tip_m=[[0.2, 0.1], [np.nan, 0.1]])
    with pytest.raises(fric.FricError, match=r"no bend of 9\.0000 rad \(goal 1\)"):
        continuum.track(arm, bend_rad=[9.0])
