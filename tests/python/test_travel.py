"""Objects travel: pickled, copied, sent to other processes, each public class of the package."""

import copy
import enum
import inspect
import json
import pickle
import subprocess
import sys

import fric
import numpy as np
import pyarrow
import pytest
from fric import continuum, fleet
from support import BENCH, HANG_S, ROOT, SLOW_BENCH

ARM = ROOT / "examples" / "tendon-prototype.toml"


NAMED = {"parameter": "found.stribeck", "state": "found", "value": 1.0, "start": 10**18, "operation": "discover"}


def public_classes():
    """By their names, wherever in the package they stand; protocols are of no objects."""
    modules = [fric, *(getattr(fric, name) for name in fric.__all__ if inspect.ismodule(getattr(fric, name)))]
    found = {name: getattr(module, name) for module in modules for name in module.__all__}
    return {name: one for name, one in found.items() if inspect.isclass(one) and not getattr(one, "_is_protocol", False)}


@pytest.fixture(scope="module")
def examples():
    """An object of each class, by its name."""
    robot = fric.Robot.from_toml(SLOW_BENCH)
    log = fric.simulate(robot, duration_s=20.0, effects=["sensor_gain:gain=1.05"])
    compensator = fric.Compensator(robot)
    first = compensator.run(log.sensor_force_n[:900], log.length_m[:900], log.speed_m_per_s[:900])
    fitted, found, replayed = fric.fit(robot, log), fric.discover(robot, log), fric.replay(robot, log)
    platform = fric.Robot.read(ROOT / "examples" / "mini-ipanema.toml")
    crossing = fric.hysteresis(platform, fric.simulate(platform, run="crossing", duration_s=20.0))
    arm = continuum.Manipulator.read(ARM)
    tendon = continuum.simulate(arm, run="mixed", seed=5)
    calibration = continuum.calibrate(arm, tendon.load_n, tendon.load_shift_nm)
    calibrated, angle_rad = calibration.manipulator, np.full(4, 1.0)
    model = continuum.StaticModel(arm, greatest_tension_n=[3.0, 0.0], hold_rad=0.001)
    shapes = model.run([0.5, 0.7, 0.6])
    failure = fleet.LogFailure("run.mcap", "run.mcap is no MCAP file")
    steps = {"start": np.arange(20) * 10**15 + 10**18, "value": np.repeat([0.02, 0.03], 10) + 1e-5 * np.sin(np.arange(20.0))}
    changed = fleet.trend(pyarrow.table({**{name: ["a"] * 20 for name in ("robot", "cable", "parameter")}, **steps}))
    named = fleet.trend(pyarrow.table({name: [one] for name, one in {**dict.fromkeys(("robot", "cable"), "a"), **NAMED}.items()}))
    objects = [
        robot,
        robot.platform,
        robot.monitor,
        robot.log,
        robot.cable("winch"),
        robot.cable("winch").friction,
        log,
        compensator,
        compensator.snapshot(),
        first,
        fitted,
        fitted.cables[0],
        found,
        found.cables[0],
        replayed,
        replayed.cables[0],
        replayed.cables[0].after,
        fric.replay(platform, fric.simulate(platform, duration_s=1.0)).wrench[0],
        fric.ComputedPoses("lengths", 9, 1, None),
        crossing,
        crossing.axes[0],
        crossing.axes[0].without,
        fric.residual_function(robot, log, "winch"),
        fric.excite(robot),
        fric.Status.SLACK | fric.Status.UNSETTLED,
        arm,
        tendon,
        tendon.run,
        calibration,
        model,
        model.snapshot(),
        shapes,
        model.tension_for(bend_rad=0.5),
        continuum.ShapeStatus.UNSTABLE | continuum.ShapeStatus.OVER_CAPACITY,
        continuum.GoalStatus.REVERSAL | continuum.GoalStatus.DEAD_BAND,
        continuum.friction(calibrated, tendon.run),
        continuum.hole(np.linspace(0.5, 2.0, 4), np.linspace(0.5, 2.0, 4) * 0.9, angle_rad, angle_rad),
        continuum.shape(calibrated, tendon.run, mixed=True, shapes=2),
        continuum.discover(calibrated, tendon.run),
        continuum.track(arm, bend_rad=[0.3, 0.2]),
        continuum.fit(calibrated, tendon.run, parameters=["mu"]),
        fleet.FleetRun("fit", "results", 1, 0, 0, (failure,)),
        failure,
        changed,
        changed.series[0],
        changed.alarms[0],
        changed.alarms[0].changes[0],
        named.named[0],
    ]
    errors = [value("what is wrong") for value in public_classes().values() if issubclass(value, Exception)]
    return {type(one).__name__: one for one in [*objects, *errors]}


def same(one, other):
    if isinstance(one, Warning):
        return type(one) is type(other) and (one.args, str(one)) == (other.args, str(other))
    return type(one) is type(other) and one == other and not one != other


def test_the_classes_are_found():
    classes = public_classes()
    assert {"Robot", "Log", "Compensator", "FitResult", "TendonRun", "Status", "FricError"} <= set(classes)
    assert "FittedCable" not in classes


@pytest.mark.parametrize("name", sorted(public_classes()))
def test_each_public_class_travels(name, examples):
    assert name in examples, f"the test has no example of {name}; give it one"
    one = examples[name]
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        assert same(pickle.loads(pickle.dumps(one, protocol)), one)
    for other in [copy.copy(one), copy.deepcopy(one)]:
        assert same(other, one) and type(one).__module__ == type(other).__module__
    if isinstance(one, (BaseException, enum.Enum)):
        return
    assert one != "another" and repr(pickle.loads(pickle.dumps(one))) == repr(one)
    with pytest.raises(TypeError, match="unhashable"):
        hash(one)


# What a notebook shows by its `repr`: states, functions, flags, and what a file tells better.
WITHOUT_A_TABLE = {"Compensator", "Manipulator", "ResidualFunction", "Snapshot", "StaticModel", "StaticSnapshot", "TendonRun"}


@pytest.mark.parametrize("name", sorted(public_classes()))
def test_what_tells_values_is_a_table_in_a_notebook(name, examples):
    one = examples[name]
    if isinstance(one, (BaseException, enum.Enum)) or name in WITHOUT_A_TABLE:
        assert not hasattr(one, "_repr_html_")
        return
    page = one._repr_html_()
    assert "<table>" in page and page.count("<tr>") == page.count("</tr>") > 0


def test_texts_of_a_file_are_escaped_in_a_table():
    robot = fric.Robot.from_toml(BENCH.replace("winch", "<b>"))
    for one in (robot, robot.cables[0], fleet.LogFailure("<b>", "<b>")):
        assert "&lt;b&gt;" in one._repr_html_() and "<b>" not in one._repr_html_()


@pytest.mark.parametrize("made", [copy.copy, copy.deepcopy])
def test_a_copy_of_a_table_belongs_to_another_robot(made):
    robot = fric.Robot.from_toml(BENCH)
    cable, friction = made(robot.cable("winch")), made(robot.cable("winch").friction)
    robot.cable("winch").friction.mu = 0.07
    assert cable.friction.mu == friction.mu != 0.07
    friction.mu = 0.08
    assert robot.cable("winch").friction.mu == 0.07


def test_values_that_differ_are_not_equal(examples):
    robot = fric.Robot.from_toml(BENCH)
    assert robot != examples["Robot"] and robot.cable("winch") == fric.Robot.from_toml(BENCH).cable("winch")
    robot.cable("winch").friction.mu = 0.03
    assert robot.cable("winch").friction != fric.Robot.from_toml(BENCH).cable("winch").friction
    longer = fric.simulate(examples["Robot"], duration_s=20.004, effects=["sensor_gain:gain=1.05"])
    assert longer != examples["Log"] and fric.replay(examples["Robot"], longer) != examples["ReplayResult"]
    assert fric.replay(examples["Robot"], examples["Log"]) == examples["ReplayResult"]
    assert fric.ForceError(1.0, float("nan")) == fric.ForceError(1.0, float("nan")) != fric.ForceError(1.0, 2.0)


def test_a_pickled_compensator_goes_on_with_the_same_bits():
    # Every effect that remembers something, a delay, pulleys of both forms, and a pose.
    robot = fric.Robot.read(ROOT / "examples" / "mini-ipanema.toml")
    cable = robot.cable("cable1")
    cable.set(effects=[{"kind": "time_delay", "delay_s": 0.0042}, {"kind": "stribeck", "ratio": 0.5}, {"kind": "pulley_inertia"}])
    robot.cable("cable2").presliding = "lumped"
    log = fric.simulate(fric.Robot.read(ROOT / "examples" / "mini-ipanema.toml"), duration_s=3.0)

    def run(compensator, rows):
        poses = {"position_m": log.position_m[rows], "orientation_xyzw": log.orientation_xyzw[rows]}
        return compensator.run(log.sensor_force_n[rows], log.length_m[rows], log.speed_m_per_s[rows], **poses)

    compensator = fric.Compensator(robot)
    run(compensator, slice(0, 1500))
    others = [pickle.loads(pickle.dumps(compensator)), copy.copy(compensator), copy.deepcopy(compensator)]
    snapshot = pickle.loads(pickle.dumps(compensator.snapshot()))
    # What is changed in the robot later does not reach it, nor its copies.
    robot.cable("cable1").friction.mu = 0.5
    assert compensator != fric.Compensator(robot)
    expected = run(compensator, slice(1500, 3000))
    fresh = fric.Compensator(fric.Robot.read(ROOT / "examples" / "mini-ipanema.toml"))
    assert run(fresh, slice(1500, 3000)) != expected
    for other in others:
        assert other != compensator and run(other, slice(1500, 3000)) == expected and other == compensator
    compensator.restore(snapshot)
    assert run(compensator, slice(1500, 3000)) == expected


def test_a_pickled_residual_function_is_the_same_function(examples):
    function = examples["ResidualFunction"]
    other = pickle.loads(pickle.dumps(function))
    x = 1.1 * function.x0
    assert np.array_equal(other(x), function(x)) and np.array_equal(other.jac(x), function.jac(x))
    assert np.array_equal(other.bounds, function.bounds) and np.array_equal(other.rows, function.rows)


def test_arrays_that_cannot_be_written_to_stay_so(examples):
    arrays = [pickle.loads(pickle.dumps(examples["Log"])).length_m, copy.deepcopy(examples["FitResult"]).cables[0].covariance]
    for array in [*arrays, examples["Compensation"].friction_n]:
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


def test_lists_and_dicts_of_results_are_read_only(examples):
    for result in (examples["FitResult"], pickle.loads(pickle.dumps(examples["FitResult"])), copy.deepcopy(examples["FitResult"])):
        cable = result.cables[0]
        for change in (
            lambda cable: cable.values.update(mu=1.0),
            lambda cable: cable.values.__setitem__("mu", 1.0),
            lambda cable: cable.values.pop("mu"),
            lambda cable: cable.left_out.__delitem__("flagged"),
            lambda cable: cable.undetermined.append("mu"),
        ):
            with pytest.raises(TypeError, match=r"is read-only; change a copy"):
                change(cable)
        own = dict(cable.values)
        own["mu"] = 1.0
        assert own != cable.values == dict(cable.values) and json.loads(json.dumps(cable.values)) == cable.values
        assert cable.values.copy() == cable.values and type(cable.values.copy()) is dict and list(cable.undetermined) == cable.undetermined
    with pytest.raises(TypeError, match="read-only"):
        examples["DiscoverResult"].cables[0].effects[0]["parameters"]["gain"] = 1.0


def test_states_of_another_version_are_refused(examples):
    pickled = pickle.dumps(examples["Snapshot"], protocol=2)
    version = fric.__version__.encode()
    assert version in pickled
    with pytest.raises(fric.ConfigError, match=f"the pickle is of fric .*, this is {fric.__version__}"):
        pickle.loads(pickled.replace(version, version[:-1] + b"9"))


# Paths are relative, and the children work elsewhere.
PROCESSES = """
import concurrent.futures, multiprocessing, os, sys, tempfile
import fric
import joblib


def elsewhere():
    os.chdir(tempfile.mkdtemp())


def work(robot, log):
    elsewhere()
    return fric.replay(robot, log), fric.fit(robot, log)


if __name__ == "__main__":
    robot, log = fric.Robot.read("robot.toml"), fric.read_log("log.mcap")
    expected = fric.replay(robot, log), fric.fit(robot, log)
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context, initializer=elsewhere) as pool:
        found = [task.result() for task in [pool.submit(work, robot, log) for _ in range(2)]]
    assert found == [expected] * 2
    found = joblib.Parallel(n_jobs=2)(joblib.delayed(work)(robot, log) for _ in range(2))
    assert found == [expected] * 2
    print("the same", expected[1].cables[0].values["mu"])
"""


def test_logs_and_results_go_to_processes_of_other_folders_and_back(tmp_path):
    (tmp_path / "script.py").write_text(PROCESSES, encoding="utf-8")
    (tmp_path / "robot.toml").write_text(SLOW_BENCH, encoding="utf-8")
    fric_cli = [sys.executable, "-m", "fric"]
    simulate = [*fric_cli, "simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "20"]
    assert subprocess.run(simulate, cwd=tmp_path, check=False).returncode == 0
    command = [sys.executable, "script.py"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=HANG_S, check=False)
    assert ended.returncode == 0 and ended.stdout.startswith("the same 0.0"), ended.stderr


SUB_INTERPRETER = """
try:
    import _interpreters as interpreters
except ImportError:
    import _xxsubinterpreters as interpreters
code = '''
try:
    import fric
except ImportError as error:
    with open({told!r}, "w") as file:
        file.write(str(error))
'''
run = getattr(interpreters, "exec", None) or interpreters.run_string
run(interpreters.create(), code)
"""


def test_sub_interpreters_are_refused_in_one_sentence(tmp_path):
    told = tmp_path / "told.txt"
    subprocess.run([sys.executable, "-c", SUB_INTERPRETER.format(told=str(told))], check=True, timeout=HANG_S)
    assert told.read_text().startswith("fric does not work in sub-interpreters")
