"""Figures: what is drawn is what is in log and result."""

import subprocess
import sys
from types import SimpleNamespace

import fric
import numpy as np
import pytest
from matplotlib import pyplot
from support import ROBOT


@pytest.fixture(scope="module")
def run():
    robot = fric.Robot.read(ROBOT)
    log = fric.simulate(robot, seed=3, duration_s=6.0)
    return log, fric.replay(robot, log)


def lines(ax):
    return {line.get_label(): line.get_xydata() for line in ax.get_lines()}


def test_forces_over_time(run):
    log, result = run
    ax = fric.plot.forces(log, result, "cable2")
    drawn = lines(ax)
    assert list(drawn) == ["reference", "measured", "compensated"]
    assert np.array_equal(drawn["measured"], np.column_stack([log.time_s, result.frictionless_n[:, 1]]))
    assert np.array_equal(drawn["compensated"][:, 1], result.force_at_platform_n[:, 1])
    assert np.array_equal(drawn["reference"][:, 1], log.reference_force_n[:, 1])
    assert ax.get_xlabel() == "time [s]" and ax.get_ylabel() == "force at the platform [N]"


def test_the_friction_loop(run):
    log, result = run
    drawn = lines(fric.plot.friction_loop(log, result, "cable2"))
    assert np.allclose(drawn["model"][:, 1], result.friction_n[:, 1], rtol=0, atol=1e-12)
    assert np.allclose(drawn["model"][:, 0], 1e3 * (log.length_m[:, 1] - log.length_m[0, 1]))
    assert np.std(drawn["measured"][:, 1] - drawn["model"][:, 1]) < 0.03 < np.std(drawn["model"][:, 1])


def test_residuals_of_white_noise_stay_in_the_band(run):
    log, result = run
    histogram, correlogram = fric.plot.residuals(log, result, "cable2", lag_count=50)
    left_n = result.force_at_platform_n[:, 1] - log.reference_force_n[:, 1]
    deviation_n = left_n - left_n.mean()
    expected = [np.mean(deviation_n[:-lag] * deviation_n[lag:]) / np.var(left_n) for lag in range(1, 51)]
    drawn = lines(correlogram)["residual"]
    assert np.array_equal(drawn[:, 0], np.arange(1, 51))
    assert np.allclose(drawn[:, 1], np.array(expected) * (1 - np.arange(1, 51) / left_n.size), rtol=0, atol=1e-12)
    assert "density [1/N]" == histogram.get_ylabel()
    areas = [patch.get_width() * patch.get_height() for patch in histogram.patches]
    assert sum(areas) == pytest.approx(1.0)


def fitted(name, errors):
    return SimpleNamespace(name=name, values={"mu": 0.016, "sigma_n_per_m": 1000.0}, standard_errors=errors)


def test_parameters_with_intervals():
    fit = SimpleNamespace(cables=[fitted("one", {"mu": 0.001, "sigma_n_per_m": 20.0}), fitted("two", {"mu": 0.002})])
    mu, sigma = fric.plot.parameters(fit)
    assert (mu.get_xlabel(), sigma.get_xlabel()) == ("mu", "sigma_n_per_m")
    assert [label.get_text() for label in mu.get_yticklabels()] == ["one", "two"]
    intervals = [segment[:, 0] for segment in mu.collections[0].get_segments()]
    assert np.allclose(intervals, [[0.016 - 0.00196, 0.016 + 0.00196], [0.016 - 0.00392, 0.016 + 0.00392]])
    assert len(sigma.collections[0].get_segments()) == 1
    assert sigma.get_lines()[-1].get_xydata().tolist() == [[1000.0, 1.0]]
    with pytest.raises(fric.ShapeError, match="`ax` has 1 axes; 2 are needed for mu, sigma_n_per_m"):
        fric.plot.parameters(fit, ax=[mu])


def test_axes_given_are_drawn_into(run):
    figure, axes = pyplot.subplots(2, 2)
    assert fric.plot.forces(*run, "cable1", ax=axes[0, 0]) is axes[0, 0]
    assert fric.plot.friction_loop(*run, "cable1", ax=axes[0, 1]) is axes[0, 1]
    assert fric.plot.residuals(*run, "cable1", ax=axes[1]) == (axes[1, 0], axes[1, 1])
    assert pyplot.get_fignums() == [figure.number]


def test_what_does_not_fit_is_told(run):
    log, result = run
    with pytest.raises(fric.ConfigError, match="the log has no cable `cable9`; it has cable1, "):
        fric.plot.forces(log, result, "cable9")
    shorter = fric.simulate(fric.Robot.read(ROBOT), duration_s=1.0)
    with pytest.raises(fric.ShapeError, match=r"not of the same run: .* \(6000, 8\) and \(1000, 8\)"):
        fric.plot.friction_loop(shorter, result, "cable1")
    with pytest.raises(fric.ShapeError, match="more than lag_count = 6000 are needed"):
        fric.plot.residuals(log, result, "cable1", lag_count=6000)


def test_fric_does_without_matplotlib():
    code = """
import sys
sys.modules["matplotlib"] = None
import fric
from types import SimpleNamespace
try:
    fric.plot.parameters(SimpleNamespace(cables=[SimpleNamespace(name="a", values={"mu": 1}, standard_errors={})]))
except ImportError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "fric.plot needs matplotlib; install it with `pip install matplotlib`\n"
