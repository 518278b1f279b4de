"""What people see of results: the same text, JSON and page as on the command line."""

import json
import re
import signal
import subprocess
import sys
from pathlib import Path

import fric
import numpy as np
import pytest
from fric import continuum
from support import HANG_S, ROBOT, ROOT, SLOW_BENCH

ARM = ROOT / "examples" / "tendon-prototype.toml"


def command(folder, *words, code=0):
    """`python -m fric` in a folder."""
    done = subprocess.run([sys.executable, "-m", "fric", *words], cwd=folder, capture_output=True, text=True, check=False, timeout=HANG_S)
    assert done.returncode == code, done.stderr
    return done


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shown")
    (folder / "robot.toml").write_text(SLOW_BENCH, encoding="utf-8")
    effect = ["--effect", "sensor_gain:gain=1.05"]
    command(folder, "simulate", "--model", "robot.toml", "-o", "log.mcap", "--duration", "24", *effect)
    command(folder, "simulate", "--model", ROBOT, "-o", "crossing.mcap", "--run", "crossing", "--duration", "20")
    simulate = ["continuum", "simulate", "--model", ARM, "-o", "run.csv", "--run", "mixed", "--seed", "5"]
    command(folder, *simulate, "--calibration", "loads.csv")
    report = ["--report", "calibrate.html", "--json", "calibrate.json"]
    command(folder, "continuum", "calibrate", "loads.csv", "--model", ARM, "-o", "cal.toml", *report)
    return folder


def unwrapped(text):
    """In one line, as before it was wrapped to the width of a terminal."""
    return " ".join(text.split())


def timeless(text):
    """Without how long cycles took, and without when and by which command a result was made."""
    text = re.sub(r'one takes [^<\n]*longest\)|"(median|p999|max)_ns": \d+', "", text)
    text = re.sub(r'<footer>.*?</footer>|,\s*"provenance": \{.*?\n  \}', "", text, flags=re.S)
    return re.sub(r'(<p class="about">[^·]*)·[^<]*', r"\1", text)


@pytest.mark.parametrize("name", ["replay", "discover", "fit", "hysteresis", "friction", "shape", "tendon", "hole"])
def test_results_are_shown_as_on_the_command_line(folder, name, monkeypatch):
    monkeypatch.chdir(folder)
    files = ["--json", f"{name}.json"]
    report = ["--report", f"{name}.html"]
    cal = ["--model", "cal.toml"]
    force = ["--force"]
    lines = {
        "replay": ["replay", "log.mcap", *report],
        "discover": ["discover", "log.mcap", *report],
        "fit": ["fit", "log.mcap", "-o", "fitted.toml", *report],
        "hysteresis": ["hysteresis", "crossing.mcap", *report],
        "friction": ["continuum", "friction", "run.csv", *cal, *report],
        "shape": ["continuum", "shape", "run.csv", *cal, "--mixed", "--shapes", "4", *report],
        "tendon": ["discover", "run.csv", *cal, *report],
        "hole": ["continuum", "hole", "hole.csv"],
    }
    first_n, angle_rad = np.linspace(0.5, 2.0, 4), np.full(4, 1.0)
    header = "tension_1_n,tension_2_n,angle_1_rad,angle_2_rad"
    hole = np.stack([first_n, 0.8 * first_n + [0.01, 0.0, -0.01, 0.0], angle_rad, angle_rad])
    np.savetxt("hole.csv", hole.T, delimiter=",", header=header, comments="", fmt="%.17g")
    told = command(folder, *lines[name], *files, *force)
    robot = fric.Robot.read("robot.toml")
    arm = continuum.Manipulator.read("cal.toml")
    results = {
        "replay": lambda: fric.replay(robot, "log.mcap"),
        "discover": lambda: fric.discover(robot, "log.mcap"),
        "fit": lambda: fric.fit(robot, "log.mcap"),
        "hysteresis": lambda: fric.hysteresis(fric.Robot.read(ROBOT), "crossing.mcap"),
        "friction": lambda: continuum.friction(arm, continuum.read_run("run.csv", arm)),
        "shape": lambda: continuum.shape(arm, continuum.read_run("run.csv", arm), mixed=True, shapes=4),
        "tendon": lambda: continuum.discover(arm, continuum.read_run("run.csv", arm)),
        "hole": lambda: continuum.hole(*hole),
    }
    result = results[name]()
    assert timeless(result.to_json()) == timeless((folder / f"{name}.json").read_text(encoding="utf-8"))
    assert json.loads(result.to_json()) == result.to_dict()
    assert timeless(told.stdout).startswith(timeless(result.summary()))
    if report[1] in lines[name]:
        assert timeless(result.to_html()) == timeless((folder / report[1]).read_text(encoding="utf-8"))
    assert result.to_html().startswith("<!DOCTYPE html>") and "http" not in result.to_html()
    table = result._repr_html_()
    assert table.startswith("<table>") and "</table>" in table and "href" not in table
    assert name == "fit" or str(result) == result.summary()


def test_a_calibration_is_shown_but_for_the_name_of_its_loads(folder, monkeypatch):
    monkeypatch.chdir(folder)
    arm = continuum.Manipulator.read(ARM)
    result = continuum.calibrate(arm, *continuum.read_loads("loads.csv", arm))
    page = (folder / "calibrate.html").read_text(encoding="utf-8")
    assert "loads.csv" in page and "loads.csv" not in result.to_html()
    assert timeless(result.to_html()) == timeless(page)
    assert timeless(result.to_json()) == timeless((folder / "calibrate.json").read_text(encoding="utf-8"))


def test_a_printed_fit_is_what_lmfit_s_users_expect(folder):
    robot = fric.Robot.read(folder / "robot.toml")
    result = fric.fit(robot, str(folder / "log.mcap"))
    cable = result.cables[0]
    scale = np.sqrt(np.diag(cable.covariance))
    assert np.allclose(cable.correlation, cable.covariance / np.outer(scale, scale), rtol=1e-12)
    text = str(result)
    for key, value, error in re.findall(r"^    (\S+): +(\S+) \+/- (\S+)", text, re.MULTILINE):
        assert np.isclose(float(value), cable.values[key], atol=0.6 * float(error))
        assert np.isclose(float(error), cable.standard_errors[key], rtol=0.06)
    pairs = re.findall(r"^    C\((\S+), (\S+)\) = (\S+)$", text, re.MULTILINE)
    names = cable.parameters
    strong = {
        (names[row], names[column]): cable.correlation[row, column]
        for row in range(len(names))
        for column in range(row + 1, len(names))
        if abs(cable.correlation[row, column]) >= 0.5
    }
    assert strong and {(one, other): pytest.approx(float(value), abs=1e-4) for one, other, value in pairs} == strong
    assert [abs(float(value)) for *_, value in pairs] == sorted((abs(float(value)) for *_, value in pairs), reverse=True)
    # A cable that rubs at one speed and one tension: offset and friction are one number.
    noise_n = np.random.default_rng(1).normal(0.0, 0.01, (2, 4000, 1))
    even = fric.Log.from_arrays(
        cable_names=["winch"],
        stamp_nanos=np.arange(4000) * 4_000_000,
        sensor_force_n=20.0 + noise_n[0],
        length_m=0.5 + 0.0002 * np.arange(4000.0)[:, None],
        speed_m_per_s=np.full((4000, 1), 0.05),
        reference_force_n=10.5 + noise_n[1],
    )
    left_open = fric.fit(robot, even)
    assert "offset_n" in left_open.cables[0].undetermined
    kept = re.findall(r"^    (\S+): .*not determined by the samples", str(left_open), re.MULTILINE)
    assert sorted(kept) == sorted(left_open.cables[0].undetermined) and "    open: together " in str(left_open)


def test_set_points_are_those_of_the_command_line(folder, monkeypatch):
    monkeypatch.chdir(folder)
    options = ["--max-speed-m-per-s", "0.5", "--box", "-0.1,-0.1,-0.1,0.1,0.1,0.1"]
    told = command(folder, "excite", "--model", ROBOT, "-o", "run-cli.csv", "--preview", "run.html", *options, "--force").stdout
    robot = fric.Robot.read(ROBOT)
    box_m = [[-0.1, -0.1, -0.1], [0.1, 0.1, 0.1]]
    run = fric.excite(robot, max_speed_m_per_s=0.5, box_m=box_m, output="run-py.csv", force=True)
    text = (folder / "run-cli.csv").read_text(encoding="utf-8")
    assert (folder / "run-py.csv").read_text(encoding="utf-8") == text
    assert timeless(run.to_html()) == timeless((folder / "run.html").read_text(encoding="utf-8"))
    assert unwrapped(told) == f"wrote run-cli.csv: {unwrapped(run.summary())} wrote run.html: the run, drawn" and str(run) == run.summary()
    header, *rows = (line.split(",") for line in text.splitlines())
    columns = dict(zip(header, zip(*rows)))
    assert [run.phases[place] for place in run.phase] == list(columns["phase"])

    def column(name):
        return np.array(columns[name], dtype=float)

    assert np.array_equal(run.time_s.round(9), column("time_s"))
    for place, axis in enumerate("xyz"):
        assert np.array_equal(run.position_m[:, place], column(f"{axis}_m"))
        assert np.array_equal(run.velocity_m_per_s[:, place], column(f"v{axis}_m_per_s"))
        assert np.array_equal(run.acceleration_m_per_s2[:, place], column(f"a{axis}_m_per_s2"))
    for place, axis in enumerate("xyzw"):
        assert np.array_equal(run.orientation_xyzw[:, place], column(f"q{axis}"))
    for place, name in enumerate(run.cable_names):
        assert np.array_equal(run.length_m[:, place], column(f"{name}_length_m"))
        assert np.array_equal(run.speed_m_per_s[:, place], column(f"{name}_speed_m_per_s"))
        assert np.array_equal(run.tension_n[:, place], column(f"{name}_tension_n"))
    with pytest.raises(fric.OutputError, match="exists"):
        fric.excite(robot, output="run-py.csv")
    with pytest.raises(fric.ConfigError, match="`max_speed_m_per_s` is -1"):
        fric.excite(robot, max_speed_m_per_s=-1.0)
    bench = fric.excite(fric.Robot.from_toml(SLOW_BENCH))
    assert bench.position_m is None and bench.tension_n is None and bench.length_m.shape == (len(bench), 1)


def test_designed_runs_are_those_of_the_command_line(folder, monkeypatch):
    monkeypatch.chdir(folder)
    (folder / "bench.toml").write_text(SLOW_BENCH, encoding="utf-8")
    options = ["--determine", "mu", "--duration", "4", "--preview", "told.html", "--force"]
    told = command(folder, "excite", "--model", "bench.toml", "-o", "told.csv", *options).stdout
    robot = fric.Robot.from_toml(SLOW_BENCH)
    run = fric.excite(robot, determine=["mu"], duration_s=4.0, output="told-py.csv", force=True)
    assert (folder / "told-py.csv").read_bytes() == (folder / "told.csv").read_bytes()
    assert timeless(run.to_html()) == timeless((folder / "told.html").read_text(encoding="utf-8"))
    summary, *_ = run.summary().split("\n")
    written = f"wrote told.csv: {unwrapped(summary)} wrote told.html: the run, drawn"
    assert unwrapped(told) == f"{written} {unwrapped(' '.join(run.expectations))}" and len(run.expectations) == 1
    assert fric.excite(robot).expectations == ()
    cable = {"name": robot.cables[0].name, "noise_floor_n": 0.02, "effects": [], "tried": [], "parameters": {"mu": 0.019}, "standard_errors": {}}
    found = {"format": "fric-discover/1", "robot": robot.name, "cables": [cable]}
    left_open = fric.excite(robot, for_=found, duration_s=4.0)
    assert "mu 0.019" in left_open.expectations[0] and left_open == fric.excite(robot, for_=json.dumps(found), duration_s=4.0)
    with pytest.raises(fric.ConfigError, match="three questions"):
        fric.excite(robot, determine=["mu"], separate=["stribeck", "dwell_stiction"])
    with pytest.raises(fric.ConfigError, match="`duration_s` needs a question"):
        fric.excite(robot, duration_s=4.0)


def test_the_command_line_runs_in_python(folder):
    assert command(folder, "--version").stdout == f"fric-cli {fric.__version__}\n"
    assert "Usage: fric-cli" in command(folder, "--help").stdout
    assert "error:" in command(folder, "replay", "--no-such-option", code=2).stderr
    assert "there is no file" in command(folder, "replay", "none.mcap", code=1).stderr
    assert command(folder, code=2).stdout == ""
    # The wheel brings it by its name too.
    script = Path(sys.executable).with_name("fric-cli")
    told = subprocess.run([script, "--version"], capture_output=True, text=True, check=True).stdout
    assert told == f"fric-cli {fric.__version__}\n"


def test_ctrl_c_ends_the_command_line_in_python(tmp_path):
    output = tmp_path / "log.mcap"
    words = ["simulate", "--model", ROBOT, "-o", output, "--duration", "100000"]
    process = subprocess.Popen([sys.executable, "-m", "fric", *words], stderr=subprocess.PIPE, text=True)
    try:
        # The file in the making is there once the work has begun.
        while process.poll() is None and not list(tmp_path.iterdir()):
            pass
        process.send_signal(signal.SIGINT)
        _, told = process.communicate(timeout=HANG_S)
    finally:
        process.kill()
    assert process.returncode == 1 and "interrupted before the end: nothing was written" in told
    assert list(tmp_path.iterdir()) == []


def test_what_is_missing_and_what_is_of_another_type_are_python_s_errors(tmp_path):
    none = tmp_path / "none"
    robot, arm = fric.Robot.from_toml(SLOW_BENCH), continuum.Manipulator.read(ARM)
    calls = {
        fric.ConfigError: [lambda: fric.Robot.read(none), lambda: continuum.Manipulator.read(none)],
        fric.LogError: [
            lambda: fric.read_log(none),
            lambda: fric.replay(robot, none),
            lambda: fric.fit(robot, [none]),
            lambda: fric.discover(robot, str(none)),
            lambda: fric.hysteresis(robot, none),
            lambda: continuum.read_run(none, arm),
            lambda: continuum.read_loads(none, arm),
        ],
    }
    for kind, missing in calls.items():
        for call in missing:
            with pytest.raises(FileNotFoundError, match=str(none)) as raised:
                call()
            assert isinstance(raised.value, kind) and isinstance(raised.value, fric.FricError)
            assert str(raised.value.filename) == str(none) and "Errno" not in str(raised.value)
    thing = object()
    compensator = fric.Compensator(robot)
    wrong = {
        "path": lambda: fric.Robot.read(thing),
        "text": lambda: fric.Robot.from_toml(thing),
        "paths": lambda: fric.read_log(thing),
        "log": lambda: fric.fit(robot, thing),
        "robot": lambda: fric.replay(thing, none),
        "run": lambda: fric.simulate(robot, run=thing),
        "seed": lambda: fric.simulate(robot, seed=0.5),
        "effects": lambda: fric.simulate(robot, effects=thing),
        "disturbances": lambda: fric.simulate(robot, disturbances=3),
        "parameters": lambda: fric.fit(robot, none, parameters=3),
        "max_speed_m_per_s": lambda: fric.excite(robot, max_speed_m_per_s="fast"),
        "box_m": lambda: fric.excite(robot, box_m=thing),
        "output": lambda: fric.replay(robot, none, output=3),
        "sensor_force_n": lambda: compensator.step(["a"], [0.1], [0.0]),
        "length_m": lambda: compensator.step([1.0], thing, [0.0]),
        "snapshot": lambda: compensator.restore(thing),
        "cable": lambda: compensator.pulley_friction_n(3),
        "manipulator": lambda: continuum.friction(thing, thing),
        "at_s": lambda: continuum.shape(arm, continuum.simulate(arm).run, at_s=thing),
    }
    for name, call in wrong.items():
        with pytest.raises(TypeError, match=rf"['`]{name}['`]"):
            call()
    with pytest.raises(fric.ShapeError, match="`length_m` must be real numbers"):
        compensator.step([1.0], thing, [0.0])
