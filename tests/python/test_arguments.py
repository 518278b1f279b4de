"""Arguments of wrong classes and values: an error of fric that names the argument, from every public function."""

import copy

import fric
import numpy as np
import pytest
from fric import continuum
from support import ARM, BENCH, LOG


class Odd:
    """Of no class that any function takes."""


@pytest.fixture(scope="module")
def calls():
    """Public functions with arguments that they take, by name."""
    robot, arm = fric.Robot.from_toml(BENCH.replace("0.001", "0.004")), continuum.Manipulator.read(ARM)
    log = fric.simulate(robot, duration_s=20.0)
    run = continuum.TendonRun.from_arrays(arm, time_s=np.arange(30) * 0.1, tension_base_n=np.linspace(0.0, 1.0, 30))
    model, compensator = continuum.StaticModel(arm), fric.Compensator(robot)
    arrays = {"sensor_force_n": np.full((5, 1), 15.0), "length_m": np.zeros((5, 1)), "speed_m_per_s": np.zeros((5, 1))}
    cycle = {name: array[0] for name, array in arrays.items()}
    noises = ("sensor_noise_n", "mu_spread_ratio", "sensor_wander_n", "wander_s", "hand_n", "length_noise_m")
    result, fitted, shapes = fric.replay(robot, log), fric.fit(robot, log), continuum.shape(arm, run)
    seen = {"log": log, "result": result, "cable": "winch", "ax": None}
    found = {"result": fric.discover(robot, log), "cable": "winch", "ax": None}
    text = {"box_m": None, "max_speed_m_per_s": None, "for_": None, "separate": None, "determine": None, "cables": None, "output": None}
    return {
        "fit": (fric.fit, {"robot": robot, "log": log, "reference": "forces", "parameters": ["mu"], "per_log": None, "huber": False}),
        "discover": (fric.discover, {"robot": robot, "log": log, "reference": "forces", "per_log": None, "empirical": True}),
        "excite": (fric.excite, {"robot": robot, **text, "force": False}),
        "read_log": (fric.read_log, {"paths": LOG, "robot": None}),
        "replay": (fric.replay, {"robot": robot, "log": log, "output": None, "force": False, "correct": False}),
        "hysteresis": (fric.hysteresis, {"robot": robot, "log": log}),
        "residual_function": (fric.residual_function, {"robot": robot, "log": log, "cable": "winch", "parameters": None}),
        "simulate": (
            fric.simulate,
            {"robot": robot, "run": "identification", "seed": 0, "duration_s": 0.1, "effects": (), "disturbances": ()}
            | dict.fromkeys(noises, 0.1),
        ),
        "Robot.read": (fric.Robot.read, {"path": "x.toml"}),
        "Robot.from_toml": (fric.Robot.from_toml, {"text": BENCH}),
        "Robot.cable": (robot.cable, {"name": "winch"}),
        "Compensator": (fric.Compensator, {"robot": robot}),
        "Compensator.step": (compensator.step, {**cycle, "elapsed_cycles": 1.0}),
        "Compensator.run": (compensator.run, arrays),
        "Compensator.restore": (compensator.restore, {"snapshot": compensator.snapshot()}),
        "Compensator.pulley_friction_n": (compensator.pulley_friction_n, {"cable": "winch"}),
        "Log.from_arrays": (fric.Log.from_arrays, {"cable_names": ["winch"], "stamp_nanos": np.arange(5), **arrays}),
        "Manipulator.read": (continuum.Manipulator.read, {"path": "x.toml"}),
        "TendonRun.from_arrays": (continuum.TendonRun.from_arrays, {"manipulator": arm, "time_s": [0.0, 1.0], "tension_base_n": [0.0, 1.0]}),
        "StaticModel": (
            continuum.StaticModel,
            {"manipulator": arm, "least_tension_n": (0.0, 0.0), "greatest_tension_n": None, "hold_rad": 0.0},
        ),
        "StaticModel.solve": (model.solve, {"base_tension_n": 0.3, "friction": "history"}),
        "StaticModel.tension_for": (model.tension_for, {"bend_rad": 0.3, "friction": "history"}),
        "continuum.calibrate": (continuum.calibrate, {"manipulator": arm, "load_n": [1.0, 2.0], "shift_nm": np.ones((2, 8))}),
        "continuum.discover": (continuum.discover, {"manipulator": arm, "run": run}),
        "continuum.fit": (continuum.fit, {"manipulator": arm, "runs": run, "parameters": ["mu"]}),
        "continuum.friction": (continuum.friction, {"manipulator": arm, "run": run}),
        "continuum.read_run": (continuum.read_run, {"path": "x.csv", "manipulator": arm}),
        "continuum.read_loads": (continuum.read_loads, {"path": "x.csv", "manipulator": arm}),
        "continuum.shape": (continuum.shape, {"manipulator": arm, "run": run, "shapes": 2, "at_s": None, "mixed": False, "ways": None}),
        "continuum.simulate": (continuum.simulate, {"manipulator": arm, "run": "one_way", "seed": 0, "greatest_tension_n": 1.0}),
        "continuum.track": (continuum.track, {"manipulator": arm, "bend_rad": [0.1], "seed": 0, "mu_spread_ratio": 0.1}),
        "plot.forces": (fric.plot.forces, seen),
        "plot.friction_loop": (fric.plot.friction_loop, seen),
        "plot.residuals": (fric.plot.residuals, {**seen, "lag_count": 100}),
        "plot.parameters": (fric.plot.parameters, {"fit_result": fitted, "ax": None}),
        "plot.gap_ladder": (fric.plot.gap_ladder, found),
        "plot.where": (fric.plot.where, found),
        "plot.candidates": (fric.plot.candidates, found),
        "plot.tendon_shape": (fric.plot.tendon_shape, {"result": shapes, "place": 0, "ax": None}),
        "plot.tendon_friction": (fric.plot.tendon_friction, {"result": shapes, "place": 0, "ax": None}),
        "FitResult.cable": (fitted.cable, {"name": "winch"}),
        "ShapeResult.bend_rad": (shapes.bend_rad, {"way": "history"}),
        "fleet.run": (fric.fleet.run, {"operation": "fit", "paths": ["x"], "results": "y", "model": None, "workers": None}),
    }


def test_each_argument_of_another_class_is_named(calls):
    for name, (function, arguments) in calls.items():
        for argument in arguments:
            with pytest.raises(fric.FricError, match=rf"(?s)`{argument}`.* of class Odd|`{argument}` must be .*; what came is"):
                function(**{**arguments, argument: Odd()})
                pytest.fail(f"{name} takes an Odd as {argument}")


@pytest.mark.parametrize(
    ("name", "argument", "value", "told"),
    [
        ("fit", "parameters", "mu", "must be a list of texts, or None; what came is 'mu' (str)"),
        ("fit", "log", 5, "must be a Log, a path, or a list of them; what came is 5 (int)"),
        ("simulate", "seed", -1, "must be a whole number of 0 or more; what came is -1 (int)"),
        ("simulate", "duration_s", 10**400, "must be a number, or None; what came is of class int"),
        ("simulate", "effects", "stribeck:ratio=0.5", "must be a list of dicts or texts; what came is 'stribeck:ratio=0.5' (str)"),
        ("excite", "box_m", [[0, 0, 0], [1, 1]], "must be two corners of three numbers each, or None; what came is [[0, 0, 0], [1, 1]] (list)"),
        ("Robot.read", "path", 5, "must be a path; what came is 5 (int)"),
        ("Robot.from_toml", "text", "\ud800", "must be a text; what came is '\\ud800' (str)"),
        ("Compensator", "robot", "x.toml", "must be a Robot; what came is 'x.toml' (str)"),
        ("StaticModel", "least_tension_n", (1.0,), "must be two numbers, or None; what came is (1.0,) (tuple)"),
        ("continuum.shape", "shapes", -1, "must be a whole number of 0 or more; what came is -1 (int)"),
        ("plot.forces", "result", None, "must be a ReplayResult or a Compensation; what came is None (NoneType)"),
        ("plot.residuals", "ax", 5, "must be 2 axes of matplotlib; what came is 5 (int)"),
        ("fleet.run", "paths", [5], "must be a path or a list of paths; what came is 5 (int)"),
    ],
)
def test_the_error_says_what_an_argument_must_be(calls, name, argument, value, told):
    function, arguments = calls[name]
    with pytest.raises(fric.ArgumentTypeError) as caught:
        function(**{**arguments, argument: value})
    assert str(caught.value) == f"`{argument}` {told}"
    assert isinstance(caught.value, (TypeError, ValueError)) and str(copy.copy(caught.value)) == str(caught.value)


def test_questions_of_a_run_are_named_too(calls):
    function, arguments = calls["excite"]
    with pytest.raises(fric.ConfigError, match="`for_`: it is not what `discover --json` writes"):
        function(**{**arguments, "for_": "{}"})
    with pytest.raises(fric.ConfigError, match="`separate`: name the two effects"):
        function(**{**arguments, "separate": []})


def test_one_of_a_kind_is_told_as_one(calls):
    _, arguments = calls["replay"]
    robot, log = arguments["robot"], arguments["log"]
    compensator = fric.Compensator(robot)
    assert repr(robot) == '<Robot "bench": 1 cable, cycle 0.004 s>'
    assert repr(log[:0.004]) == "<Log: 1 row, cable winch>" and "<p>1 row, " in log[:0.004]._repr_html_()
    assert repr(compensator) == '<Compensator of "bench": cable winch>' and repr(compensator.snapshot()) == "<Snapshot: 1 cable>"
