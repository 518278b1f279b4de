"""Scatter of a series about a line: Student's t with the standard errors and a scatter from log to log, optionally with a wander."""

from __future__ import annotations

from math import lgamma, pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Degrees of freedom under which outliers hardly move the rest while normal values keep nearly all of their weight (Lange, Little and
# Taylor 1989, Robust statistical modeling using the t distribution).
FREEDOM = 4.0
_ITERATIONS = 60
_CONVERGED = 1e-8
# Values that agree in all their digits still have rounding errors. Values are scaled to about 1 before.
_ROUNDING = 1e-9


class Scatter(NamedTuple):
    """Fit of a line to a series, with its noise."""

    coefficients: Array
    covariance: Array
    scatter: float
    """Standard deviation from log to log, in addition to the standard errors."""
    variance: Array
    """Variance of each value; that of outliers is increased until they fit."""
    deviance: float
    """-2 log likelihood."""


def size_of(values: Array) -> float:
    """Returns the divisor that scales values to about 1: their standard deviation, or their magnitude if they are all equal."""
    greatest, deviation = float(np.abs(values).max()), float(np.std(values))
    return deviation if deviation > _ROUNDING * greatest else greatest or 1.0


def rough_scatter(values: Array, errors: Array) -> float:
    """Estimates the scatter from the differences between neighbours, which steps and slopes hardly affect."""
    if len(values) < 2:
        return 0.0
    deviation = 1.4826 * float(np.median(np.abs(np.diff(values)))) / np.sqrt(2)
    return float(np.sqrt(max(deviation**2 - float(np.median(errors**2)), 0.0)))


def fit_line(design: Array, values: Array, errors: Array, start: float) -> Scatter:
    """Fits values, which are about 1, by a design, (N, P), under Student's t with the variance errors² + scatter², with the scatter by maximum
    likelihood.

    The variance is found by scoring, the weights by expectation-maximisation.
    """
    floor = _ROUNDING**2
    scatter2 = start**2
    fixed = errors**2 + floor
    weights = np.ones(len(values))
    for _ in range(_ITERATIONS):
        variance = fixed + scatter2
        coefficients, covariance = weighted(design, values, variance / weights)
        left2 = (values - design @ coefficients) ** 2
        weights = (FREEDOM + 1) / (FREEDOM + left2 / variance)
        curvature = np.sum(1 / variance**2)
        following = max(scatter2 + float(np.sum((weights * left2 - variance) / variance**2) / curvature), 0.0)
        if abs(following - scatter2) <= _CONVERGED * (following + floor):
            break
        scatter2 = following
    variance = fixed + scatter2
    grown = variance / np.minimum(weights, 1.0)
    # The scale of Student's t is smaller than the standard deviation of normal values.
    normal = max(float(np.sum(left2 / grown)) / max(len(values) - design.shape[1], 1), 1.0)
    return Scatter(coefficients, covariance * normal, scatter2**0.5, grown * normal, _deviance(left2, variance))


def weighted(design: Array, values: Array, variance: Array) -> tuple[Array, Array]:
    """Returns the coefficients by weighted least squares, and their covariance. Of columns that are combinations of others the shortest coefficients are returned,
    so that such a line explains no more than one without them, which costs less."""
    root = 1 / np.sqrt(variance)
    q, r = np.linalg.qr(design * root[:, None])
    inverse = np.linalg.pinv(r)
    return inverse @ (q.T @ (values * root)), inverse @ inverse.T


def _deviance(left2: Array, variance: Array) -> float:
    constant = lgamma((FREEDOM + 1) / 2) - lgamma(FREEDOM / 2) - 0.5 * np.log(FREEDOM * pi)
    terms = -0.5 * np.log(variance) - (FREEDOM + 1) / 2 * np.log1p(left2 / (FREEDOM * variance))
    return float(-2 * (len(left2) * constant + terms.sum()))


def white(design: Array, values: Array, variance: Array) -> float:
    """Returns -2 log likelihood of normal noise without a wander, whose variance is the most likely multiple of the given one."""
    coefficients, _ = weighted(design, values, variance)
    multiple = max(float(np.mean((values - design @ coefficients) ** 2 / variance)), _ROUNDING**2)
    return float(np.sum(np.log(2 * pi * multiple * variance)) + len(values))


class Wander(NamedTuple):
    """Wander with exponential memory (Ornstein-Uhlenbeck process), in addition to noise of a given variance at each value."""

    time: Array
    variance: Array
    size2: float
    """Variance of the wander."""
    memory: float
    """Time in which the correlation of the wander falls to 1/e."""
    deviance: float
    """-2 log likelihood of normal noise, with the design with which the wander was found."""

    def whiten(self, columns: Array) -> Array:
        """Scales columns, (N, C), such that the noise of each row has variance 1 and is independent of the other rows."""
        whitened, _ = _filtered(self.time, self.variance[:, None], np.array([self.size2]), np.array([self.memory]), columns)
        return whitened[:, 0, :]


def wander(time: Array, design: Array, values: Array, variance: Array) -> Wander:
    """Returns the most likely wander on a grid of factors of 2: its memory from the time step to the whole duration, its variance as a fraction of
    the total, and the variance of the noise as a multiple of the given one."""
    whole = float(time[-1] - time[0])
    shortest = max(float(np.median(np.diff(time))), whole / len(time) / 4)
    memories = shortest * 2.0 ** np.arange(np.ceil(np.log2(whole / shortest)) + 1)
    sizes2 = float(np.var(values)) * 2.0 ** np.arange(-7, 3)
    shares = 2.0 ** np.arange(-4, 3)
    grid = np.stack([axis.ravel() for axis in np.meshgrid(sizes2, memories, shares)])
    noise = variance[:, None] * grid[2]
    columns = np.column_stack([design, values])
    whitened, log_variance = _filtered(time, noise, grid[0], grid[1], columns)
    moments = np.einsum("ngi,ngj->gij", whitened, whitened)
    of_design, with_values = moments[:, :-1, :-1], moments[:, :-1, -1:]
    explained = with_values.transpose(0, 2, 1) @ np.linalg.solve(of_design, with_values)
    deviance = moments[:, -1, -1] - explained[:, 0, 0] + log_variance + len(values) * np.log(2 * pi)
    best = int(np.argmin(deviance))
    return Wander(time, noise[:, best], float(grid[0, best]), float(grid[1, best]), float(deviance[best]))


def _filtered(time: Array, noise: Array, size2: Array, memory: Array, columns: Array) -> tuple[Array, Array]:
    """Runs the Kalman filter of wanders (G,) with noise (N, G). Returns the innovations of each column in units of their standard deviation, (N, G,
    C), and the sum of the logarithms of their variances, (G,)."""
    mean = np.zeros((size2.size, columns.shape[1]))
    variance, log_variance = size2.copy(), np.zeros(size2.size)
    whitened = np.empty((len(time), *mean.shape))
    for place, row in enumerate(columns):
        if place:
            decay = np.exp(-(time[place] - time[place - 1]) / memory)
            mean *= decay[:, None]
            variance = decay**2 * variance + (1 - decay**2) * size2
        total = variance + noise[place]
        innovation = row - mean
        whitened[place] = innovation / np.sqrt(total)[:, None]
        log_variance += np.log(total)
        mean += (variance / total)[:, None] * innovation
        variance = variance * noise[place] / total
    return whitened, log_variance
