"""Joints of a line through a series: steps, and dates from which it has another slope."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, NamedTuple

import numpy as np

from ._needs import need
from ._noise import Array


LEAST_LOGS = 3
"""Least number of logs on each side of a joint: neither of only two logs could be identified as an outlier."""
SINGLE: tuple[Literal["step", "slope"], ...] = ("step", "slope")
"""Possible kinds of a single joint."""
_KINDS: tuple[Literal["step", "slope", "step_and_slope"], ...] = (*SINGLE, "step_and_slope")
_SWEEPS = 8
# Number of columns that are tried at once, so that memory does not grow with the square of the number of logs.
_BLOCK = 512
# Fraction of a column's squares that may be left by rounding where it is a combination of others.
_ROUNDING = 1e-20


Whiten = Callable[[Array], Array]
"""Scales columns, (N, C), such that the noise of each row is independent with variance 1."""


class Joint(NamedTuple):
    """Joint from which on the line is different: at the log `log_index`."""

    log_index: int
    kind: Literal["step", "slope", "step_and_slope"]


class Line(NamedTuple):
    """Line with joints in ascending order."""

    joints: tuple[Joint, ...] = ()
    sloped: bool = False
    """Whether it has a slope from the first log on."""

    def without(self, joint: Joint) -> Line:
        """Returns the line without one of its joints."""
        return Line(tuple(one for one in self.joints if one != joint), self.sloped)

    def with_joint(self, joint: Joint) -> Line:
        """Returns the line with one more joint."""
        return Line(tuple(sorted((*self.joints, joint))), self.sloped)

    def design(self, time: Array) -> Array:
        """Returns its columns, (N, P): level, slope from the first log on, then those of each joint."""
        columns = [np.ones(len(time))]
        if self.sloped:
            columns.append(time - time[0])
        for joint in self.joints:
            columns += _columns(time, joint)
        return np.stack(columns, axis=1)

    def column(self, change: int) -> int:
        """Returns the column of the design for a change, by its index: first the slope from the first log on, if there is one, then the joints."""
        joints = self.joints[: max(0, change - self.sloped)]
        past = [1 + (joint.kind == "step_and_slope") for joint in joints]
        return 1 if self.sloped and change == 0 else 1 + self.sloped + sum(past)

    def cost(self, count: int, series_count: int) -> float:
        """Returns the cost of the line in units of -2 log likelihood, from the prior odds.

        A coefficient costs log N (Schwarz 1978). A joint may be at each of N logs with equal probability, including a slope from the first log on: 2
        log N. Together this is the penalty of Zhang and Siegmund (2007). A joint is expected in one of all the series: 2 log of their number (Chen
        and Chen 2008).
        """
        joints = len(self.joints) + self.sloped
        coefficients = joints + sum(joint.kind == "step_and_slope" for joint in self.joints)
        return float((coefficients + 2 * joints) * np.log(count) + 2 * joints * np.log(series_count))


def by_deviation(variance: Array) -> Whiten:
    """Returns the function that scales independent noise of a given variance at each log to variance 1."""
    root = 1 / np.sqrt(variance)
    return lambda columns: columns * root[:, None]


def squares(line: Line, time: Array, values: Array, whiten: Whiten) -> float:
    """Returns the sum of squares of the whitened residual of a line."""
    whitened = whiten(np.column_stack([line.design(time), values]))
    q, _ = np.linalg.qr(whitened[:, :-1])
    left = whitened[:, -1] - q @ (q.T @ whitened[:, -1])
    return float(left @ left)


def candidates(time: Array, values: Array, variance: Array, series_count: int) -> list[Line]:
    """Returns lines that may be the best: from a segmentation and from single joints, each improved joint by joint."""
    count = len(time)
    if count < 2 * LEAST_LOGS or time[-1] <= time[0]:
        return [Line()]
    level_or_slope = [Line(), Line(sloped=True)] if _may_slope(time)[0] else [Line()]
    starts = [*level_or_slope, _segments(time, values, variance)]
    starts += [Line((best,)) for kind in SINGLE if (best := _best_joint(Line(), kind, time, values, variance))]
    improved = (_improved(start, time, values, variance, series_count) for start in starts)
    return list(dict.fromkeys([*level_or_slope, *improved]))


def _may_slope(time: Array) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Whether at least two dates follow that of each log: otherwise a slope from there is no other line than a step."""
    following = np.append(time, np.inf)[np.searchsorted(time, time, side="right")]
    may: np.ndarray[Any, np.dtype[np.bool_]] = following < time[-1]
    return may


def residual_sums(rest: Line, kind: Literal["step", "slope", "step_and_slope"], time: Array, values: Array, whiten: Whiten) -> Array:
    """Returns the sum of squares of the whitened residual with one more joint of a kind, at each log; infinite where there is no room for one."""
    q, _ = np.linalg.qr(whiten(rest.design(time)))
    left = whiten(values[:, None])
    left = left - q @ (q.T @ left)
    total = float((left**2).sum())
    sums = np.full(len(time), np.inf)
    room = _room(rest, time, kind)
    for begin in range(0, len(room), _BLOCK):
        places = room[begin : begin + _BLOCK]
        parts = [whiten(columns) for columns in _columns_at(time, places, kind)]
        least = [_ROUNDING * (part**2).sum(axis=0) for part in parts]
        parts = [part - q @ (q.T @ part) for part in parts]
        sums[places] = total - _explained(parts, least, left[:, 0])
    return sums


def _explained(parts: list[Array], least: list[Array], left: Array) -> Array:
    """Returns the part of the sum of squares of `left` that one column, or two together, explain, for each place. A column whose sum of squares is less than
    `least` is a combination of others, as a slope between logs of two dates is, and explains nothing."""

    def ratio(column: Array, least: Array) -> Array:
        size = (column**2).sum(axis=0)
        found: Array = np.divide(left @ column, size, out=np.zeros_like(size), where=size > least)
        return found

    first = parts[0]
    explained: Array = ratio(first, least[0]) * (left @ first)
    if len(parts) > 1:
        size = (first**2).sum(axis=0)
        along = np.divide((first * parts[1]).sum(axis=0), size, out=np.zeros_like(size), where=size > least[0])
        second = parts[1] - first * along
        explained = explained + ratio(second, least[1]) * (left @ second)
    return explained


def _room(rest: Line, time: Array, kind: Literal["step", "slope", "step_and_slope"]) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Returns the logs at which another joint has enough logs on each side. Logs of one date have no order among them."""
    count = len(time)
    allowed = np.zeros(count, dtype=bool)
    allowed[LEAST_LOGS : count - LEAST_LOGS + 1] = True
    allowed[1:] &= np.diff(time) > 0
    if kind != "step":
        allowed &= _may_slope(time)
    for joint in rest.joints:
        allowed[max(0, joint.log_index - LEAST_LOGS + 1) : joint.log_index + LEAST_LOGS] = False
    return np.flatnonzero(allowed)


def _columns(time: Array, joint: Joint) -> list[Array]:
    return [columns[:, 0] for columns in _columns_at(time, np.array([joint.log_index]), joint.kind)]


def _columns_at(
    time: Array, places: np.ndarray[Any, np.dtype[np.int64]], kind: Literal["step", "slope", "step_and_slope"]
) -> list[Array]:
    step = (np.arange(len(time))[:, None] >= places[None, :]).astype(float)
    slope = np.maximum(time[:, None] - time[places][None, :], 0.0)
    return [step] * (kind != "slope") + [slope] * (kind != "step")


def _best_joint(
    rest: Line, kind: Literal["step", "slope", "step_and_slope"], time: Array, values: Array, variance: Array
) -> Joint | None:
    sums = residual_sums(rest, kind, time, values, by_deviation(variance))
    return Joint(int(np.argmin(sums)), kind) if np.isfinite(sums).any() else None


def _improved(line: Line, time: Array, values: Array, variance: Array, series_count: int) -> Line:
    """Gives each joint in turn its best place and kind, or removes it, and tries one more, until no change improves the line."""
    whiten = by_deviation(variance)

    def criterion(one: Line) -> float:
        return squares(one, time, values, whiten) + one.cost(len(time), series_count)

    best = criterion(line)
    for _ in range(_SWEEPS):
        rivals = [Line(line.joints, not line.sloped)] if line.sloped or _may_slope(time)[0] else []
        for joint in (*line.joints, None):
            rest = line if joint is None else line.without(joint)
            rivals.append(rest)
            found = (_best_joint(rest, kind, time, values, variance) for kind in _KINDS)
            rivals += [rest.with_joint(one) for one in found if one]
        ranked = min(rivals, key=criterion)
        if criterion(ranked) >= best - 1e-9:
            break
        line, best = ranked, criterion(ranked)
    return line


def _segments(time: Array, values: Array, variance: Array) -> Line:
    """Returns a bottom-up segmentation into levels and slopes (Keogh et al. 2001), with a joint of step and slope between each two segments."""
    ruptures = need("ruptures")
    weights = 1 / variance
    terms = (np.append(0.0, weights * moment) for moment in _moments(time, values))
    sums = np.cumsum(list(terms), axis=1)
    worth = float(np.log(len(time)))

    def fit(cost: Any, signal: Array) -> Any:
        cost.signal = signal
        return cost

    def error(_: Any, start: int, end: int) -> float:
        """Returns the weighted sum of squares about a level, or about a line if that is worth its slope."""
        w, wt, wtt, wy, wty, wyy = sums[:, end] - sums[:, start]
        level = wyy - wy * wy / w
        spread = wtt - wt * wt / w
        slope = level - (wty - wt * wy / w) ** 2 / spread if spread > 0 else level
        return float(max(min(level, slope + worth), 0.0))

    # The base class exists only if the library is installed.
    parts = {"model": "", "min_size": LEAST_LOGS, "fit": fit, "error": error}
    cost = type("Segment", (ruptures.base.BaseCost,), parts)()
    search = ruptures.BottomUp(custom_cost=cost, min_size=LEAST_LOGS, jump=1).fit(values.reshape(-1, 1))
    # Joints that the segmentation misses would be lost; surplus ones are removed afterwards.
    ends = search.predict(pen=3 * worth)
    return Line(tuple(Joint(end, "step_and_slope") for end in ends[:-1] if time[end] > time[end - 1]))


def _moments(time: Array, values: Array) -> list[Array]:
    since = time - time.mean()
    about = values - values.mean()
    return [np.ones(len(time)), since, since**2, about, since * about, about**2]
