"""Detection of changes in a series: a step, or the start of a slope. There is none if the series only scatters or wanders."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from ._joints import LEAST_LOGS, SINGLE, Joint, Line, Whiten, by_deviation, candidates, residual_sums, squares
from ._noise import FREEDOM, Array, Scatter, Wander, fit_line, rough_scatter, size_of, wander, weighted, white

_ROUNDS = 3
# Evidence that is called very strong, in units of -2 log likelihood (Kass and Raftery 1995). A line has many joints with which to follow a wander.
_VERY_STRONG = 10.0
# Number of logs on each side with which a value is compared to detect an outlier.
_NEIGHBOURS = 3
# Range of -2 log likelihood that contains date and size together with 95 %: the quantile of χ² with two degrees of freedom.
_INTERVAL = 5.99


class Change(NamedTuple):
    """Joint that the evidence supports."""

    log_index: int
    """First log after a step, or the log from which a slope begins."""
    earliest: int
    latest: int
    """Last log of the 95 % interval of the joint, whose first one is `earliest`."""
    kind: Literal["step", "slope", "step_and_slope"]
    delta_bic: float
    """Criterion with the joint minus that without it: negative values favour the joint, and each 2 is a factor of e."""


class Course(NamedTuple):
    """Series described by a line with joints, and noise."""

    line: Line
    changes: tuple[Change, ...]
    scatter: float
    """Standard deviation from log to log in addition to the standard errors."""
    wanders: bool
    """Whether a wander with a memory explains the series better than any joint."""
    fitted: Array
    """Values of the line at each log."""
    coefficients: Array
    covariance: Array
    last_t: float
    """Deviation of the last value from the line through all others, in standard deviations of the prediction; 0 for fewer than 6 values."""


def course(time: Array, values: Array, errors: Array, series_count: int) -> Course:
    """Describes a series, in ascending order of time, which is one of `series_count` series that are examined together.

    The noise of a value follows Student's t with its standard error and a scatter from log to log. The scatter is estimated together with each line
    that is compared. Hence neither an occasional faulty log nor a deviation within the scatter counts as a change. A joint is kept if the criterion
    with the prior odds supports it (`Line.cost`), and if the evidence against a wander with a memory is very strong.
    """
    errors = np.where(np.isfinite(errors), errors, 0.0)
    middle = float(np.median(values))
    scale = size_of(values - middle)
    y, s = (values - middle) / scale, errors / scale
    line, fit = _best(time, y, s, series_count)
    whiten, wanders = by_deviation(fit.variance), None
    if line != Line():
        line, wanders = _beside_wander(time, y, line, _local_variance(y, s), series_count)
        if wanders is not None:
            whiten = wanders.whiten
            coefficients, covariance = _least_squares(line, time, y, whiten)
            fit = fit._replace(coefficients=coefficients, covariance=covariance)
    changes = _changes(line, time, y, s, fit, whiten, series_count, wanders=wanders is not None)
    fitted = line.design(time) @ fit.coefficients * scale + middle
    coefficients = fit.coefficients * scale
    coefficients[0] += middle
    last_t = _last(line, time, y, s)
    return Course(line, changes, fit.scatter * scale, wanders is not None, fitted, coefficients, fit.covariance * scale**2, last_t)


def _least_squares(line: Line, time: Array, y: Array, whiten: Whiten) -> tuple[Array, Array]:
    whitened = whiten(np.column_stack([line.design(time), y]))
    return weighted(whitened[:, :-1], whitened[:, -1], np.ones(len(y)))


def _fit(line: Line, time: Array, y: Array, s: Array) -> Scatter:
    return fit_line(line.design(time), y, s, max(rough_scatter(y, s), 1e-3))


def _best(time: Array, y: Array, s: Array, series_count: int) -> tuple[Line, Scatter]:
    count = len(time)
    variance = _local_variance(y, s)
    known: dict[Line, Scatter] = {}
    best: Line | None = None
    for _ in range(_ROUNDS):
        for line in candidates(time, y, variance, series_count):
            for one in (line, *_simpler(line)):
                if one not in known:
                    known[one] = _fit(one, time, y, s)
        ranked = min(known, key=lambda one: _compared(one, known, count, series_count))
        variance = known[ranked].variance
        if ranked == best:
            break
        best = ranked
    return ranked, known[ranked]


def _local_variance(y: Array, s: Array) -> Array:
    """Estimates the variance of each value from its neighbours only; that of outliers is increased until they fit. It favours neither joints nor a
    wander."""
    smooth = np.array([np.median(y[max(0, place - _NEIGHBOURS) : place + _NEIGHBOURS + 1]) for place in range(len(y))])
    noise2 = np.maximum(s**2 + rough_scatter(y, s) ** 2, 1e-12)
    grown: Array = noise2 / np.minimum((FREEDOM + 1) / (FREEDOM + (y - smooth) ** 2 / noise2), 1.0)
    return grown


def _compared(line: Line, known: dict[Line, Scatter], count: int, series_count: int) -> float:
    """Returns the criterion of a line relative to the line without joints, with the Bartlett factor of that comparison."""
    none = known[Line()]
    free = known[line].coefficients.size + 1
    gain = (none.deviance - known[line].deviance) * max(count - free - 1, 0) / count
    return line.cost(count, series_count) - gain


def _simpler(line: Line) -> list[Line]:
    """Returns the line without one of its joints, or with a simpler one."""
    rivals = [Line(line.joints, False)] if line.sloped else []
    for joint in line.joints:
        rest = line.without(joint)
        rivals.append(rest)
        if joint.kind == "step_and_slope":
            rivals += [rest.with_joint(Joint(joint.log_index, kind)) for kind in SINGLE]
    return rivals


def _beside_wander(time: Array, y: Array, line: Line, variance: Array, series_count: int) -> tuple[Line, Wander | None]:
    """Returns the line that remains if the series may wander. Also returns the wander, if it explains more than the line."""
    count = len(time)
    schwarz = np.log(count)
    # The prior odds against a joint are the same with a wander as with a level.
    as_line = white(line.design(time), y, variance) + schwarz + line.cost(count, series_count)
    alone = wander(time, Line().design(time), y, variance)
    # Four parameters: a level, the size and the memory of the wander, and the remaining noise.
    if as_line + _VERY_STRONG <= alone.deviance + schwarz * (1 + 3):
        return line, None
    best, beside, best_gain = Line(), alone, 0.0
    for kind in SINGLE:
        left = residual_sums(Line(), kind, time, y, alone.whiten)
        if np.isfinite(left).any():
            one = Line((Joint(int(np.argmin(left)), kind),))
            found = wander(time, one.design(time), y, variance)
            gain = alone.deviance - found.deviance - one.cost(count, series_count)
            if gain > best_gain:
                best, beside, best_gain = one, found, gain
    return best, beside


def _changes(
    line: Line, time: Array, y: Array, s: Array, fit: Scatter, whiten: Whiten, series_count: int, *, wanders: bool
) -> tuple[Change, ...]:
    count = len(time)
    free = fit.coefficients.size + 1
    parts: list[tuple[Joint | None, Line]] = [(joint, line.without(joint)) for joint in line.joints]
    if line.sloped:
        parts.insert(0, (None, Line(line.joints, False)))
    changes = []
    for joint, rest in parts:
        if wanders:
            gain = squares(rest, time, y, whiten) - squares(line, time, y, whiten)
        else:
            gain = (_fit(rest, time, y, s).deviance - fit.deviance) * max(count - free - 1, 0) / count
        delta_bic = line.cost(count, series_count) - rest.cost(count, series_count) - gain
        if joint is None:
            changes.append(Change(0, 0, 0, "slope", delta_bic))
            continue
        left = residual_sums(rest, joint.kind, time, y, whiten)
        near = np.flatnonzero(left - left.min() <= _INTERVAL)
        changes.append(Change(joint.log_index, int(near[0]), int(near[-1]), joint.kind, delta_bic))
    return tuple(changes)


def _last(line: Line, time: Array, y: Array, s: Array) -> float:
    """Compares the last value with the prediction from all others."""
    if len(time) < 2 * LEAST_LOGS:
        return 0.0
    last = len(time) - 1
    shorter = Line(tuple(joint for joint in line.joints if joint.log_index < last), line.sloped)
    fit = _fit(shorter, time[:-1], y[:-1], s[:-1])
    row = shorter.design(time)[-1]
    variance = s[-1] ** 2 + fit.scatter**2 + float(row @ fit.covariance @ row)
    return float((y[-1] - row @ fit.coefficients) / np.sqrt(max(variance, 1e-18)))
