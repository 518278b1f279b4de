"""What several test modules set up; each that uses `robot` has a `place` with a robot file in it."""

import fric
import matplotlib
import pytest

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


@pytest.fixture(scope="module")
def robot(place):
    return fric.Robot.read(place / "robot.toml")


@pytest.fixture(autouse=True)
def close_figures():
    yield
    pyplot.close("all")
