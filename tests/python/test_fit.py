"""Fits from Python, by the command line, and by other people's optimisers: the same numbers."""

import json
import subprocess
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import fric
import lmfit
import numpy as np
import pytest
from scipy.optimize import least_squares
from support import BENCH, PRESS_SOON, PROGRAM, ROBOT, printed, run, without_origin


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A robot of eight cables at a lower rate than the example's, and logs of it."""
    place = tmp_path_factory.mktemp("fit")
    text = ROBOT.read_text(encoding="utf-8").replace("cycle_s = 0.001", "cycle_s = 0.004")
    (place / "robot.toml").write_text(text, encoding="utf-8")
    for seed in (3, 4):
        log = place / f"log{seed}.mcap"
        run("simulate", "--model", place / "robot.toml", "-o", log, "--duration", "10", "--seed", str(seed))
    return place


@pytest.fixture(scope="module")
def log(place, robot):
    return fric.read_log(place / "log3.mcap", robot)


@pytest.fixture(scope="module")
def bench():
    robot = fric.Robot.from_toml(BENCH)
    return robot, fric.simulate(robot, seed=2, duration_s=12.0)


def by_command_line(place, *options, logs=("log3.mcap",)):
    command = [PROGRAM, "fit", *logs, "-o", "fitted.toml", "--json", "fit.json", "--force", *options]
    done = subprocess.run(command, cwd=place, capture_output=True, text=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done
    read = [(place / name).read_text(encoding="utf-8") for name in ("fit.json", "fitted.toml")]
    return [*read, done.stdout, done.stderr]


def told(issued):
    return [f"warning: {warning.message}" for warning in issued]


@pytest.mark.parametrize(
    ("options", "cli"),
    [
        ({}, []),
        ({"huber": True, "parameters": ["mu", "offset_n"]}, ["--huber", "--parameters", "mu,offset_n"]),
        ({"reference": "wrench", "parameters": ["mu"]}, ["--reference", "wrench", "--parameters", "mu"]),
    ],
)
def test_a_fit_tells_what_the_command_line_tells(place, robot, options, cli):
    expected, fitted, stdout, stderr = by_command_line(place, "--model", "robot.toml", *cli)
    assert stderr == ""
    result = fric.fit(robot, place / "log3.mcap", **options)
    assert without_origin(result.to_json()) == without_origin(expected) and result.to_dict() == json.loads(result.to_json())
    assert stdout.split("\nwrote ")[0] == result.summary()
    # Comments and layout included.
    assert result.robot.to_toml() == fitted and result.reference == options.get("reference", "forces")
    for cable, found in zip(result.cables, json.loads(expected)["cables"]):
        assert cable.values == found["parameters"] and cable.standard_errors == found["standard_errors"]
        assert (cable.name, cable.samples, cable.left_out) == (found["name"], found["samples"], found["left_out"])
        assert list(np.sqrt(np.diag(cable.covariance))) == [cable.standard_errors[name] for name in cable.parameters]
        assert (cable.before is None) == (result.reference == "wrench") == (result.wrench is not None)


def test_residuals_are_those_of_a_replay_with_the_fitted_robot(robot, log):
    result = fric.fit(robot, log, parameters=["mu"])
    replayed = fric.replay(result.robot, log)
    for column, cable in enumerate(result.cables):
        left_n = replayed.force_at_platform_n[:, column] - log.reference_force_n[:, column]
        assert np.allclose(cable.residuals_n, left_n, rtol=0, atol=1e-9, equal_nan=True)
        assert np.sqrt(np.nanmean(cable.residuals_n**2)) == pytest.approx(cable.after.rms_n, rel=1e-12)
    assert robot.cable("cable1").friction.mu == 0.016


def test_several_logs_are_runs_of_their_own(place, robot, log):
    expected, *_ = by_command_line(place, "--model", "robot.toml", logs=("log3.mcap", "log4.mcap"))
    result = fric.fit(robot, [log, place / "log4.mcap"])
    assert without_origin(result.to_json()) == without_origin(expected)
    assert result.cables[0].residuals_n.shape == (2 * len(log),)


def test_each_log_has_its_own_zero():
    zeros_n = (0.3, -0.5, 0.1)
    tared = [BENCH.replace("friction = {", f"friction = {{ offset_n = {zero_n},") for zero_n in zeros_n]
    logs = [fric.simulate(fric.Robot.from_toml(text), seed=seed, duration_s=12.0) for seed, text in enumerate(tared)]
    robot = fric.Robot.from_toml(BENCH)
    result = fric.fit(robot, logs, per_log=["offset_n"])
    winch = result.cable("winch")
    for log, zero_n in zip(winch.per_log, zeros_n):
        error_n = log["standard_errors"]["offset_n"]
        assert error_n < 0.1 and log["parameters"]["offset_n"] == pytest.approx(zero_n, abs=3.5 * error_n)
    assert "offset_n" not in winch.parameters and winch.values["offset_n"] == winch.per_log[2]["parameters"]["offset_n"]
    assert result.robot.cable("winch").friction.offset_n == winch.values["offset_n"]
    assert "log 2: offset_n = " in str(result)
    common = fric.fit(robot, logs).cable("winch")
    assert common.per_log == [] and common.after.rms_n > 5 * winch.after.rms_n
    assert np.sqrt(np.nanmean(winch.residuals_n**2)) == pytest.approx(winch.after.rms_n, rel=1e-9)
    for given, per_log, words in (
        (logs, ["mu"], "`per_log`: `mu` has one value for all logs"),
        (logs, ["offset"], "there is no parameter `offset` that each log may have of its own"),
        (logs[0], ["offset_n"], "there is one"),
    ):
        with pytest.raises(fric.ConfigError, match=words):
            fric.fit(robot, given, per_log=per_log)


def test_comments_go_only_where_something_was_edited():
    robot = fric.Robot.from_toml(BENCH)
    assert robot.to_toml() == BENCH
    robot.cable("winch").friction.mu = 0.03
    assert "#" not in robot.to_toml() and fric.Robot.from_toml(robot.to_toml()) == robot


def test_optimisers_of_other_people_find_the_same(bench):
    robot, log = bench
    cable = fric.fit(robot, log).cables[0]
    f = fric.residual_function(robot, log, "winch")
    assert f.names == cable.parameters and len(f) == cable.samples and len(f.rows) == len(f)
    expected = np.array([cable.values[name] for name in f.names])
    errors = np.array([cable.standard_errors[name] for name in f.names])
    by_scipy = least_squares(f, f.x0, jac=f.jac, bounds=f.bounds, x_scale="jac", xtol=1e-10, ftol=1e-12)
    assert np.all(np.abs(by_scipy.x - expected) < 0.05 * errors)
    parameters = f.lmfit_parameters()
    by_lmfit = lmfit.minimize(
        f, parameters, method="least_squares", jac=f.jac, x_scale="jac", xtol=1e-10, ftol=1e-12
    ).params
    found = np.array([by_lmfit[name].value for name in f.names])
    assert np.all(np.abs(found - expected) < 0.05 * errors)
    assert np.array_equal(f(by_lmfit), f(found))


def test_names_of_effects_become_identifiers_for_lmfit(bench):
    f = fric.residual_function(*bench, "winch", parameters=["mu", "stribeck.ratio"])
    parameters = f.lmfit_parameters()
    assert list(parameters) == ["mu", "stribeck_ratio"]
    assert np.array_equal(f(parameters), f(f.x0))
    with pytest.raises(fric.ConfigError, match="the parameters have no `mu`"):
        f(lmfit.Parameters())


def test_derivatives_are_those_of_the_residuals(bench):
    f = fric.residual_function(*bench, "winch", parameters=["mu", "offset_n"])
    step = np.array([1e-7, 0.0])
    numeric = (f(f.x0 + step) - f(f.x0 - step)) / 2e-7
    assert np.allclose(f.jac(f.x0)[:, 0], numeric, rtol=1e-5, atol=1e-5 * np.abs(numeric).max())
    with pytest.raises(fric.ShapeError, match=r"`x` must be .* shape \(2,\), one number per parameter: mu, offset_n"):
        f([0.1])


def test_the_hysteresis_is_that_of_the_command_line(tmp_path, robot):
    (tmp_path / "robot.toml").write_text(robot.to_toml(), encoding="utf-8")
    path, result_path = tmp_path / "log.mcap", tmp_path / "result.json"
    model = ["--model", tmp_path / "robot.toml"]
    run("simulate", *model, "-o", path, "--run", "crossing", "--duration", "60")
    run("hysteresis", path, *model, "--json", result_path)
    result = fric.hysteresis(robot, path)
    expected = result_path.read_text(encoding="utf-8")
    assert without_origin(result.to_json()) == without_origin(expected)
    axes = result.to_dict()["axes"]
    assert [axis.axis for axis in result.axes] == list("xyzabc")
    assert (result.axes[0].without.width, result.axes[0].compensated.width) == (
        axes[0]["without"]["width"],
        axes[0]["with"]["width"],
    )
    with pytest.raises(fric.LogError, match="passes no position|several axes|does not move"):
        fric.hysteresis(robot, fric.simulate(robot, duration_s=0.1))


def without(log, *names):
    arrays = {name: np.array(getattr(log, name)) for name in ("stamp_nanos", "sensor_force_n", "length_m")}
    kept = ("reference_force_n", "position_m", "orientation_xyzw", "outside_force_n", "outside_torque_nm")
    arrays |= {name: getattr(log, name) for name in kept if name not in names}
    return fric.Log.from_arrays(cable_names=log.cable_names, **arrays)


def test_data_that_allow_no_fit_are_told(robot, log, bench):
    bare = without(log, "reference_force_n")
    advice = r'no reference forces on /reference_forces\. .* fit without them: reference="wrench"\.'
    with pytest.raises(fric.FitError, match=advice):
        fric.fit(robot, bare)
    with pytest.raises(fric.FitError, match=advice):
        fric.residual_function(robot, bare, "cable1")
    with pytest.raises(fric.FitError, match=r'the robot has no `base_m` .*: reference="forces"\.'):
        fric.fit(*bench, reference="wrench")
    partly = np.array(log.reference_force_n)
    partly[:, 0] = np.nan
    arrays = {name: getattr(log, name) for name in ("stamp_nanos", "sensor_force_n", "length_m")}
    poses = {name: getattr(log, name) for name in ("position_m", "orientation_xyzw")}
    other = fric.Log.from_arrays(cable_names=log.cable_names, reference_force_n=partly, **arrays, **poses)
    with pytest.warns(fric.LogWarning, match="no reference forces on /reference_forces of cable1: its values are kept"):
        result = fric.fit(robot, other, parameters=["mu"])
    assert result.cables[0].samples == 0 and np.isnan(result.cables[0].residuals_n).all()


def test_what_is_misspelt_is_answered_with_the_nearest(robot, log, place):
    with pytest.raises(fric.ConfigError, match="unknown reference `force`; did you mean `forces`"):
        fric.fit(robot, log, reference="force")
    with pytest.raises(fric.ConfigError, match="`parameters`: unknown parameter `mue`; did you mean `mu`"):
        fric.fit(robot, log, parameters=["mue"])
    with pytest.raises(fric.ConfigError, match="`mu` is named twice"):
        fric.residual_function(robot, log, "cable1", parameters=["mu", "mu"])
    with pytest.raises(fric.ConfigError, match="unknown cable `cabel1`; did you mean `cable1`"):
        fric.residual_function(robot, log, "cabel1")
    with pytest.raises(TypeError):
        fric.fit(robot, log, "wrench")
    with pytest.raises(TypeError, match="`log` must be a Log, a path, or a list of them; what came is"):
        fric.fit(robot, 3)
    with pytest.raises(fric.ConfigError, match="empty list"):
        fric.fit(robot, [])
    for twice in ([log, log], [log, place / "log3.mcap"]):
        with pytest.raises(fric.ConfigError, match="given twice"):
            fric.fit(robot, twice)
    with pytest.raises(fric.LogError):
        fric.fit(robot, place / "none.mcap")


def test_a_log_of_other_cables_is_refused(robot, bench):
    with pytest.raises(fric.ShapeError, match="the log has the cables winch, the robot cable1"):
        fric.fit(robot, bench[1])


def test_fits_run_beside_other_threads(bench):
    expected = without_origin(fric.fit(*bench).to_json())
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    with ThreadPoolExecutor(3) as pool:
        results = list(pool.map(lambda _: without_origin(fric.fit(*bench).to_json()), range(3)))
    stop.set()
    counter.join()
    assert results == [expected] * 3 and counted[0] > 3


def test_progress_goes_from_nothing_to_all(bench):
    told = []
    fric.fit(*bench, parameters=["mu"], progress=told.append)
    assert told == sorted(told) and told[0] == 0.0 and told[-1] == 1.0


def test_ctrl_c_ends_a_fit(place):
    code = f"""{PRESS_SOON}
import fric
robot = fric.Robot.read({str(place / "robot.toml")!r})
log = fric.simulate(robot, duration_s=60.0)
try:
    fric.fit(robot, log, reference="wrench", progress=press_soon)
except KeyboardInterrupt:
    print(max(seen) < 1.0, len(fric.simulate(robot, duration_s=1.0)))
"""
    assert printed(code) == "True 250\n"


def test_a_real_fit_can_be_drawn(robot, log):
    result = fric.fit(robot, log, parameters=["mu"])
    panels = fric.plot.parameters(result)
    assert [panel.get_xlabel() for panel in panels] == list(result.cables[0].values)
    histogram, _ = fric.plot.residuals(log, result, "cable2", lag_count=20)
    assert histogram.get_xlabel() == "compensated less reference [N]"


def test_samples_beyond_memory_need_a_folder(bench, monkeypatch):
    robot, log = bench
    # 64 MB of rows of 64 bytes.
    times = -(-(1 << 20) // len(log)) + 1
    arrays = {name: np.tile(getattr(log, name), (times, 1)) for name in ("sensor_force_n", "length_m", "reference_force_n")}
    stamp_nanos = np.arange(times * len(log)) * 1_000_000
    long = fric.Log.from_arrays(cable_names=log.cable_names, stamp_nanos=stamp_nanos, **arrays)
    # The first is Unix's, the others are of Windows.
    for variable in ("TMPDIR", "TMP", "TEMP"):
        monkeypatch.setenv(variable, "nowhere")
    for work in (fric.fit, fric.discover):
        with pytest.raises(fric.OutputError, match=r"too many for memory.* nowhere .*TMP.* 72 free bytes"):
            work(robot, long)
