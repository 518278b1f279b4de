"""The package as a whole: stubs, documentation, Ctrl-C."""

import doctest
import inspect
import re
import subprocess
import sys

import fric
import pytest
from support import PRESS_SOON, ROBOT, ROOT, printed


def test_the_stubs_are_true():
    for command in (["mypy.stubtest", "fric"], ["mypy", "--strict", "-p", "fric"]):
        done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr


def test_what_is_public_is_documented_and_examples_are_right(monkeypatch):
    monkeypatch.chdir(ROOT)
    names = {name: getattr(fric, name) for name in fric.__all__}
    assert [name for name, value in names.items() if not isinstance(value, str) and not inspect.getdoc(value)] == []
    runner = doctest.DocTestRunner()
    continuum = {name: getattr(fric.continuum, name) for name in fric.continuum.__all__}
    assert [name for name, value in continuum.items() if not inspect.getdoc(value)] == []
    finder = doctest.DocTestFinder()
    found = finder.find(fric, "fric", module=False, globs=names)
    fleet = {name: getattr(fric.fleet, name) for name in fric.fleet.__all__}
    assert [name for name, value in fleet.items() if not inspect.getdoc(value)] == []
    for name, value in {"fric.continuum": fric.continuum, **continuum, "fric.fleet": fric.fleet, **fleet}.items():
        found += finder.find(value, name, module=False, globs=names)
    for test in found:
        runner.run(test, clear_globs=False)
    assert runner.summarize(verbose=False).failed == 0
    assert runner.tries > 20


def test_the_notices_name_all_that_is_built_in():
    tree = ["cargo", "tree", "--workspace", "--edges", "normal", "--prefix", "none", "--format", "{p}", "--frozen"]
    lines = subprocess.run(tree, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    # Our own have a path behind the version.
    built_in = {line.split(" (")[0].replace(" v", " ") for line in lines if line and "(/" not in line}
    named = set(re.findall(r"^  ([\w-]+ \d+\.\d+\.\S+)$", (ROOT / "THIRD-PARTY.txt").read_text(encoding="utf-8"), re.MULTILINE))
    assert len(built_in) > 100
    assert built_in - named == set(), "`make notices` writes THIRD-PARTY.txt anew"


def test_the_status_is_the_core_s():
    assert {flag.name: flag.value for flag in fric.Status} == fric._fric.STATUS_BITS
    assert fric.Status(1 | 1 << 8) == fric.Status.SLACK | fric.Status.POSE_UNREACHABLE


@pytest.mark.parametrize(
    "call", ["fric.simulate(robot, duration_s=1e6, progress=press_soon)", "replay_for_ever()", "run_for_ever()"]
)
def test_ctrl_c_ends_a_long_call_and_leaves_the_interpreter_whole(call):
    code = f"""{PRESS_SOON}
import fric
robot = fric.Robot.read({str(ROBOT)!r})
log = fric.simulate(robot, duration_s=20.0)
def replay_for_ever():
    while True:
        fric.replay(robot, log, progress=press_soon)
def run_for_ever():
    while True:
        fric.Compensator(robot).run(log.sensor_force_n, log.length_m, log.speed_m_per_s, progress=press_soon)
try:
    {call}
except KeyboardInterrupt:
    print(len(fric.simulate(robot, duration_s=0.5)))
"""
    assert printed(code) == "500\n"
