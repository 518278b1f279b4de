"""What several tests need."""

import json
import os
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROBOT = ROOT / "examples" / "mini-ipanema.toml"
# The build that `cargo test` leaves behind.
PROGRAM = ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "debug" / "fric-cli"
LOG = ROOT / "examples" / "mini-ipanema.mcap"
ARM = ROOT / "examples" / "tendon-prototype.toml"
# After so long a process hangs. It says nothing about speed: a busy machine takes several times as long as an idle one.
HANG_S = 1200
BENCH = """# The bench in the cellar.
format = "fric-robot/1"
name = "bench"
cycle_s = 0.001
[[cable]]
name = "winch"  # the only one
pulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]
friction = { mu = 0.02, sigma_n_per_m = 900.0, viscous_n_s_per_m = 0.3 } # guessed
"""
SLOW_BENCH = BENCH.replace("cycle_s = 0.001", "cycle_s = 0.004")


def run(*arguments):
    """Runs the command line and gives what it warns of."""
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done
    return done.stderr


def without_origin(text):
    """What the JSON of a result says, but for when it was made and by which command."""
    told = json.loads(text)
    assert told.pop("provenance")["program"] == "fric"
    return told


@contextmanager
def started(*command):
    """A program while it runs, its stdout kept; killed where the test fails before it ends."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
        try:
            yield program
        finally:
            program.kill()


# Presses Ctrl-C a moment after the call that it is the `progress` of has begun.
PRESS_SOON = """
import signal, threading
# What runs in the background may have been told to ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)
seen = []
def press_soon(fraction):
    if not seen:
        threading.Timer(0.05, signal.raise_signal, [signal.SIGINT]).start()
    seen.append(fraction)
"""


def printed(code):
    """What Python code prints."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=HANG_S)
    assert done.returncode == 0, done.stderr
    return done.stdout
