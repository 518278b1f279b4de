"""Work in a process and in its children, however these are made."""

import subprocess
import sys

import pytest
from support import HANG_S, SLOW_BENCH

SCRIPT = """
import concurrent.futures, multiprocessing, sys
import fric

TEXT = {text!r}


def work(seed):
    robot = fric.Robot.from_toml(TEXT)
    log = fric.simulate(robot, seed=seed, duration_s=24.0)
    fitted = fric.fit(robot, log).cables[0].values["mu"]
    return fitted, fric.discover(robot, log).cables[0].verdict


if __name__ == "__main__":
    here = [work(seed) for seed in (1, 2)]
    context = multiprocessing.get_context(sys.argv[1])
    with context.Pool(2) as pool:
        assert pool.map(work, (1, 2)) == here
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        assert list(pool.map(work, (1, 2))) == here
    print("the same", here[0][0])
"""


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_children_fit_and_discover_as_their_parent_does(tmp_path, method):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(text=SLOW_BENCH), encoding="utf-8")
    # Far more than it takes, so that a deadlock is a failure.
    ended = subprocess.run([sys.executable, script, method], capture_output=True, text=True, timeout=HANG_S, check=True)
    assert ended.stdout.startswith("the same 0.0")
